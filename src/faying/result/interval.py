"""The interval of each frequency: what is not known, how far it moves the frequency, and what would narrow it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import ArrayLike

from faying.typing import Array

OF_PARTS = ("mesh", "structure", "mode")  # sources that no stiffness of a joint bounds
MIN_SQUARE = 1e-300  # where nothing moves a frequency


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Interval:
    """5 to 95 % of every frequency.

    Each source moves ln f by itself, to `offsets[:, 0]` at its 5 % and `offsets[:, 1]` at its 95 % end. Sources are
    independent: their middles add, and so do the squares of their widths. Where a value that is assumed lies at an end
    of what it may be, so does the frequency.

    Args:
        sources: what is not known, s names.
        offsets: of ln f (s, 2, loads, modes).

    Source:
        First-order propagation: JCGM 100:2008 (GUM), equation (10).
    """

    sources: tuple[str, ...]
    offsets: Array

    def ends(self, frequencies: Array, free: ArrayLike = 0.0, bonded: ArrayLike = np.inf) -> tuple[Array, Array]:
        """5 and 95 % [Hz] of frequencies [Hz] (loads, modes).

        free, bonded: frequencies [Hz] (modes,) with the faces apart and bonded, which no stiffness of a joint passes;
        what is not known of the parts does.
        """
        middle = self.offsets.mean(axis=1).sum(axis=0)
        of_parts = [k for k, name in enumerate(self.sources) if name in OF_PARTS]
        room = np.exp(np.sqrt(self._squares[of_parts].sum(axis=0)) / 2)
        low = np.maximum(frequencies * np.exp(middle - self.width / 2), np.asarray(free) / room)
        return low, np.minimum(frequencies * np.exp(middle + self.width / 2), np.asarray(bonded) * room)

    @property
    def _squares(self) -> Array:
        """Squares of the distance of both ends (s, loads, modes)."""
        return np.asarray((self.offsets[:, 1] - self.offsets[:, 0]) ** 2)

    @property
    def width(self) -> Array:
        """From 5 to 95 % in ln f (loads, modes) [-]."""
        return np.asarray(np.sqrt(self._squares.sum(axis=0)))

    @property
    def shares(self) -> Array:
        """Share of each source in the square of the width (s, loads, modes) [-]; sums to 1."""
        squares = self._squares
        return np.asarray(squares / np.maximum(squares.sum(axis=0), MIN_SQUARE))

    def narrowed(self, left: Mapping[str, float]) -> "Interval":
        """The interval where sources are known better.

        left: what is left of the spread of a source, by its name [-].
        """
        factors = np.array([left.get(name, 1.0) for name in self.sources])[:, None, None, None]
        middle = self.offsets.mean(axis=1, keepdims=True)
        return Interval(sources=self.sources, offsets=middle + (self.offsets - middle) * factors)
