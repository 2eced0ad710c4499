"""A set of cells of a map: values on it, sums over coarse blocks of it, and products of a kernel between its cells."""

from functools import cached_property
from itertools import accumulate
from typing import Any, final

import numpy as np

from faying.halfspace.arrays import namespace
from faying.halfspace.kernels import Kernel
from faying.typing import AnyArray

BLOCK = 16  # cells a side of a coarse block


@final
class Cells:
    """The cells where `mask` (flat) holds; values on them are flat arrays in the order of the map."""

    def __init__(self, kernel: Kernel, mask: AnyArray) -> None:
        self.kernel, self.mask, self.xp = kernel, mask, namespace(mask)
        width = kernel.shape[1]
        self.pieces = [slice(rows.start * width, rows.stop * width) for rows in kernel.rows]
        self.counts = [int(self.xp.count_nonzero(mask[s])) for s in self.pieces]
        self.starts = [0, *accumulate(self.counts)]
        self.size = self.starts[-1]

    def values(self, field: AnyArray) -> AnyArray:
        """Values of a flat map on the cells."""
        return field[self.mask]

    def block(self, values: AnyArray, i: int) -> AnyArray | None:
        """Rows `kernel.rows[i]` of the map that has these values on the cells and 0 elsewhere; None if all are 0."""
        if not self.counts[i]:
            return None
        piece = self.pieces[i]
        out = self.xp.zeros(piece.stop - piece.start, dtype=values.dtype)
        out[self.mask[piece]] = values[self.starts[i] : self.starts[i + 1]]
        return self.xp.reshape(out, (-1, self.kernel.shape[1]))

    def product(self, values: AnyArray, table: AnyArray) -> AnyArray:
        """Apply a table of the kernel to values on the cells, shape (c, cells), in single precision."""
        out = self.xp.empty(tuple(values.shape), dtype=values.dtype)

        def write(k: int, i: int, block: AnyArray) -> None:
            out[k, self.starts[i] : self.starts[i + 1]] = self.xp.reshape(block, (-1,))[self.mask[self.pieces[i]]]

        self.kernel.stream(table, lambda k, i: self.block(values[k, :], i), write, needed=[c > 0 for c in self.counts])
        return out

    @cached_property
    def coarse(self) -> "Blocks":
        """Coarse blocks of the map, as the cells see them."""
        return Blocks(self)


@final
class Blocks:
    """Coarse blocks of a map, `shape` of them: sums of values over the cells in each, and the way back."""

    def __init__(self, cells: Cells) -> None:
        xp, kernel = cells.xp, cells.kernel
        self.shape: tuple[int, int] = (max(1, kernel.shape[0] // BLOCK), max(1, kernel.shape[1] // BLOCK))
        self.xp, self.rows = xp, kernel.shape[0]
        (of_row, edges), (of_column, across) = (_divided(n, m) for n, m in zip(kernel.shape, self.shape, strict=True))
        self._edges = kernel.place.send(edges)
        numbers = xp.empty(cells.size, dtype=xp.int32)
        offsets = xp.empty(kernel.shape[0] * self.shape[1] + 1, dtype=xp.int64)
        offsets[-1] = cells.size
        of_column = kernel.place.send(of_column.astype(np.int32))
        for i, (rows, piece) in enumerate(zip(kernel.rows, cells.pieces, strict=True)):
            mask = cells.mask[piece]
            lines = kernel.place.send(of_row[rows].astype(np.int32))
            here = slice(cells.starts[i], cells.starts[i + 1])
            if cells.counts[i]:
                every = lines[:, None] * self.shape[1] + of_column[None, :]
                numbers[here] = xp.reshape(every, (-1,))[mask]
            counted = xp.cumulative_sum(xp.astype(mask, xp.int64), include_initial=True)
            at = np.arange(rows.stop - rows.start)[:, None] * kernel.shape[1] + across[None, :-1]
            offsets[rows.start * self.shape[1] : rows.stop * self.shape[1]] = (
                xp.take(counted, kernel.place.send(at.ravel())) + cells.starts[i]
            )
        self._numbers, self._offsets = numbers, offsets

    def sums(self, values: AnyArray) -> AnyArray:
        """Sum over the cells of each block, in double precision."""
        xp = self.xp
        running = xp.take(xp.cumulative_sum(values, dtype=xp.float64, include_initial=True), self._offsets)
        lines = xp.reshape(running[1:] - running[:-1], (self.rows, self.shape[1]))
        ends = xp.take(xp.cumulative_sum(lines, axis=0, include_initial=True), self._edges, axis=0)
        return ends[1:, :] - ends[:-1, :]

    def spread(self, blocks: AnyArray) -> AnyArray:
        """Value of each cell's block, in single precision."""
        flat = self.xp.astype(self.xp.reshape(blocks, (-1,)), self.xp.float32)
        return self.xp.take(flat, self._numbers)


def _divided(n: int, m: int) -> tuple[Any, Any]:
    """For n cells in m blocks: the block of each cell, and where the blocks begin and end."""
    of = np.arange(n) * m // n
    return of, np.searchsorted(of, np.arange(m + 1))
