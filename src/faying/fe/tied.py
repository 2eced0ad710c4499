"""Faces that are welded or glued and whose meshes do not match: tied by means of their jump, as mortar elements do.

The jump of the displacements is weighted with the linear functions of the corners of one face, those of the finer one.
Each mean is held by a spring that is far stiffer than the parts. Fewer conditions than nodes leave quadratic faces free
to fit each other, where a condition at every point would lock them.
"""

from typing import Any

import numpy as np

from faying.fe.elements import FACES
from faying.fe.interface import Interface, join
from faying.fe.sides import Blocks
from faying.fe.solids import SolidMesh
from faying.typing import Array, Index

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
    from scipy.sparse import csr_array

    q = len(met.weights)
    values = (met.weights[:, None] * met.first_values).ravel()
    pointer = np.arange(q + 1) * met.first_nodes.shape[1]
    at_nodes = csr_array((values, met.first_nodes.ravel(), pointer), shape=(q, count))
    # a linear function is 1/2 at the middles of the edges of its corner
    rows, columns, halves = [corners_of(blocks)], [corners_of(blocks)], [np.ones(len(corners_of(blocks)))]
    seen: list[Index] = []
    for block in blocks:
        kind = FACES[block.shape[1]]
        if kind.order == 1:
            continue
        ends = block[:, np.array(kind.edges)].reshape(-1, 2)
        seen.append(np.column_stack([block[:, kind.corners :].ravel(), ends]))
    if seen:
        edges = np.unique(np.concatenate(seen), axis=0)
        _, once = np.unique(edges[:, 0], return_index=True)  # the edge of two elements, in either direction
        edges = edges[once]
        rows += [edges[:, 0], edges[:, 0]]
        columns += [edges[:, 1], edges[:, 2]]
        halves += [np.full(2 * len(edges), 0.5)]
    spread = csr_array((np.concatenate(halves), (np.concatenate(rows), np.concatenate(columns))), shape=(count, count))
    return (at_nodes @ spread).tocsr()


def _jump(mesh: SolidMesh, met: Interface) -> Any:
    """Displacement of the second face minus that of the first (3q, unknowns), both at the place of the second."""
    from scipy.sparse import csr_array, kron

    q, n = len(met.weights), len(mesh.points)

    def at(nodes: Index, values: Array) -> Any:
        return csr_array((values.ravel(), nodes.ravel(), np.arange(q + 1) * nodes.shape[1]), shape=(q, n))

    jump = at(met.second_nodes, met.second_values) - at(met.first_nodes, met.first_values)
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
