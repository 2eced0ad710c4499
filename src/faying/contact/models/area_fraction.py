"""What the two correlations of contact conductance share: their closure variable is the real area fraction."""

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.law import ContactLaw, require
from faying.contact.parameter import Parameter
from faying.typing import Array, Mask

MIN_AREA, MAX_AREA = 1e-12, 0.5  # area: from 7 rms heights between the mean planes to none
FITTED = (1e-6, 2.3e-2)  # of the area, within which a power stands for the integrals that it was fitted to

OF_PROFILES = {
    "h_rms": Parameter("m", "rms height sigma, both faces together", 0, surface="h_rms"),
    "mean_slope": Parameter("", "mean absolute slope m of profiles, both faces together", 0, surface="mean_slope"),
}


class AreaFractionLaw(ContactLaw):
    """A law over the real area fraction of Gaussian heights, which lies above 0 and at most at a half."""

    @property
    def closure_range(self) -> tuple[float, float]:
        """Area fractions at the least and the greatest load."""
        return MIN_AREA, MAX_AREA

    def _area(self, area: ArrayLike) -> Array:
        """Area fractions as floats; InputError unless above 0 and at most a half."""
        A = np.asarray(area, float)
        good = bool(np.all((A > 0) & (A <= MAX_AREA * (1 + 1e-9))))
        require(self.name, good, "the real area fraction is above 0, up to 0.5")
        return A

    @staticmethod
    def _unfitted(area: Array) -> Mask:
        """Where the power was not fitted."""
        return np.asarray((FITTED[0] > area) | (FITTED[1] < area))
