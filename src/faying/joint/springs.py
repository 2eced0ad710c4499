"""The springs of a joint at one preload, on any description of how its faces move."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Generic, Protocol, Self, TypeVar

import numpy as np

from faying.typing import Array


class InterfaceMotion(Protocol):
    """What a joint needs to know of its faces: relative motion at weighted points, from any vector of displacements."""

    @property
    def weights(self) -> Array:
        """Areas [m2] (q,)."""

    @property
    def gap(self) -> Array:
        """Distance of the faces before any load [m] (q,)."""

    @property
    def relative(self) -> Any:
        """Operator (3q, unknowns): opening and two slips at each point."""

    def springs(self, k_n: Array, k_t: Array) -> Any:
        """Stiffness matrix [N/m] of springs per area k_n, k_t [Pa/m] (q,)."""


STACKED = ("k_n", "k_t", "loss_n", "loss_t")
Motion = TypeVar("Motion", bound=InterfaceMotion)


@dataclass(frozen=True, kw_only=True)
class Springs(Generic[Motion]):
    """The springs of one joint at one preload, at the points of `interface` (q,).

    pressure [Pa]: nominal, under which the springs are; k_n, k_t [Pa/m]; loss_n, loss_t: loss factors [-].
    """

    interface: Motion
    pressure: Array
    k_n: Array
    k_t: Array
    loss_n: Array
    loss_t: Array

    def half(self, which: int) -> Self:
        """Every second point, from the first (0) or from the second one (1), with twice its stiffness."""
        twice = 2.0 * (np.arange(len(self.k_n)) % 2 == which)
        return replace(self, k_n=twice * self.k_n, k_t=twice * self.k_t)

    def stiffness(self) -> Any:
        """Stiffness matrix [N/m]."""
        return self.interface.springs(self.k_n, self.k_t)

    def loss(self) -> Any:
        """Imaginary part of the stiffness matrix [N/m]: hysteretic loss."""
        return self.interface.springs(self.k_n * self.loss_n, self.k_t * self.loss_t)

    def lossless(self) -> Self:
        """The same springs without loss."""
        return replace(self, loss_n=np.zeros_like(self.loss_n), loss_t=np.zeros_like(self.loss_t))

    @property
    def lossy(self) -> bool:
        """Whether any of them loses energy."""
        return bool(np.any(self.loss_n) or np.any(self.loss_t))

    def viscous(self, mass: float) -> Any:
        """Damping matrix [N s/m] of the JK paper's dampers, c = eta sqrt(M k) at every point, M [kg] the whole mass.

        k is the spring of a point, so that c grows with the root of its share of the area: the sum depends on the mesh.
        """
        w = self.interface.weights
        # the paper's eta is dissipated over stored energy: 2 pi times the loss factor
        both = (self.loss_n, self.k_n), (self.loss_t, self.k_t)
        c_n, c_t = (2 * np.pi * loss * np.sqrt(mass * k / w) for loss, k in both)
        return self.interface.springs(c_n, c_t)

    def total(self) -> tuple[float, float]:
        """Sum of all normal and all tangential springs [N/m]."""
        w = self.interface.weights
        return float(w @ self.k_n), float(w @ self.k_t)


def stacked(springs: Sequence[Springs[Any]]) -> Array:
    """Stiffness and loss factors (4, points of all joints) of springs, to be kept in a file."""
    return np.stack([np.concatenate([getattr(one, name) for one in springs]) for name in STACKED])


def unstacked(values: Array, motions: Sequence[Motion]) -> list[Springs[Motion]]:
    """Springs of all joints from what `stacked` has made of them, without their pressures."""
    parts = np.split(values, np.cumsum([len(motion.weights) for motion in motions])[:-1], axis=1)
    return [
        Springs(interface=motion, pressure=np.full(part.shape[1], np.nan), **dict(zip(STACKED, part, strict=True)))
        for motion, part in zip(motions, parts, strict=True)
    ]
