"""Gap maps: interpolation, axes, what lies outside, and a wedge between two plates."""

import numpy as np
import pytest

import faying
from faying.columns import read_numbers
from faying.form.form import Form
from faying.form.gap_map import GapMap, read_gap_map
from tests.helpers.plates import plates, stacked

GRID = np.stack(np.meshgrid(np.linspace(0, 0.08, 9), np.linspace(0, 0.04, 5), indexing="ij"), -1).reshape(-1, 2)
ARGUMENTS = {
    "xy_unit": "mm",
    "gap_unit": "um",
    "origin": (0.0, 0.0, 0.0),
    "x_axis": (1.0, 0.0, 0.0),
    "y_axis": (0.0, 1.0, 0.0),
}


def test_a_plane_is_followed_exactly_in_any_axes():
    gaps = 1e-6 + 3e-5 * GRID[:, 0] - 1e-5 * GRID[:, 1]
    turned = GapMap(places=GRID, gaps=gaps, origin=(1.0, 2.0, 3.0), x_axis=(0.0, 2.0, 0.0), y_axis=(0.0, 0.0, -1.0))
    places = np.random.default_rng(1).uniform([0, 0], [0.08, 0.04], (50, 2))
    positions = np.array([1.0, 2.0, 3.0]) + places[:, :1] * [0, 1, 0] + places[:, 1:] * [0, 0, -1]
    assert turned.at(positions) == pytest.approx(1e-6 + 3e-5 * places[:, 0] - 1e-5 * places[:, 1], abs=1e-15)


def test_missing_points_are_bridged_and_the_rim_takes_the_nearest():
    gaps = np.full(len(GRID), 2e-6)
    gaps[[0, 7, 20]] = np.nan
    found = GapMap(places=GRID, gaps=gaps).at(np.array([[0.0, 0.0, 0.0], [0.03, 0.02, 0.0], [-0.005, 0.02, 0.0]]))
    assert found == pytest.approx([2e-6] * 3)


def test_a_place_that_was_measured_twice_has_the_mean_of_both():
    gaps = np.linspace(0.0, 1e-5, len(GRID))
    twice = GapMap(places=np.concatenate([GRID, GRID[:3]]), gaps=np.concatenate([gaps, gaps[:3] + 2e-6]))
    at = np.column_stack([GRID, np.zeros(len(GRID))])
    shift = np.where(np.arange(len(GRID)) < 3, 1e-6, 0.0)
    np.testing.assert_allclose(twice.at(at), gaps + shift, rtol=1e-12, atol=1e-18)


def test_the_gap_adds_to_that_of_the_geometry():
    structure = plates(stacked(gap=1e-6))
    joint = structure.joints[0]
    form = Form(gap=GapMap(places=GRID, gaps=np.full(len(GRID), 3e-6)))
    with_map = form.on(joint.interface, structure.mesh, joint.faces)
    assert with_map.gap == pytest.approx(np.full(len(with_map.gap), 4e-6), rel=1e-6)


def test_files(tmp_path):
    file = tmp_path / "map.txt"
    file.write_text("x [mm], y [mm], gap [um]\n# comment\n0, 0, 1\n80, 0, 2\n\n0; 40; nan\n0 40 1\n80 40 2\n")
    found = read_gap_map(file, **ARGUMENTS)
    assert found.at(np.array([[0.04, 0.02, 0.0]])) == pytest.approx([1.5e-6])
    file.write_text("only words\n")
    with pytest.raises(faying.ReadError, match="has no line of 3 numbers; a gap map has the columns x, y, gap"):
        read_gap_map(file, **ARGUMENTS)
    file.write_text("0 0 1\n80 0\n")
    with pytest.raises(faying.ReadError, match="line 2: '80 0' is not 3 numbers"):
        read_numbers(file, 3, "x")
    file.write_text("0 0 1\n80 0 nan\n80 1 1\n3 3 3\n")
    with pytest.raises(faying.InputError, match="3 points with numbers; a map needs four or more"):
        read_gap_map(file, **ARGUMENTS)


def test_messages():
    good = np.full(len(GRID), 1e-6)
    with pytest.raises(faying.InputError, match="not at right angles"):
        GapMap(places=GRID, gaps=good, y_axis=(1.0, 1.0, 0.0)).at(np.zeros((1, 3)))
    with pytest.raises(faying.InputError, match=r"100% of the joint is far from the map, which covers 0 to 80 mm"):
        GapMap(places=GRID, gaps=good).at(np.full((5, 3), 3.0))
    line = np.stack([np.linspace(0, 1, 6), np.zeros(6)], axis=1)
    with pytest.raises(faying.InputError, match="are on one line"):
        GapMap(places=line, gaps=np.ones(6)).at(np.array([[0.5, 0.0, 0.0]]))
