"""Single-asperity models: published check values, the Hertz limit, exact derivatives and energies, known jumps."""

from itertools import pairwise
from math import inf, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from faying import RIGID, ContactPair, InputError, Material
from faying.contact import asperity
from faying.contact.asperity import AsperityModel

# E* = 109.89 GPa, Y = 355 MPa, nu = 0.3, H = 2.8 Y
STEEL = Material(name="m", E=100e9, nu=0.3, yield_strength=355e6)
PAIR = ContactPair(STEEL, RIGID)
R = 15e-6
ALL = asperity.models()


def build(name: str, pair: ContactPair = PAIR, R: float = R) -> AsperityModel:
    return ALL[name](R=R, pair=pair)  # type: ignore[arg-type]


def scale(pair: ContactPair = PAIR, R: float = R) -> tuple[float, float, float]:
    """dc, Pc and Ac of the K H criterion, by hand."""
    K, H = 0.454 + 0.41 * pair.softer.nu, pair.hardness
    dc = (pi * K * H / (2 * pair.E_star)) ** 2 * R
    return dc, 2 / 3 * K * H * pi * R * dc, pi * R * dc


# (P, A) at x of the K H criterion, except JG, whose x, P and A count its own; theory notes, to their printed digits
VALUES = {
    "KogutEtsion": {2: (2.766, 2.044), 6: (13.23, 7.12), 20: (61.56, 29.11), 76.8: (336.8, 136.1), 110: (530.2, 205.4)},
    "JacksonGreen": {
        2: (2.829, 2.016),
        6: (13.00, 7.136),
        20: (64.21, 28.52),
        76.8: (338.0, 134.2),
        110: (512.9, 202.9),
    },
    "ZhaoMaiettaChang": {
        2: (2.563, 2.002),
        6: (10.47, 6.125),
        20: (54.74, 25.10),
        76.8: (399.3, 153.6),
        110: (571.9, 220),
    },
    "ChangEtsionBogy": {2: (4.5, 3), 6: (16.5, 11), 20: (58.5, 39), 76.8: (228.9, 152.6), 110: (328.5, 219)},
}
PRINTED = {2: (2.603, 2.235), 6: (11.85, 7.992), 20: (62.43, 32.30), 76.8: (399.8, 153.8), 110: (571.9, 220)}


@pytest.mark.parametrize("name", VALUES)
def test_check_values(name: str) -> None:
    model = build(name)
    dc, Pc, Ac = scale()
    if name == "JacksonGreen":
        dc = model.critical
        Pc, Ac = 4 / 3 * PAIR.E_star * sqrt(R) * dc**1.5, pi * R * dc
    for x, (P, A) in VALUES[name].items():
        r = model.at(x * dc)
        # the KE fit at the border of two pieces takes the lower one, as the table does
        assert float(r.force) / Pc == pytest.approx(P, rel=4e-4), x
        assert float(r.area) / Ac == pytest.approx(A, rel=4e-4), x
        assert float(r.pressure) == pytest.approx(float(r.force / r.area), rel=1e-14)


def test_check_values_of_jk_and_lin_lin() -> None:
    printed = asperity.JK(R=R, pair=PAIR, closure="printed")
    dc, Pc, Ac = scale()
    for x, (P, A) in PRINTED.items():
        r = printed.at(x * dc)
        assert float(r.force) / Pc == pytest.approx(P, rel=4e-4)
        assert float(r.area) / Ac == pytest.approx(A, rel=4e-4)
        # Lin and Lin's own exponents differ from the rounded ones by a few parts in a thousand
        assert float(build("LinLin").at(x * dc).force) == pytest.approx(float(r.force), rel=3e-3)


@pytest.mark.parametrize("name", ALL)
def test_hertz_limit(name: str) -> None:
    d = np.array([1e-13, 1e-12]) * 1e-3
    r, hertz = build(name).at(d), build("Hertz").at(d)
    E = PAIR.E_star
    assert hertz.force == pytest.approx(4 / 3 * E * sqrt(R) * d**1.5, rel=1e-13)
    for field in ("force", "area", "pressure", "stiffness", "energy"):
        assert getattr(r, field) == pytest.approx(getattr(hertz, field), rel=1e-12), field


