"""Yan and Komvopoulos 1998: the fractal law of a surface in three dimensions."""

from dataclasses import dataclass
from math import log, pi, sqrt
from typing import ClassVar, final

from faying.contact.models.bearing import BearingLaw
from faying.contact.parameter import FRACTAL, GAMMA


@final
@dataclass(frozen=True, kw_only=True)
class YanKomvopoulos(BearingLaw):
    """Each island is a cap deformed by its full height, elastic above a critical area. doi:10.1063/1.368536.

    delta = 2^(4-D) G^(D-2) sqrt(ln gamma) pi^((D-3)/2) a'^((3-D)/2), R = a'/(2 pi delta), Hertz above a_c', hardness
    below; at a_c' both carry H a'. The real area is half the truncated one where elastic, all of it where plastic.
    Parameters and errors as of `BearingLaw`, and gamma above 1. D = 2.5 is a case of its own (a logarithm), included.
    """

    gamma: float = 1.5

    name: ClassVar[str] = "YK"
    source: ClassVar[str] = "doi:10.1063/1.368536"
    validity: ClassVar[str] = "real area up to 0.3, 2.1 <= D <= 2.9; bearing area, no interaction; plastic to elastic"
    parameters: ClassVar = FRACTAL | GAMMA
    elastic_share: ClassVar[float] = 0.5

    @property
    def critical_area(self) -> float:
        """a_c' [m2], where the Hertz force reaches H a'."""
        coefficient, power = self._elastic
        return float((coefficient / self.pair.hardness) ** (1 / (1 - power)))

    @property
    def _elastic(self) -> tuple[float, float]:
        D = self.D
        c = 2 ** ((11 - 2 * D) / 2) / (3 * pi ** ((4 - D) / 2)) * sqrt(log(self.gamma)) * self.G ** (D - 2)
        return c * self.pair.E_star, (4 - D) / 2
