"""Sliders marched round a cycle, against closed forms, step by step, and their symmetries."""

import numpy as np
import pytest

import faying
from faying.microslip.microslip import Microslip

K, MU, PRESSURE = 2e12, 0.3, 1e6  # Pa/m, -, Pa


def sliders(limits, k_t=K, k_n=K):
    """One point whose sliders slip at shears `limits` [Pa] in turn; closed by 0, far from opening."""
    limits = np.asarray(limits, dtype=float)
    depth = limits / (MU * k_n)
    return Microslip(
        onset=-depth[None],
        k_n=np.full((1, len(limits)), k_n),
        k_t=np.full((1, len(limits)), k_t),
        friction=MU,
        gap=np.zeros(1),
    )


def slip(amplitude, phase=0.0):
    found = np.zeros((3, 1, 3))
    found[1, 0, 1], found[2, 0, 1] = amplitude * np.cos(phase), amplitude * np.sin(phase)
    return found


def jenkins(limit, amplitude, k=K):
    """Cosine and sine coefficients and loss of one slider under amplitude times cosine, from the exact loop."""
    most = limit / k
    if amplitude <= most:
        return np.array([k * amplitude, 0.0]), 0.0
    turn = np.arccos(1 - 2 * most / amplitude)
    even = k * amplitude / np.pi * (turn - np.sin(2 * turn) / 2)
    return np.array([even, -4 * limit / np.pi * (1 - most / amplitude)]), 4 * limit * (amplitude - most)


@pytest.mark.parametrize("ratio", [0.7, 1.001, 1.3, 3.0, 50.0])
def test_one_slider_is_jenkins_element(ratio):
    """Force and loss to 1e-6 of the limit with 8192 instants; the error falls with the square of their distance."""
    limit = MU * PRESSURE
    amplitude = ratio * limit / K
    exact, loss = jenkins(limit, amplitude)
    errors = []
    for samples in (64, 8192):
        cycle = sliders([limit]).cycle(slip(amplitude), samples=samples, derivative=False)
        errors.append(np.max(np.abs(cycle.traction[1:, 0, 1] - exact)) / limit)
        assert cycle.dissipated[0] == pytest.approx(loss, abs=max(1, (8192 / samples) ** 2) * 1e-6 * limit * amplitude)
    assert errors[0] < 4e-3
    assert errors[1] < 1e-6


@pytest.mark.parametrize("phase", [0.3, 1.0, 2.5])
def test_where_the_ends_of_the_cycle_lie_between_instants(phase):
    """The error still falls with the square of the distance of the instants: four times the samples, about 16 times."""
    limit = MU * PRESSURE
    amplitude = 2 * limit / K
    (even, odd), _ = jenkins(limit, amplitude)

    def error(samples, p):
        return np.max(np.abs(sliders([limit]).cycle(slip(amplitude, p), samples=samples).traction[1:, 0, 1] - at(p)))

    def at(p):
        return np.array([even * np.cos(p) - odd * np.sin(p), even * np.sin(p) + odd * np.cos(p)])

    coarse, fine = (max(error(samples, p) for p in phase + np.linspace(0, 0.5, 8)) for samples in (64, 256))
    assert coarse < 4e-3 * limit
    assert 8 < coarse / fine < 32


def test_a_chain_of_sliders_is_the_sum_of_its_links():
    """Iwan's parallel sliders (doi:10.1115/1.3607751), each by Jenkins' closed form."""
    limits = MU * PRESSURE * np.array([0.1, 0.4, 1.0, 2.5])
    chain = sliders(limits)
    for amplitude in MU * PRESSURE / K * np.array([0.05, 0.3, 0.9, 2.0, 6.0]):
        parts = [jenkins(limit, amplitude) for limit in limits]
        cycle = chain.cycle(slip(amplitude), samples=4096, derivative=False)
        assert cycle.traction[1:, 0, 1] == pytest.approx(sum(p[0] for p in parts), abs=1e-6 * limits.sum())
        assert cycle.dissipated[0] == pytest.approx(sum(p[1] for p in parts), abs=1e-5 * limits.sum() * amplitude)
        slides = limits / K < amplitude
        assert cycle.slipping[0] == pytest.approx(limits[slides].sum() / limits.sum())


def test_iwans_even_chain_has_the_loops_of_two_parabolas():
    """n sliders of stiffness k/n and limits F (2i - 1)/n^2, which sum to F, slip evenly one after the other.

    So t(u) = k u - k^2 u^2/(4 F) until the last one slips at u = 2 F/k, and by Masing the loss of a cycle of amplitude
    U is 8 times the area under t(u) less the triangle under its chord: k^2 U^3/(3 F).
    """
    n, k, force = 500, 2e12, 3e5
    limits = force * (2 * np.arange(1, n + 1) - 1) / n**2
    chain = sliders(limits, k_t=k / n, k_n=k / n)
    for share in (0.2, 0.6, 0.95):
        amplitude = share * 2 * force / k
        cycle = chain.cycle(slip(amplitude), samples=512, derivative=False)
        exact = k**2 * amplitude**3 / (3 * force)
        assert cycle.dissipated[0] == pytest.approx(exact, rel=1e-4)


