"""Intel MKL's PARDISO, Cholesky of the upper triangle, called through the library that pypardiso finds."""

import ctypes
import sys
from functools import cache
from typing import Any

import numpy as np

from faying.errors import InputError, NotConverged
from faying.numerics.memory import check
from faying.typing import Array, Index

ANALYSE, FACTORISE, SOLVE, FORGET = 11, 22, 33, -1
BLOCK = 3  # unknowns of a node
FILLED = 0.7  # least share of entries in the blocks for which blocks are worth it
POSITIVE, INDEFINITE = 2, -2  # the kind of matrix: real, symmetric, positive definite or not
SINGULAR = (-4, -7)  # a zero or negative pivot


@cache
def _library() -> Any:
    """The function pardiso of MKL; looking for the library takes longer than a small factorisation."""
    from pypardiso.scipy_aliases import pypardiso_solver  # it has looked for the library already

    function = pypardiso_solver._mkl_pardiso
    function.argtypes = [ctypes.c_void_p] * 16
    return function


def mkl() -> Any:
    """MKL, as pypardiso has found it."""
    from pypardiso.scipy_aliases import pypardiso_solver

    return pypardiso_solver.libmkl


@cache
def handle(way: str) -> Any:
    """The function pardiso_handle_store or pardiso_handle_restore of MKL: (state, folder, fault)."""
    function = getattr(mkl(), f"pardiso_handle_{way}")
    function.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
    return function


def _in_blocks(matrix: Any) -> bool:
    """Whether the entries of a square CSR matrix come in blocks of three by three, by a sample of its rows."""
    size = matrix.shape[0]
    if size % BLOCK or not size:
        return False
    nodes = np.unique(np.linspace(0, size // BLOCK - 1, 500).astype(np.int64))
    blocks = entries = 0
    for node in nodes:
        columns = matrix.indices[matrix.indptr[BLOCK * node] : matrix.indptr[BLOCK * (node + 1)]]
        blocks += len(np.unique(columns // BLOCK))
        entries += len(columns)
    return entries >= FILLED * BLOCK**2 * blocks


class Pardiso:
    """A factor of a symmetric positive definite CSR matrix with sorted indices, in double or in single precision.

    pypardiso's own call converts the indices and refines every solution in two more passes over the factor; here the
    indices are converted once and nothing is refined: those who iterate on it see their own residuals.

    Args:
        matrix: the matrix, or a function that makes it, so that nobody holds it while it is factorised.
        kind: POSITIVE or INDEFINITE.
        single: whether in single precision.
        not_eliminated: unknowns (t,) that are not eliminated; None eliminates all.
    """

    name = "PARDISO"

    def __init__(
        self, matrix: Any, kind: int = POSITIVE, *, single: bool = False, not_eliminated: Index | None = None
    ) -> None:
        self._kind, self._type = kind, np.dtype(np.float32 if single else np.float64)
        if callable(matrix):
            matrix = matrix()
        matrix.sum_duplicates()  # and sorts the indices
        self._size = matrix.shape[0]
        self._block = BLOCK if not_eliminated is None and _in_blocks(matrix) else 1
        bare = np.flatnonzero(np.diff(matrix.indptr) == 0)
        if len(bare):
            raise NotConverged(f"{len(bare)} unknowns have no stiffness at all; is a part free to move?")
        blocks = self._in_nodes(matrix)
        rows = np.repeat(np.arange(len(blocks.indptr) - 1, dtype=np.int32), np.diff(blocks.indptr))
        self._upper = blocks.indices >= rows
        if self._upper.sum() * self._block**2 > np.iinfo(np.int32).max:
            raise InputError("the matrix has more than 2^31 entries; take a coarser mesh")
        counts = np.bincount(rows[self._upper], minlength=len(blocks.indptr) - 1)
        self._starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
        self._columns = blocks.indices[self._upper].astype(np.int32)
        self._values = np.asarray(blocks.data[self._upper], dtype=self._type).ravel()
        del matrix, blocks, rows
        self._state, self._iparm = np.zeros(64, dtype=np.int64), np.zeros(64, dtype=np.int32)
        iparm = self._iparm
        iparm[0] = 1  # the values below, not the library's
        iparm[1] = 3  # nested dissection (METIS)
        iparm[17] = -1  # report the entries of the factor
        iparm[27] = int(single)
        iparm[34] = 1  # indices from 0
        iparm[36] = self._block if self._block > 1 else 0  # blocks of one node: a third of the graph to order
        self._order = np.zeros(1 if not_eliminated is None else self._size, dtype=np.int32)
        if not_eliminated is not None:
            self._order[not_eliminated] = 1
            iparm[35] = 2  # a Schur complement, and solutions by halves
        self._call(ANALYSE)
        self.memory = max(float(iparm[14]), float(iparm[15]) + float(iparm[16])) * 1024
        try:
            check(self.memory, self._size, self.name)
        except InputError:
            self._call(FORGET)
            raise
        # what eliminating all others makes of the unknowns that are not_eliminated
        self.schur = np.zeros(
            (0, 0) if not_eliminated is None else (len(not_eliminated), len(not_eliminated)), dtype=self._type
        )
        self._call(FACTORISE, None if not_eliminated is None else np.zeros(self._size, dtype=self._type), self.schur)

    def solve(self, right: Array) -> Array:
        """Solve for one right-hand side (n,) or several (n, m)."""
        b = np.asfortranarray(right, dtype=self._type)
        x: Array = np.empty_like(b, order="F")
        self._call(SOLVE, b, x)
        return x.astype(float, copy=False)

    def again(self, matrix: Any) -> "Pardiso":
        """Factorise another matrix of the same pattern, indices sorted; the analysis is not_eliminated."""
        self._values = np.asarray(self._in_nodes(matrix).data[self._upper], dtype=self._type).ravel()
        self._call(FACTORISE)
        return self

    @property
    def negative(self) -> int:
        """Number of negative eigenvalues of an indefinite matrix."""
        return int(self._iparm[22])

    def _in_nodes(self, matrix: Any) -> Any:
        """The matrix in blocks of one node, in order."""
        blocks = matrix.tobsr((self._block, self._block))
        blocks.sort_indices()
        return blocks

    def _call(self, phase: int, b: Array | None = None, x: Array | None = None) -> None:
        def number(value: int) -> Any:
            return ctypes.byref(ctypes.c_int32(value))

        def place(values: Any) -> Any:
            return values.ctypes.data_as(ctypes.c_void_p)

        nothing, fault = np.zeros(1), ctypes.c_int32(0)
        columns = 1 if b is None or b.ndim == 1 else b.shape[1]
        _library()(
            place(self._state),
            number(1),
            number(1),
            number(self._kind),
            number(phase),
            number(self._size // self._block),
            place(self._values),
            place(self._starts),
            place(self._columns),
            place(self._order),
            number(columns),
            place(self._iparm),
            number(0),
            place(nothing if b is None else b),
            place(nothing if x is None else x),
            ctypes.byref(fault),
        )
        if fault.value == -2:
            raise InputError(f"PARDISO ran out of memory on {self._size:,} unknowns; take a coarser mesh")
        if fault.value in SINGULAR:
            raise NotConverged(
                "PARDISO could not factorise the matrix: it is not positive definite; is a part free to move?"
            )
        if fault.value:
            raise NotConverged(f"PARDISO could not factorise the matrix (its error {fault.value})")

    def __del__(self) -> None:
        if hasattr(self, "_state") and not sys.is_finalizing():
            self._call(FORGET)
