"""A law from any measured or computed curve."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import ClassVar, Self, final

import numpy as np
from numpy.typing import ArrayLike

from faying.checks import path as checked_path
from faying.checks import text
from faying.columns import read_columns
from faying.contact.law import ContactLaw, Response, checked, require
from faying.contact.measured_range import OF_CURVES
from faying.contact.parameter import FILE, TABLE, TEXT, Parameter
from faying.contact.pressure_series import monotone
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
    measured_ranges: ClassVar = {"Table": OF_CURVES}
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
        text(self.origin, "origin of the table")
        p = checked(self.pressure, name="pressure of the table", unit="Pa", zero=False)
        require(
            self.name, p.ndim == 1 and p.size >= 2, f"pressure has shape {p.shape}; give at least 2 values in a row"
        )
        require(self.name, bool(np.all(np.diff(p) > 0)), "pressure does not rise; sort the table and drop repetitions")
        columns = self._columns
        require(self.name, bool(columns), f"nothing but pressure is given; give any of {', '.join(QUANTITIES)}")
        for name, value in columns.items():
            require(self.name, value.shape == p.shape, f"{name} has shape {value.shape}, pressure {p.shape}")
        for name, value in ({"pressure": p} | columns).items():
            own = np.array(value)
            own.setflags(write=False)
            object.__setattr__(self, name, own)

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
        file = checked_path(path, "path of a table")
        try:
            return cls(**_read(file), origin=str(path))
        except ReadError:
            raise
        except InputError as fault:
            raise ReadError(f"{path}: {fault}") from None

    @property
    def _columns(self) -> dict[str, Array]:
        return {
            name: checked(value, name=f"{name} of the table", unit=UNITS[name], zero=True)
            for name in QUANTITIES
            if (value := getattr(self, name, None)) is not None
        }

    @property
    def closure_range(self) -> tuple[float, float]:
        """First and last pressure [Pa]."""
        p = np.asarray(self.pressure)
        return float(p[0]), float(p[-1])

    @cached_property
    def _curves(self) -> Mapping[str, Callable[[Array], Array]]:
        log_p = np.log(np.asarray(self.pressure))
        return {name: monotone(log_p, value) for name, value in self._columns.items()}

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
        values = {name: curve(x) for name, curve in self._curves.items()}
        reasons = {}
        if "area" in values:
            reasons["real area above 0.3 of the nominal area"] = values["area"] > 0.3
        return Response(pressure=p.copy(), reasons=reasons, **values)


def _read(path: Path) -> dict[str, Array]:
    """SI arrays by name from a CSV file; a column "valid", as `faying law --csv` writes it, is passed over.

    Raises ReadError.
    """
    table = read_columns(path, UNITS, needed="pressure", form=FORM, examples=EXAMPLES, passed_over=(PASSED_OVER,))
    found, lines = dict(table.values), table.lines
    if not set(found) & set(QUANTITIES):
        known = ", ".join(QUANTITIES)
        raise ReadError(f"{path}, line {table.head}: nothing but pressure is given; add any of {known}")
    if len(lines) < 2:
        raise ReadError(
            f"{path}: {len(lines)} row{'s' * (len(lines) != 1)} under the head; give 2 or more, rising in pressure"
        )
    above = "pressures must be above 0, where the faces begin to touch"
    for name, values in found.items():
        low, least = (values <= 0, above) if name == "pressure" else (values < 0, "it must be 0 or more")
        if np.any(low):
            row = int(np.argmax(low))
            raise ReadError(f'{path}, line {lines[row]}: {table.given(name, row)} in the column "{name}"; {least}')
    falls = np.diff(found["pressure"]) <= 0
    if np.any(falls):
        row = int(np.argmax(falls)) + 1
        raise ReadError(
            f"{path}, line {lines[row]}: the pressure {table.given('pressure', row)} does not rise above "
            f"{table.given('pressure', row - 1)}, that of the row before; sort the rows and drop repetitions"
        )
    return found
