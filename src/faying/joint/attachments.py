"""Supports of a structure and masses that hang on it."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.errors import InputError
from faying.fe.attach import mean_motion
from faying.fe.mesh import Mesh
from faying.fe.sides import face_centre, sampled
from faying.misuse import checked_call
from faying.typing import Array, Index

AXES: dict[str, int] = {"x": 0, "y": 1, "z": 2}
# of the structure's size: farther from any node than this, a point of the study is taken for a mistake
MAX_DISTANCE = 0.02


@checked_call
@dataclass(frozen=True, kw_only=True)
class Support:
    """A face that is fixed, or on springs per area, in some directions; or an edge or a point of it that is fixed.

    Args:
        face: Name of the face.
        directions: Some of x, y, z.
        stiffness: Springs per area [Pa/m], greater than 0; the face is fixed where None.
        edge: Name of another face: only the edge where the two meet is fixed.
        point: Place (3,) [m]: only the node of the face, or of the edge, that is nearest to it is fixed.

    Raises:
        InputError: Another direction, a stiffness that is not positive, or one of an edge or a point.
    """

    face: str
    directions: tuple[str, ...] = ("x", "y", "z")
    stiffness: float | None = None
    edge: str | None = None
    point: tuple[float, float, float] | None = None

    def __post_init__(self) -> None:
        wrong = [axis for axis in self.directions if axis not in AXES]
        if wrong or not self.directions:
            raise InputError(f"support of {self.face!r}: directions {list(self.directions)} should be some of x, y, z")
        if self.stiffness is not None and not self.stiffness > 0:
            raise InputError(f"support of {self.face!r}: stiffness {self.stiffness:g} Pa/m must be positive")
        if self.edge == self.face:
            raise InputError(f"support of {self.face!r}: edge names the same face; name the one that meets it there")
        if self.stiffness is not None and not self.whole:
            raise InputError(f"support of {self.face!r}: stiffness is per area; leave it out with edge or point")

    @property
    def whole(self) -> bool:
        """Whether all of the face is held."""
        return self.edge is None and self.point is None

    def nodes(self, mesh: Mesh) -> Index:
        """The nodes that are held (k,). Raises InputError where the faces share no edge, or the point is far away."""
        nodes = mesh.face_nodes(self.face)
        if self.edge is not None:
            nodes = np.intersect1d(nodes, mesh.face_nodes(self.edge))
            if not len(nodes):
                raise InputError(f"support: the faces {self.face!r} and {self.edge!r} share no edge; name two that do")
        if self.point is not None:
            nodes = nodes[[nearest(mesh.points[nodes], self.point, mesh.size, f"support of {self.face!r}")]]
        return nodes

    def fixed(self, mesh: Mesh) -> Index:
        """Unknowns that are fixed; none for springs."""
        if self.stiffness is not None:
            return np.zeros(0, dtype=np.int64)
        nodes = self.nodes(mesh)
        return np.sort((3 * nodes[:, None] + np.array([AXES[axis] for axis in self.directions])).ravel())

    def springs(self, mesh: Mesh) -> Any | None:
        """Sparse stiffness [N/m] of springs per area; None for a face that is fixed."""
        if self.stiffness is None:
            return None
        from scipy.sparse import coo_array

        rows, columns, entries = [], [], []
        for faces, values, _, _, share in sampled(mesh.points, mesh.face(self.face)):
            block = self.stiffness * np.einsum("fq,qa,qb->fab", share, values, values)
            a = faces.shape[1]
            for axis in self.directions:
                rows.append(np.repeat(3 * faces + AXES[axis], a, axis=1).ravel())
                columns.append(np.tile(3 * faces + AXES[axis], (1, a)).ravel())
                entries.append(block.ravel())
        n = mesh.unknowns
        where = np.concatenate(rows), np.concatenate(columns)
        return coo_array((np.concatenate(entries), where), shape=(n, n)).tocsr()


@checked_call
@dataclass(frozen=True, kw_only=True)
class PointMass:
    """A mass that follows the mean motion of a face, or the node nearest to a point.

    Args:
        mass: Mass [kg], greater than 0.
        face: Name of the face, or None.
        point: Place (3,) [m] of the node, in place of a face.
        offset: Vector (3,) [m] from the face's centre to the centre of the mass; its inertia about that is left out.

    Raises:
        InputError: The mass is not positive, or both or neither of face and point are given.
    """

    mass: float
    face: str | None = None
    point: tuple[float, float, float] | None = None
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if not self.mass > 0:
            raise InputError(f"point mass {self.mass:g} kg must be positive")
        if (self.face is None) == (self.point is None):
            raise InputError("a point mass sits on a face or at a point; give one of the two")
        if self.point is not None and any(self.offset):
            raise InputError("offset is from the centre of a face, and this point mass sits at a point; leave one out")

    def matrix(self, mesh: Mesh) -> Any:
        """Sparse mass matrix [kg] (unknowns, unknowns)."""
        from scipy.sparse import csr_array

        n = mesh.unknowns
        if self.point is not None:
            node = nearest_node(mesh, self.point, f"point mass of {self.mass:g} kg")
            at = 3 * node + np.arange(3)
            return csr_array((np.full(3, self.mass), (at, at)), shape=(n, n))
        assert self.face is not None
        centre, _, _ = face_centre(mesh.points, mesh.face(self.face))
        moved = mean_motion(mesh.points, mesh.face(self.face), centre + np.array(self.offset))[:3]
        return (self.mass * moved.T @ moved).tocsr()


def nearest_node(mesh: Mesh, point: tuple[float, float, float], what: str) -> int:
    """Index of the node nearest to a point [m]. Raises InputError where none is near."""
    return nearest(mesh.points, point, mesh.size, what)


def nearest(places: Array, point: tuple[float, float, float], size: float, what: str) -> int:
    """Index of the place (n, 3) nearest to a point [m]. Raises InputError where it is far for a size [m]."""
    distance = np.linalg.norm(places - np.array(point), axis=1)
    node = int(np.argmin(distance))
    if distance[node] > MAX_DISTANCE * size:
        raise InputError(too_far(what, point, float(distance[node]), places.min(axis=0), places.max(axis=0)))
    return node


def too_far(what: str, point: tuple[float, float, float], distance: float, low: Array, high: Array) -> str:
    """What is said of a point [m] at some distance [m] from a structure between two corners [m]."""
    at, first, last = (", ".join(f"{1e3 * x:.4g}" for x in corner) for corner in (point, low, high))
    return (
        f"{what}: the nearest node to ({at}) mm is {1e3 * distance:.3g} mm away; the structure is between ({first}) "
        f"and ({last}) mm; check the point and its unit, or mesh finer"
    )
