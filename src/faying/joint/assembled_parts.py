"""A bolted structure without the laws of its joints: what is assembled once for all laws and preloads."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from faying.bolt.bolt import Bolt, FittedBolt, each_in_its_place
from faying.bolt.dowel import Dowel, FittedDowel
from faying.bolt.solid_bolt import FittedSolidBolt, SolidBolt
from faying.fe.bonded import tie_stiffness
from faying.fe.elasticity import Solid, assemble, rigid_motions
from faying.fe.mesh import Mesh
from faying.fe.sides import nodes_of
from faying.fe.vertices import VertexRestriction
from faying.joint.attachments import PointMass, Support
from faying.memory import available
from faying.numerics.by_parts import PartByPart
from faying.numerics.constraint import constrain, free_motions
from faying.numerics.memory import in_single
from faying.typing import Array, Index

MIN_RESISTANCE = 1e-12  # of the greatest stiffness of an unknown: what a motion may ask for that nothing resists


@dataclass(frozen=True, kw_only=True, eq=False)
class AssembledParts:
    """Parts, bolts, dowels, supports and masses of a structure, and the faces that its joints join; see `Structure`."""

    mesh: Mesh
    materials: Mapping[str, Solid]
    joint_faces: tuple[str, ...]
    bolts: tuple[Bolt | SolidBolt, ...]
    supports: tuple[Support, ...]
    masses: tuple[PointMass, ...]
    dowels: tuple[Dowel, ...] = ()

    def same(self, other: "AssembledParts") -> bool:
        """Whether two frames are made of the same things."""
        mine = (self.mesh, self.materials, self.bolts, self.supports, self.masses, self.dowels)
        others = (other.mesh, other.materials, other.bolts, other.supports, other.masses, other.dowels)
        return self.joint_faces == other.joint_faces and all(a is b for a, b in zip(mine, others, strict=True))

    @cached_property
    def matrices(self) -> tuple[Any, Any]:
        """Stiffness [N/m] and mass [kg] of the parts alone, with the ties of faces that are bonded."""
        K, M = assemble(self.mesh, self.materials)
        return added(K, [self.tie(faces) for faces in self.mesh.ties]), M

    def tie(self, faces: tuple[str, str]) -> Any:
        """Stiffness [N/m] that ties two faces which meet, whether or not their nodes match; see `tie_stiffness`."""
        modulus = max(self.materials[self.mesh.face_part[face]].E for face in faces)
        return tie_stiffness(self.mesh, faces, modulus)

    @cached_property
    def vertices(self) -> VertexRestriction | None:
        """The corners of the elements; None where every node is one."""
        return VertexRestriction.of(self.mesh)

    @cached_property
    def fixed(self) -> Index:
        """Unknowns that supports keep at rest."""
        found = [support.fixed(self.mesh) for support in self.supports]
        return np.unique(np.concatenate(found)) if found else np.zeros(0, dtype=np.int64)

    @cached_property
    def fitted_bolts(self) -> tuple[FittedBolt | FittedSolidBolt, ...]:
        """The bolts in their places."""
        joint_faces = [*self.joint_faces, *(support.face for support in self.supports)]
        fitted = tuple(
            bolt.fitted(self.mesh, self.materials)
            if isinstance(bolt, Bolt)
            else bolt.fitted(self.mesh, self.matrices[0], joint_faces)
            for bolt in self.bolts
        )
        each_in_its_place([bolt for bolt in fitted if isinstance(bolt, FittedBolt)])
        return fitted

    @cached_property
    def fitted_dowels(self) -> tuple[FittedDowel, ...]:
        """The dowels in their places."""
        return tuple(dowel.fitted(self.mesh) for dowel in self.dowels)

    @cached_property
    def loads(self) -> Array:
        """Nodal forces [N] (unknowns, bolts) of 1 N in each bolt."""
        if not self.bolts:
            return np.zeros((self.mesh.unknowns, 0))
        return np.stack([bolt.load for bolt in self.fitted_bolts], axis=1)

    @cached_property
    def _supported(self) -> Any:
        """Stiffness [N/m] of the parts, of dowels and of elastic supports."""
        K = added(self.matrices[0], [dowel.stiffness for dowel in self.fitted_dowels])
        return added(K, [support.springs(self.mesh) for support in self.supports])

    @cached_property
    def supported_stiffness(self) -> Any:
        """Stiffness [N/m] of the parts, of dowels and of elastic supports, before any bolt is tight."""
        return added(self._supported, [-bolt.released for bolt in self.fitted_bolts if bolt.released is not None])

    @cached_property
    def dynamic_matrices(self) -> tuple[Any, Any]:
        """Stiffness [N/m] and mass [kg] without the joints, but with bolts, supports and masses; fixed ones cleared."""
        K = added(self._supported, [bolt.stiffness for bolt in self.fitted_bolts if bolt.released is None])
        M = added(self.matrices[1], [one.mass for one in (*self.fitted_bolts, *self.fitted_dowels)])
        M = added(M, [mass.matrix(self.mesh) for mass in self.masses])
        return constrain(K, self.fixed), constrain(M, self.fixed, 0.0)

    def elastic_forces(self, displacement: Array) -> Array:
        """Forces [N] (unknowns,) with which parts, dowels, springs and tight bolts resist a displacement [m]."""
        tight = [bolt.stiffness for bolt in self.fitted_bolts if bolt.released is None and bolt.stiffness is not None]
        return np.asarray(sum((one @ displacement for one in tight), self._supported @ displacement))

    def inertia(self, acceleration: Array) -> Array:
        """Mass of all that moves times an acceleration [m/s2] (unknowns,), unknowns that are fixed too.

        The matrix of the modes has those cleared, and with them what their nodes share of the mass of their elements.
        """
        more = [one.mass for one in (*self.fitted_bolts, *self.fitted_dowels)]
        more += [mass.matrix(self.mesh) for mass in self.masses]
        given = [one @ acceleration for one in more if one is not None]
        return np.asarray(sum(given, self.matrices[1] @ acceleration))

    @property
    def is_parts_only(self) -> bool:
        """Whether parts and supports are all that vibrates: bolts, dowels and masses add nothing."""
        if self.masses or self.dowels:
            return False
        return all(b.stiffness is None and b.released is None and b.mass is None for b in self.fitted_bolts)

    @cached_property
    def rigid(self) -> Array:
        """Rigid motions of the whole that no support resists (unknowns, up to 6)."""
        every = self._motions
        free = free_motions(every, self.fixed)
        springs = added(None, [support.springs(self.mesh) for support in self.supports])
        if springs is None or not free.shape[1]:
            return free
        values, vectors = np.linalg.eigh(free.T @ (springs @ free))
        # beside what the springs resist of any motion, fixed faces aside: the rest is rounding
        most = float(np.linalg.eigvalsh(every.T @ (springs @ every)).max())
        return np.asarray(free @ vectors[:, values < 1e-10 * most])

    @property
    def _motions(self) -> Array:
        """Six rigid motions (unknowns, 6) of the whole, whatever resists them."""
        return rigid_motions(self.mesh.points)

    @cached_property
    def is_large(self) -> bool:
        """Whether one factor of the whole would take more than half of the memory that is free when this is asked."""
        free = available()
        return free is not None and in_single(self.mesh.unknowns) > free / 2

    @cached_property
    def by_parts(self) -> PartByPart:
        """What factorises the matrices of the structure part by part; the factors of the parts serve all laws."""
        mesh = self.mesh
        faces = {*self.joint_faces, *(support.face for support in self.supports)}
        faces |= {face for bolt in self.bolts for face in bolt.faces}
        faces |= {wall for dowel in self.dowels for wall in dowel.walls}
        faces |= {mass.face for mass in self.masses if mass.face is not None}
        nodes = np.unique(np.concatenate([nodes_of(mesh.face(face)) for face in sorted(faces)]))
        pulled = np.flatnonzero(np.any(self.loads != 0, axis=1))
        touched = np.union1d(np.union1d(unknowns_of(nodes), pulled), self.fixed)
        return PartByPart([unknowns_of(mesh.body_nodes(body)) for body in mesh.bodies], touched, self._motions)

    def unjoined_motions(self) -> Array:
        """Motions (unknowns, r) of the bodies, each rigid by itself, that nothing resists with all joints apart."""
        mesh, (stiffness, _) = self.mesh, self.dynamic_matrices
        motions = np.zeros((mesh.unknowns, 6 * len(mesh.bodies)))
        for number, body in enumerate(mesh.bodies):
            nodes = mesh.body_nodes(body)
            motions[unknowns_of(nodes), 6 * number : 6 * number + 6] = rigid_motions(mesh.points[nodes])
        motions = free_motions(motions, self.fixed)
        small = motions.T @ (stiffness @ motions)
        values, vectors = np.linalg.eigh((small + small.T) / 2)
        size = float(stiffness.diagonal().max())
        return np.asarray(motions @ vectors[:, values < MIN_RESISTANCE * size])

    @cached_property
    def shift_frequency(self) -> float:
        """A frequency below the first elastic mode of any compact body of this size [Hz]: 0.02 c/size."""
        return compact_shift(self.materials.values(), self.mesh.size)


def compact_shift(materials: Iterable[Solid], size: float) -> float:
    """A frequency below the first elastic mode of any compact body of a size [m]: 0.02 c/size [Hz]."""
    return float(0.02 * max((m.E / (m.density or np.inf)) ** 0.5 for m in materials) / size)


def unknowns_of(nodes: Index) -> Index:
    """The three unknowns of each node, in the order of the nodes."""
    return np.asarray(3 * nodes[:, None] + np.arange(3)).ravel()


def added(matrix: Any, more: Sequence[Any]) -> Any:
    """Sum of a matrix and others, those that are None left out."""
    for one in more:
        if one is not None:
            matrix = one if matrix is None else matrix + one
    return matrix
