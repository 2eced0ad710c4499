"""The estimators of D and G: each is a function and an entry of the table."""

from functools import cache
from math import log, pi

import numpy as np

from faying.errors import NotConverged
from faying.surface.convention import structure_coefficient
from faying.surface.estimators.base import Estimate, Estimator, Limits, white_rms
from faying.surface.estimators.scaling import (
    Local,
    cut_log,
    inside,
    mean_law,
    rows_of,
    side_of,
    size_band,
    sizes_of,
    through_parts,
)
from faying.surface.estimators.spectral import clean_band, of_law, spectral_fit, through_draws
from faying.surface.form import Prepared
from faying.surface.heights import AreaHeights, LineHeights
from faying.surface.moments import invert_ratio
from faying.surface.spectrum import structure_function
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


def window_transfer(D: float, order: int) -> float:
    """Integral of u^-(7-2D) T(u) / (2 pi u)^2 du, T the share of a summed wave left when a polynomial is removed.

    T(u) = 1 - sum_k (2k+1) j_k(pi u)^2 over k = 0 .. order, j_k the spherical Bessel functions, of a wave of u cycles
    in a window of length 1.
    """
    u, left = share_left(order)
    power = 9 - 2 * D
    total = float(np.trapezoid(u ** (1 - power) * left, np.log(u)))
    # beyond the last u, T is 1
    total += float(u[-1]) ** (1 - power) / (power - 1)
    return float(total / (2 * pi) ** 2)


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


def in_windows(order: int) -> Local:
    """Return the local estimator of windows about polynomials of `order`, of the running sum of the heights."""

    def local(z: Array, known: Mask, steps: tuple[float, ...], low: float, high: float) -> tuple[float, float]:
        found = []
        for lines, step in rows_of(z, steps):
            work = np.cumsum(lines - lines.mean(axis=1, keepdims=True), axis=1) * step
            sizes = sizes_of(low, min(high, lines.shape[1] * step / 2), step)
            x = np.log(np.array(sizes) * step)
            y = np.array([log(float(fluctuation(work, s, order).mean())) for s in sizes])
            slope, intercept = np.polyfit(x, y, 1)
            D = 4 - slope / 2
            # F^2 = B w^(6-2D) (w^2) kappa(D)
            level = intercept - log(window_transfer(inside(D), order)) - cut_log(inside(D), z.ndim == 2)
            found.append((D, level))
        return mean_law(found, low, high)

    return local


def by_psd(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Fit a power law with a white term to the spectrum averaged over directions (see `powerlaw`)."""
    _, law, notes = spectral_fit(ready, limits)
    return of_law(law, c, noise=white_rms(ready.scan, law.noise), notes=notes)


def by_structure(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Fit SF = B lag^(6-2D) + constant to the areal structure function; every lag vector counts alike.

    The constant is twice the variance of white noise, less twice the power of the wavelengths that the points cannot
    hold (they lower the structure function at every lag alike), so it may be negative.
    """
    from scipy.optimize import least_squares

    def local(z: Array, known: Mask, steps: tuple[float, ...], low: float, high: float) -> tuple[float, float]:
        part: AreaHeights | LineHeights = (
            LineHeights(heights=z, spacing=steps[0])
            if z.ndim == 1
            else AreaHeights(heights=z, spacing=(steps[1], steps[0]))
        )
        sf = structure_function(part, known=known, longest=min(0.5, high / side_of(z, steps)))
        use = (sf.lag >= low) & (sf.lag <= high) & (sf.value > 0)
        if use.sum() < 5:
            raise NotConverged(f"only {int(use.sum())} lags between {low:.3g} and {high:.3g} m; give a wider band")
        x, y = np.log(sf.lag[use]), np.log(sf.value[use])
        middle = float(x.mean())
        x = x - middle
        slope, intercept = np.polyfit(x, y, 1)

        def residual(t: Array) -> Array:
            return np.asarray(np.log(np.maximum(np.exp(t[0] * x) + t[2], 1e-12)) + t[1] - y)

        start = np.array([min(max(slope, 0.05), 1.95), intercept, 0.0])
        found = least_squares(residual, start, bounds=([0.01, -np.inf, -20], [1.999, np.inf, 50])).x
        D = 3 - float(found[0]) / 2
        k = log(2 * structure_coefficient(inside(D))) + cut_log(inside(D), z.ndim == 2)
        return D, float(found[1]) - (6 - 2 * D) * middle - k

    return through_parts(ready, c, local, size_band(ready, limits, 3, 1 / 16), "the structure function")


def by_mfdfa(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Fluctuation of the summed profiles about parabolas, of order q = 2: D = 4 - h(2).

    Source: Kantelhardt et al. 2002, doi:10.1016/S0378-4371(02)01383-3.
    """
    return through_parts(ready, c, in_windows(2), size_band(ready, limits, 10, 1 / 4), "the detrended fluctuation")


def by_moments(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Take m2/m0 of the band (white part and window smearing removed) and solve for D, as the ideal series' map does.

    The moments are sums over bins, m_2k = (2 pi)^(2k) sum (S - white) f^(2k) df; G follows from m2, the better known
    of the two. Intervals by drawing the bins from their gamma law and repeating the inversion.
    """
    band = clean_band(ready, limits)
    f, width = band.frequency, band.width

    def solve(clean: Array) -> tuple[float, float]:
        m0, m2 = float(np.sum(clean * width)), float(np.sum(clean * f**2 * width))
        if m0 <= 0 or m2 <= 0:
            raise NotConverged("the spectral moments of the band are not positive once the noise is taken out")
        slope = invert_ratio(m2 / m0, f, width)
        return slope, log(m2) - log(float(np.sum((f / band.law.pivot) ** -slope * f**2 * width)))

    return through_draws(ready, band, c, solve)


WINDOWS, BAND = "windows from 10 spacings to a quarter of the side", "a band of a factor 5 in wavelength"
ESTIMATORS: dict[str, Estimator] = {
    name: Estimator(name=name, needs=needs, bias=bias, estimate=estimate)
    for name, estimate, needs, bias in (
        ("psd", by_psd, BAND, "none seen"),
        ("structure", by_structure, "lags from 3 spacings to a sixteenth of the side", "up to +0.1 in D below 2.2"),
        ("mfdfa", by_mfdfa, WINDOWS, "within 0.02 in D"),
        ("moments", by_moments, BAND, "none seen; its interval is twice as wide as that of psd"),
    )
}
METHODS = tuple(ESTIMATORS)
