"""Modes under changed springs against modes solved anew."""

import numpy as np
import pytest
from scipy.sparse import diags_array

from faying.errors import NotConverged
from faying.numerics.modes import lowest_modes
from faying.numerics.nearby import NearbyModes, nearby_modes
from faying.numerics.solve import factorise

N = 60


def chain(joint):
    """Two free chains of N/2 masses each, joined by one spring."""
    k = np.full(N - 1, 1e6)
    k[N // 2 - 1] = joint
    main = np.concatenate([k, [0]]) + np.concatenate([[0], k])
    return diags_array([-k, main, -k], offsets=[-1, 0, 1]).tocsr(), diags_array(np.full(N, 0.1)).tocsr()


@pytest.mark.parametrize("factor", [0.5, 2.0, 1e-2, 1e3])
def test_a_changed_spring_gives_the_modes_of_a_new_solution(factor):
    K, M = chain(1e5)
    modes = lowest_modes(K, M, 12, shift_frequency=5.0)
    changed = chain(1e5 * factor)[0]
    found, shapes = nearby_modes(modes, changed, M, rigid=1, count=6)
    wanted = lowest_modes(changed, M, 7, shift_frequency=5.0)
    assert found == pytest.approx(wanted.frequencies[1:], rel=1e-7)
    overlap = np.abs(np.einsum("im,im->m", shapes, M @ wanted.shapes[:, 1:]))
    assert overlap == pytest.approx(np.ones(6), abs=1e-3)


def test_the_same_spring_gives_the_same_modes():
    K, M = chain(1e5)
    modes = lowest_modes(K, M, 8, shift_frequency=5.0)
    assert nearby_modes(modes, K, M, rigid=1, count=5)[0] == pytest.approx(modes.frequencies[1:6], rel=1e-10)


@pytest.mark.parametrize("factor", [0.5, 2.0, 1e-2, 1e3])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
def test_the_error_that_is_said_is_not_much_less_than_the_true_one(factor, tolerance):
    """Also where it was taken from the diagonal; the inverse that measures it leaves out what lies near a mode."""
    K, M = chain(1e5)
    near = NearbyModes(lowest_modes(K, M, 12, shift_frequency=5.0), K, M, rigid=1)
    changed = chain(1e5 * factor)[0]
    found = near.under(changed, 6, tolerance=tolerance)
    wanted = lowest_modes(changed, M, 7, shift_frequency=5.0).frequencies[1:]
    true = np.abs((found.frequencies[1:] / wanted) ** 2 - 1)
    assert np.all(true <= 1.5 * found.error[1:] + 1e-11)
    assert np.all(found.error[1:] < tolerance)


def test_another_factorisation_on_the_way_changes_nothing_but_the_rounds():
    K, M = chain(1e5)
    modes = lowest_modes(K, M, 12, shift_frequency=5.0)
    near = NearbyModes(modes, K, M, rigid=1)
    changed = chain(1e8)[0]
    with pytest.raises(NotConverged, match="changed springs"):
        near.under(changed, 6, tolerance=1e-12, rounds=1)
    near.take(factorise((changed + modes.shift * M).tocsr()), changed)
    found = near.under(changed, 6, tolerance=1e-12, rounds=4)
    wanted = lowest_modes(changed, M, 7, shift_frequency=5.0)
    assert found.frequencies[1:] == pytest.approx(wanted.frequencies[1:], rel=1e-11)
