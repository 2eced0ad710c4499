"""Measured heights: closed forms of plain distributions, Gauss against Greenwood and Williamson, quadrature,
unloading."""

import itertools
from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from faying import ContactPair, InputError, Material
from faying.contact import GreenwoodWilliamson, MeasuredHeights, asperity
from faying.contact.asperity import Brake
from faying.joint.joint_law import JointLaw

STEEL = Material(name="m", E=192.31e9, nu=0.3, yield_strength=331.7e6)
PAIR = ContactPair(STEEL, STEEL)
ETA, R = 1.4e6, 1.4e-3


def uniform(span=20e-6, **changes):
    given = {
        "gaps": [0.0, span],
        "probability": [1.0, 1.0],
        "density": ETA,
        "radius": R,
        "pair": PAIR,
        "asperity": "Hertz",
    }
    return MeasuredHeights(**(given | changes))


@settings(max_examples=6)
@given(st.floats(0.002, 0.999), st.floats(-6, -4))
def test_even_gaps_under_hertz_have_closed_forms(share: float, log_span: float) -> None:
    """int_0^w (w - g)^n dg / span = w^(n+1)/((n+1) span)."""
    span = 10**log_span
    w = share * span
    r = uniform(span).at_closure(w)
    E = PAIR.E_star
    assert float(r.pressure) == pytest.approx(ETA * 4 / 3 * E * sqrt(R) * w**2.5 / (2.5 * span), rel=1e-5)
    assert float(r.area) == pytest.approx(ETA * pi * R * w**2 / (2 * span), rel=1e-5)
    stiffness = 2 * E * ETA * sqrt(R) * w**1.5 / (1.5 * span)
    assert float(r.k_n) == pytest.approx(stiffness, rel=1e-5)
    assert float(r.k_load) == pytest.approx(stiffness, rel=1e-5)
    assert float(r.k_t) == pytest.approx(stiffness * 2 * (1 - 0.3) / (2 - 0.3), rel=1e-5)


@pytest.mark.parametrize("name", ["Hertz", "JacksonGreen", "KogutEtsion"])
def test_a_gaussian_table_is_greenwood_and_williamson(name: str) -> None:
    sigma, top = 2e-6, 8.0
    g = np.linspace(0, 2 * top * sigma, 1601)
    probability = np.exp(-((g / sigma - top) ** 2) / 2)
    table = uniform(gaps=g, probability=probability, asperity=name)
    exact = GreenwoodWilliamson(density=ETA, radius=R, sigma=sigma, pair=PAIR, asperity=name)
    d = np.linspace(-1.5, 4.0, 23) * sigma
    ours, theirs = table.at_closure(top * sigma - d), exact.at_closure(d)
    # straight lines between points .01 sigma apart lie above the Gaussian's tail by .01^2 (d/sigma)^2/12
    assert ours.pressure == pytest.approx(theirs.pressure, rel=3e-4)
    assert ours.area == pytest.approx(theirs.area, rel=3e-4)
    assert ours.k_load == pytest.approx(theirs.k_n, rel=1e-3)
    hertz = exact.with_(asperity="Hertz").at_closure(d)
    assert ours.k_n == pytest.approx(
        hertz.k_n, rel=3e-4
    )  # small motion after yield is Hertz's at the same interference


def test_one_height_is_one_asperity_times_their_number() -> None:
    law = uniform(
        gaps=[5e-6, 5.001e-6, 5.002e-6], probability=[0.0, 1.0, 0.0], asperity="Ghaednia", tangent_ratio=0.003
    )
    model = asperity.models()["Ghaednia"](R=R, pair=PAIR, tangent_ratio=0.003)
    w = law.closure_range[1] * np.array([0.8, 0.95])
    one = model.at(w - 0.001e-6)
    got = law.at_closure(w)
    assert got.pressure == pytest.approx(ETA * one.force, rel=0.2)  # 2 nm of spread on 4 nm of interference
    far = uniform(gaps=[0.0, 1e-9, 100e-6], probability=[1.0, 0.0, 0.0], asperity="Ghaednia", tangent_ratio=0.003)
    w = np.array([2e-6, 20e-6])
    one = model.at(w)
    assert far.at_closure(w).pressure == pytest.approx(ETA * one.force, rel=2e-3)
    assert far.at_closure(w).area == pytest.approx(ETA * one.area, rel=2e-3)


