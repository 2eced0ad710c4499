"""A preload among those of a study."""

from collections.abc import Sequence

import numpy as np

from faying.typing import Array

SAME = 1e-3  # relative: messages and tables give a preload with four digits, and what they print is found again


def preload_index(preloads: Sequence[float] | Array, wanted: float) -> int | None:
    """Index of the preload [N] nearest to one that is wanted, None where none lies within a thousandth of it."""
    if not len(preloads):
        return None
    index = int(np.argmin(np.abs(np.asarray(preloads) - wanted)))
    return index if abs(preloads[index] - wanted) <= SAME * abs(wanted) else None
