"""Damping at levels of acceleration, against exact integrals, harmonic balance, and what scaling says."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.sparse.linalg import splu

import faying
from faying.joint.attachments import Support
from faying.microslip import levels
from faying.microslip.epmc import Epmc
from faying.microslip.levels import LevelModel, cut_laws, level_basis, level_model
from faying.microslip.slip_basis import unbalanced_forces
from tests.helpers.plates import plates, stacked
from tests.helpers.slips import chain, describing, oscillator, slider

IWAN = np.full(24, 1 / 24), np.geomspace(0.002, 1.0, 24) / 24


def leveled(model):
    """Coordinates are the x of a node each."""
    size = len(model.mass)
    vectors = np.zeros((3 * size, size))
    vectors[::3] = np.eye(size)
    return LevelModel(slip=model, vectors=vectors, rigid=0)


@pytest.mark.parametrize(("stiffness", "limits"), [(1.0, 0.5), IWAN], ids=["Jenkins", "Iwan"])
@pytest.mark.parametrize("level", [0.05, 1.0, 3.0, 10.0])
def test_one_mass_has_the_exact_integral_of_the_hysteresis(stiffness, limits, level, monkeypatch):
    monkeypatch.setattr(levels, "SAMPLES", 512)
    monkeypatch.setattr(levels, "TOLERANCE", 1e-6)
    monkeypatch.setattr(levels, "PASSES", 40)
    monkeypatch.setattr(levels, "HARMONICS", 1)
    found = leveled(oscillator(slider(stiffness, limits))).at([level], 1)
    x = brentq(lambda x: (3 + describing(stiffness, limits, x)[0]) * x - level, 1e-6, 10)
    in_phase, loss = describing(stiffness, limits, x)
    assert 2 * np.pi * found.frequencies[0, 0] == pytest.approx(np.sqrt(3 + in_phase), rel=1e-4)
    assert found.damping[0, 0] == pytest.approx(loss / (2 * np.pi * (3 + in_phase) * x**2), rel=1e-3, abs=1e-9)


def test_the_error_that_is_stated_covers_what_few_passes_leave(monkeypatch):
    monkeypatch.setattr(levels, "HARMONICS", 1)
    model = oscillator(slider(*IWAN))
    for level in (0.5, 2.0):
        found = leveled(model).at([level], 1)
        x = brentq(lambda x, level=level: (3 + describing(*IWAN, x)[0]) * x - level, 1e-6, 10)
        in_phase, loss = describing(*IWAN, x)
        exact = loss / (2 * np.pi * (3 + in_phase) * x**2)
        assert abs(found.damping[0, 0] / exact - 1) < found.error[0, 0] + 0.01  # instants of the cycle: 1 %
        # the lag, which one mass has exactly, is in the stated error
        assert found.error[0, 0] < 0.1 + levels.ERROR_OF_LAG * found.damping[0, 0]


@pytest.mark.parametrize("mode", [0, 1])
def test_two_masses_agree_with_harmonic_balance(mode, monkeypatch):
    monkeypatch.setattr(levels, "SAMPLES", 256)
    monkeypatch.setattr(levels, "HARMONICS", 1)
    model = chain([1.0, 0.7], [3.0, 2.0], slider(*IWAN))
    found = leveled(model)
    for amplitude in (0.02, 0.1, 0.4):
        point = Epmc(model=model, mode=mode, harmonics=1, samples=256).solve(amplitude)
        shape = np.abs(point.coordinates[1] + 1j * point.coordinates[2]).max()
        level = point.frequency**2 * shape
        answer = found.at([level], mode + 1)
        frequency, damping = answer.frequencies[0, mode], answer.damping[0, mode]
        speed = 2 * np.pi * frequency
        assert speed == pytest.approx(point.frequency, rel=2e-3)
        assert damping == pytest.approx(point.damping, rel=0.05)


@pytest.mark.parametrize("mode", [0, 1])
def test_harmonic_balance_goes_on_from_a_cycle(mode):
    """What it finds does not depend on the cycle that it begins with, and is what the passes find where they settle."""
    model = leveled(chain([1.0, 0.7], [3.0, 2.0], slider(*IWAN)))
    passes = model.passes(0.5, mode)
    assert passes.converged
    one, other = (model.balanced(model.passes(level, mode), 0.5, mode) for level in (0.05, 0.2))
    assert one.level == other.level == 0.5
    assert one.frequency == pytest.approx(other.frequency, rel=1e-5)
    assert one.damping == pytest.approx(other.damping, rel=1e-3)
    assert one.frequency == pytest.approx(passes.frequency, rel=2e-3)
    assert one.damping == pytest.approx(passes.damping, rel=passes.error)


def test_where_passes_do_not_settle_harmonic_balance_has_the_answer(monkeypatch):
    """The node that moves most has the level that was asked for, and no level has an answer by itself alone."""
    model = leveled(chain([1.0, 0.7], [3.0, 2.0], slider(*IWAN)))
    settled = model.at([0.1, 0.5, 2.0], 2)
    alone = model.passes

    def unsettled(level, number):
        return replace(alone(level, number), change=1.0 if level > 0.05 else 0.0)

    monkeypatch.setattr(LevelModel, "passes", lambda _, level, number: unsettled(level, number))
    balanced = model.at([0.1, 0.5, 2.0], 2)
    assert balanced.frequencies == pytest.approx(settled.frequencies, rel=2e-3)
    assert np.all(np.abs(balanced.damping / settled.damping - 1) < settled.error + balanced.error)
    assert np.array_equal(model.at([0.5], 2).damping[0], balanced.damping[1])
    cycle = model.up_to(0.5, 0)
    speed = 2 * np.pi * cycle.frequency
    assert speed**2 * np.hypot(*cycle.motion[1:3]).max() == pytest.approx(0.5, rel=2e-3)


def test_harmonics_bring_the_damping_nearer_to_harmonic_balance_with_harmonics(monkeypatch):
    """The second mass vibrates near three times the first mode: its third harmonic is large."""
    monkeypatch.setattr(levels, "SAMPLES", 256)
    model = chain([1.0, 0.2], [3.0, 1.0], slider(*IWAN))
    found = leveled(model)
    misses = []
    for harmonics in (1, 3):
        monkeypatch.setattr(levels, "HARMONICS", harmonics)
        miss = []
        for amplitude in (0.1, 0.4):
            point = Epmc(model=model, mode=0, harmonics=3, samples=256).solve(amplitude)
            level = point.frequency**2 * np.abs(point.coordinates[1] + 1j * point.coordinates[2]).max()
            answer = found.at([level], 1)
            frequency, damping = answer.frequencies[0, 0], answer.damping[0, 0]
            assert 2 * np.pi * frequency == pytest.approx(point.frequency, rel=3e-4)
            miss.append(abs(damping / point.damping - 1))
        misses.append(max(miss))
    assert misses[1] < 0.5 * misses[0]


def test_small_motions_lose_in_inverse_proportion_to_friction():
    """Mindlin's partial slip: the loss of a cycle goes with the cube of the motion over the limit of friction."""
    model = oscillator(slider(np.full(400, 1 / 400), np.linspace(0, 1, 400) / 400))
    once, twice = (
        leveled(replace(model, joints=(replace(model.joints[0], law=replace(model.joints[0].law, friction=mu)),)))
        .at([0.4, 0.8], 1)
        .damping[:, 0]
        for mu in (1.0, 2.0)
    )
    assert once[1] / once[0] == pytest.approx(2, rel=0.1)
    assert once[1] / twice[1] == pytest.approx(2, rel=0.1)


