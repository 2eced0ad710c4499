"""The JK model of a rough surface: Zhang, Wu, Liu and Jiang 2024, Fractal Fract. 8, 611.

Each asperity is a cap of radius R (set by the largest island) pressed by delta_a = 1.06 lam a'/(2 pi R). With
y = delta_a/d1c, the interference over that of first yield, its law is a power of y in each of three regimes, and the
surface is the sum over the island distribution.

Where the print is ambiguous or wrong we read it so:
- every upper limit of integration is the smaller of itself and al' (the print integrates beyond the largest asperity);
- stiffness is cut off below at `cutoff` times the smaller of a1c' and al' (the print takes a1c'/100, also when that is
  above al', where nothing is left to integrate);
- closure="printed" keeps 76.8, 1.38, 1.16, regime borders at a1c', a2c' and strain energies integrated from zero, so
  that force jumps by 0.7 % at the borders; "consistent" takes the exponents that make the law continuous for any
  Poisson's ratio (upper end x_p = 400 K/3, those of Lin and Lin), borders where y = 1 and y = x_p, and energies that
  carry on from the regime before;
- loss="literal" evaluates eqs. 49-53 at every load, so that damping vanishes in the large stage; "held" keeps the loss
  factor that the small stage ends with, as the text and its Fig. 13 say;
- the tangential load enters as shear_ratio X = T/(mu F), or as shear_stress tau, with X = tau A/(mu F) in each regime
  (the paper gives tau no value); at X = 0 the loss factor is the limit in which X cancels; a regime whose X
  reaches 1 under tau slips: it adds no tangential stiffness, and the response says so;
- stiffness grows with load throughout for 2.1 <= D <= 2.9 while cutoff <= 0.01; with a cutoff of 0.1 it falls over part
  of the meso stage above D = 2.76, with 0.3 above D = 2.5: there the cut-off leaves too little of the elastic part;
- eqs. 49-53 give dissipated over stored energy, the specific damping capacity (`specific_damping`); the loss factor of
  this project, and of the modes, is that over 2 pi;
- asperities at hardness add no stiffness, normal or tangential, as printed (eqs. A8, A14).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import log, pi, sqrt
from typing import Any, ClassVar, Literal, final

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.law import ContactLaw, Response, checked, require
from faying.contact.measured_range import MeasuredRange
from faying.contact.models.islands import Islands, covering
from faying.contact.parameter import FRACTAL, GAMMA, TEXT, Parameter
from faying.contact.substrate import SHAPE, WeightedIslands, asperity_share, substrate_share
from faying.materials import ContactPair
from faying.typing import Array

QUANTITIES = ("force", "area", "k_n", "k_t", "energy_n", "energy_t")
Term = tuple[float, float]  # coefficient and power of y


@dataclass(frozen=True)
class AsperityRegime:
    """One asperity between two borders, each quantity a sum of coefficient times power of y.

    Units: force Pc = (2/3) K H pi R d1c, area Ac = pi R d1c, k_n Pc/d1c, k_t 8 G* sqrt(R d1c), energy_n Pc d1c,
    energy_t 3 pi mu^2 Pc^2/(8 G* sqrt(R d1c)) times B(X).
    """

    force: tuple[Term, ...]
    area: tuple[Term, ...]
    k_n: tuple[Term, ...]
    k_t: tuple[Term, ...]
    energy_n: tuple[Term, ...]
    energy_t: tuple[Term, ...]


def asperity_regimes(K: float, *, printed: bool) -> tuple[float, tuple[AsperityRegime, ...]]:
    """Return x_p, the y at which full plasticity begins, and the elastic, elastic-plastic and plastic regimes."""
    x_p = 76.8 if printed else 400 * K / 3  # eq. (8)
    n = 1.38 if printed else log(400) / log(x_p)  # eq. (15)
    m = 1.16 if printed else 1 + log(2) / log(x_p)  # eq. (16)
    hard = 3 / K  # 2 pi R d1c H in units of Pc
    carry_1 = 0.0 if printed else 1 / 2.5 - 1 / (n + 1)
    carry_2 = 0.0 if printed else carry_1 + x_p ** (n + 1) / (n + 1) - hard * x_p**2 / 2

    def regime(force: Term, area: Term, carry: float = 0.0) -> AsperityRegime:
        (c, p), (a, q) = force, area  # c y^p and a y^q
        return AsperityRegime(
            force=(force,),
            area=(area,),
            k_n=((c * p, p - 1),),  # slope of the force, eqs. (A4), (A6)
            k_t=((sqrt(a), q / 2),),  # root of the area, eq. (A11)
            energy_n=((c / (p + 1), p + 1), *([(carry, 0.0)] if carry else [])),  # eqs. (A15), (A17), (A19)
            energy_t=((c**2 / sqrt(a), 2 * p - q / 2),),  # force^2 over root of the area, eqs. (A22), (A24), (A26)
        )

    elastic = regime((1.0, 1.5), (1.0, 1.0))  # eqs. (12), (13)
    mixed = regime((1.0, n), (1.0, m), carry_1)  # eqs. (15), (16)
    plastic = regime((hard, 1.0), (2.0, 1.0), carry_2)  # eqs. (18), (19)
    return x_p, (elastic, mixed, replace(plastic, k_n=(), k_t=()))  # eqs. (A8), (A14)


def slip_share(X: ArrayLike) -> Array:
    """Return B(X), the tangential work on a sphere under T = X mu F over 3 mu^2 F^2/(16 G* r) [-].

    Eq. (A21) prints 3 pi mu^2 F^2/(8 G* r) B, which is 2 pi times the work, the integral of T over Mindlin's
    displacement 3 mu F/(16 G* r) (1 - (1-X)^(2/3)). Loss factors are ratios and do not change.

    B = 3/5 - (1-X)^(2/3) + (2/5) (1-X)^(5/3) = (2/3) integral of s (1-s)^(-1/3) from 0 to X, an incomplete beta
    function, which keeps its digits at small X.
    """
    from scipy.special import betainc

    return np.asarray(3 / 5 * betainc(2.0, 2 / 3, np.asarray(X, float)))


@final
@dataclass(frozen=True, kw_only=True)
class JK(ContactLaw):
    """Contact of a fractal surface over its small, meso and large stage.

    Closure variable: the largest truncated area al' [m2]. Valid while real area <= 0.3, k_n below that of the bulk,
    al' <= al3', al1' < al2' < al3', 2.1 <= D <= 2.9.

    Args:
        D: surface dimension, 2 < D < 3.
        G: fractal roughness [m].
        pair: the materials that meet.
        scan_area: A0, the area that the scan covers and to which al' belongs [m2].
        gamma: frequency index, above 1.
        alpha: elastic-plastic load index, 0 to 1.
        closure: "consistent" takes exponents that make the law continuous, "printed" those of the paper.
        substrate: share lam of the deformation that the asperity takes (a constant), or "exact" for eq. (1) at every
            asperity, with modulus_ratio and the asperity's E in the pair.
        cutoff: least area that adds stiffness, over the smaller of a1c' and al'.
        loss: "held" keeps the loss factor that the small stage ends with, "literal" evaluates eqs. (49) to (53).
        shear_ratio: X = T/(mu F), 0 <= X < 1.
        psi: domain extension; solved where None.
        modulus_ratio: E_asperity/E_substrate.
        shear_stress: tau [Pa] on the real area, in place of shear_ratio.

    Raises:
        InputError: for parameters out of these ranges.

    Source:
        Zhang, Wu, Liu and Jiang 2024, doi:10.3390/fractalfract8100611.
    """

    D: float
    G: float
    pair: ContactPair
    scan_area: float
    gamma: float = 1.5
    alpha: float = 0.2
    closure: Literal["consistent", "printed"] = "consistent"
    substrate: float | Literal["exact"] = 1.0
    cutoff: float = 0.01
    loss: Literal["held", "literal"] = "held"
    shear_ratio: float = 0.0
    psi: float | None = None
    modulus_ratio: float = 1.0
    shear_stress: float = 0.0

    name: ClassVar[str] = "JK"
    measured_ranges: ClassVar = {"JK": MeasuredRange(hard=0.26, soft=0.11, factor=4.2)}
    source: ClassVar[str] = "doi:10.3390/fractalfract8100611"
    validity: ClassVar[str] = (
        "real area up to 0.3, k_n below that of the bulk, al' <= al3', al1' < al2' < al3', 2.1 <= D <= 2.9"
    )
    parameters: ClassVar = {
        **FRACTAL,
        **GAMMA,
        "alpha": Parameter("", "elastic-plastic load index", 0, 1, "[)"),
        "closure": Parameter(
            TEXT, "exponents and borders of the elastic-plastic regime", choices=("consistent", "printed")
        ),
        "substrate": Parameter("", "share of the deformation that the asperity takes", 0, 1, "(]", choices=("exact",)),
        "cutoff": Parameter("", "least area that adds stiffness, over the smaller of a1c' and al'", 0, 1),
        "loss": Parameter(TEXT, "loss factor above the small stage", choices=("held", "literal")),
        "shear_ratio": Parameter("", "tangential load over mu times normal load", 0, 1, "[)"),
        "psi": Parameter("", "domain extension, solved where not given", 1, ends="[)"),
        "modulus_ratio": Parameter("", "E of the asperity over that of its substrate", 0),
        "shear_stress": Parameter("Pa", "shear stress on the real area, in place of shear_ratio", 0, ends="[)"),
    }

    def __post_init__(self) -> None:
        need = partial(require, "JK")
        need(
            not self.shear_ratio >= 1,
            f"shear_ratio = {self.shear_ratio}: at T = mu F and above the joint slips everywhere and has no "
            "stiffness; lower the shear load or raise the preload",
        )
        super().__post_init__()
        need(
            self.shear_stress == 0 or self.shear_ratio == 0,
            f"shear_ratio = {self.shear_ratio} and shear_stress = {self.shear_stress:.6g} Pa; give one of them",
        )
        need(
            (self.shear_stress == 0 and self.shear_ratio == 0) or self.pair.friction > 0,
            "a tangential load needs friction above 0; give a material of the pair its friction",
        )
        need(np.isfinite(self.pair.hardness), "neither body yields; give the pair a hardness or yield_strength")

    def facts(self) -> dict[str, Any]:
        """Parameters and limits of the law, by name with unit."""
        pair = {"E_star [Pa]": self.pair.E_star, "G_star [Pa]": self.pair.G_star, "hardness [Pa]": self.pair.hardness}
        return super().facts() | pair | {"limits [m2]": list(self.limits)}

    @cached_property
    def _islands(self) -> Islands:
        if self.substrate == "exact":
            return WeightedIslands(self.D, self.psi, self.modulus_ratio)
        return Islands(self.D, self.psi)

    @cached_property
    def _regimes(self) -> tuple[float, tuple[AsperityRegime, ...]]:
        return asperity_regimes(self.pair.hardness_coefficient, printed=self.closure == "printed")

    @property
    def _yield_strain(self) -> float:
        """pi K H/(2 E*): sqrt(d1c/R), eq. (7)."""
        return pi * self.pair.hardness_coefficient * self.pair.hardness / (2 * self.pair.E_star)

    def _cap(self, al: Array) -> tuple[Array, Array, Array]:
        """Height h_a, radius R and yield interference d1c [m] of the asperities at largest truncated area al."""
        r_a = np.sqrt(al / pi)
        h_a = 2 ** (3 - self.D) * self.G ** (self.D - 2) * sqrt(log(self.gamma)) * r_a ** (3 - self.D)  # eq. (4)
        R = r_a**2 / (2 * h_a)  # eq. (6)
        return h_a, R, self._yield_strain**2 * R  # eq. (7)

    @cached_property
    def limits(self) -> tuple[float, float, float]:
        """al1', al2', al3': where the small, meso and large stage end [m2] (eqs. 26-28).

        At al1' the largest asperity leaves full plasticity, at al2' it becomes elastic. In the consistent closure
        that is where its delta_a is x_p d1c and d1c; in print where a2c' and a1c' reach al'.
        """
        KH, D = self.pair.hardness_coefficient * self.pair.hardness, self.D
        x_p = self._regimes[0]
        if self.closure == "printed":
            reach = 1.0
        elif self.substrate == "exact":
            reach = SHAPE * float(asperity_share(SHAPE, self.modulus_ratio))
        else:
            reach = SHAPE * self.substrate
        base = KH**2 / (2 ** (9 - 2 * D) * pi ** (D - 4) * self.pair.E_star**2 * log(self.gamma)) / reach
        log_al2 = (log(base) - 2 * (D - 2) * log(self.G)) / (2 - D)  # eqs. (26), (27)
        log_al1 = log_al2 - log(x_p) / (D - 2)
        al3 = self.scan_area * (3 - D) / self._islands.weight  # eq. (28)
        with np.errstate(over="ignore", under="ignore"):
            return float(np.exp(log_al1)), float(np.exp(log_al2)), al3

    @cached_property
    def closure_range(self) -> tuple[float, float]:
        """al' from next to nothing up to where the real area reaches the nominal area [m2]."""
        top = covering(lambda al: np.sum(self._parts(al, ("area",))["area"], axis=0), self.scan_area)
        return top * 1e-36, top

    def _parts(self, al: Array, wanted: Sequence[str] = QUANTITIES) -> dict[str, list[Array]]:
        """Sums over the islands in each of the three regimes, SI, without tangential load; energy_t without mu^2 B."""
        h_a, R, d1c = self._cap(al)
        x_p, regimes = self._regimes
        share = 1.0 if isinstance(self.substrate, str) else self.substrate
        scale = SHAPE * share * h_a / d1c  # y = scale * x, or scale * x * lam(x) with the exact substrate

        def border(y: float) -> Array:
            """The x at which an asperity has this y."""
            if self.closure == "printed":
                return y * d1c / h_a  # a1c'/al', a2c'/al', eqs. (10), (11)
            if self.substrate == "exact":
                return substrate_share(y * d1c / h_a, self.modulus_ratio)
            return y / scale

        first, second = np.minimum(border(1.0), 1.0), np.minimum(border(x_p), 1.0)
        borders = ((np.zeros_like(first), first), (first, second), (second, np.ones_like(second)))

        KH = self.pair.hardness_coefficient * self.pair.hardness
        P_c, A_c, root = 2 / 3 * KH * pi * R * d1c, pi * R * d1c, np.sqrt(R * d1c)
        G_star = self.pair.G_star
        units = {
            "force": P_c,
            "area": A_c,
            "k_n": P_c / d1c,
            "k_t": 8 * G_star * root,
            "energy_n": P_c * d1c,
            "energy_t": 3 * pi * P_c**2 / (8 * G_star * root),
        }
        out: dict[str, list[Array]] = {quantity: [] for quantity in wanted}
        for quantity, sums in out.items():
            for regime, (lower, upper) in zip(regimes, borders, strict=True):
                if quantity in ("k_n", "k_t") and regime is regimes[0]:
                    lower = self.cutoff * upper
                part = np.zeros_like(al)
                for coefficient, power in getattr(regime, quantity):
                    part = part + coefficient * scale**power * self._islands.total(power, lower, upper)
                sums.append(units[quantity] * part)
        return out

    def _shear(self, parts: dict[str, list[Array]]) -> list[Array]:
        """X = T/(mu F) of each regime, at most 1 (eq. A11)."""
        if self.shear_stress == 0:
            return [np.full_like(force, self.shear_ratio) for force in parts["force"]]
        tau = self.shear_stress / self.pair.friction
        pairs = zip(parts["area"], parts["force"], strict=True)
        return [np.minimum(tau * area / np.where(force > 0, force, np.inf), 1.0) for area, force in pairs]

    def _capacity(self, energies: list[Array]) -> Array:
        elastic, mixed, plastic = energies
        return (self.alpha * mixed + plastic) / (elastic + (1 - self.alpha) * mixed)  # eqs. (49), (58)

    def _energy_t(self, parts: dict[str, list[Array]]) -> list[Array]:
        """Tangential energies per regime [J]; without load over B mu^2, which cancels from their loss factor."""
        if self.shear_stress == 0 and self.shear_ratio == 0:
            return parts["energy_t"]
        mu = self.pair.friction
        return [mu**2 * slip_share(X) * w for X, w in zip(self._shear(parts), parts["energy_t"], strict=True)]

    @cached_property
    def _end_damping(self) -> tuple[float, float]:
        """Normal and tangential specific damping with which the small stage ends."""
        parts = self._parts(np.array(min(max(self.limits[0], 1e-80), 1e80)))
        return float(self._capacity(parts["energy_n"])), float(self._capacity(self._energy_t(parts)))

    def specific_damping(self, al: ArrayLike) -> tuple[Array, Array]:
        """Dissipated over stored energy, normal and tangential [-], at al' [m2]; the paper's loss factor, eqs. 49-53.

        It is 2 pi times the loss factor of `at_closure`.
        """
        a = checked(al, name="al'", unit="m2", zero=False)
        return self._damping(a, self._parts(a))

    def _damping(self, al: Array, parts: dict[str, list[Array]]) -> tuple[Array, Array]:
        normal, tangential = self._capacity(parts["energy_n"]), self._capacity(self._energy_t(parts))
        if self.loss == "literal":
            return normal, tangential
        loaded = al >= self.limits[0]
        return np.where(loaded, self._end_damping[0], normal), np.where(loaded, self._end_damping[1], tangential)

    @property
    def assumptions(self) -> tuple[str, ...]:
        """Numbers of the law that nobody measured."""
        return (f"its loss rests on an assumed elastic-plastic load index, alpha = {self.alpha:g}",)

    def _pressure_at(self, closure: Array) -> Array:
        return np.asarray(sum(self._parts(closure, ("force",))["force"]) / self.scan_area)

    def at_closure(self, al: ArrayLike) -> Response:
        """Return the response at largest truncated areas al' [m2], any shape. InputError unless positive."""
        a = checked(al, name="al'", unit="m2", zero=False)
        A0 = self.scan_area
        parts = self._parts(a)
        shear = self._shear(parts)
        tangential = self._energy_t(parts)
        damping_n, damping_t = self._damping(a, parts)
        loaded = self.shear_stress > 0 or self.shear_ratio > 0
        area, k_n = np.asarray(sum(parts["area"]) / A0), np.asarray(sum(parts["k_n"]) / A0)
        k_t = sum((1 - X) ** (1 / 3) * k for X, k in zip(shear, parts["k_t"], strict=True)) / A0  # eq. (A11)
        al1, al2, al3 = self.limits
        return Response(
            pressure=np.asarray(sum(parts["force"]) / A0),
            area=area,
            k_n=k_n,
            k_t=np.asarray(k_t),
            loss_n=damping_n / (2 * pi),
            loss_t=damping_t / (2 * pi),
            energy_n=np.asarray(sum(parts["energy_n"]) / A0),
            energy_t=np.asarray(sum(tangential) / (2 * pi * A0)) if loaded else np.zeros_like(a),
            reasons={
                "real area above 0.3 of the nominal area": area > 0.3,
                "k_n above the stiffness of the bulk, 1.129 E*/sqrt(A0)": k_n > 2 / sqrt(pi * A0) * self.pair.E_star,
                "al' above al3'": a > al3,
                "the limits of the stages are not in the order al1' < al2' < al3'": np.full(
                    a.shape, not al1 < al2 < al3
                ),
                "D outside 2.1 to 2.9": np.full(a.shape, not 2.1 <= self.D <= 2.9),
                "tau exceeds friction over the elastic or elastic-plastic asperities, which slip": np.asarray(
                    np.maximum(shear[0], shear[1]) >= 1
                ),
            },
        )
