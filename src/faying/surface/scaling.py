"""Estimators that read D from how a local measure scales with size: structure function, roughness length, Higuchi,
multifractal detrended fluctuation, box counting.

Each returns D and, through its closed transfer function, ln of the density S(f) = B f^-(7-2D). The interval comes from
the spread between parts of the scan, Student's t; it holds no bias, see `selftest`.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from math import log, pi

import numpy as np

from faying.errors import FayingError, InputError, NotConverged
from faying.surface.convention import cut_factor, structure_coefficient
from faying.surface.estimate import Z95, Estimate, Limits, with_intervals
from faying.surface.form import Prepared
from faying.surface.scan import Profile, Scan
from faying.surface.spectrum import structure_function
from faying.typing import Array, Mask

Part = tuple[Array, Mask]
# heights, known points, spacings in the order of the axes, smallest and largest size [m] -> D, ln B
Local = Callable[[Array, Mask, tuple[float, ...], float, float], tuple[float, float]]


def _steps(scan: Scan | Profile) -> tuple[float, ...]:
    return (scan.spacing,) if isinstance(scan, Profile) else (scan.spacing[1], scan.spacing[0])


def _side(z: Array, steps: tuple[float, ...]) -> float:
    return float(min(n * d for n, d in zip(z.shape, steps, strict=True)))


def _parts(z: Array, known: Mask) -> list[Part]:
    """Cut a scan into 3 x 3 parts, a profile into 8."""
    if z.ndim == 1:
        return list(zip(np.array_split(z, 8), np.array_split(known, 8), strict=True))
    out: list[Part] = []
    for rows, marks in zip(np.array_split(z, 3), np.array_split(known, 3), strict=True):
        out += zip(np.array_split(rows, 3, axis=1), np.array_split(marks, 3, axis=1), strict=True)
    return out


def _estimate(ready: Prepared, c: float, local: Local, low: float, high: float, name: str) -> Estimate:
    """Run a local estimator on the whole and on its parts."""
    from scipy.stats import t as student

    scan = ready.scan
    steps, z = _steps(scan), scan.heights
    if high < 3 * low:
        raise NotConverged(f"{scan.source}: sizes {low:.3g} .. {high:.3g} m are too few for {name}; use method psd")
    D, level = local(z, ready.known, steps, low, high)
    spots = []
    for part, known in _parts(z, ready.known):
        try:
            spots.append(local(part, known, steps, low, min(high, 0.5 * _side(part, steps))))
        except FayingError:
            continue
    if len(spots) < 4:
        raise NotConverged(f"{scan.source}: too small for an interval of {name}; use method psd")
    cloud = np.array(spots)
    cloud = cloud[np.isfinite(cloud).all(axis=1)]
    pivot = 1 / (low * high) ** 0.5
    # ln S at the pivot, ln B - (7-2D) ln f
    cloud = np.stack([cloud[:, 1] - (7 - 2 * cloud[:, 0]) * log(pivot), cloud[:, 0]])
    widen = (float(student.ppf(0.975, cloud.shape[1] - 1)) / Z95) ** 2
    return with_intervals(
        D,
        level - (7 - 2 * D) * log(pivot),
        np.cov(cloud) / cloud.shape[1] * widen,
        pivot,
        c,
        band=(low, high),
        notes=("the interval is the spread between parts of the scan and holds no bias; --self-test measures that",),
    )


def _band(ready: Prepared, limits: Limits, points: float, share: float) -> tuple[float, float]:
    """Sizes [m] from `points` spacings (and the instrument's resolution) to `share` of the side, or as given.

    Where that is less than a factor of 3, up to a third of the side.
    """
    if limits is not None:
        return limits
    steps = _steps(ready.scan)
    low = points * max(steps)
    if ready.scan.instrument.resolution:
        low = max(low, ready.scan.instrument.resolution)
    side = _side(ready.scan.heights, steps)
    # a scan of a hundred points or so: larger sizes than are good rather than none
    return low, max(share * side, min(3.2 * low, side / 3))


def _line(x: Array, y: Array) -> tuple[float, float]:
    """Slope and intercept of a straight line through logarithms."""
    slope, intercept = np.polyfit(x, y, 1)
    return float(slope), float(intercept)


def _safe(D: float) -> float:
    """D held inside the open range where the transfer functions exist."""
    return min(max(D, 2.005), 2.995)


def _rows(z: Array, steps: tuple[float, ...]) -> list[tuple[Array, float]]:
    """The profiles along x and along y (at most 256 each, evenly chosen) with their spacing."""
    if z.ndim == 1:
        return [(z[None, :], steps[0])]
    out = []
    for lines, step in ((z, steps[1]), (z.T, steps[0])):
        every = max(1, len(lines) // 256)
        out.append((np.ascontiguousarray(lines[::every]), step))
    return out


def _sizes(low: float, high: float, step: float, count: int = 12) -> list[int]:
    """About `count` whole numbers of points between low and high, evenly over the logarithm."""
    found = np.unique(np.rint(np.geomspace(max(low / step, 1.0), high / step, count)).astype(int))
    if len(found) < 4:
        raise NotConverged(f"only {len(found)} sizes between {low:.3g} and {high:.3g} m; give a wider band")
    return [int(n) for n in found]


def _cut_log(D: float, areal: bool) -> float:
    """ln of a profile's spectrum over the radial spectrum: the mean over directions of a surface, 0 for a profile."""
    return log(cut_factor(D)) if areal else 0.0


def by_structure(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Fit SF = B lag^(6-2D) + constant to the areal structure function; every lag vector counts alike.

    The constant is twice the variance of white noise, less twice the power of the wavelengths that the points cannot
    hold (they lower the structure function at every lag alike), so it may be negative.
    """
    from scipy.optimize import least_squares

    def local(z: Array, known: Mask, steps: tuple[float, ...], low: float, high: float) -> tuple[float, float]:
        part: Scan | Profile = (
            Profile(heights=z, spacing=steps[0]) if z.ndim == 1 else Scan(heights=z, spacing=(steps[1], steps[0]))
        )
        sf = structure_function(part, known=known, longest=min(0.5, high / _side(z, steps)))
        use = (sf.lag >= low) & (sf.lag <= high) & (sf.value > 0)
        if use.sum() < 5:
            raise NotConverged(f"only {int(use.sum())} lags between {low:.3g} and {high:.3g} m; give a wider band")
        x, y = np.log(sf.lag[use]), np.log(sf.value[use])
        middle = float(x.mean())
        x = x - middle
        slope, intercept = _line(x, y)

        def residual(t: Array) -> Array:
            return np.asarray(np.log(np.maximum(np.exp(t[0] * x) + t[2], 1e-12)) + t[1] - y)

        start = np.array([min(max(slope, 0.05), 1.95), intercept, 0.0])
        found = least_squares(residual, start, bounds=([0.01, -np.inf, -20], [1.999, np.inf, 50])).x
        D = 3 - float(found[0]) / 2
        k = log(2 * structure_coefficient(_safe(D))) + _cut_log(_safe(D), z.ndim == 2)
        return D, float(found[1]) - (6 - 2 * D) * middle - k

    return _estimate(ready, c, local, *_band(ready, limits, 3, 1 / 16), "the structure function")


@cache
def _share_left(order: int) -> tuple[Array, Array]:
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
    u, left = _share_left(order)
    power = 7 - 2 * D + (2 if integrated else 0)
    total = float(np.trapezoid(u ** (1 - power) * left, np.log(u)))
    # beyond the last u, T is 1
    total += float(u[-1]) ** (1 - power) / (power - 1)
    return float(total / (2 * pi) ** 2) if integrated else total


def _fluctuation(lines: Array, size: int, order: int) -> Array:
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


def _windows(order: int, integrated: bool) -> Local:
    def local(z: Array, known: Mask, steps: tuple[float, ...], low: float, high: float) -> tuple[float, float]:
        found = []
        for lines, step in _rows(z, steps):
            work = np.cumsum(lines - lines.mean(axis=1, keepdims=True), axis=1) * step if integrated else lines
            sizes = _sizes(low, min(high, lines.shape[1] * step / 2), step)
            x = np.log(np.array(sizes) * step)
            y = np.array([log(float(_fluctuation(work, s, order).mean())) for s in sizes])
            slope, intercept = _line(x, y)
            D = 3 - slope / 2 + (1.0 if integrated else 0.0)
            # F^2 = B w^(6-2D) (w^2) kappa(D)
            level = intercept - log(window_transfer(_safe(D), order, integrated)) - _cut_log(_safe(D), z.ndim == 2)
            found.append((D, level - (7 - 2 * D) * log(1 / (low * high) ** 0.5)))
        D = float(np.mean([d for d, _ in found]))
        return D, float(np.mean([v for _, v in found])) + (7 - 2 * D) * log(1 / (low * high) ** 0.5)

    return local


def by_roughness_length(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Rms residual about a straight line in windows of w along x and y: Rq ~ w^(3-D) (Malinverno, doi:10.1029/
    GL017i011p01953)."""
    return _estimate(ready, c, _windows(1, False), *_band(ready, limits, 10, 1 / 4), "the roughness length")


def by_mfdfa(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Fluctuation of the summed profiles about parabolas, q = 2: D = 4 - h(2) (Kantelhardt, doi:10.1016/
    S0378-4371(02)01383-3). `generalised_hurst` gives the other q."""
    return _estimate(ready, c, _windows(2, True), *_band(ready, limits, 10, 1 / 4), "the detrended fluctuation")


def generalised_hurst(scan: Scan | Profile, q: Array, *, low: float, high: float) -> Array:
    """Return h(q) of the summed profiles along x (order 2, sizes low .. high [m]); shape as q.

    A self-affine (monofractal) surface has h = 4 - D for every q; a range of values says it is multifractal.
    Raises InputError for sizes outside the scan.
    """
    z = scan.heights if scan.heights.ndim == 2 else scan.heights[None, :]
    step = scan.spacing if isinstance(scan, Profile) else scan.spacing[0]
    if not 6 * step <= low < high <= z.shape[1] * step / 2:
        raise InputError(f"low = {low}, high = {high}: sizes lie between 6 spacings and half the profile's length")
    work = np.cumsum(z - z.mean(axis=1, keepdims=True), axis=1)
    sizes = _sizes(low, high, step)
    squares = [np.log(_fluctuation(work, s, 2)) / 2 for s in sizes]
    x = np.log(sizes)
    out = []
    for value in np.ravel(q):
        if abs(value) < 1e-9:
            y = [float(v.mean()) for v in squares]
        else:
            y = [float(np.log(np.mean(np.exp(value * (v - v.max())))) / value + v.max()) for v in squares]
        out.append(_line(x, np.array(y))[0])
    h: Array = np.array(out, dtype=np.float64)
    return h.reshape(np.shape(q))


def by_higuchi(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Length of the profiles along x and y measured with steps of k points: L ~ k^-Ds (Higuchi, doi:10.1016/
    0167-2789(88)90081-4). G from the mean step, (2/pi)^(1/2) of its rms for Gaussian heights."""

    def local(z: Array, known: Mask, steps: tuple[float, ...], low: float, high: float) -> tuple[float, float]:
        found = []
        marks = _rows(known.astype(float), steps)
        for (lines, step), (mark, _) in zip(_rows(z, steps), marks, strict=True):
            sizes = _sizes(low, high, step)
            x = np.log(np.array(sizes) * step)
            y = []
            for k in sizes:
                both = mark[:, k:] * mark[:, :-k]
                y.append(log(max(float(np.sum(np.abs(lines[:, k:] - lines[:, :-k]) * both) / both.sum()), 1e-300)))
            # the length is N k^-2 sum |step|, so its slope -Ds is that of the mean step less 2
            slope, intercept = _line(x, np.array(y))
            D = 3 - slope
            level = 2 * intercept + log(pi / 2) - log(2 * structure_coefficient(_safe(D)))
            found.append((D, level - _cut_log(_safe(D), z.ndim == 2) - (7 - 2 * D) * log(1 / (low * high) ** 0.5)))
        D = float(np.mean([d for d, _ in found]))
        return D, float(np.mean([v for _, v in found])) + (7 - 2 * D) * log(1 / (low * high) ** 0.5)

    return _estimate(ready, c, local, *_band(ready, limits, 2, 1 / 16), "Higuchi's length")


def by_box(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Boxes that the surface meets (differential box counting of Sarkar and Chaudhuri, doi:10.1109/21.278), N ~ r^-D.

    The box is as high, in units of the range of heights, as it is wide, in units of the side. Counting does not weigh
    the heights, so G is read from the mean square difference over the geometric mean of the sizes. Strongly biased
    towards the middle of 2 .. 3; its own remark says so.
    """

    def local(z: Array, known: Mask, steps: tuple[float, ...], low: float, high: float) -> tuple[float, float]:
        step = max(steps)
        side = _side(z, steps)
        span = float(np.ptp(z))
        sizes = _sizes(low, high, step, 10)
        y = []
        for s in sizes:
            tops, bottoms = z, z
            for axis in range(z.ndim):
                starts = np.arange(0, tops.shape[axis] - s + 1, s)
                cut = [slice(None)] * z.ndim
                cut[axis] = slice(0, len(starts) * s)
                # neighbouring boxes share their border, so that the surface is counted as continuous
                tops = np.maximum.reduceat(tops[tuple(cut)], starts, axis=axis)
                bottoms = np.minimum.reduceat(bottoms[tuple(cut)], starts, axis=axis)
            height = span * s * step / side
            covered = float(np.prod([len(range(0, n - s + 1, s)) * s / n for n in z.shape]))
            count = np.floor((tops - z.min()) / height) - np.floor((bottoms - z.min()) / height) + 1
            y.append(log(float(count.sum()) / covered))
        slope, _ = _line(np.log(np.array(sizes) * step), np.array(y))
        D = -slope + (1 if z.ndim == 1 else 0)
        gap = _sizes(low, high, step)[len(_sizes(low, high, step)) // 2]
        square = np.mean([float(np.mean((lines[:, gap:] - lines[:, :-gap]) ** 2)) for lines, _ in _rows(z, steps)])
        k = log(2 * structure_coefficient(_safe(D))) + _cut_log(_safe(D), z.ndim == 2)
        return D, log(max(float(square), 1e-300)) - (6 - 2 * D) * log(gap * step) - k

    found = _estimate(ready, c, local, *_band(ready, limits, 2, 1 / 8), "box counting")
    words = "box counting is known to be off by 0.1 and more in D: quote it beside others, or correct it by --self-test"
    return replace(found, notes=(*found.notes, words))
