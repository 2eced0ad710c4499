"""The static cycle against the exact loop of sliders, and against the harmonic balance."""

import numpy as np
import pytest

from faying.microslip.epmc import Epmc
from faying.microslip.slip_cycle import nearest, static_cycle
from tests.helpers.slips import chain, oscillator, slider

LIMITS = np.geomspace(0.002, 1.0, 24) / 24


def test_the_loop_of_a_slider_is_its_parallelogram():
    model = oscillator(slider(1.0, 0.5))
    found = static_cycle(model, 0, 2.0, steps=64)
    secant = 3 + 0.5 / 2.0
    assert found.frequency == pytest.approx(np.sqrt(secant), rel=1e-12)
    assert found.damping == pytest.approx(4 * 0.5 * 1.5 / (2 * np.pi * secant * 4), rel=1e-3)
    assert found.loads[-1] == pytest.approx(found.loads[0], rel=1e-12)


def test_nothing_slips_at_small_amplitude():
    model = chain([1.0, 0.7], [3.0, 2.0], slider(1.0, 0.5))
    for mode in (0, 1):
        found = static_cycle(model, mode, 0.01)
        assert found.frequency == pytest.approx(model.modes[0][mode], rel=1e-12)
        assert abs(found.damping) < 1e-12


def test_it_agrees_with_the_harmonic_balance_where_one_mode_moves():
    model = chain([1.0, 0.7], [3.0, 2.0], slider(np.full(24, 1 / 24), LIMITS))
    for amplitude in (0.03, 0.3):
        dynamic = Epmc(model=model, samples=256).solve(amplitude)
        static = static_cycle(model, 0, amplitude)
        assert static.frequency == pytest.approx(dynamic.frequency, rel=5e-3)
        assert static.damping == pytest.approx(dynamic.damping, rel=0.05)


def test_nearest_takes_each_level_once():
    assert nearest([1.0, 10.0, 100.0], [90.0, 110.0, 2.0]) == [0, 2]
