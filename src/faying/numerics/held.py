"""Vectors on which some sums are held at zero: motions of interfaces, of faces, of points."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from faying.errors import NotConverged
from faying.numerics.product import product
from faying.numerics.solve import Factorisation
from faying.typing import Array

ACCURACY = 1e-9  # of a vector: the change of a step below which it is the answer; frequencies err by its square
MAX_STEPS = 200


@dataclass(kw_only=True, eq=False)
class Held:
    """A factorisation of A, of use to vectors u with rows @ u = 0 alone.

    Args:
        factor: of A (n, n), positive definite.
        rows: The sums (k, n), sparse or not, linearly independent where A is.

    With Q = A^-1 rows' (rows A^-1 rows')^-1 the solution A^-1 f - Q rows A^-1 f of a force f is that under forces that
    hold the sums at zero. `lowest_modes` finds by it the modes of vectors that are held.
    """

    factor: Factorisation
    rows: Any

    def __post_init__(self) -> None:
        self.name, self.memory = self.factor.name, self.factor.memory

    @cached_property
    def shapes(self) -> Array:
        """Vectors Q (n, k), in each of which one sum is 1, and which A resists by forces on the sums alone."""
        columns = self.rows.toarray() if hasattr(self.rows, "toarray") else self.rows
        lifted = self.factor.solve(np.asfortranarray(columns.T))
        return np.asarray(np.linalg.solve((self.rows @ lifted).T, lifted.T).T)

    def solve(self, right: Array) -> Array:
        """Solve A u = right plus forces that hold the sums at zero: (n,) or (n, m)."""
        plain = self.factor.solve(right)
        return np.asarray(plain - self.shapes @ (self.rows @ plain))

    def beside(self, right: Array, modes: Array, mass: Any, shift: float) -> Array:
        """Solve (A - shift mass) u = right (n, m) on vectors that are held, without what held modes (n, j) have of it.

        modes: the lowest ones, orthonormal with the mass. Raises NotConverged where they end below the shift.
        """
        moved = product(mass, modes)
        right = right - moved @ (modes.T @ right)
        found = self.solve(right)
        for _ in range(MAX_STEPS):
            before, found = found, self.solve(right + shift * product(mass, found))
            if np.abs(found - before).max() <= ACCURACY * np.abs(found).max():
                return found - modes @ (moved.T @ found)
        raise NotConverged("too few modes are kept for the frequency of the shift; ask for a higher frequency")
