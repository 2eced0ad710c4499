"""Hertz 1882: the elastic sphere."""

from dataclasses import dataclass
from math import inf
from typing import ClassVar, final

from faying.contact.asperity.base import HERTZ, Piece, PowerModel


@final
@dataclass(frozen=True, kw_only=True)
class Hertz(PowerModel):
    """Elastic: P = x^1.5, A = x. doi:10.1515/crll.1882.92.156."""

    name: ClassVar[str] = "Hertz"
    source: ClassVar[str] = "doi:10.1515/crll.1882.92.156"
    validity: ClassVar[str] = "elastic, contact radius small against R"

    @property
    def critical(self) -> float:
        """Interference at which yield begins [m]; for a pair that never yields R itself, a scale without meaning."""
        try:
            return super().critical
        except ValueError:
            return self.R

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """One stretch."""
        return (HERTZ._replace(upper=inf),)
