"""Asperity and substrate: how much of the applied deformation the asperity takes (eqs. 1 and 2 of Zhang et al. 2024).

delta = delta_a (1 + Er xi sqrt(delta_a)) with xi = 1.5 sqrt(R)/r_a. Because r_a^2 = 2 R h_a, xi sqrt(h_a) is always
1.5/sqrt(2), so the share lam = delta_a/delta depends on Er and on delta/h_a alone. In the JK model
delta = 1.06 h_a a'/al'.
"""

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.models.islands import Islands
from faying.errors import InputError
from faying.typing import Array

SHAPE = 1.06  # 1 - cos(pi r/(2 r_a)) ~ 1.06 (r/r_a)^2, eq. (9)
PANEL = np.log(1e3)  # longest panel of a quadrature in ln x
NODES = 32  # of a quadrature on one panel, exact to rounding
COUPLING = 1.5 / 2**0.5  # xi sqrt(h_a)


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
