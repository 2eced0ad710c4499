"""What shakes a structure in service: a power spectral density or a sine sweep, of its supports or of a force."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import log2
from pathlib import Path
from typing import Any, Literal

import numpy as np

from faying.checks import number
from faying.columns import read_columns
from faying.errors import InputError
from faying.misuse import checked_call, shortened
from faying.study.load import Force, Vector, vector
from faying.typing import Array

Row = tuple[float | str, float | str]
Kind = Literal["random", "sine"]
# SI unit of the second column, by kind and by whether the supports move or a force acts
UNITS = {
    ("random", True): "(m/s^2)^2/Hz",
    ("random", False): "N^2/Hz",
    ("sine", True): "m/s^2",
    ("sine", False): "N",
}
SLOPE = re.compile(r"\s*([+-]?[0-9]+(?:\.[0-9]*)?)\s*dB\s*/\s*oct(?:ave)?\s*", re.IGNORECASE)
DECIBELS = {"random": 10.0, "sine": 20.0}  # per factor of ten of a power, and of an amplitude
FORM = {
    "random": '[["20 Hz", "0.01 g^2/Hz"], ["80 Hz", "0.04 g^2/Hz"], ["2 kHz", "-3 dB/oct"]]',
    "sine": '[["20 Hz", "2 g"], ["2 kHz", "2 g"]]',
}
FASTEST = 100.0  # octaves a minute


@dataclass(frozen=True, kw_only=True, eq=False)
class InputTable:
    """A value against frequency, straight where both are drawn in logarithms; nothing outside.

    Args:
        frequencies: Rising [Hz] (k,).
        values: Above 0 (k,), of a density or of an amplitude.
    """

    frequencies: Array
    values: Array

    def at(self, frequencies: Array) -> Array:
        """The value at frequencies [Hz] of any shape; 0 below the first and above the last."""
        f = np.asarray(frequencies, dtype=float)
        inside = (f >= self.frequencies[0]) & (f <= self.frequencies[-1])
        at = np.log(np.where(inside, f, self.frequencies[0]))
        logs = np.interp(at, np.log(self.frequencies), np.log(self.values))
        return np.asarray(np.where(inside, np.exp(logs), 0.0))


@checked_call
@dataclass(frozen=True, init=False, eq=False)
class Excitation:
    """What shakes a structure: give `psd` or `sine`. Without face and point all supports move together.

    Args:
        name: What messages and results call it.
        psd: One-sided power spectral density as rows of frequency and value: [Hz] with [(m/s2)2/Hz] where the supports
            move, or [N2/Hz] where a force acts, as numbers or as text with a unit such as "0.04 g^2/Hz". A value such
            as "+3 dB/oct" is a slope that leads to the row from the one before, or from the first row to the second.
            Between rows both are straight in logarithms. Or the path of a CSV file with the columns frequency and psd.
        sine: Amplitude of a sweep in the same form, [m/s2] or [N]; the columns of a file are frequency and amplitude.
        direction: Along which supports move or the force acts; its length does not count.
        face: Face that the force is spread over.
        point: Point (3,) [m] that the force goes through; without a face the node nearest to it bears it.
        duration: Of random vibration [s], or text with a unit, for fatigue; None where it is not asked for.
        rate: Of a sweep, up to 100 octaves a minute, for fatigue; None where it is not asked for.
        points: Points (3,) [m] whose motion is wanted; the one that moves most of each part where empty.

    Raises:
        InputError: Neither or both of psd and sine, a table that does not rise or has no unit, nothing above 0.
    """

    name: str
    kind: Kind
    table: InputTable
    direction: Vector
    force: Force | None
    duration: float | None
    rate: float | None
    points: tuple[Vector, ...]

    def __init__(
        self,
        name: str,
        *,
        psd: Sequence[Row] | str | Path | None = None,
        sine: Sequence[Row] | str | Path | None = None,
        direction: Sequence[float] = (0.0, 0.0, 1.0),
        face: str | None = None,
        point: Sequence[float | str] | None = None,
        duration: float | str | None = None,
        rate: float | None = None,
        points: Sequence[Sequence[float | str]] = (),
    ) -> None:
        what = f"vibration {name!r}"
        if (psd is None) == (sine is None):
            raise InputError(f"{what}: give either psd or sine, a table of frequency and value")
        kind: Kind = "sine" if psd is None else "random"
        if duration is not None and kind == "sine":
            raise InputError(f"{what}: duration belongs to psd; a sweep has a rate, in octaves a minute")
        if rate is not None and kind == "random":
            raise InputError(f"{what}: rate belongs to sine; random vibration has a duration")
        size = float(np.linalg.norm(direction))
        if len(direction) != 3 or not 0 < size < np.inf:
            raise InputError(f"{what}: direction = {shortened(direction)}; give three numbers that are not all 0")
        along = tuple(float(one) / size for one in direction)
        rows = psd if sine is None else sine
        base = face is None and point is None
        values = {
            "name": name,
            "kind": kind,
            "table": _table(rows, kind, UNITS[kind, base], what),
            "direction": along,
            "force": None if base else Force(face, force=along, point=point),
            "duration": None if duration is None else number(duration, f"{what}: duration", "s", least=0),
            "rate": None if rate is None else number(rate, f"{what}: rate", least=0, greatest=FASTEST, ends="(]"),
            "points": tuple(vector(one, "m", f"{what}: points") for one in points),
        }
        for key, value in values.items():
            object.__setattr__(self, key, value)
        if not name.strip():
            raise InputError("a vibration has an empty name; give it one, by which results call it")

    @property
    def base(self) -> bool:
        """Whether the supports move; else a force acts."""
        return self.force is None

    @property
    def unit(self) -> str:
        """SI unit of the values of the table."""
        return UNITS[self.kind, self.base]


def not_held(name: str) -> str:
    """That the supports should move, and there are none."""
    return f"vibration {name!r} moves the supports, and there are none; add a [[support]], or give face or point"


def not_along(one: Excitation) -> str:
    """That the supports should move along a direction in which they hold nothing."""
    return (
        f"vibration {one.name!r}: no support holds the structure along direction = {list(one.direction)}; give another "
        "direction, or a [[support]] that holds it"
    )


def held_still(one: Excitation) -> str:
    """That the force acts on what supports hold."""
    return f"vibration {one.name!r}: its force acts where supports hold the structure, and shakes nothing; move it"


def _table(given: Any, kind: Kind, unit: str, what: str) -> InputTable:
    """The table of rows, or of a file. Raises InputError that shows the form."""
    key = "psd" if kind == "random" else "sine"
    where = f"{what}: {key}"
    if isinstance(given, str | Path):
        column = "psd" if kind == "random" else "amplitude"
        form = f"the columns are frequency [Hz] and {column} [{unit}]"
        table = read_columns(Path(given), {"frequency": "Hz", column: unit}, needed=("frequency", column), form=form)
        rows: Sequence[Any] = list(zip(table.values["frequency"].tolist(), table.values[column].tolist(), strict=True))
    else:
        rows = given
    if len(rows) < 2 or any(isinstance(row, str) or len(row) != 2 for row in rows):
        raise InputError(f"{where} = {shortened(given)}; give two rows or more, for example {FORM[kind]}")
    frequencies = [number(row[0], f"{where}: frequency", "Hz", least=0) for row in rows]
    for low, high in pairwise(frequencies):
        if not high > low:
            raise InputError(f"{where}: {high:g} Hz comes after {low:g} Hz; let frequencies rise, each once")
    return InputTable(frequencies=np.array(frequencies), values=_values(rows, frequencies, kind, unit, where))


def _values(rows: Sequence[Any], frequencies: Sequence[float], kind: Kind, unit: str, where: str) -> Array:
    """The values of all rows (k,), those that a slope leads to among them."""
    slopes = [SLOPE.fullmatch(row[1]) if isinstance(row[1], str) else None for row in rows]
    found = [
        None if slope else number(row[1], f"{where} at {f:g} Hz", unit, least=0)
        for row, f, slope in zip(rows, frequencies, slopes, strict=True)
    ]
    for k, slope in enumerate(slopes):
        if slope is None:
            continue
        near = 1 if k == 0 else k - 1
        start = found[near]
        if start is None:
            raise InputError(f"{where} at {frequencies[k]:g} Hz is a slope, and so is the row that it starts from")
        octaves = log2(frequencies[k] / frequencies[near])
        # a slope counts upwards in frequency, also of the first row
        found[k] = start * 10 ** (float(slope[1]) * octaves / DECIBELS[kind])
    values = np.array(found, dtype=float)
    if not np.all((values > 0) & np.isfinite(values)):
        raise InputError(f"{where}: a slope leads to 0 or beyond all numbers; give a value in its place")
    return values
