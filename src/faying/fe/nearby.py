"""Modes of a structure whose joints have changed, from the modes and the factorisation of what it was."""

from typing import Any

import numpy as np

from faying.errors import NotConverged
from faying.fe.modes import Modes
from faying.fe.span import Span
from faying.typing import Array

ROUNDS = 40  # enrichments of the basis
LEAST = 1e-10  # share of a new vector that must be new


def nearby_modes(
    modes: Modes,
    stiffness: Any,
    mass: Any,
    *,
    rigid: int,
    count: int,
    tolerance: float = 1e-7,
    more: Array | None = None,
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
        more: vectors (n, k) that are likely to be near the new modes, such as those of another stiffness between.

    Returns:
        Frequencies [Hz] (count,) and shapes (n, count), mass-normalised.

    Raises:
        NotConverged: where the tolerance is not reached.
    """
    from scipy.linalg import eigh

    span = Span(mass, stiffness, modes.shapes)
    if more is not None and more.shape[1]:
        span.add(more / np.sqrt(np.einsum("ij,ij->j", more, mass @ more)), least=LEAST)
    for _ in range(ROUNDS):
        values, inner = eigh(span.small[0])
        order = np.argsort(np.abs(values))[rigid : rigid + count]
        squared, inner = values[order], inner[:, order]
        left = span.force @ inner - (span.momentum @ inner) * squared
        solved = modes.factorisation.solve(np.asfortranarray(left))
        error = np.abs(np.einsum("ij,ij->j", left, solved)) / np.abs(squared)
        if error.max() < tolerance:
            return np.sqrt(np.abs(squared)) / (2 * np.pi), span.vectors @ inner
        new = solved[:, error > tolerance / 10]
        new = new / np.sqrt(np.einsum("ij,ij->j", new, mass @ new))
        if not span.add(new, least=LEAST):
            break
    raise NotConverged(
        f"modes under changed springs: the estimated error stays at {error.max():.1e} (tolerance {tolerance:.0e})"
    )
