"""A structure in two small bases, one for equilibrium and one for vibration: any law and preload in milliseconds.

`reduce` makes it from a structure; it has no matrix of the structure's size and can be sent to other processes.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from faying.errors import InputError, NotConverged
from faying.joint.equilibrium import Equilibrium, PreloadState, Step, StickSlip
from faying.joint.joint_law import JointLaw
from faying.joint.springs import Springs
from faying.numerics.damped import lowest_complex
from faying.reduction.groups import Groups, joint_stiffness, per_point
from faying.reduction.part_shares import ReducedShares, Scales
from faying.reduction.secant import Secants, evenly_pressed
from faying.typing import Array, Complex

_SINGLE = ("static_stiffness", "static_loads", "dynamic_stiffness", "dynamic_mass", "count", "coarse")
_OF_JOINTS = ("weights", "gaps", "static_relative", "dynamic_relative")
BALANCED = 1e-8  # imbalance at which the pressure is right to far more digits than a sweep gives
BLOCK = 36  # real modes beyond those wanted that meet them exactly under the loss
SPAN = 10  # modes in seven digits beyond those wanted, with which they span what the modes are sought in
REUSE_BELOW = 0.1  # of the force out of balance: a tangent that leaves less serves once more
SECANTS = 1e-7  # imbalance to which secants lead: frequencies are right to a tenth of that
GROUP_TOLERANCE = 1e-2  # imbalance of the groups at which all points go on
GROUPED_FROM = 400  # points of a joint from which groups pay
SLIGHT = 1e-6  # relative error of an eigenvalue up to which first order is enough for the higher modes


@dataclass(frozen=True, kw_only=True)
class ReducedMotion:
    """Relative motion at the points of a joint from coefficients of a basis: relative (3q, m), dense.

    groups: of the points, which then stand for them in tangents; light: the motion that tangents take, the exact one
    where None.
    """

    weights: Array
    gap: Array
    relative: Array
    groups: Groups | None = None
    light: Any = None

    @property
    def coarse(self) -> "ReducedMotion":
        """The groups as points; itself where there are none."""
        groups = self.groups
        if groups is None:
            return self
        return ReducedMotion(
            weights=groups.weights, gap=groups.mean(self.gap), relative=groups.relative, light=groups.light_mean
        )

    @property
    def quick(self) -> Any:
        """The motion that tangents and small changes take: seven digits where they are known."""
        light = self.light if self.groups is None else self.groups.light
        return self.relative if light is None else light

    def springs(self, k_n: Array, k_t: Array) -> Array:
        """Stiffness (m, m) [N/m] of springs per area k_n, k_t [Pa/m] (q,)."""
        return joint_stiffness(self.relative, per_point(self.weights, k_n, k_t))


@dataclass(frozen=True, kw_only=True)
class Variant:
    """One law and preload, evaluated in the bases.

    frequencies [Hz], loss_factors [-] (m,), elastic modes; estimate (m,): what the frequencies change by, relatively,
    when the last part of the basis is left out; preload: the equilibrium, with coefficients in place of displacements;
    its `displacement` is what a like variant may start from; shapes (d, m): the modes in the basis for vibration,
    complex where there is loss.
    """

    frequencies: Array
    loss_factors: Array
    estimate: Array
    preload: PreloadState
    shapes: Complex


def _complex_modes(real: Array, loss: Array, count: int, slight: float = SLIGHT) -> tuple[Complex, Complex]:
    """Lowest complex eigenvalues (m,) and vectors (d, m) of diag(real) + i loss, in rising order.

    The lowest real modes, some more than are wanted, meet each other exactly; those above them join by what the loss
    makes of them to first order. What that leaves is estimated, and where it is not slight the whole problem is solved.
    """
    from scipy.linalg import eig

    low = min(count + BLOCK, len(real))
    apart = real[:low, None] - real[None, low:]
    with np.errstate(divide="ignore", invalid="ignore"):
        mix = 1j * loss[:low, low:] / apart
        # second-order shift of an eigenvalue, times the square of the greatest loss factor: what first order leaves
        left = np.sum(np.abs(mix * mix * apart), axis=1) / real[:low] * np.max(np.abs(np.diag(loss)) / real) ** 2
    if low == len(real) or not left[:count].max() < slight:
        values, vectors = eig(np.diag(real) + 1j * loss)
    else:
        span = np.concatenate([np.eye(low), mix], axis=1).T
        small = span.T @ (real[:, None] * span + 1j * (loss @ span))
        values, inner = eig(np.linalg.solve(span.T @ span, small))  # the matrix on the left is close to one
        vectors = span @ inner
        vectors = vectors / np.linalg.norm(vectors, axis=0)
    order = lowest_complex(values.real, count)
    return values[order], vectors[:, order]


def _of_springs(springs: Springs["ReducedMotion"], moved: Any, k_n: Array, k_t: Array) -> Array:
    """Stiffness (m, m) of springs per area k_n, k_t [Pa/m] of a joint on the motion (3q, m) of its points."""
    return joint_stiffness(moved, per_point(springs.interface.weights, k_n, k_t))


class ReducedEquilibrium(Equilibrium):
    """Equilibrium in a basis: dense Newton, for one load."""

    _tangent: Any = None
    _size = 0.0  # of the last force out of balance [N]

    def _start(self, load: Array) -> Array:
        return evenly_pressed(self.stiffness, self.joints, load)

    def _direction(self, u: Array, force: Array, slip_states: Sequence[StickSlip], accuracy: float) -> Step:
        from scipy.linalg import LinAlgError, cho_factor, cho_solve

        size = float(np.linalg.norm(force))
        falls, self._size = size < REUSE_BELOW * self._size, size
        if falls and self._tangent is not None:  # near the end the last tangent does as well
            return np.asarray(cho_solve(self._tangent, force)), 0
        matrix = self.stiffness.copy()
        for interface, k_n, k_t in self._tangents(u, slip_states):
            if not k_t[:, 0, 1].any():  # nothing slides
                matrix += joint_stiffness(interface.quick, np.stack([k_n, k_t[:, 0, 0], k_t[:, 1, 1]], axis=1))
                continue
            local = interface.relative.reshape(len(k_n), 3, -1)
            scaled = np.empty_like(local)
            scaled[:, 0] = k_n[:, None] * local[:, 0]
            scaled[:, 1] = k_t[:, 0, 0, None] * local[:, 1] + k_t[:, 0, 1, None] * local[:, 2]
            scaled[:, 2] = k_t[:, 1, 0, None] * local[:, 1] + k_t[:, 1, 1, None] * local[:, 2]
            matrix += interface.relative.T @ scaled.reshape(interface.relative.shape)
        try:
            self._tangent = cho_factor(matrix)
        except LinAlgError:
            raise NotConverged("preload: the joint opens fully on the way; load it in smaller steps") from None
        return np.asarray(cho_solve(self._tangent, force)), 0


@dataclass(frozen=True, kw_only=True)
class ReducedModel:
    """The two bases, projected.

    weights [m2], gaps [m]: (q,) of each joint; static_*: stiffness (s, s), loads (s, bolts) of 1 N each, relative
    motion at the points of each joint (3q, s); dynamic_*: stiffness, mass (d, d), relative motion (3q, d); count: modes
    that are given; coarse: how many leading vectors of the dynamic basis make the coarser one of the estimate; shares:
    of the parts that may be scaled; scales: of those parts, all 1 where None; groups: of the points of each joint in
    both bases, None where points are few: `grouped`.
    """

    weights: Sequence[Array]
    gaps: Sequence[Array]
    static_stiffness: Array
    static_loads: Array
    static_relative: Sequence[Array]
    dynamic_stiffness: Array
    dynamic_mass: Array
    dynamic_relative: Sequence[Array]
    count: int
    coarse: int
    shares: ReducedShares | None = None
    scales: Scales | None = None
    groups: Sequence[tuple[Groups, Groups] | None] = ()

    def grouped(self) -> "ReducedModel":
        """The same model with the points of large joints in groups: it gives the same answers sooner."""
        found = [
            (Groups.of(w, static), Groups.of(w, dynamic)) if len(w) >= GROUPED_FROM else None
            for w, static, dynamic in zip(self.weights, self.static_relative, self.dynamic_relative, strict=True)
        ]
        return replace(self, groups=found)

    def arrays(self) -> dict[str, Array]:
        """All of it by name, to be kept in a file; `from_arrays` gives it back, without scales."""
        out = {name: np.asarray(getattr(self, name)) for name in _SINGLE}
        for i in range(len(self.weights)):
            out |= {f"{name}_{i}": getattr(self, name)[i] for name in _OF_JOINTS}
        if self.shares is not None:
            out |= {f"shares_{f.name}": getattr(self.shares, f.name) for f in fields(self.shares)}
        return out

    @classmethod
    def from_arrays(cls, data: Mapping[str, Array]) -> "ReducedModel":
        """What `arrays` gave. Raises KeyError where something is missing."""
        joints = sum(name.startswith("weights_") for name in data)
        given: dict[str, Any] = {name: [data[f"{name}_{i}"] for i in range(joints)] for name in _OF_JOINTS}
        given |= {name: data[name] for name in _SINGLE}
        given |= {name: int(data[name]) for name in ("count", "coarse")}
        if "shares_mass" in data:
            given["shares"] = ReducedShares(**{f.name: data[f"shares_{f.name}"] for f in fields(ReducedShares)})
        return cls(**given)

    @cached_property
    def matrices(self) -> tuple[Array, Array, Array]:
        """Stiffness for equilibrium (s, s), stiffness and mass for vibration (d, d), parts scaled, joints left out."""
        plain = self.static_stiffness, self.dynamic_stiffness, self.dynamic_mass
        if self.scales is None:
            return plain
        assert self.shares is not None
        return self.shares.add(self.scales, *plain)

    def with_scales(self, scales: Scales | None) -> "ReducedModel":
        """The same structure with the stiffness and the mass of each part in `shares` scaled; as drawn where None."""
        return replace(self, scales=scales)

    def with_gaps(self, gaps: Sequence[Array] | None) -> "ReducedModel":
        """The same structure with other gaps [m] (q,) of its joints before any load; itself where None."""
        return self if gaps is None else replace(self, gaps=gaps)

    def _motions(self, relative: Sequence[Array], basis: int) -> list[ReducedMotion]:
        """The joints in the basis for equilibrium, 0, or vibration, 1."""
        groups = [None if pair is None else pair[basis] for pair in self.groups or [None] * len(self.weights)]
        found = zip(self.weights, self.gaps, relative, groups, strict=True)
        return [ReducedMotion(weights=w, gap=gap, relative=motion, groups=group) for w, gap, motion, group in found]

    def equilibrium(
        self,
        laws: Sequence[JointLaw],
        forces: Array,
        friction: Sequence[float | None],
        start: Array | None = None,
        tolerance: float = SECANTS,
    ) -> PreloadState:
        """Equilibrium in the basis under bolt forces [N] (b,).

        start: coefficients found before, maybe in fewer vectors; tolerance: imbalance that is left where points are
        grouped.
        """
        motions, load = self._motions(self.static_relative, 0), self.static_loads @ forces
        if start is not None:
            start = np.concatenate([start, np.zeros(len(load) - len(start))])
        if any(motion.groups is not None for motion in motions):
            joints = list(zip(motions, laws, strict=True))
            secants = Secants(stiffness=self.matrices[0], joints=joints, friction=friction)
            all_grouped = all(motion.groups is not None for motion in motions)
            try:
                near = secants.near(load, start, GROUP_TOLERANCE) if all_grouped else None
                if near is None:
                    groups = self._balance([motion.coarse for motion in motions], laws, friction)
                    near = groups.solve(load, start=start, tolerance=GROUP_TOLERANCE).displacement
                start = near
                found = secants.solve(load, start, tolerance) if all_grouped else None
                if found is not None:
                    return found
            except NotConverged:
                pass
        if start is not None:
            try:
                return self._balance(motions, laws, friction).solve(load, start=start, tolerance=BALANCED)
            except NotConverged:
                pass
        exact = [replace(motion, groups=None) for motion in motions]
        return self._balance(exact, laws, friction).solve(load, tolerance=BALANCED)

    def equilibrium_from(
        self, laws: Sequence[JointLaw], forces: Array, friction: Sequence[float | None], start: Array | None
    ) -> PreloadState:
        """`equilibrium` where the basis grows and groups would not pay: secants from a start, with seven digits."""
        if start is not None and min(map(len, self.weights)) >= GROUPED_FROM:
            motions, load = self._motions(self.static_relative, 0), self.static_loads @ forces
            light = [replace(m, groups=None, light=m.relative.astype(np.float32)) for m in motions]
            secants = Secants(stiffness=self.matrices[0], joints=list(zip(light, laws, strict=True)), friction=friction)
            found = secants.solve(load, np.concatenate([start, np.zeros(len(load) - len(start))]), SECANTS)
            if found is not None:
                return found
        return self.equilibrium(laws, forces, friction, start)

    def _balance(
        self, motions: Sequence[ReducedMotion], laws: Sequence[JointLaw], friction: Sequence[float | None]
    ) -> ReducedEquilibrium:
        return ReducedEquilibrium(self.matrices[0], list(zip(motions, laws, strict=True)), friction=friction)

    def springs(self, laws: Sequence[JointLaw], pressures: Sequence[Array]) -> list[Springs[ReducedMotion]]:
        """Springs of all joints under pressures [Pa], one array for each joint."""
        motions = self._motions(self.dynamic_relative, 1)
        return [law.springs(motion, p) for motion, law, p in zip(motions, laws, pressures, strict=True)]

    def modes(
        self, springs: Sequence[Springs[ReducedMotion]], slight: float = SLIGHT
    ) -> tuple[Complex, Complex, Array]:
        """Complex eigenvalues w^2 (1 + i eta) [1/s2] (m,), coefficients (d, m), the estimate (m,).

        slight: relative error of an eigenvalue up to which first order is enough for the higher modes.
        """
        from scipy.linalg import eigh

        if any(s.interface.groups is not None for s in springs):
            return self._spanned(springs)
        _, K, M = self.matrices
        K = K + sum(s.stiffness() for s in springs)
        real, shapes = eigh(K, M)
        cut = slice(0, self.coarse)
        rough = eigh(K[cut, cut], M[cut, cut], eigvals_only=True, subset_by_index=[0, self.count - 1])
        estimate = np.abs(rough / real[: self.count] - 1) / 2
        if not any(s.lossy for s in springs):
            return real[: self.count].astype(complex), shapes[:, : self.count].astype(complex), estimate
        loss = sum(s.loss() for s in springs)
        values, inner = _complex_modes(real, shapes.T @ loss @ shapes, self.count, slight)
        return values, shapes @ inner, estimate

    @cached_property
    def _normal(self) -> tuple[Array, Array]:
        """A transformation (d, d) that makes the mass the identity, and the parts' stiffness (d, d) under it."""
        from scipy.linalg import cholesky, solve_triangular

        _, K, M = self.matrices
        turn = solve_triangular(cholesky(M), np.eye(len(M)))
        return turn, turn.T @ K @ turn

    def _spanned(self, springs: Sequence[Springs[ReducedMotion]]) -> tuple[Complex, Complex, Array]:
        """`modes` in the span of those by groups' seven digits, which are kept but for the energy of the parts."""
        turn, K = self._normal
        lossy = any(s.lossy for s in springs)
        rough, wanted = K, min(self.count + (BLOCK if lossy else SPAN), len(K))
        seen = [s.interface.relative if s.interface.groups is None else s.interface.groups.light for s in springs]
        for s, motion in zip(springs, seen, strict=True):
            rough = rough + turn.T @ _of_springs(s, motion, s.k_n, s.k_t) @ turn
        near, shapes = (found[..., :wanted] for found in np.linalg.eigh(rough))  # sooner than a part of them
        # the leading vectors of the basis are those of the first columns of `turn`, which is triangular
        cut = slice(0, self.coarse)
        coarser = np.linalg.eigvalsh(rough[cut, cut])
        estimate = np.abs(coarser[: self.count] / near[: self.count] - 1) / 2
        small, loss = shapes.T @ K @ shapes, np.zeros((wanted, wanted))
        span = turn @ shapes
        for s, motion in zip(springs, seen, strict=True):
            moved = motion @ span.astype(motion.dtype)
            small = small + _of_springs(s, moved, s.k_n, s.k_t)
            if lossy:
                loss = loss + _of_springs(s, moved, s.k_n * s.loss_n, s.k_t * s.loss_t)
        real, inner = np.linalg.eigh(small)
        if not lossy:
            return real[: self.count].astype(complex), (span @ inner[:, : self.count]).astype(complex), estimate
        values, mixed = _complex_modes(real, inner.T @ loss @ inner, self.count)
        return values, span @ (inner @ mixed), estimate

    def evaluate(
        self,
        laws: Sequence[JointLaw],
        forces: Array,
        friction: Sequence[float | None],
        start: Array | None = None,
        tolerance: float = SECANTS,
    ) -> Variant:
        """Evaluate one variant.

        Args:
            laws: The law of each joint.
            forces: Force of each bolt [N] (b,).
            friction: Coefficient of each joint [-], None where it sticks.
            start: `preload.displacement` of a like variant, from which the equilibrium is sought first.
            tolerance: Imbalance [-] that is left where points are grouped.

        Raises:
            InputError: The forces fit no bolt, or are all zero.
            NotConverged: No equilibrium is found.
        """
        if np.shape(forces) != (self.static_loads.shape[1],):
            raise InputError(f"{np.size(forces)} bolt forces for {self.static_loads.shape[1]} bolts; give one for each")
        found = self.equilibrium(laws, np.asarray(forces, dtype=float), friction, start, tolerance)
        values, shapes, estimate = self.modes(self.springs(laws, found.pressures))
        return Variant(
            shapes=shapes,
            frequencies=np.sqrt(values.real) / (2 * np.pi),
            loss_factors=values.imag / values.real,
            estimate=estimate,
            preload=found,
        )
