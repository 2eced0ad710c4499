"""Asperity and substrate: how much of the applied deformation the asperity takes (eqs. 1 and 2 of Zhang et al. 2024).

delta = delta_a (1 + Er xi sqrt(delta_a)) with xi = 1.5 sqrt(R)/r_a. Because r_a^2 = 2 R h_a, xi sqrt(h_a) is always
1.5/sqrt(2), so the share lam = delta_a/delta depends on Er and on delta/h_a alone. In the JK model
delta = 1.06 h_a a'/al'.

Beside it, what finite elements found (docs/theory/asperity-fe.md): the asperity takes all of the deformation, with the
modulus 1/E = x/Ea + (1 - x)/Eb, x = 1 - exp(-0.453 h_a/sqrt(R delta)), so that its compliance is c = x + (1 - x) Er
times that of its own material.
"""

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.models.islands import Islands
from faying.errors import InputError
from faying.typing import Array, Mask

SHAPE = 1.06  # 1 - cos(pi r/(2 r_a)) ~ 1.06 (r/r_a)^2, eq. (9)
PANEL = np.log(1e3)  # longest panel of a quadrature in ln x
NODES = 32  # of a quadrature on one panel, exact to rounding
COUPLING = 1.5 / 2**0.5  # xi sqrt(h_a)
OWN_MODULUS = 0.453  # fitted to computed caps, benchmarks/asperity_substrate.py
MAX_RATIO, COMPUTED_HEIGHT = 4.0, 0.075  # greatest Ea/Eb and h_a/R of caps that were computed; none below Ea = Eb


def substrate_share(deformation: ArrayLike, modulus_ratio: float) -> Array:
    """Return a'/al' [-] of the asperity whose own delta_a/h_a is `deformation` [-]: eq. (1) forwards."""
    y = np.asarray(deformation, float)
    return np.asarray(y * (1 + modulus_ratio * COUPLING * np.sqrt(y)) / SHAPE)


def asperity_share(applied: ArrayLike, modulus_ratio: float, coefficient: float = COUPLING) -> Array:
    """Return lam = delta_a/delta [-] at applied = delta/h_a [-]: eq. (1) solved, t^2 + q t^3 = 1 with lam = t^2.

    q = Er xi sqrt(delta). Newton from above converges monotonically, since the left side is convex and growing.
    """
    q = modulus_ratio * coefficient * np.sqrt(np.asarray(applied, float))
    t = np.ones_like(q)
    for _ in range(60):
        step = (t**2 + q * t**3 - 1) / (2 * t + 3 * q * t**2)
        t = t - step
        if np.all(np.abs(step) <= 2e-16 * t):
            break
    return np.asarray(t**2)


def mixed_compliance(x: ArrayLike, slope: ArrayLike, modulus_ratio: float) -> tuple[Array, Array]:
    """Return c [-], compliance over that of the asperity's own material, and g = d ln c/d ln(delta), at x = a'/al'.

    slope: h_a/r_a of the caps. Broadcasts. With r_a^2 = 2 R h_a, h_a/sqrt(R delta) is slope sqrt(2/(1.06 x)).
    """
    with np.errstate(divide="ignore", over="ignore"):
        u = OWN_MODULUS * np.asarray(slope, float) * np.sqrt(2 / (SHAPE * np.asarray(x, float)))
    far = (modulus_ratio - 1) * np.exp(-u)
    with np.errstate(invalid="ignore"):
        return 1 + far, np.where(far == 0, 0.0, far * u / (2 * (1 + far)))


def mixed_place(y: ArrayLike, slope: ArrayLike, modulus_ratio: float) -> Array:
    """Return the x = a'/al' [-] at which x/c(x)^2 is y: where an asperity reaches a deformation over that of yield."""
    y, slope = np.broadcast_arrays(np.asarray(y, float), np.asarray(slope, float))
    ends = 2 * np.log(min(1.0, modulus_ratio)), 2 * np.log(max(1.0, modulus_ratio))
    low, high = np.full(y.shape, ends[0]), np.full(y.shape, ends[1])
    for _ in range(60):  # bisection of ln(x/y), between the two materials' own values
        middle = (low + high) / 2
        c, _ = mixed_compliance(y * np.exp(middle), slope, modulus_ratio)
        below = middle < 2 * np.log(c)
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return np.asarray(y * np.exp((low + high) / 2))


