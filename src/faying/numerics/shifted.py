"""K + s M without a third matrix: products with it, and the blocks of it that are asked for."""

from dataclasses import dataclass
from typing import Any

from faying.numerics.product import product
from faying.typing import Array, Index


@dataclass(frozen=True, kw_only=True)
class Shifted:
    """The sum of a stiffness K [N/m] (n, n) and s [1/s2] times a mass M [kg] (n, n), both CSR."""

    stiffness: Any
    mass: Any
    shift: float

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return (self.stiffness.shape[0], self.stiffness.shape[1])

    def __matmul__(self, vectors: Array) -> Array:
        """Times one vector (n,) or several (n, m)."""
        found = product(self.mass, vectors)
        found *= self.shift
        found += product(self.stiffness, vectors)
        return found

    def assembled(self) -> Any:
        """The sum as CSR."""
        return (self.stiffness + self.shift * self.mass).tocsr()

    def block(self, rows: Index, columns: Index) -> Any:
        """Rows and columns of the sum as CSR with sorted indices."""
        found = block(self.stiffness, rows, columns) + self.shift * block(self.mass, rows, columns)
        found.sort_indices()
        return found


def block(matrix: Any, rows: Index, columns: Index) -> Any:
    """Rows and columns of a CSR matrix, or of a shifted one, as CSR with sorted indices."""
    from scipy.sparse import csr_array

    if isinstance(matrix, Shifted):
        return matrix.block(rows, columns)
    found = csr_array(matrix[rows][:, columns])
    found.sort_indices()
    return found
