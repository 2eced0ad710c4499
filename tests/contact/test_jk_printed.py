"""The printed closure against the paper: the asperity laws summed by quadrature, and the printed totals typed in.

Nothing here calls the model for anything but the answer and psi; the formulas stand as in the paper, with al' as the
upper limit where the paper integrates beyond it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal, localcontext
from itertools import pairwise
from math import log, pi, sqrt

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from faying import JK, ContactPair, Material
from faying.contact.law import Response


@dataclass(frozen=True, kw_only=True)
class Case:
    """A surface, its materials and its load; s = ln(a1c'/al') places al' in a stage whatever the rest is."""

    D: float = 2.39
    G: float = 1.53e-10
    E: float = 200e9
    nu: float = 0.3
    hardness_share: float = 0.005
    lam: float = 0.95
    X: float = 0.3
    alpha: float = 0.2
    cutoff: float = 0.01
    s: float = -2.0
    two_bodies: bool = False

    @property
    def material(self) -> Material:
        return Material(name="m", E=self.E, nu=self.nu, hardness=self.hardness_share * self.E, friction=0.25)

    def law(self) -> JK:
        other = self.material if self.two_bodies else Material(name="rigid", E=float("inf"), nu=0.0)
        return JK(
            D=self.D,
            G=self.G,
            pair=ContactPair(self.material, other),
            scan_area=16e-6,
            closure="printed",
            substrate=self.lam,
            shear_ratio=self.X,
            alpha=self.alpha,
            cutoff=self.cutoff,
            loss="literal",
        )

    @property
    def al(self) -> float:
        # a1c'/al' grows as al'^(D-2), and is 1 at al' = base^(1/(2-D)), eq. (10)
        bodies = 2 if self.two_bodies else 1
        E_star = self.E / (1 - self.nu**2) / bodies
        KH = (0.454 + 0.41 * self.nu) * self.hardness_share * self.E
        D, G = self.D, self.G
        base = pi ** (4 - D) * KH**2 / (2 ** (9 - 2 * D) * G ** (2 * (D - 2)) * E_star**2 * log(1.5))
        return float(np.exp((self.s - log(base)) / (D - 2)))


CASES = st.builds(
    Case,
    D=st.floats(2.1, 2.9),
    G=st.floats(-13, -8).map(lambda v: 10**v),
    E=st.floats(1e9, 6e11),
    nu=st.floats(0, 0.5),
    hardness_share=st.floats(1e-3, 0.05),
    lam=st.floats(0.3, 1.0),
    X=st.floats(1e-3, 0.999),
    alpha=st.floats(0.0, 0.9),
    cutoff=st.floats(1e-4, 0.5),
    s=st.floats(-10, 8),
    two_bodies=st.booleans(),
)
# stages: large (s > 0), meso (-ln 76.8 = -4.34 < s < 0), small; exponents that vanish at D = 2.16 (k_t) and 1.76 + ...
SPECIAL = [Case(D=2.16, s=s) for s in (-7, -2, 1)] + [Case(D=D, s=-7) for D in (2.16 + 1e-9, 2.16 - 1e-13, 2.1, 2.9)]
QUANTITIES = ("pressure", "area", "k_n", "k_t", "loss_n", "loss_t", "energy_n", "energy_t")
# a loss factor is a difference that vanishes at a border: there only its rounding, relative to 1, can agree
NOISE = {name: 1e-14 if name.startswith("loss") else 1e-300 for name in QUANTITIES}


