"""A joint condensed to one 6 x 6 stiffness and loss between two points, and what the modes make of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from faying.errors import InputError, NotConverged
from faying.fe.interface import Interface
from faying.joint.springs import Springs
from faying.joint.structure import Structure
from faying.numerics.constraint import constrain
from faying.numerics.modes import Modes, lowest_modes
from faying.numerics.solve import factorise
from faying.typing import Array

SEED = 20240611
OPEN = 1e-12  # of its greatest: a stiffness below it leaves the joint free to move

Tie = Literal["mean", "rigid"]


def carried(arm: Array) -> Array:
    """Motion (..., 3, 6) of places at `arm` (..., 3) [m] from a point, under its translations and rotations."""
    out = np.zeros((*arm.shape[:-1], 3, 6))
    out[..., :3] = np.eye(3)
    out[..., 0, 4], out[..., 0, 5] = arm[..., 2], -arm[..., 1]
    out[..., 1, 3], out[..., 1, 5] = -arm[..., 2], arm[..., 0]
    out[..., 2, 3], out[..., 2, 4] = arm[..., 1], -arm[..., 0]
    return out


@dataclass(frozen=True, kw_only=True, eq=False)
class CondensedJoint:
    """A joint whose faces move as rigid bodies: six forces on six relative motions at a point.

    Args:
        springs: Springs of the joint at its preload.
        point: The point (3,) [m] that forces, moments and motions belong to.

    The motion is that of the second face less that of the first, three translations [m] and three rotations [rad] in
    the axes of the model. `stiffness` (6, 6) sums R' D R over the springs, with R the opening and slips at each under
    the six motions and D their stiffness; `loss` (6, 6) is its imaginary part.
    """

    springs: Springs[Interface]
    point: Array

    @classmethod
    def of(cls, springs: Springs[Interface], point: Array | None = None) -> "CondensedJoint":
        """Condense a joint about a point, by default the centre of its normal springs.

        Raises InputError where the joint carries nothing, or all of its springs lie on one line.
        """
        weight = springs.interface.weights * springs.k_n
        if not weight.sum() > 0:
            raise InputError("the joint is open: it has no stiffness that could be condensed")
        centre = weight @ springs.interface.positions / weight.sum()
        size = np.sqrt(float(weight @ np.sum((springs.interface.positions - centre) ** 2, axis=1) / weight.sum()))
        about = cls(springs=springs, point=centre)
        scale = np.repeat([1.0, 1 / size], 3) if size > 0 else np.repeat([1.0, 0.0], 3)
        values = np.linalg.eigvalsh(about.stiffness * np.outer(scale, scale))
        if values[0] < OPEN * values[-1]:
            raise InputError("the springs of the joint are on one line or at one point, so that its faces can turn")
        return about if point is None else cls(springs=springs, point=np.asarray(point, dtype=float))

    @cached_property
    def _motions(self) -> Array:
        """Opening and slips (q, 3, 6) of each spring under the six motions."""
        i = self.springs.interface
        return np.asarray(np.einsum("qij,qjk->qik", i.frames, carried(i.positions - self.point)))

    @cached_property
    def _share(self) -> Array:
        """Stiffness [N/m] of each spring along normal and tangents (q, 3)."""
        s = self.springs
        return np.asarray(s.interface.weights[:, None] * np.stack([s.k_n, s.k_t, s.k_t], axis=1))

    @cached_property
    def stiffness(self) -> Array:
        """Stiffness (6, 6) [N/m, N, N m]."""
        return np.asarray(np.einsum("qij,qi,qik->jk", self._motions, self._share, self._motions))

    @cached_property
    def loss(self) -> Array:
        """Imaginary part of the stiffness (6, 6) [N/m, N, N m]."""
        s = self.springs
        lost = self._share * np.stack([s.loss_n, s.loss_t, s.loss_t], axis=1)
        return np.asarray(np.einsum("qij,qi,qik->jk", self._motions, lost, self._motions))

    def between(self, first: Array, second: Array) -> tuple[Array, Array]:
        """Stiffness and loss (12, 12) between a point (3,) [m] of the first face and one of the second.

        Rows and columns: three translations and three rotations of the first point, then of the second.
        """
        turn = np.zeros((6, 12))
        for columns, at, sign in ((slice(0, 6), first, -1.0), (slice(6, 12), second, 1.0)):
            block = np.eye(6)
            block[:3] = carried(self.point - np.asarray(at, dtype=float))
            turn[:, columns] = sign * block
        return turn.T @ self.stiffness @ turn, turn.T @ self.loss @ turn

    @cached_property
    def mean(self) -> Array:
        """Forces (unknowns, 6) of unit motions: their mean over the faces, weighted by the springs, is K^-1 of this' u.

        The mean motion of each face is the rigid one nearest to its own in the energy of the springs (RBE3 with the
        springs as weights); with it the condensed joint stores what the springs store, less what is left beside it.
        """
        spread = (self._share[:, :, None] * self._motions).reshape(-1, 6)
        return np.asarray(self.springs.interface.relative.T @ spread)


@dataclass(frozen=True, kw_only=True)
class CondensedModes:
    """Modes with a joint condensed: frequencies [Hz] and loss factors of that joint [-] (m,), shapes (unknowns, m)."""

    frequencies: Array
    loss_factors: Array
    shapes: Array


def condensed_modes(
    structure: Structure,
    springs: Sequence[Springs[Interface]],
    number: int,
    count: int,
    *,
    tie: Tie,
    solver: str | None = None,
) -> CondensedModes:
    """Find the modes of a structure with one of its joints condensed.

    Args:
        structure: the structure.
        springs: of each joint, at its preload.
        number: of the joint that is condensed, from 0; the others stay as they are.
        count: of modes, rigid ones included.
        tie: how the points hang on their faces: "mean" by the mean motion (RBE3), which leaves the faces free to
            deform and is too soft, or "rigid", both faces rigid (RBE2), which is too stiff.
        solver: factorisation, the fastest one found where None.

    Raises:
        InputError: with rigid ties, a support holds some of the face.
        NotConverged: the modes are not found.
    """
    joint = CondensedJoint.of(springs[number])
    others = [s.stiffness() for k, s in enumerate(springs) if k != number]
    K, M = structure.dynamic_matrices
    for other in others:
        K = K + constrain(other, structure.fixed, 0.0)
    if tie == "rigid":
        return _rigid(structure, K, M, joint, number, count, solver)
    spread = joint.mean.copy()
    spread[structure.fixed] = 0.0
    found = _updated(K, M, spread, joint.stiffness, count, structure.shift_frequency, solver)
    frequencies, shapes = found
    motion = np.asarray(np.linalg.solve(joint.stiffness, spread.T @ shapes))
    return CondensedModes(frequencies=frequencies, loss_factors=_factors(motion, joint, frequencies), shapes=shapes)


def _factors(motion: Array, joint: CondensedJoint, frequencies: Array) -> Array:
    """Loss factors [-] to first order, from the motions (6, m) of the condensed joint in mass-normalised modes."""
    lost = np.einsum("im,ij,jm->m", motion, joint.loss, motion)
    squared = (2 * np.pi * frequencies) ** 2
    return np.asarray(np.divide(lost, squared, out=np.zeros_like(lost), where=squared > 0))


def _updated(
    K: Any, M: Any, spread: Array, stiffness: Array, count: int, shift_frequency: float, solver: str | None
) -> tuple[Array, Array]:
    """Lowest modes of K + B k^-1 B' with six columns B, by one factorisation of K + shift M and Woodbury's formula."""
    from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

    shift, n = (2 * np.pi * shift_frequency) ** 2, K.shape[0]
    factor = factorise((K + shift * M).tocsr(), solver)
    answer = factor.solve(np.asfortranarray(spread))
    inner = np.linalg.inv(stiffness + spread.T @ answer)

    def solved(right: Array) -> Array:
        plain = factor.solve(right)
        return np.asarray(plain - answer @ (inner @ (spread.T @ plain)))

    def product(x: Array) -> Array:
        return np.asarray(K @ x + spread @ np.linalg.solve(stiffness, spread.T @ x))

    try:
        values, shapes = eigsh(
            LinearOperator((n, n), matvec=product, dtype=float),
            count,
            M,
            sigma=-shift,
            OPinv=LinearOperator((n, n), matvec=solved, dtype=float),
            v0=np.random.default_rng(SEED).standard_normal(n),
        )
    except ArpackError as fault:
        raise NotConverged(f"the modes with the joint condensed were not found ({fault}); ask for fewer") from None
    order = np.argsort(values)
    return np.sqrt(np.abs(values[order])) / (2 * np.pi), np.asarray(shapes[:, order])


def _rigid(
    structure: Structure, K: Any, M: Any, joint: CondensedJoint, number: int, count: int, solver: str | None
) -> CondensedModes:
    """Lowest modes with both faces of a joint rigid."""
    from scipy.sparse import block_diag, csr_array, eye_array, hstack

    mesh = structure.mesh
    face_nodes = [mesh.face_nodes(face) for face in structure.joints[number].faces]
    supported = np.unique(structure.fixed // 3)
    for face, nodes in zip(structure.joints[number].faces, face_nodes, strict=True):
        if np.isin(nodes, supported).any():
            raise InputError(f"a support holds some of the face {face!r}, which rigid ties would move")
    tied = np.concatenate([(3 * nodes[:, None] + np.arange(3)).ravel() for nodes in face_nodes])
    free = np.setdiff1d(np.arange(mesh.unknowns), tied)
    blocks = [csr_array(carried(mesh.points[nodes] - joint.point).reshape(-1, 6)) for nodes in face_nodes]
    rows = csr_array((np.ones(len(tied)), (tied, np.arange(len(tied)))), shape=(mesh.unknowns, len(tied)))
    tie = hstack([eye_array(mesh.unknowns, format="csc")[:, free], rows @ csr_array(block_diag(blocks))]).tocsr()
    turn = np.concatenate([-np.eye(6), np.eye(6)], axis=1)
    place = np.arange(len(free), len(free) + 12)
    inner = turn.T @ joint.stiffness @ turn
    entry = csr_array((inner.ravel(), (np.repeat(place, 12), np.tile(place, 12))), shape=(tie.shape[1],) * 2)
    modes: Modes = lowest_modes(
        (tie.T @ K @ tie + entry).tocsr(),
        (tie.T @ M @ tie).tocsr(),
        count,
        shift_frequency=structure.shift_frequency,
        solver=solver,
    )
    motion = turn @ modes.shapes[place]
    return CondensedModes(
        frequencies=modes.frequencies,
        loss_factors=_factors(motion, joint, modes.frequencies),
        shapes=np.asarray(tie @ modes.shapes),
    )
