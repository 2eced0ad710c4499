"""Complex modes of a structure with loss on its joints, hysteretic or viscous.

The loss is that of a few faces, so the complex modes lie near the span of the real modes and of the static response to
the loss forces they cause. The equations are projected on that span; what the projected modes leave in the full
equations, sent through the factorisation that the real modes have left, is both the estimate of their error and the
next enrichment of the span.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from faying.errors import NotConverged
from faying.fe.modes import Modes
from faying.fe.span import Span, without
from faying.typing import Array, Complex, Index

ROUNDS = 25  # enrichments after which the loss must be so great that nothing here applies


@dataclass(frozen=True, kw_only=True)
class DampedModes:
    """Complex modes in rising order.

    frequencies [Hz], loss_factors [-] (m,): of the complex eigenvalue w^2 (1 + i eta) under hysteretic loss; under
    viscous damping the undamped |lambda|/2pi and twice the damping ratio. error (m,): estimated relative error of the
    eigenvalue. shapes (unknowns, m), complex, with shapes^T M shapes = 1.
    """

    frequencies: Array
    loss_factors: Array
    error: Array
    shapes: Complex

    def scaled_shapes(self, mass: Any) -> tuple[Array, Array]:
        """Real and imaginary part of the shapes (unknowns, m), scaled so that the real part is mass-normalised."""
        real = self.shapes.real
        size = np.sqrt(np.einsum("im,im->m", real, mass @ real))
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
    kind: Literal["hysteretic", "viscous"] = "hysteretic",
    tolerance: float = 1e-6,
) -> DampedModes:
    """Find complex modes of K + i C (hysteretic, C [N/m]) or K + i w C (viscous, C [N s/m]).

    modes: real modes and their factorisation; rigid: how many of the lowest are rigid motions, which have no part in
    this; count: how many complex modes are wanted, all elastic ones where None; tolerance: of the estimated relative
    error of the complex eigenvalues. Raises NotConverged where it is not reached.
    """
    elastic = modes.shapes[:, rigid:]
    count = elastic.shape[1] if count is None else min(count, elastic.shape[1])
    rigid_shapes = modes.shapes[:, :rigid]
    rigid_momentum = np.asarray(mass @ rigid_shapes)

    def answered(forces: Array) -> Array:
        """What the factorisation answers to forces (n, k), less rigid motions."""
        found = modes.factorisation.solve(np.asfortranarray(forces))
        return np.asarray(found - rigid_shapes @ (rigid_momentum.T @ found))

    if not loss.count_nonzero():
        return DampedModes(
            frequencies=modes.frequencies[rigid : rigid + count],
            loss_factors=np.zeros(count),
            error=modes.error[rigid : rigid + count],
            shapes=elastic[:, :count].astype(complex),
        )
    span = Span(mass, stiffness, elastic, others=[loss])
    _enrich(span, answered(loss @ elastic), least=0.0)
    error = np.full(count, np.inf)
    for _ in range(ROUNDS):
        squared, root, inner = _eigen(span.small, count, kind)
        vectors, moved = _times(span.vectors, inner), _times(span.momentum, inner)
        lost = loss @ vectors.real + 1j * (loss @ vectors.imag)
        if kind == "hysteretic":
            miss = _times(span.force, inner) + 1j * lost - moved * squared
        else:
            miss = _times(span.force, inner) + lost * root + moved * root**2
        parts = np.concatenate([miss.real, miss.imag], axis=1)
        solved = answered(parts)
        energy = np.einsum("ij,ij->j", parts, solved).reshape(2, count).sum(axis=0)
        size = np.abs(squared) * np.einsum("im,im->m", vectors.conj(), moved).real
        error = np.abs(energy) / size
        if error.max() < tolerance:
            return DampedModes(
                frequencies=_frequency(squared, root, kind),
                loss_factors=_loss_factor(squared, root, kind),
                error=error,
                shapes=vectors / np.sqrt(np.einsum("im,im->m", vectors, moved)),
            )
        if not _enrich(span, solved / np.sqrt(np.tile(size, 2)), least=0.01 * tolerance):
            break
    raise NotConverged(
        f"complex modes: the estimated error stays at {error.max():.1e} (tolerance {tolerance:.0e}); the loss "
        "of the joint may be too great for modes to mean anything"
    )


def _frequency(squared: Complex, root: Complex, kind: str) -> Array:
    return (np.sqrt(squared.real) if kind == "hysteretic" else np.abs(root)) / (2 * np.pi)


def _loss_factor(squared: Complex, root: Complex, kind: str) -> Array:
    return squared.imag / squared.real if kind == "hysteretic" else -2 * root.real / np.abs(root)


def followers(overlap: Complex) -> Index:
    """Index of the complex mode (m,) that follows each real one, from their overlap (m, complex modes).

    Each real mode, in turn, takes the one left that overlaps it most. Raises NotConverged where there are too few.
    """
    if overlap.shape[1] < len(overlap):
        raise NotConverged(
            f"complex modes: only {overlap.shape[1]} of {len(overlap)} modes oscillate; the dampers are so "
            "strong that the others only creep back"
        )
    picked: list[int] = []
    for row in np.abs(overlap):
        picked.append(next(int(i) for i in np.argsort(-row) if int(i) not in picked))
    return np.array(picked, dtype=np.int64)


def _times(vectors: Array, inner: Complex) -> Complex:
    """Real vectors times complex coefficients, without a complex copy of the vectors."""
    return np.asarray(vectors @ inner.real + 1j * (vectors @ inner.imag))


def _enrich(span: Span, new: Array, *, least: float) -> int:
    """Add columns; directions whose share of the stiffness energy is below `least` are left out."""
    stiffness = span.operators[0]
    scale = np.einsum("ij,ij->j", new, stiffness @ new).max()
    new = without(new, span.vectors, span.momentum)
    gram = new.T @ (stiffness @ new)
    values, rotation = np.linalg.eigh((gram + gram.T) / 2)
    new = new @ rotation[:, values > max(least, 1e-12 * scale)]
    return span.add(new / np.linalg.norm(new, axis=0)) if new.shape[1] else 0


def _eigen(small: Sequence[Array], count: int, kind: str) -> tuple[Complex, Complex, Complex]:
    """Squares w^2 (1 + i eta), roots lambda and coefficients (size, count) of modes that follow the real ones.

    small: stiffness and loss on a basis that is orthonormal with the mass.
    """
    from scipy.linalg import eig

    K, C = small
    if kind == "hysteretic":
        values, vectors = eig(K + 1j * C)
        squared, root = values, 1j * np.sqrt(values)
    else:
        n = len(K)
        companion = np.block([[np.zeros((n, n)), np.eye(n)], [-K, -C]])
        root, both = eig(companion)
        above = root.imag > 0
        root, vectors = root[above], both[:n, above]
        vectors = vectors / np.linalg.norm(vectors, axis=0)
        squared = -(root**2)
    order = followers(vectors[:count])
    order = order[np.argsort(_frequency(squared[order], root[order], kind))]
    return squared[order], root[order], vectors[:, order]