def summed(case: Case) -> dict[str, float]:
    """Totals by adaptive quadrature of eqs. (7)-(20), (A4)-(A27) over the island distribution (25)."""
    E, nu, D, G, lam, X = case.E, case.nu, case.D, case.G, case.lam, case.X
    bodies = 2 if case.two_bodies else 1
    E_star, G_star = E / (1 - nu**2) / bodies, E / (2 * (1 + nu)) / (2 - nu) / bodies
    H, g, mu, psi = case.hardness_share * E, log(1.5), 0.25, case.law()._islands.psi
    K = 0.454 + 0.41 * nu
    al, A0 = case.al, 16e-6
    r_a = sqrt(al / pi)
    h_a = 2 ** (3 - D) * G ** (D - 2) * sqrt(g) * r_a ** (3 - D)
    R = r_a**2 / (2 * h_a)
    d1 = (pi * K * H / (2 * E_star)) ** 2 * R
    a1, a2 = min(2 * pi * R * d1, al), min(76.8 * 2 * pi * R * d1, al)
    B = 3 / 5 - (1 - X) ** (2 / 3) + 2 / 5 * (1 - X) ** (5 / 3)

    def islands(t: float) -> float:
        """a' n(a') at a' = exp(t)."""
        return float((D - 1) / 2 * psi ** ((3 - D) / 2) * np.exp((D - 1) / 2 * (log(al) - t)))

    def sink(a: float) -> float:
        return 1.06 * lam * a / (2 * pi * R)

    Law = Callable[[float], float]
    f_e: Law = lambda a: 4 / 3 * E_star * sqrt(R) * sink(a) ** 1.5  # noqa: E731
    a_e: Law = lambda a: pi * R * sink(a)  # noqa: E731
    f_ep: Law = lambda a: 2 / 3 * K * H * pi * R * d1 * (sink(a) / d1) ** 1.38  # noqa: E731
    a_ep: Law = lambda a: pi * R * d1 * (sink(a) / d1) ** 1.16  # noqa: E731
    a_p: Law = lambda a: 2 * pi * R * sink(a)  # noqa: E731
    f_p: Law = lambda a: H * a_p(a)  # noqa: E731

    def stiffness(area: Law) -> Law:
        return lambda a: 8 * G_star * sqrt(area(a) / pi) * (1 - X) ** (1 / 3)

    def work(force: Law, area: Law) -> Law:
        return lambda a: 3 * pi * mu**2 * force(a) ** 2 / (8 * G_star * sqrt(area(a) / pi)) * B

    def total(law: Law, lower: float, upper: float, exponent: float) -> float:
        """Integral of law(a') n(a') from lower to upper; exponent: that of the integrand in ln a', to end the tail."""
        if upper <= lower:
            return 0.0
        start = log(lower) if lower > 0 else log(upper) - 25 / exponent  # 1e-11 of it lies below
        cuts = np.linspace(start, log(upper), 9)
        return sum(
            quad(lambda t: law(np.exp(t)) * islands(t), a, b, epsabs=0, epsrel=1e-12)[0] for a, b in pairwise(cuts)
        )

    half = (1 - D) / 2
    W = {
        "n": (
            total(lambda a: 8 / 15 * E_star * sqrt(R) * sink(a) ** 2.5, 0, a1, 2.5 + half),
            total(lambda a: K * H * pi * R * sink(a) ** 2.38 / (3.57 * d1**0.38), a1, a2, 0),
            total(lambda a: pi * H * R * sink(a) ** 2, a2, al, 0),
        ),
        "t": (
            total(work(f_e, a_e), 0, a1, 2.5 + half),
            total(work(f_ep, a_ep), a1, a2, 0),
            total(work(f_p, a_p), a2, al, 0),
        ),
    }
    eps = case.cutoff * a1
    out = {
        "pressure": total(f_e, 0, a1, 1.5 + half) + total(f_ep, a1, a2, 0) + total(f_p, a2, al, 0),
        "area": total(a_e, 0, a1, 1 + half) + total(a_ep, a1, a2, 0) + total(a_p, a2, al, 0),
        "k_n": total(lambda a: 2 * E_star * sqrt(R * sink(a)), eps, a1, 0)
        + total(lambda a: 1.38 * f_ep(a) / sink(a), a1, a2, 0),
        "k_t": total(stiffness(a_e), eps, a1, 0) + total(stiffness(a_ep), a1, a2, 0),
        "energy_n": sum(W["n"]),
        "energy_t": sum(W["t"]) / (2 * pi),  # printed 2 pi times the work
    }
    out = {name: value / A0 for name, value in out.items()}
    for d, (e, ep, p) in W.items():
        out[f"loss_{d}"] = (case.alpha * ep + p) / (e + (1 - case.alpha) * ep)
    return out


