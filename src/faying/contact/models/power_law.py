"""The approach law of machine-tool joints: approach = C p^m, fitted to measured joints since Ostrovskii."""

from dataclasses import dataclass
from math import inf
from typing import ClassVar, Self, final

import numpy as np
from numpy.typing import ArrayLike

from faying.checks import number
from faying.contact.law import ContactLaw, Response, checked
from faying.contact.measured_range import OF_CURVES
from faying.contact.parameter import TEXT, Parameter
from faying.errors import InputError
from faying.units import show

PRESSURES = 1e3, 1e12  # Pa: the weight of a plate, and more than any solid has as modulus
# at the greatest pressure: no joint has an approach [m] of less than the distance of atoms or of more than any
# roughness, nor a stiffness [Pa/m] of more than the stiffest solid, 1 TPa, has over the distance of atoms
APPROACHES = 1e-10, 1e-3
STIFFEST = 1e12 / 1e-10


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
    measured_ranges: ClassVar = {"Power law": OF_CURVES}
    source: ClassVar[str] = "isbn:978-0071496605"
    validity: ClassVar[str] = "the joint and the pressures that it was fitted to"
    parameters: ClassVar = {
        "C": Parameter("", "approach at 1 Pa, in m/Pa^m", 0),
        "m": Parameter("", "power of pressure", 0, 1),
        "greatest": Parameter("Pa", "largest pressure of the measurement", *PRESSURES, "[]"),
        "origin": Parameter(TEXT, "which joint it is"),
    }

    def __post_init__(self) -> None:
        super().__post_init__()
        top, (least, greatest) = self.closure_range[1], APPROACHES
        stiffness = self.greatest / (self.m * top) if top else inf
        if not (least <= top <= greatest and stiffness <= STIFFEST):
            raise InputError(
                f"{self.name}: C = {self.C:g} m/Pa^m and m = {self.m:g} give an approach of {top:.3g} m and a "
                f"stiffness of {stiffness:.3g} Pa/m at {show(self.greatest, 'Pa')}; a joint has {show(least, 'm')} to "
                f"{show(greatest, 'm')} and at most {STIFFEST:g} Pa/m: check the units"
            )

    @classmethod
    def measured(cls, *, C: float, m: float, origin: str, greatest: float = 9.8e6) -> Self:
        """Return the law of C in um/MPa^m, as tables of joints print it."""
        C, m = number(C, "C [um/MPa^m]", least=0), number(m, "m", least=0, greatest=1)
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