def test_no_slip_is_no_damping():
    model = chain([1.0, 0.7], [3.0, 2.0], replace(slider(1.0, 0.5), friction=1e9))
    found = leveled(model).at([0.1, 10.0], 2)
    assert np.all(found.damping < 1e-12)
    assert 2 * np.pi * found.frequencies == pytest.approx(np.array([model.modes[0]] * 2), rel=1e-9)


def test_a_mass_that_friction_alone_holds_has_no_answer_above_what_friction_can_bear():
    """In phase with a motion x, a slider with limit F bears at most 4 F / pi: the inertia of a level above it wins."""
    found = leveled(oscillator(slider(1.0, 0.5), spring=0.0)).at([0.3, 3.0], 1)
    assert found.frequencies[0, 0] > 0
    assert np.isnan([found.frequencies[1, 0], found.damping[1, 0], found.error[1, 0]]).all()


def test_the_basis_leaves_little_of_the_full_equations():
    """Two plates on one bolt of which a mode slips: mean and first harmonic, in energy over that of the motion."""
    shank = {"diameter": 8e-3, "material": "45 steel", "seat": (0, 14e-3)}
    bolt = faying.Bolt("b", ("low.bottom", "high.top"), at=(0.03, 0.02, 0), **shank)
    held = plates(stacked(counts=(6, 3, 1)), bolts=[bolt], friction=0.1, supports=[Support(face="low.left")])
    state = held.solve(3e3, modes=3)
    laws = cut_laws(held, state.preload, [0.1], 12)
    basis = level_basis(held, state.preload, state.vibration, [laws], np.full(2, 30.0))
    model = level_model(held, state.preload, basis, laws)
    for mode in (0, 1):
        cycle = model.up_to(30.0, mode)
        assert cycle.damping > 1e-3
        left = unbalanced_forces(
            held,
            model.vectors,
            model.slip.joints,
            motion=cycle.motion[:3],
            traction=[traction[:3] for traction in cycle.traction],
            speed=2 * np.pi * cycle.frequency,
            damping=cycle.damping,
        )
        energy = np.einsum("ij,ij->j", left, splu(state.vibration.stiffness.tocsc()).solve(left))
        assert np.all(energy < 0.003**2 * (cycle.motion[1] @ model.slip.linear @ cycle.motion[1]))
