"""[modes], [tightening] and [response]: what is computed, and how."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from faying.errors import InputError
from faying.joint.modal import MOST_MODES, SOLVERS, ModesChoice
from faying.study.keys.reader import MOST_LOSS, Table, direction, point, quantity

MOST_POINTS, MOST_PASSES = 1_000_000, 100
Point = tuple[float, float, float]


def read_modes(table: Table | None) -> ModesChoice:
    """Read [modes]."""
    if table is None:
        return ModesChoice()
    choice = ModesChoice(
        count=table.count("count", 10, most=MOST_MODES),
        damping=table.text("damping", "hysteretic", ("hysteretic", "viscous")),
        solver=table.text("solver", None, SOLVERS),
        shift_frequency=table.quantity("shift_frequency", "Hz", None),
        levels=table.take("levels", _levels, ModesChoice.levels),
        intervals=table.truth("intervals", True),
    )
    table.close()
    return choice


def _levels(value: Any, name: str) -> tuple[float, ...]:
    """Accelerations, rising; none where empty."""
    if not isinstance(value, list):
        raise InputError(f'{name} = {value!r} should be a list, such as ["0.1 m/s^2", "1 m/s^2", "10 m/s^2"], or []')
    found = tuple(quantity(one, "m/s^2", name) for one in value)
    if any(b <= a for a, b in pairwise(found)):
        raise InputError(f"{name} = {value!r}: levels must rise")
    return found


@dataclass(frozen=True, kw_only=True)
class ResponseChoice:
    """Frequency response: inputs and outputs as (point [m], direction), from first to last [Hz] in so many points."""

    inputs: tuple[tuple[Point, Point], ...]
    outputs: tuple[tuple[Point, Point], ...]
    first: float
    last: float
    points: int
    structural_loss: float

    @classmethod
    def of(cls, table: Table | None) -> "ResponseChoice | None":
        """Read [response]."""
        if table is None:
            return None
        first, last = table.quantity("from", "Hz"), table.quantity("to", "Hz")
        if first is not None and last is not None and not first < last:
            table.faults.add(f"response: from = {first:g} Hz must lie below to = {last:g} Hz")
        sides: list[tuple[tuple[Point, Point], ...]] = []
        for key in ("input", "output"):
            pairs = []
            for one in table.tables(key, required=True):
                pairs.append((one.take("point", point), one.take("direction", direction)))
                one.close()
            sides.append(tuple(pairs))
        choice = cls(
            inputs=sides[0],
            outputs=sides[1],
            first=first,
            last=last,
            points=table.count("points", 1000, most=MOST_POINTS),
            structural_loss=table.within("structural_loss", 0, MOST_LOSS, 0.0),
        )
        table.close()
        return choice


def read_order(table: Table | None, names: Sequence[str]) -> tuple[int, ...] | None:
    """Read [tightening]: the order as indices of bolts, pass after pass; None where all are pulled at once."""
    if table is None:
        return None

    def order(value: Any, name: str) -> tuple[int, ...]:
        if not isinstance(value, list) or any(v not in names for v in value) or set(value) != set(names):
            raise InputError(f"{name} = {value!r} should name every bolt: {', '.join(map(repr, names))}")
        return tuple(names.index(v) for v in value)

    found, passes = table.take("order", order), table.count("passes", 1, most=MOST_PASSES)
    table.close()
    return None if found is None else found * passes
