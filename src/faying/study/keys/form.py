"""[joint.form]: the form of the two faces of a joint, named shapes, waves, a random form, measured maps."""

from typing import Any

from faying.form.form import PARAMETERS, Form
from faying.form.gap_map import FaceMap, GapMap, read_gap_map, read_heights
from faying.study.declaration.declared import REQUIRED, Declared, Inner, Key
from faying.study.declaration.reader import Table
from faying.study.keys.waviness import WAVINESS, read_waviness


def read_form(table: Table) -> Form | None:
    """Read [joint.form]; None where its faults leave none."""
    others = [key for key in table.data if key != "flat"]
    if table.get("flat") and others:
        table.faults.add(f"{table.where}: flat = true says that the faces have no form; leave out {', '.join(others)}")
    for key, shape in (("seed", "flatness"), ("wave_length", "wave")):
        if key in table.data and shape not in table.data:
            table.faults.add(f"{table.where}.{key} belongs to {shape}, which is missing; give that, or leave {key} out")
    given = {name: table.get(name) for name in PARAMETERS}
    along = table.get("along")
    maps: dict[str, Any] = {
        "gap": table.inner("gap", _gap),
        "first": table.inner("first", _face),
        "second": table.inner("second", _face),
        "waviness": table.inner("waviness", read_waviness),
    }
    if not {*others} - {"seed", "wave_length", "along"} and not table.get("flat"):
        if "along" in others:
            table.faults.add(f"{table.where}.along turns a shape, and none is given; give one, or leave along out")
        return None
    values = {name: value for name, value in given.items() if value is not None}
    return table.made(lambda: Form(**values, along=along, **maps))


def _gap(table: Table) -> GapMap | None:
    """Read the map of a gap: CSV or text of x, y, gap, with the units of the columns and the place of their axes."""
    given = {key: table.get(key) for key in GAP}
    path = given.pop("file")
    return None if path is None else table.made(lambda: read_gap_map(path, **given))


def _face(table: Table) -> FaceMap | None:
    """Read the heights of one face: a list of points or a scan, and where it lies."""
    given = {key: table.get(key) for key in HEIGHTS}
    if given["file"] is None:
        return None

    def made() -> FaceMap:
        path, xy, z = (given.pop(key) for key in ("file", "xy_unit", "z_unit"))
        places, heights = read_heights(path, xy_unit=xy, z_unit=z, channel=given.pop("channel"))
        return FaceMap(places=places, heights=heights, **given)

    return table.made(made)


GAP: Declared = {
    "file": Key.file("Table of x, y, gap.", REQUIRED),
    "xy_unit": Key.length_unit("Unit of x and y, where the heading of the file states none."),
    "gap_unit": Key.text("Unit of the gap, where the heading of the file states none."),
    "origin": Key.point("Point of the structure at which x = y = 0.", (0.0, 0.0, 0.0)),
    "x_axis": Key.direction("Direction of x.", (1.0, 0.0, 0.0)),
    "y_axis": Key.direction("Direction of y.", (0.0, 1.0, 0.0)),
}
HEIGHTS: Declared = {
    "file": Key.file("Scan, or table of x, y, z.", REQUIRED),
    "xy_unit": Key.length_unit("Unit of x and y, where the file states none."),
    "z_unit": Key.length_unit("Unit of the heights, where the file states none."),
    "channel": Key.text("Name of the map of heights, where the file of the scan holds several.", None),
    "origin": Key.point(
        "Point at which x = y = 0; the middle of the map lies on the middle of the joint where left out."
    ),
    "x_axis": Key.direction("Direction of x; the longer side of the face where left out."),
    "y_axis": Key.direction("Direction of y; as seen from outside the face where left out."),
}
FORM: Declared = {
    "flat": Key.truth("The faces are flat: neither form nor waves. Stands alone."),
    **{name: Key.of_parameter(parameter) for name, parameter in PARAMETERS.items()},
    "along": Key.direction("Direction of the longer side, where the face is as long as wide."),
    "gap": Inner(says="A measured gap between the faces.", keys=GAP),
    "first": Inner(says="Measured heights of the first face.", keys=HEIGHTS),
    "second": Inner(says="Measured heights of the second face.", keys=HEIGHTS),
    "waviness": Inner(
        says=(
            "Random waves between the scan and the form of the face. The size is said in one way: Wq, Wa, flatness, "
            "process or from."
        ),
        keys=WAVINESS,
    ),
}
