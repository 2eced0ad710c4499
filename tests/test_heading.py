"""Headings of tables: names and units are read or refused, in whatever order and marks they stand."""

import numpy as np
import pytest

from faying.columns import Wanted, read_list, split_heading
from faying.errors import InputError, ReadError
from faying.form.gap_map import read_gap_map, read_heights

PLACE = {"origin": (0, 0, 0), "x_axis": (1, 0, 0), "y_axis": (0, 1, 0)}
WAVY = np.array([(x, y, 1.5 * np.sin(x) + 0.3 * y) for x in range(12) for y in range(9)])  # mm, mm, um


@pytest.mark.parametrize(
    ("line", "cells"),
    [
        ("x [mm],y [mm]", [("x", "mm"), ("y", "mm")]),
        ("x/mm;y / um", [("x", "mm"), ("y", "um")]),
        ('"X (µm)"\t"Gap_width"', [("x", "um"), ("gap width", "")]),
        ("Frequency (Hz) Magnitude (m/(N s^2))", [("frequency", "Hz"), ("magnitude", "m/(N s^2)")]),
        ("h [m/(N*s²)],phase [°],", [("h", "m/(N*s^2)"), ("phase", "deg")]),
    ],
)
def test_headings_come_apart(line, cells):
    if " Magnitude" in line and "," not in line:
        line = line.replace(" Magnitude", "; Magnitude")
    assert [(one.name, one.unit) for one in split_heading(line)] == cells


def written(path, head, order=(0, 1, 2), factors=(1, 1, 1), mark=","):
    table = WAVY[:, order] * np.array(factors)[list(order)]
    path.write_text(head + "\n".join(mark.join(f"{v:.12g}" for v in row) for row in table) + "\n")
    return path


@pytest.mark.parametrize(
    ("head", "order", "factors", "flags"),
    [
        ("", (0, 1, 2), (1, 1, 1), ("mm", "um")),
        ("x [mm],y [mm],z [um]\n", (0, 1, 2), (1, 1, 1), (None, None)),
        ("x [mm],y [mm],z [um]\n", (0, 1, 2), (1, 1, 1), ("mm", "um")),
        ("z (nm);y (m);x (cm)\n", (2, 1, 0), (0.1, 1e-3, 1e3), (None, None)),
        ("# CMM of plate 3\n# Y/mm, Height/mm, X/mm\n", (1, 2, 0), (1, 1, 1e-3), (None, None)),
        ("a title of words\nz,x,y\num,mm,mm\n", (2, 0, 1), (1, 1, 1), (None, None)),
        ("y,z,x\n", (1, 2, 0), (1, 1, 1), ("mm", "um")),
    ],
)
@pytest.mark.parametrize("mark", [",", ";", "\t"])
def test_lists_of_heights_follow_their_heading(tmp_path, head, order, factors, flags, mark):
    path = written(tmp_path / "form.csv", head.replace(",", mark).replace(";", mark), order, factors, mark)
    places, heights = read_heights(path, xy_unit=flags[0], z_unit=flags[1])
    np.testing.assert_allclose(places, 1e-3 * WAVY[:, :2], rtol=1e-10)
    np.testing.assert_allclose(heights, 1e-6 * WAVY[:, 2], rtol=1e-10, atol=1e-18)


@pytest.mark.parametrize(
    ("head", "flags", "fault", "match"),
    [
        ("x [mm],y [mm],z [um]\n", ("m", "m"), InputError, 'the heading says "x .mm." and xy_unit = "m"'),
        ("x [mm],y [mm],z [um]\n", ("mm", "mm"), InputError, 'the heading says "z .um." and z_unit = "mm"'),
        ("x [mm],y [mm],z\n", (None, None), InputError, "states no unit of z; give z_unit"),
        ("", (None, None), InputError, "states no unit of x; give xy_unit"),
        ("x [mm],y [mm],dz [um]\n", (None, None), ReadError, 'line 1: the heading has .*"dz .um." is unknown'),
        ("x [mm],y [mm],z [s]\n", (None, None), ReadError, 'the column "z .s." is not in a unit like m'),
        ("x [mm],x [mm],z [um]\n", (None, None), ReadError, 'the heading has the columns "x .mm.", "x .mm."'),
        ("x,y,z,intensity\n", ("mm", "um"), ReadError, 'of which "intensity" is unknown'),
        ("all units: inch\nplate\n", ("mm", "um"), ReadError, 'line 1: "all units: inch" mentions units'),
        ("# heights in [in]\n", ("mm", "um"), ReadError, "mentions units in words"),
    ],
)
def test_headings_that_are_not_read_are_refused(tmp_path, head, flags, fault, match):
    path = written(tmp_path / "form.csv", head)
    with pytest.raises(fault, match=match):
        read_heights(path, xy_unit=flags[0], z_unit=flags[1])


def test_a_gap_list_follows_its_heading(tmp_path):
    path = written(tmp_path / "gap.csv", "gap [um],x [mm],y [mm]\n", (2, 0, 1))
    found = read_gap_map(path, xy_unit=None, gap_unit=None, **PLACE)
    np.testing.assert_allclose(found.gaps, 1e-6 * WAVY[:, 2], rtol=1e-10, atol=1e-18)
    np.testing.assert_allclose(found.places, 1e-3 * WAVY[:, :2])
    with pytest.raises(ReadError, match='"gap .um.".* is unknown|columns "gap'):
        read_list(path, [Wanted(names=(n,), unit="m", given="mm", key="k") for n in "xyz"], "x, y, z")


@pytest.mark.parametrize("off", [1000.0, -1000.0, 60.0])
@pytest.mark.parametrize("row", [0, 40, 107])
def test_a_point_that_stands_alone_is_named(tmp_path, off, row):
    table = WAVY.copy()
    table[row, 2] += off
    path = tmp_path / "form.csv"
    path.write_text("x [mm],y [mm],z [um]\n" + "\n".join(",".join(map(repr, map(float, r))) for r in table) + "\n")
    with pytest.raises(InputError, match=rf"1 of 108 points are alone; row {row + 1} of the numbers"):
        read_heights(path)


@pytest.mark.parametrize(
    "heights",
    [
        lambda x, y: 0.1 * np.round(x / 30),  # a step in the last digit
        lambda x, y: 30 * np.exp(-((x - 5) ** 2 + (y - 4) ** 2) / 8),  # a bump of several points
        lambda x, y: 20.0 * (x > 5.5),  # a step
        lambda x, y: 0.2 * (x - 5) ** 2 - (y - 4) ** 2,
        lambda x, y: 50.0 * ((x == 3) & (y >= 3) & (y <= 6)) + np.random.default_rng(3).normal(size=np.shape(x)),
    ],
)
def test_forms_with_steps_and_bumps_are_read(tmp_path, heights):
    x, y = WAVY[:, 0], WAVY[:, 1]
    path = tmp_path / "form.csv"
    np.savetxt(path, np.column_stack([x, y, heights(x, y)]), delimiter=",", header="x [mm],y [mm],z [um]", comments="")
    assert len(read_heights(path)[1]) == 108
