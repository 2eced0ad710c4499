"""The outer surface of a mesh as triangles that know their part and their named face."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faying.fe.elements import FACES
from faying.fe.sides import side_key, skin, triangles_of
from faying.fe.solids import SolidMesh
from faying.typing import Array, Index


@dataclass(frozen=True, kw_only=True)
class Outline:
    """Triangles between the corners of the outer element faces.

    Args:
        nodes: Nodes of the mesh (n,) that the triangles use, in rising order.
        triangles: Triangles (t, 3) as indices into `nodes`, normals outwards.
        part_of_triangle: Part of each (t,), by its position in `mesh.parts`.
        faces: Names of the faces; face_of_triangle: the named face of each triangle (t,), by its position in `faces`,
            -1 where it is on none.
    """

    nodes: Index
    triangles: Index
    part_of_triangle: Index
    faces: tuple[str, ...]
    face_of_triangle: Index


def outline(mesh: SolidMesh, first: Sequence[str] = ()) -> Outline:
    """Return the outer surface of a mesh.

    Args:
        mesh: The mesh.
        first: Names of faces that come before the others: a triangle on several faces is given to the first of them.
    """
    outer = skin(mesh.blocks, len(mesh.points))
    nodes, triangles = np.unique(triangles_of(outer), return_inverse=True)
    corners = nodes[triangles.reshape(-1, 3)]
    part_of_triangle = np.zeros(len(corners), dtype=np.int64)
    for number, name in enumerate(mesh.parts):
        mine = np.zeros(len(mesh.points), dtype=bool)
        mine[mesh.part_nodes(name)] = True
        part_of_triangle[np.all(mine[corners], axis=1)] = number  # bonded parts share nodes at their rim
    faces = tuple(dict.fromkeys([*first, *mesh.faces]))
    triangles = triangles.reshape(-1, 3).astype(np.int64)
    return Outline(
        nodes=nodes,
        triangles=triangles,
        part_of_triangle=part_of_triangle,
        faces=faces,
        face_of_triangle=np.concatenate(
            [np.tile(_named(mesh, sides, faces), FACES[sides.shape[1]].corners - 2) for sides in outer]
        ),
    )


def _named(mesh: SolidMesh, sides: Index, faces: Sequence[str]) -> Index:
    """The first of the faces that each element face lies on (f,), -1 where none."""
    key = side_key(sides, len(mesh.points))
    order = np.argsort(key)
    found = np.full(len(sides), -1, dtype=np.int64)
    for number, name in reversed(list(enumerate(faces))):
        for block in mesh.face(name):
            wanted = side_key(block, len(mesh.points))
            place = np.minimum(np.searchsorted(key[order], wanted), len(order) - 1)
            here = order[place]
            found[here[key[here] == wanted]] = number
    return found


def regions(points: Array, triangles: Index, apart: Index, *, angle: float = 0.7) -> Index:
    """Number smooth regions of a surface (t,), from 0: neighbours whose normals differ by less than an angle [rad].

    points (n, 3); triangles (t, 3); apart (t,): triangles of different numbers are never in one region.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    normal = normals(points, triangles)
    one, two = neighbours(triangles)
    alike = (apart[one] == apart[two]) & (np.einsum("ij,ij->i", normal[one], normal[two]) > np.cos(angle))
    count = len(triangles)
    graph = csr_array((np.ones(int(alike.sum())), (one[alike], two[alike])), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def normals(points: Array, triangles: Index) -> Array:
    """Unit normals (t, 3) of triangles; zero where a triangle has no area."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    return np.asarray(normal / np.where(size > 0, size, 1.0)[:, None])


def edges_of(triangles: Index) -> tuple[Index, Index, Index]:
    """Edges (e, 2), each once, with the first and the last triangle on each (e,); both the same at a rim."""
    corners = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    edges, inverse = np.unique(corners, axis=0, return_inverse=True)
    owner = np.repeat(np.arange(len(triangles)), 3)
    first, last = np.full(len(edges), len(triangles)), np.full(len(edges), -1)
    np.minimum.at(first, inverse.ravel(), owner)
    np.maximum.at(last, inverse.ravel(), owner)
    return edges, first, last


def neighbours(triangles: Index) -> tuple[Index, Index]:
    """Pairs of triangles that share an edge."""
    _, first, last = edges_of(triangles)
    inside = first != last
    return first[inside], last[inside]
