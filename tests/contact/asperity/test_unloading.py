"""Unloading and the elastic-plastic load index."""

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
    load_index,
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
