"""LOBPCG in one process, beside SciPy's dense solution."""

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import diags_array, eye_array, kron
from scipy.sparse.linalg import splu

from faying.mpi.lobpcg import Lobpcg


class Plate:
    """A grid of springs, free at its ends, whose modes come in pairs; the preconditioner is of another spring."""

    def __init__(self, side, off=0.5):
        chain = diags_array([-np.ones(side - 1), 2 * np.ones(side), -np.ones(side - 1)], offsets=[-1, 0, 1]).tolil()
        chain[0, 0] = chain[-1, -1] = 1.0
        one = eye_array(side)
        self.A = (kron(chain, one) + kron(one, chain) + 1e-4 * eye_array(side**2)).tocsc()
        weights = np.random.default_rng(1).uniform(0.5, 1.0, side)
        self.M = diags_array(np.outer(weights, weights).ravel()).tocsr()
        self._near = splu((self.A + diags_array(off * np.linspace(0, 0.1, side**2))).tocsc())

    def operator(self, vectors):
        return self.A @ vectors

    def mass(self, vectors):
        return self.M @ vectors

    def precondition(self, vectors):
        return self._near.solve(vectors)

    def total(self, share):
        return np.array(share)


def start(plate, width):
    return np.random.default_rng(2).standard_normal((plate.A.shape[0], width))


@pytest.mark.parametrize("count", [1, 4, 10])
def test_values_and_vectors(count):
    plate = Plate(20)
    found = Lobpcg(plate, start(plate, count + 6), count)
    wanted = eigh(plate.A.toarray(), plate.M.toarray(), eigvals_only=True)[:count]
    found.run(1e-4)  # far above what rounding leaves in the lowest, 1e-10 of it
    assert np.all(found.values[:count] / wanted - 1 < 20 * found.left[:count] + 1e-9)
    found.run(1e-10)
    assert found.values[:count] == pytest.approx(wanted, rel=1e-9)
    x = found.vectors[:, :count]
    assert x.T @ (plate.M @ x) == pytest.approx(np.eye(count), abs=1e-10)
    assert np.abs(found.residual(np.arange(count))).max() < 1e-4


def test_exact_start_takes_no_step_and_going_on_sharpens():
    """Vectors that begin exact stay; a second run goes on where the first one stopped."""
    plate = Plate(15)
    _, shapes = eigh(plate.A.toarray(), plate.M.toarray(), subset_by_index=[0, 9])
    found = Lobpcg(plate, shapes, 5)
    found.run(1e-10)
    assert found.steps == 0
    found = Lobpcg(plate, start(plate, 10), 5)
    found.run(1e-3)
    first, coarse = found.steps, found.left[:5].max()
    found.run(1e-11)
    assert found.steps > first
    assert found.left[:5].max() < 1e-11 < coarse


def test_far_below_what_rounding_allows_it_does_not_break_down():
    """Directions that are rounding are left out; what is asked for too exactly ends in an error, not in NaN."""
    plate = Plate(12)
    found = Lobpcg(plate, start(plate, 12), 6)
    with pytest.raises(RuntimeError, match="estimated error stays at"):
        found.run(1e-40)
    wanted = eigh(plate.A.toarray(), plate.M.toarray(), eigvals_only=True)[:6]
    assert found.values[:6] == pytest.approx(wanted, rel=1e-10)


def test_dependent_vectors_to_begin_with():
    plate = Plate(10)
    given = start(plate, 10)
    given[:, 3:] = given[:, :1]
    with pytest.raises(RuntimeError, match="3 of 9 vectors to begin with are independent"):
        Lobpcg(plate, given, 5)


def test_a_matrix_that_is_not_positive_definite():
    plate = Plate(10)
    plate.A = (plate.A - 0.05 * eye_array(100)).tocsc()
    found = Lobpcg(plate, start(plate, 10), 5)
    found.run(1e-8)
    assert found.values[0] < 0
