"""Products with several vectors by MKL: those of SciPy, whatever the layout, and SciPy's where MKL cannot."""

import numpy as np
import pytest
from scipy.sparse import csr_array, random_array

from faying.numerics import product as module
from faying.numerics.product import ROWS, combined, product, product_of_sizes

RNG = np.random.default_rng(7)
MATRIX = csr_array(random_array((60, 45), density=0.2, rng=RNG, format="csr"))


@pytest.fixture(autouse=True)
def small_counts(monkeypatch):
    monkeypatch.setattr(module, "LARGE", 0)


def layouts():
    """Vectors (45, m) in all ways that they may lie in memory."""
    wide = RNG.standard_normal((45, 12))
    yield from (wide, np.asfortranarray(wide), wide[:, ::2], wide[:, 1:2], wide[:, 0], wide[:, :0], wide.T.copy().T)
    yield wide + 1j * wide[::-1]
    yield (wide + 1j).real
    yield wide.astype(np.float32)


def test_it_is_that_of_scipy_for_any_layout_and_type():
    for vectors in layouts():
        before = vectors.copy()
        found, wanted = product(MATRIX, vectors), MATRIX @ vectors
        assert found.shape == wanted.shape
        assert found == pytest.approx(wanted, rel=1e-6 if vectors.dtype == np.float32 else 1e-13, abs=1e-13)
        assert np.array_equal(vectors, before)


@pytest.mark.parametrize(
    "matrix",
    [
        MATRIX.tocsc(),
        MATRIX.astype(np.float32),
        MATRIX * (1 + 2j),
        csr_array((MATRIX.data, MATRIX.indices.astype(np.int64), MATRIX.indptr.astype(np.int64)), shape=MATRIX.shape),
        csr_array((60, 45)),
        MATRIX[10:30],
        MATRIX[:, ::-1],
    ],
    ids=["columns", "single", "complex", "long", "empty", "some rows", "unsorted"],
)
def test_matrices_of_all_kinds(matrix):
    vectors = RNG.standard_normal((45, 4))
    assert product(matrix, vectors) == pytest.approx(matrix @ vectors, rel=1e-6, abs=1e-6)


def test_without_mkl(monkeypatch):
    monkeypatch.setattr(module, "available", lambda: ("superlu",))
    module._library.cache_clear()
    try:
        vectors = RNG.standard_normal((45, 4))
        assert np.array_equal(product(MATRIX, vectors), MATRIX @ vectors)
        assert module._library() is None
    finally:
        module._library.cache_clear()


def test_vectors_of_another_length_are_refused():
    with pytest.raises(ValueError):
        product(MATRIX, np.ones((44, 3)))


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
