"""Makes the small bases of a structure of which only the joints change.

PreloadState, roughness and contact model act on the faying faces alone, so one factorisation serves every variant. The
basis of each problem (equilibrium, vibration) starts from a reference state and is enriched by what that factorisation
makes of the residual of a variant, until the residual says that the variant is solved. The estimate of the error is
that of the residual in the energy norm of the reference. What the variants trained on need of the basis for vibration
is kept, most needed first, so that its leading part is a coarser basis: the difference between the two is the cheap
estimate that every evaluation carries.
"""

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Self

import numpy as np

from faying.errors import NotConverged
from faying.joint.equilibrium import PreloadState, StickSlip
from faying.joint.joint_law import JointLaw
from faying.joint.preload_case import PreloadCase
from faying.joint.springs import Springs, stacked, unstacked
from faying.joint.structure import Structure
from faying.joint.support_check import check_motions, checked_preload
from faying.numerics.basis import Basis
from faying.numerics.constraint import constrain
from faying.numerics.follow import follow
from faying.numerics.modes import lowest_modes
from faying.numerics.product import product
from faying.numerics.shifted import Shifted
from faying.numerics.single import factorise_roughly
from faying.numerics.solve import Factorisation
from faying.reduction.part_shares import PartShares, ReducedShares, Scales
from faying.reduction.reduced import ReducedModel, ReducedMotion, Variant
from faying.typing import Array

MAX_ENRICHMENTS = 60  # enrichments of one variant after which something else must be wrong
AT_ONCE = 64  # modes of variants that are enriched together: a factor is read once for all, and more take more room
EXTRA_MODES = 25  # real modes of the reference beyond those wanted: they speed the enrichment of the highest ones
# the force balance enters a frequency through k(p), to first order; the modes enter by the square of their error
STATIC_SHARE = 15.0
LEFT_OUT = 0.1  # of the tolerance of an eigenvalue: energy of a direction of the basis for vibration that is not taken


def pressed(interfaces: Sequence[Any], laws: Sequence[JointLaw], found: PreloadState) -> float:
    """Root of the energy [sqrt(J)], twice, of the joints' normal springs under their pressures.

    What the parts and a bolt's shank store beside it says nothing of how exact the pressures are.
    """
    total = 0.0
    for interface, law, p in zip(interfaces, laws, found.pressures, strict=True):
        k_n = np.where(p > 0, law.stiffness(p)[0], 1.0)
        total += float(interface.weights @ (p**2 / k_n))
    return float(np.sqrt(total))


def real_parts(values: Any) -> list[Array]:
    """Real and imaginary part; the real one alone where the other is zero."""
    return [values.real, values.imag] if np.any(values.imag) else [np.asarray(values.real)]


@dataclass(frozen=True, kw_only=True)
class Gapped:
    """One variant: the law of each joint, force of each bolt [N] (b,), friction and gap [m] (q,) of each joint.

    scales: of the parts; start: coefficients of a like equilibrium, where one is known.
    """

    laws: Sequence[JointLaw]
    forces: Array
    friction: Sequence[float | None]
    gaps: Sequence[Array]
    scales: Scales | None = None
    start: Array | None = None


