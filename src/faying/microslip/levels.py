"""Frequency and damping of modes at levels of acceleration: a mode is marched through one cycle of slip.

The mode at rest moves the sliders of every joint to and fro. What they dissipate is the damping, and the first harmonic
of their traction gives secant stiffnesses, under which the mode is found again, until frequency and damping settle.
The mean opening, the lag and the harmonics up to the third are corrected once in a pass. Where that does not settle, at
edges of joints that open and close, harmonic balance solves them all together, at ten times the cost.

The basis holds the modes at rest, and what their slipping cycles ask for. A cycle of a mode that slips leaves forces in
the full equations. The motion under them, of a joint that sticks, is the flexibility that the modes at rest lack. One
round of it leaves 0.3 % of the damping, where the modes at rest alone miss 43 % (two blocks, friction 0.03, 100 m/s2).
Rounds end where what is left is small. The basis depends on the state alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from faying.joint.bolted import BoltedStructure
from faying.joint.equilibrium import PreloadState
from faying.joint.modal import Vibration
from faying.microslip.epmc import Epmc, EpmcPoint
from faying.microslip.microslip import Microslip
from faying.microslip.slip_basis import GOOD, unbalanced_forces
from faying.microslip.slip_model import SlipModel, slip_joints
from faying.numerics.follow import same_group
from faying.numerics.shifted import Shifted
from faying.numerics.solve import conjugate_gradients
from faying.numerics.span import Span
from faying.typing import Array

PASSES = 40
HALF = 0.5  # of a change of secants under which the mode would soften too much, and of the first change of the lag
# share of a change of secants and lag from the third pass on, by Aitken's rule: undamped, the two drive each other away
# from the answer where most of a joint slides, and damped by a half alone they take twice as many passes
SHARES = 0.25, 1.0
# relative change of the squared frequency, and a tenth of that of the damping, that ends the passes: what is left then
# is as much, and 1e-4 of a damping is below its last printed digit
TOLERANCE = 3e-5
HARMONICS = 3  # highest of the motion that follows the first one
# error of the damping over the root of the relative change of the squared frequency: a shape changes by that root, of
# which the basis misses a part; covers the difference to harmonic balance on blocks, plates and a beam
ERROR_OF_SHAPE = 0.2
# of the damping, over the motion that a harmonic near a mode would have, were it not left out, over that of the first
# one: an energy of this size comes and goes (beam whose mode 5 has twice the frequency of mode 3)
ERROR_OF_NEAR_MODE = 4.0
# of the damping, over the damping ratio: what slides far lags behind, and the basis lacks more of it (twenty random
# blocks up to where all slides: the balance had 0.06 for 0.22)
ERROR_OF_LAG = 12.0
MET = 0.1  # of its square: how near the speed of a harmonic may come to that of a mode
SLIGHT = 1e-5  # relative change of the squared frequency that needs no second pass
MIN_MOTION = 1e-3  # of the greatest motion of a joint's points: what moves less keeps its stiffness at rest
SAMPLES = 32  # instants of a cycle
SPRINGS = 32  # into which a law is cut at each point
# of the squared frequency that is left after a pass, at least: a level gives the acceleration, so that a joint which
# softens moves more; fewer stiffnesses are changed at a time until the mode keeps that much
MIN_LEFT = 0.25
MIN_SQUARED = 0.01  # of the squared frequency at rest, below which the joints do not hold the mode: it has no answer
NO_DAMPING = 1e-7  # ratio: what changes by a share of it has settled
MAX_DAMPING = 1.0  # a mode that is damped by as much does not vibrate: it has no answer
MAX_OTHER_ENERGY = 10.0  # of the first harmonic, in what corrects it: more of it is no cycle of this mode
BALANCE = 1e-5  # residual over the elastic forces of a mode, and twice the error of its damping ratio
BALANCE_STEPS = 12  # of Newton: what has an answer takes 5 to 10
BALANCE_SHORTEST = 1 / 4  # of its step of 1.5: it ends within a tenth of the last level with an answer
MIN_SHARE = 1 / 64  # of a change of the secant stiffnesses, below which the passes have no answer at a level
UNSETTLED = 10 * TOLERANCE  # change of the damping in the last pass above which harmonic balance takes over
MOST_DOWN = 8  # halves of a level that has not settled, of which one has to settle for a balance to begin with


@dataclass(frozen=True, kw_only=True)
class AtLevels:
    """Frequency and damping by slip of modes (m,) at levels (l,).

    Args:
        frequencies: [Hz] (l, m).
        damping: ratio of slip [-] (l, m).
        error: of the damping, over it [-] (l, m): its change in the last pass, what the basis may miss of a shape, what
            a mode near twice or three times the frequency may add, and the lag; at most 1.

    NaN where a mode has no answer at a level: its joints would slide without end.
    """

    frequencies: Array
    damping: Array
    error: Array


@dataclass(frozen=True, kw_only=True)
class LevelCycle:
    """The cycle of one mode at one level.

    Args:
        level: greatest acceleration of a node [m/s2].
        frequency: [Hz]; NaN, as damping and error, where there is no answer.
        damping: ratio of slip [-].
        error: of the damping, over it [-].
        change: of the damping in the last pass, over it [-]: a part of the error; none of a balance.
        motion: Fourier coefficients of the coordinates (1 + 2H, m) [m].
        traction: those of the tractions of each joint (1 + 2H, q, 3) [Pa] under that motion.
        at_rest: whether its joints soften so little that it keeps its motion at rest.
    """

    level: float
    frequency: float
    damping: float
    error: float
    change: float
    motion: Array
    traction: tuple[Array, ...]
    at_rest: bool

    @property
    def converged(self) -> bool:
        """Whether there is an answer, which passes no longer change."""
        return bool(np.isfinite(self.frequency)) and self.change < UNSETTLED


@dataclass(frozen=True, kw_only=True)
class LevelModel:
    """A structure with joints that slip, in a basis.

    Args:
        slip: the parts in the basis (m,) and the joints in it.
        vectors: the basis at the nodes (unknowns, m).
        rigid: how many of its lowest modes are rigid motions.
    """

    slip: SlipModel
    vectors: Array
    rigid: int

    @cached_property
    def modes(self) -> tuple[Array, Array]:
        """Angular frequencies [rad/s] (m,) at rest, rising, and mass-normalised shapes (m, m).

        The basis begins with the modes at rest: of twins, whose plane has no directions of its own, they say which.
        """
        speeds, shapes = self.slip.modes
        shapes = shapes.copy()
        for group in np.unique(same_group(speeds), axis=0):
            u, _, v = np.linalg.svd(shapes[:, group].T @ self.slip.mass[:, group])
            shapes[:, group] = shapes[:, group] @ (u @ v)
        return speeds, shapes

    def at(self, levels: Sequence[float], count: int) -> AtLevels:
        """The lowest elastic modes, so many, at each level: acceleration [m/s2] of the point that moves most."""
        found = [[(level, self.up_to(level, k)) for k in range(count)] for level in levels]
        frequency, damping, error = (
            np.array([[getattr(one, name) if one.level == level else np.nan for level, one in row] for row in found])
            for name in ("frequency", "damping", "error")
        )
        return AtLevels(frequencies=frequency, damping=damping, error=error)

    def up_to(self, level: float, number: int) -> LevelCycle:
        """One elastic mode, counted from 0, at the greatest level with an answer up to the one given [m/s2].

        Of passes that settle, harmonic balance and passes that do not settle, in this order, the one that goes
        farthest; without frequency where there is none.
        """
        tried = [self.passes(level, number)]
        while not tried[-1].converged and len(tried) <= MOST_DOWN:
            tried.append(self.passes(level * HALF ** len(tried), number))
        if tried[0].converged:
            return tried[0]
        found = [self.balanced(tried[-1], level, number)] if tried[-1].converged else []
        found += [one for one in tried if np.isfinite(one.frequency)]
        return max(found, key=lambda one: one.level, default=tried[0])

    def passes(self, level: float, number: int) -> LevelCycle:
        """One elastic mode at one level, as far as the passes lead."""
        speeds, shapes = self.modes
        number += self.rigid
        speed, shape = float(speeds[number]), shapes[:, number]
        rest, damping, change, softened = shape, 0.0, 0.0, (speeds, shapes)
        motion = np.zeros((1 + 2 * HARMONICS, len(shape)))
        secants = [np.zeros_like(joint.at_rest[1]) for joint in self.slip.joints]
        near, share = 0.0, 1.0
        missed: Array | None = None
        for done in range(PASSES):
            amplitude = level / speed**2 / self._greatest(shape)
            motion[1] = amplitude * shape
            marched, forces = motion.copy(), self.slip.forces(motion, derivative=False, samples=SAMPLES)
            cycles = forces.cycles
            lost = sum(float(j.weights @ c.dissipated) for j, c in zip(self.slip.joints, cycles, strict=True))
            before, damping = damping, max(lost, 0.0) / (2 * np.pi * speed**2 * amplitude**2)
            change = abs(damping - before) / max(damping, NO_DAMPING)
            wanted, squared = self._secants(motion, cycles), speed**2
            # change of the squared frequency, to first order
            softer = sum(j.work(c, motion[1]) for j, c in zip(self.slip.joints, wanted, strict=True)) / amplitude**2
            at_rest = done == 0 and abs(softer) < SLIGHT * squared
            if at_rest:
                speed, change = float(np.sqrt(squared + softer)), abs(softer) / squared
                break
            before_missed, missed = missed, _diagonals(wanted) - _diagonals(secants)
            if before_missed is not None:
                share = _aitken(share, before_missed, missed)
            lag_share = HALF if before_missed is None else share
            near = self._follow(motion, forces.force, speed, softened, lag_share) / amplitude
            least = max(MIN_LEFT * squared, MIN_SQUARED * float(speeds[number]) ** 2)
            found = self._towards(wanted, secants, rest, least=least, share=share)
            if found is None or damping > MAX_DAMPING or not self._mostly_first(motion):
                speed = damping = change = np.nan
                break
            secants, softened, like = found
            speed, shape = float(softened[0][like]), softened[1][:, like]
            if abs(speed**2 - squared) < TOLERANCE * squared and change < UNSETTLED:
                break
        error = change + self._shape_error(speed, number) + ERROR_OF_NEAR_MODE * near + ERROR_OF_LAG * damping
        return LevelCycle(
            level=level,
            frequency=speed / (2 * np.pi),
            damping=damping,
            error=min(error, 1.0) if np.isfinite(speed) else np.nan,
            change=change,
            motion=marched,
            traction=tuple(cycle.traction for cycle in cycles),
            at_rest=at_rest,
        )

    def _shape_error(self, speed: float, number: int) -> float:
        """What the basis may miss of a damping, over it, where the joints have moved a mode to an angular frequency."""
        return ERROR_OF_SHAPE * float(np.sqrt(abs(1 - (speed / float(self.modes[0][number])) ** 2)))

    def balanced(self, start: LevelCycle, level: float, number: int) -> LevelCycle:
        """Follow a mode from an answer to a greater level by harmonic balance, as far as it gets."""
        epmc = Epmc(
            model=self.slip,
            mode=self.rigid + number,
            harmonics=HARMONICS,
            samples=SAMPLES,
            observer=self.vectors.reshape(-1, 3, self.vectors.shape[1]),
            tolerance=BALANCE,
            newton_steps=BALANCE_STEPS,
            shortest=BALANCE_SHORTEST,
        )
        first = EpmcPoint(
            amplitude=float(np.linalg.norm(start.motion[1:3])),
            frequency=2 * np.pi * start.frequency,
            damping=start.damping,
            coordinates=start.motion,
            level=start.level,
        )
        curve = epmc.follow(start.level, level, known=[first])
        if len(curve.points) == 1:
            return start
        last = curve.points[-1]
        left = BALANCE / max(2 * last.damping, BALANCE) + ERROR_OF_LAG * last.damping
        return LevelCycle(
            level=level if curve.code == "amplitude" else last.level,
            frequency=last.frequency / (2 * np.pi),
            damping=last.damping,
            error=min(left + self._shape_error(last.frequency, self.rigid + number), 1.0),
            change=0.0,
            motion=last.coordinates,
            traction=last.traction,
            at_rest=False,
        )

    def _towards(
        self, wanted: Sequence[Array], last: Sequence[Array], rest: Array, *, least: float, share: float
    ) -> tuple[list[Array], tuple[Array, Array], int] | None:
        """Change secant stiffnesses by a share of what is wanted, or by less where the mode would soften too much.

        Args:
            wanted, last: `_secants` of this pass, and those under which the mode was marched.
            rest: shape (m,) of the mode at rest.
            least: squared circular frequency [rad2/s2] that must be left.
            share: of the change [-], to begin with.

        Returns:
            The secants, circular frequencies and shapes under them, and the number of the mode that is most like
            `rest`; None where no share that counts leaves the mode a frequency.
        """
        while share >= MIN_SHARE:
            secants = [(1 - share) * old + share * new for old, new in zip(last, wanted, strict=True)]
            changed = sum(j.projected(c) for j, c in zip(self.slip.joints, secants, strict=True))
            softened = self.slip.modes_under(self.slip.linear + changed)
            like = int(np.argmax(np.abs(softened[1].T @ self.slip.mass @ rest)))
            if softened[0][like] ** 2 > least:
                return secants, softened, like
            share *= HALF
        return None

    def _follow(self, motion: Array, force: Array, speed: float, softened: tuple[Array, Array], share: float) -> float:
        """Correct a motion in place by what it leaves of its equations: mean, lag and higher harmonics.

        What drives the mode against its damping moves the mode alone, which the correction leaves out.

        Args:
            motion, force: of the cycle (1 + 2H, m) [m], [N]; the cosine of the first harmonic stays.
            speed: circular frequency of the mode [rad/s].
            softened: circular frequencies [rad/s] (m,) and shapes (m, m) under the secants, in which the lag is found.
            share: of the correction of the lag [-].

        Returns:
            The greatest motion of a mode [m] that a harmonic near it would have: such modes are left out.
        """
        near = 0.0
        for harmonic in range(HARMONICS + 1):
            driven = (harmonic * speed) ** 2
            rows = [0] if harmonic == 0 else [2] if harmonic == 1 else [2 * harmonic - 1, 2 * harmonic]
            left = force[rows] - driven * motion[rows] @ self.slip.mass
            speeds, shapes = (one[..., self.rigid :] for one in (softened if harmonic == 1 else self.modes))
            stiff = speeds**2 - driven
            # a mode whose own speed is near that of the harmonic is left out
            flexible = np.where(np.abs(stiff) > MET * driven, 1 / np.where(stiff == 0, 1.0, stiff), 0.0)
            motion[rows] -= (share if harmonic == 1 else 1.0) * (left @ shapes * flexible) @ shapes.T
            if harmonic > 1:
                stiff = np.abs(softened[0][self.rigid :] ** 2 - driven)
                moved = np.linalg.norm(left @ softened[1][:, self.rigid :], axis=0) / np.maximum(stiff, 1e-9 * driven)
                near = max(near, float(moved[stiff <= MET * driven].max(initial=0.0)))
        return near

    def _mostly_first(self, motion: Array) -> bool:
        """Whether no mean, lag or harmonic of a motion (1 + 2H, m) stores far more than the first harmonic."""
        energy = np.einsum("ij,jk,ik->i", motion, self.slip.linear, motion)
        return bool(energy.max() <= MAX_OTHER_ENERGY * energy[1])

    def _greatest(self, shape: Array) -> float:
        """The greatest displacement of a node in a shape (m,)."""
        return float(np.linalg.norm((self.vectors @ shape).reshape(-1, 3), axis=1).max())

    def _secants(self, motion: Array, cycles: Sequence[Any]) -> list[Array]:
        """What secant stiffnesses at the points of each joint (q, 3, 3) change of those at rest [Pa/m]."""
        out = []
        for joint, cycle in zip(self.slip.joints, cycles, strict=True):
            u, t = joint.motion(motion)[1], cycle.traction[1]
            rest = joint.at_rest[1]
            change = np.zeros_like(rest)
            size = float(np.linalg.norm(u, axis=1).max())
            for axes in ([0], [1, 2]):
                square = np.einsum("qi,qi->q", u[:, axes], u[:, axes])
                moves = square > (MIN_MOTION * size) ** 2
                k = np.einsum("qi,qi->q", t[:, axes], u[:, axes])[moves] / square[moves]
                for axis in axes:
                    change[moves, axis, axis] = k - rest[moves, axis, axis]
            out.append(change)
        return out


def _diagonals(secants: Sequence[Array]) -> Array:
    """The changes of stiffness at all points of all joints, which are diagonal (q, 3, 3), in one row."""
    return np.concatenate([np.einsum("qii->qi", one).ravel() for one in secants])


def _aitken(share: float, before: Array, now: Array) -> float:
    """Share of the next change, from the last one and from what was wanted before and after it (n,).

    Source: Aitken's relaxation, Kuettler and Wall 2008, doi:10.1007/s00466-008-0255-5, equation 43.
    """
    change = now - before
    square = float(change @ change)
    return float(np.clip(-share * float(before @ change) / square, *SHARES)) if square > 0 else share


def cut_laws(
    structure: BoltedStructure, preload: PreloadState, friction: Sequence[float], springs: int
) -> list[Microslip]:
    """The law of each joint under a preload, cut into so many springs with sliders; friction: coefficient of each.

    Raises InputError as `Microslip.cut`.
    """
    return [
        Microslip.cut(joint.law, -opening, friction=mu, springs=springs, gap=joint.interface.gap)
        for joint, opening, mu in zip(structure.joints, preload.openings, friction, strict=True)
    ]


def level_model(
    structure: BoltedStructure, preload: PreloadState, basis: Span, laws: Sequence[Microslip]
) -> LevelModel:
    """A structure under its preload in a basis, ready to be marched.

    Args:
        structure: without springs per node on its joints.
        preload: its equilibrium under the bolts.
        basis: orthonormal with the mass, with the stiffness of the parts projected on it; rigid motions first.
        laws: of each joint under that preload.
    """
    interfaces, vectors = [joint.interface for joint in structure.joints], basis.vectors
    relatives = [np.asarray(interface.relative @ vectors) for interface in interfaces]
    joints = slip_joints(interfaces, preload.displacement, laws, relatives)
    slip = SlipModel(stiffness=basis.small, mass=np.eye(vectors.shape[1]), joints=joints)
    return LevelModel(slip=slip, vectors=vectors, rigid=structure.rigid_count)


ROUNDS = 6  # of enrichment with one set of laws: a column on one bolt of which a third slides takes five
ROWS = 3  # of a cycle: its mean and its first harmonic, which damping depends on to first order
ACCURACY = 1e-3  # of the motion under what is left: below the share of it that is left out
SMALL = 1e-3  # of the motion, in energy: motions below it change a damping by less than a thousandth
MIN_NEW_SHARE = 1e-6  # of the square of a motion that must be new: what is less is left of the solution


def level_basis(
    structure: BoltedStructure,
    preload: PreloadState,
    found: Vibration,
    laws: Sequence[Sequence[Microslip]],
    levels: Array,
) -> Span:
    """Make the basis of the lowest elastic modes.

    Args:
        structure: without springs per node on its joints.
        preload: its equilibrium under the bolts.
        found: its modes at rest, at least one elastic one for each of `levels` to full accuracy.
        laws: of the joints, one set after another that the basis is made for, the least friction first. It slips most:
            the next set is for modes that have no answer at their level under it.
        levels: acceleration [m/s2] of each elastic mode from the lowest on (m,), the greatest that is looked at; 0 for
            a mode that is not looked at.

    Returns:
        Vectors orthonormal with the mass, rigid motions first, and the stiffness of the parts projected on them.
    """
    stiffness, mass = structure.dynamic_matrices
    basis = Span(mass, stiffness, found.modes.shapes[:, : structure.rigid_count + len(levels)])
    at_rest = Shifted(stiffness=found.stiffness, mass=mass, shift=found.modes.shift)
    left = [k for k, level in enumerate(levels) if level > 0]
    for own in laws:
        wanted = left
        for number in range(ROUNDS):
            model = level_model(structure, preload, basis, own)
            every = {k: model.up_to(levels[k], k) for k in wanted}
            answered = {k: one for k, one in every.items() if np.isfinite(one.frequency)}
            if number == 0:
                left = [k for k in every if k not in answered or every[k].level < levels[k]]
            # the basis has the modes at rest
            cycles = {k: one for k, one in answered.items() if not one.at_rest}
            if not cycles:
                break
            forces = np.concatenate([_left(structure, model, cycle) for cycle in cycles.values()], axis=1)
            moved = conjugate_gradients(
                at_rest.__matmul__, found.modes.factorisation, forces, accuracy=ACCURACY, least=(SMALL / 2) ** 2
            )
            size = np.sqrt(np.maximum(np.einsum("ij,ij->j", forces, moved), 0.0))
            worst = size.reshape(-1, ROWS).max(axis=1)
            wanted = [k for k, one in zip(cycles, worst, strict=True) if one > GOOD]
            if not wanted or not basis.add(moved[:, size > SMALL], least=MIN_NEW_SHARE):
                break
    return basis


def _left(structure: BoltedStructure, model: LevelModel, cycle: LevelCycle) -> Array:
    """What a cycle leaves in the full equations, (unknowns, ROWS), over the root of twice the energy of its motion."""
    motion = cycle.motion[:ROWS]
    left = unbalanced_forces(
        structure,
        model.vectors,
        model.slip.joints,
        motion=motion,
        traction=[traction[:ROWS] for traction in cycle.traction],
        speed=2 * np.pi * cycle.frequency,
        damping=cycle.damping,
    )
    return np.asarray(left / np.sqrt(motion[1] @ model.slip.linear @ motion[1]))
