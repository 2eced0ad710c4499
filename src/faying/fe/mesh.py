"""A mesh of named parts with named faces: second-order solid elements, nodes in metres."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from faying.errors import InputError

Array = NDArray[np.float64]
Index = NDArray[np.int64]

# node order of every kind is that of VTK: corners first, then the middles of the edges
CORNERS = {"tet10": 4, "tri6": 3}
EDGES = {
    "tet10": ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)),
    "tri6": ((0, 1), (1, 2), (0, 2)),
}


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """Nodes, the tetrahedra of each part, and the triangles of each named face.

    points [m], shape (n, 3); parts: name -> tet10 connectivity (e, 10); faces: name -> tri6 connectivity (f, 6), the
    normal of each triangle pointing out of its part; face_part: name of the face -> name of its part. No node is shared
    by two parts. Raises InputError for empty parts, elements of negative volume, and nodes that no element holds.
    """

    points: Array
    parts: Mapping[str, Index]
    faces: Mapping[str, Index]
    face_part: Mapping[str, str]
    source: str = field(default="")

    def __post_init__(self) -> None:
        if not self.parts:
            raise InputError("the mesh has no parts; a structure needs at least one solid")
        if not np.all(np.isfinite(self.points)):
            raise InputError(f"the mesh has {np.count_nonzero(~np.isfinite(self.points))} coordinates that are NaN")
        used = np.zeros(len(self.points), dtype=int)
        for name, cells in self.parts.items():
            if cells.size == 0:
                raise InputError(f"part {name!r} has no elements")
            here = np.unique(cells)
            if np.any(used[here]):
                raise InputError(f"part {name!r} shares nodes with another part; parts meet only through joints")
            used[here] = 1
            corners = self.points[cells[:, :4]]
            volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
            if np.any(volumes <= 0):
                raise InputError(f"part {name!r}: {np.count_nonzero(volumes <= 0)} elements have no or negative volume; "
                                 "repair the mesh or its node order")  # fmt: skip
        if not np.all(used):
            raise InputError(f"{np.count_nonzero(used == 0)} nodes belong to no element")

    @property
    def unknowns(self) -> int:
        """Number of displacement unknowns [-]: three per node."""
        return 3 * len(self.points)

    @cached_property
    def size(self) -> float:
        """Diagonal of the box around all nodes [m]."""
        return float(np.linalg.norm(np.ptp(self.points, axis=0)))

    def face(self, name: str) -> Index:
        """Triangles of a named face (f, 6). Raises InputError that lists the faces there are."""
        if name not in self.faces:
            raise InputError(f"no face is called {name!r}; the faces are {', '.join(map(repr, sorted(self.faces)))}")
        return self.faces[name]


def split_at_joints(
    points: Array,
    cells: Index,
    part_of_cell: NDArray[np.int64],
    triangles: Mapping[str, Index],
    triangle_part: Mapping[str, int],
) -> tuple[Array, Index, dict[str, Index]]:
    """Give each part nodes of its own where parts share them; returns new points, cells and triangles."""
    n = len(points)
    key = np.unique(part_of_cell[:, None] * n + cells)  # one node per (part, old node)
    new_cells = np.searchsorted(key, part_of_cell[:, None] * n + cells)
    faces = {name: np.searchsorted(key, triangle_part[name] * n + tri) for name, tri in triangles.items()}
    return points[key % n], new_cells.astype(np.int64), {k: v.astype(np.int64) for k, v in faces.items()}
