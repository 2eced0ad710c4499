"""Kogut and Etsion 2002: fits to finite elements in two elastic-plastic ranges."""

from dataclasses import dataclass
from math import inf
from typing import ClassVar, final

from faying.contact.asperity.base import HERTZ, Piece, PowerModel


@final
@dataclass(frozen=True, kw_only=True)
class KogutEtsion(PowerModel):
    """Fits for 1 < x < 6 and 6 < x < 110, fully plastic beyond. doi:10.1115/1.1490373.

    The fits do not meet: force jumps by 3 % at x = 1, 1.7 % at 6 and 8 % at 110, area by -7 %, 3 % and 7 %.
    """

    name: ClassVar[str] = "KE"
    source: ClassVar[str] = "doi:10.1115/1.1490373"
    validity: ClassVar[str] = "x up to 110; fitted to elastic, perfectly plastic spheres with nu = 0.3"

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """Four stretches."""
        return (
            HERTZ,
            Piece(6.0, ((1.03, 1.425),), ((0.93, 1.136),)),
            Piece(110.0, ((1.40, 1.263),), ((0.94, 1.146),)),
            Piece(inf, ((3 / self.pair.hardness_coefficient, 1.0),), ((2.0, 1.0),)),
        )
