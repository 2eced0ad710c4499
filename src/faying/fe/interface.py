"""The gap between two faces at quadrature points, and springs per area on it as a matrix."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from faying.errors import InputError
from faying.fe.elements import FACES
from faying.fe.overlap import overlap
from faying.fe.sides import Blocks, at_points, padded, sampled
from faying.fe.solids import SolidMesh
from faying.typing import Array, Index


class Motion:
    """Relative motion of two faces at points that each carry a share of the area; see `Interface`."""

    weights: Array
    gap: Array
    relative: Any

    @property
    def area(self) -> float:
        """Area of the joint [m2]."""
        return float(self.weights.sum())

    def springs(self, k_n: Array, k_t: Array) -> Any:
        """Stiffness matrix [N/m] of springs per area k_n, k_t [Pa/m] (q,) or any other density in their place."""
        from scipy.sparse import diags_array

        share = self.weights[:, None] * np.stack([k_n, k_t, k_t], axis=1)
        return (self.relative.T @ diags_array(share.ravel()) @ self.relative).tocsr()

    def forces(self, pressure: Array, shear: Array) -> Array:
        """Nodal forces [N] (unknowns,) of a pressure [Pa] (q,) that pushes apart and shear tractions [Pa] (q, 2)."""
        local = np.concatenate([-pressure[:, None], shear], axis=1) * self.weights[:, None]
        return np.asarray(-(self.relative.T @ local.ravel()))

    def carried(self, spread: Any) -> "CarriedMotion":
        """The same motion from other displacements, which `spread` (unknowns, m) takes to these."""
        return CarriedMotion(weights=self.weights, gap=self.gap, relative=(self.relative @ spread).tocsr())


@dataclass(frozen=True, kw_only=True, eq=False)
class CarriedMotion(Motion):
    """Relative motion by an operator (3q, m) from elsewhere; weights [m2] and gap [m] (q,) are those of `Interface`."""

    weights: Array
    gap: Array
    relative: Any


@dataclass(frozen=True, kw_only=True)
class Interface(Motion):
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
        first, second = (self.first_nodes, self.first_values), (self.second_nodes, self.second_values)
        matrix = self.motion_of(first, second, self.unknowns)
        matrix.eliminate_zeros()
        return matrix

    def motion_of(self, first: tuple[Index, Array], second: tuple[Index, Array], unknowns: int) -> Any:
        """Sparse operator (3q, unknowns) to opening and slips from functions of both faces: numbers, values (q, a)."""
        from scipy.sparse import csr_array, get_index_dtype

        q = len(self.weights)
        numbers = np.concatenate([first[0], second[0]], axis=1)
        values = np.concatenate([-first[1], second[1]], axis=1)
        entries = values[:, None, :, None] * self.frames[:, :, None, :]  # q, axis, function, component
        columns = np.broadcast_to((3 * numbers)[:, None, :, None] + np.arange(3), entries.shape)
        pointer = np.arange(3 * q + 1) * (3 * numbers.shape[1])
        short = get_index_dtype(maxval=max(unknowns, int(pointer[-1])))  # as those of the parts
        indices = columns.astype(short).ravel(), pointer.astype(short)
        return csr_array((entries.ravel(), *indices), shape=(3 * q, unknowns))

    def opening(self, displacement: Array) -> Array:
        """Opening along the normal [m] (q,), the gap before the load included; negative where the faces approach."""
        return np.asarray((self.relative @ displacement).reshape(-1, 3)[:, 0] + self.gap)

    def slip(self, displacement: Array) -> Array:
        """Two slips [m] (q, 2)."""
        return np.asarray((self.relative @ displacement).reshape(-1, 3)[:, 1:])

    def at_nodes(self) -> "Interface":
        """Return the same joint lumped to the nodes of its first face, each with its share of the area.

        For the node-by-node use of a law. Shares follow the diagonal of the consistent mass matrix, so that all are
        positive (the consistent share of a corner of a quadratic triangle is zero). Raises InputError where the faces
        do not match node for node.
        """
        from scipy.sparse.linalg import spsolve

        nodes, first = np.unique(self.first_nodes, return_inverse=True)
        others, second = np.unique(self.second_nodes, return_inverse=True)
        one = at_points(first, self.first_values, len(nodes))
        two = at_points(second, self.second_values, len(others))
        weighted = one * self.weights[:, None]
        gram, cross = (weighted.T @ one).tocsc(), (weighted.T @ two).tocoo()
        diagonal = gram.diagonal()
        # partners are the nodes whose shape functions agree: the integral of the squared difference vanishes
        differ = diagonal[cross.row] + (two * two).T.dot(self.weights)[cross.col] - 2 * cross.data
        same = differ < 1e-8 * diagonal[cross.row]
        partner = np.full(len(nodes), -1)
        partner[cross.row[same]] = others[cross.col[same]]
        if np.any(partner < 0):
            raise InputError("node-by-node springs need faces whose meshes match; use springs per area")
        normal = (weighted * one).T @ self.normals  # squared shape functions: those of corners may integrate to zero
        return Interface(
            positions=np.asarray(spsolve(gram, weighted.T @ self.positions)).reshape(-1, 3),
            weights=diagonal * (self.area / diagonal.sum()),
            normals=normal / np.linalg.norm(normal, axis=1)[:, None],
            gap=np.asarray(spsolve(gram, weighted.T @ self.gap)),
            first_nodes=nodes[:, None],
            first_values=np.ones((len(nodes), 1)),
            second_nodes=partner[:, None],
            second_values=np.ones((len(nodes), 1)),
            unknowns=self.unknowns,
        )

    def to_nodes(self, nodes: "Interface", values: Array) -> Array:
        """Mean of values (q,) at points around each node of the first face (p,); nodes: what `at_nodes` gave.

        The weight is area times squared shape function.
        """
        index = np.searchsorted(nodes.first_nodes[:, 0], self.first_nodes)
        share = self.weights[:, None] * self.first_values**2
        total, weight = np.zeros(len(nodes.weights)), np.zeros(len(nodes.weights))
        np.add.at(total, index, share * values[:, None])
        np.add.at(weight, index, share)
        return np.asarray(total / weight)


def join(mesh: SolidMesh, first: str, second: str, *, search_distance: float | None = None) -> Interface:
    """Pair two faces: where their meshes match, point by point; else over every overlap of two element faces.

    first, second: names of the faces; search_distance: the farthest that the second may lie away [m], 1 % of the
    structure's size where None. What finds no partner carries nothing. Raises InputError where the faces do not meet at
    all, lie on one part, or face the same way.
    """
    faces_a, faces_b = mesh.face(first), mesh.face(second)
    if mesh.face_part[first] == mesh.face_part[second]:
        raise InputError(
            f"faces {first!r} and {second!r} are both on part {mesh.face_part[first]!r}; a joint needs two"
        )
    search_distance = 0.01 * mesh.size if search_distance is None else search_distance
    found = _matched(mesh, faces_a, faces_b, search_distance) or _overlapping(mesh, faces_a, faces_b, search_distance)
    if found is None:
        from scipy.spatial import cKDTree

        apart = cKDTree(mesh.points[mesh.face_nodes(second)]).query(mesh.points[mesh.face_nodes(first)])[0]
        nearest = float(apart.min())
        raise InputError(
            f"faces {first!r} and {second!r} do not touch: they are {nearest * 1e3:.4g} mm apart at the "
            f"nearest and the search distance is {search_distance * 1e3:.4g} mm; move a part, or check the unit of the "
            "geometry"
        )
    return found


def _matched(mesh: SolidMesh, faces_a: Blocks, faces_b: Blocks, search_distance: float) -> Interface | None:
    """Quadrature points of the first face projected on the second; None where the meshes do not match."""
    samples = sampled(mesh.points, faces_a)
    positions = np.concatenate([place.reshape(-1, 3) for _, _, place, _, _ in samples])
    normals = np.concatenate([normal.reshape(-1, 3) for *_, normal, _ in samples])
    weights = np.concatenate([share.ravel() for *_, share in samples])
    first_nodes, first_values = padded(
        [(np.repeat(faces, len(values), axis=0), np.tile(values, (len(faces), 1))) for faces, values, *_ in samples]
    )
    second_nodes, second_values, distance, hit = _project(mesh.points, faces_b, positions, normals, search_distance)
    if not np.any(hit) or first_values.shape[1] != second_values.shape[1]:
        return None
    # shape functions of both sides agree point by point, up to their order
    if not np.allclose(np.sort(first_values[hit], axis=1), np.sort(second_values[hit], axis=1), atol=1e-6):
        return None
    counts = np.concatenate([np.full(len(faces), len(values)) for faces, values, *_ in samples])
    share = np.add.reduceat(hit, np.concatenate([[0], np.cumsum(counts)[:-1]])) / counts
    if not np.all((share == 0) | (share == 1)):  # an edge of the second face runs through an element face of the first
        return None
    return Interface(
        positions=positions[hit],
        weights=weights[hit],
        normals=normals[hit],
        gap=distance[hit],
        first_nodes=first_nodes[hit],
        first_values=first_values[hit],
        second_nodes=second_nodes[hit],
        second_values=second_values[hit],
        unknowns=mesh.unknowns,
    )


def _overlapping(mesh: SolidMesh, faces_a: Blocks, faces_b: Blocks, search_distance: float) -> Interface | None:
    """Points in every overlap of two element faces; None where there is none."""
    degree = max(2 * FACES[faces.shape[1]].order for faces in (*faces_a, *faces_b))
    cut = overlap(mesh.points, faces_a, faces_b, search_distance=search_distance, degree=degree)
    q = len(cut.weights)
    positions, normals, weights = cut.positions.copy(), cut.normals.copy(), cut.weights.copy()
    gap, good = np.zeros(q), np.zeros(q, dtype=bool)
    sides = []
    for blocks, (block, face) in ((faces_a, cut.first), (faces_b, cut.second)):
        width = max(faces.shape[1] for faces in blocks)
        nodes, values = np.full((q, width), blocks[0][0, 0]), np.zeros((q, width))
        for number, faces in enumerate(blocks):
            here = np.flatnonzero(block == number)
            tried = faces[face[here]]
            along, shapes, normal, facing = _cut(mesh.points[tried], positions[here], normals[here])
            nodes[here, : faces.shape[1]], values[here, : faces.shape[1]] = tried, shapes
            if blocks is faces_a:
                positions[here] += along[:, None] * normals[here]
                weights[here] /= np.abs(np.einsum("qi,qi->q", normal, normals[here]))
                normals[here] = normal
            else:
                gap[here], good[here] = along, facing & (np.abs(along) <= search_distance)
        sides.append((nodes, values))
    if not np.any(good):
        return None
    return Interface(
        positions=positions[good],
        weights=weights[good],
        normals=normals[good],
        gap=gap[good],
        first_nodes=sides[0][0][good],
        first_values=sides[0][1][good],
        second_nodes=sides[1][0][good],
        second_values=sides[1][1][good],
        unknowns=mesh.unknowns,
    )


def _project(
    points: Array, blocks: Blocks, positions: Array, normals: Array, search_distance: float
) -> tuple[Index, Array, Array, Any]:
    """For each position: nodes and shape functions of the face hit along its normal, signed distance [m], whether hit.

    Candidates are the element faces whose centres lie nearest; on each, Newton finds where the line along the normal
    cuts the curved face.
    """
    from scipy.spatial import cKDTree

    centres = np.concatenate([points[faces[:, : FACES[faces.shape[1]].corners]].mean(axis=1) for faces in blocks])
    block_of = np.repeat(np.arange(len(blocks)), [len(faces) for faces in blocks])
    within = np.concatenate([np.arange(len(faces)) for faces in blocks])
    count = min(12, len(centres))
    near = np.asarray(cKDTree(centres).query(positions, k=count)[1]).reshape(len(positions), count)
    width = max(faces.shape[1] for faces in blocks)
    nodes = np.full((len(positions), width), blocks[0][0, 0])
    values, distance = np.zeros((len(positions), width)), np.zeros(len(positions))
    hit = np.zeros(len(positions), dtype=bool)
    for rank in range(count):
        for number, faces in enumerate(blocks):
            left = np.flatnonzero(~hit & (block_of[near[:, rank]] == number))
            if not len(left):
                continue
            tried = faces[within[near[left, rank]]]
            along, shapes, _, facing = _cut(points[tried], positions[left], normals[left])
            good = _inside(tried, shapes) & facing & (np.abs(along) <= search_distance)
            chosen, columns = left[good], slice(0, faces.shape[1])
            hit[chosen], distance[chosen] = True, along[good]
            nodes[chosen, columns], values[chosen, columns] = tried[good], shapes[good]
    return nodes, values, distance, hit


def _inside(faces: Index, shapes: Array) -> Any:
    """Whether points with these shape functions (q, a) lie in the reference element, its edges included."""
    kind = FACES[faces.shape[1]]
    assert kind.shape.inside is not None
    return kind.shape.inside(shapes @ kind.nodes, 1e-6)


def _cut(faces: Array, targets: Array, normals: Array) -> tuple[Array, Array, Array, Any]:
    """Where lines cut curved element faces (q, a, 3), by Newton's method.

    Returns distance along the line (q,), shape functions (q, a) and unit normals (q, 3) of the face there, and whether
    it faces the line's start: not where the line runs along the face, so that there is no such place.
    """
    kind = FACES[faces.shape[1]]
    low, high = kind.shape.box
    guess = np.tile(np.mean(kind.shape.corners, axis=0), (len(faces), 1))
    along = np.zeros(len(faces))
    for _ in range(8):
        values, gradients = kind.at(guess.T)
        miss = np.einsum("qa,qai->qi", values, faces) - targets - along[:, None] * normals
        tangent = np.einsum("qai,qaj->qij", faces, gradients)
        jacobian = np.concatenate([tangent, -normals[:, :, None]], axis=2)
        flat = np.abs(np.linalg.det(jacobian)) < 1e-30
        jacobian[flat] = np.eye(3)
        step = np.linalg.solve(jacobian, miss[:, :, None])[:, :, 0]
        guess = np.clip(guess - step[:, :2], low, high)
        along = along - step[:, 2]
        if not len(step) or np.abs(step[:, :2]).max() < 1e-12:
            break
    normal = np.cross(tangent[..., 0], tangent[..., 1])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    facing = ~flat & (np.einsum("qi,qi->q", normal, normals) < 0)
    return along, kind.at(guess.T)[0], normal, facing
