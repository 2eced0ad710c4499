"""Greenwood and Williamson: closed moments for Hertz, quadrature and derivatives for every asperity."""

from itertools import pairwise
from math import gamma, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import ndtr, pbdv

from faying import RIGID, ContactPair, InputError, Material
from faying.contact import GreenwoodWilliamson, SurfaceInputs, asperity
from faying.contact.build import build
from faying.contact.inputs import RoughSurface

PAIR = ContactPair(Material(name="m", E=200e9, nu=0.3, hardness=994e6, yield_strength=355e6), RIGID)
LAW = GreenwoodWilliamson(density=1e10, radius=20e-6, sigma=0.5e-6, pair=PAIR)
ASPERITIES = list(asperity.models())


def moment(n: float, h: float) -> float:
    """(1/sqrt(2 pi)) int_h^inf (s - h)^n exp(-s^2/2) ds by parabolic cylinder functions."""
    return gamma(n + 1) / sqrt(2 * pi) * np.exp(-(h**2) / 4) * float(pbdv(-n - 1, h)[0])


@given(st.floats(-3, 6), st.floats(-2, 2), st.floats(-2, 2))
def test_hertz_has_its_closed_moments(h: float, log_radius: float, log_sigma: float) -> None:
    R, s, eta = 20e-6 * 10**log_radius, 0.5e-6 * 10**log_sigma, 1e10
    law = LAW.with_(radius=R, sigma=s)
    r = law.at_closure(h * s)
    E = PAIR.E_star
    exact = np.exp(-(h**2) / 2) / sqrt(2 * pi) - h * float(ndtr(-h))
    assert float(r.area) == pytest.approx(pi * eta * R * s * exact, rel=1e-11)
    # scipy's parabolic cylinder functions are good to nine digits
    assert float(r.pressure) == pytest.approx(4 / 3 * E * eta * sqrt(R) * s**1.5 * moment(1.5, h), rel=1e-8)
    assert float(r.area) == pytest.approx(pi * eta * R * s * moment(1, h), rel=1e-8)
    assert float(r.k_n) == pytest.approx(2 * E * eta * sqrt(R * s) * moment(0.5, h), rel=1e-8)
    assert float(r.energy_n) == pytest.approx(8 / 15 * E * eta * sqrt(R) * s**2.5 * moment(2.5, h), rel=1e-8)


@pytest.mark.parametrize("name", ASPERITIES)
@settings(max_examples=2)
@given(h=st.floats(-2, 5), log_sigma=st.floats(-1.5, 1.5))
def test_every_asperity_equals_quadrature(name: str, h: float, log_sigma: float) -> None:
    s = 0.5e-6 * 10**log_sigma
    law = LAW.with_(sigma=s, asperity=name)
    model = asperity.models()[name](R=20e-6, pair=PAIR)
    r = law.at_closure(h * s)
    ends = [0.0, *(b * model.critical for b in model.borders if b * model.critical < 11 * s)]
    cuts = sorted({*ends, *np.linspace(0, 11 * s, 9)})
    for field, value in (("force", r.pressure), ("area", r.area), ("energy", r.energy_n)):
        expected = sum(
            quad(
                lambda t, f=field: float(getattr(model.at(t), f)) * np.exp(-((t / s + h) ** 2) / 2),
                a,
                b,
                epsabs=0,
                epsrel=1e-9,
            )[0]
            for a, b in pairwise(cuts)
        )
        assert float(value) == pytest.approx(1e10 * expected / (s * sqrt(2 * pi)), rel=1e-7), field


@pytest.mark.parametrize("name", ASPERITIES)
@settings(max_examples=12)
@given(h=st.floats(-2.5, 5.5), log_sigma=st.floats(-1.5, 1.5))
def test_stiffness_is_the_derivative_and_energy_the_integral(name: str, h: float, log_sigma: float) -> None:
    # with the jumps of CEB, KE, JG and Ghaednia in
    s = 0.5e-6 * 10**log_sigma
    law = LAW.with_(sigma=s, asperity=name)
    step = 1e-3
    at = law.at_closure(s * (h + step * np.array([-2, -1, 0, 1, 2])))
    slope = lambda v: (v[4] - 8 * v[3] + 8 * v[1] - v[0]) / (12 * step * s)  # noqa: E731  # -d/dd
    assert slope(at.pressure) == pytest.approx(at.k_n[2], rel=1e-7)
    assert slope(at.energy_n) == pytest.approx(at.pressure[2], rel=1e-7)


