"""D and G by the network of Jiang et al. (see `faying.surface.fpenn`) from a series made of the band's power."""

from math import log, pi

import numpy as np

from faying.errors import NotConverged
from faying.surface import fpenn
from faying.surface.estimators.base import Estimate, Estimator, Limits
from faying.surface.estimators.spectral import clean_band, through_draws
from faying.surface.form import Prepared
from faying.typing import Array


def estimate(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Gather the band's power into a Weierstrass-Mandelbrot series (gamma 1.5) and ask the network for D and G.

    Each frequency of the series takes the power within a factor 1.5^(1/2) of it. The interval holds the scatter of the
    bins and the network's rms error.
    """
    band = clean_band(ready, limits)
    ends = np.concatenate([band.frequency - band.width / 2, [band.frequency[-1] + band.width[-1] / 2]])
    terms = int(log(float(ends[-1] / ends[0])) / log(fpenn.GAMMA))
    known = fpenn.trained_range()
    if terms < known.terms[0]:
        raise NotConverged(f"the band holds {terms} frequencies of a series; the network needs {known.terms[0]}")
    edges = ends[-1] * fpenn.GAMMA ** np.arange(-terms, 1.0)
    centres = edges[1:] * fpenn.GAMMA**-0.5
    length = 1 / float(centres[0])
    pivot = band.law.pivot
    tilt = 1 - band.law.slope

    def turned(f: Array) -> Array:
        """The coordinate in which the power of the fitted law grows evenly."""
        return np.log(f) if abs(tilt) < 1e-3 else np.asarray((f / pivot) ** tilt / tilt)

    def solve(clean: Array) -> tuple[float, float]:
        summed = np.concatenate([[0.0], np.cumsum(clean * band.width)])
        power = np.diff(np.interp(turned(edges), turned(ends), summed))
        m0, m2, m4 = (float(np.sum(power * (2 * pi * centres) ** (2 * k))) for k in range(3))
        if min(m0, m2, m4) <= 0:
            raise NotConverged("the spectral moments of the band are not positive once the noise is taken out")
        D, G = fpenn.from_series_moments(m0, m2, m4, length=length, terms=terms)
        slope = 7 - 2 * D
        if not (2.01 < D < 2.99 and G > 0):
            raise NotConverged(f"the network finds D = {D:.3f}, outside the range it was trained for")
        # a term holds B f^(1-slope) times the integral of u^-slope over a factor gamma, not times ln(gamma)
        e = (1 - slope) * log(fpenn.GAMMA) / 2
        level = (2 * D - 4) * log(G) - log(2) - log(float(np.sinh(e) / e))
        return slope, level - slope * log(pivot)

    return through_draws(ready, band, c, solve, known.rms_D)


ESTIMATOR = Estimator(
    name="fpenn",
    needs="a band that holds as many frequencies of a series as the network was trained for",
    bias="none seen",
    estimate=estimate,
)
