"""[[load]]: load cases on the preloaded structure."""

from collections.abc import Callable, Sequence
from typing import Any

from faying.errors import InputError
from faying.study.declaration.declared import QUANTITY, REQUIRED, Declared, Inner, Key
from faying.study.declaration.reader import Made, Table
from faying.study.declaration.values import number, quantity
from faying.study.keys.face import face_name, one_face
from faying.study.load import (
    COLDEST,
    MAX_CYCLES,
    MAX_FACTOR,
    MAX_INCREMENTS,
    NOTHING,
    WARMEST,
    Displacement,
    Force,
    Load,
    Pressure,
    in_order,
)

EXAMPLES = {
    "N": '["0 N", "0 N", "5 kN"]',
    "N*m": '["0 N*m", "20 N*m", "0 N*m"]',
    "m": '["0 mm", "0 mm", "0.1 mm"]',
    "m/s^2": '["0 m/s^2", "0 m/s^2", "98.1 m/s^2"]',
}
CHANGES = 'changes by part or bolt, for example {plate = "60 K"}'
FACTORS = 'factors by load, for example {"10 g" = 1.5}'


def read_loads(tables: Sequence[Table]) -> tuple[Load, ...]:
    """Read all [[load]]; a fault is noted where cases name what is not there, or each other in a circle."""
    found = tuple(load for load in map(_read, tables) if load is not None)
    if len(found) == len(tables) and tables:
        try:
            in_order(found)
        except InputError as fault:
            tables[0].faults.add(str(fault))
    return found


def _read(table: Table) -> Load | None:
    name = table.get("name")
    forces = [_force(one, f"{table.where} force {k}") for k, one in enumerate(table.tables("force"), 1)]
    pressures = _on_faces(table, "pressure", Pressure)
    moves = _on_faces(table, "displacement", Displacement)
    acceleration = table.get("acceleration") or NOTHING
    more = {key: table.get(key) for key in ("temperature", "combine", "after", "increments", "cycles")}
    if name is None or None in forces or None in pressures or None in moves:
        return None
    return table.made(
        lambda: Load(
            name,
            forces=[one for one in forces if one is not None],
            pressures=[one for one in pressures if one is not None],
            acceleration=acceleration,
            displacements=[one for one in moves if one is not None],
            **more,
        )
    )


def _force(table: Table, label: str) -> Force | None:
    face = face_name(table, label)
    force, moment = (table.get(key) or NOTHING for key in ("force", "moment"))
    place = table.get("point")
    return table.made(lambda: Force(face, force=force, moment=moment, point=place))


def _on_faces(table: Table, key: str, make: Callable[[str, Any], Made]) -> list[Made | None]:
    """What `make` makes of the face and the value of each table of a key; None where a fault leaves one of them out."""
    out: list[Made | None] = []
    for k, one in enumerate(table.tables(key), 1):
        face, value = face_name(one, f"{table.where} {key} {k}"), one.get(key)
        out.append(None if face is None or value is None else make(face, value))
    return out


def _by_name(form: str, read: Callable[[Any, str], float]) -> Callable[[Any, str], dict[str, float]]:
    def convert(value: Any, name: str) -> dict[str, float]:
        if not isinstance(value, dict) or not value:
            raise InputError(f"{name} = {value!r} should be {form}")
        return {key: read(one, f"{name}.{key}") for key, one in value.items()}

    return convert


def _three(unit: str, says: str, default: Any = None) -> Key:
    return Key.quantities(f"three components, for example {EXAMPLES[unit]}", unit, 3, says, default)


LOAD: Declared = {
    "name": Key.text("What tables call the case.", REQUIRED),
    "force": Inner(
        says="A force and a moment on a face, or a force at a point.",
        many=True,
        keys={
            "face": one_face("The face, over which the force is spread without stiffening it."),
            "force": _three("N", "Components along x, y and z."),
            "moment": _three("N*m", "Components about x, y and z; on a face alone."),
            "point": Key.point(
                "Point that the force goes through, also apart from the face; the centre of the face "
                "where left out. Without a face: the force acts on the node nearest to it."
            ),
        },
    ),
    "pressure": Inner(
        says="An even pressure on a face.",
        many=True,
        keys={
            "face": one_face("The face.", REQUIRED),
            "pressure": Key.quantity(
                "Pa", "Above 0 it presses on the face, below 0 it pulls.", REQUIRED, positive=False
            ),
        },
    ),
    "displacement": Inner(
        says="A displacement of a face that a [[support]] without stiffness holds.",
        many=True,
        keys={
            "face": one_face("The face.", REQUIRED),
            "displacement": _three(
                "m", "Components along x, y and z; 0 where the support leaves the face free.", REQUIRED
            ),
        },
    ),
    "acceleration": _three(
        "m/s^2",
        "Acceleration of the whole structure along x, y and z; the inertia of parts, bolts and masses pulls the other "
        "way.",
    ),
    "temperature": Key(
        CHANGES,
        {"type": "object", "additionalProperties": QUANTITY},
        "Change of temperature since the bolts were tightened, by the name of the part or bolt.",
        {},
        read=_by_name(CHANGES, lambda value, name: quantity(value, "K", name, positive=False)),
        unit="K",
        allowed=f"{COLDEST:g} K to {WARMEST:g} K",
    ),
    "combine": Key(
        FACTORS,
        {"type": "object", "additionalProperties": {"type": "number", "minimum": -MAX_FACTOR, "maximum": MAX_FACTOR}},
        "Factors by the names of other cases, whose loads act here too.",
        {},
        read=_by_name(FACTORS, number),
        allowed=f"{-MAX_FACTOR:g} to {MAX_FACTOR:g}",
    ),
    "after": Key.text(
        "Case from whose state this one starts: its load gives way to this one. The preload where left out."
    ),
    "increments": Key.count(
        "Into how many parts the way to the load is cut where a joint has friction.", 4, most=MAX_INCREMENTS
    ),
    "cycles": Key.within(
        0,
        MAX_CYCLES,
        "How often this load comes and goes, from the state that it starts from; fatigues the bolts.",
        0.0,
    ),
}
