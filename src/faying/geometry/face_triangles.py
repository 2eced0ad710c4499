"""The named faces of a geometry before there is a mesh, as triangles."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from faying.errors import InputError
from faying.fe.sides import Blocks
from faying.geometry.face_facts import FaceFacts, GeometryFacts
from faying.typing import Array, Index


@dataclass(frozen=True, kw_only=True)
class FacePieces:
    """The triangles of one face: their middles (t, 3) [m], areas (t,) [m2] and normals out of the part (t, 3)."""

    positions: Array
    weights: Array
    normals: Array

    @property
    def area(self) -> float:
        """Area of the face [m2]."""
        return float(self.weights.sum())


@dataclass(frozen=True, kw_only=True)
class FaceTriangles:
    """Named faces of parts, curved ones by chords; what a mesh says of its faces, it says too.

    Args:
        points: corners (n, 3) [m].
        triangles: name of a face -> its triangles (t, 3), normals out of the part.
        face_part: name of a face -> name of its part.
        size: diagonal of the box around the whole [m].
    """

    points: Array
    triangles: Mapping[str, Index]
    face_part: Mapping[str, str]
    size: float

    @classmethod
    def of(cls, facts: GeometryFacts, named: Mapping[str, tuple[FaceFacts, ...]]) -> "FaceTriangles":
        """The triangles of the named faces; corners that coincide are one."""
        points, rows = welded(facts.corners, 1e-9 * facts.size)
        index = {face.side: k for k, face in enumerate(facts.faces)}
        triangles = {
            name: rows[np.isin(facts.face_of, [index[face.side] for face in faces])] for name, faces in named.items()
        }
        owner = {name: faces[0].part for name, faces in named.items()}
        return cls(points=points, triangles=triangles, face_part=owner, size=facts.size)

    def face(self, name: str) -> Blocks:
        """Triangles of a named face. Raises InputError that lists the faces there are."""
        if name not in self.triangles:
            raise InputError(
                f"no face is called {name!r}; the faces are {', '.join(map(repr, sorted(self.triangles)))}"
            )
        return (self.triangles[name],)

    def face_nodes(self, name: str) -> Index:
        """Corners of a named face, as rows of `points`. Raises InputError as `face`."""
        return np.unique(self.face(name)[0])

    def pieces(self, name: str) -> FacePieces:
        """The triangles of a named face. Raises InputError as `face`."""
        a, b, c = np.moveaxis(self.points[self.face(name)[0]], 1, 0)
        across = np.cross(b - a, c - a)
        twice = np.linalg.norm(across, axis=1)
        good = twice > 0
        middles = (a + b + c)[good] / 3
        return FacePieces(positions=middles, weights=twice[good] / 2, normals=across[good] / twice[good][:, None])


def welded(corners: Array, close: float) -> tuple[Array, Index]:
    """Points (n, 3) and triangles (t, 3) between them of corners (t, 3, 3) [m]; those nearer than `close` are one."""
    flat = corners.reshape(-1, 3)
    keys = np.round(flat / close).astype(np.int64)
    _, first, place = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return flat[first], place.reshape(-1, 3)
