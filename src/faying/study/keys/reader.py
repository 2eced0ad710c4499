"""Reads tables of a study file and collects every fault, so that the user sees them all at once."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from typing import Any, TypeVar

from faying import units
from faying.contact.parameter import FILE, Parameter
from faying.errors import InputError
from faying.geometry.selectors import Selector

MOST = 1_000_000  # of what is counted, where a key says no less
MOST_FRICTION, MOST_LOSS = 10.0, 2.0  # coefficient of friction, loss factor [-]
# least and greatest size that a number of a unit has in any bolted structure: beyond them a unit or a power is wrong
RANGES = {
    "m": (1e-12, 1e4),
    "m^2": (1e-24, 1e6),
    "N": (1e-6, 1e10),
    "Pa": (1e-3, 1e14),
    "Pa/m": (1.0, 1e20),
    "Hz": (1e-6, 1e10),
    "kg": (1e-12, 1e9),
    "kg/m^3": (1e-3, 1e6),
    "m/s^2": (1e-9, 1e9),
    "N*m": (1e-9, 1e9),
    "W/(m*K)": (1e-6, 1e6),
}


class StudyFaults(InputError):
    """All faults of a study file; `lines` holds them one by one, each with its key in front."""

    def __init__(self, where: str, lines: list[str]) -> None:
        count = f"{len(lines)} fault" + "s" * (len(lines) > 1)
        super().__init__(f"{where}: {count}\n" + "\n".join(f"  - {line}" for line in lines))
        self.where, self.lines = where, tuple(lines)

    def __reduce__(self) -> tuple[type["StudyFaults"], tuple[str, list[str]]]:
        return StudyFaults, (self.where, list(self.lines))  # as other processes send it


MISSING: Any = object()
Made = TypeVar("Made")


@dataclass
class Faults:
    """The faults found so far, the files that the study names, which lie relative to `folder`, and selectors by name.

    selectors: those that stand in place of a face's name, under the name that the face gets.
    """

    lines: list[str] = field(default_factory=list)
    folder: Path = field(default_factory=Path)
    files: list[Path] = field(default_factory=list)
    selectors: dict[str, Selector] = field(default_factory=dict)

    def add(self, text: str) -> None:
        """Note one fault."""
        self.lines.append(text)

    def raise_if_any(self, where: str) -> None:
        """Raise one StudyFaults that lists all of them."""
        if self.lines:
            raise StudyFaults(where, self.lines)


class Table:
    """One table of the file; each key is taken once, and `close` reports the keys that nobody took."""

    def __init__(self, data: Mapping[str, Any], where: str, faults: Faults) -> None:
        self.data, self.where, self.faults = dict(data), where, faults
        self._known: list[str] = []

    def _name(self, key: str) -> str:
        return f"{self.where}.{key}" if self.where else key

    def take(self, key: str, convert: Callable[[Any, str], Any], default: Any = MISSING) -> Any:
        """Convert the value of `key`; a fault is noted where it is missing without default or does not convert."""
        self._known.append(key)
        if key not in self.data:
            if default is MISSING:
                self.faults.add(f"{self._name(key)} is missing")
                return None
            return default
        try:
            return convert(self.data[key], self._name(key))
        except InputError as fault:
            self.faults.add(str(fault))
            return None if default is MISSING else default

    def quantity(self, key: str, unit: str, default: Any = MISSING, *, positive: bool = True) -> Any:
        """Take a quantity with its unit, in SI."""
        return self.take(key, lambda value, name: quantity(value, unit, name, positive=positive), default)

    def text(self, key: str, default: Any = MISSING, choices: tuple[str, ...] | None = None) -> Any:
        """Take a text, one of `choices` where given."""
        return self.take(key, lambda value, name: _text(value, name, choices), default)

    def number(self, key: str, default: Any = MISSING) -> Any:
        """Take a plain number (of a quantity without dimension)."""
        return self.take(key, number, default)

    def within(self, key: str, least: float, greatest: float, default: Any = MISSING) -> Any:
        """Take a plain number from `least` to `greatest`."""

        def checked(value: Any, name: str) -> float:
            found = number(value, name)
            if not least <= found <= greatest:
                raise InputError(f"{name} = {found:g} should be a plain number from {least:g} to {greatest:g}")
            return found

        return self.take(key, checked, default)

    def count(self, key: str, default: Any = MISSING, *, most: int = MOST) -> Any:
        """Take a whole number from 1 to `most`."""
        return self.take(key, lambda value, name: whole_number(value, name, most), default)

    def texts(self, key: str, size: int, default: Any = MISSING) -> Any:
        """Take a list of `size` texts."""
        return self.take(key, lambda value, name: _texts(value, name, size), default)

    def truth(self, key: str, default: bool) -> bool:
        """Take true or false."""
        return bool(self.take(key, _truth, default))

    def table(self, key: str, *, required: bool = False) -> "Table | None":
        """Take a table within this one."""
        self._known.append(key)
        if key not in self.data:
            if required:
                self.faults.add(f"[{self._name(key)}] is missing")
            return None
        value = self.data[key]
        if not isinstance(value, Mapping):
            self.faults.add(f"{self._name(key)} = {value!r} should be a table: [{self._name(key)}]")
            return None
        return Table(value, self._name(key), self.faults)

    def tables(self, key: str, *, required: bool = False) -> "list[Table]":
        """Take a list of tables [[key]]; a single [key] counts as a list of one."""
        self._known.append(key)
        value = self.data.get(key)
        if value is None:
            if required:
                self.faults.add(f"[[{self._name(key)}]] is missing")
            return []
        items = [value] if isinstance(value, Mapping) else value
        if not isinstance(items, list) or not all(isinstance(item, Mapping) for item in items):
            self.faults.add(f"{self._name(key)} should be a list of tables: [[{self._name(key)}]]")
            return []
        return [Table(item, f"{self._name(key)}[{i + 1}]", self.faults) for i, item in enumerate(items)]

    def known(self, key: str) -> bool:
        """Whether this key has been asked for."""
        return key in self._known

    def file(self, key: str, default: Any = MISSING) -> Any:
        """Take the name of a file, relative to the study's folder; the study depends on that file from then on."""

        def existing(value: Any, name: str) -> Path:
            if not isinstance(value, str):
                raise InputError(f"{name} = {value!r} should be a file name in quotes")
            path = self.faults.folder / value
            if not path.is_file():
                raise InputError(f"{name}: no file {path}")
            self.faults.files.append(path)
            return path

        return self.take(key, existing, default)

    def parameter(self, key: str, parameter: Parameter) -> Any:
        """Take the parameter of a law, checked against its range; None where it is not given."""
        if parameter.unit == FILE:
            return self.file(key, None)
        return self.take(key, parameter.read, None)

    def each(self) -> "dict[str, Table]":
        """Take every table within this one, by name."""
        found = {name: self.table(name) for name in self.data}
        return {name: table for name, table in found.items() if table is not None}

    def named(self, key: str, *, required: bool = False) -> "dict[str, Table]":
        """Take the tables [key.NAME], by name."""
        outer = self.table(key, required=required)
        return outer.each() if outer is not None else {}

    def made(self, make: Callable[[], Made]) -> Made | None:
        """What `make` makes; an InputError of it is noted as a fault of this table."""
        try:
            return make()
        except InputError as fault:
            self.faults.add(f"{self.where}: {fault}")
            return None

    def close(self) -> None:
        """Note every key that was not asked for, with the nearest known one."""
        for key in self.data:
            if key not in self._known:
                near = get_close_matches(key, self._known, n=1)
                hint = f"; did you mean {near[0]}?" if near else f"; known are {', '.join(self._known)}"
                self.faults.add(f"{self._name(key)} is not a key that a study has{hint}")


