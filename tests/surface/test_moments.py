"""Moments of ideal series, their exact inversion, and the network that learns it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from faying import InputError
from faying.surface import fpenn
from faying.surface.convention import prefactor
from faying.surface.moments import from_series_moments, series_frequencies
from tests.helpers.weierstrass import weierstrass_mandelbrot


def series_moments(D, G, *, length, terms, gamma=1.5, convention="yan-komvopoulos"):
    """m0 [m2], m2 [-], m4 [1/m2] of the ideal series."""
    f = gamma ** np.arange(terms) / length
    power = prefactor(convention, gamma) * np.log(gamma) * G ** (2 * D - 4) * f ** (2 * D - 6) / 2
    return [float(np.sum(power * (2 * np.pi * f) ** (2 * k))) for k in range(3)]


def test_the_paper_s_pair_returns_exactly(published):
    # Ds = 1.39, G = 1.53e-10 m over 4 mm
    m0, m2, _ = series_moments(2.39, 1.53e-10, length=4e-3, terms=17)
    D, G = from_series_moments(m0, m2, length=4e-3, terms=17)
    source, why = "doi:10.3390/fractalfract8100611, section 4", "from the moments of the ideal series: no noise"
    published("dimension of the profile", 1.39, D - 1, tol=1e-13, source=source, why=why)
    published("fractal roughness G", 1.53e-10, G, unit="m", rel=1e-11, source=source, why=why)


@given(
    D=st.floats(2.02, 2.98),
    log_G=st.floats(-14, -6),
    terms=st.integers(3, 45),
    gamma=st.floats(1.2, 3.0),
    name=st.sampled_from(["yan-komvopoulos", "majumdar-bhushan"]),
)
def test_any_pair_returns(D, log_G, terms, gamma, name):
    G, L = 10**log_G, 3e-3
    m = series_moments(D, G, length=L, terms=terms, gamma=gamma, convention=name)
    d, g = from_series_moments(m[0], m[1], length=L, terms=terms, gamma=gamma, convention=name)
    assert d == pytest.approx(D, abs=1e-9)
    assert np.log(g) == pytest.approx(np.log(G), abs=1e-6 + 1e-8 / (D - 2) ** 2)


def test_moments_are_those_of_the_heights_themselves():
    # one profile long enough to hold whole periods of a series with gamma = 2
    D, G, L, n = 2.4, 1e-9, 1e-3, 4096
    line = weierstrass_mandelbrot(n, spacing=L / n, D=D, G=G, gamma=2.0, length=L, shortest=L / 128, seed=3)
    m0, m2, m4 = series_moments(D, G, length=L, terms=8, gamma=2.0)
    z = line.heights - line.heights.mean()
    slope = np.gradient(z, L / n, edge_order=2)
    bend = np.diff(z, 2) / (L / n) ** 2
    assert z.var() == pytest.approx(m0, rel=1e-9)
    assert np.mean(slope**2) == pytest.approx(m2, rel=2e-2)
    assert np.mean(bend**2) == pytest.approx(m4, rel=2e-2)


def test_impossible_moments_are_refused():
    with pytest.raises(InputError, match="positive"):
        from_series_moments(-1.0, 1.0, length=1e-3, terms=10)
    with pytest.raises(InputError, match="fits no dimension"):
        from_series_moments(1e-12, 1e9, length=1e-3, terms=10)
    with pytest.raises(InputError, match="terms >= 2"):
        series_frequencies(1e-3, 1)


def test_the_network_finds_the_paper_s_pair_within_its_stated_error():
    m = series_moments(2.39, 1.53e-10, length=4e-3, terms=17)
    D, G = fpenn.from_series_moments(*m, length=4e-3, terms=17)
    known = fpenn.trained_range()
    assert abs(D - 2.39) <= known.error_D
    level = (2 * D - 4) * np.log(G / 4e-3) - 0.78 * np.log(1.53e-10 / 4e-3)
    assert abs(level) <= known.error_log_level
    assert known.error_D < 5e-3


@settings(max_examples=200)
@given(D=st.floats(2.05, 2.95), log_ratio=st.floats(-22, -6), terms=st.integers(4, 40), length=st.floats(1e-5, 1.0))
def test_the_network_keeps_its_stated_error_and_has_no_unit(D, log_ratio, terms, length):
    m = series_moments(D, np.exp(log_ratio) * length, length=length, terms=terms)
    found, _ = fpenn.from_series_moments(*m, length=length, terms=terms)
    # the stated largest error is that of 1e5 random cases; hypothesis looks at the corners
    assert abs(found - D) <= 3 * fpenn.trained_range().error_D


def test_stated_errors_hold_on_fresh_cases():
    rng = np.random.default_rng(99)
    known = fpenn.trained_range()
    errors = []
    for _ in range(500):
        D, terms = rng.uniform(*known.D), int(rng.integers(known.terms[0], known.terms[1] + 1))
        m = series_moments(D, np.exp(rng.uniform(*known.log_ratio)), length=1.0, terms=terms)
        errors.append(fpenn.from_series_moments(*m, length=1.0, terms=terms)[0] - D)
    assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(known.rms_D, rel=0.5)


def test_the_network_refuses_what_it_has_not_seen():
    with pytest.raises(InputError, match="4 to 40"):
        fpenn.from_series_moments(1.0, 1.0, 1.0, length=1.0, terms=3)
    with pytest.raises(InputError, match="positive"):
        fpenn.from_series_moments(0.0, 1.0, 1.0, length=1.0, terms=10)
