"""A factorisation in single precision: half the memory and half the time of one in double.

It serves those who see their own residuals in double precision: conjugate gradients, modes that are refined. What
single precision spoils first are the softest motions, and the softest of all are the rigid ones, whose part is known
exactly and never goes through the factor.
"""

import numpy as np

from faying.errors import NotConverged
from faying.numerics.pardiso import Pardiso
from faying.numerics.shifted import Shifted
from faying.numerics.solve import Factorisation, Factoriser, chosen, factorise
from faying.typing import Array

POOR = 0.2  # relative error of a solution beyond which double precision is due
SEED = 20261122


class Single:
    """A factor of K + s M in single precision, as a `Factorisation`.

    Args:
        matrix: K + s M, (n, n), s above 0.
        rigid: motions (n, r) that the stiffness K leaves free, r = 0 where there are none.
        maker: what factorises it; None: PARDISO, as a whole.

    Raises:
        NotConverged: the factor has too few digits of this matrix, or none.
    """

    def __init__(self, matrix: Shifted, rigid: Array, maker: Factoriser | None = None) -> None:
        mass = matrix.mass
        gram = rigid.T @ (mass @ rigid)
        self._rigid = rigid @ np.linalg.inv(np.linalg.cholesky((gram + gram.T) / 2)).T
        self._momentum, self._shift = np.asarray(mass @ self._rigid), matrix.shift
        self._factor: Factorisation = (
            Pardiso(matrix.assembled, single=True) if maker is None else maker.factorise(matrix, single=True)
        )
        self.name, self.memory = self._factor.name, self._factor.memory
        # a motion of all wave lengths, as the softest of the elastic modes are the worst
        wanted = self.solve(mass @ np.random.default_rng(SEED).standard_normal(matrix.shape[0]))
        error = self.solve(matrix @ wanted) - wanted
        if not np.linalg.norm(error) < POOR * np.linalg.norm(wanted):
            raise NotConverged("single precision is too coarse for this matrix")

    def solve(self, right: Array) -> Array:
        """Solve for one right-hand side (n,) or several (n, m), to a few digits."""
        amount = self._rigid.T @ right
        found = self._factor.solve(right - self._momentum @ amount)
        found -= self._rigid @ (self._momentum.T @ found - amount / self._shift)
        return np.asarray(found)


def factorise_roughly(matrix: Shifted, *, rigid: Array, solver: str | Factoriser | None = None) -> Factorisation:
    """Factorise in single precision where the solver can and the matrix allows, else in double.

    Args:
        matrix, rigid: as `Single` takes them.
        solver: name of the factorisation, as `factorise` takes it, or what factorises otherwise.

    Raises:
        NotConverged: the matrix is singular.
        InputError: memory is short.
    """
    maker = solver if isinstance(solver, Factoriser) else None
    if isinstance(solver, Factoriser) or chosen(solver) == "pardiso":
        try:
            return Single(matrix, rigid, maker)
        except NotConverged:
            pass  # before the other is made, this one is gone
    return factorise_exactly(matrix, solver)


def factorise_exactly(matrix: Shifted, solver: str | Factoriser | None) -> Factorisation:
    """Factorise in double precision, with arguments and faults of `factorise_roughly`."""
    if isinstance(solver, Factoriser):
        return solver.factorise(matrix, single=False)
    return factorise(matrix.assembled(), solver)
