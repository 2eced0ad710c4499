"""The approach law of machine-tool joints: approach = C p^m, fitted to measured joints since Ostrovskii."""

from dataclasses import dataclass
from functools import partial
from math import inf
from typing import ClassVar, Self, final

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.law import ContactLaw, Parameter, Response, checked, require


@final
@dataclass(frozen=True, kw_only=True)
class PowerLaw(ContactLaw):
    """approach = C p^m, hence k_n = p^(1-m)/(C m). Ito, Modular Design for Machine Tools, ISBN 978-0071496605.

    C [m/Pa^m] and m [-], 0 < m < 1, as measured; greatest, the largest pressure of the measurement [Pa]; origin, a text
    that says which joint it is. The energy is the integral of p by the approach, p u m/(1+m). No area,
    tangential stiffness or loss. Closure variable: the approach [m]. Raises InputError for values out of range.
    """

    C: float
    m: float
    greatest: float = 9.8e6
    origin: str = "table"

    name: ClassVar[str] = "Power law"
    source: ClassVar[str] = "isbn:978-0071496605"
    ground: ClassVar[str] = "the joint and the pressures that it was fitted to"
    parameters: ClassVar = {
        "C": Parameter("", "approach at 1 Pa, in m/Pa^m", "above 0"),
        "m": Parameter("", "power of pressure", "between 0 and 1"),
        "greatest": Parameter("Pa", "largest pressure of the measurement", "above 0"),
        "origin": Parameter("text", "which joint it is", "any text"),
    }

    def __post_init__(self) -> None:
        need = partial(require, "Power law")
        need(0 < self.C < inf, f"C = {self.C}; it must be positive")
        need(0 < self.m < 1, f"m = {self.m}; it must lie between 0 and 1, for example 0.5")
        need(0 < self.greatest < inf, f"greatest = {self.greatest} Pa; it must be positive")

    @classmethod
    def measured(cls, *, C: float, m: float, origin: str, greatest: float = 9.8e6) -> Self:
        """Return the law of C in um/MPa^m, as tables of joints print it."""
        return cls(C=C * 1e-6 / 1e6**m, m=m, origin=origin, greatest=greatest)

    @property
    def closure_range(self) -> tuple[float, float]:
        """Approach at 1e-12 of the greatest pressure, and at that [m]."""
        top = self.C * self.greatest**self.m
        return float(top * 1e-12**self.m), float(top)

    def at_closure(self, approach: ArrayLike) -> Response:
        """Return the response at approaches [m], any shape; InputError unless positive."""
        u = checked(approach, name="approach", unit="m", zero=False)
        p = (u / self.C) ** (1 / self.m)
        return Response(
            pressure=np.asarray(p),
            k_n=np.asarray(p / (self.m * u)),
            energy_n=np.asarray(p * u * self.m / (1 + self.m)),
            reasons={"pressure above that of the measurement": np.asarray(p > self.greatest * (1 + 1e-9))},
        )
