"""Hardness against the size of an indentation: the printed fit, and the mean spot of a rough contact by its theory."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import erfc

from faying.errors import InputError
from faying.hardness import VickersHardness


def test_brinell_gives_c1_and_c2_in_their_printed_units() -> None:
    # the fit as it is printed, in MPa, worked out by hand for HB = 3178 MPa: 4.0 - 5.77 + 4.0 - 0.61 = 1.62
    law = VickersHardness.from_brinell(3.178e9)
    assert law.c1 == pytest.approx(1.62 * 3.178e9, rel=1e-12)
    assert law.c2 == pytest.approx(-0.370 + 0.442 / 1.62, rel=1e-12)


@pytest.mark.parametrize("k", [0.42, 0.6, 1.0, 1.6, 2.3])
def test_both_printed_forms_of_the_power_agree(k: float) -> None:
    """Bahrami and others 2006, doi:10.1115/1.2110231: c2 = -0.57 + 0.82 k - 0.41 k^2 + 0.06 k^3 for the same data."""
    cubic = -0.57 + 0.82 * k - 0.41 * k**2 + 0.06 * k**3
    assert VickersHardness.from_brinell(k * 3.178e9).c2 == pytest.approx(cubic, abs=0.03)


def test_small_indentations_are_harder_and_large_ones_come_near_brinell() -> None:
    for brinell in np.linspace(1.35e9, 7.5e9, 15):
        law = VickersHardness.from_brinell(float(brinell))
        assert law.c2 < 0.06
        # an indentation of some 0.1 to 1 mm is that of the Brinell test
        assert 0.6 < float(law.at(0.3e-3)) / brinell < 1.9
    soft = VickersHardness.from_brinell(1.7e9)
    assert float(soft.at(1e-6)) == pytest.approx(soft.c1)
    assert np.all(np.diff(soft.at(np.geomspace(1e-7, 1e-4, 9))) < 0)
    # large ones are those of the bulk
    assert soft.at(1e-3) == soft.least


@pytest.mark.parametrize("c2", [-0.45, -0.25, -0.1, 0.05])
@pytest.mark.parametrize("over", [1e-5, 1e-4, 1e-3, 1e-2])
def test_the_explicit_formula_solves_the_implicit_pair(c2: float, over: float) -> None:
    """p/H = erfc(l/sqrt 2)/2, spots of mean radius sqrt(8/pi) (sigma/m) exp(l^2/2) erfc(l/sqrt 2), of the same theory.

    The hardness at a Vickers indentation of the spot's area, d = sqrt(2 pi) a, is solved for here by bisection. The
    explicit formula stands for d by a power of p/H that fits it to 12 %; the hardness then is right to |c2| times that.
    """
    sigma, slope = 0.8e-6, 0.12
    law = VickersHardness(c1=6.2e9, c2=c2)

    def spot(ratio: float) -> float:
        separation = brentq(lambda x: erfc(x / np.sqrt(2)) / 2 - ratio, 0, 8, xtol=1e-14)
        a = np.sqrt(8 / np.pi) * sigma / slope * np.exp(separation**2 / 2) * erfc(separation / np.sqrt(2))
        return float(np.sqrt(2 * np.pi) * a)

    p = over * float(law.at(1.62 * sigma / slope))
    ratio = brentq(lambda r: r * float(law.at(spot(r))) - p, 1e-9, 0.4, xtol=1e-18, rtol=1e-13)
    assert float(law.contact(p, sigma, slope)) == pytest.approx(p / ratio, rel=0.12 * abs(c2))


def test_without_a_size_the_contact_has_one_hardness() -> None:
    law = VickersHardness(c1=2e9, c2=0.0)
    assert np.allclose(law.contact([1e5, 1e7], 1e-6, 0.1), 2e9, rtol=1e-12)
    assert law.contact(np.full((2, 3), 1e6), 1e-6, 0.1).shape == (2, 3)


@pytest.mark.parametrize("brinell", [1.2e9, 7.7e9, float("nan"), -1.0])
def test_brinell_outside_the_fit_is_an_error_with_the_range(brinell: float) -> None:
    with pytest.raises(InputError, match=r"covers 1.3 to 7.6 GPa; give c1 and c2"):
        VickersHardness.from_brinell(brinell)


def test_faults_say_what_is_allowed() -> None:
    with pytest.raises(InputError, match="c1 = 0 Pa; it must be positive"):
        VickersHardness(c1=0, c2=-0.2)
    with pytest.raises(InputError, match=r"c2 = -1.5; it must be between -1 and 1"):
        VickersHardness(c1=5e9, c2=-1.5)
    law = VickersHardness(c1=5e9, c2=-0.2)
    with pytest.raises(InputError, match="diagonal of an indentation must be positive"):
        law.at([1e-6, 0.0])
    with pytest.raises(InputError, match="pressures, sigma = 1e-06 m and slope = 0 must be positive"):
        law.contact(1e6, 1e-6, 0.0)
