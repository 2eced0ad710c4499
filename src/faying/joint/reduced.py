"""A structure in two small bases, one for equilibrium and one for vibration: any law and preload in milliseconds.

`reduce` makes it from a structure; it holds no matrix of the structure's size and can be sent to other processes.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faying.errors import InputError, NotConverged
from faying.fe.damped import followers
from faying.joint.equilibrium import Equilibrium, PreloadState, StickSlip
from faying.joint.joint_law import JointLaw
from faying.typing import Array, Complex

BALANCED = 1e-8  # imbalance at which the pressure is right to far more digits than a sweep gives
BLOCK = 36  # real modes beyond those wanted that meet them exactly under the loss
SLIGHT = 1e-6  # relative error of an eigenvalue up to which first order is enough for the higher modes


@dataclass(frozen=True, kw_only=True)
class ReducedMotion:
    """Relative motion at the points of a joint from coefficients of a basis: relative (3q, m), dense."""

    weights: Array
    gap: Array
    relative: Array


@dataclass(frozen=True, kw_only=True)
class Densities:
    """Springs of one joint at its points: k_n, k_t and their imaginary parts [Pa/m] (q,)."""

    k_n: Array
    k_t: Array
    c_n: Array
    c_t: Array


@dataclass(frozen=True, kw_only=True)
class Variant:
    """One law and preload, evaluated in the bases.

    frequencies [Hz], loss_factors [-] (m,), elastic modes; estimate (m,): what the frequencies change by, relatively,
    when the last part of the basis is left out; preload: the equilibrium, with coefficients in place of displacements.
    """

    frequencies: Array
    loss_factors: Array
    estimate: Array
    preload: PreloadState


def densities(laws: Sequence[JointLaw], pressures: Sequence[Array]) -> list[Densities]:
    """Springs per area of all joints at given pressures [Pa], one array for each joint."""
    out = []
    for law, p in zip(laws, pressures, strict=True):
        k_n, k_t = law.stiffness(p)
        loss_n, loss_t = law.loss(p)
        out.append(Densities(k_n=k_n, k_t=k_t, c_n=k_n * loss_n, c_t=k_t * loss_t))
    return out


def _complex_modes(real: Array, loss: Array, count: int) -> tuple[Complex, Complex]:
    """Lowest complex eigenvalues (m,) and vectors (d, m) of diag(real) + i loss, in rising order.

    The lowest real modes, some more than are wanted, meet each other exactly; those above them join by what the loss
    makes of them to first order. What that leaves is estimated, and where it is not small the whole problem is solved.
    """
    from scipy.linalg import eig

    low = min(count + BLOCK, len(real))
    apart = real[:low, None] - real[None, low:]
    with np.errstate(divide="ignore", invalid="ignore"):
        mix = 1j * loss[:low, low:] / apart
        # second-order shift of an eigenvalue, times the square of the greatest loss factor: what first order leaves
        left = np.sum(np.abs(mix * mix * apart), axis=1) / real[:low] * np.max(np.abs(np.diag(loss)) / real) ** 2
    if low == len(real) or not left[:count].max() < SLIGHT:
        values, vectors = eig(np.diag(real) + 1j * loss)
    else:
        span = np.concatenate([np.eye(low), mix], axis=1).T
        small = span.T @ (real[:, None] * span + 1j * (loss @ span))
        values, inner = eig(np.linalg.solve(span.T @ span, small))  # the matrix on the left is close to one
        vectors = span @ inner
        vectors = vectors / np.linalg.norm(vectors, axis=0)
    order = followers(vectors[:count])
    order = order[np.argsort(values[order].real)]
    return values[order], vectors[:, order]


def _sprung(relative: Array, springs: Array) -> Array:
    """Stiffness (m, m) of springs (q, 3) [N/m], normal and both tangential, on a relative motion (3q, m).

    Springs and losses are never negative: half the work through their roots.
    """
    from scipy.linalg.blas import dsyrk

    lower = dsyrk(1.0, (np.sqrt(springs).reshape(-1, 1) * relative).T, lower=1)
    return np.asarray(lower + np.tril(lower, -1).T)


class ReducedEquilibrium(Equilibrium):
    """Equilibrium in a basis: dense Newton."""

    def _start(self, load: Array) -> Array:
        """Every joint at one common pressure, by springs tangent to p(closing) there."""
        matrix, push = self.stiffness.copy(), load.copy()
        for trace, law in self.joints:
            middle = 10 * np.sqrt(law.least_pressure * law.model.greatest_pressure)
            mean = float(np.clip(middle, 10 * law.least_pressure, 0.5 * law.model.greatest_pressure))
            k_n, k_t = (float(k) for k in law.stiffness(np.asarray(mean)))
            share = trace.weights[:, None] * np.array([k_n, k_t, k_t])
            matrix = matrix + trace.relative.T @ (share.reshape(-1, 1) * trace.relative)
            offset = mean - k_n * (law.closing(mean) + trace.gap)
            local = np.zeros((len(offset), 3))
            local[:, 0] = offset * trace.weights
            push = push + trace.relative.T @ local.ravel()
        return np.asarray(np.linalg.solve(matrix, push))

    def _direction(self, u: Array, force: Array, grips: list[StickSlip], accuracy: float) -> tuple[Array, int]:
        from scipy.linalg import LinAlgError, cho_factor, cho_solve

        matrix = self.stiffness.copy()
        for trace, k_n, k_t in self._tangents(u, grips):
            if not k_t[:, 0, 1].any():  # nothing slides
                matrix += _sprung(trace.relative, np.stack([k_n, k_t[:, 0, 0], k_t[:, 1, 1]], axis=1))
                continue
            local = trace.relative.reshape(len(k_n), 3, -1)
            scaled = np.empty_like(local)
            scaled[:, 0] = k_n[:, None] * local[:, 0]
            scaled[:, 1] = k_t[:, 0, 0, None] * local[:, 1] + k_t[:, 0, 1, None] * local[:, 2]
            scaled[:, 2] = k_t[:, 1, 0, None] * local[:, 1] + k_t[:, 1, 1, None] * local[:, 2]
            matrix += trace.relative.T @ scaled.reshape(trace.relative.shape)
        try:
            return np.asarray(cho_solve(cho_factor(matrix), force)), 0
        except LinAlgError:
            raise NotConverged("preload: the joint opens wholly on the way; load it in smaller steps") from None


@dataclass(kw_only=True)
class ReducedModel:
    """The two bases, projected.

    static_*: stiffness (s, s), loads (s, bolts) of 1 N each, relative motion at the points of each joint (3q, s);
    dynamic_*: stiffness, mass (d, d), relative motion (3q, d); count: modes that are given; coarse: how many leading
    vectors of the dynamic basis make the coarser one of the estimate.
    """

    weights: list[Array]
    gaps: list[Array]
    friction: list[float | None]
    static_stiffness: Array
    static_loads: Array
    static_relative: list[Array]
    dynamic_stiffness: Array
    dynamic_mass: Array
    dynamic_relative: list[Array]
    count: int
    coarse: int
    last: Array | None = None

    def equilibrium(self, laws: Sequence[JointLaw], forces: Array) -> PreloadState:
        """PreloadState in the basis under bolt forces [N] (b,), started from the last one that was found."""
        joints = [
            (ReducedMotion(weights=w, gap=gap, relative=relative), law)
            for w, gap, relative, law in zip(self.weights, self.gaps, self.static_relative, laws, strict=True)
        ]
        balance = ReducedEquilibrium(self.static_stiffness, joints, friction=self.friction)
        load = self.static_loads @ forces
        if self.last is not None:
            balance.last = np.concatenate([self.last, np.zeros(len(load) - len(self.last))])
        try:
            found = balance.solve(load, beyond=1.0, tolerance=BALANCED)
        except NotConverged:
            if balance.last is None:
                raise
            balance.last = None
            found = balance.solve(load, beyond=1.0, tolerance=BALANCED)
        self.last = found.displacement
        return found

    def modes(self, springs: Sequence[Densities]) -> tuple[Complex, Complex, Array]:
        """Complex eigenvalues w^2 (1 + i eta) [1/s2] (m,), coefficients (d, m), the estimate (m,)."""
        from scipy.linalg import eigh

        joint, loss = self._joints(springs)
        K, M = self.dynamic_stiffness + joint, self.dynamic_mass
        real, shapes = eigh(K, M)
        cut = slice(0, self.coarse)
        rough = eigh(K[cut, cut], M[cut, cut], eigvals_only=True, subset_by_index=[0, self.count - 1])
        estimate = np.abs(rough / real[: self.count] - 1) / 2
        values, inner = _complex_modes(real, shapes.T @ loss @ shapes, self.count)
        return values, shapes @ inner, estimate

    def _joints(self, springs: Sequence[Densities]) -> tuple[Array, Array]:
        size = len(self.dynamic_mass)
        real, imaginary = np.zeros((size, size)), np.zeros((size, size))
        for weights, relative, d in zip(self.weights, self.dynamic_relative, springs, strict=True):
            for target, n, t in ((real, d.k_n, d.k_t), (imaginary, d.c_n, d.c_t)):
                target += _sprung(relative, weights[:, None] * np.stack([n, t, t], axis=1))
        return real, imaginary

    def evaluate(self, laws: Sequence[JointLaw], forces: Array) -> Variant:
        """Modes under one law per joint and one force per bolt [N] (b,). Raises InputError for forces that fit no bolt."""
        if np.shape(forces) != (self.static_loads.shape[1],):
            raise InputError(f"{np.size(forces)} bolt forces for {self.static_loads.shape[1]} bolts; give one for each")
        found = self.equilibrium(laws, np.asarray(forces, dtype=float))
        values, _, estimate = self.modes(densities(laws, found.pressures))
        return Variant(
            frequencies=np.sqrt(values.real) / (2 * np.pi),
            loss_factors=values.imag / values.real,
            estimate=estimate,
            preload=found,
        )