def materials() -> st.SearchStrategy[ContactPair]:
    return st.builds(
        lambda E, nu, share: ContactPair(Material(name="m", E=E, nu=nu, yield_strength=share * E), RIGID),
        st.floats(1e9, 6e11),
        st.floats(0, 0.5),
        st.floats(5e-4, 0.01),
    )


@pytest.mark.parametrize("name", ALL)
@settings(max_examples=10, deadline=None)
@given(pair=materials(), logx=st.floats(-2, 3))
def test_stiffness_is_the_derivative_of_force(name: str, pair: ContactPair, logx: float) -> None:
    model = build(name, pair)
    c = model.critical
    x = 10**logx
    h = 1e-4 * x
    if any(abs(x / b - 1) < 1e-2 for b in model.borders):
        return
    f = model.at(c * (x + h * np.array([-2, -1, 1, 2]))).force
    slope = (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * h * c)
    assert float(model.at(c * x).stiffness) == pytest.approx(slope, rel=2e-6, abs=1e-9 * f[3] / (c * x))


@pytest.mark.parametrize("name", ALL)
@settings(max_examples=5, deadline=None)
@given(pair=materials(), logx=st.floats(-1, 3))
def test_energy_is_the_integral_of_force(name: str, pair: ContactPair, logx: float) -> None:
    model = build(name, pair)
    c = model.critical
    x = 10**logx
    cuts = [0.0, *sorted(e for e in model.borders if e < x * (1 - 1e-9)), x]
    work = sum(
        quad(lambda v: float(model.at(c * max(v, 1e-300)).force), a, b, epsabs=0, epsrel=1e-11, limit=200)[0]
        for a, b in pairwise(cuts)
    )
    assert float(model.at(c * x).energy) == pytest.approx(c * work, rel=1e-8)


@settings(max_examples=50, deadline=None)
@given(nu=st.floats(0, 0.5), share=st.floats(5e-4, 0.01))
def test_lin_lin_and_consistent_jk_never_jump(nu: float, share: float) -> None:
    pair = ContactPair(Material(name="m", E=1e11, nu=nu, yield_strength=share * 1e11), RIGID)
    for model in (build("LinLin", pair), build("JK", pair)):
        for x in model.borders:
            below, above = model.curve(np.array([x * (1 - 1e-12), x * (1 + 1e-12)])).A
            assert abs(model.jump(x)) < 1e-12 * x**1.5
            assert above == pytest.approx(below, rel=1e-10)


# relative jumps of force at the borders, as the docstrings state them
JUMPS = {
    "Hertz": (),
    "ChangEtsionBogy": (0.5,),
    "KogutEtsion": (0.03, 0.0168, 0.0788),
    "JacksonGreen": (0.0047,),
    "Ghaednia": (0.0044,),
    "ZhaoMaiettaChang": (0.0, 0.0),
    "LinLin": (0.0, 0.0),
}


@pytest.mark.parametrize("name", JUMPS)
def test_known_jumps(name: str) -> None:
    model = build(name)
    found = [model.jump(x) / float(model.curve(np.array([x * (1 - 1e-12)])).P[0]) for x in model.borders]
    assert found == pytest.approx(list(JUMPS[name]), abs=1e-4)


def test_printed_jk_jumps_as_its_rounded_numbers_make_it() -> None:
    model = asperity.JK(R=R, pair=PAIR, closure="printed")
    assert model.jump(1.0) == pytest.approx(0.0, abs=1e-12)
    P = float(model.curve(np.array([76.8])).P[0])
    # 3 x/K after x^1.38 at 76.8 with K = .577
    assert model.jump(76.8) / P == pytest.approx(3 * 76.8 / 0.577 / 76.8**1.38 - 1, rel=1e-9)
    assert abs(model.jump(76.8) / P) < 2e-3


@given(st.floats(1e-9, 1e-5), st.floats(0.1, 5))
def test_jk_on_a_substrate_is_two_springs_in_series(delta: float, ratio: float) -> None:
    model = asperity.JK(R=R, pair=PAIR, height=1e-7, modulus_ratio=ratio)
    free = asperity.JK(R=R, pair=PAIR)
    lam = float(model.share(delta))
    own = delta * lam
    # eq. (1), with xi = 1.5 sqrt(R)/r_a and r_a^2 = 2 R h_a
    xi = 1.5 * sqrt(R) / sqrt(2 * R * 1e-7)
    assert own * (1 + ratio * xi * sqrt(own)) == pytest.approx(delta, rel=1e-12)
    assert float(model.at(delta).force) == pytest.approx(float(free.at(own).force), rel=1e-12)
    substrate = 1.5 * ratio * xi * sqrt(own)  # d delta_b/d delta_a
    assert float(model.at(delta).stiffness) == pytest.approx(float(free.at(own).stiffness) / (1 + substrate), rel=1e-12)


