"""The estimators of D and G: each is a function and an entry of the table."""

from math import log

import numpy as np

from faying.errors import NotConverged
from faying.surface.convention import cut_factor, structure_coefficient
from faying.surface.estimators.base import Estimate, Estimator, Limits, white_rms
from faying.surface.estimators.scaling import side_of, size_band, through_parts
from faying.surface.estimators.spectral import of_law, spectral_fit
from faying.surface.form import Prepared
from faying.surface.heights import AreaHeights, LineHeights
from faying.surface.spectrum import structure_function
from faying.typing import Array, Mask


def by_psd(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Fit a power law with a white term to the spectrum averaged over directions (see `powerlaw`)."""
    _, law, notes = spectral_fit(ready, limits)
    return of_law(law, c, noise=white_rms(ready.scan, law.noise), notes=notes)


def by_structure(ready: Prepared, limits: Limits, c: float) -> Estimate:
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
        slope, intercept = np.polyfit(x, y, 1)

        def residual(t: Array) -> Array:
            return np.asarray(np.log(np.maximum(np.exp(t[0] * x) + t[2], 1e-12)) + t[1] - y)

        start = np.array([min(max(slope, 0.05), 1.95), intercept, 0.0])
        found = least_squares(residual, start, bounds=([0.01, -np.inf, -20], [1.999, np.inf, 50])).x
        D = 3 - float(found[0]) / 2
        at = min(max(D, 2.005), 2.995)  # the open range in which the transfer functions exist
        # of a surface the mean spectrum of its profiles
        k = log(2 * structure_coefficient(at)) + (log(cut_factor(at)) if z.ndim == 2 else 0.0)
        return D, float(found[1]) - (6 - 2 * D) * middle - k

    return through_parts(ready, c, local, size_band(ready, limits, 3, 1 / 16), "the structure function")


BAND = "a band of a factor 5 in wavelength"
ESTIMATORS: dict[str, Estimator] = {
    name: Estimator(name=name, needs=needs, bias=bias, estimate=estimate)
    for name, estimate, needs, bias in (
        ("psd", by_psd, BAND, "none seen"),
        ("structure", by_structure, "lags from 3 spacings to a sixteenth of the side", "up to +0.1 in D below 2.2"),
    )
}
METHODS = tuple(ESTIMATORS)
