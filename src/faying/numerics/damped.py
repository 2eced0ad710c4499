"""Complex modes of a structure with loss on its joints, hysteretic or viscous.

The loss is that of a few faces, so the complex modes lie near the span of the real modes and of the static response to
the loss forces they cause. The equations are projected on that span, or on the larger one in which the real modes of
several stiffnesses were found; what the projected modes leave in the full equations, sent through the factorisation
that the real modes have left, is both the estimate of their error and the next enrichment of the span.
"""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from faying.errors import NotConverged
from faying.numerics.modal_reanalysis import MIN_NEW_SHARE, Measure, ModalReanalysis
from faying.numerics.modes import Modes, definite
from faying.numerics.product import combined, product
from faying.style import Summary
from faying.typing import Array, Complex, Index

Kind = Literal["hysteretic", "viscous"]
ROUNDS = 25  # enrichments after which the loss must be so great that nothing here applies
MAX_ROWS = 10  # of a summary
SLIGHT = 0.01  # of the tolerance: what mends less is left out


@dataclass(frozen=True, kw_only=True, repr=False)
class DampedModes(Summary):
    """Complex modes in rising order.

    frequencies [Hz], loss_factors [-] (m,): of the complex eigenvalue w^2 (1 + i eta) under hysteretic loss; under
    viscous damping the undamped |lambda|/2pi and twice the damping ratio. error (m,): estimated relative error of the
    eigenvalue. shapes (unknowns, m), complex, with shapes^T M shapes = 1; of each real part
    the greatest component is positive.
    """

    frequencies: Array
    loss_factors: Array
    error: Array
    shapes: Complex

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return the first frequencies with their loss factors."""
        pairs = zip(self.frequencies[:MAX_ROWS], self.loss_factors[:MAX_ROWS], strict=True)
        rows = {f"mode {k}": f"{f:.6g} Hz, loss factor {loss:.3g}" for k, (f, loss) in enumerate(pairs, 1)}
        return f"{len(self.frequencies)} complex modes of {len(self.shapes):,} unknowns", rows

    def scaled_shapes(self, mass: Any) -> tuple[Array, Array]:
        """Real and imaginary part of the shapes (unknowns, m), scaled so that the real part is mass-normalised."""
        real = self.shapes.real
        if not np.any(self.shapes.imag):  # of unit size in the mass as they are
            return np.ascontiguousarray(real), np.zeros_like(real)
        size = np.sqrt(np.einsum("im,im->m", real, product(mass, real)))
        return np.asarray(real / size), np.asarray(self.shapes.imag / size)

    def real_shapes(self, mass: Any) -> Array:
        """Shapes (unknowns, m) of the motion at its greatest: the real parts, mass-normalised."""
        return self.scaled_shapes(mass)[0]

    @property
    def damping_ratios(self) -> Array:
        """Damping ratios [-] (m,): half of the loss factors."""
        return self.loss_factors / 2


def damped_modes(
    modes: Modes,
    stiffness: Any,
    mass: Any,
    loss: Any,
    *,
    rigid: int,
    count: int | None = None,
    kind: Kind = "hysteretic",
    tolerance: float = 1e-6,
) -> DampedModes:
    """Find complex modes of K + i C (hysteretic, C [N/m]) or K + i w C (viscous, C [N s/m]).

    modes: real modes and their factorisation; rigid: how many of the lowest are rigid motions, which have no part in
    this; count: how many complex modes are wanted, all elastic ones where None; tolerance: of the estimated relative
    error of the complex eigenvalues. Raises NotConverged where it is not reached.
    """
    near = ModalReanalysis(modes, stiffness, mass, rigid=rigid)
    if loss.count_nonzero():
        near.add(modes.factorisation.solve(np.asfortranarray(loss @ modes.shapes[:, rigid:])))
    return damped_near(near, modes, stiffness, loss, count=count, kind=kind, tolerance=tolerance)


def damped_near(
    near: ModalReanalysis,
    modes: Modes,
    stiffness: Any,
    loss: Any,
    *,
    count: int | None = None,
    kind: Kind = "hysteretic",
    tolerance: float = 1e-6,
) -> DampedModes:
    """Find complex modes, as `damped_modes` does, in the basis in which the real ones were found, which grows."""
    rigid, mass, span = near.rigid, near.span.mass, near.span
    elastic = modes.shapes[:, rigid:]
    count = elastic.shape[1] if count is None else min(count, elastic.shape[1])
    if not loss.count_nonzero():
        return DampedModes(
            frequencies=modes.frequencies[rigid : rigid + count],
            loss_factors=np.zeros(count),
            error=modes.error[rigid : rigid + count],
            shapes=definite(elastic[:, :count]).astype(complex),
        )
    measure = near.measure(2 * count)
    lossy = np.flatnonzero(np.diff(loss.tocsr().indptr))
    inside = loss.tocsr()[lossy][:, lossy]
    for _ in range(ROUNDS):
        values, inner = near.projected(stiffness)
        order = np.argsort(np.abs(values))[rigid:]
        inner = inner[:, order]
        at_joints = span.vectors[lossy] @ inner
        squared, root, mix = _eigen(np.abs(values[order]), at_joints.T @ (inside @ at_joints), count, kind)
        vectors = _combined(span.vectors, inner @ mix)
        resisted, inertial, lossy_part = (_times(operator, vectors) for operator in (stiffness, mass, loss))
        if kind == "hysteretic":
            miss = resisted + 1j * lossy_part - inertial * squared
        else:
            miss = resisted + lossy_part * root + inertial * root**2
        size = np.abs(squared) * np.einsum("im,im->m", vectors.conj(), inertial).real
        error, correction = _measured(measure, miss, size, tolerance)
        if error.max() < tolerance:
            return DampedModes(
                frequencies=_frequency(squared, root, kind),
                loss_factors=_loss_factor(squared, root, kind),
                error=error,
                shapes=definite(vectors / np.sqrt(np.einsum("im,im->m", vectors, inertial))),
            )
        if not _enrich(near, stiffness, correction, least=SLIGHT * tolerance):
            break
    raise NotConverged(
        f"complex modes: the estimated error stays at {error.max():.1e} (tolerance {tolerance:.0e}); the loss "
        "of the joint may be too great for modes to mean anything"
    )


def _measured(measure: Measure, miss: Complex, size: Array, tolerance: float) -> tuple[Array, Array]:
    """Estimated relative errors (m,) of eigenvalues, and what mends those beyond the tolerance (n, k).

    miss: what the modes leave of the equations (n, m); size (m,): what an error is relative to; measure: of real parts
    and imaginary parts (2 m).
    """
    parts, sizes = np.concatenate([miss.real, miss.imag], axis=1), np.tile(size, 2)
    error = measure.guessed(parts, sizes, np.arange(len(sizes)))
    poor = ~(error.reshape(2, -1).sum(axis=0) < tolerance)
    chosen = np.flatnonzero(np.tile(poor, 2) & ~(error < SLIGHT * tolerance))
    correction = parts[:, :0]
    if len(chosen):
        error[chosen], correction = measure.solved(np.asfortranarray(parts[:, chosen]), sizes[chosen], chosen)
    return error.reshape(2, -1).sum(axis=0), correction / np.sqrt(sizes[chosen])


def _frequency(squared: Complex, root: Complex, kind: str) -> Array:
    return (np.sqrt(squared.real) if kind == "hysteretic" else np.abs(root)) / (2 * np.pi)


def _loss_factor(squared: Complex, root: Complex, kind: str) -> Array:
    return squared.imag / squared.real if kind == "hysteretic" else -2 * root.real / np.abs(root)


def lowest_complex(frequencies: Array, count: int) -> Index:
    """Index of the lowest complex modes (count,), in rising order of their frequencies.

    Each frequency is the Rayleigh quotient of the stiffness with its shape, so that none lies low by accident. Raises
    NotConverged where there are too few.
    """
    if len(frequencies) < count:
        raise NotConverged(
            f"complex modes: only {len(frequencies)} of {count} modes oscillate; the dampers are so strong that the "
            "others only creep back"
        )
    return np.argsort(frequencies)[:count]


def _combined(vectors: Array, mix: Complex) -> Complex:
    """Complex combinations (n, k) of real columns (n, m), which are read once for both parts."""
    real, imaginary = np.split(combined(vectors, np.concatenate([mix.real, mix.imag], axis=1)), 2, axis=1)
    return np.asarray(real + 1j * imaginary)


def _times(real: Any, other: Complex) -> Complex:
    """A real sparse matrix times a complex one, without a complex copy of the first."""
    return np.asarray(product(real, other.real) + 1j * product(real, other.imag))


def _enrich(near: ModalReanalysis, stiffness: Any, new: Array, *, least: float) -> int:
    """Add columns; combinations of them whose stiffness energy is below `least` are left out."""
    gram = new.T @ product(stiffness, new)
    values, rotation = np.linalg.eigh((gram + gram.T) / 2)
    new = new @ rotation[:, values > max(least, 1e-12 * values.max(initial=0.0))]
    return near.span.add(new, least=MIN_NEW_SHARE) if new.shape[1] else 0


def _eigen(stiffness: Array, loss: Array, count: int, kind: str) -> tuple[Complex, Complex, Complex]:
    """Squares w^2 (1 + i eta), roots lambda and coefficients (size, count) of the lowest modes.

    stiffness (size,), loss (size, size): in real modes, mass-normalised.
    """
    from scipy.linalg import eig

    if kind == "hysteretic":
        values, vectors = eig(np.diag(stiffness) + 1j * loss)
        squared, root = values, 1j * np.sqrt(values)
    else:
        n = len(stiffness)
        companion = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(stiffness), -loss]])
        root, both = eig(companion)
        above = root.imag > 0
        root, vectors = root[above], both[:n, above]
        squared = -(root**2)
    order = lowest_complex(_frequency(squared, root, kind), count)
    return squared[order], root[order], vectors[:, order]
