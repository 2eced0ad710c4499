"""Zhao, Maietta and Chang 2000: a smooth area and a logarithmic pressure between yield and full plasticity."""

from dataclasses import dataclass
from math import log, pi
from typing import ClassVar, final

import numpy as np

from faying.contact.asperity.base import AsperityCurve, AsperityModel
from faying.typing import Array

YIELD_SHARE = 0.4  # mean pressure at first yield over hardness


@final
@dataclass(frozen=True, kw_only=True)
class ZhaoMaiettaChang(AsperityModel):
    """Elastic to d1, plastic from 54 d1, between them a cubic area and a mean pressure in ln(delta).

    doi:10.1115/1.555332. Here x = delta/d1 with its own d1 = (3 pi k H/(4 E*))^2 R, k = 0.4; force, area and mean
    pressure are continuous.
    """

    name: ClassVar[str] = "ZMC"
    source: ClassVar[str] = "doi:10.1115/1.555332"
    validity: ClassVar[str] = "elastic, perfectly plastic; full plasticity at 54 d1"

    @property
    def critical(self) -> float:
        """d1, interference at which the mean pressure is 0.4 H [m]."""
        return float((3 * pi * YIELD_SHARE * self.pair.hardness / (4 * self.pair.E_star)) ** 2 * self.R)

    @property
    def borders(self) -> tuple[float, ...]:
        """First yield and full plasticity."""
        return 1.0, 54.0

    def curve(self, x: Array) -> AsperityCurve:
        """Return the model without units at x >= 0. P = A p/(k H), since that is 1 at x = 1."""
        k, L = YIELD_SHARE, 54.0 - 1.0
        mid = np.clip(x, 1.0, 54.0)
        u = (mid - 1) / L
        shape, slope = 1 + 3 * u**2 - 2 * u**3, 6 * u * (1 - u) / L
        # mean pressure over k H: 1 at x = 1, 1/k at x = 54
        rate = (1 - k) / (k * log(54.0))
        p = 1 + rate * np.log(mid)
        area = mid * shape
        # integral of p A dx: A as a polynomial in x, each power alone and times ln x
        poly = np.polynomial.Polynomial([-1 / L, 1 / L])
        terms = (np.polynomial.Polynomial([0.0, 1.0]) * (1 + 3 * poly**2 - 2 * poly**3)).coef
        n = np.arange(len(terms)) + 1.0
        power = mid[..., None] ** n
        log_part = power * (np.log(mid)[..., None] / n - 1 / n**2) + 1 / n**2
        middle = ((power - 1) / n + rate * log_part) @ terms
        low, high = np.minimum(x, 1.0), np.maximum(x, 54.0)
        elastic, plastic = x <= 1, x >= 54
        return AsperityCurve(
            P=np.where(elastic, low**1.5, np.where(plastic, 2 * x / k, p * area)),
            A=np.where(elastic, x, np.where(plastic, 2 * x, area)),
            dP=np.where(elastic, 1.5 * low**0.5, np.where(plastic, 2 / k, rate * shape + p * (shape + mid * slope))),
            W=0.4 * low**2.5 + middle + (high**2 - 54.0**2) / k,
        )
