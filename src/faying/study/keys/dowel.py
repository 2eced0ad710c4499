"""[[dowel]]: pins that carry shear between parts."""

from collections.abc import Mapping
from typing import Any

from faying.bolt.dowel import Dowel
from faying.errors import InputError
from faying.materials import CATALOGUE, Material
from faying.study.declaration.declared import QUANTITY, REQUIRED, Declared, Key, listed
from faying.study.declaration.reader import Table
from faying.study.declaration.values import point
from faying.study.keys.face import several_faces, several_names
from faying.study.keys.material import named_material


def read_dowels(tables: list[Table], materials: Mapping[str, Material]) -> tuple[Dowel, ...]:
    """Read every [[dowel]]; a fault is noted where two have one name."""
    found = [_dowel(table, index, materials) for index, table in enumerate(tables)]
    dowels = tuple(dowel for dowel in found if dowel is not None)
    if dowels:
        tables[0].faults.note_alike("dowels", [dowel.name for dowel in dowels])
    return dowels


def _dowel(table: Table, index: int, materials: Mapping[str, Material]) -> Dowel | None:
    """Read one [[dowel]]; None where its faults leave none."""
    name = table.get("name", f"dowel {index + 1}")
    walls = several_names(table, name)
    diameter, ends = table.get("diameter"), table.get("ends")
    material = named_material(table, materials, f"dowel {name!r}")
    if material is None or not walls:
        return None
    return table.made(lambda: Dowel(name, walls, material=material, diameter=diameter, ends=ends))


def _ends(value: Any, name: str) -> tuple[tuple[float, ...], ...]:
    if not isinstance(value, list) or len(value) != 2:
        raise InputError(f"{name} = {value!r} should be a list of two points, where the pin begins and where it ends")
    first, last = (tuple(point(one, f"{name}[{k}]")) for k, one in enumerate(value, 1))
    if first == last:
        raise InputError(f"{name}: both ends are one point; give the points where the pin begins and where it ends")
    return first, last


DOWEL: Declared = {
    "name": Key.text("What tables call it.", "dowel 1"),
    "walls": several_faces("The walls of the holes that it fits without play, one on each part.", REQUIRED),
    "material": Key.text("Material of the pin.", REQUIRED, examples=lambda: CATALOGUE),
    "diameter": Key.quantity("m", "Diameter of the pin; that of its first hole where left out."),
    "ends": Key(
        'two points, for example [["0 mm", "0 mm", "0 mm"], ["0 mm", "0 mm", "20 mm"]]',
        listed(listed(QUANTITY, 3, 3), 2, 2),
        "Points of the axis where the pin begins and ends; where its holes do, if left out.",
        read=_ends,
        unit="m",
    ),
}
