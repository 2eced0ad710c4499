"""Elements whose curved edges fold them over themselves, made straight again."""

import numpy as np

from faying.fe.elements import SOLIDS
from faying.fe.solids import least_jacobian
from faying.typing import Array, Index, Mask

MIN_JACOBIAN = 0.01  # least determinant at the points of stiffness and mass over that of the straight element


def folded(points: Array, cells: Index) -> Mask:
    """Which tetrahedra of ten nodes (e, 10) have a map that folds, or nearly does."""
    straight = least_jacobian(points, cells[:, :4])
    return np.asarray(least_jacobian(points, cells, of_mass=True) <= MIN_JACOBIAN * np.abs(straight))


def straightened(points: Array, cells: Index) -> tuple[Array, int, Mask]:
    """Move middle nodes of folded tetrahedra onto their edges until none folds.

    A mesher curves the edges on a round face after it has placed the corners, so that the face can pass through a flat
    element. An edge that is made straight is straight for all elements around it.

    Args:
        points: Nodes (n, 3) [m].
        cells: Tetrahedra of ten nodes (e, 10) in VTK's order.

    Returns:
        The nodes, how many elements were made straight, and which elements (e,) have no volume even so.
    """
    points, touched = points.copy(), np.zeros(len(cells), dtype=bool)
    while True:
        wrong = folded(points, cells)
        fresh = wrong & ~touched
        if not np.any(fresh):
            return points, int(touched.sum()), wrong
        touched |= fresh
        ends = cells[fresh][:, np.array(SOLIDS[10].edges)]
        points[cells[fresh][:, 4:]] = points[ends].mean(axis=2)
