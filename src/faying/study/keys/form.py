"""[joint.form]: the form of the two faces of a joint, named shapes, waves, a random form, measured maps."""

from typing import Any

from faying.form.form import PARAMETERS, Form
from faying.form.gap_map import FaceMap, GapMap, read_gap_map, read_heights
from faying.study.keys.reader import Table, direction, point
from faying.study.keys.waviness import read_waviness


def read_form(table: Table | None) -> Form | None:
    """Read [joint.form]; None where there is none."""
    if table is None:
        return None
    _note_flat(table)
    given = {name: table.parameter(name, parameter) for name, parameter in PARAMETERS.items()}
    along = table.take("along", direction, None)
    gap, first, second = table.table("gap"), table.table("first"), table.table("second")
    maps: dict[str, Any] = {
        "gap": None if gap is None else _gap(gap),
        "first": None if first is None else _face(first),
        "second": None if second is None else _face(second),
        "waviness": read_waviness(table.table("waviness")),
    }
    table.close()
    values = {name: value for name, value in given.items() if value is not None}
    return table.made(lambda: Form(**values, along=along, **maps))


def _note_flat(table: Table) -> None:
    """Take `flat`, and note where it stands beside a form."""
    others = [key for key in table.data if key != "flat"]
    if table.truth("flat", False) and others:
        table.faults.add(f"{table.where}: flat = true says that the faces have no form; leave out {', '.join(others)}")


def _gap(table: Table) -> GapMap | None:
    """Read the map of a gap: CSV or text of x, y, gap, with the units of the columns and the place of their axes."""
    file = table.file("file")
    xy, gap = table.text("xy_unit", None), table.text("gap_unit", None)
    origin = table.take("origin", point, (0.0, 0.0, 0.0))
    x_axis = table.take("x_axis", direction, (1.0, 0.0, 0.0))
    y_axis = table.take("y_axis", direction, (0.0, 1.0, 0.0))
    table.close()
    if file is None:
        return None
    return table.made(lambda: read_gap_map(file, xy_unit=xy, gap_unit=gap, origin=origin, x_axis=x_axis, y_axis=y_axis))


def _face(table: Table) -> FaceMap | None:
    """Read the heights of one face: a list of points or a scan, and where it lies."""
    file = table.file("file")
    xy, z = table.text("xy_unit", None), table.text("z_unit", None)
    origin, x_axis = table.take("origin", point, None), table.take("x_axis", direction, None)
    y_axis = table.take("y_axis", direction, None)
    table.close()
    if file is None:
        return None

    def made() -> FaceMap:
        places, heights = read_heights(file, xy_unit=xy, z_unit=z)
        return FaceMap(places=places, heights=heights, origin=origin, x_axis=x_axis, y_axis=y_axis)

    return table.made(made)
