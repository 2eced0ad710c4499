"""Power law with a white term fitted to the spectrum averaged over directions: the recommended estimator."""

from faying.surface.estimators.base import Estimate, Estimator, Limits, white_rms, with_intervals
from faying.surface.estimators.spectral import spectral_fit
from faying.surface.form import Prepared
from faying.surface.powerlaw import estimate_from


def estimate(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Fit a power law with a white term to the spectrum averaged over directions (see `powerlaw`)."""
    _, law, notes = spectral_fit(ready, limits)
    return with_intervals(
        *estimate_from(law),
        law.pivot,
        c,
        band=(1 / float(law.used[-1]), 1 / float(law.used[0])),
        noise=white_rms(ready.scan, law.noise),
        misfit=law.misfit,
        notes=notes,
    )


ESTIMATOR = Estimator(
    name="psd",
    needs="a band of a factor 5 in wavelength",
    bias="none seen",
    estimate=estimate,
)
