"""A sparse matrix times several vectors, by MKL where it is there: SciPy takes two to four times as long."""

import ctypes
from functools import cache
from typing import Any

import numpy as np

from faying.numerics.pardiso import mkl
from faying.numerics.solve import available
from faying.typing import Array

LARGE = 200_000  # entries from which it matters
ROWS = 4096  # whose sizes are taken at a time, so that they stay in the cache
PLAIN, BY_ROWS, GENERAL = 10, 101, 20  # as MKL numbers them: not transposed, vectors lie row by row, no symmetry used


class _Kind(ctypes.Structure):
    _fields_ = (("type", ctypes.c_int), ("mode", ctypes.c_int), ("diagonal", ctypes.c_int))


def product(matrix: Any, vectors: Array) -> Array:
    """A sparse matrix (n, k) times one vector (k,) or several (k, m), real or complex."""
    library = _library() if _suits(matrix, vectors) else None
    if library is None:
        return np.asarray(matrix @ vectors)
    rows, columns = matrix.shape
    right = np.ascontiguousarray(vectors)
    out = np.empty((rows, right.shape[1]))
    start = matrix.indptr.ctypes.data
    handle = ctypes.c_void_p()
    fault = library.mkl_sparse_d_create_csr(
        ctypes.byref(handle), 0, rows, columns, start, start + 4, matrix.indices.ctypes.data, matrix.data.ctypes.data
    )
    if fault:
        return np.asarray(matrix @ vectors)
    width = right.shape[1]
    sides = right.ctypes.data, width, width, 0.0, out.ctypes.data, width
    fault = library.mkl_sparse_d_mm(PLAIN, 1.0, handle, _Kind(GENERAL, 0, 0), BY_ROWS, *sides)
    library.mkl_sparse_destroy(handle)
    return np.asarray(matrix @ vectors) if fault else out


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


def _suits(matrix: Any, vectors: Array) -> bool:
    """Whether MKL can take the arrays as they are, and saves time."""
    if vectors.ndim != 2 or vectors.shape[1] < 2 or vectors.dtype != np.float64:
        return False
    if vectors.shape[0] != matrix.shape[1]:
        return False  # SciPy says so
    if getattr(matrix, "format", "") != "csr" or matrix.nnz < LARGE:
        return False
    places = matrix.indptr, matrix.indices
    return matrix.data.dtype == np.float64 and all(
        array.dtype == np.int32 and array.flags.c_contiguous for array in places
    )


@cache
def _library() -> Any | None:
    """MKL with the types of the functions that are called here; None where it is not installed."""
    if "pardiso" not in available():
        return None
    found, size, place = mkl(), ctypes.c_int, ctypes.c_void_p
    found.mkl_sparse_d_create_csr.argtypes = [place, *3 * [size], *4 * [place]]
    vectors = size, place, size, size, ctypes.c_double, place, size
    found.mkl_sparse_d_mm.argtypes = [size, ctypes.c_double, place, _Kind, *vectors]
    found.mkl_sparse_destroy.argtypes = [place]
    return found