def printed(case: Case) -> dict[str, float]:
    """Totals as printed, Eqs. (29)-(31), (49), (58), (A1)-(A27), in 70 decimal digits, so that 0/0 resolves."""
    with localcontext() as context:
        context.prec = 70

        def d(v: float | str) -> Decimal:
            return Decimal(v)

        # 1e-30 moves D off the points where an exponent vanishes; there the printed forms have ln as their limit
        D = d(case.D) + d("1e-30")
        G, E, nu, lam, X, alpha, al = map(d, (case.G, case.E, case.nu, case.lam, case.X, case.alpha, case.al))
        bodies = 2 if case.two_bodies else 1
        Es, Gs = E / (1 - nu**2) / bodies, E / (2 * (1 + nu)) / (2 - nu) / bodies
        H = d(case.material.hardness or 0.0)
        KH = (d("0.454") + d("0.41") * nu) * H
        g, mu, A0 = d(1.5).ln(), d("0.25"), d("16e-6")
        pi_ = d("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899")
        L = d("1.06") * lam
        P = d(case.law()._islands.psi) ** ((3 - D) / 2)
        a1c = pi_ ** (4 - D) * KH**2 * al ** (D - 1) / (2 ** (9 - 2 * D) * G ** (2 * (D - 2)) * Es**2 * g)
        a1, a2 = min(a1c, al), min(d("76.8") * a1c, al)
        eps = d(case.cutoff) * a1
        B = d(3) / 5 - (1 - X) ** (d(2) / 3) + d(2) / 5 * (1 - X) ** (d(5) / 3)
        slip = (1 - X) ** (d(1) / 3)
        G2 = G ** (D - 2)
        Hg1 = (
            L ** d("1.16")
            * 2 ** (d("0.44") - d("0.32") * D)
            * Es ** d("0.32")
            * g ** d("0.16")
            * G2 ** d("0.32")
            / (pi_ ** (d("0.64") - d("0.16") * D) * KH ** d("0.32"))
        )
        Hg2 = (
            L ** d("1.38")
            * 2 ** (d("3.42") - d("0.76") * D)
            * KH ** d("0.24")
            * g ** d("0.38")
            * Es ** d("0.76")
            * (G2 ** d("0.76"))
            / (3 * pi_ ** (d("1.52") - d("0.38") * D))
        )
        Hg3 = (
            d("1.38")
            * L ** d("0.38")
            * 2 ** (d("0.42") + d("0.24") * D)
            * KH ** d("0.24")
            * Es ** d("0.76")
            / (3 * G2 ** d("0.24") * g ** d("0.12") * pi_ ** (d("0.02") + d("0.12") * D))
        )
        Hg4 = (
            L ** d("2.38")
            * 2 ** (d("5.42") - d("1.76") * D)
            * KH ** d("0.24")
            * Es ** d("0.76")
            * (G2 ** d("1.76") * g ** d("0.88"))
            / (d("3.57") * pi_ ** (d("3.02") - d("0.88") * D))
        )
        Hg5 = mu**2 * L ** d("2.5") * 2 ** (d("6.5") - 2 * D) / (3 * pi_ ** (d("2.5") - D) * Gs) * g * Es**2 * G2**2 * B
        Hg6 = 3 * pi_ ** d("1.5") * mu**2 / (8 * Gs) * Hg2**2 / Hg1.sqrt() * B
        Hg7 = 3 * pi_ ** d("1.5") * mu**2 * L ** d("1.5") * H**2 / (8 * Gs) * B

        def step(e: Decimal, upper: Decimal, lower: Decimal) -> Decimal:
            return upper**e - lower**e

        Are = L * (D - 1) / (2 * (3 - D)) * P * al ** ((D - 1) / 2) * a1 ** ((3 - D) / 2)
        Arep = (
            Hg1
            * (D - 1)
            / (2 * (d("1.66") - D / 2))
            * P
            * al ** (d("0.34") * (D - 1))
            * step(d("1.66") - D / 2, a2, a1)
        )
        Arp = L * (D - 1) / (3 - D) * P * al ** ((D - 1) / 2) * step(d("1.5") - D / 2, al, a2)
        # (A1) is printed with al'^0 because the powers of al' cancel
        Fe = (
            2 ** (d("4.5") - D)
            * (D - 1)
            * L ** d("1.5")
            / (3 * (4 - D) * pi_ ** (2 - D / 2))
            * Es
            * G2
            * g.sqrt()
            * P
            * a1 ** ((4 - D) / 2)
        )
        Fep = Hg2 * (D - 1) / (d("3.76") - D) * P * al ** (d("0.12") * (D - 1)) * step(d("1.88") - D / 2, a2, a1)
        Fp = L * (D - 1) * H / (3 - D) * P * al ** ((D - 1) / 2) * step(d("1.5") - D / 2, al, a2)
        Kne = (D - 1) / (2 - D) * (2 * L / pi_).sqrt() * Es * P * al ** ((D - 1) / 2) * step((2 - D) / 2, a1, eps)
        Knep = (D - 1) * Hg3 / (d("1.76") - D) * P * al ** (d("0.62") * (D - 1)) * step(d("0.88") - D / 2, a2, a1)
        Kte = (
            8
            * (D - 1)
            / (2 - D)
            * (L / (2 * pi_)).sqrt()
            * Gs
            * P
            * al ** ((D - 1) / 2)
            * step((2 - D) / 2, a1, eps)
            * slip
        )
        Ktep = (
            slip
            * (Hg1 / pi_).sqrt()
            * Gs
            * P
            * al ** (d("0.42") * (D - 1))
            * 8
            * (D - 1)
            / (d("2.16") - D)
            * step(d("1.08") - D / 2, a2, a1)
        )
        Wne = (
            2 ** (d("8.5") - 2 * D)
            * L ** d("2.5")
            * (D - 1)
            / (15 * (6 - D) * pi_ ** (d("3.5") - D))
            * Es
            * G2**2
            * g
            * P
            * al ** ((1 - D) / 2)
            * a1 ** (3 - D / 2)
        )
        Wnep = (D - 1) / (d("5.76") - D) * Hg4 * P * al ** (d("0.38") * (1 - D)) * step(d("2.88") - D / 2, a2, a1)
        Wnp = (
            H
            * (D - 1)
            * L**2
            / ((5 - D) * pi_ ** (d("1.5") - D / 2))
            * 2 ** (2 - D)
            * G2
            * g.sqrt()
            * P
            * step((5 - D) / 2, al, a2)
        )
        Wte = (D - 1) / (6 - D) * Hg5 * P * al ** ((1 - D) / 2) * a1 ** (3 - D / 2)
        Wtep = (D - 1) / (d("5.36") - D) * Hg6 * P * al ** (d("0.18") * (1 - D)) * step(d("2.68") - D / 2, a2, a1)
        Wtp = (D - 1) / (4 - D) * Hg7 * P * al ** ((D - 1) / 2) * step((4 - D) / 2, al, a2)
        values = {
            "pressure": (Fe + Fep + Fp) / A0,
            "area": (Are + Arep + Arp) / A0,
            "k_n": (Kne + Knep) / A0,
            "k_t": (Kte + Ktep) / A0,
            "loss_n": (alpha * Wnep + Wnp) / (Wne + (1 - alpha) * Wnep) / (2 * pi_),
            "loss_t": (alpha * Wtep + Wtp) / (Wte + (1 - alpha) * Wtep) / (2 * pi_),
            "energy_n": (Wne + Wnep + Wnp) / A0,
            "energy_t": (Wte + Wtep + Wtp) / (2 * pi_ * A0),
        }
        return {name: float(value) for name, value in values.items()}


