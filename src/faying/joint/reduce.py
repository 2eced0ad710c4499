"""Makes the small bases of a structure of which only the joints change.

PreloadState, roughness and contact model act on the faying faces alone, so one factorisation serves every variant. The
basis of each problem (equilibrium, vibration) starts from a reference state and is enriched by what that factorisation
makes of the residual of a variant, until the residual says that the variant is solved. The estimate of the error is
that of the residual in the energy norm of the reference. What the variants trained on need of the basis for vibration
is kept, most needed first, so that its leading part is a coarser basis: the difference between the two is the cheap
estimate that every evaluation carries.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from faying.errors import NotConverged
from faying.fe.constraint import constrain
from faying.fe.modes import lowest_modes
from faying.fe.solve import Factorisation
from faying.fe.span import ROUNDING, extension
from faying.joint.equilibrium import PreloadState, StickSlip
from faying.joint.joint_law import JointLaw
from faying.joint.part_shares import PartShares, ReducedShares, Scales
from faying.joint.reduced import ReducedModel, ReducedMotion, Variant
from faying.joint.springs import Springs
from faying.joint.structure import Structure
from faying.joint.support_check import check_motions, checked_preload
from faying.typing import Array

FEW_STEPS = 60  # enrichments of one variant after which something else must be wrong
EXTRA_MODES = 25  # real modes of the reference beyond those wanted: they speed the enrichment of the highest ones
# the force balance enters a frequency through k(p), to first order; the modes enter by the square of their error
STATIC_SHARE = 15.0


def _pressed(traces: Sequence[Any], laws: Sequence[JointLaw], found: PreloadState) -> float:
    """Root of the energy [sqrt(J)], twice, of the joints' normal springs under their pressures.

    What the parts and a bolt's shank store beside it says nothing of how exact the pressures are.
    """
    total = 0.0
    for trace, law, p in zip(traces, laws, found.pressures, strict=True):
        k_n = np.where(p > 0, law.stiffness(p)[0], 1.0)
        total += float(trace.weights @ (p**2 / k_n))
    return float(np.sqrt(total))


def _parts(values: Any) -> list[Array]:
    """Real and imaginary part; the real one alone where the other is zero."""
    return [values.real, values.imag] if np.any(values.imag) else [np.asarray(values.real)]


@dataclass
class Basis:
    """Vectors (n, m), orthonormal in the energy of `reference`, with traces on the joints and projected operators."""

    reference: Any
    operators: tuple[Any, ...]
    traces: Sequence[Any]
    rigid: Array
    rigid_momentum: Array
    vectors: Array = field(init=False)
    image: Array = field(init=False)  # reference @ vectors
    small: list[Array] = field(init=False)
    relative: list[Array] = field(init=False)

    def __post_init__(self) -> None:
        n = self.reference.shape[0]
        self.vectors = self.image = np.zeros((n, 0))
        self.small = [np.zeros((0, 0)) for _ in self.operators]
        self.relative = [np.zeros((3 * len(trace.weights), 0)) for trace in self.traces]

    def add(self, new: Array, *, least: float = 0.0) -> int:
        """Add columns (n, k); return how many directions were new.

        least: energy, in the units of the columns, below which a direction is left out; rounding is left out anyhow.
        """
        # what rounding leaves of rigid motions would grow with every solve, and come back as modes of no frequency
        new = new - self.rigid @ (self.rigid_momentum.T @ new)
        scale = float(np.einsum("ij,ij->j", new, self.reference @ new).max())
        found, image = extension(new, self.vectors, self.image, self.reference, least=max(least, ROUNDING * scale))
        self.append(found[:, ::-1], image[:, ::-1])
        return int(found.shape[1])

    def append(self, new: Array, image: Array | None = None) -> None:
        """Take columns (n, k) as they are: orthonormal, with each other and with those that are here.

        image: reference @ new, computed where None.
        """
        self.image = np.concatenate([self.image, self.reference @ new if image is None else image], axis=1)
        for i, operator in enumerate(self.operators):
            image = operator @ new
            corner, side = new.T @ image, self.vectors.T @ image
            self.small[i] = np.block([[self.small[i], side], [side.T, (corner + corner.T) / 2]])
        self.relative = [
            np.concatenate([old, trace.relative @ new], axis=1)
            for old, trace in zip(self.relative, self.traces, strict=True)
        ]
        self.vectors = np.concatenate([self.vectors, new], axis=1)

    def turn(self, rotation: Array) -> None:
        """Replace the vectors by combinations of them, the columns of `rotation` (size, k), orthonormal."""
        self.vectors, self.image = self.vectors @ rotation, self.image @ rotation
        self.small = [rotation.T @ matrix @ rotation for matrix in self.small]
        self.relative = [relative @ rotation for relative in self.relative]


class Reduction:
    """Bases for equilibrium and vibration of one structure, grown from variants; `model` is what evaluates others."""

    def __init__(
        self,
        structure: Structure,
        *,
        factor: Factorisation,
        reference: Any,
        state: Array,
        shapes: Array,
        count: int,
        shares: PartShares | None = None,
    ) -> None:
        """Start from a factorised reference.

        reference (n, n): stiffness + joints + shift x mass, of which `factor` is the factorisation; state (n,): a
        displacement in equilibrium; shapes (n, m): elastic modes at the reference, more than the `count` that is asked
        for; shares: of the parts whose stiffness and mass variants may scale.
        """
        from scipy.linalg import cholesky, solve_triangular

        self.stiffness, self.mass = structure.vibrating
        self.stiffness_static = constrain(structure.standing, structure.fixed, 0.0)
        self.traces, self.factor, self.reference = [joint.interface for joint in structure.joints], factor, reference
        self.fixed, mass, rigid = structure.fixed, self.mass, structure.rigid
        self.loads = loads = structure.loads.copy()
        loads[self.fixed] = 0.0
        if rigid.shape[1]:
            root = cholesky(rigid.T @ (mass @ rigid))
            rigid = solve_triangular(root, rigid.T, trans="T").T
        motions = {"rigid": rigid, "rigid_momentum": np.asarray(mass @ rigid)}
        self.shares, more = shares, (() if shares is None else shares.standing)
        self.static = Basis(
            reference=reference, operators=(self.stiffness_static, *more), traces=self.traces, **motions
        )
        self.static.add(state[:, None])
        self.static.add(factor.solve(np.asfortranarray(loads)))
        more = () if shares is None else (*shares.stiffness, *shares.mass)
        self.dynamic = Basis(
            reference=reference, operators=(self.stiffness, mass, *more), traces=self.traces, **motions
        )
        self.dynamic.add(shapes)
        self._seen: list[tuple[tuple[JointLaw, ...], tuple[Array, ...], Scales | None]] = []
        self.model = ReducedModel(
            weights=[trace.weights for trace in self.traces],
            gaps=[trace.gap for trace in self.traces],
            static_stiffness=self.static.small[0],
            static_loads=self.static.vectors.T @ loads,
            static_relative=self.static.relative,
            dynamic_stiffness=self.dynamic.small[0],
            dynamic_mass=self.dynamic.small[1],
            dynamic_relative=self.dynamic.relative,
            count=count,
            coarse=self.dynamic.vectors.shape[1],
            shares=self._reduced_shares(),
        )

    def _reduced_shares(self) -> ReducedShares | None:
        """The shares of the parts in both bases."""
        if self.shares is None:
            return None
        count, rigid = len(self.shares.parts), self.dynamic.rigid
        pushed = [np.asarray(mass @ rigid) for mass in self.shares.mass]
        return ReducedShares(
            standing=np.stack(self.static.small[1:]),
            stiffness=np.stack(self.dynamic.small[2 : 2 + count]),
            mass=np.stack(self.dynamic.small[2 + count :]),
            cross=np.stack([momentum.T @ self.dynamic.vectors for momentum in pushed]),
            corner=np.stack([rigid.T @ momentum for momentum in pushed]),
        )

    def probe(self, rows: Any) -> tuple[Array, Array]:
        """What sparse rows (k, n) see of the basis for vibration (k, d) and of the rigid motions (k, r)."""
        return np.asarray(rows @ self.dynamic.vectors), np.asarray(rows @ self.dynamic.rigid)

    @classmethod
    def of(
        cls,
        structure: Structure,
        laws: Sequence[JointLaw],
        forces: Array,
        *,
        count: int,
        shift_frequency: float | None = None,
        solver: str | None = None,
        shares: PartShares | None = None,
    ) -> Self:
        """Solve one variant of a structure in full, its bolts pulled at once, and start from that.

        laws: the law of each joint; forces [N] (bolts,); count: elastic modes wanted; shares: of the parts that
        variants may scale, which this one does not. Raises InputError where a part is held by nothing.
        """
        joints = tuple(replace(joint, law=law) for joint, law in zip(structure.joints, laws, strict=True))
        structure = replace(structure, joints=joints)
        found = checked_preload(structure, structure.assembly(solver=solver), [float(f) for f in forces])
        shift = shift_frequency or structure.shift_frequency
        _, mass = structure.vibrating
        joined, _ = structure.joined(structure.springs(found.pressures))
        rigid_count = structure.rigid_count
        modes = lowest_modes(joined, mass, rigid_count + count + EXTRA_MODES, shift_frequency=shift, solver=solver)
        check_motions(structure, modes)
        return cls(
            structure,
            factor=modes.factorisation,
            reference=(joined + modes.shift * mass).tocsr(),
            state=found.displacement,
            shapes=modes.shapes[:, rigid_count:],
            count=count,
            shares=shares,
        )

    def _refresh(self, coarse: int | None = None) -> None:
        self.model = replace(
            self.model,
            static_stiffness=self.static.small[0],
            static_relative=self.static.relative,
            static_loads=self.static.vectors.T @ self.loads,
            dynamic_stiffness=self.dynamic.small[0],
            dynamic_mass=self.dynamic.small[1],
            dynamic_relative=self.dynamic.relative,
            coarse=self.model.coarse if coarse is None else coarse,
            shares=self._reduced_shares(),
        )

    def _scaled(self, matrix: Any, shares: Sequence[Any], kind: int, x: Any) -> Any:
        """Product of a matrix of the structure with x, its parts scaled; kind: 0 for stiffness, 1 for mass."""
        out = matrix @ x
        for scales, share in zip(self.model.scales or (), shares, strict=False):
            if scales[kind] != 1:
                out = out + (scales[kind] - 1) * (share @ x)
        return out

    def _static_residual(
        self, laws: Sequence[JointLaw], forces: Array, friction: Sequence[float | None], found: PreloadState
    ) -> Array:
        u = self.static.vectors @ found.displacement
        shares = () if self.shares is None else self.shares.standing
        residual = self.loads @ forces - self._scaled(self.stiffness_static, shares, 0, u)
        for trace, law, limit, p, relative in zip(
            self.traces, laws, friction, found.pressures, self.static.relative, strict=True
        ):
            slip = (relative @ found.displacement).reshape(-1, 3)[:, 1:]
            grip = StickSlip(
                k_t=law.stiffness(p)[1], limit=None if limit is None else limit * p, anchor=np.zeros_like(slip)
            )
            local = np.concatenate([-p[:, None], grip.shear(slip)], axis=1) * trace.weights[:, None]
            residual = residual - trace.relative.T @ local.ravel()
        residual[self.fixed] = 0.0
        return np.asarray(residual)

    def static_error(
        self, laws: Sequence[JointLaw], forces: Array, friction: Sequence[float | None], found: PreloadState
    ) -> tuple[float, Array]:
        """Error of an equilibrium in energy over that of the joints' springs [-], and what would mend it (n,)."""
        residual = self._static_residual(laws, forces, friction, found)
        answer = self.factor.solve(residual)
        return float(np.sqrt(np.maximum(residual @ answer, 0.0)) / _pressed(self.traces, laws, found)), answer

    def train_static(
        self,
        laws: Sequence[JointLaw],
        forces: Array,
        friction: Sequence[float | None],
        tolerance: float,
        start: Array | None = None,
    ) -> PreloadState:
        """Enrich until the equilibrium of a variant is right to `tolerance` in energy; return it."""
        error = np.inf
        for _ in range(FEW_STEPS):
            found = self.model.equilibrium(laws, forces, friction, start)
            error, mend = self.static_error(laws, forces, friction, found)
            if error < tolerance:
                return found
            start = found.displacement
            self.static.add(mend[:, None])
            self._refresh()
        raise NotConverged(
            f"reduction: {FEW_STEPS} enrichments leave the preload wrong by {error:.1e}; raise the tolerance"
        )

    def modal_error(
        self, laws: Sequence[JointLaw], pressures: Sequence[Array], tolerance: float = 0.0, which: Any = slice(None)
    ) -> tuple[Array, Array]:
        """Estimated relative error of the complex eigenvalues (m,) of a variant, and what would mend it (n, k).

        The square of the residual in the energy norm: eigenvalues err by the square of their vectors. What would mend
        it is for the modes whose error exceeds the tolerance, real and imaginary parts where there is loss. which: of
        the modes, all of them where not given.
        """
        springs = self.model.springs(laws, pressures)
        values, vectors, _ = self.model.modes(springs, slight=0.0)  # no basis mends what first order leaves
        values, vectors = values[which], vectors[:, which]
        momentum = self.model.matrices[2] @ vectors
        size = np.abs(values) * np.abs(np.einsum("ij,ij->j", vectors.conj(), momentum))
        parts = _parts(self._modal_residual(springs, values, vectors))
        solved = [self.factor.solve(np.asfortranarray(part)) for part in parts]
        energy = sum(np.einsum("ij,ij->j", part, answer) for part, answer in zip(parts, solved, strict=True))
        error = np.asarray(energy / size)
        poor = error > tolerance
        return error, np.concatenate([answer[:, poor] / np.sqrt(size[poor]) for answer in solved], axis=1)

    def _modal_residual(self, springs: Sequence[Springs[ReducedMotion]], values: Any, vectors: Any) -> Any:
        lossy = any(np.any(d.loss_n) or np.any(d.loss_t) for d in springs)
        if not lossy:
            values, vectors = values.real, vectors.real
        x = self.dynamic.vectors @ vectors
        stiffness, mass = ((), ()) if self.shares is None else (self.shares.stiffness, self.shares.mass)
        residual = self._scaled(self.stiffness, stiffness, 0, x)
        if self.model.scales is not None and self.model.shares is not None:
            x = x + self.dynamic.rigid @ (self.model.shares.motion(self.model.scales) @ vectors)
        residual = residual - self._scaled(self.mass, mass, 1, x) * values
        for trace, relative, d in zip(self.traces, self.dynamic.relative, springs, strict=True):
            n, t = trace.weights * d.k_n, trace.weights * d.k_t
            if lossy:
                n, t = n * (1 + 1j * d.loss_n), t * (1 + 1j * d.loss_t)
            share = np.stack([n, t, t], axis=1).reshape(-1, 1)
            residual = residual + trace.relative.T @ (share * (relative @ vectors))
        residual[self.fixed] = 0.0
        return np.asarray(residual)

    def train_dynamic(self, laws: Sequence[JointLaw], pressures: Sequence[Array], tolerance: float) -> None:
        """Enrich until all modes of a variant are right; tolerance: of the complex eigenvalues."""
        poor: Any = np.arange(self.model.count)
        for _ in range(FEW_STEPS):
            error, mend = self.modal_error(laws, pressures, tolerance, poor)
            poor = poor[error > tolerance]  # the others only gain by what is added
            if not len(poor):
                return
            new = self.dynamic.add(mend, least=0.02 * tolerance)
            self._refresh()
            if not new:
                raise NotConverged(f"reduction: the modes stay wrong by {error.max():.1e} and nothing improves them")
        raise NotConverged(
            f"reduction: {FEW_STEPS} enrichments do not bring a mode to {tolerance:.0e}; ask for fewer modes"
        )

    def train(
        self,
        laws: Sequence[JointLaw],
        forces: Array,
        friction: Sequence[float | None],
        *,
        tolerance: float,
        start: Array | None = None,
        gaps: Sequence[Array] | None = None,
        scales: Scales | None = None,
    ) -> Array:
        """Make the bases fit one variant; tolerance: relative error of a frequency; start: see `ReducedModel.evaluate`.

        gaps: of the joints before any load [m] (q,), those of the model where None; scales: of the parts. The model has
        both from then on. Returns the coefficients from which a like variant may start.
        """
        self.model = self.model.with_gaps(gaps).with_scales(scales)
        found = self.train_static(laws, forces, friction, STATIC_SHARE * tolerance, start)
        self.train_dynamic(laws, found.pressures, 2 * tolerance)
        self._seen.append((tuple(laws), found.pressures, scales))
        return found.displacement

    @property
    def trained(self) -> int:
        """Number of variants that the bases have been made to fit."""
        return len(self._seen)

    def compress(self, tolerance: float) -> None:
        """Keep of the basis for vibration what the modes of all variants trained on need, most needed first."""
        columns = []
        for laws, pressures, scales in self._seen:
            model = self.model.with_scales(scales)
            _, vectors, _ = model.modes(model.springs(laws, pressures))
            columns += _parts(vectors / np.linalg.norm(vectors, axis=0))
        rotation, size, _ = np.linalg.svd(np.concatenate(columns, axis=1), full_matrices=False)
        share = size**2
        self.dynamic.turn(rotation[:, share > 0.3 * tolerance])
        self._refresh(max(int(np.count_nonzero(share > 30 * tolerance)), self.model.count))

    def evaluate(
        self, laws: Sequence[JointLaw], forces: Array, friction: Sequence[float | None], start: Array | None = None
    ) -> Variant:
        """Modes under one law per joint and one force per bolt [N] (b,); see `ReducedModel.evaluate`."""
        return self.model.evaluate(laws, forces, friction, start)
