"""What variants need of a basis, and how much of it may go without any of them losing more than is allowed."""

from collections.abc import Sequence

import numpy as np

from faying.typing import Array

# times the tolerance: what the leading part of the basis for vibration may miss, from which errors are estimated
COARSER = 140.0
FEW_NEED, FEW_COARSE = 0.3, 30.0  # the same of sums over few variants, for all of the basis and for its leading part
ENOUGH = 1.5  # variants learnt, for each combination of displacements that they need


def padded(columns: Sequence[Array], size: int) -> Array:
    """Columns of coefficients in a basis of `size` vectors that has grown since, one behind the other (size, k)."""
    grown = [np.pad(one, ((0, size - len(one)), (0, 0))) for one in columns]
    return np.concatenate([np.zeros((size, 0)), *grown], axis=1)


def needed(shares: Array, most: float) -> int:
    """How many leading rows of `shares` (d, k) have to stay, so that no column loses more of its square than `most`."""
    lost = np.cumsum(shares[::-1] ** 2, axis=0).max(axis=1, initial=0.0)
    return len(shares) - int(np.count_nonzero(lost <= most))


def for_modes(columns: Array, tolerance: float, *, learnt: bool) -> tuple[Array, int]:
    """Combinations (d, r) of a basis for vibration to be kept, most needed first, and how many make its coarser part.

    columns (d, k): modes, of length 1 in the energy of the basis; tolerance: of an eigenvalue; learnt: whether they are
    those of many variants, none of which may then lose more than the tolerance; of few the sum counts, since what lies
    between them needs more than they do.
    """
    rotation, size, _ = np.linalg.svd(columns, full_matrices=False)
    if learnt:
        kept, coarse = (needed(rotation.T @ columns, most) for most in (tolerance, COARSER * tolerance))
    else:
        kept, coarse = (int(np.count_nonzero(size**2 > most * tolerance)) for most in (FEW_NEED, FEW_COARSE))
    return rotation[:, :kept], coarse


def for_states(states: Array, tolerance: float, learnt: int) -> Array | None:
    """Combinations (s, r) of a basis for equilibrium to be kept, most needed first; None where all of it stays.

    states (s, k): displacements over the root of the energy of their joints; tolerance: of the root of that energy that
    none may lose; learnt: how many of them were evaluated in the basis and not trained on. Fewer than three for two
    combinations that they need are too few to tell what others need.
    """
    if not learnt:
        return None
    rotation, _, _ = np.linalg.svd(states, full_matrices=False)
    count = needed(rotation.T @ states, tolerance**2)
    return rotation[:, :count] if ENOUGH * count <= learnt else None
