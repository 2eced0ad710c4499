"""Which mode is which after a change, against modes that are followed in small steps, and in closed form."""

import numpy as np
import pytest
from scipy.linalg import eigh

from faying.numerics.follow import between_by_rank, follow, may_cross, same_group


def oscillators(stiffness):
    """Modes of masses on springs to the ground with weak springs between neighbours: frequencies, shapes."""
    K = np.diag(np.asarray(stiffness, float))
    for k in range(len(K) - 1):
        K[k, k] += 1e-7
        K[k + 1, k + 1] += 1e-7
        K[k, k + 1] = K[k + 1, k] = -1e-7
    values, shapes = eigh(K, np.diag([1.0, 2.0, 1.5][: len(K)]))
    return np.sqrt(values), shapes


MASS = np.diag([1.0, 2.0, 1.5])


@pytest.mark.parametrize(
    "last", [(9.0, 4.0, 6.0), (1.0, 14.0, 2.0), (6.0, 2.0, 12.0), (8.0, 6.5, 9.5), (1.5, 7.0, 10.0)]
)
def test_modes_keep_their_shapes_through_crossings(last):
    """The product of small steps, in each of which the nearest shape is plain, and one step over all of them."""
    first = np.array([1.0, 6.0, 9.0])
    before, shapes = oscillators(first)
    order, at = np.arange(3), shapes
    for share in np.linspace(0, 1, 384)[1:]:
        _, new = oscillators(first + share * (np.array(last) - first))
        step = np.abs(at.T @ MASS @ new).argmax(axis=1)
        order, at = step[order], new
    after, moved = oscillators(last)
    found = follow(shapes, moved, MASS, before)
    assert list(found) == list(order)
    rising = np.all(np.array(last) >= first)
    assert not rising or may_cross(before, after) == (list(order) != [0, 1, 2])


def test_twins_are_followed_as_a_plane():
    """A third mode passes twins whose directions turn by 40 degrees: it keeps its own place."""
    turn = np.deg2rad(40)
    twins = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1.0]])
    before = np.array([100.0, 100.001, 130.0])
    after = twins[:, [2, 0, 1]]  # torsion is the lowest now
    found = follow(np.eye(3), after, np.eye(3), before)
    assert sorted(found[:2]) == [1, 2]
    assert found[2] == 0
    assert may_cross(before, np.array([90.0, 105.0, 105.001]))


def test_twins_are_followed_by_all_that_lies_in_their_plane():
    """They turn by 45 degrees and a tenth of each leaves the plane: neither has half of one, both have 0.9 of it."""
    c, s = np.sqrt(0.45), np.sqrt(0.1)
    first, second, other = (c, c, 0, s, 0, 0), (c, -c, 0, 0, s, 0), (0, 0, 0, 0, 0, 1)
    after = np.array([other, first, second]).T  # the third left, another one is the lowest now
    assert follow(np.eye(6)[:, :3], after, np.eye(6), np.array([100.0, 100.001, 130.0])).tolist() == [1, 2, 0]


def test_a_mode_that_left_the_range_takes_the_place_that_is_left():
    other = np.eye(4)[:, [0, 1, 3]]  # the third shape is gone, a new one came
    assert list(follow(np.eye(4)[:, :3], other, np.eye(4), np.array([1.0, 2.0, 3.0]))) == [0, 1, 2]


def test_ranges_that_are_apart_cannot_cross():
    assert not may_cross(np.array([1.0, 2.0, 4.0]), np.array([1.5, 2.5, 5.0]))
    assert may_cross(np.array([1.0, 2.0, 4.0]), np.array([2.1, 2.5, 5.0]))


@pytest.mark.parametrize("turned", [0.0, 0.7, 1.5])
def test_twins_stay_in_the_order_of_their_frequencies(turned):
    """The directions in their plane are arbitrary; the third mode falls below both."""
    c, s = np.cos(turned), np.sin(turned)
    before = np.eye(4)[:, :3]
    after = np.array([[0, c, -s], [0, s, c], [1, 0, 0], [0, 0, 0]], dtype=float)
    assert follow(before, after, np.eye(4), np.array([100.0, 100.01, 105.0])).tolist() == [1, 2, 0]


def test_a_stiffer_joint_bounds_frequencies_by_rank_and_not_those_of_modes():
    """Oscillators whose first passes the others: the bounds of the order leave each where it is."""
    soft, stiff = (oscillators(k)[0] for k in ((1.0, 6.0, 9.0), (20.0, 6.0, 9.0)))
    between = np.sqrt(12 / 1.0), np.sqrt(6 / 2.0), np.sqrt(9 / 1.5)  # the first is the highest now
    assert between_by_rank(np.array(between), soft, stiff) == pytest.approx(between)
    over = np.array([between[0], between[1], 1.2 * stiff[1]])  # what a small basis misses
    assert between_by_rank(over, soft, stiff) == pytest.approx([between[0], between[1], stiff[1]])


def test_twins_are_told_at_each_load():
    found = same_group(np.array([[1.0, 1.0005, 2.0], [1.0, 1.5, 1.5001]]))
    assert found.tolist() == [
        [[True, True, False], [True, True, False], [False, False, True]],
        [[True, False, False], [False, True, True], [False, True, True]],
    ]


def test_modes_are_followed_from_any_order():
    """Twins that stand apart in the list of modes, as where the numbers are those of another state."""
    after = np.array([[0, 0, 1, 0], [1, 0, 0, 0], [0, 0, 0, 1], [0, 1, 0, 0]], dtype=float)
    before = np.array([100.0, 90.0, 100.01, 95.0])
    assert same_group(before)[0].tolist() == [True, False, True, False]
    assert follow(np.eye(4), after, np.eye(4), before).tolist() == [2, 0, 3, 1]