class WeightedIslands(Islands):
    """Islands whose powers carry lam(x): total(p) sums (x lam(x))^p, by quadrature that is exact to rounding.

    lam is analytic in sqrt(x). Ranges from 0 go by Gauss-Jacobi quadrature in z = sqrt(x/upper) with the weight
    z^(2 e - 1); others by Gauss-Legendre in ln x, on panels of at most a factor of a thousand.
    """

    def __init__(self, D: float, psi: float | None, modulus_ratio: float) -> None:
        super().__init__(D, psi)
        self.modulus_ratio = modulus_ratio
        self._jacobi: dict[float, tuple[Array, Array]] = {}

    @cached_property
    def _legendre(self) -> tuple[Array, Array]:
        x, w = np.polynomial.legendre.leggauss(NODES)
        return (x + 1) / 2, w / 2

    def _lam(self, x: Array) -> Array:
        return asperity_share(SHAPE * x, self.modulus_ratio)

    def _from_zero(self, power: float, upper: Array) -> Array:
        from scipy.special import roots_jacobi

        exponent = power + (1 - self.D) / 2
        if exponent <= 0:
            raise InputError(f"the sum of (a')^{power} over the islands from 0 diverges at D = {self.D}")
        if exponent not in self._jacobi:
            nodes, weights = roots_jacobi(NODES, 0.0, 2 * exponent - 1)
            self._jacobi[exponent] = ((nodes + 1) / 2, weights / 2 ** (2 * exponent))
        z, w = self._jacobi[exponent]
        inner = self._lam(upper[..., None] * z**2) ** power
        return np.asarray(2 * upper**exponent * (inner @ w))

    def _between(self, power: float, lower: Array, upper: Array) -> Array:
        t, w = self._legendre
        exponent = power + (1 - self.D) / 2
        length = np.log(np.maximum(upper / lower, 1.0))
        panels = max(1, int(np.ceil(length.max(initial=0.0) / PANEL)))
        sum_ = np.zeros_like(length)
        for i in range(panels):
            x = lower[..., None] * np.exp(length[..., None] * (i + t) / panels)
            sum_ += (x**exponent * self._lam(x) ** power) @ w
        return np.asarray(length * sum_ / panels)

    def total(self, power: float, lower: ArrayLike, upper: ArrayLike) -> Array:
        """Sum of (x lam(x))^power over all islands with lower < x < upper [-]."""
        if power == 0:
            return super().total(power, lower, upper)
        lo, hi = np.broadcast_arrays(np.asarray(lower, float), np.asarray(upper, float))
        some, from_zero = (hi > lo) & (lo > 0), (hi > lo) & (lo <= 0)
        result = np.zeros(lo.shape)
        if np.any(some):
            result[some] = self._between(power, lo[some], hi[some])
        if np.any(from_zero):
            result[from_zero] = self._from_zero(power, hi[from_zero])
        return np.asarray(self.weight * result)


class MixedIslands(Islands):
    """Islands whose compliance c depends on their size, by `mixed_compliance`; sums by Gauss-Legendre in ln x.

    Below the x at which exp(-u) has left double precision c is 1 and the power is integrated in closed form.
    """

    def __init__(self, D: float, psi: float | None, modulus_ratio: float) -> None:
        super().__init__(D, psi)
        self.modulus_ratio = modulus_ratio

    def log_compliance(self, slope: Array) -> Array:
        """Return ln c [-] of the largest asperity where its c equals h_a/r_a over `slope`, of any shape."""
        low, high = (np.full(slope.shape, v) for v in sorted((0.0, float(np.log(self.modulus_ratio)))))
        for _ in range(60):
            middle = (low + high) / 2
            below = middle < np.log(mixed_compliance(1.0, slope * np.exp(middle), self.modulus_ratio)[0])
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return np.asarray((low + high) / 2)

    def ground(self, slope: Array) -> dict[str, Mask]:
        """Say where caps of h_a/r_a = slope lie outside those that were computed; empty where Ea = Eb."""
        if self.modulus_ratio == 1:
            return {}
        return {
            "modulus_ratio below 1, for which no caps were computed": np.full(slope.shape, self.modulus_ratio < 1),
            f"h_a/R above {COMPUTED_HEIGHT:g}, up to which caps were computed": 2 * slope**2 > COMPUTED_HEIGHT,
        }

    def mixed(
        self, power: float, softness: float, lower: ArrayLike, upper: ArrayLike, slope: ArrayLike, *, tangent: bool
    ) -> Array:
        """Sum of (x/c^2)^power c^softness over all islands with lower < x < upper [-].

        tangent: each term times 1 - 2 g power/(power + 1), which makes d/d(delta) of a force c^2 (delta/c^2)^(power +
        1) out of that at constant c. slope: h_a/r_a. Raises InputError where the sum from zero diverges.
        """
        lo, hi, q = np.broadcast_arrays(*(np.asarray(v, float) for v in (lower, upper, slope)))
        plain = 2 / SHAPE * (OWN_MODULUS * q / 40) ** 2  # u = 40
        start = np.minimum(np.maximum(lo, plain), hi)
        t, w = np.polynomial.legendre.leggauss(NODES)
        exponent = power + (1 - self.D) / 2
        length = np.where(hi > start, np.log(np.where(hi > start, hi / start, 1.0)), 0.0)
        panels = max(1, int(np.ceil(length.max(initial=0.0) / PANEL)))
        sum_ = np.zeros_like(length)
        for i in range(panels):
            x = start[..., None] * np.exp(length[..., None] * (i + (t + 1) / 2) / panels)
            c, g = mixed_compliance(x, q[..., None], self.modulus_ratio)
            each = c ** (softness - 2 * power)
            if tangent:
                each = each * (1 - 2 * g * power / (power + 1))
            sum_ += (x**exponent * each) @ (w / 2)
        return np.asarray(self.weight * length * sum_ / panels + self.total(power, lo, start))
