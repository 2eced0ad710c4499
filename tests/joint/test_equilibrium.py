"""Equilibrium of points on springs, against the solution by hand: shares, anchors, ends of the law, tolerances."""

import numpy as np
import pytest

from faying.joint.equilibrium import Equilibrium
from faying.joint.joint_law import JointLaw
from tests.helpers.laws import Given

MU, K_T, GROUND = 0.4, 3e12, 2e7  # -, Pa/m, N/m
AREAS = np.array([1e-6, 2e-6, 5e-6, 12e-6])  # m2: shares of area and shares of points differ


class Points:
    """One joint of points that move by themselves: unknowns are the opening and the two slips of each."""

    def __init__(self, weights, gap=0.0):
        self.weights = np.asarray(weights)
        self.gap = np.full(len(self.weights), gap)
        self.relative = np.eye(3 * len(self.weights))


class Dense(Equilibrium):
    """Newton's step by a dense solution."""

    def _start(self, load):
        start = np.zeros_like(load)
        start[::3] = -1e-6
        return start

    def _direction(self, u, force, slip_states, accuracy):
        matrix = np.array(self.stiffness)
        for trace, k_n, k_t in self._tangents(u, slip_states):
            for i in range(len(trace.weights)):
                matrix[3 * i, 3 * i] += k_n[i]
                matrix[3 * i + 1 : 3 * i + 3, 3 * i + 1 : 3 * i + 3] += k_t[i]
        return np.linalg.solve(matrix, force), 1


def law(**changes):
    """k_n as the root of pressure: p = (c w/2)^2. k_t grows with pressure, too."""
    given = {"k_n": lambda p: 1e9 * np.sqrt(p), "k_t": lambda p: K_T * (p / 1e6) ** 0.25} | changes
    return JointLaw(model=Given(**given))


def on_springs(areas=AREAS, friction=MU, **changes):
    """Points held sideways by springs to the ground; nothing but the joint holds them along its normal."""
    ground = np.diag(np.tile([0.0, GROUND, GROUND], len(areas)))
    return Dense(ground, [(Points(areas), law(**changes))], friction=[friction])


def load(pressures, pushes, areas=AREAS):
    """Pressed by pressure times area, pushed sideways [N] along the first direction."""
    out = np.zeros((len(areas), 3))
    out[:, 0] = -np.asarray(pressures) * areas
    out[:, 1] = pushes
    return out.ravel()


def slips(found):
    return found.displacement.reshape(-1, 3)[:, 1]


def test_a_path_of_sticking_and_sliding_is_that_of_a_spring_and_a_slider():
    """Each point is a Jenkins element beside a spring: pushed until some slide, let go, pushed back until they slide.

    Pushed by T: it sticks with s = (T + A k_t a)/(k + A k_t) about its anchor a while k_t |s - a| <= mu p, and slides
    with s = (T -+ A mu p)/k beyond; the anchor then lies mu p/k_t behind.
    """
    p = np.array([1e6, 2e6, 3e6, 0.5e6])
    k_t, limit = K_T * (p / 1e6) ** 0.25, MU * p
    slider = on_springs()
    anchor = np.zeros(4)
    shares = []
    for factor in (0.5, 3.0, 0.0, -2.0, -4.0, 0.0, 1.0):
        push = factor * AREAS * limit * np.array([0.3, 1.0, 1.4, 0.8])
        stuck = (push + AREAS * k_t * anchor) / (GROUND + AREAS * k_t)
        over = k_t * np.abs(stuck - anchor) > limit
        sign = np.sign(stuck - anchor)
        expected = np.where(over, (push - sign * AREAS * limit) / GROUND, stuck)
        anchor = np.where(over, expected - sign * limit / k_t, anchor)
        found = slider.solve(load(p, push))
        assert found.pressures[0] == pytest.approx(p, rel=1e-9)
        assert slips(found) == pytest.approx(expected, rel=1e-8, abs=1e-15)
        shares.append(found.slipping[0])
        assert shares[-1] == pytest.approx(AREAS[over].sum() / AREAS.sum(), rel=1e-12)
    assert len(set(shares)) >= 3  # none, some and all of the area


def test_the_springs_are_those_of_the_pressure_that_is_left():
    """k_t belongs to the pressure in equilibrium, not to one on the way: s = T/(k + A k_t(p))."""
    p, push = np.array([4e6, 9e6, 1e5, 7e5]), np.array([60.0, 30.0, -20.0, 90.0])
    found = on_springs(friction=None).solve(load(p, push))
    exact = push / (GROUND + AREAS * K_T * (p / 1e6) ** 0.25)
    assert slips(found) == pytest.approx(exact, rel=1e-9)
    assert found.imbalance < 1e-10


def test_what_rounding_leaves_is_accepted_and_no_more():
    """Sideways springs so stiff that K u has lost digits: the imbalance may exceed the tolerance, by rounding alone."""
    p, stiff = np.array([1e6, 2e6]), 1e13
    areas = AREAS[:2]
    turned = np.array([[1.0, -1.0], [-1.0, 1.0]]) * stiff  # ties two points to each other
    ground = np.zeros((6, 6))
    for i in (1, 2):
        ground[i::3, i::3] = turned
        ground[i, i] += GROUND
    slider = Dense(ground, [(Points(areas), law())], friction=[None])
    push = load(p, [40.0, 0.0], areas)
    found = slider.solve(push)
    rounding = slider._rounding(found.displacement) / np.linalg.norm(push)
    assert 1e-10 < rounding < 1e-5  # else nothing is tested
    assert found.imbalance <= rounding
    both = 40.0 / (GROUND + (areas * K_T * (p / 1e6) ** 0.25).sum())
    assert slips(found) == pytest.approx([both, both], rel=1e-5)


@pytest.mark.parametrize("beyond", [0.9e-6, 9e-6])
def test_any_share_of_what_touches_may_lie_beyond_the_law(beyond):
    """The pressures are those of the forces, whatever the law covers."""
    areas = np.array([beyond, 10e-6 - beyond, 90e-6])
    joint = Points(areas)
    joint.gap = np.array([0.0, 0.0, 1e-3])
    ground = np.diag(np.tile([0.0, GROUND, GROUND], 3))
    ground[6, 6] = GROUND  # the open point hangs on its spring
    model = law()
    model.model.greatest_pressure = 5e6
    problem = Dense(ground, [(joint, model)], friction=[None])
    found = problem.solve(load([6e6, 1e6, 0.0], 0.0, areas))
    assert found.pressures[0] == pytest.approx([6e6, 1e6, 0.0], rel=1e-6)
