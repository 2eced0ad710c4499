"""Pairing by frequency and visibility, and following modes: crossings, missing and spurious modes."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brute
from scipy.sparse import diags_array

import faying
from faying.measured.mac import mac
from faying.measured.pairing import by_track, changes, follow, pair_frequencies

FULL = np.ones((2, 4))


def chain(stiff, coupling):
    """Two oscillators of different mass with a weak spring: shapes (2, 2), frequencies; they veer where k/m agree."""
    K = np.array([[1.0 + coupling, -coupling], [-coupling, stiff + coupling]])
    values, vectors = eigh(K, np.diag([1.0, 4.0]))
    return np.sqrt(values), vectors.T


def test_weighted_mac_of_modes_is_the_unit_matrix():
    """Modes are orthogonal in the mass: unweighted, two of unequal masses look alike."""
    _, shapes = chain(8.0, 1.0)
    mass = diags_array([1.0, 4.0])
    assert mac(shapes, shapes, mass) == pytest.approx(np.eye(2), abs=1e-12)
    assert mac(shapes, shapes)[0, 1] > 0.1
    turned = shapes * np.exp(1j * np.array([0.3, 2.0]))[:, None] * 5
    assert mac(turned, shapes, mass) == pytest.approx(np.eye(2), abs=1e-12)
    assert mac(np.zeros((1, 2)), shapes, mass) == pytest.approx(np.zeros((1, 2)))


def test_crossing_modes_are_followed_and_named():
    mass = diags_array([1.0, 4.0])
    steps = [chain(stiff, 1e-6) for stiff in (3.0, 5.0)]  # k/m of the second passes that of the first at 4
    table = mac(steps[0][1], steps[1][1], mass)
    tracks = follow([table])
    assert tracks.tolist() == [[0, 1], [1, 0]]
    assert changes([table]) == ([(0, 0, 1)], [])
    followed = by_track(tracks, np.stack([f for f, _ in steps]))
    assert followed[:, 1] == pytest.approx([1, 1], rel=1e-5)  # the oscillator that nothing has changed


def test_coupled_modes_are_named():
    mass = diags_array([1.0, 4.0])
    shapes = [chain(stiff, 0.2)[1] for stiff in (2.0, 4.0, 6.0)]  # they veer in the middle
    _, couple = changes([mac(a, b, mass) for a, b in pairwise(shapes)])
    assert {(i, j) for _, i, j in couple} == {(0, 1)}


def test_a_model_that_is_a_little_off_pairs_in_order():
    test = np.array([[100.0, 200, 300], [101, 203, 306]])
    model = np.array([[104.0, 207, 310, 380], [105, 210, 317, 381]])
    assert pair_frequencies(test, model, FULL).tolist() == [0, 1, 2]


def test_crossing_modes_pair_as_one_mode_over_both_loads():
    """By order at each load alone, both would change partners at the second."""
    test = np.array([[100.0, 110], [120, 111]])
    model = np.array([[101.0, 112, 300, 400], [122, 113, 300, 400]])
    assert pair_frequencies(test, model, FULL).tolist() == [0, 1]


def test_a_missing_test_mode_and_a_spurious_one():
    model = np.array([[100.0, 200, 300, 400]] * 2)
    assert pair_frequencies(np.array([[101.0, 303], [101, 303]]), model, FULL).tolist() == [0, 2]
    assert pair_frequencies(np.array([[101.0, 145, 202], [101, 145, 202]]), model, FULL).tolist() == [0, -1, 1]


def test_modes_that_the_test_cannot_see_are_passed_over():
    test, model = np.array([[100.0, 200]] * 2), np.array([[99.0, 101, 198, 400]] * 2)
    dark = np.array([[0.02, 0.8, 1.0, 1.0]] * 2)
    assert pair_frequencies(test, model, dark).tolist() == [1, 2]
    dim = np.array([[0.15, 1.0, 1.0, 1.0]] * 2)  # as near in frequency, but hardly moving
    assert pair_frequencies(test, model, dim).tolist() == [1, 2]


def test_a_twist_lets_the_test_see_a_little_of_modes_across_it():
    """T-specimen with a crown of 12 um and a twist of 4 um at 8 kN: bending modes keep 98 % of their shape (MAC with
    the flat joint), and modes across the width move a tenth as much at the point of the test, one of them nearer to a
    test frequency than the mode that it is."""
    test = np.array([[410.0, 1135, 2175, 3285, 4725]])
    model = np.array([[408.1, 446.9, 1117.0, 1298.7, 1868.8, 2053.4, 2221.0, 2880.9, 3115.8, 3251.9, 3790.2, 4692.4]])
    seen = np.array([[1.0, 0.126, 0.984, 0, 0, 0.960, 0.103, 0, 0, 0.914, 0, 0.908]])
    assert pair_frequencies(test, model, seen).tolist() == [0, 2, 5, 9, 11]


def test_the_assignment_has_the_least_stated_cost():
    generator = np.random.default_rng(4)
    for _ in range(20):
        test, model = (np.sort(generator.uniform(100, 200, (1, n))) for n in (3, 4))
        seen = generator.uniform(0.05, 1, (1, 4))
        alone = (np.log(1.3) / 0.05) ** 2 + 2

        def cost(places, test=test, model=model, seen=seen, alone=alone):
            total, chosen = 0.0, [int(p) for p in places]
            if len({p for p in chosen if p >= 0}) < sum(p >= 0 for p in chosen):
                return np.inf
            for t, m in enumerate(chosen):
                apart = 0.0 if m < 0 else np.log(model[0, m] / test[0, t])
                if m >= 0 and (abs(apart) > np.log(1.3) or seen[0, m] < 0.1):
                    return np.inf
                total += alone if m < 0 else (apart / 0.05) ** 2 - 2 * np.log10(seen[0, m])
            return total

        best = brute(cost, [slice(-1, 4)] * 3, finish=None)
        assert cost(pair_frequencies(test, model, seen)) == pytest.approx(cost(best), rel=1e-12)


def test_degrees_of_freedom_must_agree():
    with pytest.raises(faying.InputError, match="degrees of freedom"):
        mac(np.ones((1, 2)), np.ones((1, 3)), np.eye(2))
