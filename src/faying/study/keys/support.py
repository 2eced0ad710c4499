"""[[support]] and [[mass]]: what holds the structure, and what hangs on it."""

from typing import Any

from faying.errors import InputError
from faying.joint.attachments import PointMass, Support
from faying.study.declaration.declared import REQUIRED, Declared, Key, listed
from faying.study.declaration.reader import Table
from faying.study.keys.face import face_name, one_face


def read_support(table: Table) -> Support | None:
    """Read one [[support]]; None where its faults leave none."""
    face = face_name(table, table.where)
    given = {key: table.get(key) for key in ("directions", "stiffness", "point")}
    given["edge"] = face_name(table, f"{table.where}.edge", "edge")
    return None if face is None else table.made(lambda: Support(face=face, **given))


def read_mass(table: Table) -> PointMass | None:
    """Read one [[mass]]; None where its faults leave none."""
    mass, face = table.get("mass"), face_name(table, table.where)
    given = {key: table.get(key) for key in ("point", "offset")}
    return None if mass is None else table.made(lambda: PointMass(mass=mass, face=face, **given))


def _axes(value: Any, name: str) -> tuple[str, ...]:
    if not isinstance(value, list) or not value or any(v not in ("x", "y", "z") for v in value):
        raise InputError(f'{name} = {value!r} should be some of "x", "y", "z" in a list')
    return tuple(value)


SUPPORT: Declared = {
    "face": one_face("The face.", REQUIRED),
    "edge": one_face("Another face of the part: only the edge where the two meet is held."),
    "point": Key.point("Only the node of the face, or of the edge, that is nearest to this place is held."),
    "directions": Key(
        'some of "x", "y", "z" in a list',
        listed({"enum": ["x", "y", "z"]}, 1, 3),
        "Directions in which it is held.",
        ("x", "y", "z"),
        read=_axes,
    ),
    "stiffness": Key.quantity("Pa/m", "Stiffness per area of an elastic foundation; rigid where left out."),
}
MASS: Declared = {
    "mass": Key.quantity("kg", "The mass.", REQUIRED),
    "face": one_face("The face that carries it."),
    "point": Key.point("The point that carries it, in place of a face."),
    "offset": Key.point("From there to its centre of gravity.", (0.0, 0.0, 0.0)),
}
