"""The laws of contact conductance: their fits against the theories that they stand for, and what a scan gives them."""

from math import pi, sqrt

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import erfc

from faying import RIGID, ContactPair, InputError, Material
from faying.contact import CMY, Mikic, SurfaceInputs
from faying.contact.conductance import contact_conductance, heat_conductance
from faying.hardness import VickersHardness
from tests.helpers.published import Published

STEEL = Material(name="steel", E=207e9, nu=0.3, hardness=2e9, conductivity=50.0)
PAIR = ContactPair(STEEL, STEEL)
SIGMA, SLOPE = 1.3e-6, 0.14
LAW = CMY(h_rms=SIGMA, mean_slope=SLOPE, pair=PAIR)
ELASTIC = Mikic(h_rms=SIGMA, mean_slope=SLOPE, pair=PAIR)
RANGE = np.geomspace(1e-6, 2.3e-2, 25)


def separation(ratio: float, share: float) -> float:
    """Y/sigma at which a share of the overlap of Gaussian heights, erfc(Y/(sqrt 2 sigma)), is p/H."""
    return float(brentq(lambda x: share * erfc(x / sqrt(2)) - ratio, -3, 9, xtol=1e-14))


def conducted(k_n: np.ndarray, pair: ContactPair = PAIR) -> np.ndarray:
    """h sigma/(m K_s)."""
    return heat_conductance(k_n, pair) * SIGMA / (SLOPE * 50.0)


def test_cmy_is_the_theory_of_spots_that_yield_within_its_fit(published: Published) -> None:
    """h sigma/(m K_s) = exp(-l^2/2)/(2 sqrt(2 pi) (1 - sqrt(p/H))^1.5), p/H = erfc(l/sqrt 2)/2."""
    theory = []
    for ratio in RANGE:
        l = separation(ratio, 1 / 2)
        theory.append(np.exp(-(l**2) / 2) / (2 * sqrt(2 * pi)) / (1 - sqrt(erfc(l / sqrt(2)) / 2)) ** 1.5)
    r = LAW.at_pressure(RANGE * 2e9)
    assert conducted(r.k_n) == pytest.approx(theory, rel=0.016)  # "within about 1.5 %", as the fit is stated
    assert r.area == pytest.approx(RANGE, rel=1e-9)
    # the published curve itself
    assert conducted(r.k_n) == pytest.approx(1.25 * RANGE**0.95, rel=1e-9)
    published(
        "dimensionless conductance h sigma/(m K_s) of spots that yield at p/H 1e-3",
        1.25e-3 * 10**0.15,
        conducted(LAW.at_pressure(2e6).k_n),
        source="doi:10.1016/0017-9310(69)90011-8",
        rel=0.01,
    )


def test_mikic_is_the_theory_of_elastic_spots_within_its_fit(published: Published) -> None:
    """Half of the overlap touches: p/H_e = erfc(l/sqrt 2)/4 with H_e = E* m/sqrt 2, and the spots conduct as in CMY."""
    theory = []
    for ratio in RANGE:
        l = separation(ratio, 1 / 4)
        theory.append(np.exp(-(l**2) / 2) / (4 * sqrt(pi)) / (1 - sqrt(erfc(l / sqrt(2)) / 4)) ** 1.5)
    p = RANGE * PAIR.E_star * SLOPE / sqrt(2)
    r = ELASTIC.at_pressure(p)
    assert conducted(r.k_n) == pytest.approx(theory, rel=0.036)
    middle = (RANGE > 8e-6) & (RANGE < 1e-2)
    assert conducted(r.k_n)[middle] == pytest.approx(np.array(theory)[middle], rel=0.018)
    assert conducted(r.k_n) == pytest.approx(1.54 * (sqrt(2) * p / (PAIR.E_star * SLOPE)) ** 0.94, rel=1e-9)
    published(
        "dimensionless conductance h sigma/(m K_s) of elastic spots at sqrt(2) p/(m E*) 1e-3",
        1.54e-3 * 10**0.18,
        conducted(ELASTIC.at_pressure(1e-3 * PAIR.E_star * SLOPE / sqrt(2)).k_n),
        source="doi:10.1016/0017-9310(74)90082-9",
        rel=0.01,
    )


