"""The coarse space of a mesh of second order: displacements that are linear between the corners of its elements."""

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from faying.fe.elements import SOLIDS
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
        from scipy.sparse import csr_array, kron

        n = len(mesh.points)
        ends = np.repeat(np.arange(n)[:, None], 2, axis=1)  # of the edge in whose middle a node lies; a corner is both
        for cells in mesh.blocks:
            kind = SOLIDS[cells.shape[1]]
            if kind.order == 2:
                ends[cells[:, kind.corners :]] = cells[:, np.array(kind.edges)]
        corner = ends[:, 0] == ends[:, 1]
        if corner.all():
            return None
        number = np.cumsum(corner) - 1
        halves = csr_array(
            (np.full(2 * n, 0.5), number[ends].ravel(), np.arange(0, 2 * n + 1, 2)), shape=(n, int(corner.sum()))
        )
        halves.sum_duplicates()
        unknowns = 3 * np.flatnonzero(corner)[:, None] + np.arange(3)
        return cls(unknowns=unknowns.ravel(), spread=kron(halves, np.eye(3), format="csr"))

    def of_matrix(self, matrix: Any) -> Any:
        """What a matrix (n, n) is on the corners, sparse (m, m)."""
        return (self.spread.T @ (matrix @ self.spread)).tocsr()
