"""Power law with a white term fitted to the spectrum averaged over directions: the recommended estimator."""

from faying.surface.estimators.base import Estimate, Estimator, Limits, white_rms
from faying.surface.estimators.spectral import of_law, spectral_fit
from faying.surface.form import Prepared


def estimate(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Fit a power law with a white term to the spectrum averaged over directions (see `powerlaw`)."""
    _, law, notes = spectral_fit(ready, limits)
    return of_law(law, c, noise=white_rms(ready.scan, law.noise), notes=notes)


ESTIMATOR = Estimator(
    name="psd",
    needs="a band of a factor 5 in wavelength",
    bias="none seen",
    estimate=estimate,
)
