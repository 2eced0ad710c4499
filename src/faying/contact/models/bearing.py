"""What the fractal laws of the bearing-area kind share: islands of truncated area, each fully deformed."""

from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.law import ContactLaw, Response, checked, require
from faying.contact.models.islands import Islands
from faying.contact.parameter import FRACTAL_MB
from faying.materials import ContactPair
from faying.typing import Array


@dataclass(frozen=True, kw_only=True)
class BearingLaw(ContactLaw):
    """D, G [m], pair and scan_area A0 [m2]; closure variable the area al [m2] of the largest island.

    A model gives the area of the critical island, below which islands are plastic, and the elastic force of an island
    as coefficient times power of its area. No stiffness, energy or loss: the sources define none. Raises InputError
    for D outside 2 to 3, lengths that are not positive, and a pair without hardness.
    """

    D: float
    G: float
    pair: ContactPair
    scan_area: float

    parameters: ClassVar = FRACTAL_MB
    # real area of an elastic island over its truncated area
    elastic_share: ClassVar[float] = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        require(self.name, np.isfinite(self.pair.hardness), "neither body yields; give a hardness or yield_strength")

    @cached_property
    def _islands(self) -> Islands:
        return Islands(self.D, 1.0)

    @property
    @abstractmethod
    def critical_area(self) -> float:
        """Area of the island at the border [m2]: smaller ones are plastic, larger ones elastic."""

    @property
    @abstractmethod
    def _elastic(self) -> tuple[float, float]:
        """Coefficient and power of the elastic force in the area of the island."""

    @cached_property
    def closure_range(self) -> tuple[float, float]:
        """al from next to nothing to where the islands cover the nominal area [m2]."""
        top = self.scan_area / float(self._islands.total(1.0, 0.0, 1.0))
        return top * 1e-30, top

    def at_closure(self, al: ArrayLike) -> Response:
        """Return the response at areas al of the largest island [m2], any shape; InputError unless positive."""
        a: Array = checked(al, name="al", unit="m2", zero=False)
        border = np.minimum(self.critical_area / a, 1.0)
        coefficient, power = self._elastic
        elastic_area = a * self._islands.total(1.0, border, 1.0)
        plastic_area = a * self._islands.total(1.0, 0.0, border)
        force = coefficient * a**power * self._islands.total(power, border, 1.0) + self.pair.hardness * plastic_area
        area = (self.elastic_share * elastic_area + plastic_area) / self.scan_area
        return Response(
            pressure=np.asarray(force / self.scan_area),
            area=np.asarray(area),
            reasons={
                "real area above 0.3 of the nominal area": np.asarray(area > 0.3),
                "D outside 2.1 to 2.9": np.full(a.shape, not 2.1 <= self.D <= 2.9),
            },
        )
