"""Vibration modes of a structure, free, joined or bonded."""

from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from faying.errors import InputError, NotConverged
from faying.numerics.product import combined, product
from faying.numerics.solve import Factorisation, factorise, negative_eigenvalues
from faying.typing import Array, Complex

Shapes = TypeVar("Shapes", Array, Complex)
TIE = 1e-3  # of the greatest component: those that differ by less are equal, since shapes are known to 1e-4


def definite(shapes: Shapes) -> Shapes:
    """Return shapes (n, m) with the greatest component of each real part positive; of equal ones that of lowest index.

    A mode and its negative are one motion, and which of them an eigensolver finds is chance.
    """
    signs = np.ones(shapes.shape[1])
    for k in range(shapes.shape[1]):  # one at a time: a copy of all may be as large as the shapes themselves
        column = shapes[:, k].real
        size = np.abs(column)
        first = int(np.argmax(size >= (1 - TIE) * size.max(initial=0.0))) if len(size) else 0
        signs[k] = -1.0 if len(size) and column[first] < 0 else 1.0
    return np.asarray(shapes * signs)


SEED = 20240611
WIDTH = 8  # of a block of vectors: a factor is read once for all of them
TOO_HIGH = 30.0  # times the highest frequency of a single unknown: such a shift leaves few digits of the modes
ROWS = 50_000  # of the basis that are joined at a time
MAX_STEPS = 1200  # vectors of the basis
SAME = 1e-6  # relative difference of eigenvalues of A^-1 M below which they may be one
NOTHING = 1e-13  # of the size of a block: what the basis leaves of it is rounding, and the basis is whole
TOLERANCE = 1e-8  # residual of A^-1 M x = theta x over theta; the error of theta is of its square over the gap


@dataclass(frozen=True, kw_only=True)
class Modes:
    """Lowest modes in rising order: frequencies [Hz] (m,), mass-normalised shapes (unknowns, m), what solved them.

    frequencies below zero do not occur: a rigid motion that rounding makes slightly negative is given as its size. The
    factorisation is that of `factorised` + shift x mass, a stiffness [N/m] near the one of the modes. error (m,):
    estimated relative error of the squared frequencies, 0 for rigid motions, NaN for modes that came along.
    """

    frequencies: Array
    shapes: Array
    error: Array
    factorisation: Factorisation
    factorised: Any
    shift: float


def lowest_modes(
    stiffness: Any,
    mass: Any,
    count: int,
    *,
    shift_frequency: float,
    solver: str | None = None,
    factor: Factorisation | None = None,
    rigid: Array | None = None,
    tolerance: float | Array = TOLERANCE,
) -> Modes:
    """Find the `count` lowest modes by block Lanczos iteration with a negative shift.

    stiffness [N/m], mass [kg]: sparse and symmetric; shift_frequency [Hz] sets the shift -(2 pi f)^2, at which
    K + |shift| M is positive definite even for free bodies; factor: of that matrix, made here where None; rigid: the
    motions (n, r) that nothing resists, which are not looked for where they are given; tolerance: residual of
    A^-1 M x = theta x over theta, A the factorised matrix, one for all or one for each (count,), infinite for modes
    that may be as they come, or not at all. Raises InputError where more modes are asked for than there are masses, the
    shift is above every mode, the structure is unstable, or memory is short, and NotConverged where the iteration stops
    short.
    """
    check_shift(stiffness, mass, shift_frequency)
    shift = (2 * np.pi * shift_frequency) ** 2
    allowed = np.broadcast_to(tolerance, (max(count, 0),))
    least, most = int(np.count_nonzero(np.isfinite(allowed))), int(np.count_nonzero(mass.diagonal() > 0))
    if not 0 < least <= most:
        raise InputError(f"{least} modes of a structure with {most} unknowns that have mass; ask for 1 to {most}")
    if factor is None:
        factor = factorise((stiffness + shift * mass).tocsr(), solver)
    rigid_basis, _, _ = _orthonormal(np.zeros((stiffness.shape[0], 0)) if rigid is None else rigid, mass)
    inverse, shapes = np.full(rigid_basis.shape[1], 1 / shift), rigid_basis
    if count > rigid_basis.shape[1]:
        width = min(WIDTH, stiffness.shape[0])
        more = _krylov(factor, mass, width, rigid_basis=rigid_basis, allowed=allowed[rigid_basis.shape[1] :])
        inverse, shapes = np.concatenate([inverse, more[0]]), np.concatenate([shapes, more[1]], axis=1)
        del more
    if len(inverse) < least:
        raise InputError(f"{least} modes of a structure whose masses allow {len(inverse)}; ask for 1 to {len(inverse)}")
    values, shapes = _ritz(stiffness, mass, shapes)
    apart = np.abs(np.sort(values + shift) * np.sort(inverse)[::-1] - 1)[:count]
    allowed = allowed[: len(apart)]
    if np.any(apart > np.maximum(SAME, allowed)):
        # motions without mass have crept in, which the projection on the mass does not see, or the rounding of a factor
        # in single precision: one more solve has none
        for k in range(0, shapes.shape[1], WIDTH):  # few at a time, as below, and in their place
            shapes[:, k : k + WIDTH] = factor.solve(product(mass, shapes[:, k : k + WIDTH]))
        shapes, _, _ = _orthonormal(shapes, mass)
        values, shapes = _ritz(stiffness, mass, shapes)
    _check_stable(stiffness, values, shapes, shift)
    order = np.argsort(np.abs(values))[:count]
    return Modes(
        frequencies=np.sqrt(np.abs(values[order])) / (2 * np.pi),
        shapes=definite(shapes[:, order]),
        error=np.where(np.isfinite(allowed), allowed, np.nan),
        factorisation=factor,
        factorised=stiffness,
        shift=shift,
    )


