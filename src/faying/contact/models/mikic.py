"""Mikic 1974: spots that stay elastic, the counterpart of Cooper, Mikic and Yovanovich."""

from dataclasses import dataclass
from math import sqrt
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.law import Response
from faying.contact.measured_range import MeasuredRange
from faying.contact.models.area_fraction import OF_PROFILES, AreaFractionLaw
from faying.materials import ContactPair

POWER = 0.94


@final
@dataclass(frozen=True, kw_only=True)
class Mikic(AreaFractionLaw):
    """k_n = 1.54 E* (m/sigma) (p/H_e)^0.94, A = p/H_e, H_e = E* m/sqrt(2). doi:10.1016/0017-9310(74)90082-9.

    h_rms sigma [m] of both faces together; mean_slope m [-], mean absolute slope of profiles, both faces together;
    pair. H_e is the mean pressure of the spots. The correlation is one of conductance, h = 1.54 K_s (m/sigma)
    (p/H_e)^0.94; k_n = h E*/K_s (Barber 2003, doi:10.1098/rspa.2002.1038). Elastic: loading is unloading, and
    energy_n = p^2/(1.06 k_n), the integral of p dp/k_n. k_t is k_n times Mindlin's ratio 4 G*/E*. No loss.

    Closure variable: the real area fraction, p/H_e. Raises InputError for values that are not positive.
    """

    h_rms: float
    mean_slope: float
    pair: ContactPair

    name: ClassVar[str] = "Mikic"
    measured_ranges: ClassVar = {"Mikic": MeasuredRange(hard=2.6, soft=1.1, factor=3.8)}
    source: ClassVar[str] = "doi:10.1016/0017-9310(74)90082-9"
    validity: ClassVar[str] = "isotropic rough faces, flat, whose spots stay elastic; real area from 1e-6 to 0.023"
    parameters: ClassVar = OF_PROFILES

    def at_closure(self, area: ArrayLike) -> Response:
        """Return the response at real area fractions, any shape; InputError unless above 0 and at most a half."""
        A = self._area(area)
        H = self.pair.E_star * self.mean_slope / sqrt(2)
        p = H * A
        k_n = 1.54 * self.pair.E_star * self.mean_slope / self.h_rms * A**POWER
        reasons = {"real area outside of 1e-6 to 0.023": self._unfitted(A)}
        if any(m.hardness for m in (self.pair.first, self.pair.second)):
            reasons["mean pressure of the contacts above the hardness"] = np.full(A.shape, self.pair.hardness < H)
        return Response(
            pressure=np.asarray(p),
            area=A.copy(),
            k_n=np.asarray(k_n),
            k_t=np.asarray(k_n * 4 * self.pair.G_star / self.pair.E_star),
            energy_n=np.asarray(p**2 / ((2 - POWER) * k_n)),
            reasons=reasons,
        )