def test_pressure_in_gives_the_separation_back() -> None:
    h = np.linspace(-2.9, 5.9, 12).reshape(3, 4)
    straight = LAW.at_closure(h * LAW.sigma)
    back = LAW.at_pressure(straight.pressure)
    for name, value in straight.quantities().items():
        assert back.quantities()[name] == pytest.approx(value, rel=1e-10), name
    assert back.k_t is None
    assert back.loss_n is None


def test_area_is_nearly_proportional_to_load() -> None:
    r = LAW.at_closure(np.array([4.0, 3.0, 2.0]) * LAW.sigma)
    assert np.ptp(np.log(r.area / r.pressure)) < 0.35
    assert np.ptp(np.log(r.pressure)) > 6


def test_ground_of_the_model_is_marked() -> None:
    def reasons(law: GreenwoodWilliamson, h: float) -> list[str]:
        return [text for text, mask in law.at_closure(h * law.sigma).reasons.items() if mask]

    assert "separation below the mean plane of the summits" in reasons(LAW, -0.5)
    assert any("0.3" in text for text in reasons(LAW, -2.9))
    smooth = LAW.with_(sigma=1e-10)
    assert reasons(smooth, 2.0) == []
    assert "mean pressure of the contacts above the hardness" in reasons(LAW, 2.0)
    assert (
        "mean pressure of the contacts above the hardness" not in LAW.with_(asperity="LinLin").at_closure(1e-6).reasons
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"density": 0.0}, "density = 0 1/m.2; it must be positive"),
        ({"radius": -60e-6}, "radius = -6e-05 m; it must be positive"),
        ({"sigma": float("nan")}, "sigma"),
        ({"asperity": "cube"}, "asperity = 'cube'; use one of"),
    ],
)
def test_parameters_out_of_range_are_refused(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        LAW.with_(**change)


@pytest.mark.parametrize("h", [-3.1, 6.1, float("nan")])
def test_separations_out_of_range_are_refused(h: float) -> None:
    with pytest.raises(InputError, match="-3 to 6 sigma"):
        LAW.at_closure(h * LAW.sigma)


def test_numbers_of_a_surface_are_those_of_its_own_summits() -> None:
    """A Gaussian surface of waves of 12 to 48 points: the law against a count of its summits, and Hertz on each.

    McCool's density and radius hold for every random surface, his deviation for the isotropic Gaussian one. Some 3500
    summits scatter by 2 %; differences over a spacing take 2 to 4 % off the curvature of waves of 12 points.
    """
    n, step = 1024, 1e-6
    rng = np.random.default_rng(7)
    q = np.hypot(*np.meshgrid(np.fft.fftfreq(n), np.fft.fftfreq(n)))
    noise = np.fft.fft2(rng.standard_normal((n, n)))
    z = np.fft.ifft2(np.where((q > 1 / 48) & (q < 1 / 12), noise, 0)).real
    z *= 1e-7 / z.std()
    inputs = SurfaceInputs.from_heights(z, (step, step), D=2.4, G=1e-10)
    law = build("gw", {}, RoughSurface(inputs=inputs), PAIR)
    assert isinstance(law, GreenwoodWilliamson)

    ring = [np.roll(z, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]
    top = np.all([z > other for other in ring], axis=0)
    heights = z[top]
    bend = -sum(np.roll(z, 1, axis) - 2 * z + np.roll(z, -1, axis) for axis in (0, 1))[top] / (2 * step**2)
    area = (n * step) ** 2
    assert law.density == pytest.approx(len(heights) / area, rel=0.08)
    assert law.radius == pytest.approx(1 / bend.mean(), rel=0.08)
    assert law.sigma == pytest.approx(heights.std(), rel=0.05)
    # one radius for all is the model's own simplification: high summits are sharper, by a fifth at one deviation
    for h in (0.0, 1.0):
        depth = np.maximum(heights - heights.mean() - h * law.sigma, 0.0)
        pressure = 4 / 3 * PAIR.E_star * np.sum(depth**1.5 / np.sqrt(bend)) / area
        assert float(law.at_closure(h * law.sigma).pressure) == pytest.approx(pressure, rel=0.25)
