"""Frequency and damping of modes at levels of acceleration: a mode is marched through one cycle of slip.

The mode at rest moves the sliders of every joint to and fro. What they dissipate is the damping, and the first harmonic
of their traction gives secant stiffnesses, under which the mode is found again, until frequency and damping settle.
The mean opening, the lag and the harmonics up to the third are corrected once in a pass; `backbone` solves them all
together.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from faying.joint.equilibrium import PreloadState
from faying.joint.structure import Structure
from faying.microslip.microslip import Microslip
from faying.microslip.slip_model import SlipModel, slip_joints
from faying.numerics.product import product
from faying.typing import Array

PASSES = 40
EVEN = 2  # passes after which a change of the secant stiffnesses, and from the first on one of the lag, is halved:
HALF = 0.5  # undamped, the two drive each other away from the answer where most of a joint slides
TOLERANCE = 1e-4  # relative change of the squared frequency, and a tenth of that of the damping, that ends the passes
HARMONICS = 3  # highest of the motion that follows the first one
# error of the damping over the root of the relative change of the squared frequency: a shape changes by that root, of
# which the basis misses a part; covers the difference to harmonic balance on blocks, plates and a beam
ERROR_OF_SHAPE = 0.2
# of the damping, over the motion that a harmonic near a mode would have, were it not left out, over that of the first
# one: an energy of this size comes and goes (beam whose mode 5 has twice the frequency of mode 3)
ERROR_OF_NEAR_MODE = 4.0
MET = 0.1  # of its square: how near the speed of a harmonic may come to that of a mode
SLIGHT = 1e-5  # relative change of the squared frequency that needs no second pass
MIN_MOTION = 1e-3  # of the greatest motion of a joint's points: what moves less keeps its stiffness at rest
SAMPLES = 32  # instants of a cycle
SPRINGS = 32  # into which a law is cut at each point


@dataclass(frozen=True, kw_only=True)
class AtLevels:
    """Frequency and damping by slip of modes (m,) at levels (l,).

    Args:
        frequencies: [Hz] (l, m).
        damping: ratio of slip [-] (l, m).
        error: of the damping, over it [-] (l, m): its change in the last pass, what the basis may miss of a shape, and
            what a mode near twice or three times the frequency may add; at most 1.
    """

    frequencies: Array
    damping: Array
    error: Array


@dataclass(frozen=True, kw_only=True)
class LevelModel:
    """A structure with joints that slip, in a basis.

    Args:
        slip: the parts in the basis (m,) and the joints in it.
        vectors: the basis at the nodes (unknowns, m).
        rigid: how many of its lowest modes are rigid motions.
    """

    slip: SlipModel
    vectors: Array
    rigid: int

    def lowest(self, count: int) -> "LevelModel":
        """The same on its lowest modes (count,), rigid ones included."""
        _, shapes = self.slip.modes
        shapes = shapes[:, :count]
        return replace(self, slip=self.slip.turned(shapes), vectors=self.vectors @ shapes)

    def at(self, levels: Sequence[float], count: int) -> AtLevels:
        """The lowest elastic modes, so many, at each level: acceleration [m/s2] of the point that moves most."""
        numbers = range(self.rigid, self.rigid + count)
        greatest = self._greatest(self.slip.modes[1][:, numbers])
        found = np.array([[self._mode(a, k, far) for k, far in zip(numbers, greatest, strict=True)] for a in levels])
        frequency, damping, error = np.moveaxis(found, 2, 0)
        return AtLevels(frequencies=frequency, damping=damping, error=error)

    def _mode(self, level: float, number: int, greatest: float) -> tuple[float, float, float]:
        """Frequency [Hz], damping of slip and its error, of one mode; greatest: motion of a node in its shape."""
        speeds, shapes = self.slip.modes
        speed, shape = float(speeds[number]), shapes[:, number]
        rest, damping, error, softened = shape, 0.0, 0.0, (speeds, shapes)
        motion = np.zeros((1 + 2 * HARMONICS, len(shape)))
        secants: list[Array] = []
        near = 0.0
        for done in range(PASSES):
            amplitude = level / speed**2 / greatest
            motion[1] = amplitude * shape
            forces = self.slip.forces(motion, derivative=False, samples=SAMPLES)
            cycles = forces.cycles
            lost = sum(float(j.weights @ c.dissipated) for j, c in zip(self.slip.joints, cycles, strict=True))
            before, damping = damping, max(lost, 0.0) / (2 * np.pi * speed**2 * amplitude**2)
            error = abs(damping - before) / damping if damping > 0 else 0.0
            last, secants = secants, self._secants(motion, cycles)
            squared = speed**2
            # change of the squared frequency, to first order
            softer = sum(j.work(c, motion[1]) for j, c in zip(self.slip.joints, secants, strict=True)) / amplitude**2
            if done == 0 and abs(softer) < SLIGHT * squared:
                speed, error = float(np.sqrt(squared + softer)), abs(softer) / squared
                break
            if done >= EVEN:
                secants = [HALF * (one + other) for one, other in zip(last, secants, strict=True)]
            near = self._follow(motion, forces.force, speed, damping, softened) / amplitude
            softened, like = self._under(secants, rest)
            speed, shape = float(softened[0][like]), softened[1][:, like]
            if abs(speed**2 - squared) < TOLERANCE * squared and error < 10 * TOLERANCE:
                break
            greatest = float(self._greatest(shape[:, None])[0])
        lower = max(1 - (speed / float(speeds[number])) ** 2, 0.0)
        error += ERROR_OF_SHAPE * float(np.sqrt(lower)) + ERROR_OF_NEAR_MODE * near
        return speed / (2 * np.pi), damping, min(error, 1.0)

    def _follow(
        self, motion: Array, force: Array, speed: float, damping: float, softened: tuple[Array, Array]
    ) -> float:
        """Correct a motion in place by what it leaves of its equations: mean, lag and higher harmonics.

        Args:
            motion, force: of the cycle (1 + 2H, m) [m], [N]; the cosine of the first harmonic stays.
            speed, damping: circular frequency of the mode [rad/s] and its ratio [-]: negative damping keeps it going.
            softened: circular frequencies [rad/s] (m,) and shapes (m, m) under the secants, in which the lag is found.

        Returns:
            The greatest motion of a mode [m] that a harmonic near it would have: such modes are left out.
        """
        near = 0.0
        for harmonic in range(HARMONICS + 1):
            driven = (harmonic * speed) ** 2
            rows = [0] if harmonic == 0 else [2] if harmonic == 1 else [2 * harmonic - 1, 2 * harmonic]
            left = force[rows] - driven * motion[rows] @ self.slip.mass
            if harmonic == 1:
                left = left + 2 * damping * driven * motion[1:2] @ self.slip.mass
            speeds, shapes = (one[..., self.rigid :] for one in (softened if harmonic == 1 else self.slip.modes))
            stiff = speeds**2 - driven
            # a mode whose own speed is near that of the harmonic is left out
            flexible = np.where(np.abs(stiff) > MET * driven, 1 / np.where(stiff == 0, 1.0, stiff), 0.0)
            motion[rows] -= (HALF if harmonic == 1 else 1.0) * (left @ shapes * flexible) @ shapes.T
            if harmonic > 1:
                stiff = np.abs(softened[0][self.rigid :] ** 2 - driven)
                moved = np.linalg.norm(left @ softened[1][:, self.rigid :], axis=0) / np.maximum(stiff, 1e-9 * driven)
                near = max(near, float(moved[stiff <= MET * driven].max(initial=0.0)))
        return near

    def _greatest(self, shapes: Array) -> Array:
        """The greatest displacement of a node (k,) in each of several shapes (m, k)."""
        moved = (self.vectors @ shapes).reshape(-1, 3, shapes.shape[1])
        return np.asarray(np.sqrt(np.einsum("nik,nik->nk", moved, moved).max(axis=0)))

    def _secants(self, motion: Array, cycles: Sequence[Any]) -> list[Array]:
        """What secant stiffnesses at the points of each joint (q, 3, 3) change of those at rest [Pa/m]."""
        out = []
        for joint, cycle in zip(self.slip.joints, cycles, strict=True):
            u, t = joint.motion(motion)[1], cycle.traction[1]
            rest = joint.at_rest[1]
            change = np.zeros_like(rest)
            size = float(np.linalg.norm(u, axis=1).max())
            for axes in ([0], [1, 2]):
                square = np.einsum("qi,qi->q", u[:, axes], u[:, axes])
                moves = square > (MIN_MOTION * size) ** 2
                k = np.einsum("qi,qi->q", t[:, axes], u[:, axes])[moves] / square[moves]
                for axis in axes:
                    change[moves, axis, axis] = k - rest[moves, axis, axis]
            out.append(change)
        return out

    def _under(self, changes: Sequence[Array], rest: Array) -> tuple[tuple[Array, Array], int]:
        """Circular frequencies and shapes under changed springs, and the number of the mode that is most like `rest`.

        changes: `_secants`.
        """
        from scipy.linalg import eigh

        change = sum(j.projected(c) for j, c in zip(self.slip.joints, changes, strict=True))
        squared, shapes = eigh(self.slip.linear + change, self.slip.mass)
        like = np.abs(shapes.T @ self.slip.mass @ rest)
        return (np.sqrt(np.maximum(squared, 0.0)), shapes), int(np.argmax(like))


def cut_laws(structure: Structure, preload: PreloadState, friction: Sequence[float], springs: int) -> list[Microslip]:
    """The law of each joint under a preload, cut into so many springs with sliders; friction: coefficient of each.

    Raises InputError as `Microslip.cut`.
    """
    return [
        Microslip.cut(joint.law, -opening, friction=mu, springs=springs, gap=joint.interface.gap)
        for joint, opening, mu in zip(structure.joints, preload.openings, friction, strict=True)
    ]


def level_model(structure: Structure, preload: PreloadState, vectors: Array, friction: Sequence[float]) -> LevelModel:
    """A structure under its preload in a basis, ready to be marched.

    Args:
        structure: with joints whose laws have a tangential stiffness.
        preload: its equilibrium under the bolts.
        vectors: the basis (unknowns, m), orthonormal with the mass: modes and directions near them.
        friction: coefficient [-] of each joint, 0 or more.

    Raises:
        InputError: a law without stiffness, or a joint that is wholly open.
    """
    interfaces = [joint.interface for joint in structure.joints]
    relatives = [np.asarray(interface.relative @ vectors) for interface in interfaces]
    laws = cut_laws(structure, preload, friction, SPRINGS)
    joints = slip_joints(interfaces, preload.displacement, laws, relatives)
    parts = vectors.T @ product(structure.dynamic_matrices[0], vectors)
    slip = SlipModel(stiffness=(parts + parts.T) / 2, mass=np.eye(vectors.shape[1]), joints=joints)
    return LevelModel(slip=slip, vectors=vectors, rigid=structure.rigid_count)