def with_examples(test: Callable[..., None]) -> Callable[..., None]:
    for case in SPECIAL:
        test = example(case=case)(test)
    return test


def answers(case: Case) -> dict[str, float]:
    response: Response = case.law().at_closure(case.al)
    return {name: float(value) for name, value in response.quantities().items()}


@settings(max_examples=40)
@with_examples
@given(case=CASES)
def test_totals_equal_quadrature_of_the_asperity_laws(case: Case) -> None:
    expected = summed(case)
    for name, value in answers(case).items():
        assert value == pytest.approx(expected[name], rel=1e-9, abs=NOISE[name]), name


@settings(max_examples=200)
@with_examples
@given(case=CASES)
def test_totals_equal_the_printed_ones(case: Case) -> None:
    expected = printed(case)
    for name, value in answers(case).items():
        assert value == pytest.approx(expected[name], rel=1e-12, abs=NOISE[name]), name


@pytest.mark.parametrize("D", [2.1, 2.16, 2.39, 2.9])
def test_stage_limits_are_the_printed_ones(D: float) -> None:
    law = Case(D=D).law()
    E, nu, H, G, g = 200e9, 0.3, 1e9, 1.53e-10, log(1.5)
    KH, E_star = (0.454 + 0.41 * nu) * H, E / (1 - nu**2)
    al1 = (76.8 * KH**2 / (2 ** (9 - 2 * D) * pi ** (D - 4) * E_star**2 * G ** (2 * (D - 2)) * g)) ** (1 / (2 - D))
    al3 = 16e-6 / ((D - 1) / (2 * (3 - D)) * law._islands.psi ** ((3 - D) / 2))
    assert law.limits == pytest.approx((al1, al1 * 76.8 ** (1 / (D - 2)), al3), rel=1e-9)
