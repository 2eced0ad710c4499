"""D from the ratio of the spectral moments m2 and m0 over the band, G from m2."""

from math import log

import numpy as np

from faying.errors import NotConverged
from faying.surface.estimators.base import Estimate, Estimator, Limits
from faying.surface.estimators.spectral import clean_band, through_draws
from faying.surface.form import Prepared
from faying.surface.moments import invert_ratio
from faying.typing import Array


def estimate(ready: Prepared, limits: Limits, c: float) -> Estimate:
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


ESTIMATOR = Estimator(
    name="moments",
    needs="a band of a factor 5 in wavelength",
    bias="none seen; its interval is twice as wide as that of psd",
    estimate=estimate,
)
