"""A matrix that differs from another on few unknowns: products with it, without a copy of the other."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from faying.numerics.product import product
from faying.typing import Array, Index


@dataclass(frozen=True, kw_only=True)
class UpdatedStiffness:
    """The sum of a matrix (n, n), CSR, and of a change (n, n), CSR and symmetric, that has few rows with entries."""

    before: Any
    change: Any

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return (self.before.shape[0], self.before.shape[1])

    @cached_property
    def touched(self) -> Index:
        """The unknowns (k,) on which the two differ."""
        return np.flatnonzero(np.diff(self.change.indptr))

    @cached_property
    def small(self) -> Any:
        """The change (k, k) on these."""
        return self.change[self.touched][:, self.touched]

    def __matmul__(self, vectors: Array) -> Array:
        """Times one vector (n,) or several (n, m)."""
        found = product(self.before, vectors)
        found[self.touched] += self.small @ vectors[self.touched]
        return found

    def diagonal(self) -> Array:
        """The diagonal (n,)."""
        return np.asarray(self.before.diagonal() + self.change.diagonal())


def assembled(matrix: Any) -> Any:
    """A matrix, or the sum of one that has changed, as one CSR matrix."""
    return (matrix.before + matrix.change).tocsr() if isinstance(matrix, UpdatedStiffness) else matrix
