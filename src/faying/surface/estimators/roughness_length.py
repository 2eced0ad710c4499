"""D from the rms residual in windows of growing length."""

from faying.surface.estimators.base import Estimate, Estimator, Limits
from faying.surface.estimators.scaling import size_band, through_parts
from faying.surface.estimators.windows import in_windows
from faying.surface.form import Prepared


def estimate(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Rms residual about a straight line in windows of w along x and y: Rq ~ w^(3-D).

    Source: Malinverno 1990, doi:10.1029/GL017i011p01953.
    """
    return through_parts(ready, c, in_windows(1, False), *size_band(ready, limits, 10, 1 / 4), "the roughness length")


ESTIMATOR = Estimator(
    name="roughness-length",
    needs="windows from 10 spacings to a quarter of the side",
    bias="-0.05 to -0.1 in D above 2.4",
    estimate=estimate,
)