def moving(seed, count=5, points=4):
    """Sliders and a motion in both directions of slip that opens some of them."""
    rng = np.random.default_rng(seed)
    law = Microslip(
        onset=-rng.uniform(0, 1e-6, (points, 9)),
        k_n=rng.uniform(0.5e12, 2e12, (points, 9)),
        k_t=rng.uniform(0.5e12, 2e12, (points, 9)),
        friction=MU,
        gap=rng.uniform(0, 1e-7, points),
    )
    x = rng.normal(size=(count, points, 3)) * 3e-7
    return law, x


@pytest.mark.parametrize("seed", range(4))
def test_a_cycle_is_its_steps_one_by_one(seed):
    """Closed forms for what sticks and what stays shut, against every slider stepped twice round and transformed."""
    law, x = moving(seed)
    x *= 0.3  # so that some stick
    samples = 48
    cycle = law.cycle(x, samples=samples)
    state = law.start(np.zeros((4, 3)))
    phase = 2 * np.pi * np.arange(samples) / samples
    tractions = []
    for _ in range(2):
        tractions = []
        for a in phase:
            motion = x[0] + x[1] * np.cos(a) + x[2] * np.sin(a) + x[3] * np.cos(2 * a) + x[4] * np.sin(2 * a)
            state, t, _ = law.advance(state, motion)
            tractions.append(t)
    waves = [np.ones(samples) / 2, np.cos(phase), np.sin(phase), np.cos(2 * phase), np.sin(2 * phase)]
    exact = np.einsum("at,tqi->aqi", np.array(waves) * 2 / samples, np.array(tractions))
    assert cycle.traction == pytest.approx(exact, rel=1e-10, abs=1e-10 * float(np.max(np.abs(exact))))


def test_the_axes_of_slip_may_be_turned():
    law, x = moving(11)
    turn = np.eye(3)
    turn[1:, 1:] = [[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]]
    one, other = law.cycle(x), law.cycle(x @ turn.T)
    assert other.traction == pytest.approx(one.traction @ turn.T, abs=1e-9 * float(np.max(np.abs(one.traction))))
    assert other.dissipated == pytest.approx(one.dissipated, rel=1e-9)
    large = np.kron(np.eye(5), turn)
    assert other.derivative == pytest.approx(
        large @ one.derivative @ large.T, abs=1e-5 * float(np.max(np.abs(one.derivative)))
    )


@pytest.mark.parametrize("seed", range(6))
def test_friction_only_takes_energy(seed):
    """Springs that open and shut under a moving normal load give back what they stored, and no more."""
    law, x = moving(seed)
    dissipated = law.cycle(x, samples=256, derivative=False).dissipated
    assert np.all(dissipated >= 0)


def test_one_harmonic_of_normal_motion_alone_loses_nothing_and_opens_where_it_must():
    law = sliders([MU * PRESSURE])
    depth = PRESSURE / K
    for swing, opens in ((0.5 * depth, False), (1.5 * depth, True)):
        x = np.zeros((3, 1, 3))
        x[1, 0, 0] = swing
        cycle = law.cycle(x, samples=512)
        assert cycle.dissipated[0] == pytest.approx(0.0, abs=1e-9 * PRESSURE * swing)
        assert cycle.open[0] == opens
        assert np.all(cycle.traction[:, 0, 1:] == 0)
    # the half-wave max(depth - swing cos a, 0) has the mean of a clipped cosine
    turn = np.arccos(1 / 1.5)
    mean = K * (depth * (np.pi - turn) + 1.5 * depth * np.sin(turn)) / np.pi
    assert cycle.traction[0, 0, 0] == pytest.approx(-mean, rel=1e-4)


def test_sliders_set_out_from_the_state_that_is_named():
    """A stuck slider keeps the shear that its start and the mean motion leave."""
    law = sliders([MU * PRESSURE])
    x = slip(0.2 * MU * PRESSURE / K)
    x[0, 0, 1] = 0.5 * MU * PRESSURE / K
    assert law.cycle(x).traction[0, 0, 1] == pytest.approx(0.5 * MU * PRESSURE)
    there = law.start(np.array([[0.0, 0.5 * MU * PRESSURE / K, 0.0]]))
    assert law.cycle(x, start=there).traction[0, 0, 1] == pytest.approx(0.0, abs=1e-9 * PRESSURE)


def test_too_few_instants_are_refused():
    with pytest.raises(faying.InputError, match="samples: 4 cannot resolve 2 harmonics"):
        sliders([1.0]).cycle(np.zeros((5, 1, 3)), samples=4)
