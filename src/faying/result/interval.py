"""The interval of each frequency: what is not known, how far it moves the frequency, and what would narrow it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.typing import ArrayLike

from faying.style import Summary
from faying.typing import Array

OF_PARTS = ("mesh", "structure", "parts", "mode")  # sources that no stiffness of a joint bounds
MAX_ROWS = 10  # of a summary
MIN_SQUARE = 1e-300  # where nothing moves a frequency


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Interval(Summary):
    """Best estimate of every frequency, and its 5 to 95 %.

    Each source moves ln f by itself, to `offsets[:, 0]` at its 5 % and `offsets[:, 1]` at its 95 % end. Sources are
    independent: their middles add to that of the whole, the best estimate, and the squares of their widths add. Where a
    value that is assumed lies at an end of what it may be, so does the frequency as modelled.

    Args:
        sources: what is not known, s names.
        offsets: of ln f (s, 2, loads, modes).
        frequencies: as modelled [Hz] (loads, modes), each assumed value as it is.
        free, bonded: frequencies [Hz] (modes,) with the faces apart and bonded, which no stiffness of a joint passes;
            what is not known of the parts does.

    Source:
        First-order propagation: JCGM 100:2008 (GUM), equation (10).
    """

    sources: tuple[str, ...]
    offsets: Array
    frequencies: Array
    free: ArrayLike = 0.0
    bonded: ArrayLike = np.inf

    @property
    def low(self) -> Array:
        """5 % [Hz] (loads, modes)."""
        return self._at(-0.5)

    @property
    def best(self) -> Array:
        """The best estimate, the median of all that is not known [Hz] (loads, modes)."""
        return self._at(0.0)

    @property
    def high(self) -> Array:
        """95 % [Hz] (loads, modes)."""
        return self._at(0.5)

    def _at(self, share: float) -> Array:
        """Frequencies so many widths from the middle, between those of free and of bonded faces of such parts."""
        middles = self.offsets.mean(axis=1)
        of_parts = [k for k, name in enumerate(self.sources) if name in OF_PARTS]
        parts, room = middles[of_parts].sum(axis=0), np.sqrt(self._squares[of_parts].sum(axis=0)) / 2
        found = self.frequencies * np.exp(middles.sum(axis=0) + share * self.width)
        low, high = np.asarray(self.free) * np.exp(parts - room), np.asarray(self.bonded) * np.exp(parts + room)
        return np.asarray(np.clip(found, low, high))

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return 5 %, the best estimate and 95 % of each mode at the greatest preload."""
        ends = zip(self.low[-1], self.best[-1], self.high[-1], strict=True)
        rows = {f"mode {k}": " .. ".join(f"{one:.4g}" for one in three) for k, three in enumerate(ends, 1)}
        more = len(rows) - MAX_ROWS
        if more > 0:
            rows = dict(list(rows.items())[:MAX_ROWS]) | {"": f"{more} more modes"}
        return "5 % .. best estimate .. 95 % [Hz] at the greatest preload", rows

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

    def between(self, free: Array | None, bonded: Array | None) -> "Interval":
        """The interval between frequencies [Hz] of free and of bonded faces; as it is where there are none."""
        return self if free is None or bonded is None else replace(self, free=free, bonded=bonded)

    def narrowed(self, left: Mapping[str, float]) -> "Interval":
        """The interval where sources are known better.

        left: what is left of the spread of a source, by its name [-].
        """
        factors = np.array([left.get(name, 1.0) for name in self.sources])[:, None, None, None]
        middle = self.offsets.mean(axis=1, keepdims=True)
        return replace(self, offsets=middle + (self.offsets - middle) * factors)
