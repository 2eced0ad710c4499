"""Power spectra and structure functions against direct sums and closed forms."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from faying import NotConverged, Scan
from faying.surface import powerlaw
from faying.surface.convention import cut_factor, density, structure_coefficient
from faying.surface.lines import find_lines
from faying.surface.scan import Profile
from faying.surface.spectrum import periodogram, spectrum, structure_function
from faying.surface.synthesize import spectral, weierstrass_mandelbrot


def test_the_integral_of_the_spectrum_is_the_mean_square_height():
    # white noise: no leakage to speak of, every coefficient below the Nyquist circle counts
    z = np.random.default_rng(0).normal(size=(256, 256))
    s = spectrum(Scan(heights=z, spacing=(2e-6, 2e-6)))
    inside = s.frequency <= s.nyquist
    power = np.sum((s.density * s.width * s.lowest)[inside])
    # the circle holds pi/4 of the square's power
    assert power == pytest.approx(np.pi / 4, rel=0.05)
    line = Profile(heights=z.ravel()[:8192], spacing=2e-6)
    s = spectrum(line)
    assert np.sum(s.density * s.width * s.lowest) == pytest.approx(1.0, rel=0.05)


@pytest.mark.parametrize("shape", [(256, 256), (192, 320)])
@pytest.mark.parametrize("lay", [None, (0.7, 2.0)])
def test_the_spectrum_of_a_synthetic_surface_is_the_one_put_in(shape, lay):
    D, G = 2.4, 1e-9
    total = 0.0
    for seed in range(6):
        s = spectrum(spectral(shape, spacing=(1e-6, 1.5e-6), D=D, G=G, lay=lay, seed=seed))
        total = total + s.density / 6
    use = (s.frequency > 10 * s.lowest) & (s.frequency < 0.5 * s.nyquist)
    ratio = (total / (density(D, G) * s.frequency ** (2 * D - 7)))[use]
    weights = s.count[use]
    assert np.average(ratio, weights=weights) == pytest.approx(1.0, abs=0.03)


def test_unevenness_is_one_for_isotropic_and_more_for_a_lay():
    plain = spectrum(spectral((256, 256), spacing=1e-6, D=2.4, Rq=1e-6, seed=1))
    laid = spectrum(spectral((256, 256), spacing=1e-6, D=2.4, Rq=1e-6, lay=(0.3, 3.0), seed=1))
    assert np.median(plain.uneven) < 1.1
    assert np.median(laid.uneven) > 1.5


@settings(max_examples=20, deadline=None)
@given(scale=st.floats(1e-3, 1e3), length=st.floats(1e-3, 1e3))
def test_units_only_scale_the_spectrum(scale, length):
    a = spectral((48, 64), spacing=1.0, D=2.5, Rq=1.0, seed=2)
    b = Scan(heights=a.heights * scale, spacing=(length, length))
    sa, sb = spectrum(a), spectrum(b)
    assert np.allclose(sb.frequency * length, sa.frequency, rtol=1e-12)
    assert np.allclose(sb.density, sa.density * scale**2 * length, rtol=1e-8)


@pytest.mark.parametrize("holes", [False, True])
def test_structure_function_equals_the_sum_over_pairs(holes):
    rng = np.random.default_rng(5)
    z = rng.normal(size=(24, 30)).cumsum(axis=0).cumsum(axis=1)
    known = rng.random(z.shape) > 0.2 if holes else np.ones(z.shape, bool)
    sf = structure_function(Scan(heights=z, spacing=(1.0, 1.0)), known=known, longest=0.125, ratio=1.0)
    # lags of length 1: (0, 1) and (1, 0); the ring holds |lag| in .5 .. 1.5, so the diagonals too
    sums, weights, lags = [], [], []
    for dy, dx in ((0, 1), (1, 0), (1, 1), (1, -1)):
        a, b = z[dy:, max(dx, 0) : z.shape[1] + min(dx, 0)], z[: z.shape[0] - dy, max(-dx, 0) : z.shape[1] - max(dx, 0)]
        m = (
            known[dy:, max(dx, 0) : z.shape[1] + min(dx, 0)]
            & known[: z.shape[0] - dy, max(-dx, 0) : z.shape[1] - max(dx, 0)]
        )
        sums.append(float(np.sum(((a - b) ** 2)[m]) / m.sum()))
        # half-plane of lags: (0, 1) once, (1, 0) and (-1, 0) both
        weights.append(1 if dy == 0 else (2 if dx == 0 else 1))
        lags.append(float(np.hypot(dx, dy)))
    assert sf.lag[0] == pytest.approx(np.average(lags, weights=weights))
    assert sf.value[0] == pytest.approx(np.average(sums, weights=weights), rel=1e-9)


def test_structure_function_of_a_known_surface():
    D, G = 2.6, 1e-9
    values = [structure_function(spectral((512, 512), spacing=1e-6, D=D, G=G, seed=s)) for s in range(4)]
    lag = values[0].lag
    mean = np.mean([v.value for v in values], axis=0)
    law = 2 * density(D, G) * structure_coefficient(D) * cut_factor(D) * lag ** (6 - 2 * D)
    # waves under the Nyquist wavelength are absent: they would add twice their power at every lag
    short = 2 * density(D, G) * (0.5e6) ** (2 * D - 6) / (6 - 2 * D)
    use = (lag > 6e-6) & (lag < 3e-5)
    assert np.allclose(mean[use] + short, law[use], rtol=0.06)


@pytest.mark.parametrize("slope", [1.4, 2.2, 2.9])
def test_the_fit_returns_an_exact_law_with_its_noise(slope):
    s = spectrum(spectral((256, 256), spacing=1e-6, D=2.4, Rq=1e-6, seed=1))
    f = s.frequency
    smear = powerlaw.smearing(s, f, slope)[0]
    from dataclasses import replace

    white = 1e-3 * 1e-15 * (1e5) ** -(slope + 1)
    exact = replace(s, density=1e-15 * f**-slope * smear + white * 2 * np.pi * f)
    law = powerlaw.fit(exact, 6 * s.lowest, 0.5 * s.nyquist)
    assert law.slope == pytest.approx(slope, abs=1e-6)
    assert law.log_level == pytest.approx(np.log(1e-15) - slope * np.log(law.pivot), abs=1e-6)
    assert law.noise == pytest.approx(white, rel=1e-3)
    assert law.misfit < 1e-10


def test_the_window_smears_a_power_law_as_stated():
    # expected periodogram of a power law over exact smearing by the Hann kernel, one axis: weights 1/6, 2/3, 1/6 of
    # neighbouring coefficients of a periodic signal have the variance 1/3 that the formula rests on
    k = np.arange(8, 40)
    slope = 2.2
    exact = (k**-slope) * 2 / 3 + ((k - 1.0) ** -slope + (k + 1.0) ** -slope) / 6
    assert np.allclose(exact / k**-slope, 1 + slope * (slope + 1) / (6 * k**2), rtol=2e-3)


def test_blur_lowers_the_upper_end_and_waviness_raises_the_lower():
    from faying.surface.filters import gaussian_lowpass

    rough = spectral((512, 512), spacing=1e-6, D=2.4, Rq=1e-6, seed=3)
    s = spectrum(gaussian_lowpass(rough, 6e-6))
    law, notes = powerlaw.fit_band(s, *powerlaw.supported_band(s))
    assert any("waves under" in note for note in notes)
    assert law.used[-1] < 0.4 * s.nyquist
    long = spectral((512, 512), spacing=1e-6, D=2.4, Rq=1e-6, longest=2e-5, seed=3)
    s = spectrum(long)
    law, notes = powerlaw.fit_band(s, *powerlaw.supported_band(s))
    assert any("waves over" in note for note in notes)
    assert law.used[0] > 2.5e4
    assert law.slope == pytest.approx(2.2, abs=0.1)


def test_a_band_without_bins_is_refused():
    s = spectrum(spectral((64, 64), spacing=1e-6, D=2.4, Rq=1e-6))
    with pytest.raises(NotConverged, match="widen it"):
        powerlaw.fit(s, 1e5, 1.01e5)


def test_tool_marks_are_found_and_a_rough_surface_or_a_series_left_alone():
    rough = spectral((256, 256), spacing=1e-6, D=2.4, Rq=1e-6, seed=1)
    power, frequency, _ = periodogram(rough)
    assert not find_lines(rough, power, frequency).any()
    x = np.arange(256) * 1e-6
    marks = 2e-7 * np.cos(2 * np.pi * x / 12.3e-6)
    marked = rough.with_heights(rough.heights + marks[None, :])
    power, frequency, _ = periodogram(marked)
    found = find_lines(marked, power, frequency)
    assert 3 <= found.sum() <= 60
    assert np.allclose(frequency[found], 1 / 12.3e-6, rtol=0.2)
    series = weierstrass_mandelbrot((256, 256), spacing=1e-6, D=2.4, G=1e-9)
    power, frequency, _ = periodogram(series)
    assert not find_lines(series, power, frequency).any()
