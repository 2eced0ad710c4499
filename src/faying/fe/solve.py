"""Factorisations behind one interface; the best one found at run time is taken and reported."""

import os
import sys
from collections.abc import Callable
from functools import cache
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from faying.errors import InputError, NotConverged

Array = NDArray[np.float64]


class Factorisation(Protocol):
    """A factorised symmetric positive definite matrix."""

    name: str

    def solve(self, right: Array) -> Array:
        """Solve for one right-hand side (n,) or several (n, m)."""

    def again(self, matrix: Any) -> "Factorisation":
        """Factorise another matrix with the same pattern, both CSR with sorted indices; the analysis is kept if it can."""


class _Pardiso:
    """Intel MKL's PARDISO through pypardiso, as Cholesky of the upper triangle."""

    name = "PARDISO"

    def __init__(self, matrix: Any) -> None:
        from pypardiso import PyPardisoSolver
        from scipy.sparse import csr_matrix, triu

        self._upper = csr_matrix(triu(matrix, format="csr"))
        self._upper.sort_indices()
        self._kept: Any = None
        self._solver = PyPardisoSolver(mtype=2)
        self._solver._check_A(self._upper)
        self._solver.set_phase(12)
        try:
            self._solver._call_pardiso(self._upper, np.zeros((matrix.shape[0], 1)))
        except Exception as fault:
            raise NotConverged(
                f"PARDISO could not factorise the matrix ({fault}); is a part held by nothing?"
            ) from None
        # pypardiso's solve() compares the whole matrix with the factorised one at every call, which costs more than
        # solving; the phase is set here instead
        self._solver.set_phase(33)

    def solve(self, right: Array) -> Array:
        x: Array = self._solver._call_pardiso(self._upper, np.asfortranarray(right))
        return x.reshape(right.shape)

    def again(self, matrix: Any) -> "_Pardiso":
        if self._kept is None:
            self._kept = matrix.indices >= np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
        self._upper.data[:] = matrix.data[self._kept]
        self._solver.set_phase(22)
        try:
            self._solver._call_pardiso(self._upper, np.zeros((matrix.shape[0], 1)))
        except Exception as fault:
            raise NotConverged(f"PARDISO could not factorise the matrix ({fault})") from None
        self._solver.set_phase(33)
        return self

    def __del__(self) -> None:
        solver = getattr(self, "_solver", None)
        if solver is not None and not sys.is_finalizing():
            solver.free_memory(everything=True)


class _Mumps:
    """MUMPS through python-mumps."""

    name = "MUMPS"

    def __init__(self, matrix: Any) -> None:
        import mumps

        self._context = mumps.Context()
        self._context.set_matrix(matrix.tocoo(), symmetric=True)
        self._context.factor()

    def again(self, matrix: Any) -> "_Mumps":
        return _Mumps(matrix)

    def solve(self, right: Array) -> Array:
        if right.ndim == 2:
            return np.column_stack([self._context.solve(column.copy()) for column in right.T])
        return np.asarray(self._context.solve(right.copy()))


class _Cholmod:
    """CHOLMOD through scikit-sparse (GPL: only where the user has installed it)."""

    name = "CHOLMOD"

    def __init__(self, matrix: Any) -> None:
        from scipy.sparse import csc_matrix
        from sksparse.cholmod import cholesky

        self._factor = cholesky(csc_matrix(matrix))

    def again(self, matrix: Any) -> "_Cholmod":
        return _Cholmod(matrix)

    def solve(self, right: Array) -> Array:
        return np.asarray(self._factor(right))


class _SuperLU:
    """SciPy's SuperLU: always there, slow and hungry on solids."""

    name = "SuperLU"

    def __init__(self, matrix: Any) -> None:
        from scipy.sparse.linalg import splu

        try:
            self._factor = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
                                options={"SymmetricMode": True})  # fmt: skip
        except RuntimeError as fault:
            raise NotConverged(
                f"SuperLU could not factorise the matrix ({fault}); is a part held by nothing?"
            ) from None

    def again(self, matrix: Any) -> "_SuperLU":
        return _SuperLU(matrix)

    def solve(self, right: Array) -> Array:
        return np.asarray(self._factor.solve(right))


_MODULE = {"pardiso": "pypardiso", "mumps": "mumps", "cholmod": "sksparse.cholmod", "superlu": "scipy"}
_BACKENDS: dict[str, Callable[[Any], Factorisation]] = {
    "pardiso": _Pardiso,
    "mumps": _Mumps,
    "cholmod": _Cholmod,
    "superlu": _SuperLU,
}


@cache
def available() -> tuple[str, ...]:
    """Names of the factorisations that can be used here, fastest first; one that is installed but broken is left out."""
    from importlib import import_module

    def works(module: str) -> bool:
        try:
            import_module(module)
        except Exception:
            return False
        return True

    return tuple(name for name, module in _MODULE.items() if works(module))


def chosen(name: str | None = None) -> str:
    """Return the factorisation to use: `name`, else the environment's FAYING_SOLVER, else the fastest there is."""
    asked = name or os.environ.get("FAYING_SOLVER") or None
    have = available()
    if asked is None:
        return have[0]
    if asked not in have:
        raise InputError(f"solver {asked!r} is not here; use one of {', '.join(have)}, or install it "
                         "(pardiso: pip install 'faying[pardiso]')")  # fmt: skip
    return asked


def factorise(matrix: Any, name: str | None = None) -> Factorisation:
    """Factorise a sparse symmetric positive definite matrix. Raises NotConverged where it is singular."""
    return _BACKENDS[chosen(name)](matrix)
