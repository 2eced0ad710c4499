"""Majumdar-Bhushan, Wang-Komvopoulos, Yan-Komvopoulos and Morag-Etsion against the sum over their islands."""

from itertools import pairwise
from math import log, pi, sqrt

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from faying import JK, RIGID, ContactPair, InputError, Material
from faying.contact import MajumdarBhushan, MoragEtsion, WangKomvopoulos, YanKomvopoulos
from faying.contact.asperity import LinLin
from faying.contact.models.islands import domain_extension

PAIR = ContactPair(Material(name="m", E=200e9, nu=0.3, hardness=994e6, yield_strength=355e6), RIGID)
H, E = PAIR.hardness, PAIR.E_star
A0 = 16e-6


def islands_sum(law: object, D: float, psi: float, al: float, lower: float, upper: float) -> float:
    """Integral of law(a) n(a) da, n = (d/2) psi^((2-d)/2) al^(d/2) a^-(d/2+1), d = D - 1, in t = ln a."""
    if upper <= lower:
        return 0.0
    d = D - 1
    weight = d / 2 * psi ** ((2 - d) / 2)
    start = log(lower) if lower > 0 else log(upper) - 60 / (2 - d)
    cuts = np.linspace(start, log(upper), 30)
    return sum(
        quad(lambda t: law(np.exp(t)) * weight * np.exp(d / 2 * (log(al) - t)), a, b, epsabs=0, epsrel=1e-11)[0]  # type: ignore[operator]
        for a, b in pairwise(cuts)
    )


@pytest.mark.parametrize("cls", [MajumdarBhushan, WangKomvopoulos])
@settings(max_examples=10)
@example(D=2.5, ratio=100.0)
@example(D=2.5 + 1e-9, ratio=100.0)
@given(D=st.floats(2.1, 2.75), ratio=st.floats(0.1, 1e6))
def test_majumdar_bhushan_and_wang_komvopoulos(cls: type, D: float, ratio: float) -> None:
    G, d = 1e-10, D - 1
    law = cls(D=D, G=G, pair=PAIR, scan_area=A0)
    ac = G**2 / (H / (2 * E)) ** (2 / (d - 1))
    assert law.critical_area == pytest.approx(ac, rel=1e-9)
    al = ac * ratio
    psi = domain_extension(D) if cls is WangKomvopoulos else 1.0
    r = law.at_closure(al)
    area = d / (2 - d) * psi ** ((2 - d) / 2) * al
    assert float(r.area) == pytest.approx(area / A0, rel=1e-12)
    border = min(ac, al)
    elastic = islands_sum(lambda a: 4 * sqrt(pi) / 3 * E * G ** (d - 1) * a ** ((3 - d) / 2), D, psi, al, border, al)
    plastic = islands_sum(lambda a: H * a, D, psi, al, 0, border)
    assert float(r.pressure) == pytest.approx((elastic + plastic) / A0, rel=1e-8)
    assert r.k_n is None
    assert r.loss_n is None


