"""The extended periodic motion against closed forms, and against time integration of what it stands for."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from faying.errors import InputError, NotConverged
from faying.microslip.epmc import Epmc
from tests.helpers.slips import chain, describing, oscillator, slider

IWAN = np.full(24, 1 / 24), np.geomspace(0.002, 1.0, 24) / 24


@pytest.mark.parametrize(("stiffness", "limits"), [(1.0, 0.5), IWAN], ids=["Jenkins", "Iwan"])
def test_one_harmonic_is_the_exact_integral_of_the_hysteresis(stiffness, limits):
    epmc = Epmc(model=oscillator(slider(stiffness, limits)), harmonics=1, samples=1024, most_sliding=2)
    curve = epmc.follow(0.05, 10.0, per_decade=3)
    assert curve.code == "amplitude"
    assert 9.98 <= curve.points[-1].level < 10.5
    assert epmc.follow(0.05, 11.0, known=curve.points, per_decade=3).points[-1].level >= 10.97
    for point in curve.points:
        in_phase, loss = describing(stiffness, limits, point.amplitude)
        squared = 3 + in_phase
        assert point.frequency == pytest.approx(np.sqrt(squared), rel=1e-6)
        damping = loss / (2 * np.pi * squared * point.amplitude**2)
        assert point.damping == pytest.approx(damping, rel=1e-4, abs=1e-9)


def test_instants_of_a_cycle_count_by_their_square():
    errors = []
    for samples in (64, 128, 256):
        point = Epmc(model=oscillator(slider(1.0, 0.5)), harmonics=1, samples=samples).solve(2.0)
        errors.append(abs(point.frequency - np.sqrt(3 + describing(1.0, 0.5, 2.0)[0])))
    assert errors[2] < errors[0] / 8
    assert errors[0] < (2 * np.pi / 64) ** 2 / 12 / 8  # of the trapezoidal rule; 16 instants leave four times as much


def test_no_limit_of_friction_leaves_the_linear_mode():
    model = chain([1.0, 0.7], [3.0, 2.0], replace(slider(1.0, 0.5), friction=1e9))
    for mode in (0, 1):
        epmc = Epmc(model=model, mode=mode, harmonics=3)
        point = epmc.solve(5.0)
        assert point.frequency == pytest.approx(model.modes[0][mode], rel=1e-12)
        assert abs(point.damping) < 1e-12
        assert point.other_modes < 1e-9


def test_vanishing_amplitude_is_the_mode_at_rest():
    model = chain([1.0, 0.7], [3.0, 2.0], slider(*IWAN))
    point = Epmc(model=model).solve(1e-6)
    assert point.frequency == pytest.approx(model.modes[0][0], rel=1e-10)
    assert abs(point.damping) < 1e-10


@pytest.mark.parametrize("harmonics", [1, 3])
def test_what_the_joint_dissipates_is_what_the_damping_takes(harmonics):
    model = chain([1.0, 0.7], [3.0, 2.0], slider(*IWAN))
    point = Epmc(model=model, harmonics=harmonics, samples=256, tolerance=1e-11).solve(0.6)
    X, w = point.coordinates, point.frequency
    by_damping = sum(
        np.pi * 2 * point.damping * w * h**2 * w * (X[k] @ model.mass @ X[k])
        for h in range(1, harmonics + 1)
        for k in (2 * h - 1, 2 * h)
    )
    assert point.dissipated[0].sum() == pytest.approx(by_damping, rel=1e-6)


def test_what_a_point_says_follows_from_its_motion():
    """Norm, level and share of other modes, from the Fourier coefficients in modal coordinates."""
    model = chain([1.0, 0.7], [3.0, 2.0], slider(*IWAN))
    row = np.array([0.3, -1.0])
    point = Epmc(model=model, observer=row, tolerance=1e-11, samples=256).solve(0.6)
    X, w = point.coordinates, point.frequency
    assert w < 0.97 * model.modes[0][0]  # far from the linear limit
    q = X @ model.mass @ model.modes[1]
    assert (q[1:3] ** 2).sum() == pytest.approx(0.6**2, rel=1e-9)
    assert abs(q[2, 1]) > 1e-4  # the other mode lags, so that the sine has a share of the norm
    assert point.level == pytest.approx(w**2 * np.hypot(*(X[1:3] @ row)), rel=1e-9)
    q[1:3, 0] = 0
    assert point.other_modes == pytest.approx(np.sqrt((q[1:] ** 2).sum()) / 0.6, rel=1e-9)


def test_a_curve_ends_where_a_fifth_of_the_motion_is_of_other_modes():
    epmc = Epmc(model=oscillator(slider(*IWAN)))
    point = epmc.solve(0.1)
    assert epmc._ended(replace(point, other_modes=0.19), 1.0) is None
    code, reason = epmc._ended(replace(point, other_modes=0.21), 1.0)
    assert (code, "21%" in reason) == ("other-modes", True)


def test_known_points_go_on_as_if_nothing_had_happened():
    epmc = Epmc(model=chain([1.0, 0.7], [3.0, 2.0], slider(*IWAN)))
    whole = epmc.follow(0.01, 1.0)
    again = epmc.follow(0.01, 1.0, known=whole.points[:5])
    assert len(again.points) == len(whole.points)
    assert again.points[-1].frequency == pytest.approx(whole.points[-1].frequency, rel=1e-9)


def test_the_curve_ends_where_everything_slides():
    curve = Epmc(model=oscillator(slider(*IWAN))).follow(0.01, 100.0)
    assert curve.code == "all-slipping"
    assert "slides" in curve.reason


def test_the_curve_ends_where_the_joint_opens():
    """A mass between a spring and a one-sided one: stiff until the faces part, and softer beyond."""
    model = oscillator(slider(1.0, 1.0))
    joint = model.joints[0]
    model = replace(model, joints=(replace(joint, relative=joint.relative[[1, 0, 2]]),))
    curve = Epmc(model=model).follow(0.1, 100.0)
    assert curve.code == "open"
    assert "opens fully" in curve.reason
    assert all(abs(point.damping) < 1e-9 for point in curve.points)
    assert curve.points[0].frequency == pytest.approx(np.sqrt(3 + 1), rel=1e-9)
    assert np.sqrt(3) < Epmc(model=model).solve(4.0).frequency < np.sqrt(3.9)


def test_the_curve_ends_where_its_keeper_says_so():
    curve = Epmc(model=oscillator(slider(*IWAN))).follow(
        0.01, 1.0, keep=lambda point: "enough" if point.amplitude > 0.05 else None
    )
    assert (curve.code, curve.reason) == ("basis", "enough")
    assert 0.05 < curve.points[-1].level < 0.1


def test_faults_are_named():
    model = oscillator(slider(1.0, 0.5))
    with pytest.raises(InputError, match="mode 2 of a model with 1"):
        Epmc(model=model, mode=1)
    with pytest.raises(InputError, match="harmonics 0"):
        Epmc(model=model, harmonics=0)
    with pytest.raises(NotConverged, match="residual"):
        Epmc(model=model, tolerance=0.0).solve(2.0)


class Motion:
    """The equations of motion in time, by the trapezoidal rule with the sliders stepped at its instants."""

    def __init__(self, model, x, v, step):
        self.model, self.x, self.v, self.step = model, x, v, step
        self.states = [joint.law.start(joint.rest) for joint in model.joints]
        self.force, _, self.states = self.contact(x)
        self.a = np.linalg.solve(model.mass, -self.force)

    def contact(self, x):
        force, tangent, states = self.model.stiffness @ x, self.model.stiffness.copy(), []
        for joint, state in zip(self.model.joints, self.states, strict=True):
            after, traction, slope = joint.law.advance(state, joint.rest + (joint.relative @ x).reshape(-1, 3))
            force = force + joint.relative.T @ ((traction - joint.at_rest[0]) * joint.weights[:, None]).ravel()
            tangent = tangent + joint.projected(slope)
            states.append(after)
        return force, tangent, states

    def go(self, push=0.0):
        """One step of average acceleration."""
        h, M = self.step, self.model.mass
        guess = self.x + h * self.v + h**2 / 4 * self.a
        x = guess + h**2 / 4 * self.a
        for _ in range(20):
            force, tangent, states = self.contact(x)
            miss = M @ (x - guess) * 4 / h**2 + force - push
            if np.abs(miss).max() < 1e-10:
                break
            x = x - np.linalg.solve(4 / h**2 * M + tangent, miss)
        a = (x - guess) * 4 / h**2
        self.v = self.v + h / 2 * (self.a + a)
        self.x, self.a, self.states = x, a, states


STEPS = 300  # in a period
SLOWER = (2 * np.pi / STEPS) ** 2 / 12  # share of the frequency that the trapezoidal rule takes


def test_ring_down_falls_as_the_curve_says():
    weak = slider(0.2 * IWAN[0], 0.2 * IWAN[1])
    epmc = Epmc(model=chain([1.0, 0.7], [3.0, 2.0], weak), samples=256)
    curve = epmc.follow(0.02, 0.5, per_decade=12)
    start = curve.points[-1]
    phi = epmc.model.modes[1][:, 0]
    X, period = start.coordinates, 2 * np.pi / start.frequency
    x0 = X[0] + X[1::2].sum(axis=0)
    v0 = start.frequency * sum(h * X[2 * h] for h in (1, 2, 3))
    motion = Motion(epmc.model, x0, v0, period / STEPS)
    q, times, crossings, peaks = [float(phi @ motion.x)], [0.0], [], []
    for k in range(1, 14 * STEPS):
        before = q[-1]
        motion.go()
        q.append(float(phi @ epmc.model.mass @ motion.x))
        times.append(k * motion.step)
        if before < 0 <= q[-1]:
            crossings.append(times[-2] + motion.step * before / (before - q[-1]))
    q, times = np.array(q), np.array(times)
    for a, b in pairwise(crossings[3:]):  # one period after another, past the transient
        inside = (times >= a) & (times < b)
        peaks.append((q[inside].max() - q[inside].min()) / 2)
    amplitude = np.array(peaks)
    x = np.log([p.amplitude for p in curve.points])
    w = np.interp(np.log(amplitude), x, [p.frequency for p in curve.points])
    zeta = np.interp(np.log(amplitude), x, [p.damping for p in curve.points])
    measured = 2 * np.pi / np.diff(crossings[3:])
    np.testing.assert_allclose(measured, w, rtol=2e-3)  # one period alone still has a share of the other mode
    span = 2 * np.pi * len(measured) / (crossings[-1] - crossings[3])
    assert span == pytest.approx(np.mean(w), rel=1e-4 + SLOWER)
    decay = np.log(amplitude[0] / amplitude[-1]) + np.log(w[0] / w[-1]) / 2  # of w q^2, halved
    predicted = np.sum((zeta[1:] + zeta[:-1]) / 2 * 2 * np.pi)
    assert decay == pytest.approx(predicted, rel=0.02)


@pytest.mark.slow
def test_steady_response_at_the_frequency_of_the_curve_has_its_amplitude():
    epmc = Epmc(model=chain([1.0, 0.7], [3.0, 2.0], slider(*IWAN)), samples=256)
    point = epmc.solve(0.3)
    shape = epmc.model.mass @ epmc.model.modes[1][:, 0]
    w, zeta = point.frequency, point.damping
    X = point.coordinates
    x0, v0 = X[0] + X[1::2].sum(axis=0), w * sum(h * X[2 * h] for h in (1, 2, 3))
    motion = Motion(epmc.model, x0, v0, 2 * np.pi / w / STEPS)
    rounds = int(1.5 / zeta / np.pi) + 4
    history = []
    for k in range(1, rounds * STEPS + 1):
        motion.go(-2 * zeta * w**2 * 0.3 * np.sin(w * k * motion.step) * shape)  # a quarter ahead of cos
        history.append(float(shape @ motion.x))
    last = np.array(history[-STEPS:])
    phase = w * motion.step * np.arange((rounds - 1) * STEPS + 1, rounds * STEPS + 1)
    c, s = 2 * np.mean(last * np.cos(phase)), 2 * np.mean(last * np.sin(phase))
    assert np.hypot(c, s) == pytest.approx(0.3, rel=0.02)
    # at its own frequency the motion is a quarter behind the force: what it is off is a difference of frequency
    assert abs(zeta * s / c) < 1e-4 + SLOWER


def test_the_level_of_an_amplitude_is_that_of_a_solved_point_in_the_linear_limit():
    """Omega squared times the motion of the observer: a power of omega less would be off by that frequency."""
    model = chain([1.0, 0.7], [3.0, 2.0], replace(slider(1.0, 0.5), friction=1e9))
    for mode in (0, 1):
        epmc = Epmc(model=model, mode=mode, observer=np.array([0.3, -1.0]), samples=256)
        assert abs(epmc.linear_frequency - 1) > 0.2
        assert epmc.level_of(0.02) == pytest.approx(epmc.solve(0.02).level, rel=1e-6)
