"""Elements that a round face folds over are made straight, and no others."""

import numpy as np
import pytest

from faying.fe.elements import SOLIDS
from faying.fe.solids import least_jacobian
from faying.fe.straighten import folded, straightened

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], float)


def two_tetrahedra(shift):
    """Two on a common face; the middle of the edge 0-1 of the first is moved by so much along +z."""
    corners = np.array([[0, 1, 2, 3], [4, 2, 1, 3]])
    edges = np.sort(corners[:, np.array(SOLIDS[10].edges)].reshape(-1, 2), axis=1)
    pairs, number = np.unique(edges, axis=0, return_inverse=True)
    middles = CORNERS[pairs].mean(axis=1)
    middles[np.flatnonzero((pairs == [0, 1]).all(axis=1))[0]] += [0, 0, shift]
    cells = np.concatenate([corners, 5 + number.reshape(2, 6)], axis=1)
    return np.concatenate([CORNERS, middles]), cells


@pytest.mark.parametrize("shift", [0.0, 0.05])
def test_elements_that_do_not_fold_stay_as_they_are(shift):
    points, cells = two_tetrahedra(shift)
    found, count, flat = straightened(points, cells)
    assert np.array_equal(found, points)
    assert count == 0
    assert not np.any(flat)


def test_a_folded_element_gets_the_volume_of_its_corners():
    points, cells = two_tetrahedra(0.9)
    assert list(folded(points, cells)) == [True, False]
    found, count, flat = straightened(points, cells)
    assert count == 1
    assert not np.any(flat)
    assert least_jacobian(found, cells) == pytest.approx(least_jacobian(found, cells[:, :4]))
    assert np.array_equal(found[:5], points[:5])


def test_an_element_that_folds_at_the_points_of_its_mass_alone_is_made_straight():
    """Its mass would be negative there, and so would what a finer mesh adds to its stiffness."""
    points, cells = two_tetrahedra(0.38)
    assert np.all(least_jacobian(points, cells) > 0)
    assert least_jacobian(points, cells, of_mass=True)[0] < 0
    found, count, flat = straightened(points, cells)
    assert count == 1
    assert not np.any(flat)
    assert np.all(least_jacobian(found, cells, of_mass=True) > 0)


def test_an_element_without_volume_is_named():
    points, cells = two_tetrahedra(0.0)
    points[3] = [0.3, 0.3, 0.0]  # its corners lie in one plane
    assert list(straightened(points, cells)[2]) == [True, False]
