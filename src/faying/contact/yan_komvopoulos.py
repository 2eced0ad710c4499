"""Yan and Komvopoulos 1998: the fractal law of a surface in three dimensions."""

from dataclasses import dataclass
from functools import partial
from math import inf, log, pi, sqrt
from typing import ClassVar, final

from faying.contact.bearing import PARAMETERS, BearingLaw
from faying.contact.inputs import SurfaceInputs
from faying.contact.law import Parameter, require
from faying.materials import ContactPair


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
    ground: ClassVar[str] = "real area up to 0.3, 2.1 <= D <= 2.9; bearing area, no interaction; plastic to elastic"
    parameters: ClassVar = PARAMETERS | {"gamma": Parameter("", "frequency index of the surface", "above 1")}
    elastic_share: ClassVar[float] = 0.5

    def __post_init__(self) -> None:
        super().__post_init__()
        need = partial(require, self.name)
        need(1 < self.gamma < inf, f"gamma = {self.gamma}; it must be above 1, for example 1.5")

    @classmethod
    def from_surface(cls, surface: SurfaceInputs, pair: ContactPair) -> "YanKomvopoulos":
        """Return the law of a measured surface, from its D and G."""
        return cls(D=surface.D, G=surface.G, pair=pair, scan_area=surface.scan_area, gamma=surface.gamma)

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
