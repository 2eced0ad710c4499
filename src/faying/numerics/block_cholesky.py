"""Cholesky's factor of a symmetric matrix of dense blocks, few of which are coupled."""

from collections.abc import Collection, Sequence
from itertools import combinations
from typing import Any

import numpy as np

from faying.errors import NotConverged
from faying.typing import Array, Index


class BlockCholesky:
    """Factor of a symmetric positive definite matrix given by its blocks.

    Rough blocks are eliminated first, then small ones. Only the columns of a block beside the diagonal that hold
    anything are kept.

    Args:
        diagonal: the blocks on the diagonal, dense (n_i, n_i).
        edges: (i, j), i < j -> the block of rows i and columns j, dense or sparse. Both are used up: the blocks are
            great, and what is left of them is in the factor.
        rough: blocks whose factor is kept in single precision once it is made, where nothing is lost on what holds
            them.

    Raises:
        NotConverged: the matrix is not positive definite.
    """

    def __init__(self, diagonal: list[Array], edges: dict[tuple[int, int], Any], rough: Collection[int] = ()) -> None:
        self._order = sorted(range(len(diagonal)), key=lambda k: (k not in rough, len(diagonal[k])))
        rank = {block: place for place, block in enumerate(self._order)}
        blocks = [np.asarray(diagonal[k], dtype=float) for k in self._order]
        diagonal.clear()
        neighbours: list[dict[int, _Edge]] = [{} for _ in blocks]
        while edges:
            (one, other), edge = edges.popitem()
            i, j = rank[one], rank[other]
            neighbours[min(i, j)][max(i, j)] = _Edge.of(edge if i < j else edge.T)
        self._lower: list[Array] = []
        self._neighbours = neighbours
        for i in range(len(blocks)):
            lower = _cholesky(blocks[i])
            blocks[i] = np.zeros((0, 0))
            self._lower.append(lower)
            for edge in neighbours[i].values():
                edge.values = _solved(lower, edge.values)
            for j, edge in neighbours[i].items():
                blocks[j][np.ix_(edge.columns, edge.columns)] -= edge.values.T @ edge.values
            for j, k in combinations(sorted(neighbours[i]), 2):
                first, second = neighbours[i][j], neighbours[i][k]
                fill = np.zeros((len(blocks[j]), len(second.columns)))
                fill[first.columns] = -first.values.T @ second.values
                met = neighbours[j].get(k)
                neighbours[j][k] = _Edge(second.columns, fill) if met is None else met.plus(second.columns, fill)
            if self._order[i] in rough:
                self._lower[i] = lower.astype(np.float32)
                for edge in neighbours[i].values():
                    edge.values = edge.values.astype(np.float32)
        kept = [*self._lower, *(edge.values for row in neighbours for edge in row.values())]
        self.memory = float(sum(values.nbytes for values in kept))

    def solve(self, right: Sequence[Array]) -> list[Array]:
        """Solve for right-hand sides, one (n_i, m) for each block; the solutions in the same order."""
        found = [np.array(right[k], dtype=float) for k in self._order]
        for i, lower in enumerate(self._lower):
            found[i] = _solved(lower, found[i])
            for j, edge in self._neighbours[i].items():
                found[j][edge.columns] -= edge.values.T @ found[i].astype(edge.values.dtype)
        for i in reversed(range(len(found))):
            for j, edge in self._neighbours[i].items():
                found[i] -= edge.values @ found[j][edge.columns].astype(edge.values.dtype)
            found[i] = _solved(self._lower[i], found[i], trans="T")
        out: list[Array] = [np.zeros(0)] * len(found)
        for place, block in enumerate(self._order):
            out[block] = found[place]
        return out


class _Edge:
    """A block beside the diagonal: dense values (n_i, c) in some of its columns."""

    def __init__(self, columns: Index, values: Array) -> None:
        self.columns, self.values = columns, values

    @classmethod
    def of(cls, edge: Any) -> "_Edge":
        if isinstance(edge, np.ndarray):
            return cls(np.arange(edge.shape[1]), edge)
        columns = np.flatnonzero(np.diff(edge.tocsc().indptr))
        return cls(columns, edge.tocsc()[:, columns].toarray())

    def plus(self, columns: Index, values: Array) -> "_Edge":
        """The sum with values in other columns."""
        either = np.union1d(self.columns, columns)
        total = np.zeros((len(values), len(either)))
        total[:, np.searchsorted(either, self.columns)] = self.values
        total[:, np.searchsorted(either, columns)] += values
        return _Edge(either, total)


def _cholesky(block: Array) -> Array:
    from scipy.linalg import LinAlgError, cholesky

    try:
        # the transpose of a symmetric matrix is itself, in the order that LAPACK overwrites
        return np.asarray(cholesky(block.T, lower=True, overwrite_a=True, check_finite=False))
    except LinAlgError:
        raise NotConverged("the matrix is not positive definite; is a part free to move?") from None


def _solved(lower: Array, right: Array, trans: str = "N") -> Array:
    """Solve with a lower triangle; "T": with its transpose."""
    from scipy.linalg import solve_triangular

    return np.asarray(solve_triangular(lower, right.astype(lower.dtype), lower=True, trans=trans, check_finite=False))
