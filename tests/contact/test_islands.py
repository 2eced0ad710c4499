"""The island distribution and the one integral behind every total of the fractal laws."""

from math import log, sqrt

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.integrate import quad

from faying.contact.models.islands import Islands, domain_extension, power_integral
from faying.errors import InputError

# psi of Wang and Komvopoulos for a surface of dimension D, tabulated in theory notes to four decimals
PSI = {
    2.1: 2.4435,
    2.2: 2.3014,
    2.3: 2.1837,
    2.39: 2.0940,
    2.4: 2.0849,
    2.5: 2.0007,
    2.6: 1.9283,
    2.7: 1.8654,
    2.8: 1.8103,
    2.9: 1.7616,
}


@pytest.mark.parametrize(("D", "psi"), PSI.items())
def test_psi_has_its_tabulated_values(D: float, psi: float) -> None:
    assert domain_extension(D) == pytest.approx(psi, abs=5.1e-5)


def test_psi_tends_to_its_two_limits() -> None:
    assert domain_extension(2 + 1e-9) == pytest.approx(((1 + sqrt(5)) / 2) ** 2, rel=1e-8)
    assert domain_extension(3 - 1e-9) == pytest.approx(np.e - 1, rel=1e-8)


@given(st.floats(2.001, 2.999))
def test_psi_solves_its_equation(D: float) -> None:
    psi = domain_extension(D)
    left = psi ** ((3 - D) / 2) - (1 + psi ** (-(D - 1) / 2)) ** (-(3 - D) / (D - 1))
    assert left == pytest.approx((3 - D) / (D - 1), rel=1e-10, abs=1e-13)
    assert psi > 1


@pytest.mark.parametrize("D", [2.0, 3.0, 1.4, float("nan")])
def test_psi_is_refused_outside_two_to_three(D: float) -> None:
    with pytest.raises(InputError, match="between 2 and 3"):
        domain_extension(D)


@given(st.floats(-2, 3), st.floats(1e-6, 1), st.floats(1e-6, 1))
def test_power_integral_equals_quadrature(e: float, a: float, b: float) -> None:
    lower, upper = sorted((a, b))
    assume(upper > 1.01 * lower)  # narrow ranges: below, since quad's own limits are rounded
    # in t = ln x the integrand is exp(e t): smooth, so quad reaches rounding
    expected = quad(lambda t: np.exp(e * t), log(lower), log(upper), epsabs=0, epsrel=1e-12)[0]
    assert float(power_integral(e, lower, upper)) == pytest.approx(expected, rel=1e-11, abs=1e-300)


@given(st.floats(-1e-7, 1e-7), st.floats(1e-6, 0.9))
def test_power_integral_passes_through_exponent_zero(e: float, lower: float) -> None:
    # (1 - exp(-e s))/e = s - e s^2/2 + e^2 s^3/6 with s = ln(1/lower)
    s = -log(lower)
    assert float(power_integral(e, lower, 1.0)) == pytest.approx(s - e * s**2 / 2 + e**2 * s**3 / 6, rel=1e-14)


@given(st.floats(-2, 3), st.floats(1e-6, 0.9), st.floats(-40, -7))
def test_power_integral_over_a_narrow_range(e: float, lower: float, log2_width: float) -> None:
    upper = lower * (1 + 2**log2_width)
    h = (upper - lower) / lower
    # x^(e-1) expanded about the lower end
    series = (
        lower**e * h * (1 + (e - 1) * h / 2 + (e - 1) * (e - 2) * h**2 / 6 + (e - 1) * (e - 2) * (e - 3) * h**3 / 24)
    )
    assert float(power_integral(e, lower, upper)) == pytest.approx(series, rel=1e-15 / h + 5 * h**4 + 1e-13)


def test_power_integral_of_an_empty_range_is_zero() -> None:
    assert power_integral(0.5, [0.5, 0.7, 0.0], [0.5, 0.2, 0.0]).tolist() == [0.0, 0.0, 0.0]


def test_power_integral_from_zero_needs_a_positive_exponent() -> None:
    assert float(power_integral(0.25, 0.0, 0.5)) == pytest.approx(0.5**0.25 / 0.25, rel=1e-15)
    with pytest.raises(InputError, match="diverges"):
        power_integral(0.0, 0.0, 1.0)


@given(st.floats(2.01, 2.99))
def test_islands_sum_to_the_area_that_mandelbrot_gives(D: float) -> None:
    # sum of a' over all islands, in units of al': (D-1)/(3-D) psi^((3-D)/2)
    islands = Islands(D)
    assert float(islands.total(1.0, 0.0, 1.0)) == pytest.approx(
        (D - 1) / (3 - D) * islands.psi ** ((3 - D) / 2), rel=1e-12
    )