@settings(max_examples=10)
@example(D=2.5, ratio=100.0)
@given(D=st.floats(2.1, 2.75), ratio=st.floats(0.1, 1e6))
def test_yan_komvopoulos(D: float, ratio: float) -> None:
    G, g = 1e-10, log(1.5)
    law = YanKomvopoulos(D=D, G=G, pair=PAIR, scan_area=A0)
    ac = (2 ** (11 - 2 * D) / (9 * pi ** (4 - D)) * G ** (2 * D - 4) * (E / H) ** 2 * g) ** (1 / (D - 2))
    assert law.critical_area == pytest.approx(ac, rel=1e-9)
    al = ac * ratio
    border = min(ac, al)

    def elastic(a: float) -> float:
        delta = 2 ** (4 - D) * G ** (D - 2) * sqrt(g) * pi ** ((D - 3) / 2) * a ** ((3 - D) / 2)
        return 4 / 3 * E * sqrt(a / (2 * pi * delta)) * delta**1.5

    r = law.at_closure(al)
    load = islands_sum(elastic, D, 1.0, al, border, al) + islands_sum(lambda a: H * a, D, 1.0, al, 0, border)
    assert float(r.pressure) == pytest.approx(load / A0, rel=1e-8)
    real = islands_sum(lambda a: a / 2, D, 1.0, al, border, al) + islands_sum(lambda a: a, D, 1.0, al, 0, border)
    assert float(r.area) == pytest.approx(real / A0, rel=1e-8)
    if ratio > 1 and abs(D - 2.5) > 1e-3:  # the printed totals
        x = ac / al
        Fe = (
            2 ** ((11 - 2 * D) / 2)
            / (3 * pi ** ((4 - D) / 2))
            * (D - 1)
            / (5 - 2 * D)
            * sqrt(g)
            * G ** (D - 2)
            * E
            * al ** ((4 - D) / 2)
            * (1 - x ** ((5 - 2 * D) / 2))
        )
        Fp = (D - 1) / (3 - D) * H * al * x ** ((3 - D) / 2)
        assert float(r.pressure) == pytest.approx((Fe + Fp) / A0, rel=1e-9)


@settings(max_examples=5)
@given(D=st.floats(2.1, 2.8), log_x=st.floats(-2, 4))
def test_morag_etsion(D: float, log_x: float) -> None:
    G, length, d = 1e-10, 1e-4, D - 1
    law = MoragEtsion(D=D, G=G, wavelength=length, pair=PAIR, scan_area=A0)
    K = 0.454 + 0.41 * 0.3
    R = length**d / (pi**2 * G ** (d - 1))
    assert pytest.approx(R, rel=1e-12) == law.R
    ac = (1 / pi) * (K * H / (2 * E)) ** 2 * (length**d / G ** (d - 1)) ** 2
    assert law.critical_area == pytest.approx(ac, rel=1e-12)
    one = LinLin(R=R, pair=PAIR)
    al = 2 * pi * R * one.critical * 10**log_x
    r = law.at_closure(al)
    cuts = [0.0, *(c for c in (2 * pi * R * one.critical * b for b in one.borders) if c < al), al]
    for field, value in (("force", r.pressure), ("area", r.area)):
        total = sum(
            islands_sum(lambda a, f=field: float(getattr(one.at(a / (2 * pi * R)), f)), D, 1.0, al, p, q)
            for p, q in pairwise(cuts)
        )
        assert float(value) == pytest.approx(total / A0, rel=1e-7), field
    cuts = [al / 100, *(c for c in cuts if al / 100 < c < al), al]
    stiff = sum(
        islands_sum(lambda a: float(one.at(a / (2 * pi * R)).stiffness), D, 1.0, al, p, q) for p, q in pairwise(cuts)
    )
    assert float(r.k_n) == pytest.approx(stiff / A0, rel=1e-7)


def test_morag_etsion_yields_later_on_longer_waves() -> None:
    law = MoragEtsion(D=2.4, G=1e-10, wavelength=1e-4, pair=PAIR, scan_area=A0)
    assert law.with_(wavelength=2e-4).critical_area == pytest.approx(law.critical_area * 2**2.8, rel=1e-12)
    # the opposite order of MB: elastic first, then at hardness
    al = 2 * pi * law.R * LinLin(R=law.R, pair=PAIR).critical * np.array([1e-3, 1e5])
    r = law.at_closure(al)
    light, heavy = r.pressure / r.area
    assert light < 0.1 * H
    assert heavy > 0.95 * H


