"""D from the detrended fluctuation of the summed profiles."""

from faying.surface.estimators.base import Estimate, Estimator, Limits
from faying.surface.estimators.scaling import size_band, through_parts
from faying.surface.estimators.windows import in_windows
from faying.surface.form import Prepared


def estimate(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Fluctuation of the summed profiles about parabolas, of order q = 2: D = 4 - h(2).

    Source: Kantelhardt et al. 2002, doi:10.1016/S0378-4371(02)01383-3.
    """
    return through_parts(
        ready, c, in_windows(2, True), *size_band(ready, limits, 10, 1 / 4), "the detrended fluctuation"
    )


ESTIMATOR = Estimator(
    name="mfdfa",
    needs="windows from 10 spacings to a quarter of the side",
    bias="within 0.02 in D",
    estimate=estimate,
)
