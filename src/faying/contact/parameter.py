"""What one parameter of a contact law is, and how a value for it is read and checked."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from math import inf
from pathlib import Path
from typing import Literal, final

import numpy as np
from numpy.typing import ArrayLike

from faying import units
from faying.checks import number, plain
from faying.errors import InputError, shown
from faying.typing import Array

FARTHEST = 1e308  # whole numbers beyond it are not floats
TEXT, FILE, TABLE = "text", "file", "table"  # in place of a unit: a word, the name of a file, an array


@final
@dataclass(frozen=True)
class Parameter:
    """One parameter of a law.

    Args:
        unit: SI unit; "" for a plain number, "text", "file" or "table" for what is not a number.
        meaning: a few words for people.
        least, greatest: the allowed range in SI units; ends tells which ends belong to it: "()", "[)", "(]", "[]".
        choices: the words that are allowed, also beside numbers.
        whole: whether only whole numbers are allowed.
        surface: the number of a rough surface that gives this parameter where nobody else does, an attribute of
            `SurfaceInputs`, or "scan"; "" where no surface gives it.
    """

    unit: str
    meaning: str
    least: float = -inf
    greatest: float = inf
    ends: Literal["()", "[)", "(]", "[]"] = "()"
    choices: tuple[str, ...] = ()
    whole: bool = False
    surface: str = ""

    @property
    def is_number(self) -> bool:
        """Whether values are numbers (a choice of words may be allowed besides)."""
        return self.unit not in (TEXT, FILE, TABLE)

    @property
    def is_switch(self) -> bool:
        """Whether values are 0 or 1, which True and False stand for as well."""
        return self.whole and (self.least, self.greatest, self.ends) == (0, 1, "[]")

    @property
    def allowed(self) -> str:
        """The allowed values in words."""
        words = {TEXT: "" if self.choices else "any text", FILE: "the name of a file", TABLE: "an array"}
        text = self._range if self.is_number else words[self.unit]
        if self.whole:
            text = f"a whole number, {text}"
        return ", or ".join(filter(None, (text, " or ".join(f'"{word}"' for word in self.choices))))

    @property
    def _range(self) -> str:
        if self.least > -inf and self.greatest < inf and self.ends == "()":
            return f"between {self.least:g} and {self.greatest:g}"
        if self.least == 0 and self.greatest == inf and self.ends[0] == "(":
            return "positive"
        low = {"(": "above", "[": "at least"}[self.ends[0]] + f" {self.least:g}" if self.least > -inf else ""
        high = {")": "below", "]": "at most"}[self.ends[1]] + f" {self.greatest:g}" if self.greatest < inf else ""
        return " and ".join(filter(None, (low, high))) or "any number"

    def check(self, value: object, name: str) -> None:
        """Raise InputError unless a value in SI units is allowed."""
        if not self.is_number or isinstance(value, str):
            if not isinstance(value, str):
                if self.unit != TEXT:
                    return
                raise InputError(f"{name} = {shown(value)}; allowed is {self.allowed}")
            if self.choices and value not in self.choices:
                near = get_close_matches(str(value), self.choices, n=1)
                hint = f"; did you mean {near[0]}?" if near else ""
                raise InputError(f"{name} = {shown(value)}; allowed is {self.allowed}{hint}")
            return
        if (isinstance(value, bool) and not self.is_switch) or not isinstance(value, int | float):
            raise InputError(f"{name} = {shown(value)}; allowed is {self.allowed}")
        if abs(value) > FARTHEST:
            value = inf if value > 0 else -inf
        above = value >= self.least if self.ends[0] == "[" else value > self.least
        below = value <= self.greatest if self.ends[1] == "]" else value < self.greatest
        if not (above and below and abs(value) < inf) or (self.whole and value != int(value)):
            unit = f" {self.unit}" if self.unit else ""
            raise InputError(f"{name} = {value:.12g}{unit}; it must be {self.allowed}")

    def value(self, value: object, name: str) -> object:
        """Return what a Python user gives as a value in SI units; InputError where it is not allowed.

        value: a number, or text with a unit for a quantity; a word. name: what the error calls it.
        """
        if self.is_number and not (isinstance(value, str) and value in self.choices):
            number = units.parse(value, self.unit, name=name) if isinstance(value, str) and self.unit else value
            value = number.item() if isinstance(number, np.generic) else number
            if isinstance(value, str):
                raise InputError(f"{name} = {shown(value)}; allowed is {self.allowed}")
        self.check(value, name)
        return value

    def read(self, value: object, name: str, folder: Path | None = None) -> object:
        """Turn what a user wrote (TOML or text) into a value in SI units; InputError where it is not allowed.

        Args:
            value: text with a unit for a quantity, a number or its text for a plain one, a word, a file name.
            name: what the error calls it.
            folder: where file names start from.
        """
        if self.unit == TABLE:
            raise InputError(f"{name}: an array cannot be written here; give it in Python")
        out: object = value
        if self.unit in (TEXT, FILE):
            if not isinstance(value, str):
                raise InputError(f"{name} = {shown(value)} should be text in quotes")
            if self.unit == FILE:
                out = (folder or Path()) / value
                if not out.is_file():
                    raise InputError(f"{name}: no file {out}")
        elif isinstance(value, str) and value in self.choices:
            pass
        elif self.unit:
            out = units.parse(value, self.unit, name=name)
        else:
            out = plain(value, name, f" or {', '.join(self.choices)}" if self.choices else "")
        self.check(out, name)
        return int(out) if self.whole and isinstance(out, float) else out


def checked_all(
    law: str, parameters: Mapping[str, Parameter], values: Mapping[str, object], optional: Collection[str]
) -> dict[str, object]:
    """Return the values that differ from those given once they are read: text with a unit, numbers of numpy.

    Raises InputError, with the law's name before it, for the first of the values that is not allowed; None is, for
    those that are `optional`.
    """
    read: dict[str, object] = {}
    for name, parameter in parameters.items():
        value = values.get(name)
        if parameter.unit == TABLE or (value is None and name in optional):
            continue
        try:
            plain = parameter.value(value, name)
        except InputError as fault:
            raise InputError(f"{law}: {fault}") from None
        if plain is not value:
            read[name] = plain
    return read


def checked(values: ArrayLike, *, name: str, unit: str, zero: bool) -> Array:
    """Return values as floats, texts with units among them read; InputError where one is NaN, infinite, negative, or
    zero unless `zero` allows it."""
    array = _floats(values, name, unit)
    if not np.all(np.isfinite(array)):
        raise InputError(
            f"{name}: {np.count_nonzero(~np.isfinite(array))} of {array.size} values are NaN or infinite; "
            f"give finite numbers in {unit}"
        )
    if np.any(array < 0) or (not zero and np.any(array == 0)):
        raise InputError(
            f"{name}: least value {array.min():.6g} {unit}; it must be {'0 or more' if zero else 'positive'}"
        )
    return array


def _floats(values: ArrayLike, name: str, unit: str) -> Array:
    """Values as they are where they are numbers, as `checks.number` reads them where one of them is text."""
    try:
        given = np.asarray(values)
        if given.dtype.kind in "fiu":
            return np.asarray(given, dtype=float)
        given = np.asarray(values, dtype=object)
    except (TypeError, ValueError):
        raise InputError(f"{name} = {shown(values)}: the rows differ in length; give numbers in {unit}") from None
    read = [number(value, name, unit) for value in given.ravel()]
    return np.asarray(read, dtype=float).reshape(given.shape)


# what the laws of fractal surfaces share
FRACTAL = {
    "D": Parameter("", "fractal dimension of the surface", 2, 3, surface="D"),
    "G": Parameter("m", "fractal roughness", 0, surface="G"),
    "scan_area": Parameter(
        "m^2", "area that the scan covers, to which the largest spot belongs", 0, surface="scan_area"
    ),
}
GAMMA = {"gamma": Parameter("", "frequency index of the surface", 1, surface="gamma")}
# G in the convention of Majumdar and Bhushan
FRACTAL_MB = FRACTAL | {"G": Parameter("m", "fractal roughness", 0, surface="G_majumdar_bhushan")}
