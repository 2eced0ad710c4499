"""Vibration modes of a structure, free, joined or tied."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.errors import NotConverged
from faying.fe.mesh import Array
from faying.fe.solve import Factorisation, factorise

SEED = 20240611


@dataclass(frozen=True, kw_only=True)
class Modes:
    """Lowest modes in rising order: frequencies [Hz] (m,), mass-normalised shapes (unknowns, m), what solved them.

    frequencies below zero do not occur: a rigid motion that rounding makes slightly negative is given as its size.
    """

    frequencies: Array
    shapes: Array
    factorisation: Factorisation
    shift: float


def lowest_modes(
    stiffness: Any,
    mass: Any,
    count: int,
    *,
    shift_frequency: float,
    solver: str | None = None,
) -> Modes:
    """Find the `count` lowest modes by Lanczos iteration with a negative shift.

    stiffness [N/m], mass [kg]: sparse and symmetric; shift_frequency [Hz] sets the shift -(2 pi f)^2, at which
    K + |shift| M is positive definite even for free bodies. Raises NotConverged where ARPACK stops short.
    """
    from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

    shift = (2 * np.pi * shift_frequency) ** 2
    factor = factorise((stiffness + shift * mass).tocsr(), solver)
    n = stiffness.shape[0]
    inverse = LinearOperator((n, n), matvec=factor.solve, dtype=float)
    first = np.random.default_rng(SEED).standard_normal(n)
    try:
        _, shapes = eigsh(stiffness, k=count, M=mass, sigma=-shift, OPinv=inverse, v0=first,
                               ncv=min(n, max(2 * count + 1, 20)), tol=1e-11)  # fmt: skip
    except ArpackNoConvergence as fault:
        raise NotConverged(
            f"{len(fault.eigenvalues)} of {count} modes converged; ask for fewer or refine the mesh"
        ) from None
    # Rayleigh quotients remove what the shifted inverse lost on the lowest eigenvalues
    sizes = np.einsum("im,im->m", shapes, mass @ shapes)
    values = np.einsum("im,im->m", shapes, stiffness @ shapes) / sizes
    shapes = shapes / np.sqrt(sizes)
    order = np.argsort(values)
    return Modes(
        frequencies=np.sqrt(np.abs(values[order])) / (2 * np.pi),
        shapes=shapes[:, order],
        factorisation=factor,
        shift=shift,
    )
