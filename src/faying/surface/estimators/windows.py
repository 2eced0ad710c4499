"""Mean square residual of windows about a polynomial: what roughness length and detrended fluctuation share."""

from functools import cache
from math import log, pi

import numpy as np

from faying.surface.estimators.scaling import Local, cut_log, inside, mean_law, rows_of, sizes_of, straight
from faying.typing import Array, Mask


@cache
def share_left(order: int) -> tuple[Array, Array]:
    """Cycles u per window, and the share T(u) of a wave's power left when the polynomial is removed."""
    from scipy.special import spherical_jn

    u = np.exp(np.linspace(log(1e-5), log(200.0), 40001))
    x = pi * u
    left = 1 - sum((2 * k + 1) * spherical_jn(k, x) ** 2 for k in range(order + 1))
    # leading term of the series where the difference cancels; all orders together sum to 1
    k = order + 1
    double = float(np.prod(np.arange(2 * k + 1, 0, -2)))
    return u, np.where(x < 0.05, (2 * k + 1) * x ** (2 * k) / double**2, left)


def window_transfer(D: float, order: int, integrated: bool) -> float:
    """Integral of u^-(7-2D) T(u) du, T the share of a wave of u cycles left when a window's polynomial is removed.

    T(u) = 1 - sum_k (2k+1) j_k(pi u)^2 over k = 0 .. order, j_k the spherical Bessel functions. With `integrated` the
    wave has been summed first, which divides its power by (2 pi u)^2. In this unit the window has length 1.
    """
    u, left = share_left(order)
    power = 7 - 2 * D + (2 if integrated else 0)
    total = float(np.trapezoid(u ** (1 - power) * left, np.log(u)))
    # beyond the last u, T is 1
    total += float(u[-1]) ** (1 - power) / (power - 1)
    return float(total / (2 * pi) ** 2) if integrated else total


def fluctuation(lines: Array, size: int, order: int) -> Array:
    """Mean square residual of every window of `size` points about its polynomial (windows from both ends)."""
    count = lines.shape[1] // size
    x = np.linspace(-1, 1, size)
    basis = np.linalg.qr(np.stack([x**k for k in range(order + 1)], axis=1))[0]
    total = []
    for part in (lines[:, : count * size], lines[:, lines.shape[1] - count * size :]):
        w = part.reshape(-1, size)
        inside = w @ basis
        total.append((np.einsum("ij,ij->i", w, w) - np.einsum("ij,ij->i", inside, inside)) / size)
    return np.asarray(np.maximum(np.concatenate(total), 1e-300), float)


def in_windows(order: int, integrated: bool) -> Local:
    """Return the local estimator of windows about polynomials of `order`, of the heights or of their running sum."""

    def local(z: Array, known: Mask, steps: tuple[float, ...], low: float, high: float) -> tuple[float, float]:
        found = []
        for lines, step in rows_of(z, steps):
            work = np.cumsum(lines - lines.mean(axis=1, keepdims=True), axis=1) * step if integrated else lines
            sizes = sizes_of(low, min(high, lines.shape[1] * step / 2), step)
            x = np.log(np.array(sizes) * step)
            y = np.array([log(float(fluctuation(work, s, order).mean())) for s in sizes])
            slope, intercept = straight(x, y)
            D = 3 - slope / 2 + (1.0 if integrated else 0.0)
            # F^2 = B w^(6-2D) (w^2) kappa(D)
            level = intercept - log(window_transfer(inside(D), order, integrated)) - cut_log(inside(D), z.ndim == 2)
            found.append((D, level))
        return mean_law(found, low, high)

    return local
