"""Power spectra and structure functions against direct sums and closed forms."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from faying import NotConverged, Scan
from faying.surface import powerlaw
from faying.surface.convention import cut_factor, density, structure_coefficient
from faying.surface.fractal import fit_fractal
from faying.surface.lines import find_lines
from faying.surface.scan import Profile
from faying.surface.spectrum import (
    HANN_CORRELATION,
    _running_median,
    binned,
    periodogram,
    spectrum,
    structure_function,
)
from faying.surface.synthesize import spectral
from tests.helpers.weierstrass import weierstrass_mandelbrot


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
    from scipy.ndimage import gaussian_filter

    rough = spectral((512, 512), spacing=1e-6, D=2.4, Rq=1e-6, seed=3)
    s = spectrum(rough.with_heights(gaussian_filter(rough.heights, 1.12)))  # half the amplitude at 6 um
    law, notes = powerlaw.fit_band(s, *powerlaw.supported_band(s))
    assert any("wavelengths below" in note for note in notes)
    assert law.used[-1] < 0.4 * s.nyquist
    long = spectral((512, 512), spacing=1e-6, D=2.4, Rq=1e-6, longest=2e-5, seed=3)
    s = spectrum(long)
    law, notes = powerlaw.fit_band(s, *powerlaw.supported_band(s))
    assert any("wavelengths above" in note for note in notes)
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


def edges_of(lowest, highest, ratio):
    """Half-integers, two steps wide at least, growing by `ratio`, until the highest frequency is passed."""
    edges = [0.5]
    while edges[-1] < highest / lowest:
        edges.append(max(edges[-1] + 2, np.ceil(edges[-1] * ratio) + 0.5))
    return np.array(edges) * lowest


SIZES = [
    (31, 48, 2e-6, 3e-6),
    (31, 48, 3e-6, 2e-6),
    (48, 31, 3e-6, 2e-6),
    (40, 44, 1e-6, 2.5e-6),
    (33, 35, 2.3e-6, 1.1e-6),
]


@pytest.mark.parametrize(("ny", "nx", "dx", "dy"), SIZES)
def test_bins_are_the_averages_over_the_whole_plane(ny, nx, dx, dy):
    """Odd and even sizes, unequal spacings: the half-plane must count as the whole plane, brute force."""
    rng = np.random.default_rng(ny)
    scan = Scan(heights=rng.standard_normal((ny, nx)) * 1e-6, spacing=(dx, dy))
    s = spectrum(scan, ratio=1.2)
    wy, wx = (0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(n) + 0.5) / n) for n in (ny, nx))
    window = np.outer(wy, wx)
    z = scan.heights - np.average(scan.heights, weights=window)
    power = np.abs(np.fft.fft2(z * window)) ** 2 * dx * dy / np.sum(window**2)
    f = np.hypot(np.fft.fftfreq(nx, dx)[None, :], np.fft.fftfreq(ny, dy)[:, None])
    sides = nx * dx, ny * dy
    assert s.lowest == pytest.approx(1 / min(sides))
    assert s.nyquist == pytest.approx(0.5 / max(dx, dy))
    assert s.curvature == pytest.approx((1 / sides[0] ** 2 + 1 / sides[1] ** 2) / 2)
    edges = edges_of(s.lowest, s.nyquist, 1.2)
    inside = [(f >= low) & (f < high) for low, high in itertools.pairwise(edges)]
    inside = [m for m in inside if m.any()]
    assert len(s.frequency) == len(inside)
    np.testing.assert_allclose(s.count, [m.sum() / 2 for m in inside])  # each coefficient stands twice in the plane
    np.testing.assert_allclose(s.frequency, [f[m].mean() for m in inside], rtol=1e-9)
    np.testing.assert_allclose(s.density, [power[m].mean() * 2 * np.pi * f[m].mean() for m in inside], rtol=1e-9)


@pytest.mark.parametrize(("ny", "nx", "dx", "dy"), SIZES)
def test_what_is_excluded_counts_for_nothing(ny, nx, dx, dy):
    rng = np.random.default_rng(nx)
    scan = Scan(heights=rng.standard_normal((ny, nx)) * 1e-6, spacing=(dx, dy))
    power, frequency, axes = periodogram(scan)
    mask = rng.random(power.shape) < 0.3
    without = binned(scan, power, frequency, axes, exclude=mask)
    spoiled = binned(scan, np.where(mask, 1e9, power), frequency, axes, exclude=mask)
    np.testing.assert_array_equal(without.density, spoiled.density)
    assert without.count.sum() < binned(scan, power, frequency, axes).count.sum()


def test_the_window_is_even_and_leaves_no_mean():
    """A periodogram does not know which way a profile runs, and holds nothing at zero frequency."""
    z = np.random.default_rng(4).standard_normal(101).cumsum() * 1e-7
    line, back = (periodogram(Profile(heights=h, spacing=1e-6))[0] for h in (z, z[::-1]))
    np.testing.assert_allclose(line, back, rtol=1e-9, atol=1e-12 * line.max())
    assert line[0] < 1e-20 * line.max()
    plane = np.random.default_rng(5).standard_normal((40, 33)).cumsum(0).cumsum(1) * 1e-8
    one, other = (periodogram(Scan(heights=h, spacing=(1e-6, 2e-6)))[0] for h in (plane, plane[::-1, ::-1]))
    np.testing.assert_allclose(one, other, rtol=1e-6, atol=1e-12 * one.max())
    assert one[0, 0] < 1e-20 * one.max()


def test_the_window_correlation_is_that_of_its_fourth_power():
    """Parseval: the squared correlations of all neighbours sum to N sum(w^4) / sum(w^2)^2 = 35/18."""
    w = 0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(64) + 0.5) / 64)
    assert pytest.approx(64 * np.sum(w**4) / np.sum(w**2) ** 2) == HANN_CORRELATION


@pytest.mark.parametrize("shape", [(600,), (48, 60)])
def test_the_spread_of_a_bin_is_that_of_white_noise(shape):
    rng = np.random.default_rng(1)
    found = []
    for _ in range(400):
        z = rng.standard_normal(shape)
        scan = Profile(heights=z, spacing=1e-6) if z.ndim == 1 else Scan(heights=z, spacing=(1e-6, 1.5e-6))
        found.append(spectrum(scan, ratio=1.5))
    density = np.array([s.density for s in found])
    # away from the ends; a bin's border coefficients lose neighbours, so that the spread stated is a little large
    stated = np.mean([s.spread for s in found], axis=0)
    use = slice(3, -1)
    seen = density.std(axis=0) / density.mean(axis=0)
    assert 0.88 < np.mean(seen[use] / stated[use]) < 1.05


def test_a_minority_of_uneven_bins_does_not_change_the_unevenness():
    """Median over 6 bins on either side: 6 uneven neighbours of 13 are smoothed out, 7 are not."""
    even = np.ones(60)
    for run, level in ((6, 1.0), (7, 5.0)):
        values = even.copy()
        values[30 : 30 + run] = 5.0
        assert _running_median(values)[30 + run // 2 - (run % 2 == 0)] == level
    assert (_running_median(np.full(9, 0.3)) == 1).all()


@pytest.mark.parametrize(("ny", "nx", "dx", "dy"), SIZES)
def test_the_structure_function_is_the_mean_over_all_pairs(ny, nx, dx, dy):
    """Brute force over every lag, with missing points, unequal spacings and the longest lag as asked."""
    rng = np.random.default_rng(nx + ny)
    z = rng.standard_normal((ny, nx))
    z[rng.random(z.shape) < 0.1] = np.nan
    scan, longest = Scan(heights=z, spacing=(dx, dy)), 0.3
    sf = structure_function(scan, longest=longest, ratio=1.4)
    limit = longest * min(nx * dx, ny * dy)
    step = max(dx, dy)
    edges = [0.5]
    while edges[-1] * step < limit:
        edges.append(max(edges[-1] + 1, edges[-1] * 1.4))
    rings = {}
    for i in range(-int(limit / dy), int(limit / dy) + 1):
        for j in range(int(limit / dx) + 1):
            r = np.hypot(j * dx, i * dy)
            a = z[max(0, -i) : ny - max(0, i), : nx - j]
            b = z[max(0, i) : ny + min(0, i), j:]
            known = ~np.isnan(a - b)
            if r <= limit * (1 + 1e-12) and r / step >= 0.5 and known.any():
                rings.setdefault(int(np.digitize(r / step, edges)), []).append(
                    (r, np.mean((b - a)[known] ** 2), known.sum())
                )
    expected = np.array([np.mean(rings[k], axis=0) * [1, 1, len(rings[k])] for k in sorted(rings)])
    np.testing.assert_allclose(sf.lag, expected[:, 0], rtol=1e-9)
    np.testing.assert_allclose(sf.value, expected[:, 1], rtol=1e-6)
    np.testing.assert_allclose(sf.pairs, expected[:, 2], rtol=1e-9)


def test_lags_end_at_an_eighth_of_the_shorter_side():
    """A longer lag has few independent pairs: the mean of its squared differences scatters with single waves."""
    z = np.random.default_rng(3).standard_normal((160, 240))
    lag = structure_function(Scan(heights=z, spacing=(3e-6, 2e-6))).lag
    assert 0.9 * 320e-6 / 8 < lag[-1] < 320e-6 / 8


def test_a_scan_without_any_usable_wave_is_called_too_short():
    """6 cycles on 20 points are 3.3 points a cycle, and 4 are needed. It ended in a warning and a band turned round."""
    scan = spectral((20, 20), spacing=1e-5, D=2.4, Rq=1e-6)
    with pytest.raises(NotConverged, match="too short for a spectrum: waves from 40 um up .* from 33.33 um up"):
        fit_fractal(scan, method="psd")
