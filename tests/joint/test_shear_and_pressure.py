"""Pressure sets k_t, and shear moves the pressure: the state where both fit is found though their steps swing."""

import numpy as np
import pytest
from scipy.optimize import brentq

from faying.errors import NotConverged
from faying.reduction.reduced import ReducedEquilibrium, ReducedMotion

COUPLING, SHEAR_OF_PRESSURE = 0.9, 10.0


class Proportional:
    """p = approach and k_t = c p, on one point."""

    def pressure(self, approach):
        p = np.maximum(approach, 0.0)
        return p, np.where(p > 0, 1.0, 0.0)

    def stiffness(self, pressure, *, tabulated=False):
        return np.ones_like(pressure), SHEAR_OF_PRESSURE * pressure


def answer(load):
    """Pressure and slip by elimination: of a given k_t the equations are linear, and k_t = c p is one number."""

    def state(k):
        slip = (load[1] - COUPLING * load[0] / 2) / (1 + k - COUPLING**2 / 2)
        return (COUPLING * slip - load[0]) / 2, slip

    return state(brentq(lambda k: SHEAR_OF_PRESSURE * state(k)[0] - k, 0.0, 1e6, xtol=1e-12, rtol=1e-14))


# of its steps each change of k_t is 0.5, 0.9, 0.97 and 0.995 times the last, with the other sign
@pytest.mark.parametrize("pull", [50.0, 2011.0, 20000.0, 1e6])
def test_pressure_and_shear_that_swing_meet(pull):
    stiffness = np.array([[1.0, COUPLING], [COUPLING, 1.0]])
    motion = ReducedMotion(weights=np.ones(1), gap=np.zeros(1), relative=np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]))
    balance = ReducedEquilibrium(stiffness, [(motion, Proportional())])
    load = np.array([-2.0, pull])
    found = balance.solve(load, start=np.array([-1.0, 0.0]), tolerance=1e-10)
    pressure, slip = answer(load)
    assert found.pressures[0] == pytest.approx([pressure], rel=1e-7)
    assert found.displacement[1] == pytest.approx(slip, rel=1e-7)
    assert found.newton_steps <= 30


class Root:
    """p = approach^2 and k_t = c sqrt(p)."""

    def __init__(self, shear):
        self.shear = shear

    def pressure(self, approach):
        closing = np.maximum(approach, 0.0)
        return closing**2, 2 * closing

    def stiffness(self, pressure, *, tabulated=False):
        return np.ones_like(pressure), self.shear * np.sqrt(pressure)


@pytest.mark.parametrize("seed", range(40))
def test_what_is_found_with_several_points_is_in_balance(seed):
    """Random structures with two points, some of which open: no state that is left out of balance counts as found."""
    rng = np.random.default_rng(seed)
    root, moves = rng.standard_normal((4, 4)), rng.standard_normal((6, 4)) * np.tile([[1.0], [3.0], [3.0]], (2, 1))
    law, stiffness = Root(10 ** rng.uniform(0, 1.5)), root @ root.T + 1e-3 * np.eye(4)
    load = 10 * rng.standard_normal(4)
    motion = ReducedMotion(weights=np.ones(2), gap=np.zeros(2), relative=moves)
    start = -0.1 * moves.T @ np.tile([1.0, 0.0, 0.0], 2)
    try:
        found = ReducedEquilibrium(stiffness, [(motion, law)]).solve(load, start=start, tolerance=1e-10)
    except NotConverged:
        return
    opening, *slip = (moves @ found.displacement).reshape(2, 3).T
    p = np.maximum(-opening, 0.0) ** 2
    traction = np.stack([-p, *(law.shear * np.sqrt(p) * one for one in slip)], axis=1)
    assert stiffness @ found.displacement + moves.T @ traction.ravel() == pytest.approx(load, abs=1e-7)
