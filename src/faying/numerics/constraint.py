"""Unknowns fixed at zero, without renumbering: their rows and columns give way to a diagonal."""

from typing import Any

import numpy as np

from faying.typing import Array, Index


def constrain(matrix: Any, fixed: Index, diagonal: float | None = None) -> Any:
    """Return a sparse CSR matrix with the rows and columns of `fixed` unknowns cleared.

    diagonal: what stands there instead, the mean of the diagonal where None (a stiffness), 0 for a mass or a loss:
    fixed unknowns then have no part in any mode.
    """
    matrix = matrix.tocsr()
    if not len(fixed):
        return matrix
    from scipy.sparse import diags_array

    n = matrix.shape[0]
    keep = np.ones(n)
    keep[fixed] = 0.0
    if diagonal is None:
        diagonal = float(matrix.diagonal().mean())
    sieve = diags_array(keep)
    return (sieve @ matrix @ sieve + diags_array((1 - keep) * diagonal)).tocsr()


def free_motions(rigid: Array, fixed: Index) -> Array:
    """Rigid motions (unknowns, r) out of the six of `rigid` that leave all fixed unknowns at rest."""
    if not len(fixed):
        return rigid
    _, size, right = np.linalg.svd(rigid[fixed], full_matrices=True)
    rank = int(np.count_nonzero(size > 1e-8 * size.max())) if len(size) else 0
    return np.asarray(rigid @ right[rank:].T)
