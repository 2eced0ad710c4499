"""Faces that are welded or glued: the nodes of both become one where they match, else the faces are tied."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from faying.errors import InputError
from faying.fe.faces import face_centre
from faying.fe.interface import join
from faying.fe.sides import Blocks
from faying.fe.solids import SolidMesh
from faying.notes import Note
from faying.typing import Array, Index, Mask
from faying.units import show_area

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
    if abs(_area(mesh.points, mesh.face(faces[0]), on_both) - area) > SHARE * area:
        return None
    return np.stack([a[index[near]], b[near]])


def _area(points: Array, blocks: Blocks, nodes: Mask) -> float:
    """Area [m2] of those elements of a face whose nodes are all among some."""
    inside = tuple(block[np.all(nodes[block], axis=1)] for block in blocks)
    inside = tuple(block for block in inside if len(block))
    return face_centre(points, inside)[2] if inside else 0.0
