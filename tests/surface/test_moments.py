"""Moments of ideal series, and their exact inversion."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from faying import InputError
from faying.surface.convention import G_from_density, prefactor
from faying.surface.moments import invert_ratio
from tests.helpers.weierstrass import weierstrass_mandelbrot


def series_moments(D, G, *, length, terms, gamma=1.5, convention="yan-komvopoulos"):
    """m0 [m2], m2 [-], m4 [1/m2] of the ideal series."""
    f = gamma ** np.arange(terms) / length
    power = prefactor(convention, gamma) * np.log(gamma) * G ** (2 * D - 4) * f ** (2 * D - 6) / 2
    return [float(np.sum(power * (2 * np.pi * f) ** (2 * k))) for k in range(3)]


def from_series_moments(m0, m2, *, length, terms, gamma=1.5, convention="yan-komvopoulos"):
    """D and G [m] of the series whose moments these are."""
    f = gamma ** np.arange(terms) / length
    slope = invert_ratio(m2 / m0 / (2 * np.pi) ** 2, f, f)  # A_n^2 ~ f_n f_n^-(5-2Ds)
    D = (7 - slope) / 2
    # m0 = B ln(gamma) sum f f^-slope with B = c G^(2Ds-2)/2
    level = np.log(m0 / np.log(gamma)) - np.log(np.sum(f ** (1 - slope)))
    return D, G_from_density(D, level, prefactor(convention, gamma))


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
    with pytest.raises(InputError, match="fits no dimension"):
        from_series_moments(1e-12, 1e9, length=1e-3, terms=10)
