"""Pieces of matrices: every unknown in one, balanced, compact, and together the whole."""

import numpy as np
import pytest
from scipy.sparse import block_diag, csr_array, kron, random_array

from faying.mpi.partition import bisected, rows_of_pieces, write_operator, write_points
from faying.numerics.shifted import Shifted


@pytest.mark.parametrize("pieces", [1, 2, 3, 4, 7, 16])
def test_every_node_is_in_one_region_and_regions_are_of_one_size(pieces):
    points = np.random.default_rng(1).uniform(size=(1001, 3)) * [3, 2, 1]
    regions = bisected(points, pieces)
    assert np.array_equal(np.sort(np.concatenate(regions)), np.arange(1001))
    assert np.ptp([len(region) for region in regions]) <= max(1, pieces.bit_length())


def test_cuts_go_across_the_longest_side():
    """A bar along y is cut into four lengths, each a quarter of it."""
    points = np.random.default_rng(2).uniform(size=(4000, 3)) * [1, 20, 2]
    for number, region in enumerate(sorted(bisected(points, 4), key=lambda region: points[region, 1].min())):
        assert points[region, 1] == pytest.approx(5 * number + 2.5, abs=2.8)


def test_without_coordinates_pieces_are_ranges():
    rows = rows_of_pieces(10, None, 3)
    assert np.array_equal(np.concatenate(rows), np.arange(10))


@pytest.mark.parametrize("known", [True, False])
def test_pieces_put_together_are_the_whole(tmp_path, known):
    """Read back as a process would, with the numbering undone, they are K + s M and the nodes."""
    nodes = 50
    half = csr_array(random_array((3 * nodes, 3 * nodes), density=0.05, rng=np.random.default_rng(3)))
    K, M = (half @ half.T).tocsr(), csr_array(kron(block_diag([np.diag(np.arange(1.0, 51))]), np.eye(3)))
    points = np.random.default_rng(4).uniform(-1, 5, size=(nodes, 3)) if known else None
    rows = rows_of_pieces(3 * nodes, points, 4)
    for number in range(4):
        (tmp_path / str(number)).mkdir()
    write_operator(tmp_path, Shifted(stiffness=K, mass=M, shift=7.0), rows)
    order = np.concatenate(rows)
    got = np.zeros((3 * nodes, 3 * nodes))
    first = 0
    for number in range(4):
        starts, columns, values = (
            np.load(tmp_path / str(number) / f"operator_{what}.npy") for what in ("starts", "columns", "values")
        )
        piece = csr_array((values, columns, starts), shape=(len(starts) - 1, 3 * nodes)).toarray()
        got[first : first + len(piece)] = piece
        first += len(piece)
    assert got == pytest.approx((K + 7.0 * M).toarray()[np.ix_(order, order)], rel=1e-14)
    if points is not None:
        write_points(tmp_path, points, rows)
        placed = np.concatenate([np.load(tmp_path / str(number) / "points.npy") for number in range(4)])
        assert np.ptp(placed, axis=0).max() == pytest.approx(1.0)
        same = points[order[::3] // 3]
        assert placed - placed[0] == pytest.approx((same - same[0]) / np.ptp(points, axis=0).max(), abs=1e-14)
