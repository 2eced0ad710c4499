"""What every single-asperity model gives, and the models that are sums of powers between borders."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from math import pi, sqrt
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.law import checked, found_in
from faying.errors import InputError, shown
from faying.materials import ContactPair
from faying.typing import Array

Term = tuple[float, float]  # coefficient and power of x


@dataclass(frozen=True, kw_only=True)
class AsperityResponse:
    """One asperity at one interference or many, all arrays of the same shape.

    force [N]; area, real [m2]; pressure, mean [Pa]; stiffness, the derivative of force by interference [N/m]; energy,
    its integral from first touch [J].
    """

    force: Array
    area: Array
    pressure: Array
    stiffness: Array
    energy: Array


class AsperityCurve(NamedTuple):
    """A model without units at x: force P, area A, derivative dP/dx, energy integral of P dx."""

    P: Array
    A: Array
    dP: Array
    W: Array


@dataclass(frozen=True, kw_only=True)
class AsperityModel(ABC):
    """A sphere of radius R [m] of the pair, against a plane. A model states a curve in x, interference over `critical`.

    Units of the curve: the Hertz force (4/3) E* sqrt(R) c^(3/2) and area pi R c at the critical interference c.
    Raises InputError unless R is positive and finite.
    """

    R: float
    pair: ContactPair

    name: ClassVar[str]
    source: ClassVar[str]
    validity: ClassVar[str]

    def __post_init__(self) -> None:
        if not 0 < self.R < np.inf:
            raise InputError(f"{self.name}: R = {self.R:.6g} m; it must be positive, for example 15e-6")

    @property
    def critical(self) -> float:
        """Interference at which yield begins, (pi K H/(2 E*))^2 R [m]; K H of the softer body."""
        KH = self.pair.hardness_coefficient * self.pair.hardness
        return float((pi * KH / (2 * self.pair.E_star)) ** 2 * self.R)

    @property
    @abstractmethod
    def borders(self) -> tuple[float, ...]:
        """The x at which the formulas change; force may jump there where the source's fits do not meet."""

    @abstractmethod
    def curve(self, x: Array) -> AsperityCurve:
        """Return the model without units at x >= 0."""

    def at(self, delta: ArrayLike) -> AsperityResponse:
        """Return the response at interferences [m], any shape; InputError where one is negative or not finite."""
        d = checked(delta, name="interference", unit="m", zero=True)
        c = self.critical
        P, A, dP, W = self.curve(d / c)
        unit_force, unit_area = 4 / 3 * self.pair.E_star * sqrt(self.R) * c**1.5, pi * self.R * c
        force, area = unit_force * P, unit_area * A
        return AsperityResponse(
            force=np.asarray(force),
            area=np.asarray(area),
            pressure=np.asarray(force / np.where(area > 0, area, 1.0)),
            stiffness=np.asarray(unit_force / c * dP),
            energy=np.asarray(unit_force * c * W),
        )

    def jump(self, x: float) -> float:
        """How much P grows at once at the border x."""
        below, above = self.curve(np.array([np.nextafter(x, 0), np.nextafter(x, np.inf)])).P
        return float(above - below)


class Piece(NamedTuple):
    """A stretch of a curve up to x = upper: P and A as sums of coefficient times power of x."""

    upper: float
    P: tuple[Term, ...]
    A: tuple[Term, ...]


HERTZ = Piece(1.0, ((1.0, 1.5),), ((1.0, 1.0),))


def powers(terms: tuple[Term, ...], x: Array) -> Array:
    """Sum of coefficient times power of x."""
    return np.asarray(sum((c * x**n for c, n in terms), np.zeros_like(x)))


def work(piece: Piece, lower: float, x: Array) -> Array:
    """Integral of P from the beginning of a piece to x, or to its end where x lies beyond; 0 before it."""
    terms = tuple((c / (n + 1), n + 1) for c, n in piece.P)
    return powers(terms, np.clip(x, lower, piece.upper)) - (powers(terms, np.full_like(x, lower)) if lower > 0 else 0.0)


class PowerModel(AsperityModel):
    """A model whose curve is a sum of powers on each of a few stretches."""

    @property
    @abstractmethod
    def pieces(self) -> tuple[Piece, ...]:
        """The stretches in order; the last ends at infinity."""

    @property
    def borders(self) -> tuple[float, ...]:
        """The x at which the formulas change."""
        return tuple(piece.upper for piece in self.pieces[:-1])

    def curve(self, x: Array) -> AsperityCurve:
        """Return the model without units at x >= 0."""
        P, A, dP, W = (np.zeros_like(x) for _ in range(4))
        lower = 0.0
        for piece in self.pieces:
            here = (x > lower) & (x <= piece.upper)
            P[here], A[here] = powers(piece.P, x[here]), powers(piece.A, x[here])
            dP[here] = powers(tuple((c * n, n - 1) for c, n in piece.P if n != 0), x[here])
            W += work(piece, lower, x)
            lower = piece.upper
        return AsperityCurve(P, A, dP, W)


def models() -> dict[str, type[AsperityModel]]:
    """Return every single-asperity model by the name of its class, in alphabetical order."""
    return dict(found_in("faying.contact.asperity", AsperityModel))


def summed_model(name: str, law: str) -> type[AsperityModel]:
    """Return the model called `name`, in any case and with or without hyphens; InputError, from `law`, lists them."""
    plain = {key.lower(): cls for key, cls in models().items()}
    cls = plain.get(name.lower().replace("-", "").replace("_", "")) if isinstance(name, str) else None
    if cls is None:
        raise InputError(f"{law}: asperity = {shown(name)}; use one of {', '.join(models())}")
    return cls
