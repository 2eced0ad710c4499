"""Chang, Etsion and Bogy 1987: volume conserved beyond yield."""

from dataclasses import dataclass
from math import inf
from typing import ClassVar, final

from faying.contact.asperity.base import HERTZ, Piece, PowerModel


@final
@dataclass(frozen=True, kw_only=True)
class ChangEtsionBogy(PowerModel):
    """Hertz up to yield, then a = pi R (2 delta - c) at the mean pressure K H. doi:10.1115/1.3261348.

    With P in units of (2/3) K H pi R c: A = 2x - 1, P = (3/2) A. Force jumps by half at x = 1.
    """

    name: ClassVar[str] = "CEB"
    source: ClassVar[str] = "doi:10.1115/1.3261348"
    validity: ClassVar[str] = "near yield; no elastic-plastic range, mean pressure stays at K H"

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """Two stretches."""
        return HERTZ, Piece(inf, ((3.0, 1.0), (-1.5, 0.0)), ((2.0, 1.0), (-1.0, 0.0)))