def check_shift(stiffness: Any, mass: Any, shift_frequency: float) -> None:
    """Raise InputError for a shift that is not a frequency, or above all modes that the mesh has."""
    if not (np.isfinite(shift_frequency) and shift_frequency > 0):
        raise InputError(f"a shift of {shift_frequency:g} Hz: give one above 0, near the first elastic mode")
    heavy = mass.diagonal() > 0
    ratio = stiffness.diagonal()[heavy] / mass.diagonal()[heavy]
    highest = float(np.sqrt(ratio.max(initial=0.0))) / (2 * np.pi)
    if shift_frequency > TOO_HIGH * highest > 0:
        raise InputError(
            f"a shift of {shift_frequency:.4g} Hz is above all modes of these matrices, which end near "
            f"{highest:.3g} Hz; give one near the first elastic mode"
        )


def _check_stable(stiffness: Any, values: Array, shapes: Array, shift: float) -> None:
    """Raise InputError where an eigenvalue is negative beyond rounding: its motion would grow, not vibrate."""
    worst = int(np.argmin(values))
    limit = 1e-4 * shift
    if values[worst] >= -limit:
        return
    limit = max(limit, 1e-12 * float(np.abs(shapes[:, worst]) @ (abs(stiffness) @ np.abs(shapes[:, worst]))))
    if values[worst] < -limit:
        rate = np.sqrt(-values[worst]) / (2 * np.pi)
        raise InputError(
            f"the structure is unstable: {np.count_nonzero(values < -limit)} eigenvalues are negative, the "
            f"lowest -({rate:.4g} Hz)^2; check the signs of the stiffness matrix and of its springs"
        )


def missed_modes(stiffness: Any, mass: Any, modes: Modes) -> int:
    """Count the modes that `lowest_modes` has missed below the last of those found, 0 where it has found all.

    The matrix K - s M has as many negative eigenvalues as there are modes below s (Sturm); s lies between the last two
    modes found that differ, which costs one more factorisation.
    """
    values = np.sort((2 * np.pi * modes.frequencies) ** 2)
    if len(values) < 2:
        return 0
    apart = (values[1:] - values[:-1]) / (values[1:] + 1e-3 * modes.shift)
    place = int(np.flatnonzero(apart > 1e-3)[-1]) if np.any(apart > 1e-3) else len(apart) - 1
    between = (values[place] + values[place + 1]) / 2
    return negative_eigenvalues((stiffness - between * mass).tocsr()) - (place + 1)


def _ritz(stiffness: Any, mass: Any, shapes: Array) -> tuple[Array, Array]:
    """Eigenvalues and vectors in the span of the shapes: restores what the shifted inverse loses on the lowest."""
    from scipy.linalg import eigh

    small, gram = (np.zeros((shapes.shape[1], shapes.shape[1])) for _ in range(2))
    for k in range(0, shapes.shape[1], WIDTH):  # few at a time: images take as much room as shapes
        few = slice(k, k + WIDTH)
        small[:, few], gram[:, few] = (shapes.T @ product(matrix, shapes[:, few]) for matrix in (stiffness, mass))
    values, turn = eigh((small + small.T) / 2, (gram + gram.T) / 2)
    return values, combined(shapes, turn)


