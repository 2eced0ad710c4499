"""Matrices in pieces, one for each process: every piece holds the rows of the nodes in one region of the structure."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from faying.numerics.shifted import Shifted
from faying.typing import Array, Index


def bisected(points: Array, pieces: int) -> list[Index]:
    """Nodes in regions of equal size by recursive coordinate bisection, each cut across the longest side.

    Args:
        points: coordinates (n, 3) [m].
        pieces: how many regions, 1 to n.

    Returns:
        The nodes of each region, in rising order; sizes differ by one at most for powers of two, by `pieces` else.

    Source:
        Berger and Bokhari 1987, doi:10.1109/TC.1987.1676942.
    """

    def cut(nodes: Index, pieces: int) -> list[Index]:
        if pieces == 1:
            return [np.sort(nodes)]
        axis = int(np.argmax(np.ptp(points[nodes], axis=0)))
        order = nodes[np.argsort(points[nodes, axis], kind="stable")]
        left = pieces // 2
        middle = len(order) * left // pieces
        return cut(order[:middle], left) + cut(order[middle:], pieces - left)

    return cut(np.arange(len(points)), pieces)


def rows_of_pieces(unknowns: int, points: Array | None, pieces: int) -> list[Index]:
    """Unknowns of each piece: those of the nodes in a region, or without coordinates, ranges in their order."""
    if points is None:
        return list(np.array_split(np.arange(unknowns), pieces))
    return [(3 * nodes[:, None] + np.arange(3)).ravel() for nodes in bisected(points, pieces)]


def write_points(folder: Path, points: Array, rows: Sequence[Index]) -> None:
    """Write coordinates (nodes, 3) into the folder of each piece, as points.npy.

    A piece is a folder, named by its number from 0. Coordinates are from the centre, in sizes of the structure.
    """
    centred = (points - points.mean(axis=0)) / np.ptp(points, axis=0).max()
    for number, here in enumerate(rows):
        np.save(folder / str(number) / "points.npy", centred[here[::3] // 3])


def write_operator(folder: Path, matrix: Shifted, rows: Sequence[Index]) -> None:
    """Write the rows of K + s M into the folder of each piece, unknowns numbered piece after piece.

    They are operator_starts.npy, operator_columns.npy and operator_values.npy: row pointers, columns and values.
    """
    order = np.concatenate(rows)
    numbers = np.empty(len(order), dtype=np.int64)
    numbers[order] = np.arange(len(order))
    for number, here in enumerate(rows):
        piece = (matrix.stiffness[here] + matrix.shift * matrix.mass[here]).tocsr()
        piece.indices = numbers[piece.indices]
        piece.sort_indices()
        for what, values in (("starts", piece.indptr), ("columns", piece.indices), ("values", piece.data)):
            np.save(folder / str(number) / f"operator_{what}.npy", values)
