"""Where a joint lies: the least rectangle around it, with a longer and a shorter side."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from faying.errors import InputError
from faying.fe.interface import Interface
from faying.fe.line import across
from faying.fe.mesh import Mesh
from faying.geometry.face_triangles import FacePieces, FaceTriangles
from faying.typing import Array

Sides = tuple[float, float]
Faces = Mesh | FaceTriangles  # of a mesh, or of a geometry before there is one
SQUARE = 0.02  # relative difference of the sides below which neither is the longer one
CURVED = 0.87  # cosine between a face's normal and its mean below which shapes in a plane say nothing of it


@dataclass(frozen=True, kw_only=True)
class FaceAxes:
    """The rectangle of a joint: x along its longer side, y across, z along the normal from the first face.

    origin (3,) [m], the middle of the rectangle; x_axis, y_axis, normal (3,), unit vectors, y = normal x x;
    lengths: of the rectangle along x and y [m]; certain: whether x is known, as the longer side or because it was
    given; flat: whether the face is flat enough for shapes over the rectangle; spacing [m] between neighbouring nodes
    of the coarser face, which three quarters of its nodes within the rectangle do not exceed.
    """

    origin: Array
    x_axis: Array
    y_axis: Array
    normal: Array
    lengths: tuple[float, float]
    certain: bool
    flat: bool
    spacing: float

    @classmethod
    def of(
        cls,
        mesh: Faces,
        faces: tuple[str, str],
        interface: Interface | FacePieces,
        along: tuple[float, float, float] | None = None,
    ) -> Self:
        """Find the rectangle that both faces have in common; along: the direction of x in place of the longer side.

        The sides are those of the least rectangle around the smaller face, so that they do not depend on the mesh.
        Raises InputError where `along` stands on the face.
        """
        normal = interface.weights @ interface.normals
        normal = normal / np.linalg.norm(normal)
        flat = bool(np.min(interface.normals @ normal) > CURVED)
        plane = across(normal).T
        outlines = [mesh.points[mesh.face_nodes(face)] @ plane.T for face in faces]
        least = min((_least_rectangle(outline) for outline in outlines), key=lambda found: found[0])
        if along is None:
            x = least[1] @ plane
        else:
            given = np.array(along) - normal * (normal @ np.array(along))
            if np.linalg.norm(given) < 0.1 * np.linalg.norm(along):
                raise InputError(f"along = {list(along)} is at right angles to the faces {faces[0]!r} and {faces[1]!r}")
            x = given / np.linalg.norm(given)
        x, y, middle, sides = _box(mesh, faces, normal, x)
        certain = along is not None or abs(sides[0] / sides[1] - 1) > SQUARE
        if along is None and sides[1] > sides[0]:
            x, y, middle, sides = _box(mesh, faces, normal, y)
        depth = float(interface.weights @ (interface.positions @ normal) / interface.area)
        origin = middle[0] * x + middle[1] * y + depth * normal
        spacing = max(_spacing(mesh, face, np.stack([x, y]), middle, sides) for face in faces)
        return cls(
            origin=origin, x_axis=x, y_axis=y, normal=normal, lengths=sides, certain=certain, flat=flat, spacing=spacing
        )

    def check(self, what: str) -> None:
        """Raise InputError where the face has no longer side, or no plane, which `what` needs."""
        if not self.flat:
            raise InputError(f"{what} is a shape over a flat face, and this one is curved; give a measured map")
        if not self.certain:
            a, b = (f"{1e3 * side:.4g} mm" for side in self.lengths)
            raise InputError(
                f"{what} runs along the longer side of a face, and this one is as long as wide ({a} x {b}); say "
                "which way with along = [1, 0, 0], a direction in the axes of the model"
            )

    def local(self, positions: Array) -> Array:
        """Places (q, 2) [m] in the rectangle's own axes, from its middle."""
        return np.asarray((positions - self.origin) @ np.stack([self.x_axis, self.y_axis]).T)

    def steady(self, positions: Array) -> Array:
        """Places (q, 2) [m] from its middle, along axes that do not turn with the mesh or the order of the faces.

        x is that of the rectangle where its longer side is known; else an axis of the model, laid into the face.
        """
        x = self.x_axis
        if not self.certain:
            helper = np.eye(3)[np.argmin(np.round(np.abs(self.normal), 6))]
            x = helper - self.normal * (self.normal @ helper)
            x /= np.linalg.norm(x)
        return np.asarray((positions - self.origin) @ np.stack([x, np.cross(_upwards(self.normal), x)]).T)


def _upwards(direction: Array) -> Array:
    """A direction or its opposite (3,), the one whose largest component is above 0."""
    return np.asarray(direction * np.sign(direction[np.argmax(np.abs(direction) > np.abs(direction).max() - 1e-9)]))


def _box(mesh: Faces, faces: tuple[str, str], normal: Array, x: Array) -> tuple[Array, Array, Array, Sides]:
    """Axes, middle and sides of the box that both faces share along x; x points where its largest component is > 0."""
    x = _upwards(x)
    y = np.cross(normal, x)
    ends = [mesh.points[mesh.face_nodes(face)] @ np.stack([x, y]).T for face in faces]
    low = np.max([end.min(axis=0) for end in ends], axis=0)
    high = np.min([end.max(axis=0) for end in ends], axis=0)
    return x, y, (low + high) / 2, (float(high[0] - low[0]), float(high[1] - low[1]))


def _spacing(mesh: Faces, face: str, axes: Array, middle: Array, sides: Sides) -> float:
    """Distance [m] to the next node that three quarters of a face's nodes within the rectangle do not exceed."""
    from scipy.spatial import cKDTree

    nodes = mesh.points[mesh.face_nodes(face)]
    inside = np.all(np.abs(nodes @ axes.T - middle) <= np.array(sides) * (0.5 + 1e-6), axis=1)
    nodes = nodes[inside] if np.count_nonzero(inside) > 3 else nodes
    return float(np.quantile(cKDTree(nodes).query(nodes, k=2)[0][:, 1], 0.75))


def _least_rectangle(points: Array) -> tuple[float, Array]:
    """Area [m2] of the least rectangle around points (n, 2), and the direction of one of its sides (2,).

    One side lies on an edge of the convex hull (Freeman and Shapira 1975, doi:10.1145/360881.360919).
    """
    from scipy.spatial import ConvexHull

    corners = points[ConvexHull(points).vertices]
    edges = np.roll(corners, -1, axis=0) - corners
    edges /= np.linalg.norm(edges, axis=1)[:, None]
    across = np.stack([-edges[:, 1], edges[:, 0]], axis=1)
    areas = np.ptp(corners @ edges.T, axis=0) * np.ptp(corners @ across.T, axis=0)
    best = int(np.argmin(areas))
    return float(areas[best]), edges[best]
