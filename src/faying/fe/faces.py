"""Centres and normals on faces of any elements, flat or curved."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from faying.fe.elements import FACES
from faying.fe.sides import Blocks
from faying.typing import Array, Index


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