def quantity(value: Any, unit: str, name: str, *, positive: bool = True) -> float:
    """Parse one quantity; InputError where the unit is missing or the value not positive."""
    number = units.parse(value, unit, name=name)
    if positive and number <= 0:
        raise InputError(f'{name} = "{value}" must be positive')
    least, greatest = RANGES.get(unit, (0.0, float("inf")))
    if (number and not (least <= abs(number) or not positive)) or abs(number) > greatest:
        low, high = (units.show(end, unit) for end in (least, greatest))
        raise InputError(f'{name} = "{value}" is beyond what a bolted structure has, {low} to {high}; check its unit')
    return number


def point(value: Any, name: str) -> tuple[float, float, float]:
    """Convert three lengths with units; InputError that shows the form."""
    if not isinstance(value, list) or len(value) != 3:
        raise InputError(f'{name} = {value!r} should be three lengths, for example ["0 mm", "10 mm", "0 mm"]')
    x, y, z = (quantity(v, "m", name, positive=False) for v in value)
    return x, y, z


def direction(value: Any, name: str) -> tuple[float, float, float]:
    """Convert three numbers that are not all zero; InputError that shows the form."""
    if not isinstance(value, list) or len(value) != 3:
        raise InputError(f"{name} = {value!r} should be three numbers, for example [1, 0, 0]")
    x, y, z = (number(v, name) for v in value)
    size = max(abs(x), abs(y), abs(z))
    if size == 0:
        raise InputError(f"{name} = {value!r} has no length")
    if not 1e-9 < size < 1e9:  # whose square is 0 or infinite at the end
        raise InputError(f"{name} = {value!r} is only a direction; write numbers about 1, for example [1, 0, 0]")
    return x, y, z


def number(value: Any, name: str) -> float:
    """Check one plain number."""
    if isinstance(value, bool) or not isinstance(value, int | float) or value != value or abs(value) == float("inf"):
        raise InputError(f"{name} = {value!r} should be a plain finite number, for example 0.3")
    return float(value)


def whole_number(value: Any, name: str, most: int = MOST) -> int:
    """A whole number from 1 to `most`. Raises InputError for any other value."""
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= most:
        raise InputError(f"{name} = {value!r} should be a whole number from 1 to {most:,}")
    return value


def _truth(value: Any, name: str) -> bool:
    if not isinstance(value, bool):
        raise InputError(f"{name} = {value!r} should be true or false, without quotes")
    return value


def _text(value: Any, name: str, choices: tuple[str, ...] | None) -> str:
    if not isinstance(value, str):
        raise InputError(f"{name} = {value!r} should be text in quotes")
    if choices and value not in choices:
        raise InputError(f'{name} = "{value}" should be one of {", ".join(choices)}')
    return value


def _texts(value: Any, name: str, size: int) -> list[str]:
    if not isinstance(value, list) or len(value) != size or not all(isinstance(v, str) for v in value):
        raise InputError(
            f'{name} = {value!r} should be a list of {size} names, for example ["upper.joint", "lower.joint"]'
        )
    return list(value)
