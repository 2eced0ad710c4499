"""Unloading, the elastic-plastic load index, layered moduli and the cap of a fractal surface."""

from math import sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from faying import RIGID, ContactPair, InputError, Material
from faying.contact.asperity import (
    JK,
    Brake,
    EtsionKligermanKadin,
    Hertz,
    JacksonGreen,
    LinLin,
    cap_of_fractal,
    dimension_of_cap,
    gao_modulus,
    king_modulus,
    load_index,
    mixed_modulus,
    roughness_of_cap,
)

PAIR = ContactPair(Material(name="m", E=100e9, nu=0.3, yield_strength=355e6), RIGID)
R = 15e-6
LOAD = JK(R=R, pair=PAIR, closure="printed")
# alpha of the JK law with Etsion's unloading, theory notes
ALPHA = {2: 0.091, 5: 0.256, 10: 0.381, 20: 0.491, 50: 0.611, 76.8: 0.657, 500: 0.831}


@pytest.mark.parametrize(("x", "alpha"), ALPHA.items())
def test_load_index_has_its_check_values(x: float, alpha: float) -> None:
    assert float(load_index(LOAD, x * LOAD.critical)) == pytest.approx(alpha, abs=6e-4)


def test_load_index_grows_from_zero_and_keeps_its_shape() -> None:
    x = np.geomspace(1.01, 500, 40).reshape(8, 5)
    alpha = load_index(LinLin(R=R, pair=PAIR), x * LOAD.critical)
    assert alpha.shape == (8, 5)
    assert np.all(np.diff(alpha.ravel()) > 0)
    assert 0 < alpha[0, 0] < 1e-2
    # the paper's constant 0.2 is right near x = 4 only
    assert float(load_index(LOAD, 3.7 * LOAD.critical)) == pytest.approx(0.2, abs=0.01)


@pytest.mark.parametrize("kind", [EtsionKligermanKadin, Brake])
@given(logx=st.floats(0.05, 2.3))
def test_unloading_leaves_the_loading_curve_and_ends_at_the_residual(kind: type, logx: float) -> None:
    top = 10**logx * LOAD.critical
    back = kind(loading=LOAD, delta_max=top)
    assert float(back.at(top).force) == pytest.approx(float(LOAD.at(top).force), rel=1e-12)
    assert float(back.at(top).area) == pytest.approx(float(LOAD.at(top).area), rel=1e-12)
    assert 0 < back.residual < top
    assert float(back.at(back.residual * 0.99).force) == 0
    work = quad(lambda d: float(back.at(d).force), back.residual, top, epsabs=0, epsrel=1e-10)[0]
    assert float(back.at(top).energy) == pytest.approx(work, rel=1e-8)
    h = 1e-5 * (top - back.residual)
    middle = (top + back.residual) / 2
    slope = float(np.diff(back.at([middle - h, middle + h]).force)[0]) / (2 * h)
    assert float(back.at(middle).stiffness) == pytest.approx(slope, rel=1e-8)


def test_brake_unloads_as_hertz_with_a_larger_radius() -> None:
    top = 20 * LOAD.critical
    back = Brake(loading=LOAD, delta_max=top)
    d = np.linspace(back.residual, top, 5)
    hertz = Hertz(R=back.radius, pair=PAIR).at(d - back.residual)
    assert back.at(d).force == pytest.approx(hertz.force, rel=1e-10)
    assert back.radius > R


@pytest.mark.parametrize("kind", [EtsionKligermanKadin, Brake])
def test_elastic_loading_loses_nothing(kind: type) -> None:
    back = kind(loading=JacksonGreen(R=R, pair=PAIR), delta_max=0.5 * LOAD.critical)
    assert back.residual == pytest.approx(0, abs=1e-20)
    assert back.load_index == pytest.approx(0, abs=1e-12)


def test_unloading_refuses_what_it_cannot_do() -> None:
    with pytest.raises(InputError, match="it must be positive"):
        Brake(loading=LOAD, delta_max=0.0)
    with pytest.raises(InputError, match="is above delta_max"):
        Brake(loading=LOAD, delta_max=1e-9).at(2e-9)


# ---- layers ----