def test_jk_with_one_psi_and_plain_borders_reduces_to_the_plastic_bearing_area() -> None:
    # fully plastic surfaces: MB, YK and JK all give p = H Ar/A0 over the same islands
    soft = ContactPair(Material(name="s", E=200e9, nu=0.3, hardness=1e3), RIGID)
    al = 1e-10
    mb = MajumdarBhushan(D=2.4, G=1e-10, pair=soft, scan_area=A0).at_closure(al)
    yk = YanKomvopoulos(D=2.4, G=1e-10, pair=soft, scan_area=A0).at_closure(al)
    wk = WangKomvopoulos(D=2.4, G=1e-10, pair=soft, scan_area=A0).at_closure(al)
    jk = JK(D=2.4, G=1e-10, pair=soft, scan_area=A0, psi=1.0, closure="printed").at_closure(al)
    assert float(yk.pressure) == pytest.approx(float(mb.pressure), rel=1e-2)
    # JK's caps are cut at 1.06 r^2, so that its plastic area is 1.06 a'
    assert float(jk.area) == pytest.approx(1.06 * float(mb.area), rel=1e-2)
    assert float(jk.pressure) == pytest.approx(1e3 * float(jk.area), rel=1e-2)
    assert float(wk.area / mb.area) == pytest.approx(domain_extension(2.4) ** 0.3, rel=1e-12)


def test_jk_reduces_to_morag_etsion_where_the_cap_is_the_same() -> None:
    # JK at one al' is LL's law on the cap of its largest island, over the islands: so is ME, with R given
    jk = JK(D=2.4, G=1e-10, pair=PAIR, scan_area=A0, psi=1.0, substrate=1 / 1.06)
    al = jk.limits[0] * 3
    R = float(jk._cap(np.array(al))[1])
    wavelength = (R * pi**2 * 1e-10**0.4) ** (1 / 1.4)
    me = MoragEtsion(D=2.4, G=1e-10, wavelength=wavelength, pair=PAIR, scan_area=A0)
    a, b = jk.at_closure(al), me.at_closure(al)
    assert float(a.pressure) == pytest.approx(float(b.pressure), rel=1e-10)
    assert float(a.area) == pytest.approx(float(b.area), rel=1e-10)


LAWS = [
    MajumdarBhushan(D=2.4, G=1e-10, pair=PAIR, scan_area=A0),
    WangKomvopoulos(D=2.4, G=1e-10, pair=PAIR, scan_area=A0),
    YanKomvopoulos(D=2.4, G=1e-10, pair=PAIR, scan_area=A0),
    MoragEtsion(D=2.4, G=1e-10, wavelength=4e-3, pair=PAIR, scan_area=A0),
]


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_pressure_in_and_out(law: MajumdarBhushan) -> None:
    first, last = law.closure_range
    al = first * (last / first) ** np.linspace(0.3, 1, 7)
    r = law.at_closure(al)
    back = law.at_pressure(r.pressure)
    assert back.area == pytest.approx(r.area, rel=1e-10)
    assert float(r.area[-1]) == pytest.approx(1.0, rel=0.5)
    assert not r.valid[-1]
    assert r.valid[0]


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"D": 2.0}, "between 2 and 3"),
        ({"G": 0.0}, "it must be positive"),
        ({"scan_area": -1.0}, "it must be positive"),
        ({"pair": ContactPair(Material(name="m", E=1e9, nu=0.3), RIGID)}, "neither hardness nor yield_strength"),
    ],
)
def test_parameters_out_of_range_are_refused(law: MajumdarBhushan, change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        law.with_(**change)


def test_more_refusals() -> None:
    with pytest.raises(InputError, match=r"gamma = 1; it must be above 1"):
        YanKomvopoulos(D=2.4, G=1e-10, pair=PAIR, scan_area=A0, gamma=1.0)
    with pytest.raises(InputError, match=r"wavelength = 0 m; it must be positive"):
        MoragEtsion(D=2.4, G=1e-10, wavelength=0.0, pair=PAIR, scan_area=A0)
    reasons = LAWS[3].with_(wavelength=1e-5).at_closure(1e-9).reasons
    assert reasons["the largest contact exceeds its wavelength"]