def test_spots_of_the_theory_add_up_to_the_stiffness() -> None:
    """k_n = 2 E* n a: n spots per area and their mean radius a, as Cooper, Mikic and Yovanovich count them."""
    for ratio in (1e-4, 1e-3):
        l = separation(ratio, 1 / 2)
        n = (SLOPE / SIGMA) ** 2 * np.exp(-(l**2)) / erfc(l / sqrt(2)) / 16
        a = sqrt(8 / pi) * SIGMA / SLOPE * np.exp(l**2 / 2) * erfc(l / sqrt(2))
        alone = 2 * PAIR.E_star * n * a  # spots far apart
        assert n * pi * a**2 == pytest.approx(ratio, rel=1e-9)
        assert float(LAW.at_pressure(ratio * 2e9).k_n) == pytest.approx(alone / (1 - sqrt(ratio)) ** 1.5, rel=0.015)


@pytest.mark.parametrize("size", [{}, {"c1": 6e9, "c2": -0.26}])
def test_the_loading_curve_of_cmy_is_the_closing_of_the_mean_planes(size: dict[str, float]) -> None:
    law = CMY(h_rms=SIGMA, mean_slope=SLOPE, pair=PAIR, **size)
    low, high = 1e6, 30e6
    ends = [SIGMA * separation(float(law.at_pressure(p).area), 1 / 2) for p in (low, high)]
    closing = quad(lambda t: np.exp(t) / float(law.at_pressure(np.exp(t)).k_load), np.log(low), np.log(high))[0]
    assert closing == pytest.approx(ends[0] - ends[1], rel=1e-7)


def test_loading_is_never_stiffer_than_unloading() -> None:
    p = np.geomspace(1e4, 2e8, 40)
    for hardness in (0.5e9, 2e9, 8e9, 30e9):
        r = LAW.with_(hardness=hardness).at_pressure(p)
        assert np.all(r.k_load <= r.k_n)
    assert ELASTIC.at_pressure(p).k_load is None


def test_the_hardness_of_small_spots_enters_as_in_its_explicit_formula() -> None:
    size = VickersHardness.from_brinell(1.7e9)
    p = np.geomspace(1e5, 1e8, 7)
    r = LAW.with_(c1=size.c1, c2=size.c2).at_pressure(p)
    H = size.contact(p, SIGMA, SLOPE)
    assert p / r.area == pytest.approx(H, rel=1e-9)
    assert r.k_n == pytest.approx(1.25 * PAIR.E_star * SLOPE / SIGMA * (p / H) ** 0.95, rel=1e-9)


def test_the_hardness_is_that_given_else_that_of_the_pair() -> None:
    hard = LAW.with_(hardness=4e9)
    assert float(hard.at_pressure(1e6).area) == pytest.approx(1e6 / 4e9, rel=1e-9)
    assert float(LAW.at_pressure(1e6).area) == pytest.approx(1e6 / 2e9, rel=1e-9)
    assert "hardness of steel, 2000 MPa, at any size" in LAW.assumptions[0]
    assert hard.assumptions == ()
    assert hard.facts()["c1 [Pa]"] == 4e9
    soft = Material(name="soft", E=70e9, nu=0.3)
    with pytest.raises(InputError, match=r"CMY: neither hardness nor .* or give hardness, or c1 and c2"):
        CMY(h_rms=SIGMA, mean_slope=SLOPE, pair=ContactPair(soft, soft))
    with pytest.raises(InputError, match="give hardness, or c1 and c2, not both"):
        LAW.with_(hardness=2e9, c1=5e9, c2=-0.2)
    with pytest.raises(InputError, match="c1 and c2 belong together"):
        LAW.with_(c1=5e9)
    with pytest.raises(InputError, match=r"CMY: h_rms = 0 m; it must be positive"):
        LAW.with_(h_rms=0.0)


def test_mikic_is_elastic_work_and_stiffness_agree() -> None:
    p = 2e7
    work = quad(lambda q: q / float(ELASTIC.at_pressure(q).k_n), p * 1e-4, p)[0]
    rest = float(ELASTIC.at_pressure(p * 1e-4).energy_n)
    assert float(ELASTIC.at_pressure(p).energy_n) == pytest.approx(work + rest, rel=1e-6)
    r = ELASTIC.at_pressure(p)
    assert float(r.k_t / r.k_n) == pytest.approx(2 * 0.7 / 1.7)
    assert r.loss_n is None
    assert r.loss_t is None


