"""Damage of bolts against closed forms, rainflow of a simulated stress, and what the guidelines print."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import gamma

from faying.bolt.fatigue import FatigueCurve, bending_modulus, dirlik, narrow_band, sweep_cycles
from faying.errors import InputError

CURVE = FatigueCurve(endurance=50e6, slope=3.0, slope_below=5.0)


def rainflow(series):
    """Amplitudes of the closed cycles of a series, by the method of four points; those that stay open are left out."""
    turns = series[np.concatenate([[True], np.diff(np.sign(np.diff(series))) != 0, [True]])]
    stack, out = [], []
    for one in turns.tolist():
        stack.append(one)
        while len(stack) > 3:
            a, b, c, d = stack[-4:]
            if not (min(a, d) <= min(b, c) and max(b, c) <= max(a, d)):
                break
            out.append(abs(c - b) / 2)
            del stack[-3:-1]
    return np.array(out)


def test_an_amplitude_at_the_knee_fails_after_as_many_cycles():
    assert CURVE.damage(np.array([50e6]), np.array([2e6])) == pytest.approx(1.0, rel=1e-12)
    assert CURVE.cycles(np.array([100e6, 25e6])) == pytest.approx([2e6 / 8, 2e6 * 32])
    assert CURVE.cycles(np.array(0.0)) == np.inf
    assert FatigueCurve(endurance=50e6, slope_below=np.inf).cycles(np.array(49e6)) == np.inf
    # Miner: halves of the life at two amplitudes
    assert CURVE.damage(np.array([100e6, 25e6]), np.array([2e6 / 16, 2e6 * 16])) == pytest.approx(1.0)


def test_the_guidelines_have_their_values():
    """VDI 2230 Part 1:2015: 51 MPa for M10; EN 1993-1-9: 50 MPa of range at 2e6 cycles, IEC 61400-6: 36 of them, less
    beyond 30 mm by (30/d)^0.25."""
    assert FatigueCurve.vdi(10e-3).endurance == pytest.approx(51e6)
    assert 2 * FatigueCurve.iec(24e-3).endurance == pytest.approx(36e6)
    assert 2 * FatigueCurve.iec(64e-3).endurance == pytest.approx(36e6 * (30 / 64) ** 0.25)


@pytest.mark.parametrize("sigma", [4e6, 20e6, 90e6])
def test_a_narrow_band_has_the_integral_over_rayleigh(sigma):
    def rate(a):
        return a / sigma**2 * np.exp(-(a**2) / (2 * sigma**2)) / float(CURVE.cycles(np.array(a)))

    exact = sum(quad(rate, *ends, epsrel=1e-12)[0] for ends in ((0, 50e6), (50e6, 14 * sigma + 50e6)))
    assert narrow_band(CURVE, sigma, 7.0) == pytest.approx(7.0 * exact, rel=1e-6)
    assert narrow_band(CURVE, 0.0, 7.0) == 0.0


def test_dirlik_becomes_the_narrow_band():
    f, sigma = 80.0, 30e6
    moments = sigma**2 * np.array([1, f, f**2, f**4])
    assert dirlik(CURVE, moments) == pytest.approx(narrow_band(CURVE, sigma, f), rel=1e-9)
    near = sigma**2 * np.array([1, 80.0, 80**2 * 1.0005, 80**4 * 1.003])
    assert dirlik(CURVE, near) == pytest.approx(narrow_band(CURVE, sigma, f), rel=0.05)


def test_dirlik_of_one_slope_is_his_closed_form():
    """Of his exponential and two Rayleigh parts, by gamma functions, for a band in which each of them counts."""
    f = np.linspace(1, 100, 2001)
    m0, m1, m2, m4 = (np.trapezoid(f**n * 1e14, f) for n in (0, 1, 2, 4))
    gamma2, x = m2 / np.sqrt(m0 * m4), m1 / m0 * np.sqrt(m2 / m4)
    D1 = 2 * (x - gamma2**2) / (1 + gamma2**2)
    R = (gamma2 - x - D1**2) / (1 - gamma2 - D1 + D1**2)
    D2 = (1 - gamma2 - D1 + D1**2) / (1 - R)
    Q = 1.25 * (gamma2 - (1 - D1 - D2) - D2 * R) / D1
    k = 4.0
    parts = np.array([D1 * Q**k * gamma(1 + k), 2 ** (k / 2) * gamma(1 + k / 2) * D2 * abs(R) ** k])
    last = 2 ** (k / 2) * gamma(1 + k / 2) * (1 - D1 - D2)
    curve = FatigueCurve(endurance=50e6, slope=k, slope_below=k)
    exact = np.sqrt(m4 / m2) / curve.knee * m0 ** (k / 2) / curve.endurance**k * (parts.sum() + last)
    assert dirlik(curve, np.array([m0, m1, m2, m4])) == pytest.approx(exact, rel=1e-9)
    assert parts.min() > 1e-4 * last


@pytest.mark.parametrize(
    ("peaks", "within"),
    [
        (((20, 1.0), (90, 1.0)), 0.10),
        (((40, 2.0), (60, 0.5), (200, 0.05)), 0.10),
        pytest.param(((30, 1.0),), 0.10, marks=pytest.mark.slow),
        (((15, 4.0), (60, 0.2), (200, 0.05)), 0.20),  # far apart: his distribution is known to miss most there
    ],
)
def test_dirlik_is_within_a_tenth_of_rainflow_of_a_million_cycles(peaks, within):
    """A Gaussian stress of several resonances, by the inverse Fourier transform of random phases."""
    rate, count = 2048.0, 2**23
    f = np.fft.rfftfreq(count, 1 / rate)
    density = np.zeros(len(f))
    for at, size in peaks:
        density += size / ((1 - (f / at) ** 2) ** 2 + (2 * 0.02 * f / at) ** 2)
    density[(f < 2) | (f > 500)] = 0.0
    df = f[1]
    density *= (25e6) ** 2 / (density.sum() * df)
    rng = np.random.default_rng(5)
    parts = rng.standard_normal((2, len(f)))
    spectrum = np.sqrt(density * df / 2) * (parts[0] + 1j * parts[1]) * count / np.sqrt(2)
    series = np.fft.irfft(spectrum, count)
    amplitudes = rainflow(series)
    assert series.std() == pytest.approx(25e6, rel=0.02)
    counted = CURVE.damage(amplitudes, np.ones(len(amplitudes))) / (count / rate)
    moments = np.array([np.sum(f**n * density) * df for n in (0, 1, 2, 4)])
    assert dirlik(CURVE, moments) == pytest.approx(counted, rel=within)


def test_a_sweep_has_the_cycles_of_its_integral():
    """f dt with f = f_1 2^(R t/60)."""
    first, last, rate = 20.0, 2000.0, 2.0
    seconds = 60 / rate * np.log2(last / first)
    exact = quad(lambda t: first * 2 ** (rate * t / 60), 0, seconds)[0]
    assert sweep_cycles(first, last, rate) == pytest.approx(exact, rel=1e-9)


def test_the_modulus_of_a_round_section():
    assert bending_modulus(np.pi / 4 * 0.01**2) == pytest.approx(np.pi / 32 * 0.01**3)


def test_a_curve_without_endurance_is_refused():
    with pytest.raises(InputError, match="endurance"):
        FatigueCurve(endurance=0.0)
