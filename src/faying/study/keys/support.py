"""[[support]] and [[mass]]: what holds the structure, and what hangs on it."""

from typing import Any

from faying.errors import InputError
from faying.joint.attachments import PointMass, Support
from faying.study.keys.face import face_name
from faying.study.keys.reader import Table, point


def read_support(table: Table) -> Support | None:
    """Read one [[support]]; None where its faults leave none."""

    def axes(value: Any, name: str) -> tuple[str, ...]:
        if not isinstance(value, list) or not value or any(v not in ("x", "y", "z") for v in value):
            raise InputError(f'{name} = {value!r} should be some of "x", "y", "z" in a list')
        return tuple(value)

    face, directions = face_name(table, "face", table.where), table.take("directions", axes, ("x", "y", "z"))
    stiffness = table.quantity("stiffness", "Pa/m", None)
    table.close()
    if face is None:
        return None
    return table.made(lambda: Support(face=face, directions=directions, stiffness=stiffness))


def read_mass(table: Table) -> PointMass | None:
    """Read one [[mass]]; None where its faults leave none."""
    mass, face = table.quantity("mass", "kg"), face_name(table, "face", table.where, required=False)
    place = table.take("point", point, None)
    offset = table.take("offset", point, (0.0, 0.0, 0.0))
    table.close()
    if mass is None:
        return None
    return table.made(lambda: PointMass(mass=mass, face=face, point=place, offset=offset))
