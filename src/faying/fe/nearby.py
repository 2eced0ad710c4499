"""Modes of a structure whose joints have changed, from the modes and the factorisation of what it was."""

from typing import Any

import numpy as np

from faying.errors import NotConverged
from faying.fe.modes import Modes
from faying.typing import Array

ROUNDS = 40  # enrichments of the basis
LEAST = 1e-10  # share of a new vector that must be new


def nearby_modes(
    modes: Modes, stiffness: Any, mass: Any, *, rigid: int, count: int, tolerance: float = 1e-7
) -> tuple[Array, Array]:
    """Find the modes under another stiffness without another factorisation.

    The basis is that of the modes, enriched by what the new modes leave in the new equations, sent through the old
    factorisation: few rounds where springs change by factors, more where they change by orders of magnitude.

    Args:
        modes: those of the stiffness before, rigid motions first.
        stiffness: [N/m] after, sparse (n, n); rigid motions must still be free of it.
        mass: [kg], sparse (n, n).
        rigid: how many of the modes are rigid motions.
        count: how many elastic modes are wanted, at most those that `modes` has.
        tolerance: of the estimated relative error of the squared frequencies.

    Returns:
        Frequencies [Hz] (count,) and shapes (n, count), mass-normalised.

    Raises:
        NotConverged: where the tolerance is not reached.
    """
    from scipy.linalg import eigh

    basis = modes.shapes
    small = basis.T @ (stiffness @ basis)
    moved = np.asarray(mass @ basis)
    for _ in range(ROUNDS):
        values, inner = eigh((small + small.T) / 2)
        order = np.argsort(np.abs(values))[rigid : rigid + count]
        squared, shapes = values[order], basis @ inner[:, order]
        left = stiffness @ shapes - (mass @ shapes) * squared
        solved = modes.factorisation.solve(np.asfortranarray(left))
        error = np.abs(np.einsum("ij,ij->j", left, solved)) / np.abs(squared)
        if error.max() < tolerance:
            return np.sqrt(np.abs(squared)) / (2 * np.pi), shapes
        new = solved[:, error > tolerance / 10]
        new = new / np.sqrt(np.einsum("ij,ij->j", new, mass @ new))
        for _ in range(2):
            new = new - basis @ (moved.T @ new)
        weights, rotation = np.linalg.eigh(new.T @ (mass @ new))
        kept = weights > LEAST
        if not kept.any():
            break
        new = new @ (rotation[:, kept] / np.sqrt(weights[kept]))
        image = stiffness @ new
        side = basis.T @ image
        small = np.block([[small, side], [side.T, new.T @ image]])
        basis = np.concatenate([basis, new], axis=1)
        moved = np.concatenate([moved, mass @ new], axis=1)
    raise NotConverged(
        f"modes under changed springs: the estimated error stays at {error.max():.1e} (tolerance {tolerance:.0e})"
    )
