"""A law from any measured or computed curve."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from math import isfinite
from pathlib import Path
from typing import Any, ClassVar, Self, final

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.law import ContactLaw, Response, checked, require
from faying.contact.parameter import FILE, TABLE, TEXT, Parameter
from faying.contact.response import UNITS
from faying.errors import InputError, ReadError
from faying.materials import ContactPair
from faying.typing import Array

FORM = "a table looks like: pressure [MPa],k_n [MPa/um] and under it rows such as 1,40"
EXAMPLES = {"Pa": "MPa", "Pa/m": "MPa/um", "J/m^2": "J/m^2"}
PASSED_OVER = "valid"
QUANTITIES = tuple(name for name in UNITS if name != "pressure")


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class TabulatedLaw(ContactLaw):
    """Rising pressures [Pa], shape (n,), n >= 2, and any of area, k_n, k_t, loss_n, ... at them, SI, same shape.

    Between the points: shape-preserving cubics (Fritsch and Carlson 1980, doi:10.1137/0717021) through the logarithms
    of both where all values are positive, so that power laws stay exact; through the values over ln(p) else. Outside
    the table the law says nothing. `origin` names the measurement. Raises InputError for tables that are not finite,
    not rising in pressure, of unequal length, negative, or with nothing but pressure.
    """

    pressure: ArrayLike
    area: ArrayLike | None = None
    k_n: ArrayLike | None = None
    k_t: ArrayLike | None = None
    loss_n: ArrayLike | None = None
    loss_t: ArrayLike | None = None
    energy_n: ArrayLike | None = None
    energy_t: ArrayLike | None = None
    k_load: ArrayLike | None = None
    origin: str = "table"

    name: ClassVar[str] = "Table"
    source: ClassVar[str] = "measured or computed curve"
    validity: ClassVar[str] = "between its first and last pressure"
    parameters: ClassVar = {
        "pressure": Parameter(TABLE, "nominal pressures [Pa], rising"),
        "area": Parameter(TABLE, "real area over nominal area [-]"),
        "k_n": Parameter(TABLE, "normal stiffness per area [Pa/m]"),
        "k_t": Parameter(TABLE, "tangential stiffness per area [Pa/m]"),
        "loss_n": Parameter(TABLE, "normal loss factor [-]"),
        "loss_t": Parameter(TABLE, "tangential loss factor [-]"),
        "energy_n": Parameter(TABLE, "normal energy per area [J/m2]"),
        "energy_t": Parameter(TABLE, "tangential energy per area [J/m2]"),
        "k_load": Parameter(TABLE, "slope of pressure over approach on first loading [Pa/m], where not k_n"),
        "origin": Parameter(TEXT, "where the table comes from"),
    }

    @classmethod
    def entries(cls) -> Mapping[str, Parameter]:
        """A user gives the table by its file."""
        return {"file": Parameter(FILE, "the table, as CSV with units in its head")}

    @classmethod
    def from_entries(cls, given: Mapping[str, object], pair: ContactPair) -> Self:
        """Read the table; the materials are those of the measurement."""
        return cls.from_csv(str(given["file"]))

    def __post_init__(self) -> None:
        p = checked(self.pressure, name="pressure of the table", unit="Pa", zero=False)
        require(
            self.name, p.ndim == 1 and p.size >= 2, f"pressure has shape {p.shape}; give at least 2 values in a row"
        )
        require(self.name, bool(np.all(np.diff(p) > 0)), "pressure does not rise; sort the table and drop repetitions")
        columns = self._columns
        require(self.name, bool(columns), f"nothing but pressure is given; give any of {', '.join(QUANTITIES)}")
        for name, value in columns.items():
            checked(value, name=f"{name} of the table", unit=UNITS[name] or "no unit", zero=True)
            require(self.name, value.shape == p.shape, f"{name} has shape {value.shape}, pressure {p.shape}")
        object.__setattr__(self, "pressure", _frozen(p))
        for name, value in columns.items():
            object.__setattr__(self, name, _frozen(value))

    @classmethod
    def from_approach(cls, pressure: ArrayLike, approach: ArrayLike, *, origin: str = "table") -> Self:
        """Return the law of a measured approach of the faces [m] under rising pressures [Pa]: k_n = dp/d(approach).

        The derivative is that of a shape-preserving cubic through the logarithms. Raises InputError as the class, and
        unless the approach rises.
        """
        from scipy.interpolate import PchipInterpolator

        p = checked(pressure, name="pressure of the table", unit="Pa", zero=False)
        u = checked(approach, name="approach", unit="m", zero=False)
        good = p.ndim == 1 and p.shape == u.shape and p.size >= 2 and np.all(np.diff(u) > 0) and np.all(np.diff(p) > 0)
        require(cls.name, bool(good), "pressure and approach must be two rows of one length, both rising")
        slope = PchipInterpolator(np.log(u), np.log(p)).derivative()(np.log(u))
        return cls(pressure=p, k_n=p / u * slope, origin=origin)

    @classmethod
    def from_csv(cls, path: str | Path) -> Self:
        """Read a table with a head such as `pressure [MPa],k_n [MPa/um]`; lines from # on are comments.

        `faying law --csv` writes such files. Raises ReadError, with the file and the line, for files that are missing
        or do not hold a table.
        """
        try:
            return cls(**read_columns(Path(path)), origin=str(path))
        except ReadError:
            raise
        except InputError as fault:
            raise ReadError(f"{path}: {fault}") from None

    @property
    def _columns(self) -> dict[str, Array]:
        given = {f.name: getattr(self, f.name) for f in fields(self) if f.name in QUANTITIES}
        return {name: np.asarray(value, float) for name, value in given.items() if value is not None}

    @property
    def closure_range(self) -> tuple[float, float]:
        """First and last pressure [Pa]."""
        p = np.asarray(self.pressure)
        return float(p[0]), float(p[-1])

    @cached_property
    def _curves(self) -> Mapping[str, tuple[bool, Any]]:
        from scipy.interpolate import PchipInterpolator

        log_p = np.log(np.asarray(self.pressure))
        out = {}
        for name, value in self._columns.items():
            positive = bool(np.all(value > 0))
            out[name] = positive, PchipInterpolator(log_p, np.log(value) if positive else value)
        return out

    def at_closure(self, pressure: ArrayLike) -> Response:
        """Return the response at pressures [Pa] within the table, any shape; InputError outside."""
        p = checked(pressure, name="pressure", unit="Pa", zero=False)
        first, last = self.closure_range
        if p.size and (p.min() < first * (1 - 1e-9) or p.max() > last * (1 + 1e-9)):
            raise InputError(
                f"{self.origin}: the table covers {first:.4g} to {last:.4g} Pa; asked were {p.min():.4g} "
                f"to {p.max():.4g} Pa"
            )
        x = np.log(np.clip(p, first, last))
        values = {n: np.exp(c(x)) if positive else np.asarray(c(x)) for n, (positive, c) in self._curves.items()}
        reasons = {}
        if "area" in values:
            reasons["real area above 0.3 of the nominal area"] = values["area"] > 0.3
        return Response(pressure=p.copy(), reasons=reasons, **values)


def _frozen(values: Array) -> Array:
    out = np.array(values, dtype=float)
    out.setflags(write=False)
    return out


def read_columns(path: Path) -> dict[str, Array]:
    """Read the columns of a CSV file whose head names quantities and units; SI arrays by name.

    Comments begin with #; a column "valid", as `faying law --csv` writes it, is passed over. Raises ReadError.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as fault:
        raise ReadError(f"{path}: cannot be read as text ({fault})") from None
    lines = [(i, bare) for i, line in enumerate(text.splitlines(), start=1) if (bare := line.partition("#")[0].strip())]
    if not lines:
        raise ReadError(f"{path}: the head is empty; {FORM}")
    (first, head), *body = lines
    if "," not in head and (";" in head or "\t" in head):
        mark = "semicolons" if ";" in head else "tabs"
        raise ReadError(
            f"{path}, line {first}: {mark} between the columns; put commas there, and points in decimal numbers"
        )
    if _is_number(_cells(head)[0]):
        raise ReadError(f"{path}, line {first}: no head with the names of the columns; {FORM}")
    columns = [_column(cell, f"{path}, line {first}") for cell in _cells(head)]
    names = [name for name, _ in columns]
    for name in names:
        if names.count(name) > 1:
            raise ReadError(f'{path}, line {first}: {names.count(name)} columns are called "{name}"; leave one')
    if "pressure" not in names:
        raise ReadError(f'{path}, line {first}: no column "pressure [unit]"; the head is {head}')
    if not set(names) & set(QUANTITIES):
        raise ReadError(f"{path}, line {first}: nothing but pressure is given; add any of {', '.join(QUANTITIES)}")
    rows = [_row(line, names, f"{path}, line {number}") for number, line in body]
    if len(rows) < 2:
        raise ReadError(
            f"{path}: {len(rows)} row{'s' * (len(rows) != 1)} under the head; give 2 or more, rising in pressure"
        )
    for (number, _), above, row in zip(body[1:], rows, rows[1:], strict=False):
        if not row["pressure"] > above["pressure"]:
            raise ReadError(
                f"{path}, line {number}: the pressure {row['pressure']:g} does not rise above {above['pressure']:g}, "
                "that of the row before; sort the rows and drop repetitions"
            )
    return {name: factor * np.array([row[name] for row in rows]) for name, factor in columns if name != PASSED_OVER}


