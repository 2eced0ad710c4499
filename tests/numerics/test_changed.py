"""A matrix and a change of it on few unknowns, against their sum."""

import numpy as np
import pytest
from scipy.sparse import csr_array, random_array

from faying.numerics.changed import UpdatedStiffness, assembled
from faying.numerics.modal_reanalysis import ModalReanalysis
from faying.numerics.modes import lowest_modes


@pytest.fixture(scope="module")
def pair():
    """A chain of 200 masses, and springs between some of them that are far apart."""
    n = 200
    chain = csr_array(np.diag(np.full(n, 2.01)) - np.eye(n, k=1) - np.eye(n, k=-1))
    change = np.zeros((n, n))
    for a, b, k in [(20, 150, 0.3), (60, 61, -0.5), (150, 199, 2.0)]:
        change[np.ix_([a, b], [a, b])] += k * np.array([[1, -1], [-1, 1]])
    return chain, csr_array(change)


def test_products_diagonal_and_sum_are_those_of_the_sum(pair):
    both, total = UpdatedStiffness(before=pair[0], change=pair[1]), (pair[0] + pair[1]).toarray()
    assert both.shape == total.shape
    assert both.touched.tolist() == [20, 60, 61, 150, 199]
    rng = np.random.default_rng(0)
    for vectors in (rng.standard_normal(200), rng.standard_normal((200, 4))):
        assert both @ vectors == pytest.approx(total @ vectors)
    assert both.diagonal() == pytest.approx(np.diag(total))
    assert assembled(both).toarray() == pytest.approx(total)
    assert assembled(pair[0]) is pair[0]


def test_large_matrices_too():
    """Above the size from which another library takes the product."""
    rng = np.random.default_rng(1)
    before = random_array((30_000, 30_000), density=3e-4, format="csr", rng=rng)
    change = csr_array(([2.0, -3.0], ([5, 7], [7, 5])), shape=before.shape)
    vectors = rng.standard_normal((30_000, 3))
    assert UpdatedStiffness(before=before, change=change) @ vectors == pytest.approx((before + change) @ vectors)


def test_modes_of_a_changed_stiffness_are_those_of_the_sum(pair):
    mass = csr_array(np.eye(200))
    modes = lowest_modes(pair[0], mass, 8, shift_frequency=0.01)
    near = ModalReanalysis(modes, pair[0], mass, rigid=0)
    both = UpdatedStiffness(before=pair[0], change=pair[1])
    found = near.under(both, 4, tolerance=1e-9)
    exact = np.sqrt(np.linalg.eigvalsh(assembled(both).toarray())[:4]) / (2 * np.pi)
    assert found.frequencies[:4] == pytest.approx(exact, rel=1e-8)
    bare = near.under(both, 4, tolerance=1e-9, shapes=False)
    assert bare.frequencies[:4] == pytest.approx(exact, rel=1e-8)
    assert bare.shapes.shape == (200, 0)
