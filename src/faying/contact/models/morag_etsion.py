"""Morag and Etsion 2007: asperities of a fixed wavelength, which yield as load grows."""

from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.asperity.lin_lin import LinLin
from faying.contact.law import ContactLaw, Response, checked, require
from faying.contact.measured_range import MeasuredRange
from faying.contact.models.islands import Islands, covering
from faying.contact.parameter import FRACTAL_MB, Parameter
from faying.materials import ContactPair


@final
@dataclass(frozen=True, kw_only=True)
class MoragEtsion(ContactLaw):
    """A cap keeps the radius of its wavelength while its contact grows from elastic to plastic.

    doi:10.1115/WTC2005-64357 gives one asperity: R = l^d/(pi^2 G^(d-1)), d = D - 1, and the critical contact area
    a_c = (1/pi) (K H/(2 E*))^2 (l^d/G^(d-1))^2; where a_c exceeds the base area l^2 it never yields. Here it is summed
    (our step) over Mandelbrot's islands a' = 2 pi R delta below a largest one al', with Lin and Lin's law beyond yield.

    D, G [m] in the convention of Majumdar and Bhushan; wavelength l [m]; pair; scan_area A0 [m2]. Closure variable: al'
    [m2], valid up to the base area l^2. No tangential stiffness or loss. k_n sums dF/d(delta) of the islands above
    1/100 of the largest, as in JK. Raises InputError for values out of range.
    """

    D: float
    G: float
    wavelength: float
    pair: ContactPair
    scan_area: float

    name: ClassVar[str] = "ME"
    measured_ranges: ClassVar = {"ME": MeasuredRange(hard=0.2, soft=0.16, factor=4.4)}
    source: ClassVar[str] = "doi:10.1115/WTC2005-64357"
    validity: ClassVar[str] = "real area up to 0.3, largest contact within its wavelength, 2.1 <= D <= 2.9"
    parameters: ClassVar = {
        **FRACTAL_MB,
        "wavelength": Parameter("m", "wavelength of the asperities", 0, surface="side"),
    }
    CUTOFF: ClassVar[float] = 0.01

    def __post_init__(self) -> None:
        super().__post_init__()
        require(
            "ME", np.isfinite(self.pair.hardness), "neither body yields; give the pair a hardness or yield_strength"
        )

    @property
    def R(self) -> float:
        """Radius of the asperities [m]."""
        return float(self.wavelength ** (self.D - 1) / (pi**2 * self.G ** (self.D - 2)))

    @property
    def critical_area(self) -> float:
        """Contact area a_c at which an asperity of this wavelength yields [m2]; above the base area it never does."""
        return pi * self.R * self._law.critical

    @cached_property
    def _law(self) -> LinLin:
        return LinLin(R=self.R, pair=self.pair)

    @cached_property
    def _islands(self) -> Islands:
        return Islands(self.D, 1.0)

    @cached_property
    def closure_range(self) -> tuple[float, float]:
        """al' from next to nothing to where the real area reaches the nominal one [m2]."""
        top = covering(lambda al: self._totals(al)[1], self.scan_area)
        return top * 1e-30, top

    def _totals(self, al: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Force, area and stiffness over all islands, SI."""
        c = self._law.critical
        scale = al / (2 * pi * self.R * c)  # delta over critical of the largest island; proportional to a'
        force, area, k_n = np.zeros_like(al), np.zeros_like(al), np.zeros_like(al)
        lower = np.zeros_like(al)
        for piece in self._law.pieces:
            upper = np.minimum(piece.upper / scale, 1.0)
            for coefficient, n in piece.P:
                force = force + coefficient * scale**n * self._islands.total(n, lower, upper)
                stiff = np.maximum(lower, self.CUTOFF)
                k_n = k_n + coefficient * n * scale ** (n - 1) * self._islands.total(n - 1, stiff, upper)
            for coefficient, n in piece.A:
                area = area + coefficient * scale**n * self._islands.total(n, lower, upper)
            lower = upper
        unit = 4 / 3 * self.pair.E_star * self.R**0.5 * c**1.5
        return unit * force, pi * self.R * c * area, unit / c * k_n

    def at_closure(self, al: ArrayLike) -> Response:
        """Return the response at largest truncated areas al' [m2], any shape; InputError unless positive."""
        a = checked(al, name="al'", unit="m2", zero=False)
        force, area, k_n = (v / self.scan_area for v in self._totals(a))
        return Response(
            pressure=np.asarray(force),
            area=np.asarray(area),
            k_n=np.asarray(k_n),
            reasons={
                "real area above 0.3 of the nominal area": np.asarray(area > 0.3),
                "the largest contact exceeds its wavelength": np.asarray(a > self.wavelength**2),
                "D outside 2.1 to 2.9": np.full(a.shape, not 2.1 <= self.D <= 2.9),
            },
        )
