"""What the named faces of a mesh are, in the words of the facts of CAD faces."""

from collections.abc import Mapping, Sequence

import numpy as np

from faying.fe.face_map import barycentric
from faying.fe.mesh import Mesh
from faying.fe.sides import face_centre, skin, triangles_of
from faying.geometry.face_facts import FaceFacts, GeometryFacts, PartFacts, point_of, shape_of
from faying.typing import Array


def mesh_facts(mesh: Mesh, points: Mapping[str, tuple[str, Sequence[float]]] | None = None) -> GeometryFacts:
    """Return the facts of a mesh; its faces are those with a name, numbered part by part in the order of the file.

    Args:
        mesh: the mesh.
        points: label -> (part, point [m]): the distance of each to the faces of its part is measured.
    """
    faces: list[FaceFacts] = []
    triangles, parts = [], []
    for part in mesh.parts:
        named = [name for name in mesh.faces if mesh.face_part[name] == part]
        nodes = {name: set(mesh.face_nodes(name).tolist()) for name in named}
        for k, name in enumerate(named):
            centre, _, area = face_centre(mesh.points, mesh.face(name))
            tris = mesh.points[triangles_of(mesh.face(name))]
            cross = np.cross(tris[:, 1] - tris[:, 0], tris[:, 2] - tris[:, 0])
            normals = np.repeat((cross / np.linalg.norm(cross, axis=1)[:, None])[:, None], 3, axis=1)
            near = tuple(j + 1 for j, other in enumerate(named) if j != k and len(nodes[name] & nodes[other]) > 1)
            faces.append(
                FaceFacts(
                    part=part,
                    number=k + 1,
                    name=name,
                    area=area,
                    centre=point_of(centre),
                    neighbours=near,
                    **shape_of(tris, normals, area),
                )
            )
            triangles.append(tris)
        parts.append(_part(mesh, part))
    distances = {
        label: [distance_to(np.array(at), one) for one, face in zip(triangles, faces, strict=True) if face.part == part]
        for label, (part, at) in (points or {}).items()
    }
    return GeometryFacts.of(parts, faces, triangles, file=mesh.source, distances=distances, notes=mesh.notes)


def _part(mesh: Mesh, part: str) -> PartFacts:
    outer = mesh.points[triangles_of(skin(mesh.parts[part], len(mesh.points)))]
    x, y, z = outer.transpose(1, 0, 2)
    volume = float(np.einsum("ti,ti->", x, np.cross(y, z))) / 6
    area = float(np.linalg.norm(np.cross(y - x, z - x), axis=1).sum()) / 2
    low, high = point_of(outer.min(axis=(0, 1))), point_of(outer.max(axis=(0, 1)))
    return PartFacts(name=part, volume=volume, area=area, low=low, high=high)


def distance_to(point: Array, corners: Array) -> float:
    """Distance [m] of a point to the nearest of some triangles (t, 3, 3)."""
    return float(nearest_places(point, corners)[1].min())


def nearest_places(point: Array, corners: Array) -> tuple[Array, Array]:
    """Place on each triangle (t, 3, 3) nearest to a point (3,): weights of its corners (t, 3), distance [m] (t,)."""
    foot = barycentric(corners, point)
    foot[(foot < 0).any(axis=1)] = np.eye(3)[0]  # beside the triangle: a corner, which the sides hold, too
    places = [foot]
    for first, second in ((0, 1), (1, 2), (2, 0)):
        along = corners[:, second] - corners[:, first]
        length = np.einsum("tx,tx->t", along, along)
        way = np.einsum("tx,tx->t", point - corners[:, first], along)
        share = np.clip(way / np.where(length > 0, length, 1.0), 0.0, 1.0)
        places.append(np.zeros_like(foot))
        places[-1][:, first], places[-1][:, second] = 1 - share, share
    weights = np.stack(places, axis=1)
    away = np.linalg.norm(weights @ corners - point, axis=2)
    best = np.arange(len(corners)), away.argmin(axis=1)
    return weights[best], away[best]