class Reduction:
    """Bases for equilibrium and vibration of one structure, grown from variants; `model` is what evaluates others."""

    def __init__(
        self, structure: Structure, *, factor: Factorisation, reference: Any, shares: PartShares | None
    ) -> None:
        """Empty bases about a factorised reference.

        reference (n, n): stiffness + joints + shift x mass, of which `factor` is the factorisation; shares: of the
        parts whose stiffness and mass variants may scale.
        """
        from scipy.linalg import cholesky, solve_triangular

        self.stiffness, self.mass = structure.dynamic_matrices
        self.stiffness_static = constrain(structure.supported_stiffness, structure.fixed, 0.0)
        self.interfaces, self.factor = [joint.interface for joint in structure.joints], factor
        self.fixed, mass, rigid = structure.fixed, self.mass, structure.rigid
        self.loads = structure.loads.copy()
        self.loads[self.fixed] = 0.0
        if rigid.shape[1]:
            root = cholesky(rigid.T @ (mass @ rigid))
            rigid = solve_triangular(root, rigid.T, trans="T").T
        basis = partial(
            Basis,
            reference=reference,
            interfaces=self.interfaces,
            rigid=rigid,
            rigid_momentum=np.asarray(mass @ rigid),
        )
        self.shares = shares = PartShares() if shares is None else shares
        self._pushed = [np.asarray(share @ rigid).T for share in shares.mass]
        self.static = basis(operators=(self.stiffness_static, *shares.supported_stiffness), rows=[self.loads.T])
        self.dynamic = basis(operators=(self.stiffness, mass, *shares.stiffness, *shares.mass), rows=self._pushed)
        # springs (4, points of all joints) of the reference, with its shift
        self._reference: tuple[Array, float] | None = None
        # modes of the variants trained on, in the basis for vibration as it was then: real and imaginary parts
        self._needed: list[Array] = []
        # equilibria of variants, over their energy, in the basis for equilibrium as it was then
        self._states: list[Array] = []
        self.trained = self.learnt = 0  # number of variants that the bases have been made to fit, and are compressed by

    @classmethod
    def about(
        cls,
        structure: Structure,
        *,
        factor: Factorisation,
        reference: Any,
        state: Array,
        shapes: Array,
        count: int,
        shares: PartShares | None = None,
    ) -> Self:
        """Start from a solution of the reference.

        factor, reference, shares: of the empty bases; state (n,): a displacement in equilibrium; shapes (n, m): elastic
        modes at the reference, more than the `count` that is asked for.
        """
        made = cls(structure, factor=factor, reference=reference, shares=shares)
        made.static.add(state[:, None])
        made.static.add(factor.solve(np.asfortranarray(made.loads)))
        made.dynamic.add(shapes)
        made._project(count, made.dynamic.vectors.shape[1])
        return made

    def _project(self, count: int, coarse: int) -> None:
        """Make `model` of the bases as they are."""
        self.model = ReducedModel(
            weights=[interface.weights for interface in self.interfaces],
            gaps=[interface.gap for interface in self.interfaces],
            static_stiffness=self.static.small[0],
            static_loads=self.static.at_rows[0].T,
            static_relative=self.static.relative,
            dynamic_stiffness=self.dynamic.small[0],
            dynamic_mass=self.dynamic.small[1],
            dynamic_relative=self.dynamic.relative,
            count=count,
            coarse=coarse,
            shares=self._reduced_shares(),
        )

    def arrays(self) -> dict[str, Array]:
        """All that `resumed` needs beside the structure, to be kept in a file; of bases that `of` has begun."""
        assert self._reference is not None
        return {
            "count": np.array(self.model.count),
            "coarse": np.array(self.model.coarse),
            "static": self.static.vectors,
            "dynamic": self.dynamic.vectors,
            "reference": self._reference[0],
            "shift": np.array(self._reference[1]),
            "needed": padded(self._needed, self.dynamic.vectors.shape[1]),
            "states": padded(self._states, self.static.vectors.shape[1]),
            "trained": np.array(self.trained),
            "learnt": np.array(self.learnt),
        }

    @classmethod
    def resumed(
        cls,
        structure: Structure,
        kept: Mapping[str, Array],
        *,
        solver: str | None = None,
        shares: PartShares | None = None,
    ) -> Self:
        """The bases that `arrays` has given, their reference factorised again."""
        springs = unstacked(kept["reference"], [joint.interface for joint in structure.joints])
        shifted = Shifted(
            stiffness=structure.coupled(springs)[0], mass=structure.dynamic_matrices[1], shift=float(kept["shift"])
        )
        factor = factorise_roughly(shifted, rigid=structure.rigid, solver=solver)
        made = cls(structure, factor=factor, reference=shifted.assembled(), shares=shares)
        made._reference = kept["reference"], float(kept["shift"])
        made.static.append(kept["static"])
        made.dynamic.append(kept["dynamic"])
        made._needed, made._states = [kept["needed"]], [kept["states"]]
        made.trained, made.learnt = int(kept["trained"]), int(kept["learnt"])
        made._project(int(kept["count"]), int(kept["coarse"]))
        return made

    def _reduced_shares(self) -> ReducedShares | None:
        """The shares of the parts in both bases."""
        count = len(self.shares.parts)
        if not count:
            return None
        return ReducedShares(
            supported_stiffness=np.stack(self.static.small[1:]),
            stiffness=np.stack(self.dynamic.small[2 : 2 + count]),
            mass=np.stack(self.dynamic.small[2 + count :]),
            cross=np.stack(self.dynamic.at_rows),
            corner=np.stack([momentum @ self.dynamic.rigid for momentum in self._pushed]),
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
        structure = structure.with_joints(laws=laws)
        found = checked_preload(structure, structure.assembly(solver=solver), PreloadCase(tuple(map(float, forces))))
        shift = shift_frequency or structure.shift_frequency
        _, mass = structure.dynamic_matrices
        springs = structure.springs(found.pressures)
        joined, _ = structure.coupled(springs)
        rigid_count = structure.rigid_count
        modes = lowest_modes(joined, mass, rigid_count + count + EXTRA_MODES, shift_frequency=shift, solver=solver)
        check_motions(structure, modes)
        shifted = Shifted(stiffness=joined, mass=mass, shift=modes.shift)
        made = cls.about(
            structure,
            factor=factorise_roughly(shifted, rigid=structure.rigid, solver=solver),
            reference=shifted.assembled(),
            state=found.displacement,
            shapes=modes.shapes[:, rigid_count:],
            count=count,
            shares=shares,
        )
        made._reference = stacked(springs), modes.shift
        return made

    def refresh(self, coarse: int | None = None) -> None:
        """Make `model` again, under the gaps and scales that it has."""
        old = self.model
        self._project(old.count, old.coarse if coarse is None else coarse)
        self.model = replace(self.model, gaps=old.gaps, scales=old.scales)

    def _scaled(self, matrix: Any, shares: Sequence[Any], kind: int, x: Any) -> Any:
        """Product of a matrix of the structure with x, its parts scaled; kind: 0 for stiffness, 1 for mass."""
        out = product(matrix, x)
        for scales, share in zip(self.model.scales or (), shares, strict=False):
            if scales[kind] != 1:
                out = out + (scales[kind] - 1) * product(share, x)
        return out

    def static_residual(
        self, laws: Sequence[JointLaw], forces: Array, friction: Sequence[float | None], found: PreloadState
    ) -> Array:
        """What an equilibrium leaves of the forces [N] (n,)."""
        u = self.static.vectors @ found.displacement
        residual = self.loads @ forces - self._scaled(self.stiffness_static, self.shares.supported_stiffness, 0, u)
        for interface, law, limit, p, relative in zip(
            self.interfaces, laws, friction, found.pressures, self.static.relative, strict=True
        ):
            slip = (relative @ found.displacement).reshape(-1, 3)[:, 1:]
            slip_state = StickSlip(
                k_t=law.stiffness(p)[1], limit=None if limit is None else limit * p, anchor=np.zeros_like(slip)
            )
            local = np.concatenate([-p[:, None], slip_state.shear(slip)], axis=1) * interface.weights[:, None]
            residual = residual - interface.relative.T @ local.ravel()
        residual[self.fixed] = 0.0
        return np.asarray(residual)

    def static_error(
        self, laws: Sequence[JointLaw], forces: Array, friction: Sequence[float | None], found: PreloadState
    ) -> tuple[float, Array]:
        """Error of an equilibrium in energy over that of the joints' springs [-], and what would correct it (n,)."""
        residual = self.static_residual(laws, forces, friction, found)
        answer = self.factor.solve(residual)
        return float(np.sqrt(np.maximum(residual @ answer, 0.0)) / pressed(self.interfaces, laws, found)), answer

    def modal_error(self, laws: Sequence[JointLaw], pressures: Sequence[Array], which: Any = slice(None)) -> Array:
        """Estimated relative error of the complex eigenvalues (m,) of a variant; which: of them, all where not given.

        The square of the residual in the energy norm: eigenvalues err by the square of their vectors.
        """
        parts, size = self.modal_parts(laws, pressures, which)
        energy = sum(np.einsum("ij,ij->j", part, self.factor.solve(np.asfortranarray(part))) for part in parts)
        return np.asarray(energy / size)

    def modal_parts(
        self, laws: Sequence[JointLaw], pressures: Sequence[Array], which: Any
    ) -> tuple[list[Array], Array]:
        """What some modes of a variant leave (n, m), real and imaginary part where there is loss; their size (m,)."""
        springs = self.model.springs(laws, pressures)
        values, vectors, _ = self.model.modes(springs, slight=0.0)  # no basis corrects what first order leaves
        values, vectors = values[which], vectors[:, which]
        momentum = self.model.matrices[2] @ vectors
        size = np.abs(values) * np.abs(np.einsum("ij,ij->j", vectors.conj(), momentum))
        return real_parts(self.modal_residual(springs, values, vectors)), size

    def modal_residual(self, springs: Sequence[Springs[ReducedMotion]], values: Any, vectors: Any) -> Any:
        """What complex eigenvalues (m,) and vectors (d, m) of a variant leave of the equations of motion (n, m)."""
        lossy = any(d.lossy for d in springs)
        if not lossy:
            values, vectors = values.real, vectors.real
        parts = np.concatenate(real_parts(vectors), axis=1) if lossy else vectors
        x = self.dynamic.vectors @ parts  # real, so that the products with the matrices are
        force = self._scaled(self.stiffness, self.shares.stiffness, 0, x)
        if self.model.scales is not None and self.model.shares is not None:
            x = x + self.dynamic.rigid @ (self.model.shares.motion(self.model.scales) @ parts)
        moved = self._scaled(self.mass, self.shares.mass, 1, x)
        if parts.shape[1] > vectors.shape[1]:
            force, moved = (both[:, : len(values)] + 1j * both[:, len(values) :] for both in (force, moved))
        residual = force - moved * values
        for interface, relative, d in zip(self.interfaces, self.dynamic.relative, springs, strict=True):
            n, t = interface.weights * d.k_n, interface.weights * d.k_t
            if lossy:
                n, t = n * (1 + 1j * d.loss_n), t * (1 + 1j * d.loss_t)
            share = np.stack([n, t, t], axis=1).reshape(-1, 1)
            residual = residual + interface.relative.T @ (share * (relative @ vectors))
        residual[self.fixed] = 0.0
        return np.asarray(residual)

    def frequency_error(
        self, laws: Sequence[JointLaw], forces: Array, friction: Sequence[float | None], found: PreloadState, count: int
    ) -> float:
        """Estimated relative error of the first frequencies [-], by what modes and equilibrium leave in the equations.

        Of the equilibrium that is what the frequencies change by under the pressures that one correction gives.
        """
        modal = self.modal_error(laws, found.pressures, slice(count))
        _, correction = self.static_error(laws, forces, friction, found)
        moved = [(interface.relative @ correction)[::3] for interface in self.interfaces]
        corrected = [law.pressure(-gap - by)[0] for law, gap, by in zip(laws, found.openings, moved, strict=True)]
        old, new = (self.model.modes(self.model.springs(laws, p))[0].real for p in (found.pressures, corrected))
        return float(modal.max() + np.abs(new / old - 1)[:count].max()) / 2  # of a square of a frequency

    def with_halves(self, laws: Sequence[JointLaw], pressures: Sequence[Array]) -> tuple[Array, Array, list[Array]]:
        """Modes of a variant without loss, and their frequencies with each half of the points of the joints.

        The basis for vibration grows by what the halves need. Returns frequencies [Hz] (m,), mass-normalised shapes
        (n, m) and the frequencies of each half (m,), each of the mode whose shape it has.
        """

        def springs() -> list[list[Springs[ReducedMotion]]]:
            whole = [s.lossless() for s in self.model.springs(laws, pressures)]
            return [whole, *([s.half(which) for s in whole] for which in (0, 1))]

        whole, *halves = springs()
        values, shapes, _ = self.model.modes(whole)
        left = [self.modal_residual(half, values, shapes) / np.sqrt(values.real) for half in halves]
        self.dynamic.add(self.factor.solve(np.asfortranarray(np.concatenate(left, axis=1))))
        self.refresh()
        found = map(self.model.modes, springs())
        (f, turned), *changed = [(np.sqrt(values.real) / (2 * np.pi), shapes.real) for values, shapes, _ in found]
        mass = self.model.matrices[2]
        return f, self.dynamic.vectors @ turned, [new[follow(turned, other, mass, f)] for new, other in changed]

    def at(self, variant: Gapped) -> ReducedModel:
        """The bases as they are, with the gaps and scales of a variant; `model` has them from then on."""
        self.model = self.model.with_gaps(variant.gaps).with_scales(variant.scales)
        return self.model

    def branch(self) -> Self:
        """Bases that begin as these and grow by themselves; of branches only one may grow at a time."""
        made = copy(self)
        made.static, made.dynamic = self.static.branch(), self.dynamic.branch()
        return made

    def train_each(
        self, every: Sequence[Sequence[Gapped]], tolerance: float
    ) -> list[list[PreloadState] | NotConverged]:
        """Make the bases fit groups of variants, together; the equilibria of each group, or why it has none.

        Where they cannot be trained together, each group is trained alone, so that one without an answer loses none
        else.
        """
        try:
            found = iter(self.train_together([one for group in every for one in group], tolerance))
        except NotConverged as fault:
            return [fault] if len(every) == 1 else [self.train_each([group], tolerance)[0] for group in every]
        return [[next(found) for _ in group] for group in every]

    def train_together(self, variants: Sequence[Gapped], tolerance: float) -> list[PreloadState]:
        """Make the bases fit several variants, which costs less than one after the other; return their equilibria.

        A factor is read once for the corrections of all, and each block of new directions is projected once.
        tolerance: relative error of a frequency. Raises NotConverged where a variant has no equilibrium, or its error
        does not fall.
        """
        found = self._train_static(variants, STATIC_SHARE * tolerance)
        self._train_dynamic(variants, found, 2 * tolerance)
        return found

    def _train_static(self, variants: Sequence[Gapped], tolerance: float) -> list[PreloadState]:
        """Grow the basis for equilibrium until every variant is right to `tolerance` in energy; their equilibria."""
        found: dict[int, PreloadState] = {}
        poor, error = list(range(len(variants))), np.full(len(variants), np.inf)
        for _ in range(MAX_ENRICHMENTS):
            residuals = []
            for k in poor:
                one, start = variants[k], found[k].displacement if k in found else variants[k].start
                found[k] = self.at(one).equilibrium(one.laws, one.forces, one.friction, start)
                residuals.append(self.static_residual(one.laws, one.forces, one.friction, found[k]))
            right = np.asfortranarray(np.stack(residuals, axis=1))
            answers = self.factor.solve(right)
            work = np.maximum(np.einsum("ij,ij->j", right, answers), 0.0)
            error = np.sqrt(work) / [pressed(self.interfaces, variants[k].laws, found[k]) for k in poor]
            far = ~(error < tolerance)
            poor = [k for k, is_far in zip(poor, far, strict=True) if is_far]
            if not poor:
                return [found[k] for k in range(len(variants))]
            self.static.add(answers[:, far])
            self.refresh()
        what = f"the preload wrong by {error.max():.1e}" if len(variants) == 1 else f"{len(poor)} equilibria wrong"
        raise NotConverged(f"reduction: {MAX_ENRICHMENTS} enrichments leave {what}; raise the tolerance")

    def _train_dynamic(self, variants: Sequence[Gapped], found: Sequence[PreloadState], tolerance: float) -> None:
        """Grow the basis for vibration until all modes of every variant are right; tolerance: of the eigenvalues."""
        poor: list[Any] = [np.arange(self.model.count)] * len(variants)
        at_once = max(1, AT_ONCE // self.model.count)
        for _ in range(MAX_ENRICHMENTS):
            open_, most, grown = [k for k, some in enumerate(poor) if len(some)], 0.0, 0
            if not open_:
                return
            for begin in range(0, len(open_), at_once):
                some = open_[begin : begin + at_once]
                corrections, error = self._corrections(variants, found, poor, some, tolerance)
                most = max(most, error)
                if corrections:
                    grown += self.dynamic.add(np.concatenate(corrections, axis=1), least=LEFT_OUT * tolerance)
                    self.refresh()
            if not grown and any(len(some) for some in poor):
                what = f"the modes stay wrong by {most:.1e}" if len(variants) == 1 else "some modes stay wrong"
                raise NotConverged(f"reduction: {what} and nothing improves them")
        raise NotConverged(
            f"reduction: {MAX_ENRICHMENTS} enrichments do not bring a mode to {tolerance:.0e}; ask for fewer modes"
        )

    def _corrections(
        self,
        variants: Sequence[Gapped],
        found: Sequence[PreloadState],
        poor: list[Any],
        some: Sequence[int],
        tolerance: float,
    ) -> tuple[list[Array], float]:
        """What mends the modes of some variants that are wrong by more than the tolerance, and the greatest error.

        poor: of every variant, the modes that were wrong; those that are right now are taken out.
        """
        left = []
        for k in some:
            self.at(variants[k])
            left.append((k, *self.modal_parts(variants[k].laws, found[k].pressures, poor[k])))
        right = np.asfortranarray(np.concatenate([part for _, parts, _ in left for part in parts], axis=1))
        answers = self.factor.solve(right)
        energy = np.einsum("ij,ij->j", right, answers)
        corrections, at, most = [], 0, 0.0
        for k, parts, size in left:
            spans = [slice(at + i * len(size), at + (i + 1) * len(size)) for i in range(len(parts))]
            error = np.sum([energy[span] for span in spans], axis=0) / size
            far, most = error > tolerance, max(most, float(error.max()))
            corrections += [answers[:, span][:, far] / np.sqrt(size[far]) for span in spans]
            poor[k] = poor[k][far]  # the others only gain by what is added
            at += len(parts) * len(size)
        return [correction for correction in corrections if correction.shape[1]], most

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
        gaps = self.model.gaps if gaps is None else gaps
        one = Gapped(laws=laws, forces=forces, friction=friction, gaps=gaps, scales=scales, start=start)
        (found,) = self.train_together([one], tolerance)
        _, vectors, _ = self.model.modes(self.model.springs(laws, found.pressures))
        self._note(laws, found, vectors)
        self.trained += 1
        return found.displacement

    def _note(self, laws: Sequence[JointLaw], found: PreloadState, vectors: Any) -> None:
        """Keep in mind what a variant needs of the bases as they are."""
        self._states.append(found.displacement[:, None] / pressed(self.interfaces, laws, found))
        self._needed += real_parts(vectors / np.linalg.norm(vectors, axis=0))

    def learn(self, laws: Sequence[JointLaw], found: Variant) -> None:
        """Keep in mind what a variant needs that was evaluated in the bases as they are: they are compressed by it."""
        self._note(laws, found.preload, found.shapes)
        self.learnt += 1

    def compress(self, tolerance: float) -> None:
        """Keep of the bases what variants need, most needed first.

        None of those that were learnt may lose more than the tolerance lets it: a frequency by the energy of what is
        left out of its mode, an equilibrium by that of its displacement.
        """
        columns = padded(self._needed, self.dynamic.vectors.shape[1])
        states = padded(self._states, self.static.vectors.shape[1])
        turned = for_states(states, STATIC_SHARE * tolerance, self.learnt)
        if turned is not None:
            self.static.turn(turned)
            self._states = [turned.T @ states]
        rotation, coarse = for_modes(columns, tolerance, learnt=self.learnt > 0)
        self.dynamic.turn(rotation)
        self._needed = [rotation.T @ columns]
        self.refresh(max(coarse, self.model.count))


# times the tolerance: what the leading part of the basis for vibration may miss, from which errors are estimated
COARSER = 140.0
FEW_NEED, FEW_COARSE = 0.3, 30.0  # the same of sums over few variants, for all of the basis and for its leading part
ENOUGH = 1.5  # variants learnt, for each combination of displacements that they need


def padded(columns: Sequence[Array], size: int) -> Array:
    """Columns of coefficients in a basis of `size` vectors that has grown since, one behind the other (size, k)."""
    grown = [np.pad(one, ((0, size - len(one)), (0, 0))) for one in columns]
    return np.concatenate([np.zeros((size, 0)), *grown], axis=1)


def needed(shares: Array, most: float) -> int:
    """How many leading rows of `shares` (d, k) have to stay, so that no column loses more of its square than `most`."""
    lost = np.cumsum(shares[::-1] ** 2, axis=0).max(axis=1, initial=0.0)
    return len(shares) - int(np.count_nonzero(lost <= most))


def for_modes(columns: Array, tolerance: float, *, learnt: bool) -> tuple[Array, int]:
    """Combinations (d, r) of a basis for vibration to be kept, most needed first, and how many make its coarser part.

    columns (d, k): modes, of length 1 in the energy of the basis; tolerance: of an eigenvalue; learnt: whether they are
    those of many variants, none of which may then lose more than the tolerance; of few the sum counts, since what lies
    between them needs more than they do.
    """
    rotation, size, _ = np.linalg.svd(columns, full_matrices=False)
    if learnt:
        kept, coarse = (needed(rotation.T @ columns, most) for most in (tolerance, COARSER * tolerance))
    else:
        kept, coarse = (int(np.count_nonzero(size**2 > most * tolerance)) for most in (FEW_NEED, FEW_COARSE))
    return rotation[:, :kept], coarse


def for_states(states: Array, tolerance: float, learnt: int) -> Array | None:
    """Combinations (s, r) of a basis for equilibrium to be kept, most needed first; None where all of it stays.

    states (s, k): displacements over the root of the energy of their joints; tolerance: of the root of that energy that
    none may lose; learnt: how many of them were evaluated in the basis and not trained on. Fewer than three for two
    combinations that they need are too few to tell what others need.
    """
    if not learnt:
        return None
    rotation, _, _ = np.linalg.svd(states, full_matrices=False)
    count = needed(rotation.T @ states, tolerance**2)
    return rotation[:, :count] if ENOUGH * count <= learnt else None
