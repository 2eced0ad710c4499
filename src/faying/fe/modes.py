"""Vibration modes of a structure, free, joined or bonded."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.errors import InputError, NotConverged
from faying.fe.solve import Factorisation, factorise
from faying.typing import Array

SEED = 20240611
WIDTH = 8  # of a block of vectors: a factor is read once for all of them
MOST_STEPS = 1200  # vectors of the basis
SAME = 1e-6  # relative difference of eigenvalues of A^-1 M below which they may be one
NOTHING = 1e-13  # of the size of a block: what the basis leaves of it is rounding, and the basis is whole
TOLERANCE = 1e-8  # residual of A^-1 M x = theta x over theta; the error of theta is of its square over the gap


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
    """Find the `count` lowest modes by block Lanczos iteration with a negative shift.

    stiffness [N/m], mass [kg]: sparse and symmetric; shift_frequency [Hz] sets the shift -(2 pi f)^2, at which
    K + |shift| M is positive definite even for free bodies. Raises InputError where more modes are asked for than there are
    masses, or memory is short, and NotConverged where the iteration stops short.
    """
    shift = (2 * np.pi * shift_frequency) ** 2
    most = int(np.count_nonzero(mass.diagonal() > 0))
    if not 0 < count <= most:
        raise InputError(f"{count} modes of a structure with {most} unknowns that have mass; ask for 1 to {most}")
    factor = factorise((stiffness + shift * mass).tocsr(), solver)
    inverse, shapes = _krylov(factor, mass, count, min(WIDTH, stiffness.shape[0]))
    if len(inverse) < count:
        raise InputError(f"{count} modes of a structure whose masses allow {len(inverse)}; ask for 1 to {len(inverse)}")
    values, shapes = _ritz(stiffness, mass, shapes)
    if np.any(np.abs(np.sort(values + shift) * np.sort(inverse)[::-1] - 1) > SAME):
        # motions without mass have crept in, which the projection on the mass does not see: one more solve has none
        shapes, _, _ = _orthonormal(factor.solve(np.asfortranarray(mass @ shapes)), mass)
        values, shapes = _ritz(stiffness, mass, shapes)
    order = np.argsort(np.abs(values))
    return Modes(
        frequencies=np.sqrt(np.abs(values[order])) / (2 * np.pi),
        shapes=shapes[:, order],
        factorisation=factor,
        shift=shift,
    )


def _ritz(stiffness: Any, mass: Any, shapes: Array) -> tuple[Array, Array]:
    """Eigenvalues and vectors in the span of the shapes: restores what the shifted inverse loses on the lowest."""
    from scipy.linalg import eigh

    small, gram = shapes.T @ (stiffness @ shapes), shapes.T @ (mass @ shapes)
    values, turn = eigh((small + small.T) / 2, (gram + gram.T) / 2)
    return values, shapes @ turn


def _krylov(factor: Factorisation, mass: Any, count: int, width: int) -> tuple[Array, Array]:
    """The greatest eigenvalues (count,) of A^-1 M and their vectors (n, count), orthonormal with the mass.

    Fewer where the mass has a lower rank.

    Block Lanczos with full reorthogonalisation (Grimes, Lewis, Simon 1994, doi:10.1137/S0895479888151111), without
    restarts: a factor takes far more memory than the basis. An eigenvalue that comes as often as the blocks are wide may
    come more often than that, so that wider ones are tried.
    """
    n = mass.shape[0]
    generator = np.random.default_rng(SEED)
    last = factor.solve(mass @ generator.standard_normal((n, width)))
    last, momentum, _ = _orthonormal(last, mass)
    before, rows = np.zeros((n, 0)), np.zeros((last.shape[1], 0))
    basis, projected = last, np.zeros((0, 0))
    for _ in range(MOST_STEPS // width):
        image = factor.solve(momentum)
        corner = momentum.T @ image
        corner = (corner + corner.T) / 2
        old = len(projected)
        edge = np.zeros((last.shape[1], old))
        edge[:, old - before.shape[1] :] = rows
        projected = np.block([[projected, edge.T], [edge, corner]])
        size = float(np.sqrt(np.einsum("ij,ij->j", image, mass @ image).max()))
        image -= last @ corner + before @ rows.T
        image -= basis @ (basis.T @ (mass @ image))
        before = last
        last, momentum, rows = _orthonormal(image, mass, nothing=NOTHING * size)
        values, vectors = np.linalg.eigh(projected)
        values, vectors = values[::-1][:count], vectors[:, ::-1][:, :count]
        converged = np.linalg.norm(rows @ vectors[old:], axis=0) <= TOLERANCE * values
        if (len(values) == count and np.all(converged)) or not last.shape[1]:
            often = max(int(np.count_nonzero(np.abs(values / value - 1) < SAME)) for value in values)
            if width <= often < count and width < n:
                return _krylov(factor, mass, count, 2 * width)
            return values, np.asarray(basis @ vectors)
        basis = np.concatenate([basis, last], axis=1)
    raise NotConverged(
        f"{np.count_nonzero(converged)} of {count} modes have converged after {basis.shape[1]} steps; ask for "
        "fewer, or raise modes.shift_frequency towards the first mode"
    )


def _orthonormal(new: Array, mass: Any, nothing: float = 0.0) -> tuple[Array, Array, Array]:
    """Vectors x (n, r) orthonormal with the mass that span `new` (n, k), mass @ x, and (r, k) with new = x @ that.

    nothing: size, in the norm of the mass, up to which a direction is rounding.
    """
    rows, least = np.eye(new.shape[1]), 1e-14
    for _ in range(2):  # the Gram matrix squares what is small: what the first pass leaves, the second mends
        momentum = mass @ new
        gram = new.T @ momentum
        values, turn = np.linalg.eigh((gram + gram.T) / 2)
        keep = values > max(least * values.max(initial=0.0), nothing**2)
        nothing = 0.0
        root = np.sqrt(values[keep])
        new, rows = new @ (turn[:, keep] / root), (turn[:, keep] * root).T @ rows
    return new, momentum @ (turn[:, keep] / root), rows
