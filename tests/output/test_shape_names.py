"""Names of mode shapes and axes of faces, against motions that are known."""

import numpy as np
import pytest

from faying.joint.figure import in_plane
from faying.result.shape_names import long_shape, shape_name
from tests.helpers.scenes import two_boxes

GRID = np.stack(np.meshgrid(np.linspace(0, 1, 33), np.linspace(-0.05, 0.05, 3), np.linspace(-0.1, 0.1, 3)), -1)
POINTS = GRID.reshape(-1, 3)
X, Y, Z = POINTS.T
WAVE, SLOPE = np.cos(3 * np.pi * X), -3 * np.pi * np.sin(3 * np.pi * X)
NONE = np.zeros_like(X)


@pytest.mark.parametrize(
    ("motion", "name"),
    [
        ((-Y * SLOPE, WAVE, NONE), "bending, y"),  # Euler and Bernoulli: sections stay square to the axis
        ((-Z * SLOPE, NONE, WAVE), "bending, z"),
        ((WAVE, NONE, NONE), "stretch"),
        ((NONE, -Z * WAVE, Y * WAVE), "torsion"),
        ((WAVE, WAVE, NONE), ""),  # half of each: no one word
        ((NONE, NONE, NONE), ""),
    ],
)
def test_motions_of_a_beam_have_their_names(motion, name):
    assert long_shape(POINTS, np.stack(motion, axis=1)) == name


def test_a_name_does_not_depend_on_where_nodes_lie_densely():
    """Ten times the nodes at one end, which only translates there."""
    motion = np.stack([-Y * SLOPE, WAVE, NONE], axis=1)
    near = X < 0.1
    again = np.concatenate([POINTS, np.repeat(POINTS[near], 10, axis=0)])
    assert long_shape(again, np.concatenate([motion, np.repeat(motion[near], 10, axis=0)])) == "bending, y"


def test_a_short_structure_is_named_by_part_and_axis():
    cube = POINTS * (0.1, 1, 1)
    assert long_shape(cube, np.stack([NONE, WAVE, NONE], axis=1)) == ""
    short = two_boxes(lengths=(0.05, 0.04))
    assert shape_name(short, 0) == "both, z"


def test_a_tilted_face_is_drawn_in_its_own_plane():
    """Distances on the face stay; a face across an axis keeps the coordinates of the model."""
    rng = np.random.default_rng(0)
    flat = np.column_stack([rng.uniform(0, 0.1, (40, 2)), np.zeros(40)])
    same, names = in_plane(flat)
    assert names == ("x", "y")
    np.testing.assert_array_equal(same, flat[:, :2])
    c, s = np.cos(0.6), np.sin(0.6)
    tilted, names = in_plane(flat @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]))
    assert names == ("along y", "across")
    np.testing.assert_allclose(tilted[:, 0], flat[:, 1] - flat[:, 1].mean(), atol=1e-12)
    np.testing.assert_allclose(np.ptp(tilted, axis=0), np.ptp(flat[:, 1::-1], axis=0), atol=1e-12)
