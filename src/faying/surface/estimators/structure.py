"""D from the structure function."""

from math import log

import numpy as np

from faying.errors import NotConverged
from faying.surface.convention import structure_coefficient
from faying.surface.estimators.base import Estimate, Estimator, Limits
from faying.surface.estimators.scaling import cut_log, inside, side_of, size_band, straight, through_parts
from faying.surface.form import Prepared
from faying.surface.heights import AreaHeights, LineHeights
from faying.surface.spectrum import structure_function
from faying.typing import Array, Mask


def estimate(ready: Prepared, limits: Limits, c: float) -> Estimate:
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
        slope, intercept = straight(x, y)

        def residual(t: Array) -> Array:
            return np.asarray(np.log(np.maximum(np.exp(t[0] * x) + t[2], 1e-12)) + t[1] - y)

        start = np.array([min(max(slope, 0.05), 1.95), intercept, 0.0])
        found = least_squares(residual, start, bounds=([0.01, -np.inf, -20], [1.999, np.inf, 50])).x
        D = 3 - float(found[0]) / 2
        k = log(2 * structure_coefficient(inside(D))) + cut_log(inside(D), z.ndim == 2)
        return D, float(found[1]) - (6 - 2 * D) * middle - k

    return through_parts(ready, c, local, *size_band(ready, limits, 3, 1 / 16), "the structure function")


ESTIMATOR = Estimator(
    name="structure",
    needs="lags from 3 spacings to a sixteenth of the side",
    bias="up to +0.1 in D below 2.2",
    estimate=estimate,
)
