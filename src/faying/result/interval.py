"""The interval of each frequency: what is not known, how far it moves the frequency, and what would narrow it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self, final

import numpy as np
from numpy.typing import ArrayLike

from faying.numerics.follow import between_by_rank
from faying.result.fields import Arrays, variable
from faying.typing import Array

OF_PARTS = ("mesh", "structure", "parts", "mode")  # sources that no stiffness of a joint bounds
MAX_ROWS = 10  # of a summary
IN = "modes/interval"  # of a file
MIN_SQUARE = 1e-300  # where nothing moves a frequency


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Interval(Arrays):
    """Best estimate of every frequency, and its 5 to 95 %.

    Each source moves ln f from the best estimate by itself, to `offsets[:, 0]` at its 5 % and `offsets[:, 1]` at its
    95 % end. Sources are independent: the squares of what they move a frequency down by add, and the squares of what
    they move it up by.

    Args:
        sources: what is not known, s names.
        offsets: of ln f (s, 2, loads, modes).
        low, best, high: 5 %, the best estimate (the median of all that is not known) and 95 % [Hz] (loads, modes).
        moved: by how much what is known of the parts moves ln f, and what bounds it (loads, modes) [-].

    Source:
        First-order propagation: JCGM 100:2008 (GUM), equation (10), on each side by itself.
    """

    sources: tuple[str, ...]
    offsets: Array = variable(
        "source end load mode", "1", "change of ln f at 5 and at 95 % of one thing that is not known", f"{IN}_offsets"
    )
    best: Array = variable(
        "load mode",
        "Hz",
        "best estimate of the frequency, the median of all that is not known",
        f"{IN}_best",
        shown="best",
    )
    low: Array = variable("load mode", "Hz", "5 % of the frequency, of all that is not known", f"{IN}_low", shown="5 %")
    high: Array = variable(
        "load mode", "Hz", "95 % of the frequency, of all that is not known", f"{IN}_high", shown="95 %"
    )
    moved: Array = variable("load mode", "1", "change of ln f by what is known of the parts", f"{IN}_moved")

    @classmethod
    def about(cls, best: Array, offsets: Mapping[str, Array], moved: ArrayLike = 0.0) -> Self:
        """From the best estimates [Hz] (loads, modes), and what each source moves ln f by (2, loads, modes)."""
        ends = np.stack(list(offsets.values()))
        made = cls(
            sources=tuple(offsets),
            offsets=ends,
            low=best,
            best=best,
            high=best,
            moved=np.broadcast_to(moved, best.shape),
        )
        down, up = made._distances
        return replace(made, low=best * np.exp(-down), high=best * np.exp(up))

    def between(self, free: Array | None, bonded: Array | None) -> "Interval":
        """The interval between frequencies [Hz] (modes,) with free and with bonded faces as modelled, if known.

        No stiffness of a joint passes them; what is known and not known of the parts does.
        """
        if free is None or bonded is None:
            return self
        of_parts = [k for k, name in enumerate(self.sources) if name in OF_PARTS]
        room = np.sqrt(self._squares[of_parts].sum(axis=0)) / 2
        least, most = free * np.exp(self.moved - room), bonded * np.exp(self.moved + room)
        low, best, high = (between_by_rank(one, least, most) for one in (self.low, self.best, self.high))
        return replace(self, low=np.minimum(low, best), best=best, high=np.maximum(high, best))

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return 5 %, the best estimate and 95 % of each mode at the last preload."""
        ends = zip(self.low[-1], self.best[-1], self.high[-1], strict=True)
        texts = [" .. ".join(f"{one:.4g}" for one in three) for three in ends]
        rows = {f"mode {k}": text for k, text in enumerate(texts[:MAX_ROWS], 1)}
        rows |= {"": f"{len(texts) - MAX_ROWS} more modes"} if len(texts) > MAX_ROWS else {}
        return "5 % .. best estimate .. 95 % [Hz] at the last preload", rows

    @property
    def _squares(self) -> Array:
        """Squares of the distance of both ends (s, loads, modes)."""
        return np.asarray((self.offsets[:, 1] - self.offsets[:, 0]) ** 2)

    @property
    def _distances(self) -> Array:
        """From the best estimate down to 5 % and up to 95 %, in ln f (2, loads, modes) [-]."""
        down, up = np.minimum(self.offsets.min(axis=1), 0.0), np.maximum(self.offsets.max(axis=1), 0.0)
        return np.asarray(np.linalg.norm([down, up], axis=1))

    @property
    def ends(self) -> Array:
        """5 and 95 % of each frequency (2, loads, modes) [Hz]."""
        return np.stack([self.low, self.high])

    @property
    def width(self) -> Array:
        """From 5 to 95 % in ln f (loads, modes) [-]."""
        return np.asarray(self._distances.sum(axis=0))

    @property
    def shares(self) -> Array:
        """Share of each source in the square of the width (s, loads, modes) [-]; sums to 1."""
        squares = self._squares
        return np.asarray(squares / np.maximum(squares.sum(axis=0), MIN_SQUARE))

    def narrowed_width(self, left: Mapping[str, float]) -> Array:
        """The width (loads, modes) [-] where sources are known better.

        left: what is left of the spread of a source, by its name [-].
        """
        factors = np.array([left.get(name, 1.0) for name in self.sources])[:, None, None, None]
        return replace(self, offsets=self.offsets * factors).width
