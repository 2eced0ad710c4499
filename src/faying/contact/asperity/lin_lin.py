"""Lin and Lin 2005: powers fixed by the two ends of the elastic-plastic range."""

from dataclasses import dataclass
from math import inf, log
from typing import ClassVar, final

from faying.contact.asperity.base import HERTZ, Piece, PowerModel


@final
@dataclass(frozen=True, kw_only=True)
class LinLin(PowerModel):
    """P = x^(ln 400/ln x_p), A = x^(1 + ln 2/ln x_p) up to x_p = 400 K/3, then plastic. doi:10.1115/1.1843830.

    Both ends of the range fix both powers, so that force and area are continuous for any Poisson's ratio.
    """

    name: ClassVar[str] = "LL-2005"
    source: ClassVar[str] = "doi:10.1115/1.1843830"
    validity: ClassVar[str] = "elastic, perfectly plastic; full plasticity at 400 times the load of first yield"

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """Three stretches."""
        K = self.pair.hardness_coefficient
        x_p = 400 * K / 3
        return (
            HERTZ,
            Piece(x_p, ((1.0, log(400) / log(x_p)),), ((1.0, 1 + log(2) / log(x_p)),)),
            Piece(inf, ((3 / K, 1.0),), ((2.0, 1.0),)),
        )
