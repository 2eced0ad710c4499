"""Unloading from a largest interference, and the elastic-plastic load index that follows from it."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from math import sqrt
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.asperity.base import AsperityModel, AsperityResponse
from faying.contact.law import checked
from faying.errors import InputError
from faying.typing import Array


@dataclass(frozen=True, kw_only=True)
class Unloading(ABC):
    """Unloading after loading by a model to delta_max [m], one number or any shape; InputError unless positive."""

    loading: AsperityModel
    delta_max: float | Array

    name: ClassVar[str]
    source: ClassVar[str]

    def __post_init__(self) -> None:
        checked(self.delta_max, name=f"{self.name}: delta_max", unit="m", zero=False)

    @cached_property
    def top(self) -> AsperityResponse:
        """The response at delta_max under loading."""
        return self.loading.at(self.delta_max)

    @property
    @abstractmethod
    def residual(self) -> Array:
        """Interference at which contact is lost [m]."""

    @property
    @abstractmethod
    def exponents(self) -> tuple[Array, Array]:
        """Powers of force and of area in (delta - residual)/(delta_max - residual)."""

    def at(self, delta: ArrayLike) -> AsperityResponse:
        """Return the response at interferences [m] of unloading; 0 below the residual one.

        energy is what is still to be recovered, the integral of force from the residual interference. Raises
        InputError for interferences that are negative or above delta_max.
        """
        d = checked(delta, name="interference", unit="m", zero=True)
        if np.any(d > self.delta_max * (1 + 1e-12)):
            most = np.max(self.delta_max)
            raise InputError(f"{self.name}: interference {d.max():.6g} m is above delta_max = {most:.6g} m")
        span = self.delta_max - self.residual
        s = np.clip((d - self.residual) / span, 0.0, 1.0)
        n, m = self.exponents
        F, A = self.top.force, self.top.area
        force, area = F * s**n, A * s**m
        return AsperityResponse(
            force=np.asarray(force),
            area=np.asarray(area),
            pressure=np.asarray(force / np.where(area > 0, area, 1.0)),
            stiffness=np.asarray(n * F / span * s ** (n - 1)),
            energy=np.asarray(F * span * s ** (n + 1) / (n + 1)),
        )

    @property
    def load_index(self) -> Array:
        """Energy lost over the energy of loading [-]: 0 elastic, 1 all lost."""
        return np.asarray(1 - self.at(self.delta_max).energy / self.top.energy)


@final
@dataclass(frozen=True, kw_only=True)
class EtsionKligermanKadin(Unloading):
    """Fits to finite elements, doi:10.1016/j.ijsolstr.2004.12.006; x = delta_max over the critical interference.

    residual/delta_max = (1 - x^-0.28)(1 - x^-0.69), force power 1.5 x^-0.0331, area power x^-0.12; elastic to x = 1.
    """

    name: ClassVar[str] = "EKK"
    source: ClassVar[str] = "doi:10.1016/j.ijsolstr.2004.12.006"

    @property
    def _x(self) -> Array:
        return np.maximum(np.asarray(self.delta_max) / self.loading.critical, 1.0)

    @property
    def residual(self) -> Array:
        """Interference at which contact is lost [m]."""
        return np.asarray(self.delta_max * (1 - self._x**-0.28) * (1 - self._x**-0.69))

    @property
    def exponents(self) -> tuple[Array, Array]:
        """Powers of force and of area."""
        return 1.5 * self._x**-0.0331, self._x**-0.12


@final
@dataclass(frozen=True, kw_only=True)
class Brake(Unloading):
    """Hertz with a flattened radius, doi:10.1016/j.ijsolstr.2015.02.018.

    residual = delta_max [1 - F/((4/3) E* sqrt(R) delta_max^1.5)]; the radius that then carries F over the rest.
    """

    name: ClassVar[str] = "Brake"
    source: ClassVar[str] = "doi:10.1016/j.ijsolstr.2015.02.018"

    @property
    def residual(self) -> Array:
        """Interference at which contact is lost [m]."""
        elastic = 4 / 3 * self.loading.pair.E_star * sqrt(self.loading.R) * self.delta_max**1.5
        return np.asarray(self.delta_max * np.maximum(0.0, 1 - self.top.force / elastic))

    @property
    def radius(self) -> Array:
        """Radius of the flattened asperity, F^2/[((4/3) E*)^2 (delta_max - residual)^3] [m]."""
        span = self.delta_max - self.residual
        return np.asarray((self.top.force / (4 / 3 * self.loading.pair.E_star)) ** 2 / span**3)

    @property
    def exponents(self) -> tuple[Array, Array]:
        """Powers of force and of area."""
        return np.asarray(1.5), np.asarray(1.0)


def load_index(
    loading: AsperityModel, delta_max: ArrayLike, unloading: type[Unloading] = EtsionKligermanKadin
) -> Array:
    """Return alpha, the energy lost over the energy of loading [-], at largest interferences [m], any shape.

    The JK model's elastic-plastic load index, which its paper takes as 0.2: alpha grows from 0 at first yield to 0.66
    where full plasticity begins.
    """
    d = checked(delta_max, name="delta_max", unit="m", zero=False)
    return unloading(loading=loading, delta_max=d).load_index
