"""Equilibrium in a basis by one tangent and secants: few products with all points of a joint, and no search."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from faying.errors import NotConverged
from faying.joint.equilibrium import PreloadState, StickSlip
from faying.joint.joint_law import JointLaw
from faying.reduction.groups import joint_stiffness, per_point
from faying.typing import Array

STEPS = 30  # after which Newton is asked
SLOW = 0.4  # of the imbalance, that a step leaves whose tangent is made anew
NEWTON = 8  # steps of the groups after which a line search is due
EVEN = 2  # times that joints of one pressure each are solved: the pressure is that of the last
GROWN = 10.0  # times the least imbalance found, from which Newton is asked
FAR_IMBALANCE = 0.2  # imbalance of a state whose tangent serves for one step
NO_START = 0.6  # imbalance of a start that is none
AGAIN, FALLEN = 0.05, 0.03  # imbalance of a start whose tangent is that of groups, and where the one of points is made
IN_FULL = 1e-3  # imbalance from which the balance is found in full once; what changes after that needs seven digits

_Answer = Callable[[Array], Array]  # what a tangent answers to a force


@dataclass(frozen=True, kw_only=True)
class _There:
    """Joints at one displacement.

    Relative motion (q, 3), opening, pressure, k_n, stick or slip, and tractions times area (3q,) of each.
    """

    moves: list[Array]
    openings: list[Array]
    pressures: list[Array]
    k_n: list[Array]
    slip_states: list[StickSlip]
    forces: list[Array]


@dataclass(frozen=True, kw_only=True)
class Secants:
    """Solves the equilibrium of one load without history: no joint has slipped before.

    Broyden's good method from one tangent. The force out of balance is found in seven digits from step to step, since
    it is that of a change which grows ever smaller, and in full once, near the end. Tangential stiffness and the limit
    of friction follow the pressure at once.

    Args:
        stiffness: of the parts in the basis (m, m).
        joints: motion at the points of each joint, with groups, and its law.
        friction: of each joint, None where it sticks.

    Source:
        Broyden 1965, doi:10.1090/S0025-5718-1965-0198670-6; Kelley 1995, doi:10.1137/1.9781611970944, section 7.3, for
        the form with few vectors.
    """

    stiffness: Array
    joints: Sequence[tuple[Any, JointLaw]]
    friction: Sequence[float | None]

    def solve(self, load: Array, start: Array, tolerance: float) -> PreloadState | None:
        """Equilibrium under a load from a start near to it; None where it is not found soon."""
        scale, u, least, last = float(np.linalg.norm(load)), start, np.inf, np.inf
        here = self._there(self._moves(u, quick=True))
        force = self._out_of_balance(load, u, here, quick=True)
        step, answer = u, None
        in_full, poor, far, past = False, False, False, list[tuple[Array, float]]()
        for count in range(STEPS + 1):
            size = float(np.linalg.norm(force)) / scale
            if size < IN_FULL and not in_full:
                here, in_full = self._there(self._moves(u)), True
                force, least = self._out_of_balance(load, u, here), np.inf
                size = float(np.linalg.norm(force)) / scale
            if in_full and size < tolerance:
                return self._state(u, here, size, count)
            if not size < GROWN * least:
                return None
            least, last, slow = min(least, size), size, not poor and len(past) > 1 and size > SLOW * last
            if answer is None or far or slow or (poor and size < FALLEN):
                far = size > FAR_IMBALANCE
                poor = answer is None and AGAIN < size <= FAR_IMBALANCE
                answer, past = self._tangent(here, rough=poor), []
                if answer is None:
                    return None
                step = answer(force)
            else:
                step = _next(step, answer(force), past)
            u, old = u + step, here
            here = self._there([move + by for move, by in zip(here.moves, self._moves(step, quick=True), strict=True)])
            force = force - self.stiffness @ step
            for (motion, _), before, after in zip(self.joints, old.forces, here.forces, strict=True):
                with np.errstate(over="ignore", invalid="ignore"):  # of a step too far, from which Newton is asked
                    force = force - motion.quick.T @ (after - before).astype(np.float32)
        return None

    def near(self, load: Array, start: Array | None, tolerance: float) -> Array | None:
        """Displacement at which groups in the place of points balance, by Newton; None where it is not found soon.

        It goes on from the start where that is near, else from springs of one pressure at each joint.
        """
        few = replace(self, joints=[(motion.coarse, law) for motion, law in self.joints])
        scale = float(np.linalg.norm(load))
        for u, least in ((start, NO_START), (None, np.inf)):
            if u is None:
                u = evenly_pressed(self.stiffness, few.joints, load)
            for _ in range(NEWTON):
                here = few._there(few._moves(u, quick=True))
                force = few._out_of_balance(load, u, here, quick=True)
                size = float(np.linalg.norm(force)) / scale
                if size < tolerance:
                    return u
                answer = few._tangent(here) if size < least else None
                if answer is None:
                    break
                least, u = size, u + answer(force)
        return None

    def _moves(self, u: Array, *, quick: bool = False) -> list[Array]:
        """Relative motion (q, 3) of the points of each joint, maybe of a change, to seven digits where quick."""
        if not quick:
            return [(motion.relative @ u).reshape(-1, 3) for motion, _ in self.joints]
        u = u.astype(np.float32)
        return [(motion.quick @ u).astype(float).reshape(-1, 3) for motion, _ in self.joints]

    def _out_of_balance(self, load: Array, u: Array, here: _There, *, quick: bool = False) -> Array:
        force = load - self.stiffness @ u
        for (motion, _), local in zip(self.joints, here.forces, strict=True):
            if quick:
                with np.errstate(over="ignore", invalid="ignore"):  # of a step too far
                    force = force - motion.quick.T @ local.astype(np.float32)
            else:
                force = force - motion.relative.T @ local
        return force

    def _there(self, moves: list[Array]) -> _There:
        there = _There(moves=moves, openings=[], pressures=[], k_n=[], slip_states=[], forces=[])
        for (motion, law), friction, move in zip(self.joints, self.friction, moves, strict=True):
            gap = move[:, 0] + motion.gap
            p, k_n = law.pressure(-gap)
            k_t = law.stiffness(p, tabulated=True)[1]
            limit = None if friction is None else friction * p
            slip_state = StickSlip(k_t=k_t, limit=limit, anchor=np.zeros((len(p), 2)))
            local = np.empty_like(move)
            local[:, 0] = -p
            local[:, 1:] = slip_state.shear(move[:, 1:])
            there.openings.append(gap)
            there.pressures.append(p)
            there.k_n.append(k_n)
            there.slip_states.append(slip_state)
            there.forces.append((local * motion.weights[:, None]).ravel())
        return there

    def _tangent(self, here: _There, *, rough: bool = False) -> _Answer | None:
        """What answers a force: springs of the joints as they are, without what slides; None where that is singular.

        rough: groups stand for the points.
        """
        tangents = []
        for (motion, _), springs in zip(self.joints, self._springs(here), strict=True):
            if rough and motion.groups is not None:
                tangents.append(joint_stiffness(motion.groups.light_mean, motion.groups.sums(springs)))
            else:
                tangents.append(joint_stiffness(motion.quick, springs))
        return _answer(self.stiffness, tangents)

    def _springs(self, here: _There) -> list[Array]:
        """Springs [N/m] (q, 3) at the points of each joint, without tangential ones where it slides."""
        found = []
        for (motion, _), move, k_n, slip_state in zip(self.joints, here.moves, here.k_n, here.slip_states, strict=True):
            k_t = np.where(slip_state.sliding(move[:, 1:]), 0.0, slip_state.k_t)
            found.append(per_point(motion.weights, k_n, k_t))
        return found

    def _state(self, u: Array, here: _There, size: float, steps: int) -> PreloadState:
        slipping = []
        for (motion, _), move, slip_state in zip(self.joints, here.moves, here.slip_states, strict=True):
            slides = slip_state.sliding(move[:, 1:])
            slipping.append(float(motion.weights @ slides / motion.weights.sum()))
        return PreloadState(
            pressures=tuple(here.pressures),
            openings=tuple(here.openings),
            slipping=tuple(slipping),
            displacement=u,
            imbalance=size,
            newton_steps=steps,
            inner_steps=0,
            factorisations=0,
        )


def evenly_pressed(stiffness: Array, joints: Sequence[tuple[Any, JointLaw]], load: Array) -> Array:
    """Displacement under springs that are tangent to p(approach) at one pressure in each joint: what they then carry.

    Raises NotConverged where nothing but slack springs holds the parts.
    """
    ends = [(10 * law.least_pressure, 0.5 * law.model.greatest_pressure) for _, law in joints]
    means = [
        float(np.clip(10 * np.sqrt(law.least_pressure * law.model.greatest_pressure), *end))
        for (_, law), end in zip(joints, ends, strict=True)
    ]
    u = np.zeros(len(load))
    for _ in range(EVEN):
        push, tangents, laid = load, [], []
        for (motion, law), mean in zip(joints, means, strict=True):
            k_n, k_t = (float(k) for k in law.stiffness(np.asarray(mean)))
            tangents.append(joint_stiffness(motion.quick, motion.weights[:, None] * np.array([k_n, k_t, k_t])))
            laid.append((k_n, mean - k_n * (float(law.approach(mean)) + motion.gap)))
            local = np.zeros((len(motion.gap), 3))
            local[:, 0] = laid[-1][1] * motion.weights
            push = push + motion.quick.T @ local.ravel().astype(motion.quick.dtype)
        answer = _answer(stiffness, tangents)
        if answer is None:
            raise NotConverged("preload: the joint opens fully on the way; load it in smaller steps")
        u = answer(push)
        for i, ((motion, _), (k_n, offset)) in enumerate(zip(joints, laid, strict=True)):
            carried = np.maximum(offset - k_n * (motion.quick @ u.astype(motion.quick.dtype))[::3], 0.0)
            means[i] = float(np.clip(motion.weights @ carried / motion.weights.sum(), *ends[i]))
    return u


def _answer(stiffness: Array, tangents: Sequence[Array]) -> _Answer | None:
    """What answers a force: the parts and the springs of the joints (m, m); None where they are singular."""
    from scipy.linalg.lapack import dpotrf, dpotrs

    factor, singular = dpotrf(sum(tangents, stiffness))
    if singular:
        return None
    return lambda force: np.asarray(dpotrs(factor, force)[0])


def _next(step: Array, answer: Array, past: list[tuple[Array, float]]) -> Array:
    """Broyden's next step after `step`, from what the tangent answers to the force that it has left; keeps `past`."""
    past.append((step, float(step @ step)))
    for (old, square), (new, _) in pairwise(past):
        answer = answer + new * (float(old @ answer) / square)
    last, square = past[-1]
    return np.asarray(answer / (1 - float(last @ answer) / square))
