"""D from counting the boxes that the surface meets."""

from dataclasses import replace
from math import log

import numpy as np

from faying.surface.convention import structure_coefficient
from faying.surface.estimators.base import Estimate, Estimator, Limits
from faying.surface.estimators.scaling import (
    cut_log,
    inside,
    rows_of,
    side_of,
    size_band,
    sizes_of,
    straight,
    through_parts,
)
from faying.surface.form import Prepared
from faying.typing import Array, Mask


def estimate(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Boxes that the surface meets (differential box counting of Sarkar and Chaudhuri, doi:10.1109/21.278), N ~ r^-D.

    The box is as high, in units of the range of heights, as it is wide, in units of the side. Counting does not weigh
    the heights, so G is read from the mean square difference over the geometric mean of the sizes. Strongly biased
    towards the middle of 2 .. 3; its own remark says so.
    """

    def local(z: Array, known: Mask, steps: tuple[float, ...], low: float, high: float) -> tuple[float, float]:
        step = max(steps)
        side = side_of(z, steps)
        span = float(np.ptp(z))
        sizes = sizes_of(low, high, step, 10)
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
        slope, _ = straight(np.log(np.array(sizes) * step), np.array(y))
        D = -slope + (1 if z.ndim == 1 else 0)
        gap = sizes_of(low, high, step)[len(sizes_of(low, high, step)) // 2]
        square = np.mean([float(np.mean((lines[:, gap:] - lines[:, :-gap]) ** 2)) for lines, _ in rows_of(z, steps)])
        k = log(2 * structure_coefficient(inside(D))) + cut_log(inside(D), z.ndim == 2)
        return D, log(max(float(square), 1e-300)) - (6 - 2 * D) * log(gap * step) - k

    found = through_parts(ready, c, local, *size_band(ready, limits, 2, 1 / 8), "box counting")
    words = "box counting is known to be off by 0.1 and more in D: quote other methods too, or use --self-test"
    return replace(found, notes=(*found.notes, words))


ESTIMATOR = Estimator(
    name="box",
    needs="boxes from 2 spacings to an eighth of the side",
    bias="-0.1 to -0.4 in D",
    estimate=estimate,
)
