"""A set of cells of a map: values on it, sums over coarse blocks of it, and products of a kernel between its cells."""

from itertools import accumulate
from typing import Any, final

import numpy as np

from faying.halfspace.arrays import parts, sums_between
from faying.halfspace.kernels import Kernel
from faying.typing import AnyArray

BLOCK = 16  # cells a side of a coarse block


@final
class Cells:
    """The cells where `mask` (flat) holds; values on them are flat arrays in the order of the map."""

    def __init__(self, kernel: Kernel, mask: AnyArray) -> None:
        self.kernel, self.mask = kernel, mask
        width = kernel.shape[1]
        self.pieces = [slice(rows.start * width, rows.stop * width) for rows in kernel.rows]
        self.counts = [int(np.count_nonzero(mask[s])) for s in self.pieces]
        self.starts = [0, *accumulate(self.counts)]
        self.size = self.starts[-1]

    def block(self, values: AnyArray, i: int) -> AnyArray | None:
        """Rows `kernel.rows[i]` of the map that has these values on the cells and 0 elsewhere; None if all are 0."""
        if not self.counts[i]:
            return None
        piece = self.pieces[i]
        out = np.zeros(piece.stop - piece.start, dtype=values.dtype)
        out[self.mask[piece]] = values[self.starts[i] : self.starts[i + 1]]
        return np.reshape(out, (-1, self.kernel.shape[1]))

    def product(self, values: AnyArray, table: AnyArray) -> AnyArray:
        """Apply a table of the kernel to values on the cells, shape (c, cells), in single precision."""
        out = np.empty(tuple(values.shape), dtype=values.dtype)

        def write(k: int, i: int, block: AnyArray) -> None:
            out[k, self.starts[i] : self.starts[i + 1]] = np.reshape(block, (-1,))[self.mask[self.pieces[i]]]

        self.kernel.stream(table, lambda k, i: self.block(values[k, :], i), write, needed=[c > 0 for c in self.counts])
        return out


@final
class Blocks:
    """Coarse blocks of a map, `shape` of them: sums of values over the cells in each, and the way back."""

    def __init__(self, cells: Cells) -> None:
        kernel = cells.kernel
        self.shape: tuple[int, int] = (max(1, kernel.shape[0] // BLOCK), max(1, kernel.shape[1] // BLOCK))
        self.kernel, self.starts = kernel, cells.starts
        (of_row, edges), (of_column, across) = (_divided(n, m) for n, m in zip(kernel.shape, self.shape, strict=True))
        self._edges = edges
        self._numbers = np.empty(cells.size, dtype=np.int32)
        self._offsets = []  # of each piece: where the cells of each row in each block begin, and the end of the last
        for i, (rows, piece) in enumerate(zip(kernel.rows, cells.pieces, strict=True)):
            mask = cells.mask[piece]
            if cells.counts[i]:
                every = of_row[rows, None] * self.shape[1] + of_column[None, :]
                self._numbers[cells.starts[i] : cells.starts[i + 1]] = np.reshape(every, (-1,))[mask]
            counted = np.cumulative_sum(np.astype(mask, np.int64), include_initial=True)
            at = np.arange(rows.stop - rows.start)[:, None] * kernel.shape[1] + across[None, :-1]
            self._offsets.append(np.take(counted, np.append(at.ravel(), mask.shape[0])))

    def sums(self, values: AnyArray, weights: AnyArray | None = None) -> AnyArray:
        """Sum over the cells of each block, of flat values times weights; the sum of rows in double precision."""
        lines = np.empty((self.kernel.shape[0], self.shape[1]), dtype=np.float64)
        for i, rows in enumerate(self.kernel.rows):
            here = slice(self.starts[i], self.starts[i + 1])
            given = values[here] if weights is None else values[here] * weights[here]
            lines[rows, :] = np.reshape(sums_between(given, self._offsets[i]), (-1, self.shape[1]))
        return np.add.reduceat(lines, self._edges[:-1], axis=0)

    def take_off(self, values: AnyArray, k: int, blocks: AnyArray, weights: AnyArray | None = None) -> None:
        """Subtract each cell's block, times weights, from row k of values (c, cells)."""
        flat = np.astype(np.reshape(blocks, (-1,)), np.float32)
        for s in parts(self._numbers):
            share = np.take(flat, self._numbers[s])
            values[k, s] -= share if weights is None else share * weights[s]


def _divided(n: int, m: int) -> tuple[Any, Any]:
    """For n cells in m blocks: the block of each cell, and where the blocks begin and end."""
    of = (np.arange(n) * m // n).astype(np.int32)
    return of, np.searchsorted(of, np.arange(m + 1))
