"""D from the length of profiles measured with growing steps."""

from math import log, pi

import numpy as np

from faying.surface.convention import structure_coefficient
from faying.surface.estimators.base import Estimate, Estimator, Limits
from faying.surface.estimators.scaling import (
    cut_log,
    inside,
    mean_law,
    rows_of,
    size_band,
    sizes_of,
    straight,
    through_parts,
)
from faying.surface.form import Prepared
from faying.typing import Array, Mask


def estimate(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Length of the profiles along x and y measured with steps of k points: L ~ k^-Ds (Higuchi, doi:10.1016/
    0167-2789(88)90081-4). G from the mean step, (2/pi)^(1/2) of its rms for Gaussian heights."""

    def local(z: Array, known: Mask, steps: tuple[float, ...], low: float, high: float) -> tuple[float, float]:
        found = []
        marks = rows_of(known.astype(float), steps)
        for (lines, step), (mark, _) in zip(rows_of(z, steps), marks, strict=True):
            sizes = sizes_of(low, high, step)
            x = np.log(np.array(sizes) * step)
            y = []
            for k in sizes:
                both = mark[:, k:] * mark[:, :-k]
                y.append(log(max(float(np.sum(np.abs(lines[:, k:] - lines[:, :-k]) * both) / both.sum()), 1e-300)))
            # the length is N k^-2 sum |step|, so its slope -Ds is that of the mean step less 2
            slope, intercept = straight(x, np.array(y))
            D = 3 - slope
            level = 2 * intercept + log(pi / 2) - log(2 * structure_coefficient(inside(D)))
            found.append((D, level - cut_log(inside(D), z.ndim == 2)))
        return mean_law(found, low, high)

    return through_parts(ready, c, local, *size_band(ready, limits, 2, 1 / 16), "Higuchi's length")


ESTIMATOR = Estimator(
    name="higuchi",
    needs="Gaussian heights (for G); steps from 2 spacings to a sixteenth of the side",
    bias="+0.08 in D at 2.1, -0.06 at 2.7",
    estimate=estimate,
)
