"""What the estimators share that read D from how a local measure scales with size.

Each returns D and, through its closed transfer function, ln of the density S(f) = B f^-(7-2D). The interval comes from
the spread between parts of the scan, Student's t; it holds no bias.
"""

from collections.abc import Callable
from math import log

import numpy as np

from faying.errors import FayingError, NotConverged
from faying.surface.estimators.base import Z95, Estimate, Limits, with_intervals
from faying.surface.form import Prepared
from faying.surface.heights import sides_of, steps_of
from faying.typing import Array, Mask

Part = tuple[Array, Mask]
# heights, known points, spacings in the order of the axes, smallest and largest size [m] -> D, ln B
Local = Callable[[Array, Mask, tuple[float, ...], float, float], tuple[float, float]]


def side_of(z: Array, steps: tuple[float, ...]) -> float:
    """Shortest side [m]."""
    return float(min(n * d for n, d in zip(z.shape, steps, strict=True)))


def _parts(z: Array, known: Mask) -> list[Part]:
    """Cut a scan into 3 x 3 parts, a profile into 8."""
    if z.ndim == 1:
        return list(zip(np.array_split(z, 8), np.array_split(known, 8), strict=True))
    out: list[Part] = []
    for rows, marks in zip(np.array_split(z, 3), np.array_split(known, 3), strict=True):
        out += zip(np.array_split(rows, 3, axis=1), np.array_split(marks, 3, axis=1), strict=True)
    return out


def through_parts(ready: Prepared, c: float, local: Local, sizes: tuple[float, float], name: str) -> Estimate:
    """Run a local estimator over sizes [m] from the smallest to the largest, on the whole and on its parts."""
    from scipy.stats import t as student

    scan, (low, high) = ready.scan, sizes
    steps, z = steps_of(scan), scan.heights
    if high < 3 * low:
        raise NotConverged(f"{scan.source}: sizes {low:.3g} .. {high:.3g} m are too few for {name}; use method psd")
    D, level = local(z, ready.known, steps, low, high)
    spots = []
    for part, known in _parts(z, ready.known):
        try:
            spots.append(local(part, known, steps, low, min(high, 0.5 * side_of(part, steps))))
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
        notes=("the interval is the spread between parts of the scan without a bias: psd states both",),
    )


def size_band(ready: Prepared, limits: Limits, points: float, share: float) -> tuple[float, float]:
    """Sizes [m] from `points` spacings (and the instrument's resolution) to `share` of the side, or as given.

    Where that is less than a factor of 3, up to a third of the side.
    """
    if limits is not None:
        return limits
    low = max(points * max(steps_of(ready.scan)), ready.scan.instrument.resolution or 0.0)
    side = min(sides_of(ready.scan))
    # a scan of a hundred points or so: larger sizes than are good rather than none
    return low, max(share * side, min(3.2 * low, side / 3))
