"""Lowest eigenpairs by a preconditioner in place of a factorisation, every process with its rows of the vectors.

Imports NumPy alone, since `mpi_worker` runs where Faying is not.
"""

from typing import Any, Protocol

import numpy as np

Block = Any  # (rows of this process, vectors)
WATCHED = 4  # vectors beyond those wanted that must have found their place above them
PLACED = 1e-2  # estimated relative error of their eigenvalues
MAX_STEPS = 300
DROPPED = 1e-14  # of the largest eigenvalue of a Gram matrix: directions below it are rounding
NO_STEP = 1e-8  # of a unit vector: a change below it gives no direction
ROWS = 20_000  # that are combined at a time


class Space(Protocol):
    """The matrices as products with blocks of vectors, and sums over the processes."""

    def operator(self, vectors: Block) -> Block:
        """A times vectors, A symmetric and positive definite."""

    def mass(self, vectors: Block) -> Block:
        """M times vectors, M symmetric and positive semidefinite."""

    def precondition(self, vectors: Block) -> Block:
        """A symmetric approximation of the inverse of A, times vectors."""

    def total(self, share: Any) -> Any:
        """The sum of an array over all processes, the same to the last bit in each of them."""


class Lobpcg:
    """The lowest eigenvalues of A x = theta M x, with vectors orthonormal with M.

    Each step takes the best vectors in the span of those at hand, of their residuals through the preconditioner, and
    of the directions of the last step. The three are kept orthonormal: else the method breaks down near its end.
    Vectors that are exact enough take no further residuals.

    Args:
        space: the matrices.
        start: vectors (n, m) to begin with, more than those wanted by `WATCHED` or more, with parts in all directions.
        count: how many are wanted.

    Source:
        Knyazev 2001, doi:10.1137/S1064827500366124; Hetmaniuk and Lehoucq 2006, doi:10.1016/j.jcp.2006.02.007.
    """

    def __init__(self, space: Space, start: Block, count: int) -> None:
        self._space, self._count, self.steps = space, count, 0
        vectors = self._orthonormal(start, [])
        small = self._grams([vectors], space.operator(vectors))
        self.values, turn = np.linalg.eigh((small + small.T) / 2)
        self.vectors = vectors @ turn
        width = len(self.values)
        if width < count + WATCHED:
            raise RuntimeError(f"{width} of {count + WATCHED} vectors to begin with are independent")
        self.left = np.full(width, np.inf)  # r' B r / theta: estimated relative error of the eigenvalues
        self._ahead, self._edge, self._corner = vectors[:, :0], np.zeros((width, 0)), np.zeros((0, 0))

    def run(self, tolerance: float) -> None:
        """Go on until the estimated relative error of the wanted eigenvalues, and of those watched, is small enough.

        It ends at once with a value of zero or less where A is not positive definite.

        Raises:
            RuntimeError: that takes too many steps.
        """
        limits = np.full(len(self.left), PLACED)
        limits[: self._count] = tolerance
        active = everything = np.arange(len(self.left))
        last = self.steps + MAX_STEPS
        while self.steps < last:
            search = self._search(active)
            coarse = self.left > limits
            if np.any(coarse[: self._count + WATCHED]):
                self._step(search[:, coarse[active]], coarse)
                self.steps += 1
                if self.values[0] <= 0:
                    return
                active = np.flatnonzero(coarse)
            elif len(active) < len(everything):  # those that took no more residuals are looked at once more
                active = everything
            else:
                return
        raise RuntimeError(f"the estimated error stays at {self.left[: self._count].max():.1e}")

    def residual(self, numbers: Any) -> Block:
        """A x - theta M x of some of the vectors (n, k)."""
        vectors = np.asfortranarray(self.vectors[:, numbers])
        out = self._space.mass(vectors)
        out *= -self.values[numbers]
        out += self._space.operator(vectors)
        return out

    def _search(self, active: Any) -> Block:
        """Residuals of some vectors, through the preconditioner; what is left of their error is noted."""
        residual = self.residual(active)
        found = self._space.precondition(residual)
        self.left[active] = np.abs(self._space.total(np.einsum("ij,ij->j", residual, found))) / self.values[active]
        return found

    def _step(self, search: Block, coarse: Any) -> None:
        """The best vectors in the span; `coarse` are those whose directions are kept for the next step."""
        old = [self.vectors, self._ahead]
        search = self._orthonormal(search, old)
        width, known = len(self.values), len(self.values) + self._ahead.shape[1]
        size = known + search.shape[1]
        small = np.zeros((size, size))
        small[:width, :width] = np.diag(self.values)
        small[:width, width:known], small[width:known, width:known] = self._edge, self._corner
        small[:, known:] = self._grams([*old, search], self._space.operator(search))
        small = np.triu(small) + np.triu(small, 1).T
        values, turn = np.linalg.eigh(small)
        best = turn[:, :width]
        change = best[:, coarse]
        change[:width] = 0.0
        for _ in range(2):
            change = change - best @ (best.T @ change)
            unit, sizes, _ = np.linalg.svd(change, full_matrices=False)
            change = unit[:, sizes > NO_STEP]
        self.values = values[:width]
        self._edge, self._corner = best.T @ small @ change, change.T @ small @ change
        ahead = np.empty((len(search), change.shape[1]), order="F")
        for begin in range(0, len(search), ROWS):
            here = slice(begin, begin + ROWS)
            rows = np.concatenate([part[here] for part in (*old, search)], axis=1)
            self.vectors[here], ahead[here] = rows @ best, rows @ change
        self._ahead = ahead

    def _orthonormal(self, new: Block, against: list[Block]) -> Block:
        """Vectors orthonormal with M that span what is new (n, k) beyond those of orthonormal blocks."""
        for _ in range(2):  # what rounding leaves of the first pass, the second mends
            if against:
                shares = self._grams(against, self._space.mass(new))
                at = 0
                for block in against:
                    new = new - block @ shares[at : at + block.shape[1]]
                    at += block.shape[1]
            gram = self._grams([new], self._space.mass(new))
            size = np.sqrt(np.maximum(np.diag(gram), np.finfo(float).tiny))
            values, turn = np.linalg.eigh((gram + gram.T) / 2 / size / size[:, None])
            keep = values > DROPPED * values[-1]
            new = np.asfortranarray(new @ (turn[:, keep] / np.sqrt(values[keep]) / size[:, None]))
        return new

    def _grams(self, blocks: list[Block], other: Block) -> Any:
        """Products of the vectors of all blocks with those of another, over all processes."""
        return self._space.total(np.concatenate([block.T @ other for block in blocks]))
