"""A mode with damping by level under noise and under a sweep, against closed forms and integration in time."""

from functools import partial
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from faying.microslip.levels import LevelModel
from faying.service.mode_curve import ModeCurve, resonance, rule, variance
from faying.study.vibration import InputTable
from tests.helpers.shaken import integrated
from tests.helpers.slips import chain, describing, oscillator, slider

IWAN = np.full(24, 1 / 24) * 0.5, np.geomspace(0.002, 1.0, 24) / 24 * 0.5


def flat(value, first=1e-5, last=1e3):
    return InputTable(frequencies=np.array([first, last]), values=np.array([value, value]))


def curves_of(model, count, *, rest, levels):
    """The curves of the modes of a model whose coordinates are the x of a node each."""
    size = len(model.mass)
    vectors = np.zeros((3 * size, size))
    vectors[::3] = np.eye(size)
    leveled = LevelModel(slip=model, vectors=vectors, rigid=0)
    root = np.sqrt(np.diag(model.mass))
    out = []
    for mode in range(count):
        cycles = [cycle for level in levels if np.isfinite((cycle := leveled.passes(level, mode)).frequency)]
        out.append(
            ModeCurve(
                speed=float(model.modes[0][mode]),
                rest=rest,
                amplitudes=np.array([np.linalg.norm(root * cycle.motion[1]) for cycle in cycles]),
                speeds=np.array([2 * np.pi * cycle.frequency for cycle in cycles]),
                slips=np.array([cycle.damping for cycle in cycles]),
            )
        )
    return out


@pytest.mark.parametrize("damping", [1e-4, 3e-3, 0.05])
def test_a_linear_mode_has_the_rms_of_miles(damping):
    """Q = 1/(2 zeta): rms of omega^2 q is the root of pi/2 f Q G (Miles 1954), to the band that is cut off."""
    f, density = 120.0, 0.3
    curve = ModeCurve(speed=2 * np.pi * f, rest=damping)
    sigma = curve.balance(partial(variance, flat(density, 1e-6, 1e7), 1.0)).sigma
    assert sigma * curve.speed**2 == pytest.approx(np.sqrt(np.pi / 2 * f / (2 * damping) * density), rel=1e-6)


def test_the_amplitude_of_a_mode_that_slips_has_the_density_of_its_fokker_planck_equation():
    """a exp(-int 2 zeta omega^3 a da/(pi S_0)) by integrals of its own; G = 4 pi S_0."""
    (curve,) = curves_of(oscillator(slider(*IWAN)), 1, rest=1e-3, levels=np.geomspace(1e-4, 3, 20))
    for density in (2e-6, 2e-4, 2e-3):
        level = curve.balance(partial(variance, flat(density), 1.0))
        a = np.geomspace(1e-6, 30, 400) * level.sigma

        def lost(a):
            w, z = curve.at(np.array(a))
            return z * w**3 * a

        spent = np.cumsum([quad(lost, low, high)[0] for low, high in pairwise([0.0, *a])])
        p = a * np.exp(-spent / (density / 8))
        mean = [np.trapezoid(p * a * one, np.log(a)) for one in (1.0, a**2, a * lost(a))]
        assert level.sigma == pytest.approx(np.sqrt(mean[1] / mean[0] / 2), rel=2e-3)
        assert mean[2] / mean[0] == pytest.approx(density / 4, rel=2e-3)  # what it gives off is what it gets
        assert 2 * level.damping * level.speed**3 * level.sigma**2 == pytest.approx(density / 4, rel=2e-3)


def test_the_rule_integrates_sharp_resonances_exactly():
    table = InputTable(frequencies=np.array([3.0, 40.0, 700.0]), values=np.array([0.2, 4.0, 0.01]))
    speeds, dampings = 2 * np.pi * np.array([12.0, 12.1, 90.0]), np.array([2e-4, 1e-3, 0.03])
    f, weights = rule(table, speeds, dampings)
    force = np.array([1.0, -0.7, 2.0])

    def answer(f):
        return table.at(f) * np.abs(force @ resonance(speeds, dampings, f)) ** 2

    exact, at = 0.0, np.unique(np.concatenate([speeds / (2 * np.pi) * (1 + k * dampings) for k in (-30, -3, 0, 3, 30)]))
    edges = np.unique(np.concatenate([[3.0, 40.0, 700.0], at]))
    for low, high in pairwise(edges):
        exact += quad(lambda f: float(answer(np.array([f]))[0]), low, high, epsrel=1e-11, limit=400)[0]
    assert weights @ answer(f) == pytest.approx(exact, rel=1e-8)


