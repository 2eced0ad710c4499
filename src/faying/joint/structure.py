"""A bolted structure: meshed parts, the joints between them, the bolts that pull them together, what holds them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from faying.errors import InputError
from faying.fe.constraint import free_motions, hold
from faying.fe.elasticity import Solid, assemble, rigid_motions
from faying.fe.interface import Interface
from faying.fe.mesh import Mesh
from faying.fe.sides import skin, triangles_of
from faying.joint.attachments import PointMass, Support
from faying.joint.bolt import Bolt, FittedBolt
from faying.joint.joint_law import JointLaw
from faying.joint.preload import PreloadProblem
from faying.joint.solid_bolt import FittedSolidBolt, SolidBolt
from faying.typing import Array, Index


@dataclass(frozen=True, kw_only=True)
class Joint:
    """Two faces, how they meet, and the law between them; per_node puts springs at nodes, as the JK paper does.

    friction: coefficient of Coulomb slip under the preload [-]; None where the joint sticks everywhere.
    """

    name: str
    faces: tuple[str, str]
    interface: Interface
    law: JointLaw
    per_node: bool = False
    scan_area: float | None = None
    friction: float | None = None

    def __post_init__(self) -> None:
        if self.friction is not None and not 0 <= self.friction < 10:
            raise InputError(
                f"joint {self.name!r}: friction {self.friction:g} is no coefficient of friction; give one such as "
                "0.2, or leave it out for a joint that sticks"
            )


@dataclass(frozen=True, kw_only=True)
class Springs:
    """The springs of one joint at one preload: densities [Pa/m] and loss factors [-] at the points of `interface`."""

    interface: Interface
    k_n: Array
    k_t: Array
    loss_n: Array
    loss_t: Array

    def stiffness(self) -> Any:
        """Stiffness matrix [N/m]."""
        return self.interface.springs(self.k_n, self.k_t)

    def loss(self) -> Any:
        """Imaginary part of the stiffness matrix [N/m]: hysteretic loss."""
        return self.interface.springs(self.k_n * self.loss_n, self.k_t * self.loss_t)

    def viscous(self, mass: float) -> Any:
        """Damping matrix [N s/m] of the JK paper's dampers, c = eta sqrt(M k) at every point, M [kg] the whole mass.

        k is the spring of a point, so that c grows with the root of its share of the area: the sum depends on the mesh.
        """
        w = self.interface.weights
        c_n, c_t = (eta * np.sqrt(mass * k / w) for eta, k in ((self.loss_n, self.k_n), (self.loss_t, self.k_t)))
        return self.interface.springs(c_n, c_t)

    def total(self) -> tuple[float, float]:
        """Sum of all normal and all tangential springs [N/m]."""
        w = self.interface.weights
        return float(w @ self.k_n), float(w @ self.k_t)


@dataclass(frozen=True, kw_only=True)
class Structure:
    """Mesh, material of each part, joints, bolts, supports and point masses.

    Raises InputError where a part is held by nothing, neither a joint nor a support, or is two solid bolts, and where a
    solid bolt's face is in no joint.
    """

    mesh: Mesh
    materials: Mapping[str, Solid]
    joints: tuple[Joint, ...]
    bolts: tuple[Bolt | SolidBolt, ...] = ()
    supports: tuple[Support, ...] = ()
    masses: tuple[PointMass, ...] = ()

    def __post_init__(self) -> None:
        faces = [face for joint in self.joints for face in joint.faces] + [support.face for support in self.supports]
        held = {self.mesh.face_part[face] for face in faces if face in self.mesh.face_part}
        solid = [bolt for bolt in self.bolts if isinstance(bolt, SolidBolt)]
        meshed = [bolt.part for bolt in solid]
        twice = sorted({part for part in meshed if meshed.count(part) > 1})
        if twice:
            raise InputError(f"part {', '.join(twice)} is two solid bolts; a part is drawn in once, with one preload")
        for bolt in solid:
            apart = [face for face in bolt.faces if face not in faces]
            if apart:
                raise InputError(
                    f"bolt {bolt.name!r}: its face {apart[0]!r} is in no joint; add a [[joint]] of it and the seat that it "
                    "presses"
                )
        loose = [part for part in self.mesh.parts if part not in held]
        if loose and len(self.mesh.parts) > 1:
            raise InputError(f"part {', '.join(loose)} has no joint; add a [[joint]] that holds it, or leave it out")

    @cached_property
    def matrices(self) -> tuple[Any, Any]:
        """Stiffness [N/m] and mass [kg] of the parts alone."""
        return assemble(self.mesh, self.materials)

    def sharing(self, other: "Structure") -> "Structure":
        """Return this structure with what `other`, which differs in its laws alone, has assembled already."""
        for name in ("matrices", "held", "fitted_bolts", "loads", "_upheld", "standing", "vibrating", "rigid"):
            self.__dict__[name] = getattr(other, name)
        return self

    @cached_property
    def held(self) -> Index:
        """Unknowns that supports keep at rest."""
        found = [support.held(self.mesh) for support in self.supports]
        return np.unique(np.concatenate(found)) if found else np.zeros(0, dtype=np.int64)

    @cached_property
    def fitted_bolts(self) -> tuple[FittedBolt | FittedSolidBolt, ...]:
        """The bolts in their places."""
        joined = [*(f for joint in self.joints for f in joint.faces), *(support.face for support in self.supports)]
        return tuple(
            bolt.fitted(self.mesh) if isinstance(bolt, Bolt) else bolt.fitted(self.mesh, self.matrices[0], joined)
            for bolt in self.bolts
        )

    @cached_property
    def loads(self) -> Array:
        """Nodal forces [N] (unknowns, bolts) of 1 N in each bolt."""
        if not self.bolts:
            return np.zeros((self.mesh.unknowns, 0))
        return np.stack([bolt.load for bolt in self.fitted_bolts], axis=1)

    @cached_property
    def _upheld(self) -> Any:
        """Stiffness [N/m] of the parts and of elastic supports."""
        return _added(self.matrices[0], [support.springs(self.mesh) for support in self.supports])

    @cached_property
    def standing(self) -> Any:
        """Stiffness [N/m] of the parts and of elastic supports, before any bolt is tight."""
        return _added(self._upheld, [-bolt.released for bolt in self.fitted_bolts if bolt.released is not None])

    @cached_property
    def vibrating(self) -> tuple[Any, Any]:
        """Stiffness [N/m] and mass [kg] without the joints, but with bolts, supports and masses; held unknowns cleared."""
        K = _added(self._upheld, [bolt.stiffness for bolt in self.fitted_bolts if bolt.released is None])
        M = _added(self.matrices[1], [bolt.mass for bolt in self.fitted_bolts])
        M = _added(M, [mass.matrix(self.mesh) for mass in self.masses])
        return hold(K, self.held), hold(M, self.held, 0.0)

    @cached_property
    def rigid(self) -> Array:
        """Rigid motions of the whole that no support resists (unknowns, up to 6)."""
        if any(support.stiffness is not None for support in self.supports):
            springs = _added(None, [support.springs(self.mesh) for support in self.supports])
            all_six = free_motions(rigid_motions(self.mesh.points), self.held)
            if not all_six.shape[1]:
                return all_six
            energy = all_six.T @ (springs @ all_six)
            values, vectors = np.linalg.eigh(energy)
            return np.asarray(all_six @ vectors[:, values < 1e-10 * max(values.max(), 1e-300)])
        return free_motions(rigid_motions(self.mesh.points), self.held)

    @cached_property
    def shift_frequency(self) -> float:
        """A frequency below the first elastic mode of any compact body of this size [Hz]: .02 c/size."""
        speeds = [(m.E / (m.density or np.inf)) ** 0.5 for m in self.materials.values()]
        return float(0.02 * max(speeds) / self.mesh.size)

    def bolt_load(self, first: str, second: str) -> Array:
        """Nodal forces [N] (unknowns,) of a bolt that pulls the two faces towards each other with 1 N."""
        return Bolt(name="bolt", faces=(first, second)).fitted(self.mesh).load

    def assembly(self, *, solver: str | None = None) -> PreloadProblem:
        """Return the preload problem of this structure."""
        pairs = [(joint.interface, joint.law) for joint in self.joints]
        return PreloadProblem(
            self.standing,
            self.matrices[1],
            self.rigid,
            pairs,
            shift_frequency=self.shift_frequency,
            solver=solver,
            friction=[joint.friction for joint in self.joints],
            held=self.held,
        )

    def joined(self, springs: Sequence[Springs], *, viscous: bool = False) -> tuple[Any, Any]:
        """Stiffness [N/m] with the springs of all joints, and their loss; held unknowns cleared.

        The loss is the imaginary part of the stiffness [N/m], or where viscous the damping [N s/m] of the JK paper.
        """
        K = _added(self.vibrating[0], [hold(s.stiffness(), self.held, 0.0) for s in springs])
        weight = float(self.matrices[1].sum()) / 3 if viscous else 0.0
        losses = [hold(s.viscous(weight) if viscous else s.loss(), self.held, 0.0) for s in springs]
        return K, _added(None, losses)

    def springs(self, pressures: tuple[Array, ...]) -> tuple[Springs, ...]:
        """Stiffness and loss of every joint at pressures [Pa], one array per joint at the points of its interface."""
        out = []
        for joint, pressure in zip(self.joints, pressures, strict=True):
            interface = joint.interface
            per_area: Array = np.ones(1)
            if joint.per_node:
                # the paper's use: each node's force goes straight into the law as if the node were a whole scan
                nodes = interface.at_nodes()
                forces = np.maximum(interface.to_nodes(nodes, pressure), 0.0) * nodes.weights
                area = joint.scan_area or 1.0
                pressure, interface = forces / area, nodes
                per_area = area / nodes.weights
            k_n, k_t = joint.law.stiffness(pressure)
            loss_n, loss_t = joint.law.loss(pressure)
            out.append(
                Springs(interface=interface, k_n=k_n * per_area, k_t=k_t * per_area, loss_n=loss_n, loss_t=loss_t)
            )
        return tuple(out)

    def tie(self) -> Any | None:
        """Return the map that grows the faces of every joint together; see `tie`."""
        return tie(self.mesh, [joint.faces for joint in self.joints])

    def outline(self) -> tuple[Index, Index]:
        """Nodes of the outer surface and triangles between them (t, 3), for pictures."""
        outer = triangles_of(skin(self.mesh.blocks, len(self.mesh.points)))
        nodes, triangles = np.unique(outer, return_inverse=True)
        return nodes, triangles.reshape(-1, 3).astype(np.int64)


def _added(matrix: Any, more: Sequence[Any]) -> Any:
    for one in more:
        if one is not None:
            matrix = one if matrix is None else matrix + one
    return matrix


def tie(mesh: Mesh, pairs: Sequence[tuple[str, str]]) -> Any | None:
    """Return the sparse map (unknowns, fewer) that grows pairs of faces together node by node.

    None where the meshes of a pair do not match.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    n = len(mesh.points)
    near, far = [], []
    for first, second in pairs:
        a, b = mesh.face_nodes(first), mesh.face_nodes(second)
        distance, index = cKDTree(mesh.points[a]).query(mesh.points[b])
        if not np.all(distance < 1e-6 * mesh.size):
            return None
        near.append(a[index])
        far.append(b)
    ends = np.concatenate(near), np.concatenate(far)
    # a node of several joints grows together with all that it meets in any of them
    _, column = connected_components(csr_array((np.ones(len(ends[0])), ends), shape=(n, n)), directed=False)
    count = int(column.max()) + 1
    columns = (3 * column.reshape(-1, 1) + np.arange(3)).ravel()
    return csr_array((np.ones(3 * n), (np.arange(3 * n), columns)), shape=(3 * n, 3 * count))
