"""Persson, and Jackson and Streator."""

from math import erf, log, pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from faying import RIGID, ContactPair, InputError, Material
from faying.contact import JacksonStreator, Persson
from faying.contact.models.jackson_streator import sinusoid_area

PAIR = ContactPair(Material(name="m", E=200e9, nu=0.3, hardness=994e6), RIGID)
E = PAIR.E_star
PERSSON = Persson(slope=0.05, h_rms=1e-6, pair=PAIR)
STACK = JacksonStreator(D=2.4, G=1e-10, shortest=1e-6, pair=PAIR, scan_area=16e-6)


@given(st.floats(1e-6, 0.999))
def test_persson_area_is_the_error_function(A: float) -> None:
    p = float(PERSSON.with_(corrected=False).at_closure(A).pressure)
    assert erf(p / sqrt(2 * E**2 * 0.05**2 / 4)) == pytest.approx(A, rel=1e-9)
    corrected = float(PERSSON.at_closure(A).pressure)
    assert erf(corrected / sqrt(2 * E**2 * 0.05**2 / 4 * (0.42 + 0.58 * A))) == pytest.approx(A, rel=1e-9)


def test_persson_at_small_loads() -> None:
    # A = kappa p/(E* slope): sqrt(8/pi) as derived, and 2.46 with the correction, near Bush's sqrt(2 pi) = 2.51
    p = 1e-6 * E
    kappa = [float(PERSSON.with_(corrected=c).at_pressure(p).area) * E * 0.05 / p for c in (False, True)]
    assert kappa[0] == pytest.approx(sqrt(8 / pi), rel=1e-6)
    assert kappa[1] == pytest.approx(sqrt(8 / pi / 0.42), rel=1e-4)


def test_persson_stiffness_energy_and_ratio() -> None:
    p = np.geomspace(1e5, 1e9, 9)
    r = PERSSON.at_pressure(p)
    assert r.k_n == pytest.approx(p / (0.45 * 1e-6), rel=1e-12)
    assert r.k_t / r.k_n == pytest.approx(np.full(9, 2 * 0.7 / 1.7), rel=1e-12)
    # work: dW = p du = p dp/k_n
    fine = np.linspace(0, 1e8, 1001)[1:]
    work = np.trapezoid(np.concatenate([[0], fine / PERSSON.at_pressure(fine).k_n]), np.concatenate([[0], fine]))
    assert float(PERSSON.at_pressure(1e8).energy_n) == pytest.approx(0.45e-6 * 1e8, rel=1e-12)
    assert work == pytest.approx(0.45e-6 * 1e8, rel=2e-3)
    assert r.loss_n is None


def test_persson_marks_its_ground() -> None:
    r = PERSSON.at_pressure(np.array([1e6, 3e9]))
    assert "real area above 0.3 of the nominal area" in r.reasons
    assert r.reasons["mean pressure of the contacts above the hardness"].tolist() == [True, True]
    assert PERSSON.with_(slope=0.005).at_pressure(1e6).valid


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"slope": 0.0}, "slope"),
        ({"h_rms": -1.0}, "h_rms"),
        ({"gamma": float("nan")}, "gamma"),
    ],
)
def test_persson_refuses(change: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        PERSSON.with_(**change)
    with pytest.raises(InputError, match="is between 0 and 1"):
        PERSSON.at_closure([0.5, 1.0])


# ---- Jackson and Streator ----


def test_sinusoid_starts_as_hertz_and_ends_flat() -> None:
    # one period l^2 of a cos cos has two summits of curvature 4 pi^2 a/l^2; each carries p l^2/2 as a Hertz contact
    length, amplitude, load = 1e-4, 1e-7, 1e-12
    flat = sqrt(2) * pi * E * amplitude / length
    R = length**2 / (4 * pi**2 * amplitude)
    force = load * flat * length**2 / 2
    hertz = 2 * pi * (3 * force * R / (4 * E)) ** (2 / 3) / length**2
    assert float(sinusoid_area(load)) == pytest.approx(hertz, rel=1e-4)
    assert float(sinusoid_area(1.0)) == pytest.approx(1.0, rel=1e-14)
    assert float(sinusoid_area(5.0)) == pytest.approx(1.0, rel=1e-14)
    x = np.linspace(1e-6, 1, 2000)
    assert np.all(np.diff(sinusoid_area(x)) > 0)
    below, above = sinusoid_area(np.array([0.8 - 1e-9, 0.8 + 1e-9]))
    assert above == pytest.approx(below, rel=1e-6)


def test_layers_hold_the_variance_of_the_series() -> None:
    length, amplitude = STACK.layers
    assert length[0] == pytest.approx(4e-3)
    assert length[:-1] / length[1:] == pytest.approx(np.full(len(length) - 1, 1.5))
    assert length[-1] >= 1e-6 > length[-1] / 1.5
    # series of Yan and Komvopoulos: A_n^2 = G^(2Ds-2) ln(gamma) f^-(4-2Ds), Ds = D - 1, variance A^2/2; cosines a^2/4
    series = (1e-10) ** (2 * 1.4 - 2) * log(1.5) * (1 / length) ** -(4 - 2 * 1.4) / 2
    assert amplitude**2 / 4 == pytest.approx(series, rel=1e-10)


def test_area_multiplies_over_the_layers() -> None:
    p = 5e7
    area, local = 1.0, p
    for length, amplitude in zip(*STACK.layers, strict=True):
        share = float(sinusoid_area(local / (sqrt(2) * pi * E * amplitude / length)))
        area, local = area * share, local / share
    r = STACK.at_pressure(p)
    assert float(r.area) == pytest.approx(area, rel=1e-12)
    assert r.k_n is None
    # load is carried: mean pressure times area
    assert local * area == pytest.approx(p, rel=1e-12)


def test_finer_waves_lower_the_area() -> None:
    areas = [float(STACK.with_(shortest=s).at_pressure(1e7).area) for s in (1e-4, 1e-5, 1e-6)]
    assert areas[0] > areas[1] > areas[2]


def test_stack_marks_yield() -> None:
    r = STACK.at_pressure(1e7)
    assert r.reasons["mean pressure of the contacts above the hardness"] == (1e7 / float(r.area) > PAIR.hardness)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"D": 3.0}, "between 2 and 3"),
        ({"G": 0.0}, "G = 0 m; it must be positive"),
        ({"scan_area": 0.0}, "scan_area"),
        ({"gamma": 1.0}, "gamma"),
        ({"shortest": 5e-3}, "below 0.004 m"),
        ({"shortest": 0.0}, "shortest"),
    ],
)
def test_stack_refuses(change: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        STACK.with_(**change)
