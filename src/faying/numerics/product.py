"""Products of matrices that are sparse, or sums of such, with vectors, and combinations of vectors."""

from typing import Any

import numpy as np

from faying.typing import Array

ROWS = 4096  # whose sizes are taken at a time, so that they stay in the cache


def product(matrix: Any, vectors: Array) -> Array:
    """A matrix (n, k) times one vector (k,) or several (k, m), real or complex."""
    return np.asarray(matrix @ vectors)


def combined(vectors: Array, mix: Array) -> Array:
    """Combinations vectors @ mix (n, k) of columns (n, m), as columns in memory.

    OpenBLAS takes half of the time that it takes for rows, which NumPy asks for where the first matrix is long.
    """
    return np.asarray((mix.T @ vectors.T).T)


def product_of_sizes(matrix: Any, vector: Array) -> Array:
    """|A| |x| (n,) of a matrix (n, k), sparse or not, and a vector (k,), without a copy of a sparse matrix."""
    if getattr(matrix, "format", "") != "csr":
        return np.asarray(abs(matrix) @ np.abs(vector))
    size, starts = np.abs(vector), matrix.indptr
    out = np.empty(matrix.shape[0])
    for begin in range(0, len(out), ROWS):
        end = min(begin + ROWS, len(out))
        some = slice(starts[begin], starts[end])
        parts = np.abs(matrix.data[some]), matrix.indices[some], starts[begin : end + 1] - starts[begin]
        out[begin:end] = type(matrix)(parts, shape=(end - begin, len(size))) @ size
    return out