@pytest.mark.parametrize("density", [2e-5, 3e-4, 3e-3])
def test_one_mass_has_the_rms_of_its_integration_in_time(density):
    """4 % of 150 realisations is three of their standard deviations; slip damps three to thirty times the rest."""
    (curve,) = curves_of(oscillator(slider(*IWAN)), 1, rest=2e-3, levels=np.geomspace(1e-4, 5, 24))
    level = curve.balance(partial(variance, flat(density), 1.0))
    x, _, _ = integrated(np.ones(1), [3.0], *IWAN, density=density, damping=2e-3, time=1200.0, realisations=150)
    assert np.sqrt(np.mean(x**2)) == pytest.approx(level.sigma, rel=0.04)
    assert level.damping > 2.5 * curve.rest
    linear = ModeCurve(speed=curve.speed, rest=curve.rest).balance(partial(variance, flat(density), 1.0))
    assert linear.sigma > 1.5 * level.sigma  # what damping at rest alone says


@pytest.mark.parametrize("density", [3e-5, 3e-3])
def test_modes_in_one_joint_have_their_rms_where_one_of_them_leads(density):
    """Two modes slide the same sliders. Each by its own level: 5 % for the first, which leads, and 15 % for the second,
    which the slip of the first damps less than it would alone, for it breaks the sliders loose."""
    masses, springs = np.array([1.0, 0.7]), [3.0, 2.0]
    model = chain(masses, springs, slider(*IWAN))
    curves = curves_of(model, 2, rest=2e-3, levels=np.geomspace(1e-4, 5, 24))
    x, _, modes = integrated(masses, springs, *IWAN, density=density, damping=2e-3, time=1500.0, realisations=100)
    measured = np.sqrt(np.mean((x @ np.diag(masses) @ modes) ** 2, axis=(0, 1)))
    forces = np.abs(modes.T @ masses)
    found = [c.balance(partial(variance, flat(density), float(f))).sigma for c, f in zip(curves, forces, strict=True)]
    assert measured[0] == pytest.approx(found[0], rel=0.05)
    assert measured[1] == pytest.approx(found[1], rel=0.15)


def test_a_sweep_reaches_the_amplitude_of_the_hysteresis_itself():
    """At resonance force = 2 zeta omega^2 a: the peak against the describing function of the sliders, to 2 %."""
    (curve,) = curves_of(oscillator(slider(*IWAN)), 1, rest=0.0, levels=np.geomspace(1e-4, 5, 40))
    for force in (1e-3, 0.02):
        drive = np.linspace(0.5, 1.05, 20001) * curve.speed
        answer, _ = curve.forced(np.full(len(drive), force), drive)
        peak = np.abs(answer).max()
        x = np.geomspace(1e-5, 1, 4000)
        loss = np.array([describing(*IWAN, one)[1] for one in x]) / np.pi  # the energy of a cycle is pi F x
        exact = np.interp(force, loss / x, x)
        assert peak == pytest.approx(exact, rel=0.02)


def test_a_softening_mode_jumps_and_a_linear_one_does_not():
    curve = ModeCurve(
        speed=1.0, rest=1e-3, amplitudes=np.array([0.1, 1.0]), speeds=np.array([0.999, 0.9]), slips=np.zeros(2)
    )
    drive = np.linspace(0.8, 1.1, 3001)
    assert curve.forced(np.full(3001, 1e-3), drive)[1].any()
    assert not ModeCurve(speed=1.0, rest=1e-3).forced(np.full(3001, 1e-3), drive)[1].any()


def test_a_small_motion_is_that_at_rest():
    curve = ModeCurve(
        speed=9.0, rest=0.01, amplitudes=np.array([1.0, 2.0]), speeds=np.array([8.0, 7.0]), slips=np.array([0.1, 0.2])
    )
    speed, damping = curve.at(np.array([1e-6, 0.5, 1.0, 50.0]))
    assert speed == pytest.approx([9.0, 8.5, 8.0, 7.0], rel=1e-5)
    assert damping == pytest.approx([0.01, 0.06, 0.11, 0.21], rel=1e-4)
