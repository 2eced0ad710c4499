"""What the spectral estimators share: a power law fitted to the spectrum, and its bins drawn anew."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np

from faying.errors import FayingError, NotConverged
from faying.surface.estimators.base import Estimate, Limits, white_rms, with_intervals
from faying.surface.form import Prepared
from faying.surface.heights import AreaHeights, LineHeights
from faying.surface.lines import find_lines
from faying.surface.powerlaw import FittedPowerLaw, fit_band, smearing, supported_band
from faying.surface.spectrum import Spectrum, binned, periodogram, white_shape
from faying.typing import Array


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


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class FittedBand:
    """The bins of a fitted band: frequency, width [1/m], density [m3], the white term's shape, smearing, spread [-]."""

    law: FittedPowerLaw
    frequency: Array
    width: Array
    density: Array
    shape: Array
    smear: Array
    spread: Array
    notes: tuple[str, ...]

    def clean(self, density: Array, noise: float) -> Array:
        """Density [m3] without its white part and the window's smearing."""
        return (density - noise * self.shape) / self.smear

    def drawn(self, rng: np.random.Generator) -> tuple[Array, float]:
        """One draw of the bins about the fitted law, and the white level that the fit would find in it."""
        expected = self.law.expected
        fake = expected * rng.gamma(1 / self.spread**2, self.spread**2)
        return fake, self.law.noise + float(self.law.response[2] @ (fake / expected - 1))


def clean_band(ready: Prepared, limits: Limits) -> FittedBand:
    """Fit the band and keep its bins, to be drawn again from their gamma law."""
    s, law, notes = spectral_fit(ready, limits)
    use = (s.frequency >= law.used[0] * 0.999999) & (s.frequency <= law.used[-1] * 1.000001) & (s.density > 0)
    f = s.frequency[use]
    return FittedBand(
        law=law,
        frequency=f,
        width=s.width[use] * s.lowest,
        density=s.density[use],
        shape=white_shape(f, s.axes),
        smear=smearing(s, f, law.slope)[0],
        spread=s.spread[use] * max(1.0, law.misfit) ** 0.5,
        notes=notes,
    )


def through_draws(
    ready: Prepared, band: FittedBand, c: float, solve: Callable[[Array], tuple[float, float]]
) -> Estimate:
    """Solve for (slope, ln S(pivot)) on the measured bins; bias and covariance from 200 draws of the bins."""
    slope, level = solve(band.clean(band.density, band.law.noise))
    rng = np.random.default_rng(2024)
    draws = []
    for _ in range(200):
        try:
            draws.append(solve(band.clean(*band.drawn(rng))))
        except FayingError:
            continue
    if len(draws) < 150:
        raise NotConverged("the moments of this band do not fix D: most draws within their error have no solution")
    cloud = np.array(draws)
    centre = solve(band.clean(band.law.expected, band.law.noise))
    slope, level = slope - float(cloud[:, 0].mean() - centre[0]), level - float(cloud[:, 1].mean() - centre[1])
    covariance = np.cov(np.stack([cloud[:, 1], -cloud[:, 0] / 2]))
    f = band.frequency
    return with_intervals(
        (7 - slope) / 2,
        level,
        covariance,
        band.law.pivot,
        c,
        band=(1 / float(f[-1]), 1 / float(f[0])),
        noise=white_rms(ready.scan, band.law.noise),
        misfit=band.law.misfit,
        notes=band.notes,
    )
