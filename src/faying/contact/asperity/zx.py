"""The ZX model as the JK paper describes it: Lin and Lin's law with a radius that follows the truncated area."""

from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.asperity.base import AsperityCurve, AsperityModel, AsperityResponse
from faying.contact.asperity.lin_lin import LinLin
from faying.contact.law import checked
from faying.errors import InputError
from faying.typing import Array


@final
@dataclass(frozen=True, kw_only=True)
class ZX(AsperityModel):
    """Reconstructed: the printed form was not found. doi:10.3390/fractalfract8100611, section 2.4, describes it.

    In the traditional fractal models every asperity is deformed by its whole height, so both its interference and
    its radius follow its area: delta ~ a'^((3-D)/2), R ~ a'^((D-1)/2), hence R(delta) = R (delta/height)^((D-1)/(3-D)).
    R [m] is the radius at delta = height [m]. Lin and Lin's law with that radius gives the contact paradox: small
    contacts are plastic and become elastic as they grow. The jumps that the paper shows for it do not follow from
    this description: Lin and Lin's law has none. Raises InputError for D outside 2 to 3 or a height not positive.
    """

    D: float
    height: float

    name: ClassVar[str] = "ZX (reconstructed)"
    source: ClassVar[str] = "doi:10.3390/fractalfract8100611"
    validity: ClassVar[str] = "none known: it goes from plastic to elastic as load grows"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 2 < self.D < 3:
            raise InputError(f"ZX: D = {self.D}; the dimension of a surface is between 2 and 3, for example 2.4")
        if not 0 < self.height < np.inf:
            raise InputError(f"ZX: height = {self.height:.6g} m; it must be positive, for example 1e-7")

    @property
    def _power(self) -> float:
        """Power of R in delta."""
        return (self.D - 1) / (3 - self.D)

    @property
    def _law(self) -> LinLin:
        return LinLin(R=self.R, pair=self.pair)

    @property
    def borders(self) -> tuple[float, ...]:
        """Borders of Lin and Lin's law."""
        return self._law.borders

    def curve(self, x: Array) -> AsperityCurve:
        """Lin and Lin's curve; x counts the critical interference at the present radius."""
        return self._law.curve(x)

    def at(self, delta: ArrayLike) -> AsperityResponse:
        """Return the response at interferences [m], any shape; InputError where one is negative or zero."""
        d = checked(delta, name="interference", unit="m", zero=False)
        b = self._power
        radius = self.R * (d / self.height) ** b
        strain = self.critical / self.R
        c = strain * radius
        P, A, dP, _ = self.curve(d / c)
        unit = 4 / 3 * self.pair.E_star * strain**1.5 * radius**2
        force, area = unit * P, np.pi * radius * c * A
        # x ~ delta^(1-b) falls, so that integration from 0 runs through the pieces from the last to the first
        energy, lower = np.zeros_like(d), np.zeros_like(d)
        scale = self.height**b / (strain * self.R)  # x = scale delta^(1-b)
        ends = [(end / scale) ** (1 / (1 - b)) for end in self.borders]
        for piece, end in zip(reversed(self._law.pieces), [*reversed(ends), np.inf], strict=True):
            upper = np.clip(d, lower, end)
            for coefficient, n in piece.P:
                e = 2 * b + n * (1 - b) + 1
                factor = 4 / 3 * self.pair.E_star * strain**1.5 * self.R**2 / self.height ** (2 * b)
                energy = energy + coefficient * factor * scale**n * (upper**e - lower**e) / e
            lower = upper
        return AsperityResponse(
            force=np.asarray(force),
            area=np.asarray(area),
            pressure=np.asarray(force / area),
            stiffness=np.asarray(2 * b * force / d + unit / c * dP * (1 - b)),
            energy=energy,
        )
