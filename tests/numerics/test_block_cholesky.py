"""Cholesky's factor of a few dense blocks, against the whole matrix."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import csr_array

from faying.errors import NotConverged
from faying.numerics.block_cholesky import BlockCholesky


@given(
    sizes=st.lists(st.integers(1, 6), min_size=1, max_size=6),
    seed=st.integers(0, 2**32 - 1),
    share=st.floats(0.0, 1.0),
    dense=st.booleans(),
)
def test_any_blocks_with_any_coupling(sizes, seed, share, dense):
    """Chains, stars, rings and blocks on their own; what elimination couples anew is not a loss."""
    rng = np.random.default_rng(seed)
    starts = np.cumsum([0, *sizes])
    n = starts[-1]
    A = np.zeros((n, n))
    pieces = [slice(a, b) for a, b in pairwise(starts)]
    edges = {}
    for i, rows in enumerate(pieces):
        for j, columns in enumerate(pieces[i + 1 :], start=i + 1):
            if rng.random() < share:
                edge = rng.standard_normal((sizes[i], sizes[j])) * (rng.random(sizes[j]) < 0.7)
                edges[i, j] = edge if dense else csr_array(edge)
                A[rows, columns] = edge
    A += A.T
    for rows in pieces:
        own = rng.standard_normal((rows.stop - rows.start,) * 2)
        A[rows, rows] = own @ own.T
    A += (1 - np.linalg.eigvalsh(A).min()) * np.eye(n)
    b = rng.standard_normal((n, 2))
    found = BlockCholesky([A[p, p].copy() for p in pieces], edges).solve([b[p] for p in pieces])
    assert np.concatenate(found) == pytest.approx(np.linalg.solve(A, b), abs=1e-9 * np.linalg.norm(b))


def test_a_matrix_that_is_not_positive_definite():
    with pytest.raises(NotConverged, match="positive definite"):
        BlockCholesky([np.eye(2), np.eye(2)], {(0, 1): 2 * np.eye(2)})