def test_jk_on_a_substrate_conserves_work() -> None:
    model = asperity.JK(R=R, pair=PAIR, height=1e-7, modulus_ratio=2.0)
    d = np.linspace(0, 3e-7, 200_001)
    work = np.trapezoid(model.at(d).force, d)
    assert float(model.at(3e-7).energy) == pytest.approx(work, rel=1e-8)


def test_ghaednia_between_its_ends() -> None:
    x = np.geomspace(2, 300, 9)
    plastic = asperity.JacksonGreen(R=R, pair=PAIR, hardness="cosine").curve(x)
    soft = asperity.Ghaednia(R=R, pair=PAIR, tangent_ratio=0.0).curve(x)
    hard = asperity.Ghaednia(R=R, pair=PAIR, tangent_ratio=0.999).curve(x)
    assert pytest.approx(plastic.P, rel=1e-12) == soft.P
    assert pytest.approx(plastic.A, rel=1e-12) == soft.A
    assert pytest.approx(plastic.P + (x**1.5 - plastic.P) * (1 - np.exp(-3.3)), rel=1e-2) == hard.P
    assert pytest.approx(x, rel=1e-6) == hard.A


def test_ghaednia_mixes_radii_of_the_contact() -> None:
    """a = a_e + (a_p - a_e) exp(U) as printed, with U of E_t/E = 0.05; areas in place of radii are up to 6 % off."""
    x, t, E = np.geomspace(2, 300, 9), 0.05, PAIR.softer.E
    model = asperity.Ghaednia(R=R, pair=PAIR, tangent_ratio=t)
    plastic = asperity.JacksonGreen(R=R, pair=PAIR, hardness="cosine").curve(x)
    root = np.sqrt(E / model.yield_strength)
    deep = (x - 1) * model.critical / R
    U = -2 * root * t ** (1 - deep) / ((4 - 3 * np.exp(-2 * root * t)) * (1 - t))
    radius = np.sqrt(x) + (np.sqrt(plastic.A) - np.sqrt(x)) * np.exp(U)
    assert pytest.approx(radius**2, rel=1e-12) == model.curve(x).A


@pytest.mark.parametrize("name", ALL)
def test_shapes_and_refusals(name: str) -> None:
    model = build(name)
    d = np.full((2, 3), 1e-8)
    assert model.at(d).energy.shape == (2, 3)
    assert model.at(1e-8).force.shape == ()
    assert float(model.at(0.0).force) == 0
    assert float(model.at(0.0).pressure) == 0
    for bad in (-1e-9, float("nan"), inf):
        with pytest.raises(InputError, match="interference"):
            model.at(bad)
    for bad in (0.0, -1.0, inf):
        with pytest.raises(InputError, match="R = "):
            build(name, R=bad)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: asperity.JacksonGreen(R=R, pair=PAIR, hardness="other"), '"exponential" or "cosine"'),
        (lambda: asperity.Ghaednia(R=R, pair=PAIR, tangent_ratio=1.0), "up to below 1"),
        (lambda: asperity.JK(R=R, pair=PAIR, height=0.0), "height = 0.0; it must be positive"),
        (lambda: asperity.JK(R=R, pair=PAIR, closure="other"), '"consistent" or "printed"'),
        (
            lambda: asperity.KogutEtsion(R=R, pair=ContactPair(Material(name="m", E=1e9, nu=0.3), RIGID)).at(1e-9),
            "neither hardness nor yield_strength",
        ),
    ],
)
def test_options_out_of_range_are_refused(make: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()  # type: ignore[operator]


def test_hertz_needs_no_hardness() -> None:
    pair = ContactPair(Material(name="m", E=1e9, nu=0.3), RIGID)
    assert float(asperity.Hertz(R=R, pair=pair).at(1e-9).force) == pytest.approx(
        4 / 3 * 1e9 / 0.91 * sqrt(R) * 1e-9**1.5, rel=1e-12
    )
