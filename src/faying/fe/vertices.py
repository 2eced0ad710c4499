"""The coarse space of a mesh of second order: displacements that are linear between the corners of its elements."""

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from faying.fe.elements import SOLIDS
from faying.fe.sides import at_points, edge_ends
from faying.fe.solids import SolidMesh
from faying.typing import Index


@final
@dataclass(frozen=True, kw_only=True)
class VertexRestriction:
    """The corners of the elements, and how all nodes move with them: the middle of an edge as the mean of its ends.

    Args:
        unknowns: those of the corners (m,), in the order of the nodes.
        spread: sparse (n, m), from displacements of the corners to those of all nodes [-].
    """

    unknowns: Index
    spread: Any

    @classmethod
    def of(cls, mesh: SolidMesh) -> "VertexRestriction | None":
        """The corners of a mesh; None where every node is one."""
        from scipy.sparse import kron

        ends = edge_ends(mesh.blocks, SOLIDS, len(mesh.points))
        corner = ends[:, 0] == ends[:, 1]
        if corner.all():
            return None
        number = np.cumsum(corner) - 1
        halves = at_points(number[ends], np.full(ends.shape, 0.5), int(corner.sum()))
        halves.sum_duplicates()
        unknowns = 3 * np.flatnonzero(corner)[:, None] + np.arange(3)
        return cls(unknowns=unknowns.ravel(), spread=kron(halves, np.eye(3), format="csr"))

    def of_matrix(self, matrix: Any) -> Any:
        """What a matrix (n, n) is on the corners, sparse (m, m)."""
        return (self.spread.T @ (matrix @ self.spread)).tocsr()
