"""Text with units at the edges, SI floats inside: "12 kN" <-> 12000.0. The only file that imports pint."""

import re
from collections.abc import Iterable
from functools import cache
from math import isfinite, pi
from typing import Any

from faying.errors import InputError, shown

# what a quantity of each SI unit looks like when a user writes it
EXAMPLES = {
    "m": "0.4 mm",
    "m^2": "16 mm^2",
    "N": "12 kN",
    "N*m": "9 N*m",
    "Pa": "200 GPa",
    "Pa/m": "50 MPa/um",
    "kg": "120 g",
    "kg/m^3": "7800 kg/m^3",
    "Hz": "5 kHz",
    "rad": "30 deg",
    "N/m": "1 kN/mm",
    "W/(m*K)": "50 W/(m K)",
    "ohm*m": "0.2 uohm m",
    "m/s^2": "10 m/s^2",
    "K": "60 K",
    "1/K": "12e-6 1/K",
    "s": "30 min",
    "(m/s^2)^2/Hz": "0.04 g^2/Hz",
    "N^2/Hz": "2 N^2/Hz",
}

_PREFIXES = (
    (1e9, "G"),
    (1e6, "M"),
    (1e3, "k"),
    (1.0, ""),
    (1e-3, "m"),
    (1e-6, "u"),
    (1e-9, "n"),
    (1e-12, "p"),
)


GRAVITY = 9.80665  # m/s2, standard: "g" where an acceleration is meant
# what most studies say, so that pint, which takes a second to load, stays out; a test compares each with pint
COMMON = {
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9},
    "m^2": {"m^2": 1.0, "mm^2": 1e-6},
    "N": {"N": 1.0, "kN": 1e3},
    "Pa": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9},
    "kg": {"kg": 1.0, "g": 1e-3},
    "kg/m^3": {"kg/m^3": 1.0},
    "Hz": {"Hz": 1.0, "kHz": 1e3},
    "m/s^2": {"m/s^2": 1.0, "g": GRAVITY},
    "(m/s^2)^2/Hz": {"(m/s^2)^2/Hz": 1.0, "g^2/Hz": GRAVITY**2},
    "N^2/Hz": {"N^2/Hz": 1.0},
    "N*m": {"N*m": 1.0, "N m": 1.0},
    "s": {"s": 1.0, "min": 60.0, "h": 3600.0},
    "K": {"K": 1.0},
    "1/K": {"1/K": 1.0},
}

NUMBER = re.compile(r"\s*+([+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*+((?:.*\S)?)\s*+", re.DOTALL)
# a unit is names with whole powers, joined by * / . or a blank, maybe in brackets; "1/" may stand before one
_NAME = r"[^\W\d_]++(?:_\w+)?(?:(?:\^|\*\*)-?[0-9]{1,2}|[²³])?"  # ++: letters are not divided in every way
UNIT = re.compile(rf"(?:\s|\)(?:\^|\*\*)[0-9]|[*/·.()]|1(?=\s*/)|{_NAME})*+|%")
SHORT_OR_LONG = re.compile(r"\btons?(?:_force)?\b")
LONGEST = 60  # letters of a unit's name


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(cache_folder=None)


@cache
def _factor(text: str, unit: str) -> float | None:
    """How many SI `unit` one unit `text` is; None where it is of another dimension. InputError for no unit's name."""
    if text in COMMON.get(unit, ()):
        return COMMON[unit][text]
    return _pint_factor(text, unit)


def _pint_factor(text: str, unit: str) -> float | None:
    import pint

    if (found := SHORT_OR_LONG.search(text)) is not None:
        raise InputError(f"{found[0]!r} may be a metric, a short or a long ton; write t, short_ton or long_ton")
    if len(text) > LONGEST or UNIT.fullmatch(text) is None:
        raise InputError(f"{text[:LONGEST]!r} is not the name of a unit")
    plain = (
        re.sub(r"(?<=[^\W\d_])\s*\.\s*(?=[^\W\d_])", "*", text).replace("·", "*").replace("²", "^2").replace("³", "^3")
    )
    try:
        nothing, one = (_registry().Quantity(value, plain) for value in (0.0, 1.0))
        if nothing.to(unit).magnitude:
            raise InputError(f"{text!r} has a zero of its own; give a difference, in K")
        # to pint an angle has no dimension, and rad/s are Hz
        turns = one.to_root_units().unit_items() if "Hz" in unit else ()
        return float(one.to(unit).magnitude / (2 * pi) ** dict(turns).get("radian", 0))
    except InputError:
        raise
    except pint.errors.DimensionalityError:
        return None
    except Exception:  # pint's parser lets errors of many kinds through
        raise InputError(f"{text!r} is not the name of a unit") from None


