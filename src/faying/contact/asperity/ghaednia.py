"""Ghaednia, Brake, Berryhill and Jackson 2019: bilinear hardening between Hertz and Jackson-Green."""

from dataclasses import dataclass
from math import exp, sqrt
from typing import ClassVar, final

import numpy as np

from faying.contact.asperity.base import AsperityCurve
from faying.contact.asperity.jackson_green import ELASTIC_END, JacksonGreenBase
from faying.errors import InputError
from faying.typing import Array


@final
@dataclass(frozen=True, kw_only=True)
class Ghaednia(JacksonGreenBase):
    """Jackson-Green (cosine hardness) corrected for the tangent modulus E_t of a bilinear material.

    doi:10.1115/1.4041537. tangent_ratio = E_t/E of the softer body, 0 (perfectly plastic) up to below 1:
    F = Fp + (Fe - Fp) (1 - exp(-3.3 E_t/E)), a = ae + (ap - ae) exp(U), U falling with E_t, of the radii a of the
    contact. Raises InputError outside.
    """

    tangent_ratio: float = 0.02

    name: ClassVar[str] = "Ghaednia"
    source: ClassVar[str] = "doi:10.1115/1.4041537"
    validity: ClassVar[str] = "contact radius below 0.41 R; bilinear hardening"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 <= self.tangent_ratio < 1:
            raise InputError(
                f"Ghaednia: tangent_ratio = {self.tangent_ratio}; it must be 0 up to below 1, such as 0.02"
            )

    def _yielding(self, x: Array) -> AsperityCurve:
        P, A, dP = self._plastic(x, "cosine")
        s = 1 - exp(-3.3 * self.tangent_ratio)
        hertz_work = 0.4 * (x**2.5 - ELASTIC_END**2.5)
        return AsperityCurve(
            P=P + s * (x**1.5 - P),
            A=(x**0.5 + (A**0.5 - x**0.5) * self._radius_share(x)) ** 2,
            dP=dP + s * (1.5 * x**0.5 - dP),
            W=s * hertz_work + (1 - s) * self._work(x, "cosine"),
        )

    def _radius_share(self, x: Array) -> Array:
        """exp(U), the share of what the perfectly plastic radius is beyond the elastic one."""
        t = self.tangent_ratio
        if t == 0:
            return np.ones_like(x)
        root = sqrt(self.pair.softer.E / self.yield_strength)
        depth = (x - 1) * self.critical / self.R
        U = -2 * root * t ** (1 - depth) / ((4 - 3 * exp(-2 * root * t)) * (1 - t))
        return np.asarray(np.exp(U))
