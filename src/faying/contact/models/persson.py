"""Persson 2001, 2007: area from the rms slope, stiffness from the rms height."""

from dataclasses import dataclass
from math import sqrt
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.law import ContactLaw, Response
from faying.contact.measured_range import MeasuredRange
from faying.contact.parameter import Parameter
from faying.errors import InputError
from faying.materials import ContactPair

MIN_AREA, MAX_AREA = 1e-12, 1 - 1e-7


@final
@dataclass(frozen=True, kw_only=True)
class Persson(ContactLaw):
    """A/A0 = erf(p/sqrt(2 V)), V = E*^2 slope^2/4; k_n = p/(gamma h_rms). doi:10.1063/1.1388626.

    slope, rms gradient [-]; h_rms, rms height [m]; pair; corrected multiplies V by 0.42 + 0.58 A (Dapp, Prodanov and
    Mueser 2014, doi:10.1088/0953-8984/26/35/355002), which brings the area at small loads from sqrt(8/pi) p/(E* slope)
    near the 2 to 2.5 of full solutions; gamma, 0.4 to 0.5, of doi:10.1103/PhysRevLett.99.125502. k_t is k_n times
    Mindlin's ratio 4 G*/E* (doi:10.1088/0953-8984/23/8/085001). energy_n = gamma h_rms p, elastic. No loss.

    Closure variable: the real area fraction, 0 to 1. The stiffness is that of a large surface: on a small one, at low
    load, k_n grows as p^(1/(1+Hurst)) instead. Raises InputError for values that are not positive.
    """

    slope: float
    h_rms: float
    pair: ContactPair
    corrected: bool = True
    gamma: float = 0.45

    name: ClassVar[str] = "Persson"
    measured_ranges: ClassVar = {"Persson": MeasuredRange(hard=4.1, soft=1.6, factor=3.9)}
    source: ClassVar[str] = "doi:10.1063/1.1388626"
    validity: ClassVar[str] = "elastic; real area up to 0.3 for the stiffness; a surface much larger than its waves"
    parameters: ClassVar = {
        "slope": Parameter("", "rms gradient of the surface", 0, surface="slope"),
        "h_rms": Parameter("m", "rms height", 0, surface="h_rms"),
        "corrected": Parameter("", "use the area-dependent correction, 1 or 0", 0, 1, "[]", whole=True),
        "gamma": Parameter("", "factor of the mean separation, 0.4 to 0.5", 0),
    }

    @property
    def closure_range(self) -> tuple[float, float]:
        """Area fractions at the least and the greatest load."""
        return MIN_AREA, MAX_AREA

    def at_closure(self, area: ArrayLike) -> Response:
        """Return the response at real area fractions, any shape; InputError unless above 0 and below 1."""
        from scipy.special import erfinv

        A = np.asarray(area, float)
        if not np.all((A > 0) & (A < 1)):
            raise InputError("Persson: the real area fraction is between 0 and 1")
        spread = self.pair.E_star * self.slope / 2 * np.sqrt(0.42 + 0.58 * A if self.corrected else np.ones_like(A))
        p = sqrt(2) * spread * erfinv(A)
        k_n = p / (self.gamma * self.h_rms)
        reasons = {"real area above 0.3 of the nominal area": np.asarray(A > 0.3)}
        if any(m.hardness for m in (self.pair.first, self.pair.second)):
            reasons["mean pressure of the contacts above the hardness"] = np.asarray(p > self.pair.hardness * A)
        return Response(
            pressure=np.asarray(p),
            area=A.copy(),
            k_n=np.asarray(k_n),
            k_t=np.asarray(k_n * 4 * self.pair.G_star / self.pair.E_star),
            energy_n=np.asarray(self.gamma * self.h_rms * p),
            reasons=reasons,
        )
