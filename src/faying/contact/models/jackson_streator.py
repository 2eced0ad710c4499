"""Jackson and Streator 2006: sinusoids stacked on sinusoids, each carrying the pressure of the contacts above it."""

from dataclasses import dataclass
from functools import cached_property
from math import log, pi, sqrt
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.law import ContactLaw, Response, checked, require
from faying.contact.parameter import FRACTAL, GAMMA, Parameter
from faying.materials import ContactPair
from faying.typing import Array


def sinusoid_area(load: ArrayLike) -> Array:
    """Return the contact fraction of one elastic sinusoidal layer at load = p/p* [-], 1 from p* on.

    Johnson, Greenwood and Higginson's two limits, doi:10.1016/0020-7403(85)90029-3, joined by Jackson and Streator:
    per period 1/f^2, A1 f^2 = pi [(3/(8 pi)) load]^(2/3), A2 f^2 = 1 - (3/(2 pi)) (1 - load), and below 0.8 of p*
    A = A1 (1 - [1.25 load]^1.51) + A2 (1.25 load)^1.04.
    """
    x = np.minimum(np.asarray(load, float), 1.0)
    low = pi * (3 / (8 * pi) * x) ** (2 / 3)
    high = 1 - 3 / (2 * pi) * (1 - x)
    joined = low * (1 - np.minimum(1.25 * x, 1.0) ** 1.51) + high * (1.25 * x) ** 1.04
    return np.asarray(np.where(x < 0.8, joined, high))


@final
@dataclass(frozen=True, kw_only=True)
class JacksonStreator(ContactLaw):
    """Each layer of wavelength l and amplitude a flattens at p* = sqrt2 pi E* a/l; areas multiply over the layers.

    doi:10.1016/j.wear.2006.03.015. Layers: l_n = sqrt(scan_area)/gamma^n down to the shortest wavelength, amplitudes
    from D and G [m] in the convention of Yan and Komvopoulos: a cosine product of amplitude a has the variance of
    the series term, a^2/4 = G^(2D-4) ln(gamma) l^(6-2D)/2. The answer depends on `shortest` [m]: real area falls
    as finer waves are taken in. Elastic; no stiffness or loss, since the source defines none.

    Closure variable: the nominal pressure itself [Pa]. Raises InputError for values out of range.
    """

    D: float
    G: float
    shortest: float
    pair: ContactPair
    scan_area: float
    gamma: float = 1.5

    name: ClassVar[str] = "JS"
    source: ClassVar[str] = "doi:10.1016/j.wear.2006.03.015"
    validity: ClassVar[str] = "real area up to 0.3; elastic; depends on the shortest wavelength taken in"
    parameters: ClassVar = {
        **FRACTAL,
        "shortest": Parameter("m", "shortest wavelength", 0, surface="shortest"),
        **GAMMA,
    }

    def __post_init__(self) -> None:
        super().__post_init__()
        side = sqrt(self.scan_area)
        require("JS", self.shortest < side, f"shortest = {self.shortest:.6g} m; it must be below {side:.4g} m")

    @cached_property
    def layers(self) -> tuple[Array, Array]:
        """Wavelengths and amplitudes [m], the longest first."""
        count = int(log(sqrt(self.scan_area) / self.shortest) / log(self.gamma)) + 1
        length = np.asarray(sqrt(self.scan_area) / self.gamma ** np.arange(count), float)
        variance = self.G ** (2 * self.D - 4) * log(self.gamma) * length ** (6 - 2 * self.D) / 2
        return length, np.asarray(2 * np.sqrt(variance), float)

    @cached_property
    def flattening(self) -> Array:
        """Pressures p* that flatten each layer [Pa]."""
        length, amplitude = self.layers
        return np.asarray(sqrt(2) * pi * self.pair.E_star * amplitude / length)

    @property
    def closure_range(self) -> tuple[float, float]:
        """Pressures between which the law is given [Pa]: up to where the steepest layer is flat."""
        top = float(self.flattening.max())
        return top * 1e-12, top

    def at_closure(self, pressure: ArrayLike) -> Response:
        """Return the response at nominal pressures [Pa], any shape; InputError unless positive."""
        p = checked(pressure, name="pressure", unit="Pa", zero=False)
        area, local = np.ones_like(p), p.copy()
        for flat in self.flattening:
            share = sinusoid_area(local / flat)
            area, local = area * share, local / share
        reasons = {"real area above 0.3 of the nominal area": np.asarray(area > 0.3)}
        if any(m.hardness for m in (self.pair.first, self.pair.second)):
            reasons["mean pressure of the contacts above the hardness"] = np.asarray(local > self.pair.hardness)
        return Response(pressure=p.copy(), area=np.asarray(area), reasons=reasons)