def _krylov(factor: Factorisation, mass: Any, width: int, *, rigid_basis: Array, allowed: Array) -> tuple[Array, Array]:
    """The greatest eigenvalues of A^-1 M to residuals `allowed` (count,), and their vectors (n, count).

    Orthonormal with the mass; fewer where it has a lower rank. Vectors `rigid_basis` (n, r), orthonormal too, are left
    out.

    Block Lanczos with full reorthogonalisation (Grimes, Lewis, Simon 1994, doi:10.1137/S0895479888151111), without
    restarts: a factor takes far more memory than the basis. An eigenvalue that comes as often as the blocks are wide
    may come more often than that, so that wider ones are tried.
    """
    n, count = mass.shape[0], len(allowed)
    wanted = np.isfinite(allowed)
    same = max(SAME, *allowed[wanted])
    generator = np.random.default_rng(SEED)
    last = factor.solve(mass @ generator.standard_normal((n, width)))
    last -= combined(rigid_basis, rigid_basis.T @ (mass @ last))
    last, momentum, _ = _orthonormal(last, mass)
    before, rows = np.zeros((n, 0)), np.zeros((last.shape[1], 0))
    basis, projected = [last], np.zeros((0, 0))  # as blocks: to join them would take them twice
    for _ in range(MAX_STEPS // width):
        image = factor.solve(momentum)
        corner = momentum.T @ image
        corner = (corner + corner.T) / 2
        old = len(projected)
        edge = np.zeros((last.shape[1], old))
        edge[:, old - before.shape[1] :] = rows
        projected = np.block([[projected, edge.T], [edge, corner]])
        known = np.concatenate([rows.T, corner])  # what the last two blocks have of the image
        size = float(np.linalg.norm(known, axis=0).max())
        image -= combined(last, corner)
        image -= combined(before, rows.T)
        moved = product(mass, image)
        for block in (rigid_basis, *basis):
            image -= combined(block, block.T @ moved)
        before = last
        last, momentum, rows = _orthonormal(image, mass, nothing=NOTHING * size)
        del image, moved  # before the next solution takes room
        values, vectors = np.linalg.eigh(projected)
        values, vectors = values[::-1][:count], vectors[:, ::-1][:, :count]
        converged = np.linalg.norm(rows @ vectors[old:], axis=0) <= allowed[: len(values)] * values
        closed = not last.shape[1]
        found = values if closed else values[converged & wanted[: len(values)]]
        often = max((int(np.count_nonzero(np.abs(found / value - 1) < same)) for value in found), default=0)
        if width <= often < count and width < n:
            return _krylov(factor, mass, 2 * width, rigid_basis=rigid_basis, allowed=allowed)
        if closed or (len(values) == count and np.all(converged)):
            shapes = np.empty((n, len(values)), order="F")
            for begin in range(0, n, ROWS):
                here = slice(begin, begin + ROWS)
                shapes[here] = np.concatenate([block[here] for block in basis], axis=1) @ vectors
            return values, shapes
        basis.append(last)
    raise NotConverged(
        f"{np.count_nonzero(converged)} of {count} modes have converged after {len(projected)} steps; ask for "
        "fewer, or raise modes.shift_frequency towards the first mode"
    )


def _orthonormal(new: Array, mass: Any, nothing: float = 0.0) -> tuple[Array, Array, Array]:
    """Vectors x (n, r) orthonormal with the mass that span `new` (n, k), mass @ x, and (r, k) with new = x @ that.

    nothing: size, in the norm of the mass, up to which a direction is rounding.
    """
    rows, least = np.eye(new.shape[1]), 1e-14
    for _ in range(2):  # the Gram matrix squares what is small: what the first pass leaves, the second mends
        momentum = np.empty(new.shape, order="F")
        for k in range(0, new.shape[1], WIDTH):
            momentum[:, k : k + WIDTH] = product(mass, new[:, k : k + WIDTH])
        gram = new.T @ momentum
        values, turn = np.linalg.eigh((gram + gram.T) / 2)
        keep = values > max(least * values.max(initial=0.0), nothing**2)
        nothing = 0.0
        root = np.sqrt(values[keep])
        new, rows = combined(new, turn[:, keep] / root), (turn[:, keep] * root).T @ rows
    return new, combined(momentum, turn[:, keep] / root), rows
