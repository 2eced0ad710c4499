"""[modes], [tightening] and [response]: what is computed, and how."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from faying.errors import InputError
from faying.joint.modal import MAX_MODES, SOLVERS, ModesChoice
from faying.study.declaration.declared import QUANTITY, REQUIRED, WORDS, Declared, Inner, Key, listed
from faying.study.declaration.reader import Table
from faying.study.declaration.values import MOST_LOSS, quantity

MOST_POINTS, MOST_PASSES = 1_000_000, 100
Point = tuple[float, float, float]


def read_modes(table: Table) -> ModesChoice:
    """Read [modes]."""
    return ModesChoice(**{key: table.get(key) for key in MODES})


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


def read_response(table: Table) -> tuple[ResponseChoice, float]:
    """Read [response], and the loss factor of the parts [-], which is theirs whether or not a response is found."""
    first, last = table.get("from"), table.get("to")
    if first is not None and last is not None and not first < last:
        table.faults.add(f"response: from = {first:g} Hz must be below to = {last:g} Hz")
    inputs, outputs = (
        tuple((one.get("point"), one.get("direction")) for one in table.tables(key)) for key in ("input", "output")
    )
    choice = ResponseChoice(inputs=inputs, outputs=outputs, first=first, last=last, points=table.get("points"))
    return choice, table.get("structural_loss")


def read_order(table: Table, names: Sequence[str]) -> tuple[int, ...] | None:
    """Read [tightening]: the order as indices of bolts, pass after pass; None where it has a fault."""

    def order(value: Any, name: str) -> tuple[int, ...]:
        if not isinstance(value, list) or any(v not in names for v in value) or set(value) != set(names):
            raise InputError(f"{name} = {value!r} should name every bolt: {', '.join(map(repr, names))}")
        return tuple(names.index(v) for v in value)

    found, passes = table.take("order", order), table.get("passes")
    return None if found is None else found * passes


MODES: Declared = {
    "count": Key.count("Number of elastic modes.", 10, most=MAX_MODES),
    "damping": Key.text(
        "Loss of the joints: the same energy per cycle at every frequency, or dampers as in the JK paper, which "
        "depend on the mesh.",
        "hysteretic",
        ("hysteretic", "viscous"),
    ),
    "solver": Key.text("Factorisation; the fastest one found where left out.", None, SOLVERS),
    "shift_frequency": Key.quantity("Hz", "Frequency about which modes are sought; chosen where left out."),
    "levels": Key(
        'a list, such as ["0.1 m/s^2", "1 m/s^2", "10 m/s^2"], or []',
        listed(QUANTITY, 0),
        "Accelerations of the point that moves most, rising, at which damping and frequency are found; [] for none.",
        ModesChoice.levels,
        read=_levels,
        unit="m/s^2",
    ),
    "intervals": Key.truth("Whether each frequency has its interval, and waves are drawn where faces have them.", True),
}
TIGHTENING: Declared = {
    "order": Key("a list that names every bolt", listed(WORDS, 1), "The names of all bolts, in their order.", REQUIRED),
    "passes": Key.count("How often the order is gone through.", 1, most=MOST_PASSES),
}
PLACE: Declared = {"point": Key.point("The point.", REQUIRED), "direction": Key.direction("The direction.", REQUIRED)}
RESPONSE: Declared = {
    "from": Key.quantity("Hz", "First frequency.", REQUIRED),
    "to": Key.quantity("Hz", "Last frequency.", REQUIRED),
    **{
        side: Inner(says=f"A point and a direction of a {what}.", keys=PLACE, many=True, required=True)
        for side, what in (("input", "force"), ("output", "motion"))
    },
    "points": Key.count("Number of frequencies.", 1000, most=MOST_POINTS),
    "structural_loss": Key.within(0, MOST_LOSS, "Loss factor of the parts, also at rest in vibration.", 0.0),
}
