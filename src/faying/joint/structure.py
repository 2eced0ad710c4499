"""A bolted structure: meshed parts, the joints between them, and the bolts that pull them together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faying.errors import InputError
from faying.fe.elasticity import Solid, assemble, rigid_motions
from faying.fe.faces import face_centre, face_load
from faying.fe.interface import Interface
from faying.fe.mesh import Mesh
from faying.fe.sides import Index, skin, triangles_of
from faying.joint.preload import Assembly
from faying.joint.seat import Seat

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Joint:
    """Two faces, how they meet, and the law between them; per_node puts springs at nodes, as the JK paper does."""

    name: str
    faces: tuple[str, str]
    interface: Interface
    seat: Seat
    per_node: bool = False
    scan_area: float | None = None


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

    def total(self) -> tuple[float, float]:
        """Sum of all normal and all tangential springs [N/m]."""
        w = self.interface.weights
        return float(w @ self.k_n), float(w @ self.k_t)


@dataclass(frozen=True, kw_only=True)
class Structure:
    """Mesh, material of each part, and joints. Raises InputError where a part belongs to no joint."""

    mesh: Mesh
    materials: Mapping[str, Solid]
    joints: tuple[Joint, ...]

    def __post_init__(self) -> None:
        held = {self.mesh.face_part[face] for joint in self.joints for face in joint.faces}
        loose = [part for part in self.mesh.parts if part not in held]
        if loose and len(self.mesh.parts) > 1:
            raise InputError(f"part {', '.join(loose)} has no joint; add a [[joint]] that holds it, or leave it out")

    @cached_property
    def matrices(self) -> tuple[Any, Any]:
        """Stiffness [N/m] and mass [kg] of the parts without joints."""
        return assemble(self.mesh, self.materials)

    @cached_property
    def rigid(self) -> Array:
        """Six rigid motions of the whole (unknowns, 6)."""
        return rigid_motions(self.mesh.points)

    @cached_property
    def shift_frequency(self) -> float:
        """A frequency below the first elastic mode of any compact body of this size [Hz]: .02 c/size."""
        speeds = [(m.E / (m.density or np.inf)) ** 0.5 for m in self.materials.values()]
        return float(0.02 * max(speeds) / self.mesh.size)

    def bolt_load(self, first: str, second: str) -> Array:
        """Nodal forces [N] (unknowns,) of a bolt that pulls the two faces towards each other with 1 N."""
        mesh = self.mesh
        faces_a, faces_b = mesh.face(first), mesh.face(second)
        if mesh.face_part[first] == mesh.face_part[second]:
            raise InputError(f"the bolt's faces {first!r} and {second!r} are both on part {mesh.face_part[first]!r}; a bolt "
                             "pulls two parts together")  # fmt: skip
        centre_a, normal_a, _ = face_centre(mesh.points, faces_a)
        centre_b, normal_b, _ = face_centre(mesh.points, faces_b)
        axis = centre_b - centre_a
        length = float(np.linalg.norm(axis))
        if length < 1e-6 * mesh.size or normal_a @ axis > -0.5 * length or normal_b @ axis < 0.5 * length:
            raise InputError(f"the bolt's faces {first!r} and {second!r} do not look away from each other; name the two seats "
                             "that head and nut press on")  # fmt: skip
        return face_load(mesh.points, faces_a, centre_a, axis) + face_load(mesh.points, faces_b, centre_a, -axis)

    def assembly(self, *, solver: str | None = None) -> Assembly:
        """Return the preload problem of this structure."""
        K, M = self.matrices
        pairs = [(joint.interface, joint.seat) for joint in self.joints]
        return Assembly(K, M, self.rigid, pairs, shift_frequency=self.shift_frequency, solver=solver)

    def springs(self, pressures: tuple[Array, ...]) -> tuple[Springs, ...]:
        """Stiffness and loss of every joint at pressures [Pa], one array per joint at the points of its interface."""
        out = []
        for joint, pressure in zip(self.joints, pressures, strict=True):
            interface = joint.interface
            per_area: Array = np.ones(1)
            if joint.per_node:
                # the paper's use: each node's force goes straight into the law as if the node were a whole scan
                nodes = interface.at_nodes()
                forces = np.maximum(_to_nodes(interface, nodes, pressure), 0.0) * nodes.weights
                area = joint.scan_area or 1.0
                pressure, interface = forces / area, nodes
                per_area = area / nodes.weights
            k_n, k_t = joint.seat.stiffness(pressure)
            loss_n, loss_t = joint.seat.loss(pressure)
            out.append(
                Springs(interface=interface, k_n=k_n * per_area, k_t=k_t * per_area, loss_n=loss_n, loss_t=loss_t)
            )
        return tuple(out)

    def tie(self) -> Any | None:
        """Return the map that grows the faces of every joint together; see `tie`."""
        return tie(self.mesh, [joint.faces for joint in self.joints])

    def outline(self) -> tuple[NDArray[np.int64], Index]:
        """Nodes of the outer surface and triangles between them (t, 3), for pictures."""
        outer = triangles_of(skin(self.mesh.blocks, len(self.mesh.points)))
        nodes, triangles = np.unique(outer, return_inverse=True)
        return nodes, triangles.reshape(-1, 3).astype(np.int64)


def tie(mesh: Mesh, pairs: Sequence[tuple[str, str]]) -> Any | None:
    """Return the sparse map (unknowns, fewer) that grows pairs of faces together node by node.

    None where the meshes of a pair do not match.
    """
    from scipy.sparse import csr_array
    from scipy.spatial import cKDTree

    n = len(mesh.points)
    owner = np.arange(n)
    for first, second in pairs:
        a, b = mesh.face_nodes(first), mesh.face_nodes(second)
        distance, index = cKDTree(mesh.points[a]).query(mesh.points[b])
        if not np.all(distance < 1e-6 * mesh.size):
            return None
        owner[b] = owner[a[index]]
    kept, column = np.unique(owner, return_inverse=True)
    columns = (3 * column.reshape(-1, 1) + np.arange(3)).ravel()
    return csr_array((np.ones(3 * n), (np.arange(3 * n), columns)), shape=(3 * n, 3 * len(kept)))


def _to_nodes(interface: Interface, nodes: Interface, pressure: Array) -> Array:
    """Mean pressure around each node of the first face, weighted by area and squared shape function."""
    index = np.searchsorted(nodes.first_nodes[:, 0], interface.first_nodes)
    share = interface.weights[:, None] * interface.first_values**2
    total, weight = np.zeros(len(nodes.weights)), np.zeros(len(nodes.weights))
    np.add.at(total, index, share * pressure[:, None])
    np.add.at(weight, index, share)
    return np.asarray(total / weight)
