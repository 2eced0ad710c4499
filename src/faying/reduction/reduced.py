"""A structure in two small bases, one for equilibrium and one for vibration: any law and preload in milliseconds.

`reduce` makes it from a structure; it has no matrix of the structure's size and can be sent to other processes.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from faying.errors import InputError, NotConverged
from faying.joint.equilibrium import Equilibrium, PreloadState, Step, StickSlip
from faying.joint.joint_law import JointLaw
from faying.joint.springs import Springs
from faying.numerics.damped import lowest_complex
from faying.reduction.part_shares import ReducedShares, Scales
from faying.typing import Array, Complex

_SINGLE = ("static_stiffness", "static_loads", "dynamic_stiffness", "dynamic_mass", "count", "coarse")
_OF_JOINTS = ("weights", "gaps", "static_relative", "dynamic_relative")
OPENS = "preload: the joint opens fully on the way; load it in smaller steps"
BALANCED = 1e-7  # imbalance at which a frequency is right to a tenth of that
# square of what a mode takes up of those beyond the border, where first order holds: with one that is close it has no
# bound, and the small problem then has a mode that is none and may lie below all others
ACROSS = 0.1
BLOCK = 36  # real modes beyond those wanted that meet them exactly under the loss
REUSE_BELOW = 0.4  # of the force out of balance: a tangent that leaves less serves once more
EVEN = 2  # times that joints of one pressure each are solved: the pressure is that of the last
MIN_CLOSED_SHARE = 0.95  # of the points: where fewer have springs, the others are left out
SLIGHT = 1e-6  # relative error of an eigenvalue up to which first order is enough for the higher modes


def joint_stiffness(relative: Array, springs: Array) -> Array:
    """Stiffness (m, m) of springs (q, 3) [N/m], normal and both tangential, on a relative motion (3q, m).

    Springs and losses are never negative: half the work through their roots. A motion in single precision gives as many
    digits.
    """
    closed = np.flatnonzero(springs.any(axis=1))
    if len(closed) < MIN_CLOSED_SHARE * len(springs):
        # one copy, by rows of three, takes less than what it saves
        rooted = relative.reshape(len(springs), -1).take(closed, axis=0).reshape(-1, relative.shape[1])
        rooted *= np.sqrt(springs[closed]).astype(relative.dtype).reshape(-1, 1)
    else:
        rooted = np.sqrt(springs).astype(relative.dtype).reshape(-1, 1) * relative
    return np.asarray((rooted.T @ rooted).astype(float))  # NumPy sees that both are one, and does half of it


@dataclass(frozen=True, kw_only=True)
class ReducedMotion:
    """Relative motion at the points of a joint from coefficients of a basis: relative (3q, m), dense."""

    weights: Array
    gap: Array
    relative: Array

    @cached_property
    def single(self) -> Any:
        """The relative motion in single precision: enough for the tangents of an equilibrium."""
        return self.relative.astype(np.float32)

    def springs(self, k_n: Array, k_t: Array) -> Array:
        """Stiffness (m, m) [N/m] of springs per area k_n, k_t [Pa/m] (q,)."""
        return joint_stiffness(self.relative, self.weights[:, None] * np.stack([k_n, k_t, k_t], axis=1))


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


def _complex_modes(real: Array, loss: Array, count: int, slight: float) -> tuple[Complex, Complex]:
    """Lowest complex eigenvalues (m,) and vectors (d, m) of diag(real) + i loss, in rising order.

    The lowest real modes, some more than are wanted, meet each other exactly; those above them join by what the loss
    makes of them to first order. What that leaves is estimated. Where it is not slight, or modes on both sides of the
    border are close, the whole problem is solved.
    """
    from scipy.linalg import eig

    low = min(count + BLOCK, len(real))
    apart = real[:low, None] - real[None, low:]
    with np.errstate(divide="ignore", invalid="ignore"):
        mix = 1j * loss[:low, low:] / apart
        # second-order shift of an eigenvalue, times the square of the greatest loss factor: what first order leaves
        left = np.sum(np.abs(mix * mix * apart), axis=1) / real[:low] * np.max(np.abs(np.diag(loss)) / real) ** 2
    across = np.sum(np.abs(mix) ** 2, axis=1).max(initial=0.0)
    if low == len(real) or not (left[:count].max() < slight and across < ACROSS):
        values, vectors = eig(np.diag(real) + 1j * loss)
    else:
        span = np.concatenate([np.eye(low), mix], axis=1).T
        small = span.T @ (real[:, None] * span + 1j * (loss @ span))
        values, inner = eig(np.linalg.solve(span.T @ span, small))  # the matrix on the left is close to one
        vectors = span @ inner
        vectors = vectors / np.linalg.norm(vectors, axis=0)
    order = lowest_complex(values.real, count)
    return values[order], vectors[:, order]


def evenly_pressed(stiffness: Array, joints: Sequence[tuple[ReducedMotion, JointLaw]], load: Array) -> Array:
    """Displacement under springs that are tangent to p(approach) at one pressure in each joint: what they then carry.

    Raises NotConverged where nothing but slack springs holds the parts.
    """
    from scipy.linalg import LinAlgError, cho_factor, cho_solve

    ends = [(10 * law.least_pressure, 0.5 * law.model.greatest_pressure) for _, law in joints]
    means = [
        float(np.clip(10 * np.sqrt(law.least_pressure * law.model.greatest_pressure), *end))
        for (_, law), end in zip(joints, ends, strict=True)
    ]
    u = np.zeros(len(load))
    for _ in range(EVEN):
        push, tangent, laid = load, stiffness, []
        for (motion, law), mean in zip(joints, means, strict=True):
            k_n, k_t = (float(k) for k in law.stiffness(np.asarray(mean)))
            tangent = tangent + joint_stiffness(motion.relative, motion.weights[:, None] * np.array([k_n, k_t, k_t]))
            laid.append((k_n, mean - k_n * (float(law.approach(mean)) + motion.gap)))
            push = push + motion.relative[::3].T @ (laid[-1][1] * motion.weights)
        try:
            u = np.asarray(cho_solve(cho_factor(tangent), push))
        except LinAlgError:
            raise NotConverged(OPENS) from None
        for i, ((motion, _), (k_n, offset)) in enumerate(zip(joints, laid, strict=True)):
            carried = np.maximum(offset - k_n * (motion.relative[::3] @ u), 0.0)
            means[i] = float(np.clip(motion.weights @ carried / motion.weights.sum(), *ends[i]))
    return u


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
                matrix += joint_stiffness(interface.single, np.stack([k_n, k_t[:, 0, 0], k_t[:, 1, 1]], axis=1))
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
            raise NotConverged(OPENS) from None
        return np.asarray(cho_solve(self._tangent, force)), 0


@dataclass(frozen=True, kw_only=True)
class ReducedModel:
    """The two bases, projected.

    weights [m2], gaps [m]: (q,) of each joint; static_*: stiffness (s, s), loads (s, bolts) of 1 N each, relative
    motion at the points of each joint (3q, s); dynamic_*: stiffness, mass (d, d), relative motion (3q, d); count: modes
    that are given; coarse: how many leading vectors of the dynamic basis make the coarser one of the estimate; shares:
    of the parts that may be scaled; scales: of those parts, all 1 where None.
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

    def _motions(self, relative: Sequence[Array]) -> list[ReducedMotion]:
        """The joints in the basis of their relative motion."""
        found = zip(self.weights, self.gaps, relative, strict=True)
        return [ReducedMotion(weights=w, gap=gap, relative=motion) for w, gap, motion in found]

    def equilibrium(
        self, laws: Sequence[JointLaw], forces: Array, friction: Sequence[float | None], start: Array | None = None
    ) -> PreloadState:
        """Equilibrium in the basis under bolt forces [N] (b,).

        start: coefficients found before, maybe in fewer vectors.
        """
        load, joints = self.static_loads @ forces, list(zip(self._motions(self.static_relative), laws, strict=True))
        if start is not None:
            with suppress(NotConverged):  # not near enough
                balance = ReducedEquilibrium(self.matrices[0], joints, friction=friction)
                return balance.solve(load, start=np.pad(start, (0, len(load) - len(start))), tolerance=BALANCED)
        return ReducedEquilibrium(self.matrices[0], joints, friction=friction).solve(load, tolerance=BALANCED)

    def springs(self, laws: Sequence[JointLaw], pressures: Sequence[Array]) -> list[Springs[ReducedMotion]]:
        """Springs of all joints under pressures [Pa], one array for each joint."""
        motions = self._motions(self.dynamic_relative)
        return [law.springs(motion, p) for motion, law, p in zip(motions, laws, pressures, strict=True)]

    def modes(
        self, springs: Sequence[Springs[ReducedMotion]], slight: float = SLIGHT
    ) -> tuple[Complex, Complex, Array]:
        """Complex eigenvalues w^2 (1 + i eta) [1/s2] (m,), coefficients (d, m), the estimate (m,).

        slight: relative error of an eigenvalue up to which first order is enough for the higher modes.
        """
        from scipy.linalg import eigh

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

    def evaluate(
        self, laws: Sequence[JointLaw], forces: Array, friction: Sequence[float | None], start: Array | None = None
    ) -> Variant:
        """Evaluate one variant.

        Args:
            laws: The law of each joint.
            forces: Force of each bolt [N] (b,).
            friction: Coefficient of each joint [-], None where it sticks.
            start: `preload.displacement` of a like variant, from which the equilibrium is sought first.

        Raises:
            InputError: The forces fit no bolt, or are all zero.
            NotConverged: No equilibrium is found.
        """
        if np.shape(forces) != (self.static_loads.shape[1],):
            raise InputError(f"{np.size(forces)} bolt forces for {self.static_loads.shape[1]} bolts; give one for each")
        found = self.equilibrium(laws, np.asarray(forces, dtype=float), friction, start)
        values, shapes, estimate = self.modes(self.springs(laws, found.pressures))
        return Variant(
            shapes=shapes,
            frequencies=np.sqrt(values.real) / (2 * np.pi),
            loss_factors=values.imag / values.real,
            estimate=estimate,
            preload=found,
        )
