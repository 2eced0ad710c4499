"""The gap between two faces at quadrature points, and springs per area on it as a matrix."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from faying.errors import InputError
from faying.fe.elasticity import surface_frame
from faying.fe.elements import reference, shape_at
from faying.fe.mesh import Array, Index, Mesh

DEGREE = 4  # exact for products of two quadratic functions on straight triangles


@dataclass(frozen=True, kw_only=True)
class Interface:
    """Where two faces meet: relative displacement at points that each carry a share of the area.

    positions [m] (q, 3); weights, the areas [m2] (q,); normals (q, 3), from the first face to the second; gap, the
    distance between the faces before any load [m] (q,). The operator `relative` (3q, unknowns) takes displacements to
    (opening along the normal, two slips) at each point; second face minus first.
    """

    positions: Array
    weights: Array
    normals: Array
    gap: Array
    first_nodes: Index
    first_values: Array
    second_nodes: Index
    second_values: Array
    unknowns: int

    @property
    def area(self) -> float:
        """Area of the joint [m2]."""
        return float(self.weights.sum())

    @cached_property
    def frames(self) -> Array:
        """Orthonormal axes (q, 3, 3): rows are the normal and two tangents."""
        n = self.normals
        helper = np.where(np.abs(n[:, :1]) < 0.8, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
        t1 = np.cross(n, helper)
        t1 /= np.linalg.norm(t1, axis=1)[:, None]
        return np.stack([n, t1, np.cross(n, t1)], axis=1)

    @cached_property
    def relative(self) -> Any:
        """Sparse operator (3q, unknowns) from displacements to opening and slips [m per m]."""
        from scipy.sparse import csr_array

        q = len(self.weights)
        nodes = np.concatenate([self.first_nodes, self.second_nodes], axis=1)
        values = np.concatenate([-self.first_values, self.second_values], axis=1)
        entries = values[:, None, :, None] * self.frames[:, :, None, :]  # q, axis, node, component
        columns = np.broadcast_to((3 * nodes)[:, None, :, None] + np.arange(3), entries.shape)
        pointer = np.arange(3 * q + 1) * (3 * nodes.shape[1])
        matrix = csr_array((entries.ravel(), columns.ravel(), pointer), shape=(3 * q, self.unknowns))
        matrix.eliminate_zeros()
        return matrix

    def springs(self, k_n: Array, k_t: Array) -> Any:
        """Stiffness matrix [N/m] of springs per area k_n, k_t [Pa/m] (q,) or any other density in their place."""
        from scipy.sparse import diags_array

        share = self.weights[:, None] * np.stack([k_n, k_t, k_t], axis=1)
        return (self.relative.T @ diags_array(share.ravel()) @ self.relative).tocsr()

    def opening(self, displacement: Array) -> Array:
        """Opening along the normal [m] (q,), the gap before the load included; negative where the faces approach."""
        return np.asarray((self.relative @ displacement).reshape(-1, 3)[:, 0] + self.gap)

    def slip(self, displacement: Array) -> Array:
        """Two slips [m] (q, 2)."""
        return np.asarray((self.relative @ displacement).reshape(-1, 3)[:, 1:])

    def forces(self, pressure: Array, shear: Array) -> Array:
        """Nodal forces [N] (unknowns,) of a pressure [Pa] (q,) that pushes apart and shear tractions [Pa] (q, 2)."""
        local = np.concatenate([-pressure[:, None], shear], axis=1) * self.weights[:, None]
        return np.asarray(-(self.relative.T @ local.ravel()))

    def at_nodes(self) -> "Interface":
        """Return the same joint lumped to the nodes of its first face, each with its share of the area.

        For the node-by-node use of a law. Shares follow the diagonal of the consistent mass matrix, so that all are
        positive (the consistent share of a corner of a quadratic triangle is zero). Needs faces that match.
        """
        nodes, inverse = np.unique(self.first_nodes, return_inverse=True)
        inverse = inverse.reshape(self.first_nodes.shape)
        diagonal = np.zeros(len(nodes))
        np.add.at(diagonal, inverse, self.weights[:, None] * self.first_values**2)
        share = diagonal * (self.area / diagonal.sum())
        where = np.empty((len(nodes), 3))
        partner = np.full(len(nodes), -1)
        normal, gap = np.zeros((len(nodes), 3)), np.zeros(len(nodes))
        np.add.at(normal, inverse, self.weights[:, None, None] * self.normals[:, None, :])
        np.add.at(gap, inverse, (self.weights * self.gap)[:, None])
        weight = np.zeros(len(nodes))
        np.add.at(weight, inverse, self.weights[:, None])
        # matched faces: the shape functions of both sides agree point by point, up to their order
        order_a = np.argsort(-self.first_values, axis=1)
        order_b = np.argsort(-self.second_values, axis=1)
        same = np.allclose(np.take_along_axis(self.first_values, order_a, 1),
                           np.take_along_axis(self.second_values, order_b, 1), atol=1e-6)  # fmt: skip
        if not same:
            raise InputError("node-by-node springs need faces whose meshes match; use springs per area")
        for column in range(self.first_nodes.shape[1]):
            match = np.argmin(np.abs(self.second_values - self.first_values[:, column : column + 1]), axis=1)
            partner[inverse[:, column]] = self.second_nodes[np.arange(len(match)), match]
        return Interface(
            positions=where,
            weights=share,
            normals=normal / np.linalg.norm(normal, axis=1)[:, None],
            gap=gap / weight,
            first_nodes=nodes[:, None],
            first_values=np.ones((len(nodes), 1)),
            second_nodes=partner[:, None],
            second_values=np.ones((len(nodes), 1)),
            unknowns=self.unknowns,
        )


def join(mesh: Mesh, first: str, second: str, *, reach: float | None = None) -> Interface:
    """Pair two faces: each quadrature point of the first is projected on the second.

    first, second: names of the faces; reach: the farthest that the second may lie away [m], 1 % of the structure's size
    where None. Points that find no partner carry nothing. Raises InputError where the faces do not meet at all, lie on
    one part, or face the same way.
    """
    tri_a, tri_b = mesh.face(first), mesh.face(second)
    if mesh.face_part[first] == mesh.face_part[second]:
        raise InputError(
            f"faces {first!r} and {second!r} are both on part {mesh.face_part[first]!r}; a joint needs two"
        )
    reach = 0.01 * mesh.size if reach is None else reach
    _, weights, values, gradients = reference("tri6", DEGREE)
    normals, area = surface_frame(mesh.points, tri_a, gradients)
    positions = np.einsum("fai,qa->fqi", mesh.points[tri_a], values).reshape(-1, 3)
    normals = normals.reshape(-1, 3)
    host, local, distance = _project(mesh.points, tri_b, positions, normals, reach)
    hit = host >= 0
    if not np.any(hit):
        from scipy.spatial import cKDTree

        apart = cKDTree(mesh.points[tri_b].reshape(-1, 3)).query(mesh.points[tri_a].reshape(-1, 3))[0]
        nearest = float(apart.min())
        raise InputError(f"faces {first!r} and {second!r} do not touch: they are {nearest * 1e3:.4g} mm apart at the "
                         f"nearest and the joint reaches {reach * 1e3:.4g} mm; move a part, or check the unit of the "
                         "geometry")  # fmt: skip
    nodes_a = np.repeat(tri_a, len(weights), axis=0)
    second_values, _ = shape_at("tri6", local[hit].T)
    first_values = np.tile(values, (len(tri_a), 1))[hit]
    return Interface(
        positions=positions[hit],
        weights=(area * weights).reshape(-1)[hit],
        normals=normals[hit],
        gap=distance[hit],
        first_nodes=nodes_a[hit],
        first_values=first_values,
        second_nodes=tri_b[host[hit]],
        second_values=second_values,
        unknowns=mesh.unknowns,
    )


def _project(
    points: Array, triangles: Index, positions: Array, normals: Array, reach: float
) -> tuple[Index, Array, Array]:
    """For each position: triangle hit along its normal (-1 for none), local coordinates there, signed distance [m].

    Candidates are the triangles whose centres lie nearest; on each, Newton finds where the line along the normal cuts
    the curved triangle.
    """
    from scipy.spatial import cKDTree

    centres = points[triangles[:, :3]].mean(axis=1)
    count = min(12, len(triangles))
    _, near = cKDTree(centres).query(positions, k=count)
    near = np.asarray(near).reshape(len(positions), count)
    host = np.full(len(positions), -1, dtype=np.int64)
    local = np.zeros((len(positions), 2))
    distance = np.zeros(len(positions))
    open_points = np.arange(len(positions))
    for rank in range(count):
        if not len(open_points):
            break
        tri = near[open_points, rank]
        corners = points[triangles[tri]]
        target, normal = positions[open_points], normals[open_points]
        guess = np.full((len(open_points), 2), 1 / 3)
        along = np.zeros(len(open_points))
        for _ in range(8):
            values, gradients = shape_at("tri6", guess.T)
            miss = np.einsum("qa,qai->qi", values, corners) - target - along[:, None] * normal
            tangent = np.einsum("qai,qaj->qij", corners, gradients)
            jacobian = np.concatenate([tangent, -normal[:, :, None]], axis=2)
            flat = np.abs(np.linalg.det(jacobian)) < 1e-30
            jacobian[flat] = np.eye(3)
            step = np.linalg.solve(jacobian, miss[:, :, None])[:, :, 0]
            guess = np.clip(guess - step[:, :2], -1.0, 2.0)
            along = along - step[:, 2]
        tolerance = 1e-6
        facing = np.einsum("qi,qi->q", np.cross(tangent[..., 0], tangent[..., 1]), normal) < 0
        inside = (guess >= -tolerance).all(axis=1) & (guess.sum(axis=1) <= 1 + tolerance)
        good = inside & facing & (np.abs(along) <= reach) & ~flat
        chosen = open_points[good]
        host[chosen], local[chosen], distance[chosen] = tri[good], guess[good], along[good]
        open_points = open_points[~good]
    return host, local, distance
