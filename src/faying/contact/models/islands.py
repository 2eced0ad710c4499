"""The island distribution of a fractal surface and the integral of a power of the truncated area over it.

Everything is written for x = a'/al', the truncated area of an asperity over that of the largest one, so that the
number of islands is dimensionless: n dx = (D-1)/2 psi^((3-D)/2) x^(-(D+1)/2) dx with 0 < x <= 1 (eq. 25 of
Zhang et al. 2024, doi:10.3390/fractalfract8100611; Mandelbrot's law with the psi of Wang and Komvopoulos 1994,
doi:10.1115/1.2927035).
"""

from collections.abc import Callable
from functools import cache
from math import e, exp, log

import numpy as np
from numpy.typing import ArrayLike

from faying.errors import InputError
from faying.typing import Array


def power_integral(exponent: float, lower: ArrayLike, upper: ArrayLike) -> Array:
    """Integrate x^(exponent - 1) from lower to upper [-]; the one integral behind every total of the fractal laws.

    Accurate through exponent = 0, where it is ln(upper/lower), and for narrow ranges. lower = 0 needs a positive
    exponent (InputError otherwise). Where upper <= lower the range is empty and the integral 0. Shapes broadcast.
    """
    from scipy.special import exprel

    lo, hi = np.broadcast_arrays(np.asarray(lower, float), np.asarray(upper, float))
    full = (hi > lo) & (lo > 0)
    top = np.where(full, hi, 1.0)
    ratio = np.log(top / np.where(full, lo, 1.0))
    finite = np.where(full, top**exponent * ratio * exprel(-exponent * ratio), 0.0)
    from_zero = (lo <= 0) & (hi > 0)
    if not np.any(from_zero):
        return finite
    if exponent <= 0:
        raise InputError(f"the integral of x^({exponent} - 1) from 0 diverges; give a lower limit above 0")
    return np.where(from_zero, np.where(from_zero, hi, 1.0) ** exponent / exponent, finite)


@cache
def domain_extension(D: float) -> float:
    """Return psi of Wang and Komvopoulos [-], greater than 1, for a surface dimension 2 < D < 3.

    Root of psi^((3-D)/2) - (1 + psi^(-(D-1)/2))^(-(3-D)/(D-1)) = (3-D)/(D-1), doi:10.1115/1.2927035, with D - 1 in
    place of the profile's dimension. Limits: 2.618 (golden ratio squared) at D = 2 and e - 1 at D = 3.
    """
    from scipy.optimize import brentq

    if not 2 < D < 3:
        raise InputError(f"D = {D}: the dimension of a surface is between 2 and 3, for example 2.4")
    q = (3 - D) / (D - 1)

    def residual(psi: float) -> float:
        # both sides divided by q, each power written as 1 + q (...) so that nothing cancels as D -> 3
        head = np.expm1((3 - D) / 2 * log(psi)) / q
        tail = np.expm1(-q * np.log1p(psi ** (-(D - 1) / 2))) / q
        return float(head - tail - 1)

    return float(brentq(residual, 1 + 1e-9, e, xtol=1e-15, rtol=8.9e-16))


def covering(area: Callable[[Array], Array], scan_area: float) -> float:
    """Largest truncated area al' [m2] at which the real area [m2], a function of al', is the area of the scan [m2]."""
    from scipy.optimize import brentq

    def excess(log_al: float) -> float:
        return float(np.log(area(np.array(np.exp(log_al))) / scan_area))

    middle = log(scan_area)
    return float(np.exp(brentq(excess, middle - 80, middle + 40, xtol=1e-12)))


class Islands:
    """The island distribution of one surface: dimension D and extension psi (solved where None)."""

    def __init__(self, D: float, psi: float | None = None) -> None:
        self.D = D
        self.psi = domain_extension(D) if psi is None else psi
        self.weight = (D - 1) / 2 * exp((3 - D) / 2 * log(self.psi))

    def total(self, power: float, lower: ArrayLike, upper: ArrayLike) -> Array:
        """Sum of x^power over all islands with lower < x < upper [-]."""
        return self.weight * power_integral(power + (1 - self.D) / 2, lower, upper)
