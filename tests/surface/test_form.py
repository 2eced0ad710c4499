"""Levelling, filling, spikes; filters; spheres and cylinders."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from faying import InputError, Scan
from faying.surface.form import filled, find_spikes, levelled, prepared
from faying.surface.roughness import mean_peak_to_valley, roughness
from faying.surface.scan import Profile
from faying.surface.synthesize import spectral
from tests.helpers.imperfect import with_missing


def grid(n=60, m=80, d=1e-6):
    y, x = np.mgrid[0:n, 0:m] * d
    return x, y


@settings(deadline=None, max_examples=30)
@given(degree=st.integers(0, 5), seed=st.integers(0, 1000), holes=st.booleans())
def test_a_polynomial_is_removed_exactly(degree, seed, holes):
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[-1:1:40j, -1:1:50j]
    z = sum(rng.normal() * x**i * y**j for i in range(degree + 1) for j in range(degree + 1 - i)) + np.zeros_like(x)
    scan = Scan(heights=z * 1e-6, spacing=(1e-6, 1e-6))
    if holes:
        scan = with_missing(scan, share=0.3, seed=seed)
    left = levelled(scan, degree)
    assert np.nanmax(np.abs(left.heights)) < 1e-10 * 1e-6 * (1 + np.abs(z).max())
    assert left.missing == scan.missing


def test_levelling_a_second_time_changes_nothing():
    scan = with_missing(spectral((50, 40), spacing=1e-6, D=2.4, Rq=1e-6, seed=1), share=0.1)
    once = levelled(scan, 3)
    assert np.allclose(levelled(once, 3).heights, once.heights, equal_nan=True, atol=1e-18)


def test_linear_heights_are_filled_exactly_at_isolated_points():
    x, y = grid()
    z = 3 * x - 2 * y
    holed = z.copy()
    holed[10, 10] = holed[20, 33] = np.nan
    full = filled(Scan(heights=holed, spacing=(1e-6, 1e-6))).heights
    assert np.allclose(full, z, atol=1e-15)


def test_a_filled_hole_stays_within_its_border():
    rng = np.random.default_rng(3)
    z = rng.normal(size=(64, 64))
    z[20:40, 10:50] = np.nan
    full = filled(Scan(heights=z, spacing=(1e-6, 1e-6))).heights
    assert not np.isnan(full).any()
    assert full[20:40, 10:50].min() >= np.nanmin(z)
    assert full[20:40, 10:50].max() <= np.nanmax(z)
    assert np.array_equal(full[~np.isnan(z)], z[~np.isnan(z)])


def test_spikes_are_found_and_nothing_else():
    scan = spectral((128, 128), spacing=1e-6, D=2.7, Rq=1e-6, seed=2)
    z = scan.heights.copy()
    where = [(5, 5), (40, 90), (127, 0)]
    for i, j in where:
        z[i, j] += 3e-5
    found = find_spikes(scan.with_heights(z))
    assert sorted(map(tuple, np.argwhere(found).tolist())) == sorted(where)
    assert not find_spikes(scan).any()


def test_spikes_are_counted_and_no_longer_felt():
    scan = spectral((128, 128), spacing=1e-6, D=2.5, Rq=1e-6, seed=4)
    z = scan.heights.copy()
    z[64, 64] = 5e-3
    ready = prepared(scan.with_heights(z))
    assert ready.spikes == 1
    assert not ready.known[64, 64]
    assert roughness(ready).Rq == pytest.approx(roughness(scan).Rq, rel=1e-3)
    assert prepared(scan.with_heights(z), spikes=False).spikes == 0


def test_degree_and_too_few_points():
    scan = Scan(heights=np.random.default_rng(0).normal(size=(20, 20)), spacing=(1e-6, 1e-6))
    with pytest.raises(InputError, match="whole number, at least 0 and at most 8"):
        levelled(scan, 9)
    z = np.full((20, 20), np.nan)
    z[0, :5] = 1.0
    with pytest.raises(InputError, match="cannot fix a polynomial"):
        levelled(scan.with_heights(z), 2)
    with pytest.raises(InputError, match="every point is missing"):
        filled(scan.with_heights(np.full((20, 20), np.nan)))


def test_a_sine_has_the_textbook_roughness():
    x, _ = grid(64, 200)
    a, wave = 2e-6, 20e-6
    scan = Scan(heights=a * np.sin(2 * np.pi * (x + 0.5e-6) / wave), spacing=(1e-6, 1e-6))
    r = roughness(scan, degree=0)
    assert r.Rq == pytest.approx(a / 2**0.5, rel=1e-6)
    assert r.Ra == pytest.approx(2 * a / np.pi, rel=5e-3)
    assert r.kurtosis == pytest.approx(1.5, rel=1e-6)
    # rms of forward differences: 2 a/d sin(pi d/wave) / sqrt 2
    assert r.Rdq == pytest.approx(2 * a / 1e-6 * np.sin(np.pi / 20) / 2**0.5, rel=1e-2)
    assert (r.Sq, r.Sa, r.Sdq) == (r.Rq, r.Ra, r.Rdq)


def test_the_mean_height_of_a_sine_is_twice_its_amplitude():
    """Across the grooves; along them, and between its five parts, a slow wave counts for little."""
    x = np.arange(1000) * 1e-6
    line = 2e-6 * np.sin(2 * np.pi * x / 50e-6)
    assert mean_peak_to_valley(Profile(heights=line, spacing=1e-6)) == pytest.approx(4e-6, rel=0.01)
    grooves = Scan(heights=np.tile(line, (60, 1)), spacing=(1e-6, 1e-6))
    assert mean_peak_to_valley(grooves) == pytest.approx(4e-6, rel=0.01)
    turned = Scan(heights=np.tile(line, (60, 1)).T, spacing=(1e-6, 1e-6))
    assert mean_peak_to_valley(turned) == pytest.approx(4e-6, rel=0.01)
    slow = 3e-6 * np.cos(2 * np.pi * x / x[-1])
    assert mean_peak_to_valley(Profile(heights=slow, spacing=1e-6)) < 0.7 * np.ptp(slow)
