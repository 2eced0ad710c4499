"""Combinations of vectors in any layout, and the sizes of products."""

import numpy as np
import pytest
from scipy.sparse import csr_array, random_array

from faying.numerics.product import ROWS, combined, product_of_sizes

RNG = np.random.default_rng(7)


def layouts():
    """Vectors (45, m) in all ways that they may lie in memory."""
    wide = RNG.standard_normal((45, 12))
    yield from (wide, np.asfortranarray(wide), wide[:, ::2], wide[:, 1:2], wide[:, 0], wide[:, :0], wide.T.copy().T)
    yield wide + 1j * wide[::-1]
    yield (wide + 1j).real
    yield wide.astype(np.float32)


def test_combinations_of_columns_are_products_for_any_layout():
    for vectors in layouts():
        if vectors.ndim == 2:
            mix = RNG.standard_normal((vectors.shape[1], 4))
            assert combined(vectors, mix) == pytest.approx(vectors @ mix, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("rows", [1, 2 * ROWS + 3])
@pytest.mark.parametrize("form", ["csr", "csc", "dense"])
def test_sizes_of_a_product_are_those_of_all_its_terms(rows, form):
    sparse = csr_array(random_array((rows, 30), density=0.3, rng=RNG, format="csr"))
    sparse.data -= 0.5
    matrix = sparse.toarray() if form == "dense" else sparse.asformat(form)
    vector = RNG.standard_normal(30)
    wanted = np.einsum("ij,j->i", np.abs(sparse.toarray()), np.abs(vector))
    assert product_of_sizes(matrix, vector) == pytest.approx(wanted, rel=1e-13)
