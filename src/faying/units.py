"""Text with units at the edges, SI floats inside: "12 kN" <-> 12000.0. The only file that imports pint."""

from functools import cache
from math import isfinite
from typing import Any

from faying.errors import InputError

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


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(cache_folder=None)


def parse(text: object, unit: str, *, name: str = "value") -> float:
    """Turn text such as "12 kN" into a float in the SI unit `unit`.

    `name` is what the error calls the quantity. Raises InputError when the unit is missing, of another
    dimension, or unknown, and when the number is not finite.
    """
    example = EXAMPLES.get(unit, f"1 {unit}")
    if isinstance(text, bool) or not isinstance(text, str):
        raise InputError(
            f'{name} = {text!r} has no unit; write a number with its unit as text, for example "{example}"'
        )
    import pint

    try:
        quantity = _registry().Quantity(text)
    except (
        pint.errors.PintError,
        ValueError,
        TypeError,
        AttributeError,
        SyntaxError,
        AssertionError,
        KeyError,
        ZeroDivisionError,
        OverflowError,
    ) as fault:
        raise InputError(f'{name} = "{text}" is not a quantity ({fault}); write for example "{example}"') from None
    except Exception as fault:  # pint's tokenizer lets other kinds through
        raise InputError(f'{name} = "{text}" is not a quantity; write for example "{example}"') from fault
    if not hasattr(quantity, "units") or (quantity.dimensionless and unit != ""):
        raise InputError(f'{name} = "{text}" has no unit; write for example "{example}"')
    try:
        value = float(quantity.to(unit).magnitude)
    except pint.errors.DimensionalityError:
        raise InputError(f'{name} = "{text}" is not in a unit like {unit}; write for example "{example}"') from None
    if not isfinite(value):
        raise InputError(f'{name} = "{text}" is not a finite number; write for example "{example}"')
    return value


def scale(unit_text: str, unit: str, *, name: str = "unit") -> float:
    """Return how many SI `unit` one `unit_text` is: scale("um", "m") is 1e-6. Raises InputError as parse does."""
    return parse(f"1 {unit_text}", unit, name=name)


def show(value: float, unit: str, *, digits: int = 4) -> str:
    """Write an SI value with a prefix: show(12000.0, "N") is "12 kN". Units with powers get no prefix."""
    if value == 0 or not isfinite(value) or any(mark in unit for mark in "^*") or unit.startswith("kg"):
        return f"{value:.{digits}g} {unit}".rstrip()
    for factor, prefix in _PREFIXES:
        if abs(value) >= factor * (1 - 1e-12):
            return f"{value / factor:.{digits}g} {prefix}{unit}"
    return f"{value:.{digits}g} {unit}"
