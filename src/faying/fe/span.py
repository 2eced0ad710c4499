"""A basis that grows, orthonormal with the mass, and what operators make of it."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from faying.typing import Array

ROUNDING = 1e-13  # of the largest: squares of directions below it are rounding


def extension(new: Array, basis: Array, image: Array, operator: Any, *, least: float = 0.0) -> tuple[Array, Array]:
    """Directions that columns add to a basis.

    Args:
        new: columns (n, k).
        basis: vectors (n, m), orthonormal in the operator.
        image: operator @ basis (n, m).
        operator: symmetric and positive (n, n), sparse: the mass, or a stiffness whose energy measures.
        least: square, in the operator, of what is new in a column below which a direction is left out; what is
            rounding beside the largest is left out anyhow.

    Returns:
        Columns (n, r), orthonormal in the operator with each other and with the basis, the largest share of what is new
        last, and operator @ columns.
    """
    new = new - basis @ (image.T @ new)
    gram = new.T @ (operator @ new)
    squares, turn = np.linalg.eigh((gram + gram.T) / 2)
    keep = squares > max(least, ROUNDING * squares.max(initial=0.0))
    new = new @ (turn[:, keep] / np.sqrt(squares[keep]))
    new = new - basis @ (image.T @ new)  # what rounding leaves of the first pass
    moved = np.asarray(operator @ new)
    gram = new.T @ moved  # a direction that was small has lost digits of its size
    squares, turn = np.linalg.eigh((gram + gram.T) / 2)
    mend = (turn / np.sqrt(squares)) @ turn.T
    return new @ mend, moved @ mend


def without(new: Array, basis: Array, image: Array) -> Array:
    """Columns (n, k) less what a basis (n, m), orthonormal in an operator, has of them; image: operator @ basis."""
    for _ in range(2):  # what rounding leaves of the first pass, the second takes
        new = new - basis @ (image.T @ new)
    return new


class Span:
    """Vectors (n, m), orthonormal with the mass, the images of the mass and the stiffness, and operators projected.

    Args:
        mass, stiffness: sparse (n, n).
        first: the vectors to begin with.
        others: further operators, whose projections alone are kept.
    """

    def __init__(self, mass: Any, stiffness: Any, first: Array, others: Sequence[Any] = ()) -> None:
        self.mass, self.operators = mass, (stiffness, *others)
        self._columns = [_Columns(one) for one in (first, mass @ first, stiffness @ first)]
        self.small = [first.T @ self.force, *(first.T @ (operator @ first) for operator in others)]

    @property
    def vectors(self) -> Array:
        """The vectors (n, m)."""
        return self._columns[0].values

    @property
    def momentum(self) -> Array:
        """Mass @ vectors (n, m)."""
        return self._columns[1].values

    @property
    def force(self) -> Array:
        """Stiffness @ vectors (n, m)."""
        return self._columns[2].values

    def add(self, new: Array, *, least: float = 0.0) -> int:
        """Add what is new in columns (n, k), as `extension` does; return how many vectors that makes."""
        new, momentum = extension(new, self.vectors, self.momentum, self.mass, least=least)
        force = np.asarray(self.operators[0] @ new)
        for i, operator in enumerate(self.operators):
            image = force if i == 0 else operator @ new
            corner, side = new.T @ image, self.vectors.T @ image
            self.small[i] = np.block([[self.small[i], side], [side.T, (corner + corner.T) / 2]])
        for kept, more in zip(self._columns, (new, momentum, force), strict=True):
            kept.add(more)
        return int(new.shape[1])


class _Columns:
    """Columns (n, m) of a matrix that grows, without a copy of all of it for each that comes."""

    def __init__(self, first: Array) -> None:
        self._room, self._used = np.asfortranarray(first), first.shape[1]

    @property
    def values(self) -> Array:
        return self._room[:, : self._used]

    def add(self, new: Array) -> None:
        used = self._used + new.shape[1]
        if used > self._room.shape[1]:
            room = np.empty((len(new), used + used // 8), order="F")
            room[:, : self._used] = self.values
            self._room = room
        self._room[:, self._used : used] = new
        self._used = used
