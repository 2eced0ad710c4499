"""Factorisations behind one interface; the best one found at run time is taken and reported."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any, Protocol, runtime_checkable

import numpy as np

from faying.errors import InputError, NotConverged
from faying.numerics.memory import FILL_MINIMUM_DEGREE, check, guessed
from faying.numerics.pardiso import INDEFINITE, Pardiso
from faying.typing import Array


class Factorisation(Protocol):
    """A factorised symmetric positive definite matrix; memory [B]: what it was estimated to take before it was made."""

    name: str
    memory: float

    def solve(self, right: Array) -> Array:
        """Solve for one right-hand side (n,) or several (n, m)."""


@runtime_checkable
class Factoriser(Protocol):
    """Factorises the matrices of one structure; key: what results call it."""

    key: str

    def factorise(self, matrix: Any, *, single: bool) -> Factorisation:
        """Factorise a symmetric positive definite `Shifted` (n, n) to single or to double precision."""


@dataclass(kw_only=True)
class Released:
    """Stands for a factorisation that was given up for its memory [B]."""

    name: str
    memory: float

    def solve(self, right: Array) -> Array:
        """Raise RuntimeError: there is nothing left to solve with."""
        raise RuntimeError(f"the factorisation by {self.name} was released")


class _SuperLU:
    """SciPy's SuperLU: always there, slow and hungry on solids."""

    name = "SuperLU"

    def __init__(self, matrix: Any) -> None:
        try:
            self._factor, self.memory = _superlu(matrix)
        except RuntimeError as fault:
            raise NotConverged(f"SuperLU could not factorise the matrix ({fault}); is a part free to move?") from None

    def solve(self, right: Array) -> Array:
        return np.asarray(self._factor.solve(right))


def _superlu(matrix: Any) -> tuple[Any, float]:
    """SuperLU's factor of a symmetric matrix, and its memory [B]. Raises RuntimeError where it is singular."""
    from scipy.sparse.linalg import splu

    memory = guessed(matrix.shape[0], fill=FILL_MINIMUM_DEGREE, per_entry=2 * 10)  # both triangles
    check(memory, matrix.shape[0], _SuperLU.name)
    symmetric = {"SymmetricMode": True}
    return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=symmetric), memory


_MODULE = {"pardiso": "pypardiso", "superlu": "scipy"}
BY_PARTS = "pardiso-by-parts"  # a way to use PARDISO on structures; as a whole where there are no parts
_BACKENDS: dict[str, Callable[[Any], Factorisation]] = {
    "pardiso": Pardiso,
    BY_PARTS: Pardiso,
    "superlu": _SuperLU,
}


@cache
def available() -> tuple[str, ...]:
    """Names of the factorisations that can be used here, fastest first.

    One that is installed but broken is left out.
    """
    from importlib import import_module

    def works(module: str) -> bool:
        try:
            if module == "pypardiso":
                _point_to_mkl()
            import_module(module)
        except Exception:
            return False
        return True

    return tuple(name for name, module in _MODULE.items() if works(module))


def _point_to_mkl() -> None:
    """Tell pypardiso where MKL is, where its package says so: to look through all files takes most of a second."""
    from importlib.metadata import PackageNotFoundError, files

    try:
        found = [file for file in files("mkl") or () if "mkl_rt" in file.name]
    except PackageNotFoundError:
        return
    if found:
        os.environ.setdefault("PYPARDISO_MKL_RT", str(found[0].locate()))


def chosen(name: str | None = None) -> str:
    """Return the factorisation to use: `name`, else the environment's FAYING_SOLVER, else the fastest there is."""
    asked = name or os.environ.get("FAYING_SOLVER") or None
    have = available()
    if asked is None:
        return have[0]
    if asked == BY_PARTS and "pardiso" in have:
        return asked
    if asked not in have:
        raise InputError(
            f"solver {asked!r} is not here; use one of {', '.join(have)}, or install it "
            "(pardiso: add --extra pardiso to uv run, or pip install pypardiso)"
        )
    return asked


def factorise(matrix: Any, name: str | None = None) -> Factorisation:
    """Factorise a sparse symmetric positive definite matrix. Raises NotConverged where it is singular."""
    return _BACKENDS[chosen(name)](matrix)


def conjugate_gradients(
    product: Callable[[Array], Array],
    factor: Factorisation,
    right: Array,
    *,
    accuracy: float,
    limit: int = 200,
    like: Array | None = None,
    least: float = 0.0,
) -> Array:
    """Solve for several right-hand sides (n, m) by conjugate gradients, each on its own.

    Args:
        product: the symmetric matrix, positive on what the right-hand sides reach, times vectors (n, m).
        factor: of a matrix near it; one of the very matrix asks for one step.
        right: (n, m).
        accuracy: of the residual relative to the right-hand side.
        limit: steps.
        like: solutions (n, k) of like equations; it starts from the best combination of them.
        least: energy, right x solution, below which one step is enough.

    Raises:
        NotConverged: the residual stays above the accuracy.
    """
    found, rest = np.zeros_like(right), np.array(right)
    if like is not None:
        image = product(like)
        shares = np.linalg.lstsq(like.T @ image, like.T @ right, rcond=1e-12)[0]
        found, rest = like @ shares, right - image @ shares
    target = accuracy * np.linalg.norm(right, axis=0)
    open_ = np.flatnonzero(~(np.linalg.norm(rest, axis=0) <= target))  # to go on with; NaN never ends
    rest, step, slope = rest[:, open_], np.zeros((len(rest), len(open_))), np.ones(len(open_))
    for done in range(limit):
        if not len(open_):
            return found
        ahead = factor.solve(rest)
        fall = np.einsum("ij,ij->j", rest, ahead)
        step = ahead + step * np.where(slope > 0, fall / np.where(slope > 0, slope, 1.0), 0.0)
        slope = fall
        force = product(step)
        bend = np.einsum("ij,ij->j", step, force)
        length = np.where(bend > 0, fall / np.where(bend > 0, bend, 1.0), 0.0)
        found[:, open_] += step * length
        rest -= force * length
        goes_on = ~(np.linalg.norm(rest, axis=0) <= target[open_])
        if done == 0 and least > 0:
            goes_on &= ~(fall <= least)
        if not np.all(goes_on):
            open_, slope, rest, step = open_[goes_on], slope[goes_on], rest[:, goes_on], step[:, goes_on]
    raise NotConverged(f"conjugate gradients: the residual stays above {accuracy:.0e} after {limit} steps")


def negative_eigenvalues(matrix: Any, name: str | None = None) -> int:
    """Count the negative eigenvalues of a sparse symmetric matrix by the signs of its pivots (Sylvester).

    Raises NotConverged where the factorisation gives no signs.
    """
    if chosen(name) in ("pardiso", BY_PARTS):
        return Pardiso(matrix.tocsr(), INDEFINITE).negative
    try:
        factor, _ = _superlu(matrix)
    except RuntimeError as fault:
        raise NotConverged(f"the modes could not be counted ({fault})") from None
    if not np.array_equal(factor.perm_r, factor.perm_c):
        raise NotConverged("the modes could not be counted: the factorisation has left the diagonal; install PARDISO")
    return int(np.count_nonzero(factor.U.diagonal() < 0))
