"""A reduced structure whose joints slip: elastic matrices in a small basis, and a microslip law at every point.

Everything is measured from the preload: coordinates, forces and tractions are 0 at rest.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from faying.fe.interface import Motion
from faying.microslip.hysteresis import Cycle
from faying.microslip.microslip import Microslip
from faying.typing import Array, Mask


@dataclass(frozen=True, kw_only=True)
class SlipJoint:
    """One joint of a reduced structure.

    weights [m2] (q,); relative (3q, m): opening and two slips at each point from the coordinates; rest [m] (q, 3):
    relative motion under the preload, on which the law counts its own; law: the microslip law at the points.
    """

    weights: Array
    relative: Array
    rest: Array
    law: Microslip

    def motion(self, coordinates: Array) -> Array:
        """Fourier coefficients of the relative motion [m] (1 + 2H, q, 3) from those of the coordinates (1 + 2H, m)."""
        out = (coordinates @ self.relative.T).reshape(len(coordinates), -1, 3)
        out[0] += self.rest
        return out

    @cached_property
    def at_rest(self) -> tuple[Array, Array]:
        """Traction [Pa] (q, 3) and stiffness [Pa/m] (q, 3, 3) under the preload alone."""
        _, traction, tangent = self.law.advance(self.law.start(self.rest), self.rest)
        return traction, tangent

    def cycle(self, coordinates: Array, *, derivative: bool, samples: int) -> Cycle:
        """Tractions of the cycle that the coordinates (1 + 2H, m) make, sliders without shear at rest."""
        start = self.law.start(self.rest)
        return self.law.cycle(self.motion(coordinates), derivative=derivative, samples=samples, start=start)

    def projected(self, tangent: Array) -> Array:
        """Stiffness (m, m) [N/m] of a tangent per area [Pa/m] (q, 3, 3)."""
        rows = np.flatnonzero(tangent.any(axis=(1, 2)))
        relative = self.relative.reshape(len(self.weights), 3, -1)[rows]
        turned = np.matmul(self.weights[rows, None, None] * tangent[rows], relative)
        size = self.relative.shape[1]
        return np.asarray(relative.reshape(-1, size).T @ turned.reshape(-1, size))

    def work(self, tangent: Array, coordinates: Array) -> float:
        """Twice the energy [J] of a tangent per area [Pa/m] (q, 3, 3) in a motion given by its coordinates (m,)."""
        motion = (self.relative @ coordinates).reshape(-1, 3)
        return float(np.einsum("q,qi,qij,qj->", self.weights, motion, tangent, motion, optimize=True))

    def halved(self) -> Self:
        """The same joint at every other point, each with the area of the one that was left out beside it."""
        kept = np.arange(0, len(self.weights), 2)
        rows = (3 * kept[:, None] + np.arange(3)).ravel()
        law = self.law
        at = {name: getattr(law, name)[kept] for name in ("onset", "k_n", "k_t", "gap")}
        return replace(
            self,
            weights=np.add.reduceat(self.weights, kept),
            relative=self.relative[rows],
            rest=self.rest[kept],
            law=replace(law, **at),
        )


def slip_joints(
    interfaces: Sequence[Motion], displacement: Array, laws: Sequence[Microslip], relatives: Sequence[Array]
) -> tuple[SlipJoint, ...]:
    """Joints in a basis, under a preload.

    Args:
        interfaces: how the faces of each joint meet.
        displacement: under the preload [m] (unknowns,).
        laws: of each joint, at the points of its interface.
        relatives: relative motion of each joint (3q, m) from the coordinates of the basis.
    """
    return tuple(
        SlipJoint(
            weights=interface.weights,
            relative=relative,
            rest=np.asarray(interface.relative @ displacement).reshape(-1, 3),
            law=law,
        )
        for interface, law, relative in zip(interfaces, laws, relatives, strict=True)
    )


@dataclass(frozen=True, kw_only=True)
class SlipForces:
    """Elastic and contact forces of a cycle.

    force (1 + 2H, m) [N]; stiffness, its derivative ((1 + 2H) m, (1 + 2H) m) [N/m] or None; cycles: of each joint.
    """

    force: Array
    stiffness: Array | None
    cycles: tuple[Cycle, ...]


@dataclass(frozen=True, kw_only=True)
class SlipModel:
    """Stiffness [N/m] and mass [kg] (m, m) of the parts in a basis, without the joints, and the joints in it."""

    stiffness: Array
    mass: Array
    joints: tuple[SlipJoint, ...]

    @cached_property
    def linear(self) -> Array:
        """Stiffness (m, m) [N/m] at rest, nothing slipping."""
        total = self.stiffness.copy()
        for joint in self.joints:
            total += joint.projected(joint.at_rest[1])
        return (total + total.T) / 2

    @cached_property
    def modes(self) -> tuple[Array, Array]:
        """Angular frequencies [rad/s] (m,) at rest, rising, and mass-normalised shapes (m, m)."""
        return self.modes_under(self.linear)

    def modes_under(self, stiffness: Array) -> tuple[Array, Array]:
        """The same under another stiffness (m, m) [N/m] of parts and joints."""
        from scipy.linalg import eigh

        squared, shapes = eigh(stiffness, self.mass)
        return np.sqrt(np.maximum(squared, 0.0)), shapes

    def turned(self, shapes: Array) -> Self:
        """The model in other coordinates: old = shapes @ new."""
        joints = tuple(replace(joint, relative=joint.relative @ shapes) for joint in self.joints)
        K, M = (shapes.T @ matrix @ shapes for matrix in (self.stiffness, self.mass))
        return replace(self, stiffness=(K + K.T) / 2, mass=(M + M.T) / 2, joints=joints)

    def halved(self) -> Self:
        """The model with half of the points, and the same stiffness at rest.

        What changes is how finely the slip is sampled.
        """
        fewer = replace(self, joints=tuple(joint.halved() for joint in self.joints))
        return replace(fewer, stiffness=self.stiffness + self.linear - fewer.linear)

    def forces(self, coordinates: Array, *, derivative: bool = True, samples: int = 64) -> SlipForces:
        """Forces of a cycle given by the Fourier coefficients of the coordinates (1 + 2H, m): mean, cos, sin, ..."""
        count, size = coordinates.shape
        force = coordinates @ self.stiffness
        jacobian = np.zeros((count, size, count, size)) if derivative else None
        if jacobian is not None:
            jacobian[np.arange(count), :, np.arange(count)] = self.stiffness
        cycles = []
        for joint in self.joints:
            cycle = joint.cycle(coordinates, derivative=derivative, samples=samples)
            traction = cycle.traction.copy()
            traction[0] -= joint.at_rest[0]
            traction *= joint.weights[:, None]
            force = force + traction.reshape(count, -1) @ joint.relative
            if jacobian is not None and cycle.derivative is not None:
                _add_projected(jacobian, joint, cycle.derivative)
            cycles.append(cycle)
        full = None if jacobian is None else jacobian.reshape(count * size, count * size)
        return SlipForces(force=force, stiffness=full, cycles=tuple(cycles))


def _add_projected(jacobian: Array, joint: SlipJoint, derivative: Array) -> None:
    """Add the derivatives of a joint's tractions (q, 3n, 3n) to those of the forces (n, m, n, m)."""
    count, size = jacobian.shape[:2]
    q = len(joint.weights)
    motion = joint.relative.reshape(q, 3, size)
    weighted = derivative.reshape(q, count, 3, count, 3)
    weighted = weighted * joint.weights[:, None, None, None, None]
    for column in range(count):
        by = np.matmul(weighted[:, :, :, column].reshape(q, 3 * count, 3), motion).reshape(q, count, 3, size)
        for row in range(count):
            jacobian[row, :, column, :] += joint.relative.T @ by[:, row].reshape(3 * q, size)


def share(values: Sequence[Array | Mask], joints: Sequence[SlipJoint]) -> float:
    """Mean over the area of all joints of values (q,) at their points."""
    area = sum(float(joint.weights.sum()) for joint in joints)
    return sum(float(joint.weights @ value) for value, joint in zip(values, joints, strict=True)) / area
