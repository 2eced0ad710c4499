"""Vectors that grow in number, orthonormal in one energy, with what joints and operators make of them."""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from faying.numerics.product import product
from faying.numerics.span import ROUNDING, GrowingColumns, extension
from faying.typing import Array


@dataclass
class Basis:
    """Vectors (n, m), orthonormal in the energy of `reference`, with what operators, joints and rows make of them.

    small: of each operator, vectors.T @ operator @ vectors; relative: motion of the joints' points; seen: of each of
    the `rows` (k, n), rows @ vectors.
    """

    reference: Any
    operators: tuple[Any, ...]
    interfaces: Sequence[Any]
    rigid: Array
    rigid_momentum: Array
    rows: Sequence[Array] = ()
    small: list[Array] = field(init=False)
    relative: list[Array] = field(init=False)
    at_rows: list[Array] = field(init=False)

    def __post_init__(self) -> None:
        nothing = np.zeros((self.reference.shape[0], 0))
        self._vectors, self._image = GrowingColumns(nothing), GrowingColumns(nothing)
        self.small = [np.zeros((0, 0)) for _ in self.operators]
        self.relative = [np.zeros((3 * len(interface.weights), 0)) for interface in self.interfaces]
        self.at_rows = [np.zeros((len(rows), 0)) for rows in self.rows]

    @property
    def vectors(self) -> Array:
        """The vectors (n, m)."""
        return self._vectors.values

    def branch(self) -> "Basis":
        """A basis that begins as this one and grows by itself; room is shared, so that only one may grow at a time."""
        made = copy(self)
        made._vectors, made._image, made.small = copy(self._vectors), copy(self._image), list(self.small)
        return made

    def add(self, new: Array, *, least: float = 0.0) -> int:
        """Add columns (n, k); return how many directions were new.

        least: energy, in the units of the columns, below which a direction is left out; rounding is left out anyhow.
        """
        # what rounding leaves of rigid motions would grow with every solve, and come back as modes of no frequency
        new = new - self.rigid @ (self.rigid_momentum.T @ new)
        scale = float(np.einsum("ij,ij->j", new, product(self.reference, new)).max())
        found, image = extension(
            new, self.vectors, self._image.values, self.reference, least=max(least, ROUNDING * scale)
        )
        self.append(found[:, ::-1], image[:, ::-1])
        return int(found.shape[1])

    def append(self, new: Array, image: Array | None = None) -> None:
        """Take columns (n, k) as they are: orthonormal, with each other and with those that are here.

        image: reference @ new, computed where None.
        """
        self._image.add(product(self.reference, new) if image is None else image)
        # the vectors are read once for all operators: they are far more than what is added
        images = np.concatenate([product(operator, new) for operator in self.operators], axis=1)
        sides, corners = self.vectors.T @ images, new.T @ images
        for i, (side, corner) in enumerate(
            zip(*(np.split(x, len(self.small), axis=1) for x in (sides, corners)), strict=True)
        ):
            self.small[i] = np.block([[self.small[i], side], [side.T, (corner + corner.T) / 2]])
        moved = [interface.relative @ new for interface in self.interfaces]
        self.relative = [np.concatenate(pair, axis=1) for pair in zip(self.relative, moved, strict=True)]
        self.at_rows = [
            np.concatenate([old, rows @ new], axis=1) for old, rows in zip(self.at_rows, self.rows, strict=True)
        ]
        self._vectors.add(new)

    def turn(self, rotation: Array) -> None:
        """Replace the vectors by combinations of them, the columns of `rotation` (size, k), orthonormal."""
        for kept in (self._vectors, self._image):
            kept.turn(rotation)
        self.small = [rotation.T @ matrix @ rotation for matrix in self.small]
        self.relative = [relative @ rotation for relative in self.relative]
        self.at_rows = [values @ rotation for values in self.at_rows]
