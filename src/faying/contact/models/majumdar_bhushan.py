"""Majumdar and Bhushan 1991: the first fractal law; small contacts are plastic, large ones elastic."""

from dataclasses import dataclass
from math import pi, sqrt
from typing import ClassVar, final

from faying.contact.models.bearing import BearingLaw


@dataclass(frozen=True, kw_only=True)
class MajumdarBhushanBase(BearingLaw):
    """Asperities of Majumdar and Bhushan, profile dimension d = D - 1, over any island distribution."""

    @property
    def critical_area(self) -> float:
        """a_c = G^2/(H/(2 E*))^(2/(d-1)) [m2], eq. (9)."""
        return float(self.G**2 / (self.pair.hardness / (2 * self.pair.E_star)) ** (2 / (self.D - 2)))

    @property
    def _elastic(self) -> tuple[float, float]:
        d = self.D - 1
        return 4 * sqrt(pi) / 3 * self.pair.E_star * self.G ** (d - 1), (3 - d) / 2  # eq. (11)


@final
@dataclass(frozen=True, kw_only=True)
class MajumdarBhushan(MajumdarBhushanBase):
    """n(a) = (d/2) aL^(d/2) a^-(d/2+1); elastic force (4 sqrt(pi)/3) E* G^(d-1) a^((3-d)/2) for a > a_c, else H a.

    doi:10.1115/1.2920588. Parameters and errors as of `BearingLaw`; G in the convention of Majumdar and Bhushan. At a_c
    an elastic island carries 2 sqrt(pi)/3 = 1.18 times H a_c: the asperity law jumps there, as in the source. The
    elastic area is the whole island, as in the source. d = 1.5 is a case of its own (a logarithm), included.
    """

    name: ClassVar[str] = "MB"
    source: ClassVar[str] = "doi:10.1115/1.2920588"
    validity: ClassVar[str] = "real area up to 0.3, 2.1 <= D <= 2.9; bearing area, no interaction; plastic to elastic"
