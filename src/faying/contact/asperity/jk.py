"""The JK asperity of Zhang, Wu, Liu and Jiang 2024: Lin and Lin's law on a cap that rests on a compliant substrate."""

from dataclasses import dataclass, replace
from math import inf, sqrt
from typing import ClassVar, Literal, final

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.asperity.base import AsperityResponse, Piece, PowerModel, work
from faying.contact.law import checked
from faying.contact.models.jk import asperity_regimes
from faying.contact.substrate import asperity_share
from faying.errors import InputError
from faying.typing import Array


@final
@dataclass(frozen=True, kw_only=True)
class JK(PowerModel):
    """Powers 1.38 and 1.16 between yield and 76.8 c ("printed") or those of Lin and Lin ("consistent").

    doi:10.3390/fractalfract8100611, eqs. (1), (7)-(20). With `height` h_a [m] the interference is shared with the
    substrate by eq. (1), delta = delta_a (1 + Er xi sqrt(delta_a)) with xi sqrt(h_a) = coefficient/sqrt(2), where
    Er = modulus_ratio and the paper's coefficient is 1.5 (a half-space in series gives 0.67 to 1); energy is then
    the work on both. Without it the asperity takes all. Raises InputError for values that are not positive.
    """

    height: float | None = None
    modulus_ratio: float = 1.0
    coefficient: float = 1.5
    closure: Literal["consistent", "printed"] = "consistent"

    name: ClassVar[str] = "JK"
    source: ClassVar[str] = "doi:10.3390/fractalfract8100611"
    validity: ClassVar[str] = "as LL-2005; the substrate's share from an elastic model"

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("height", "modulus_ratio", "coefficient"):
            value = getattr(self, name)
            if value is not None and not 0 < value < inf:
                raise InputError(f"JK asperity: {name} = {value}; it must be positive")
        if self.closure not in ("consistent", "printed"):
            raise InputError(f'JK asperity: closure = {self.closure!r}; use "consistent" or "printed"')

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """Three stretches, in x = delta_a/c."""
        x_p, regimes = asperity_regimes(self.pair.hardness_coefficient, printed=self.closure == "printed")
        ends = (1.0, x_p, inf)
        return tuple(Piece(end, r.force, r.area) for end, r in zip(ends, regimes, strict=True))

    @property
    def _coupling(self) -> float:
        """Factor q of delta/c = x + q x^1.5."""
        if self.height is None:
            return 0.0
        return self.modulus_ratio * self.coefficient / sqrt(2) * sqrt(self.critical / self.height)

    def share(self, delta: ArrayLike) -> Array:
        """Return lam = delta_a/delta at interferences [m]."""
        d = checked(delta, name="interference", unit="m", zero=True)
        if self.height is None:
            return np.ones_like(d)
        return asperity_share(d / self.height, self.modulus_ratio, self.coefficient / sqrt(2))

    def at(self, delta: ArrayLike) -> AsperityResponse:
        """Return the response at applied interferences [m], any shape; InputError where one is negative."""
        d = checked(delta, name="interference", unit="m", zero=True)
        taken = d * self.share(d)
        own, q, c = super().at(taken), self._coupling, self.critical
        if q == 0:
            return own
        x, energy = taken / c, own.energy
        unit = 4 / 3 * self.pair.E_star * sqrt(self.R) * c**2.5
        # work on the substrate: integral of P d(q x^1.5), each term of P by 1.5 q x^0.5
        for lower, piece in zip((0.0, *self.borders), self.pieces, strict=True):
            soft = piece._replace(P=tuple((1.5 * q * a, n + 0.5) for a, n in piece.P))
            energy = energy + unit * work(soft, lower, x)
        return replace(own, stiffness=own.stiffness / (1 + 1.5 * q * np.sqrt(x)), energy=energy)
