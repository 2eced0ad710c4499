"""Vibration modes of a structure, free, joined or tied, real and with interface loss."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

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


@dataclass(frozen=True, kw_only=True)
class DampedModes:
    """Frequencies [Hz] and loss factors [-] of the modes with hysteretic loss, and the estimated error of the latter."""

    frequencies: Array
    loss_factors: Array
    residual: Array


def damped_modes(modes: Modes, stiffness: Any, mass: Any, loss: Any, *, rigid: int) -> DampedModes:
    """Find complex modes of K + i C by projection on the real modes enriched with the response to C.

    loss: C, sparse: the imaginary part of the stiffness [N/m]; rigid: how many of the lowest modes are rigid motions.
    Basis: elastic modes and A^-1 C modes with A = K + |shift| M. residual (m,): norm of what the projected mode leaves in
    the full equations, in the A^-1 norm, relative: the relative error of the complex eigenvalue is of its square.
    """
    from scipy.linalg import eig, eigh

    elastic = modes.shapes[:, rigid:]
    driven = loss @ elastic
    corrections = modes.factorisation.solve(driven)
    basis = np.concatenate([elastic, corrections / np.linalg.norm(corrections, axis=0)], axis=1)
    gram = basis.T @ (mass @ basis)
    size = np.sqrt(np.diag(gram))
    values, vectors = eigh(gram / np.outer(size, size))
    keep = values > 1e-12
    basis = (basis / size) @ (vectors[:, keep] / np.sqrt(values[keep]))
    small_k, small_c = basis.T @ (stiffness @ basis), basis.T @ (loss @ basis)
    squared, mixed = eig(small_k + 1j * small_c)
    return _follow(modes, rigid, squared, mixed, basis, stiffness, mass, loss)


def _follow(
    modes: Modes,
    rigid: int,
    squared: NDArray[Any],
    mixed: NDArray[Any],
    basis: Array,
    stiffness: Any,
    mass: Any,
    loss: Any,
) -> DampedModes:
    """Pick for each real mode, in turn, the complex one that overlaps it most."""
    elastic = modes.shapes[:, rigid:]
    overlap = np.abs((elastic.T @ (mass @ basis)) @ mixed) / np.linalg.norm(mixed, axis=0)
    picked: list[int] = []
    for row in overlap:
        ranked = [int(i) for i in np.argsort(-row) if int(i) not in picked]
        picked.append(ranked[0])
    values = squared[picked]
    order = np.argsort(values.real)
    values, vectors = values[order], basis @ mixed[:, picked][:, order]
    miss = stiffness @ vectors + 1j * (loss @ vectors) - (mass @ vectors) * values
    solved = modes.factorisation.solve(np.ascontiguousarray(miss.real)) + 1j * modes.factorisation.solve(
        np.ascontiguousarray(miss.imag)
    )
    numerator = np.sqrt(np.abs(np.einsum("im,im->m", miss.conj(), solved)))
    residual = numerator / np.sqrt(np.abs(values) * np.abs(np.einsum("im,im->m", vectors.conj(), mass @ vectors)))
    return DampedModes(
        frequencies=np.sqrt(values.real) / (2 * np.pi), loss_factors=values.imag / values.real, residual=residual
    )