def _cells(line: str) -> list[str]:
    """The cells of one line, without blanks and quotation marks around them."""
    return [cell.strip() for cell in next(csv.reader([line], skipinitialspace=True))]


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _column(cell: str, where: str) -> tuple[str, float]:
    """Name and factor to SI of one cell of the head."""
    from faying.units import scale

    name, _, unit = cell.partition("[")
    name, unit = name.strip(), unit.rstrip("] ").strip()
    if name == PASSED_OVER:
        return name, 1.0
    if name != "pressure" and name not in QUANTITIES:
        known = ", ".join(("pressure", *QUANTITIES))
        raise ReadError(f'{where}: the column "{cell}" is unknown; known are {known}; {FORM}')
    wanted = UNITS[name]
    if not wanted:
        if unit not in ("", "-", "1"):
            raise ReadError(f'{where}: the column "{cell}" has no unit; give plain numbers under "{name}"')
        return name, 1.0
    example = f'write for example "{name} [{EXAMPLES[wanted]}]"'
    if not unit:
        raise ReadError(f'{where}: the column "{cell}" lacks its unit; {example}')
    try:
        return name, scale(unit, wanted)
    except InputError:
        raise ReadError(f'{where}: "{unit}" of the column "{cell}" is not a unit like {wanted}; {example}') from None


def _row(line: str, names: list[str], where: str) -> dict[str, float]:
    """The numbers of one line by the names of their columns."""
    cells = _cells(line)
    if len(cells) > len(names):
        raise ReadError(f"{where}: {len(cells)} values under the {len(names)} columns of the head; {FORM}")
    row = {}
    for i, name in enumerate(names):
        if name == PASSED_OVER:
            continue
        cell = cells[i] if i < len(cells) else ""
        if not cell:
            raise ReadError(f'{where}: no value in the column "{name}"; give one, or leave the row out')
        try:
            value = row[name] = float(cell)
        except ValueError:
            raise ReadError(f'{where}: "{cell}" in the column "{name}" is not a number') from None
        if not isfinite(value):
            raise ReadError(f'{where}: "{cell}" in the column "{name}" is not a finite number; leave the row out')
        if value < 0 or (value == 0 and name == "pressure"):
            least = (
                "pressures must be above 0, where the faces begin to touch"
                if name == "pressure"
                else "it must be 0 or more"
            )
            raise ReadError(f'{where}: {cell} in the column "{name}"; {least}')
    return row
