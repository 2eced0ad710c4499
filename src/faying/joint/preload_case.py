"""One preload of a structure: the force that each bolt is tightened to, and in which order."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faying.checks import number
from faying.errors import InputError
from faying.typing import Array
from faying.units import load_text

SAME = 1e-3  # relative: messages and tables give a preload with four digits, and what they print is found again


@dataclass(frozen=True)
class PreloadCase:
    """The force of every bolt at one preload.

    Args:
        forces: Force [N] of each bolt (b,), above 0, in the order of the structure's bolts; none where it has no bolts.
        order: Indices of the bolts in the order of tightening, any of them more than once; None where all are pulled at
            once.
    """

    forces: tuple[float, ...]
    order: tuple[int, ...] | None = None

    @property
    def preload(self) -> float:
        """Force of the first bolt [N], by which results know the case; 0 without bolts."""
        return self.forces[0] if self.forces else 0.0

    @property
    def name(self) -> str:
        """What messages call it: "12 kN"."""
        return load_text(self.preload)


def preload_index(
    preloads: Sequence[float] | Array, wanted: float | str | None, *, name: str = "preload", of: str = "the study"
) -> int:
    """Return which of some preloads [N] is wanted, to a thousandth of it.

    wanted: a force [N], or text with a unit; the last one where None. name: what asks for it; of: what has them. Raises
    InputError where none is so near.
    """
    if wanted is None:
        return len(preloads) - 1
    force = number(wanted, name, "N", least=0, ends="()" if np.all(preloads) else "[)")
    index = int(np.argmin(np.abs(np.asarray(preloads) - force))) if len(preloads) else -1
    if index < 0 or abs(preloads[index] - force) > SAME * force:
        known = ", ".join(load_text(one) for one in preloads)
        raise InputError(f"{name} = {load_text(force)}: {of} has no such preload; it has {known or 'none'}")
    return index