def test_just_one_of_the_two_laws_is_valid_on_a_surface() -> None:
    """Spots yield where the mean pressure of elastic ones, E* m/sqrt 2, passes the hardness."""
    for slope in (0.005, 0.02, 0.05, 0.2):
        plastic = bool(CMY(h_rms=SIGMA, mean_slope=slope, pair=PAIR).at_pressure(1e6).valid)
        elastic = bool(Mikic(h_rms=SIGMA, mean_slope=slope, pair=PAIR).at_pressure(1e6).valid)
        assert plastic is not elastic
        assert plastic is (PAIR.E_star * slope / sqrt(2) > 2e9)
    assert not LAW.at_pressure(1e8).valid  # p/H 0.05
    assert not LAW.at_pressure(1e3).valid
    assert not ELASTIC.at_pressure(3e3).valid


def test_the_mean_slope_of_a_scan() -> None:
    # a sine along x, nothing along y: the mean absolute slope is 4 A/wave along x, half of that over both
    x = np.arange(2000) * 1e-6
    z = np.tile(1e-6 * np.sin(2 * pi * x / 100e-6), (40, 1)) + np.random.default_rng(0).normal(size=(40, 2000)) * 1e-12
    s = SurfaceInputs.from_heights(z, (1e-6, 1e-6), D=2.4, G=1e-10)
    assert s.mean_slope == pytest.approx(4e-6 / 100e-6 / 2, rel=1e-3)
    # white heights are Gaussian in their differences as well
    noise = np.random.default_rng(1).normal(size=(300, 300)) * 1e-7
    n = SurfaceInputs.from_heights(noise, (1e-6, 1e-6), D=2.4, G=1e-10)
    assert n.mean_slope == pytest.approx(sqrt(2 / pi) * sqrt(2) * 1e-7 / 1e-6, rel=1e-2)
    noise[100:130, 100:130] = np.nan
    assert SurfaceInputs.from_heights(noise, (1e-6, 1e-6), D=2.4, G=1e-10).mean_slope == pytest.approx(
        n.mean_slope, rel=1e-2
    )
    ideal = SurfaceInputs.from_fractal(D=2.39, G=1.53e-10, scan_area=16e-6, shortest=1e-5)
    assert ideal.mean_slope == pytest.approx(sqrt(2 / pi * ideal.m2))


def test_two_faces_alike_have_the_slope_of_their_sum() -> None:
    from faying.contact.two_faces import faces_of
    from faying.surface.synthesize import spectral

    scan = spectral((96, 96), spacing=2e-6, D=2.3, Rq=0.4e-6, longest=60e-6, seed=3)
    one, two = (faces_of(scan, counter).unfitted.inputs for counter in ("smooth", "same"))
    assert isinstance(one, SurfaceInputs)
    assert isinstance(two, SurfaceInputs)
    assert two.mean_slope == pytest.approx(sqrt(2) * one.mean_slope)
    law = CMY.from_surface(two, PAIR)
    assert (law.h_rms, law.mean_slope) == (two.h_rms, two.mean_slope)
    # the heights of the two laid on each other say the same
    heights = faces_of(scan, "same").unfitted.scan
    assert heights is not None
    laid = SurfaceInputs.from_heights(heights.heights, heights.spacing, D=2.3, G=1e-10)
    assert laid.mean_slope == pytest.approx(two.mean_slope, rel=0.05)


def test_heat_needs_two_conductors() -> None:
    assert heat_conductance(1e12, PAIR) == pytest.approx(
        contact_conductance(1e12, E_star=PAIR.E_star, resistivities=(1 / 50, 1 / 50))
    )
    with pytest.raises(InputError, match="the rigid plane does not: name the material of the other face"):
        heat_conductance(1e12, ContactPair(STEEL, RIGID))
    bare = Material(name="bare", E=200e9, nu=0.3)
    with pytest.raises(InputError, match=r"'bare' has none: give conductivity, for example 50 W/\(m K\)"):
        heat_conductance(1e12, ContactPair(STEEL, bare))


def test_a_pair_with_a_vickers_law_gives_it() -> None:
    size = VickersHardness(c1=5e9, c2=-0.2)

    class Sized(ContactPair):
        @property
        def vickers(self) -> VickersHardness:
            return size

    pair = Sized(STEEL, STEEL)
    p = np.geomspace(1e5, 1e7, 5)
    own = CMY(h_rms=SIGMA, mean_slope=SLOPE, pair=pair)
    assert p / own.at_pressure(p).area == pytest.approx(size.contact(p, SIGMA, SLOPE), rel=1e-9)
    assert own.assumptions == ()
    # a number counts before it
    assert 1e6 / float(own.with_(hardness=2e9).at_pressure(1e6).area) == pytest.approx(2e9)
