"""How one value of a study is read: its form, its unit, its range."""

from collections.abc import Callable
from typing import Any, TypeVar

from faying import units
from faying.checks import plain
from faying.errors import InputError

POINT, DIRECTION = 'three lengths, for example ["0 mm", "10 mm", "0 mm"]', "three numbers, for example [1, 0, 0]"
MAX_COUNT = 1_000_000  # of what is counted, where a key says no less
MOST_LOSS = 2.0  # loss factor [-]: no structure loses more in a radian than it stores
Made = TypeVar("Made")
# least and greatest size that a number of a unit has in any bolted structure: beyond them a unit or a power is wrong
RANGES = {
    "m": (1e-12, 1e4),
    "m^2": (1e-24, 1e6),
    "N": (1e-6, 1e10),
    "Pa": (1e-3, 1e14),
    "Pa/m": (1.0, 1e20),
    "Hz": (1e-6, 1e10),
    "kg": (1e-12, 1e7),  # the heaviest machines have some 1e6 kg
    "kg/m^3": (1.0, 3e4),  # aerogels and osmium
    "m/s^2": (1e-9, 1e6),  # shocks of 100,000 g
    "N*m": (1e-9, 1e9),
    "W/(m*K)": (1e-6, 1e6),
}


def quantity(
    value: Any, unit: str, name: str, *, positive: bool = True, ends: tuple[float, float] | None = None
) -> float:
    """Parse one quantity; InputError where the unit is missing or the value not positive or out of its range."""
    number = units.parse(value, unit, name=name)
    if positive and number <= 0:
        raise InputError(f'{name} = "{value}" must be positive')
    least, greatest = ends or RANGES.get(unit, (0.0, float("inf")))
    if (number and not (least <= abs(number) or not positive)) or abs(number) > greatest:
        low, high = (units.show(end, unit) for end in (least, greatest))
        raise InputError(f'{name} = "{value}" is beyond what a bolted structure has, {low} to {high}; check its unit')
    return number


def several(value: Any, name: str, form: str, read: Callable[[Any, str], Made], count: int) -> tuple[Made, ...]:
    """Convert so many values in a list, each by `read`; InputError that shows the form."""
    if not isinstance(value, list) or len(value) != count:
        raise InputError(f"{name} = {value!r} should be {form}")
    return tuple(read(one, name) for one in value)


def quantities(value: Any, name: str, form: str, unit: str, count: int) -> tuple[float, ...]:
    """Convert so many quantities of one unit in a list, of any sign; InputError that shows the form."""
    return several(value, name, form, lambda one, where: quantity(one, unit, where, positive=False), count)


def point(value: Any, name: str) -> tuple[float, float, float]:
    """Convert three lengths with units; InputError that shows the form."""
    x, y, z = quantities(value, name, POINT, "m", 3)
    return x, y, z


def direction(value: Any, name: str) -> tuple[float, float, float]:
    """Convert three numbers that are not all zero; InputError that shows the form."""
    x, y, z = several(value, name, DIRECTION, number, 3)
    size = max(abs(x), abs(y), abs(z))
    if size == 0:
        raise InputError(f"{name} = {value!r} has no length")
    if not 1e-9 < size < 1e9:  # whose square is 0 or infinite at the end
        raise InputError(f"{name} = {value!r} is only a direction; write numbers about 1, for example [1, 0, 0]")
    return x, y, z


def number(value: Any, name: str) -> float:
    """Check one plain number."""
    return plain(value, name, as_text=False)


def whole_number(value: Any, name: str, most: int = MAX_COUNT) -> int:
    """A whole number from 1 to `most`. Raises InputError for any other value."""
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= most:
        raise InputError(f"{name} = {value!r} should be a whole number from 1 to {most:,}")
    return value


def within(value: Any, name: str, least: float, greatest: float) -> float:
    """Check one plain number from the least to the greatest."""
    found = number(value, name)
    if not least <= found <= greatest:
        raise InputError(f"{name} = {found:g} should be a plain number from {least:g} to {greatest:g}")
    return found


def truth(value: Any, name: str) -> bool:
    """Check true or false."""
    if not isinstance(value, bool):
        raise InputError(f"{name} = {value!r} should be true or false, without quotes")
    return value


def length_unit(value: Any, name: str) -> str:
    """Check the name of a unit of length."""
    unit = text(value, name)
    units.scale(unit, "m", name=name)
    return unit


def text(value: Any, name: str, choices: tuple[str, ...] = ()) -> str:
    """Check a text, one of some choices where they are given."""
    if not isinstance(value, str):
        raise InputError(f"{name} = {value!r} should be text in quotes")
    if choices and value not in choices:
        raise InputError(f'{name} = "{value}" should be one of {", ".join(choices)}')
    return value
