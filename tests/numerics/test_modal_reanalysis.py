"""Modes under changed springs against modes solved anew."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.sparse import csr_array, diags_array

from faying.errors import NotConverged
from faying.numerics.modal_reanalysis import Measure, ModalReanalysis, _sharper, nearby_modes
from faying.numerics.modes import lowest_modes
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
    near = ModalReanalysis(lowest_modes(K, M, 12, shift_frequency=5.0), K, M, rigid=1)
    changed = chain(1e5 * factor)[0]
    found = near.under(changed, 6, tolerance=tolerance)
    wanted = lowest_modes(changed, M, 7, shift_frequency=5.0).frequencies[1:]
    true = np.abs((found.frequencies[1:] / wanted) ** 2 - 1)
    assert np.all(true <= 1.5 * found.error[1:] + 1e-11)
    assert np.all(found.error[1:] < tolerance)


def test_another_factorisation_on_the_way_changes_nothing_but_the_rounds():
    K, M = chain(1e5)
    modes = lowest_modes(K, M, 12, shift_frequency=5.0)
    near = ModalReanalysis(modes, K, M, rigid=1)
    changed = chain(1e8)[0]
    with pytest.raises(NotConverged, match="changed springs"):
        near.under(changed, 6, tolerance=1e-12, rounds=1)
    near.adopt_factor(factorise((changed + modes.shift * M).tocsr()), changed)
    found = near.under(changed, 6, tolerance=1e-12, rounds=4)
    wanted = lowest_modes(changed, M, 7, shift_frequency=5.0)
    assert found.frequencies[1:] == pytest.approx(wanted.frequencies[1:], rel=1e-11)


def pair(soft, stiff, inside=1e10):
    """Two chains that nothing joins, each held at one end by a spring: no motion of one is of the other."""
    k = np.full(N, 1e6)
    k[0], k[N // 2] = soft, stiff
    k[N // 2 + 1 :] = inside
    main = k + np.append(k[1:], 0)
    main[N // 2 - 1] -= k[N // 2]
    off = -k[1:].copy()
    off[N // 2 - 1] = 0
    return diags_array([off, main, off], offsets=[-1, 0, 1]).tocsr(), diags_array(np.full(N, 0.1)).tocsr()


def at(fraction, count):
    """Spring that puts the second chain, nearly rigid, between modes count - 1 and count of the first."""
    squared = np.linalg.eigvalsh(pair(1e6, 1e10)[0].toarray()[: N // 2, : N // 2]) / 0.1
    return 0.1 * (N // 2) * (squared[count - 2] + fraction * (squared[count - 1] - squared[count - 2]))


BEYOND = at(0.5, 20)  # beyond the basis of the modes before


@pytest.mark.parametrize("fraction", [0.2, 0.5, 0.8, 0.99])
@pytest.mark.parametrize("count", [3, 6])
def test_a_mode_of_another_symmetry_that_comes_down_is_found(fraction, count):
    """None of the modes before has a motion of the second chain, so no residual of theirs shows it."""
    K, M = pair(1e6, BEYOND)
    modes = lowest_modes(K, M, 12, shift_frequency=5.0)
    changed = pair(1e6, at(fraction, count))[0]
    found = ModalReanalysis(modes, K, M, rigid=0).under(changed, count)
    wanted = lowest_modes(changed, M, count, shift_frequency=5.0).frequencies
    assert found.frequencies == pytest.approx(wanted, rel=1e-7)


@pytest.mark.parametrize("inside", [5e7, 2e8])
def test_a_mode_whose_shape_is_not_yet_known_is_watched_above_those_wanted(inside):
    """It bends, so that its first estimate lies above its place, and above the last mode that is asked for."""
    squared = np.linalg.eigvalsh(pair(1e6, 1e10)[0].toarray()[: N // 2, : N // 2]) / 0.1
    target = squared[1] + 0.999 * (squared[2] - squared[1])

    def off(logarithm):
        second = pair(1e6, np.exp(logarithm), inside)[0].toarray()[N // 2 :, N // 2 :]
        return np.linalg.eigvalsh(second)[0] / 0.1 - target

    spring = np.exp(brentq(off, np.log(1e2), np.log(1e9)))
    K, M = pair(1e6, 1e9, inside)
    modes = lowest_modes(K, M, 4, shift_frequency=5.0)
    changed = pair(1e6, spring, inside)[0]
    wanted = lowest_modes(changed, M, 3, shift_frequency=5.0).frequencies
    assert ModalReanalysis(modes, K, M, rigid=0).under(changed, 3).frequencies == pytest.approx(wanted, rel=1e-7)


def test_a_guessed_energy_is_not_below_one_that_others_have_shown():
    """A residual that was stiff and turns soft, in pairs that move alike easily and against each other hardly."""
    block = np.array([[2.0, -1.9], [-1.9, 2.0]])
    K = csr_array(np.kron(np.eye(3), block))
    measure = Measure(K.diagonal(), factorise(K), 3)
    soft, stiff = np.array([1.0, 1.0]), np.array([1.0, -1.0])
    left = np.zeros((6, 3))
    for k, some in enumerate((soft, soft, stiff)):
        left[2 * k : 2 * k + 2, k] = some
    found, _ = measure.solved(left, np.ones(3), np.arange(3))
    assert found == pytest.approx([2 / 0.1, 2 / 0.1, 2 / 3.9], rel=1e-9)
    turned = np.concatenate([np.zeros(4), soft])[:, None]
    assert measure.guessed(turned, np.ones(1), np.array([2]))[0] >= 2 / 0.1


def test_it_is_found_after_a_basis_that_was_cut_back():
    K, M = pair(1e6, BEYOND)
    near = ModalReanalysis(lowest_modes(K, M, 12, shift_frequency=5.0), K, M, rigid=0, most=14)
    for soft, stiff in ((2e6, 2 * BEYOND), (3e5, BEYOND), (1e5, BEYOND), (3e6, BEYOND), (2e5, BEYOND)):
        near.under(pair(soft, stiff)[0], 6)
    near.under(pair(2.02e5, BEYOND)[0], 6, rounds=2)  # what is left of it serves a stiffness nearby at once
    changed = pair(2e6, at(0.5, 4))[0]
    wanted = lowest_modes(changed, M, 6, shift_frequency=5.0).frequencies
    assert near.under(changed, 6).frequencies == pytest.approx(wanted, rel=1e-7)


def test_the_residual_of_a_mode_near_another_must_be_smaller():
    """Ten times the relative distance to the nearest, at most 1; neighbours nearer than the target do no harm."""
    squared = np.array([1.0, 1.002, 3.0, 3.3, 9.0])
    assert _sharper(squared, np.full(4, 1e-6)) == pytest.approx([0.02, 0.02 / 1.002, 1.0, 10 * 0.3 / 3.3], rel=1e-9)
    assert _sharper(squared, np.full(2, 0.1)) == pytest.approx([1.0, 1.0])
