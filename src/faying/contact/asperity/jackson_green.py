"""Jackson and Green 2005: fits to finite elements with a hardness that falls as the contact grows."""

from abc import abstractmethod
from dataclasses import dataclass
from math import exp, pi
from typing import ClassVar, Literal, final

import numpy as np

from faying.contact.asperity.base import AsperityCurve, AsperityModel
from faying.errors import InputError
from faying.typing import Array

ELASTIC_END = 1.9


@dataclass(frozen=True, kw_only=True)
class JacksonGreenBase(AsperityModel):
    """What Jackson and Green's model and Ghaednia's share: yield from the yield strength Y, and the plastic curve."""

    @property
    def yield_strength(self) -> float:
        """Y of the softer body [Pa]; its hardness over 2.8 where it has none of its own."""
        return self.pair.softer.yield_strength or self.pair.hardness / 2.8

    @property
    def CY(self) -> float:
        """C Y = 1.295 exp(0.736 nu) Y [Pa]."""
        return 1.295 * exp(0.736 * self.pair.softer.nu) * self.yield_strength

    @property
    def critical(self) -> float:
        """(pi C Y/(2 E*))^2 R [m]."""
        return float((pi * self.CY / (2 * self.pair.E_star)) ** 2 * self.R)

    @property
    def borders(self) -> tuple[float, ...]:
        """End of the Hertz range."""
        return (ELASTIC_END,)

    @abstractmethod
    def _yielding(self, x: Array) -> AsperityCurve:
        """The model at x > 1.9, where it yields; W counted from there."""

    def curve(self, x: Array) -> AsperityCurve:
        """Return the model without units at x >= 0."""
        low, high = np.minimum(x, ELASTIC_END), np.maximum(x, ELASTIC_END)
        elastic, yielding = x <= ELASTIC_END, self._yielding(high)
        return AsperityCurve(
            P=np.where(elastic, low**1.5, yielding.P),
            A=np.where(elastic, low, yielding.A),
            dP=np.where(elastic, 1.5 * low**0.5, yielding.dP),
            W=0.4 * low**2.5 + yielding.W,
        )

    def _plastic(self, x: Array, form: str) -> tuple[Array, Array, Array]:
        """P, A, dP/dx at x > 1.9; form of the hardness: "exponential" (2005) or "cosine" (later)."""
        unit = pi * self.CY / (2 * self.pair.E_star)
        B = 0.14 * exp(23 * self.yield_strength / self.pair.E_star)
        ratio = unit * np.sqrt(x) * (x / ELASTIC_END) ** (B / 2)  # contact radius over R, and its derivative by x
        slope = ratio * (1 + B) / (2 * x)
        if form == "exponential":
            e = np.exp(-0.82 * ratio**-0.7)
            HG, dHG = 2.84 * (1 - e), -2.84 * e * 0.82 * 0.7 * ratio**-1.7 * slope
        else:
            HG, dHG = 2.84 - 0.92 * (1 - np.cos(pi * ratio)), -0.92 * pi * np.sin(pi * ratio) * slope
        h = 4 * self.yield_strength / self.CY
        first = np.exp(-(x ** (5 / 12)) / 4)
        second = np.exp(-(x ** (5 / 9)) / 25)
        P = first * x**1.5 + h * HG * (1 - second) * x
        dP = (
            first * (1.5 * x**0.5 - 5 / 48 * x ** (11 / 12))
            + h * dHG * (1 - second) * x
            + h * HG * ((1 - second) + second * x ** (5 / 9) / 45)
        )
        return P, (ratio / unit) ** 2, dP

    def _work(self, x: Array, form: str) -> Array:
        """Integral of P from 1.9 to x > 1.9 by Gauss-Legendre in ln x, on panels of a factor of 8."""
        t, w = np.polynomial.legendre.leggauss(12)
        length = np.log(x / ELASTIC_END)
        panels = max(1, int(np.ceil(length.max(initial=0.0) / np.log(8))))
        total = np.zeros_like(x)
        for i in range(panels):
            v = ELASTIC_END * np.exp(length[..., None] * (i + (t + 1) / 2) / panels)
            total += (self._plastic(v, form)[0] * v) @ (w / 2)
        return np.asarray(total * length / panels)


@final
@dataclass(frozen=True, kw_only=True)
class JacksonGreen(JacksonGreenBase):
    """Hertz up to x = 1.9, then fits with the hardness HG(a/R). doi:10.1115/1.1866166.

    hardness: "exponential", HG/Y = 2.84 [1 - exp(-0.82 (a/R)^-0.7)], of the 2005 paper, or "cosine",
    HG/Y = 2.84 - 0.92 (1 - cos(pi a/R)), a later form. Force rises by 0.5 % at x = 1.9.
    """

    hardness: Literal["exponential", "cosine"] = "exponential"

    name: ClassVar[str] = "JG"
    source: ClassVar[str] = "doi:10.1115/1.1866166"
    validity: ClassVar[str] = "contact radius below 0.41 R; elastic, perfectly plastic"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.hardness not in ("exponential", "cosine"):
            raise InputError(f'JG: hardness = {self.hardness!r}; use "exponential" or "cosine"')

    def _yielding(self, x: Array) -> AsperityCurve:
        return AsperityCurve(*self._plastic(x, self.hardness), self._work(x, self.hardness))