def parse(text: object, unit: str, *, name: str = "value") -> float:
    """Turn text such as "12 kN" into a float in the SI unit `unit`.

    Args:
        text: one number with a decimal point and the name of a unit.
        unit: the SI unit that is wanted.
        name: what the error calls the quantity.

    Raises:
        InputError: the unit is missing, of another dimension or unknown, the number has a comma or is not finite.
    """
    example = f'write for example "{EXAMPLES.get(unit, f"1 {unit}")}"'
    if isinstance(text, bool) or not isinstance(text, str):
        raise InputError(f"{name} = {_short(text)} has no unit; write a number with its unit as text, {example[6:]}")
    if "," in text:
        raise InputError(
            f"{name} = {_short(text)} has a comma; use a decimal point, and no mark for thousands: {example}"
        )
    found = NUMBER.fullmatch(text)
    if found is None:
        raise InputError(f"{name} = {_short(text)} is not a quantity (one number and a unit); {example}")
    number, word = float(found.group(1)), found.group(2)
    if not word:
        raise InputError(f"{name} = {_short(text)} has no unit; {example}")
    try:
        factor = _factor(word, unit)
    except InputError as fault:
        raise InputError(f"{name} = {_short(text)} is not a quantity ({fault}); {example}") from None
    if factor is None:
        raise InputError(f"{name} = {_short(text)} is not in a unit like {unit}; {example}")
    if not isfinite(number * factor):
        raise InputError(f"{name} = {_short(text)} is not a finite number; {example}")
    return number * factor


def _short(text: object) -> str:
    """What was given, cut where it is long."""
    if not isinstance(text, str):
        return shown(text)
    given = f'"{text}"'
    return given if len(given) <= 80 else f"{given[:60]}... ({len(given)} characters)"


def lengths(text: str, *, name: str = "size") -> tuple[float, float] | float:
    """Turn "4 mm x 3 mm" into two lengths [m], along x and y, or "5 um" into one. Raises InputError as `parse`."""
    parts = re.split(r"\s+x\s+", text.strip())
    if len(parts) > 2:
        raise InputError(f'{name} = {_short(text)}; write one length or two, for example "4 mm x 3 mm"')
    found = [parse(part, "m", name=name) for part in parts]
    if min(found) <= 0:
        raise InputError(f"{name} = {_short(text)} must be positive")
    return found[0] if len(found) == 1 else (found[0], found[1])


def scale(unit_text: str, unit: str, *, name: str = "unit") -> float:
    """Return how many SI `unit` one `unit_text` is: scale("um", "m") is 1e-6.

    Raises InputError unless `unit_text` is the name of a unit of that kind, without a number.
    """
    try:
        factor = _factor(unit_text.strip(), unit)
    except InputError as fault:
        raise InputError(f"{name}: {fault}; write its name alone, for example {_name_like(unit)}") from None
    if factor is None:
        raise InputError(f'{name} = "{unit_text}" is not a unit like {unit}; write for example {_name_like(unit)}')
    return factor


def _name_like(unit: str) -> str:
    return EXAMPLES.get(unit, f"1 {unit}").partition(" ")[2]


def load_text(load: float) -> str:
    """Write a preload [N] in kN: load_text(12000.0) is "12 kN"; "no preload" where it is 0, as no bolt's is."""
    return f"{load / 1e3:.4g} kN" if load else "no preload"


def in_mm(point: Iterable[float]) -> str:
    """Write a point [m]: in_mm((0.01, 0.0, 0.005)) is "(10, 0, 5) mm"."""
    return f"({', '.join(f'{1e3 * x:.4g}' for x in point)}) mm"


def show(value: float, unit: str, *, digits: int = 4) -> str:
    """Write an SI value with a prefix: show(12000.0, "N") is "12 kN". Units with powers get no prefix."""
    if value == 0 or not isfinite(value) or any(mark in unit for mark in "^*") or unit.startswith("kg"):
        return f"{value:.{digits}g} {unit}".rstrip()
    for factor, prefix in _PREFIXES:
        if abs(value) >= factor * (1 - 1e-12):
            return f"{value / factor:.{digits}g} {prefix}{unit}"
    return f"{value:.{digits}g} {unit}"


def show_area(area: float) -> str:
    """An area [m2] for a reader, in mm2 to four digits and without an exponent: "10,490 mm2"."""
    return f"{float(f'{1e6 * area:.4g}'):,.15g} mm2"