@settings(max_examples=4, deadline=None)
@given(st.integers(0, 1000), st.floats(0.2, 1.6))
def test_any_table_equals_quadrature(seed: int, share: float) -> None:
    rng = np.random.default_rng(seed)
    g = np.sort(rng.uniform(0, 30e-6, 12))
    probability = rng.uniform(0, 1, 12)
    law = uniform(gaps=g, probability=probability, asperity="Ghaednia", tangent_ratio=0.003)
    model = law._asperity
    w = share * (g[-1] - g[0])
    density = lambda x: np.interp(x, g, probability / np.trapezoid(probability, g), left=0, right=0)  # noqa: E731
    cuts = sorted({*g, g[0] + w, *(g[0] + w - b * model.critical for b in model.borders)})
    cuts = [c for c in cuts if g[0] <= c <= min(g[-1], g[0] + w)]
    for field, value in (("force", law.at_closure(w).pressure), ("area", law.at_closure(w).area)):
        total = sum(
            quad(lambda x, f=field: float(getattr(model.at(max(g[0] + w - x, 0.0)), f)) * density(x), a, b)[0]
            for a, b in itertools.pairwise(cuts)
        )
        assert float(value) == pytest.approx(ETA * total, rel=1e-4), field


def test_loading_slope_is_the_derivative_of_pressure() -> None:
    law = uniform(asperity="Ghaednia", tangent_ratio=0.003)
    w, step = np.linspace(1e-6, 35e-6, 40), 1e-9
    slope = (law.at_closure(w + step).pressure - law.at_closure(w - step).pressure) / (2 * step)
    assert law.at_closure(w).k_load == pytest.approx(slope, rel=1e-5)


@given(st.floats(3, 200))
def test_stiffness_after_yield_is_the_slope_of_unloading(x: float) -> None:
    """Brake's unloading at its top: 2 E* sqrt(R delta), whatever the loading model; the law's k_n sums this."""
    for name in ("Ghaednia", "JacksonGreen", "KogutEtsion"):
        model = asperity.models()[name](R=R, pair=PAIR)
        top = x * model.critical
        unloading = Brake(loading=model, delta_max=top)
        assert float(unloading.at(top).stiffness) == pytest.approx(2 * PAIR.E_star * sqrt(R * top), rel=1e-9)


def test_the_joint_closes_by_the_loading_slope() -> None:
    law = uniform(asperity="Ghaednia", tangent_ratio=0.003)
    joined = JointLaw(model=law)
    p = np.array([1e6, 1e7, 5e7])
    closing = np.array([joined.approach(one) for one in p])
    assert np.diff(closing) == pytest.approx(np.diff(law._closure_at(p)), rel=1e-4)
    assert joined.stiffness(p)[0] == pytest.approx(law.at_pressure(p).k_n, rel=1e-9)
    assert np.all(law.at_pressure(p).k_n > law.at_pressure(p).k_load)


def test_flags() -> None:
    law = uniform(density=3e8)
    r = law.at_closure(np.array([1e-6, 19e-6, 21e-6]))
    assert r.reasons["closing above the largest measured gap"].tolist() == [False, False, True]
    assert r.reasons["real area above 0.3 of the nominal area"].tolist() == [False, True, True]


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"gaps": [0.0, 1e-6], "probability": [1.0]}, "give two rows of one length"),
        ({"gaps": [1e-6, 0.0]}, "gaps do not rise"),
        ({"gaps": [-1e-6, 0.0]}, "must be 0 or more"),
        ({"probability": [0.0, 0.0]}, "the probability of every gap is 0"),
        ({"probability": [-1.0, 1.0]}, "must be 0 or more"),
        ({"density": 0.0}, "density = 0 1/m.2; it must be positive"),
        ({"radius": -5.9999999999999995e-05}, "radius = -6e-05 m; it must be positive"),
        ({"asperity": "cube"}, "asperity = 'cube'; use one of"),
        ({"tangent_ratio": 0.1}, "tangent_ratio belongs to asperity = 'Ghaednia'"),
        ({"asperity": "Ghaednia", "tangent_ratio": 1.5}, "must be at least 0 and below 1"),
    ],
)
def test_faults(changes, text: str) -> None:
    with pytest.raises(InputError, match=text):
        uniform(**changes)


def test_closings_outside_are_told() -> None:
    with pytest.raises(InputError, match="closings from 2e-08 to 4e-05 m are covered"):
        uniform().at_closure(1e-3)
