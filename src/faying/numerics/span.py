"""A basis that grows, orthonormal with the mass, and the stiffness projected on it."""

from typing import Any

import numpy as np

from faying.numerics.product import combined, product
from faying.typing import Array

CLOSE = 1e-14  # of what is orthonormal: overlap up to which it is
ROWS = 10_000  # that are combined at a time
CHUNK_VECTORS, CHUNK_NUMBERS = 8, 2_000_000  # vectors, or numbers, that are worked on together: the larger
ROOM_FACTOR, ROOM_NUMBERS = 10, 24_000_000  # times the first columns, or numbers, for which there is room: the smaller
ROUNDING = 1e-13  # of the largest: squares of directions below it are rounding


def chunks(size: int, count: int) -> list[slice]:
    """Slices of `count` vectors (size,), as many at a time as take little room: work takes some times that."""
    width = max(CHUNK_VECTORS, CHUNK_NUMBERS // size)
    return [slice(k, k + width) for k in range(0, count, width)]


def extension(new: Array, basis: Array, image: Array, operator: Any, *, least: float = 0.0) -> tuple[Array, Array]:
    """Directions that columns add to a basis whose image is kept.

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
    new = new @ _directions(new.T @ product(operator, new), least)
    new = new - basis @ (image.T @ new)  # what rounding leaves of the first pass
    moved = product(operator, new)
    correction = _inverse_root(new.T @ moved)  # a direction that was small has lost digits of its size
    return new @ correction, moved @ correction


def _directions(gram: Array, least: float) -> Array:
    """Combinations (k, r) of columns with products `gram` (k, k), orthonormal, the largest last.

    least: square below which a direction is left out; what is rounding beside the largest is left out anyhow.
    """
    squares, turn = np.linalg.eigh((gram + gram.T) / 2)
    keep = squares > max(least, ROUNDING * squares.max(initial=0.0))
    return np.asarray(turn[:, keep] / np.sqrt(squares[keep]))


def _inverse_root(gram: Array) -> Array:
    """What makes columns with products `gram` (k, k), near to 1, orthonormal with the least change."""
    squares, turn = np.linalg.eigh((gram + gram.T) / 2)
    return np.asarray((turn / np.sqrt(squares)) @ turn.T)


class Span:
    """Vectors (n, m), orthonormal with the mass, and a stiffness projected on them.

    Their images are not kept: a product of a sparse matrix with a few combinations of them costs less than the same
    combinations of the images, and these would take twice the room of the vectors.

    Args:
        mass, stiffness: sparse (n, n).
        first: the vectors to begin with.
    """

    def __init__(self, mass: Any, stiffness: Any, first: Array) -> None:
        self.mass, self.stiffness = mass, stiffness
        self._columns = GrowingColumns(first)
        parts = [self.vectors.T @ product(stiffness, self.vectors[:, some]) for some in chunks(*self.vectors.shape)]
        self.small: Array = np.concatenate([np.zeros((self.vectors.shape[1], 0)), *parts], axis=1)

    @property
    def vectors(self) -> Array:
        """The vectors (n, m)."""
        return self._columns.values

    def add(self, new: Array, *, least: float = 0.0) -> int:
        """Add what is new in columns (n, k); return how many vectors that makes.

        least: share of a column's square, in the mass, that must be new; what is rounding is left out anyhow.
        """
        basis, moved = self.vectors, product(self.mass, new)
        size = np.sqrt(np.einsum("ij,ij->j", new, moved))
        new = (new - combined(basis, basis.T @ moved)) / size
        moved = product(self.mass, new)
        turn = _directions(new.T @ moved, least)
        new, moved = combined(new, turn), moved @ turn
        image = product(self.stiffness, new)
        # the basis is long, and it is its reading that takes time
        left, side = np.split(basis.T @ np.concatenate([moved, image], axis=1), 2, axis=1)
        gram = new.T @ moved - left.T @ left  # a direction that was small has lost digits of its size
        corner = new.T @ image
        del moved, image  # before there is room for more vectors
        if np.abs(left).max(initial=0.0) > CLOSE:
            known = self.small @ left
            new = new - combined(basis, left)
            corner += left.T @ known - left.T @ side - side.T @ left
            side = side - known
        correction = _inverse_root(gram)
        side, corner = side @ correction, correction @ corner @ correction
        self.small = np.block([[self.small, side], [side.T, (corner + corner.T) / 2]])
        del basis  # or the columns could not grow where they are
        self._columns.add(combined(new, correction))
        return int(new.shape[1])

    def turn(self, rotation: Array) -> None:
        """Replace the vectors by combinations of them, the columns of `rotation` (m, k), orthonormal."""
        self._columns.turn(rotation)
        self.small = rotation.T @ self.small @ rotation


class GrowingColumns:
    """Columns (n, m) of a matrix that grows, without a copy of all of it for each that comes.

    ahead: times the first columns, for which there is room from the beginning.
    """

    def __init__(self, first: Array, *, ahead: int = ROOM_FACTOR) -> None:
        self._size, self._used = first.shape
        # column by column; what is not written yet takes no memory
        self._numbers = np.empty(max(first.size, min(ahead * first.size, ROOM_NUMBERS)))
        self.values[:] = first

    @property
    def values(self) -> Array:
        """The columns (n, m)."""
        return self._numbers[: self._size * self._used].reshape(self._size, self._used, order="F")

    def add(self, new: Array) -> None:
        """Put columns (n, k) behind those that are here."""
        before, self._used = self._used, self._used + new.shape[1]
        if self._size * self._used > len(self._numbers):
            self._grow()
        self.values[:, before:] = new

    def turn(self, rotation: Array) -> None:
        """Replace the columns (n, m) by combinations of them, k <= m columns of `rotation` (m, k), in their place."""
        columns = self.values
        self._used = rotation.shape[1]
        for begin in range(0, self._size, ROWS):
            here = columns[begin : begin + ROWS]
            here[:, : self._used] = combined(here, rotation)

    def _grow(self) -> None:
        """Make room for all columns."""
        size = self._size * self._used
        try:
            self._numbers.resize(size)  # the system moves its pages: no second copy in memory
        except ValueError:  # somebody looks at it
            numbers = np.empty(size)
            numbers[: len(self._numbers)] = self._numbers
            self._numbers = numbers
