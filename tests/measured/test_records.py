"""FRFs from records of a system of two masses, with noise on one side at a time."""

import numpy as np
import pytest

from faying import InputError, frf_from_records, identify_modes

RATE, N = 1024.0, 2048
MODES = ((40.0, 0.02), (110.0, 0.01))
SHAPES = np.array([[1.0, 0.6], [0.8, -1.2]])
OUTPUTS = [(1, "z"), (2, "z")]


def accelerance(frequency):
    w = 2 * np.pi * frequency
    parts = [
        np.outer(s[0] * s, -(w**2) / ((2 * np.pi * f) ** 2 - w**2 + 2j * z * 2 * np.pi * f * w))
        for (f, z), s in zip(MODES, SHAPES, strict=True)
    ]
    return parts[0] + parts[1]


@pytest.fixture
def periodic():
    """Random forces that repeat after each record, and the exact responses: no leakage."""
    force = np.random.default_rng(3).standard_normal((400, N))
    spectrum = np.fft.rfft(force)
    spectrum[:, -1] = 0
    force = np.fft.irfft(spectrum)
    response = np.fft.irfft(spectrum[:, None] * accelerance(np.fft.rfftfreq(N, 1 / RATE)))
    return force, response


def measured(force, response, **options):
    frf = frf_from_records(force, response, RATE, outputs=OUTPUTS, **options).band(10, 200)
    return frf, frf.values[:, 0] / accelerance(frf.frequency)


@pytest.mark.parametrize("estimator", ["H1", "H2"])
def test_without_noise_both_are_exact(periodic, estimator):
    frf, ratio = measured(*periodic, estimator=estimator)
    np.testing.assert_allclose(ratio, 1, atol=1e-9)
    np.testing.assert_allclose(frf.coherence, 1, atol=1e-9)


def test_noise_on_the_force(periodic):
    """H1 falls by 1/(1 + q), H2 stands, the coherence is 1/(1 + q) (Bendat and Piersol 2010, section 6.1.4)."""
    force, response = periodic
    q = 0.25
    noisy = force + np.sqrt(q) * np.random.default_rng(4).standard_normal(force.shape)
    frf, ratio = measured(noisy, response, estimator="H1")
    scatter = 1 / np.sqrt(ratio.size * 400)
    assert np.mean(ratio).real == pytest.approx(1 / (1 + q), abs=5 * scatter)
    assert np.mean(frf.coherence) == pytest.approx(1 / (1 + q), abs=0.005)
    assert np.mean(measured(noisy, response, estimator="H2")[1]).real == pytest.approx(1, abs=0.005)


def test_noise_on_the_response(periodic):
    """H1 stands, H2 rises by 1 + q with the noise-to-signal ratio q of each line."""
    force, response = periodic
    power = 0.3
    noisy = response + np.sqrt(power) * np.random.default_rng(5).standard_normal(response.shape)
    frf, h1 = measured(force, noisy, estimator="H1")
    _, h2 = measured(force, noisy, estimator="H2")
    q = power / np.abs(accelerance(frf.frequency)) ** 2  # the force has unit power on every line
    strong = q < 0.3
    assert np.mean(h1[strong]).real == pytest.approx(1, abs=0.01)
    np.testing.assert_allclose(np.mean((h2 / (1 + q))[strong]).real, 1, atol=0.01)
    np.testing.assert_allclose(np.mean((frf.coherence[:, 0] * (1 + q))[strong]), 1, atol=0.01)


def hits(count=3, length=N):
    """Half-sine hits and the response of the system, summed from its impulse response; it does not die out in a
    record."""
    t = np.arange(length) / RATE
    pulse = np.where(t < 0.004, np.sin(np.pi * t / 0.004), 0.0)
    displacement = np.zeros((2, length))
    for (f, z), s in zip(MODES, SHAPES, strict=True):
        wr = 2 * np.pi * f
        wd = wr * np.sqrt(1 - z**2)
        displacement += np.outer(s[0] * s, np.exp(-z * wr * t) * np.sin(wd * t) / wd)
    response = np.array([np.convolve(pulse, h)[:length] / RATE for h in displacement])
    return np.tile(pulse, (count, 1)), np.tile(response, (count, 1, 1))


def test_an_exponential_window_is_taken_off_again():
    """A record of half a second cuts the ringing of the first mode at a quarter; the window's decay cures that
    exactly."""
    force, response = hits(length=512)
    frf = frf_from_records(
        force, response, RATE, outputs=OUTPUTS, quantity="receptance", window="exponential", decay=12.0
    )
    assert frf.window_decay == 12.0
    found = identify_modes(frf, band=(10, 200)).modes
    np.testing.assert_allclose(found.frequencies, [f for f, _ in MODES], rtol=1e-3)
    np.testing.assert_allclose(found.loss_factors, [2 * z for _, z in MODES], rtol=0.02)


def test_a_single_record_has_no_coherence():
    force, response = hits(1)
    assert frf_from_records(force, response, RATE, outputs=OUTPUTS).coherence is None


def test_hann_window_on_random_force_leaves_the_scale(periodic):
    _, ratio = measured(*periodic, window="hann")
    assert np.mean(np.abs(ratio[:, 100:])) == pytest.approx(1, rel=0.02)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"force": np.ones(9)}, "give \\(records, samples\\)"),
        ({"force": np.full((3, N), np.nan)}, "NaN or infinite"),
        ({"force": np.zeros((3, N))}, "record 1 is zero"),
        ({"sampling_rate": 0.0}, "must be positive"),
        ({"estimator": "Hv"}, 'give "H1" or "H2"'),
        ({"window": "flat"}, 'give "none" or'),
        ({"decay": 3.0}, "and only then"),
        ({"window": "exponential"}, "and only then"),
    ],
)
def test_what_does_not_fit(change, match):
    force, response = hits()
    given = {"force": force, "response": response, "sampling_rate": RATE, "outputs": OUTPUTS} | change
    with pytest.raises(InputError, match=match):
        frf_from_records(**given)
