"""A power law fitted to the spectrum of a scan, and the estimate that it makes."""

import numpy as np

from faying.surface.estimators.base import Estimate, Limits, with_intervals
from faying.surface.form import Prepared
from faying.surface.heights import AreaHeights, LineHeights
from faying.surface.lines import find_lines
from faying.surface.powerlaw import FittedPowerLaw, fit_band, supported_band
from faying.surface.spectrum import Spectrum, binned, periodogram


def spectral_fit(ready: Prepared, limits: Limits) -> tuple[Spectrum, FittedPowerLaw, tuple[str, ...]]:
    """Fit a power law to the cleaned spectrum, over `limits` [m] or the band that the data support."""
    s, notes = clean_spectrum(ready.scan)
    if limits is not None:
        law, more = fit_band(s, 1 / limits[1], 1 / limits[0], fixed=True)
    else:
        law, more = fit_band(s, *supported_band(s, resolution=ready.scan.instrument.resolution))
    return s, law, notes + more


def clean_spectrum(scan: AreaHeights | LineHeights) -> tuple[Spectrum, tuple[str, ...]]:
    """Return the spectrum without the sharp peaks of tool marks, and what was left out in words."""
    power, frequency, axes = periodogram(scan)
    if isinstance(scan, LineHeights):
        return binned(scan, power, frequency, axes), ()
    marked = find_lines(scan, power, frequency)
    share = float(power[marked].sum() / power.sum())
    if share < 1e-4:
        return binned(scan, power, frequency, axes), ()
    words = f"tool marks: {100 * share:.2g} % of the power is in sharp peaks of the spectrum; D and G exclude it"
    return binned(scan, power, frequency, axes, exclude=marked), (words,)


def of_law(law: FittedPowerLaw, c: float, **rest: object) -> Estimate:
    """The estimate that a fitted power law makes, D = (7 - slope)/2."""
    turn = np.array([[1.0, 0.0], [0.0, -0.5]])
    covariance = turn @ law.covariance[:2, :2] @ turn.T
    band = 1 / float(law.used[-1]), 1 / float(law.used[0])
    D = (7 - law.slope) / 2
    return with_intervals(D, law.log_level, covariance, law.pivot, c, band=band, misfit=law.misfit, **rest)
