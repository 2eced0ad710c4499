"""Sides of solid elements: which lie on the outside, which of them make up a face; centres and normals."""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from faying.fe.elements import FACES, SOLIDS, Element
from faying.typing import Array, Index

Blocks = tuple[Index, ...]


def all_sides(cells: Index) -> Blocks:
    """Nodes (f, a) of the sides of a block of elements, kind by kind."""
    sides = SOLIDS[cells.shape[1]].sides
    counts = sorted({len(side) for side in sides})
    return tuple(cells[:, [side for side in sides if len(side) == count]].reshape(-1, count) for count in counts)


def side_key(faces: Index, nodes: int) -> Index:
    """One number per face, the same for faces with the same corners whatever their order; nodes: how many there are."""
    corners = np.sort(faces[:, : FACES[faces.shape[1]].corners], axis=1)
    return np.asarray((corners[:, 0] * nodes + corners[:, 1]) * nodes + corners[:, 2])


def skin(blocks: Blocks, nodes: int) -> Blocks:
    """Sides that belong to one element only, normals outwards, kind by kind."""
    sides = [side for block in blocks for side in all_sides(block)]
    outer = []
    for kind in sorted({side.shape[1] for side in sides}):
        faces = np.concatenate([side for side in sides if side.shape[1] == kind])
        _, first, count = np.unique(side_key(faces, nodes), return_index=True, return_counts=True)
        outer.append(faces[np.sort(first[count == 1])])
    return tuple(faces for faces in outer if len(faces))


def triangles_of(blocks: Blocks) -> Index:
    """Triangles between the corners of faces (t, 3), for pictures."""
    out = [
        faces[:, corners] for faces in blocks for corners in ([0, 1, 2], [0, 2, 3])[: FACES[faces.shape[1]].corners - 2]
    ]
    return np.concatenate(out)


def nodes_of(blocks: Blocks) -> Index:
    """Nodes that the elements of all blocks hold, each once, in rising order."""
    return np.unique(np.concatenate([block.ravel() for block in blocks]))


def padded(blocks: Sequence[tuple[Index, Array]]) -> tuple[Index, Array]:
    """Put nodes (q, a) and values (q, a) of several kinds into one table; what is missing gets the value 0."""
    width = max(nodes.shape[1] for nodes, _ in blocks)
    nodes = [np.concatenate([n, np.repeat(n[:, :1], width - n.shape[1], axis=1)], axis=1) for n, _ in blocks]
    values = [np.pad(v, ((0, 0), (0, width - v.shape[1]))) for _, v in blocks]
    return np.concatenate(nodes), np.concatenate(values)


def at_points(nodes: Index, values: Array, count: int) -> Any:
    """Sparse operator (q, count) from nodes to points, by the shape functions `values` (q, a) of their `nodes`."""
    from scipy.sparse import csr_array

    q, a = values.shape
    return csr_array((values.ravel(), nodes.ravel(), a * np.arange(q + 1)), shape=(q, count))


def edge_ends(blocks: Blocks, kinds: Mapping[int, Element], count: int) -> Index:
    """Nodes (n, 2) between which each lies half-way: the ends of the edge that it is on, or a corner twice."""
    ends = np.repeat(np.arange(count)[:, None], 2, axis=1)
    for block in blocks:
        kind = kinds[block.shape[1]]
        if kind.order == 2:
            ends[block[:, kind.corners :]] = block[:, np.array(kind.edges)]
    return ends


class NamedFaces(Protocol):
    """Faces with names on parts: those of a mesh, or the outline of a geometry before there is one."""

    @property
    def points(self) -> Array:
        """Nodes (n, 3) [m]."""
        ...

    @property
    def face_part(self) -> Mapping[str, str]:
        """Name of a face -> name of its part."""
        ...

    @property
    def size(self) -> float:
        """Diagonal of the box around all of it [m]."""
        ...

    def face(self, name: str) -> Blocks:
        """Blocks of a named face, each (f, a)."""
        ...


def surface_frame(points: Array, faces: Index, gradients: Array) -> tuple[Array, Array]:
    """Unit normals (f, q, 3) and area per reference area (f, q) on curved element faces of one kind."""
    tangent = np.einsum("fai,qaj->fqij", points[faces], gradients, optimize=True)
    normal = np.cross(tangent[..., 0], tangent[..., 1])
    area = np.linalg.norm(normal, axis=-1)
    return normal / area[..., None], area


def sampled(points: Array, blocks: Blocks) -> list[tuple[Index, Array, Array, Array, Array]]:
    """Per block: the element faces, shape functions (q, a), places (f, q, 3), normals (f, q, 3) and areas (f, q)."""
    out = []
    for faces in blocks:
        _, weights, values, gradients = FACES[faces.shape[1]].face_rule
        normals, area = surface_frame(points, faces, gradients)
        out.append((faces, values, np.einsum("fai,qa->fqi", points[faces], values), normals, area * weights))
    return out


def face_centre(points: Array, blocks: Blocks) -> tuple[Array, Array, float]:
    """Centre [m] (3,), mean unit normal (3,), and area [m2] of a face."""
    samples = sampled(points, blocks)
    area = float(sum(share.sum() for *_, share in samples))
    centre = sum(np.einsum("fq,fqi->i", share, place) for _, _, place, _, share in samples) / area
    normal = np.sum([np.einsum("fq,fqi->i", share, normals) for _, _, _, normals, share in samples], axis=0)
    return np.asarray(centre), normal / np.linalg.norm(normal), area
