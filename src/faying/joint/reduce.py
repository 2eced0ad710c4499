"""A small basis for the preload and the modes of a structure of which only the joints change.

Preload, roughness and contact model act on the faying faces alone, so one factorisation serves every variant. The basis
of each problem (equilibrium, vibration) starts from a reference state and is enriched by what that factorisation makes
of the residual of a variant, until the residual says that the variant is solved. Laws and preloads are then evaluated
with small dense matrices. The estimate of the error is that of the residual in the energy norm of the reference.

Basis vectors are orthonormal in the reference energy and kept in the order in which they came, so that a leading part
of them is a coarser basis: the difference between the two is the cheap estimate that every evaluation carries.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faying.errors import InputError, NotConverged
from faying.fe.solve import Factorisation
from faying.joint.balance import Array, Balance, Grip, Preload
from faying.joint.seat import Seat

FEW_STEPS = 60  # enrichments of one variant after which something else must be wrong


@dataclass(frozen=True, kw_only=True)
class SmallTrace:
    """Relative motion at the points of a joint from coefficients of a basis: relative (3q, m), dense."""

    weights: Array
    gap: Array
    relative: Array


@dataclass
class Basis:
    """Vectors (n, m), orthonormal in the energy of `reference`, with their traces on the joints and reduced matrices."""

    reference: Any
    operators: tuple[Any, ...]
    traces: Sequence[Any]
    rigid: Array
    rigid_momentum: Array
    vectors: Array = field(init=False)
    small: list[Array] = field(init=False)
    relative: list[Array] = field(init=False)

    def __post_init__(self) -> None:
        n = self.reference.shape[0]
        self.vectors = np.zeros((n, 0))
        self.small = [np.zeros((0, 0)) for _ in self.operators]
        self.relative = [np.zeros((3 * len(trace.weights), 0)) for trace in self.traces]

    @property
    def size(self) -> int:
        """How many vectors there are."""
        return int(self.vectors.shape[1])

    def add(self, new: Array, *, least: float = 0.0) -> int:
        """Add columns (n, k); return how many directions were new.

        least: energy, in the units of the columns, below which a direction is left out; rounding is left out anyhow.
        """
        # what rounding leaves of rigid motions would grow with every solve, and come back as modes of no frequency
        new = new - self.rigid @ (self.rigid_momentum.T @ new)
        scale = float(np.einsum("ij,ij->j", new, self.reference @ new).max())
        for _ in range(2):
            new = new - self.vectors @ (self.vectors.T @ (self.reference @ new))
        gram = new.T @ (self.reference @ new)
        values, rotation = np.linalg.eigh((gram + gram.T) / 2)
        keep = values > max(least, 1e-13 * scale)
        if not np.any(keep):
            return 0
        new = new @ (rotation[:, keep] / np.sqrt(values[keep]))[:, ::-1]
        new = new - self.vectors @ (self.vectors.T @ (self.reference @ new))
        new /= np.sqrt(np.einsum("ij,ij->j", new, self.reference @ new))
        for i, operator in enumerate(self.operators):
            image = operator @ new
            corner, side = new.T @ image, self.vectors.T @ image
            self.small[i] = np.block([[self.small[i], side], [side.T, (corner + corner.T) / 2]])
        self.relative = [
            np.concatenate([old, trace.relative @ new], axis=1)
            for old, trace in zip(self.relative, self.traces, strict=True)
        ]
        self.vectors = np.concatenate([self.vectors, new], axis=1)
        return int(new.shape[1])

    def turn(self, rotation: Array) -> None:
        """Replace the vectors by combinations of them, the columns of `rotation` (size, k), orthonormal."""
        self.vectors = self.vectors @ rotation
        self.small = [rotation.T @ matrix @ rotation for matrix in self.small]
        self.relative = [relative @ rotation for relative in self.relative]


class SmallBalance(Balance):
    """Equilibrium in a basis: dense Newton."""

    def _start(self, load: Array) -> Array:
        """Every joint at one common pressure, by springs tangent to p(closing) there."""
        matrix, push = self.stiffness.copy(), load.copy()
        for trace, seat in self.joints:
            mean = np.sqrt(seat.least_pressure * seat.law.greatest_pressure) * 10
            mean = float(np.clip(mean, 10 * seat.least_pressure, 0.5 * seat.law.greatest_pressure))
            k_n, k_t = (float(k) for k in seat.stiffness(np.asarray(mean)))
            share = trace.weights[:, None] * np.array([k_n, k_t, k_t])
            matrix = matrix + trace.relative.T @ (share.reshape(-1, 1) * trace.relative)
            offset = mean - k_n * (seat.closing(mean) + trace.gap)
            local = np.zeros((len(offset), 3))
            local[:, 0] = offset * trace.weights
            push = push + trace.relative.T @ local.ravel()
        return np.asarray(np.linalg.solve(matrix, push))

    def _direction(self, u: Array, force: Array, grips: list[Grip], accuracy: float) -> tuple[Array, int]:
        from scipy.linalg import LinAlgError, cho_factor, cho_solve

        matrix = self.stiffness.copy()
        for trace, k_n, k_t in self._tangents(u, grips):
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


@dataclass(frozen=True, kw_only=True)
class Variant:
    """One law and preload, evaluated in the basis.

    frequencies [Hz], loss_factors [-] (m,), elastic modes; estimate (m,): what the frequencies change by, relatively,
    when the last part of the basis is left out; preload: the equilibrium, with coefficients in place of displacements.
    """

    frequencies: Array
    loss_factors: Array
    estimate: Array
    preload: Preload


@dataclass(frozen=True, kw_only=True)
class Densities:
    """Springs of one joint at its points: k_n, k_t and their imaginary parts [Pa/m] (q,)."""

    k_n: Array
    k_t: Array
    c_n: Array
    c_t: Array


class Reduction:
    """Bases for equilibrium and vibration of one structure, grown from variants and then evaluated on others."""

    def __init__(
        self,
        *,
        stiffness: Any,
        stiffness_static: Any,
        mass: Any,
        traces: Sequence[Any],
        factor: Factorisation,
        reference: Any,
        loads: Array,
        shapes: Array,
        count: int,
        rigid: Array,
        friction: Sequence[float | None],
    ) -> None:
        """Start from a factorised reference.

        stiffness, stiffness_static, mass (n, n): of the parts with their attachments, for vibration and for preload
        (held unknowns cleared); reference (n, n): stiffness + joints + shift x mass, of which `factor` is the
        factorisation; loads (n, b): one column for 1 N in each bolt; shapes (n, m): elastic modes at the reference,
        more of them than the `count` that is asked for: the rest speeds the enrichment; rigid (n, r): motions that nothing
        resists.
        """
        self.stiffness, self.stiffness_static, self.mass = stiffness, stiffness_static, mass
        self.traces, self.factor, self.reference = list(traces), factor, reference
        self.loads, self.friction = loads, list(friction)
        self.count = count
        from scipy.linalg import cholesky, solve_triangular

        if rigid.shape[1]:
            root = cholesky(rigid.T @ (mass @ rigid))
            rigid = solve_triangular(root, rigid.T, trans="T").T
        still = {"rigid": rigid, "rigid_momentum": np.asarray(mass @ rigid)}
        self.static = Basis(reference=reference, operators=(stiffness_static,), traces=self.traces, **still)
        self.static.add(factor.solve(np.ascontiguousarray(loads)))
        self.dynamic = Basis(reference=reference, operators=(stiffness, mass), traces=self.traces, **still)
        self.dynamic.add(shapes)
        self.coarse = self.dynamic.size
        self._seen: list[list[Densities]] = []
        self._last: Array | None = None

    # -- equilibrium -------------------------------------------------------------------------------------------------

    def equilibrium(self, seats: Sequence[Seat], forces: Array) -> Preload:
        """Preload in the basis under bolt forces [N] (b,)."""
        joints = [
            (SmallTrace(weights=trace.weights, gap=trace.gap, relative=relative), seat)
            for trace, relative, seat in zip(self.traces, self.static.relative, seats, strict=True)
        ]
        balance = SmallBalance(self.static.small[0], joints, friction=self.friction)
        load = self.static.vectors.T @ (self.loads @ forces)
        if self._last is not None:
            balance.last = np.concatenate([self._last, np.zeros(self.static.size - len(self._last))])
        try:
            found = balance.solve(load, beyond=1.0)
        except NotConverged:
            if balance.last is None:
                raise
            balance.last = None
            found = balance.solve(load, beyond=1.0)
        self._last = found.displacement
        return found

    def _static_residual(self, seats: Sequence[Seat], forces: Array, found: Preload) -> Array:
        u = self.static.vectors @ found.displacement
        residual = self.loads @ forces - self.stiffness_static @ u
        for trace, seat, friction, p, relative in zip(
            self.traces, seats, self.friction, found.pressures, self.static.relative, strict=True
        ):
            slip = (relative @ found.displacement).reshape(-1, 3)[:, 1:]
            grip = Grip(k_t=seat.stiffness(p)[1], limit=None if friction is None else friction * p,
                        anchor=np.zeros_like(slip))  # fmt: skip
            local = np.concatenate([-p[:, None], grip.shear(slip)], axis=1) * trace.weights[:, None]
            residual = residual - trace.relative.T @ local.ravel()
        return np.asarray(residual)

    def train_static(self, seats: Sequence[Seat], forces: Array, tolerance: float) -> tuple[float, int]:
        """Enrich until the equilibrium of a variant is solved; return the relative error left and the vectors added."""
        added = 0
        for _ in range(FEW_STEPS):
            found = self.equilibrium(seats, forces)
            residual = self._static_residual(seats, forces, found)
            answer = self.factor.solve(residual)
            error = float(np.sqrt(max(residual @ answer, 0.0)) / np.linalg.norm(found.displacement))
            if error < tolerance:
                return error, added
            added += self.static.add(answer[:, None])
        raise NotConverged(
            f"reduction: {FEW_STEPS} enrichments leave the preload wrong by {error:.1e}; raise the tolerance"
        )

    # -- vibration ---------------------------------------------------------------------------------------------------

    def _joints(self, densities: Sequence[Densities]) -> tuple[Array, Array]:
        size = self.dynamic.size
        real, imaginary = np.zeros((size, size)), np.zeros((size, size))
        for trace, relative, d in zip(self.traces, self.dynamic.relative, densities, strict=True):
            for target, n, t in ((real, d.k_n, d.k_t), (imaginary, d.c_n, d.c_t)):
                share = trace.weights[:, None] * np.stack([n, t, t], axis=1)
                target += relative.T @ (share.reshape(-1, 1) * relative)
        return real, imaginary

    def modes(self, densities: Sequence[Densities]) -> tuple[Array, Array, Array, Array]:
        """Complex eigenvalues [1/s2] (m,), coefficients (size, m), real frequencies' squares, the cheap estimate (m,)."""
        from scipy.linalg import eig, eigh

        joint, loss = self._joints(densities)
        K, M = self.dynamic.small[0] + joint, self.dynamic.small[1]
        some = slice(0, self.count)
        real, shapes = eigh(K, M)
        cut = slice(0, self.coarse)
        rough = eigh(K[cut, cut], M[cut, cut], eigvals_only=True, subset_by_index=[0, self.count - 1])
        estimate = np.abs(rough / real[some] - 1) / 2
        mixed = shapes.T @ loss @ shapes
        values, inner = eig(np.diag(real) + 1j * mixed)
        picked: list[int] = []
        for row in range(self.count):  # each real mode, in turn, takes the complex one that overlaps it most
            ranked = np.argsort(-np.abs(inner[row]))
            picked.append(next(int(i) for i in ranked if int(i) not in picked))
        order = np.array(picked)[np.argsort(values[picked].real)]
        return values[order], shapes @ inner[:, order], real[some], estimate

    def _modal_residual(
        self, densities: Sequence[Densities], values: NDArray[Any], vectors: NDArray[Any]
    ) -> NDArray[Any]:
        x = self.dynamic.vectors @ vectors
        residual = self.stiffness @ x - (self.mass @ x) * values
        for trace, relative, d in zip(self.traces, self.dynamic.relative, densities, strict=True):
            n, t = trace.weights * (d.k_n + 1j * d.c_n), trace.weights * (d.k_t + 1j * d.c_t)
            share = np.stack([n, t, t], axis=1).reshape(-1, 1)
            residual = residual + trace.relative.T @ (share * (relative @ vectors))
        return np.asarray(residual)

    def train_dynamic(self, densities: Sequence[Densities], tolerance: float) -> tuple[float, int]:
        """Enrich until all modes of a variant are solved; tolerance: relative error of the complex eigenvalues.

        The estimate is the square of the residual in the energy norm: eigenvalues err by the square of their vectors.
        Returns the greatest estimate left and the number of vectors added.
        """
        added = 0
        for _ in range(FEW_STEPS):
            values, vectors, _, _ = self.modes(densities)
            residual = self._modal_residual(densities, values, vectors)
            both = np.concatenate([residual.real, residual.imag], axis=1)
            solved = self.factor.solve(np.asfortranarray(both))
            split = residual.shape[1]
            energy = np.einsum("ij,ij->j", both, solved)
            energy = energy[:split] + energy[split:]
            x = self.dynamic.small[1] @ vectors
            size = np.abs(values) * np.abs(np.einsum("ij,ij->j", vectors.conj(), x))
            error = energy / size
            if error.max() < tolerance:
                return float(error.max()), added
            new = self.dynamic.add(solved / np.sqrt(np.concatenate([size, size])), least=0.02 * tolerance)
            if not new:
                raise NotConverged(f"reduction: the modes stay wrong by {error.max():.1e} and nothing improves them")
            added += new
        raise NotConverged(f"reduction: {FEW_STEPS} enrichments leave a mode wrong by {error.max():.1e}; ask for fewer")

    # -- both --------------------------------------------------------------------------------------------------------

    @staticmethod
    def densities(seats: Sequence[Seat], pressures: Sequence[Array]) -> list[Densities]:
        """Springs per area of all joints at given pressures [Pa]."""
        out = []
        for seat, p in zip(seats, pressures, strict=True):
            k_n, k_t = seat.stiffness(p)
            loss_n, loss_t = seat.loss(p)
            out.append(Densities(k_n=k_n, k_t=k_t, c_n=k_n * loss_n, c_t=k_t * loss_t))
        return out

    def train(self, seats: Sequence[Seat], forces: Array, *, tolerance: float) -> int:
        """Make the bases fit one variant; tolerance: relative error of a frequency. Returns the vectors added."""
        _, static = self.train_static(seats, forces, 30 * tolerance)
        found = self.equilibrium(seats, forces)
        densities = self.densities(seats, found.pressures)
        _, dynamic = self.train_dynamic(densities, 2 * tolerance)
        self._seen.append(densities)
        return static + dynamic

    def compress(self, tolerance: float) -> None:
        """Keep of the basis for vibration what the modes of all variants trained on need, most needed first."""
        columns = []
        for densities in self._seen:
            _, vectors, _, _ = self.modes(densities)
            both = np.concatenate([vectors.real, vectors.imag], axis=1)
            columns.append(both / np.tile(np.linalg.norm(vectors, axis=0), 2))
        rotation, size, _ = np.linalg.svd(np.concatenate(columns, axis=1), full_matrices=False)
        share = size**2
        self.dynamic.turn(rotation[:, share > 0.3 * tolerance])
        self.coarse = max(int(np.count_nonzero(share > 30 * tolerance)), self.count)

    def evaluate(self, seats: Sequence[Seat], forces: Array) -> Variant:
        """Modes under one law per joint and one force per bolt [N] (b,). Raises InputError for forces that fit no bolt."""
        if np.shape(forces) != (self.loads.shape[1],):
            raise InputError(f"{np.size(forces)} bolt forces for {self.loads.shape[1]} bolts; give one force for each")
        found = self.equilibrium(seats, forces)
        values, _, _, estimate = self.modes(self.densities(seats, found.pressures))
        return Variant(frequencies=np.sqrt(values.real) / (2 * np.pi), loss_factors=values.imag / values.real,
                       estimate=estimate, preload=found)  # fmt: skip
