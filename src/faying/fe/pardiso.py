"""Intel MKL's PARDISO, Cholesky of the upper triangle, called through the library that pypardiso finds."""

import ctypes
import sys
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faying.errors import InputError, NotConverged
from faying.fe.memory import check

Array = NDArray[np.float64]
ANALYSE, FACTORISE, SOLVE, FORGET = 11, 22, 33, -1
POSITIVE = 2  # the kind of matrix: real, symmetric, positive definite
SINGULAR = (-4, -7)  # a zero or negative pivot


@cache
def _library() -> Any:
    """The function pardiso of MKL; looking for the library takes longer than a small factorisation."""
    from pypardiso import PyPardisoSolver

    function = PyPardisoSolver()._mkl_pardiso
    function.argtypes = [ctypes.c_void_p] * 16
    return function


class Pardiso:
    """A factor of a symmetric positive definite CSR matrix with sorted indices.

    pypardiso's own call converts the indices and refines every solution in two more passes over the factor; here the
    indices are converted once and nothing is refined: those who iterate on it see their own residuals.
    """

    name = "PARDISO"

    def __init__(self, matrix: Any) -> None:
        matrix.sort_indices()
        self._size = matrix.shape[0]
        rows = np.repeat(np.arange(self._size, dtype=np.int32), np.diff(matrix.indptr))
        self._kept = matrix.indices >= rows
        counts = np.bincount(rows[self._kept], minlength=self._size)
        if np.any(counts == 0):
            raise NotConverged(
                f"{np.count_nonzero(counts == 0)} unknowns have no stiffness at all; is a part held by nothing?"
            )
        if self._kept.sum() > np.iinfo(np.int32).max:
            raise InputError("the matrix has more than 2^31 entries; use faying modes --slepc under mpiexec")
        self._starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
        self._columns = matrix.indices[self._kept].astype(np.int32)
        self._values = np.asarray(matrix.data[self._kept], dtype=float)
        self._state, self._iparm = np.zeros(64, dtype=np.int64), np.zeros(64, dtype=np.int32)
        iparm = self._iparm
        iparm[0] = 1  # the values below, not the library's
        iparm[1] = 3  # nested dissection (METIS)
        iparm[17] = -1  # report the entries of the factor
        iparm[34] = 1  # indices from 0
        self._call(ANALYSE)
        self.memory = max(float(iparm[14]), float(iparm[15]) + float(iparm[16])) * 1024
        try:
            check(self.memory, self._size, self.name)
        except InputError:
            self._call(FORGET)
            raise
        self._call(FACTORISE)

    def solve(self, right: Array) -> Array:
        """Solve for one right-hand side (n,) or several (n, m)."""
        b = np.asfortranarray(right, dtype=float)
        x: Array = np.empty_like(b, order="F")
        self._call(SOLVE, b, x)
        return x

    def again(self, matrix: Any) -> "Pardiso":
        """Factorise another matrix of the same pattern, indices sorted; the analysis is kept."""
        self._values = np.asarray(matrix.data[self._kept], dtype=float)
        self._call(FACTORISE)
        return self

    def _call(self, phase: int, b: Array | None = None, x: Array | None = None) -> None:
        def number(value: int) -> Any:
            return ctypes.byref(ctypes.c_int32(value))

        def place(values: Any) -> Any:
            return values.ctypes.data_as(ctypes.c_void_p)

        nothing, fault = np.zeros(1), ctypes.c_int32(0)
        columns = 1 if b is None or b.ndim == 1 else b.shape[1]
        _library()(
            place(self._state), number(1), number(1), number(POSITIVE), number(phase), number(self._size),
            place(self._values), place(self._starts), place(self._columns), place(np.zeros(1, dtype=np.int32)),
            number(columns), place(self._iparm), number(0), place(nothing if b is None else b),
            place(nothing if x is None else x), ctypes.byref(fault),
        )  # fmt: skip
        if fault.value == -2:
            raise InputError(f"PARDISO ran out of memory on {self._size:,} unknowns; take a coarser mesh, or faying modes "
                             "--slepc under mpiexec")  # fmt: skip
        if fault.value in SINGULAR:
            raise NotConverged(
                "PARDISO could not factorise the matrix: it is not positive definite; is a part held by nothing?"
            )
        if fault.value:
            raise NotConverged(f"PARDISO could not factorise the matrix (its error {fault.value})")

    def __del__(self) -> None:
        if hasattr(self, "_state") and not sys.is_finalizing():
            self._call(FORGET)