@pytest.mark.parametrize("modulus", [king_modulus, gao_modulus])
def test_layer_moduli_run_from_substrate_to_layer(modulus: object) -> None:
    t = np.array([0.0, 1e-6, 0.3, 1.0, 3.0, 1e6])
    E = modulus(200e9, 100e9, t)  # type: ignore[operator]
    assert E[0] == pytest.approx(100e9, rel=1e-12)
    assert E[-1] == pytest.approx(200e9, rel=1e-5)
    assert np.all(np.diff(E) > 0)
    assert modulus(100e9, 100e9, t) == pytest.approx(np.full(6, 100e9), rel=1e-12)  # type: ignore[operator]


def test_gao_at_unit_thickness_by_hand() -> None:
    # nu = .3, xi = 1: (2/pi)(pi/4) + [.4 ln 2 - .5]/(1.4 pi)
    weight = 0.5 + (0.4 * np.log(2) - 0.5) / (1.4 * np.pi)
    assert float(gao_modulus(200e9, 100e9, 1.0)) == pytest.approx(100e9 * (1 + weight), rel=1e-12)


def test_mixed_compliances() -> None:
    assert float(mixed_modulus(200e9, 100e9, 0.5)) == pytest.approx(1 / (0.5 / 200e9 + 0.5 / 100e9), rel=1e-14)
    assert float(king_modulus(2.0, 1.0, 0.7, 1.5)) == pytest.approx(float(mixed_modulus(2.0, 1.0, 1 - np.exp(-1.05))))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: mixed_modulus(0.0, 1.0, 0.5), "both must be positive"),
        (lambda: mixed_modulus(1.0, 1.0, 1.5), "between 0 and 1"),
        (lambda: king_modulus(1.0, 1.0, -1.0), "0 or more"),
        (lambda: gao_modulus(1.0, 1.0, -1.0), "0 or more"),
        (lambda: gao_modulus(1.0, 1.0, 1.0, nu=0.7), r"nu in \(-1, 0.5\]"),
        (lambda: roughness_of_cap(1e-5, 1e-7, D=3.1), "between 2 and 3"),
        (lambda: roughness_of_cap(0.0, 1e-7, D=2.4), "both must be positive"),
        (lambda: roughness_of_cap(1e-5, 1e-7, D=2.4, gamma=1.0), "above 1"),
        (lambda: dimension_of_cap(1e-5, 1e-7, G=0.0), "it must be positive"),
        (lambda: dimension_of_cap(1e-5, 1e-7, G=1e-2), "outside 2 to 3"),
        (lambda: cap_of_fractal(3.1, 1e-9, 1e-6), "between 2 and 3"),
        (lambda: cap_of_fractal(2.4, 1e-9, 0.0), "positive lengths"),
    ],
)
def test_layers_and_caps_refuse_what_lies_outside(make: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()  # type: ignore[operator]


# ---- section 2.4 ----


def test_the_papers_inverse_problem() -> None:
    # R 15 um, h_a .1 um -> D 2.9961, G 1.5463e-4 mm; back with the sphere's own r_a: R 15.00, h_a .0997
    R, h = 15e-6, 0.1e-6
    back_R, back_h = cap_of_fractal(2.9961, 1.5463e-7, sqrt(2 * R * h - h**2))
    assert back_R * 1e6 == pytest.approx(15.00, abs=0.005)
    assert back_h * 1e6 == pytest.approx(0.0997, abs=5e-5)


@pytest.mark.parametrize(("D", "G"), [(2.39, 1.24e-9), (2.5, 7.1e-9), (2.9961, 1.55e-7)])
def test_one_cap_fits_many_surfaces(D: float, G: float) -> None:
    assert roughness_of_cap(15e-6, 0.1e-6, D=D) == pytest.approx(G, rel=5e-3)
    assert dimension_of_cap(15e-6, 0.1e-6, G=roughness_of_cap(15e-6, 0.1e-6, D=D)) == pytest.approx(D, rel=1e-12)


@given(st.floats(2.01, 2.99), st.floats(-12, -8), st.floats(-7, -4))
def test_cap_there_and_back(D: float, log_G: float, log_r: float) -> None:
    R, h = cap_of_fractal(D, 10**log_G, 10**log_r)
    assert sqrt(2 * R * h) == pytest.approx(10**log_r, rel=1e-12)
    assert roughness_of_cap(R, h, D=D) == pytest.approx(10**log_G, rel=1e-8)
