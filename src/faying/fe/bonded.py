"""Faces that are welded or glued: the nodes of both become one where they match, else the faces are tied.

Ties hold means of the jump of the displacements, as mortar elements do, weighted with the linear functions of the
corners of the finer face. Each mean is held by a spring that is far stiffer than the parts. Fewer conditions than nodes
leave quadratic faces free to fit each other, where a condition at every point would lock them.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from faying.errors import InputError
from faying.fe.elements import FACES
from faying.fe.interface import Interface, join
from faying.fe.sides import Blocks, at_points, edge_ends, sampled
from faying.fe.solids import SolidMesh
from faying.notes import Note
from faying.typing import Array, Index
from faying.units import show_area

STIFF = 1e5  # times E over the size of the mesh: the stiffness per area of a tie [Pa/m]
NO_GAP = 1e-12  # of the size of the mesh: faces that lie no farther apart turn about the same points


def tie_stiffness(mesh: SolidMesh, faces: tuple[str, str], modulus: float) -> Any:
    """Stiffness [N/m] (unknowns, unknowns) that ties two faces where they meet; rigid motions of both cost nothing.

    Args:
        mesh: The parts and their faces.
        faces: Names of two faces on two parts.
        modulus: E of the stiffer part [Pa].

    Raises:
        InputError: The faces do not meet.

    Source:
        M.A. Puso, T.A. Laursen, "A mortar segment-to-segment contact method for large deformation solid mechanics",
        Comput. Methods Appl. Mech. Eng. 193 (2004) 601-629, doi:10.1016/j.cma.2003.10.010: integrals over the overlaps
        of element faces.
    """
    from scipy.sparse import diags_array, kron

    first, second = faces
    if len(corners_of(mesh.face(second))) > len(corners_of(mesh.face(first))):
        first, second = second, first
    met = join(mesh, first, second)
    hats = _hats(met, mesh.face(first), len(mesh.points))
    area = np.asarray(hats.sum(axis=0)).ravel()
    kept = area > 0
    means = (kron(hats.T.tocsr()[kept], np.eye(3)) @ _jump(mesh, met)).tocsr()
    share = np.repeat(STIFF * modulus / mesh.size / area[kept], 3)
    return (means.T @ diags_array(share) @ means).tocsr()


def corners_of(blocks: Blocks) -> Index:
    """Nodes of a face that are corners of its elements, each once."""
    return np.unique(np.concatenate([block[:, : FACES[block.shape[1]].corners].ravel() for block in blocks]))


def _hats(met: Interface, blocks: Blocks, count: int) -> Any:
    """Area of each point times the linear functions of the corners of the first face (q, n) [m2]."""
    # a linear function is 1/2 at the middles of the edges of its corner
    spread = at_points(edge_ends(blocks, FACES, count), np.full((count, 2), 0.5), count)
    return (at_points(met.first_nodes, met.weights[:, None] * met.first_values, count) @ spread).tocsr()


def _jump(mesh: SolidMesh, met: Interface) -> Any:
    """Displacement of the second face minus that of the first (3q, unknowns), both at the place of the second."""
    from scipy.sparse import kron

    n = len(mesh.points)
    jump = at_points(met.second_nodes, met.second_values, n) - at_points(met.first_nodes, met.first_values, n)
    whole = kron(jump, np.eye(3)).tocsr()
    if np.abs(met.gap).max() <= NO_GAP * mesh.size:
        return whole
    return whole - _turned(mesh.points, met)


def _turned(points: Array, met: Interface) -> Any:
    """What the rotation of the first face adds to its displacement across the gap (3q, unknowns).

    The rotation is that of the triangle of the first three corners of each element: exact for rigid motions.
    """
    from scipy.sparse import csr_array

    corners = met.first_nodes[:, :3]
    x = points[corners]
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    twice = np.linalg.norm(normal, axis=1)
    normal /= twice[:, None]
    # gradients of the linear functions of the triangle: the opposite edge turned inwards, over twice the area
    slopes = np.stack([np.cross(normal, x[:, (c + 2) % 3] - x[:, (c + 1) % 3]) for c in range(3)], axis=1)
    slopes /= twice[:, None, None]
    rotation = np.einsum("qci,qj->qcij", np.cross(slopes, normal[:, None]), normal)
    rotation += 0.5 * np.einsum("qi,qcj->qcij", normal, np.cross(normal[:, None], slopes))
    arm = met.gap[:, None] * met.normals
    # rotation x arm, column by column
    moved = np.cross(rotation, arm[:, None, :, None], axisa=2, axisb=2, axisc=2)
    rows = np.broadcast_to(3 * np.arange(len(corners))[:, None, None, None] + np.arange(3)[:, None], moved.shape)
    columns = np.broadcast_to(3 * corners[:, :, None, None] + np.arange(3), moved.shape)
    shape = (3 * len(corners), 3 * len(points))
    return csr_array((moved.ravel(), (rows.ravel(), columns.ravel())), shape=shape)


M = TypeVar("M", bound=SolidMesh)
CLOSE = 1e-6  # of the size of the mesh: nodes nearer than this are one
SHARE = 1e-3  # of the area over which faces meet: how much of it may lack nodes that match


def bonded_mesh(mesh: M, pairs: Sequence[tuple[str, tuple[str, str]]], *, snap: float = 0.0) -> M:
    """Merge the nodes of faces that are bonded, and tie those whose nodes do not match.

    Args:
        mesh: the parts and their faces.
        pairs: name of each bond, for messages, and the names of its two faces, on two parts.
        snap: nodes that lie no farther apart than this are one, too [m].

    Raises:
        InputError: a face does not exist, both are on one part, or they do not meet.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    if not pairs:
        return mesh
    n = len(mesh.points)
    ends, ties, notes = [np.zeros((2, 0), dtype=np.int64)], [], []
    for name, faces in pairs:
        for face in faces:
            mesh.face(face)  # raises where there is none
        if mesh.face_part[faces[0]] == mesh.face_part[faces[1]]:
            part = mesh.face_part[faces[0]]
            raise InputError(f"joint {name!r}: both faces are on part {part!r}; a bond needs two parts")
        area = join(mesh, *faces).area  # raises where they do not meet
        met = matched(mesh, faces, area, max(snap, CLOSE * mesh.size))
        text = f"{name}: {faces[0]} and {faces[1]} are bonded over {show_area(area)}: no pressure, no law"
        if met is None:
            ties.append(faces)
            text += "; their nodes do not match, so that means over the finer elements hold them together"
        else:
            ends.append(met)
        notes.append(Note(code="bonded", joint=name, text=text))
    one, two = np.concatenate(ends, axis=1)
    _, column = connected_components(csr_array((np.ones(len(one)), (one, two)), shape=(n, n)), directed=False)
    _, first = np.unique(column, return_index=True)

    def moved(blocks: Blocks) -> Blocks:
        return tuple(column[block].astype(np.int64) for block in blocks)

    return replace(
        mesh,
        points=mesh.points[first],
        parts={part: moved(blocks) for part, blocks in mesh.parts.items()},
        faces={face: moved(blocks) for face, blocks in mesh.faces.items()},
        node_numbers=None if mesh.node_numbers is None else mesh.node_numbers[first],
        turned=None if mesh.turned is None else mesh.turned[first],
        bonded=(*mesh.bonded, *((mesh.face_part[a], mesh.face_part[b]) for _, (a, b) in pairs)),
        ties=(*mesh.ties, *ties),
        notes=(*mesh.notes, *notes),
    )


def matched(mesh: SolidMesh, faces: tuple[str, str], area: float, close: float) -> Index | None:
    """Nodes (2, m) of two faces that lie on each other; None where the nodes of some of what meets do not match.

    Args:
        mesh: the parts and their faces.
        faces: names of both.
        area: over which the faces meet [m2].
        close: nodes nearer than this are one [m].
    """
    from scipy.spatial import cKDTree

    a, b = (mesh.face_nodes(face) for face in faces)
    distance, index = cKDTree(mesh.points[a]).query(mesh.points[b])
    near = distance <= close
    on_both = np.zeros(len(mesh.points), dtype=bool)
    on_both[a[index[near]]] = True
    inside = tuple(block[on_both[block].all(axis=1)] for block in mesh.face(faces[0]))
    matching = sum(float(share.sum()) for *_, share in sampled(mesh.points, inside))
    if abs(matching - area) > SHARE * area:
        return None
    return np.stack([a[index[near]], b[near]])
