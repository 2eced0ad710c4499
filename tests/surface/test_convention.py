"""The closed forms that tie D and G to spectra, structure functions and rms heights, against quadrature."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from faying.errors import InputError
from faying.surface import convention as cv

DIMENSIONS = st.floats(2.05, 2.95)


@given(D=DIMENSIONS)
def test_cut_factor_is_the_mean_power_of_the_cosine(D):
    mean = quad(lambda t: abs(math.cos(t)) ** (6 - 2 * D), 0, math.pi / 2)[0] * 2 / math.pi
    assert cv.cut_factor(D) == pytest.approx(mean, rel=1e-7)


def test_cut_factor_at_the_paper_s_dimension():
    assert cv.cut_factor(2.39) == pytest.approx(0.597, abs=5e-4)


@given(D=DIMENSIONS)
def test_structure_coefficient_is_the_integral_over_the_spectrum(D):
    # SF(tau) = 2 B tau^(6-2D) k, k = integral of (1 - cos(2 pi u)) u^-(7-2D) du
    p, end = 7 - 2 * D, 40
    # 1 - cos = 2 sin^2, with one power of u^2 taken out at zero; period by period; beyond, the mean and the first term
    # of the cosine's asymptotic series
    head = sum(quad(lambda u: 2 * math.sin(math.pi * u) ** 2 * u**-p, k, k + 1)[0] for k in range(1, end))
    start = quad(lambda v: 2 * math.sin(math.pi * math.exp(v)) ** 2 * math.exp(v * (1 - p)), -60, 0, limit=200)[0]
    start += 2 * math.pi**2 * math.exp(-60 * (3 - p)) / (3 - p)
    tail = end ** (1 - p) / (p - 1) - p * end ** (-p - 1) / (2 * math.pi) ** 2
    assert cv.structure_coefficient(D) == pytest.approx(start + head + tail, rel=1e-6)


def test_structure_coefficient_passes_the_pole_of_gamma_smoothly():
    near = [cv.structure_coefficient(2.5 + d) for d in (-1e-6, 0.0, 1e-6)]
    assert near[1] == pytest.approx((near[0] + near[2]) / 2, rel=1e-9)
    assert near[1] == pytest.approx(math.pi**2, rel=1e-12)  # Ds = 1.5: 2 pi times pi/2


@given(D=DIMENSIONS, log_G=st.floats(-14, -7), side=st.floats(1e-4, 1e-1))
def test_Rq_and_G_invert_each_other_and_match_the_spectrum(D, log_G, side):
    G = 10**log_G
    rq = cv.implied_Rq(D, G, side)
    # S(f) df = S(f) f d(ln f), from one cycle over the side upwards
    decay = 6 - 2 * D
    power = cv.density(D, G) * side**decay * quad(lambda v: math.exp(-decay * v), 0, 30 / decay)[0]
    assert rq**2 == pytest.approx(power, rel=1e-6)
    assert cv.G_from_Rq(D, rq, side) == pytest.approx(G, rel=1e-8)


def test_the_two_conventions_differ_as_the_notes_say():
    D, log_b = 2.39, math.log(1e-9)
    ratio = cv.G_from_density(D, log_b, 1.0) / cv.G_from_density(D, log_b, cv.prefactor("majumdar-bhushan", 1.5))
    # the same heights need a smaller G where c is larger
    assert ratio == pytest.approx(3.18, rel=2e-3)


def test_paper_s_numbers_imply_far_more_than_its_roughness():
    assert cv.implied_Rq(2.39, 1.53e-10, 4e-3) == pytest.approx(3.3e-6, rel=0.02)


@pytest.mark.parametrize("D", [2.0, 3.0, 1.39, float("nan")])
def test_D_outside_two_and_three_is_refused(D):
    with pytest.raises(InputError, match="between 2 and 3"):
        cv.check_dimension(D)


def test_unknown_convention_and_gamma():
    with pytest.raises(InputError, match="yan-komvopoulos"):
        cv.prefactor("other", 1.5)
    with pytest.raises(InputError, match="greater than 1"):
        cv.prefactor("yan-komvopoulos", 1.0)
    with pytest.raises(InputError, match="positive"):
        cv.G_from_Rq(2.4, -1.0, 1.0)
