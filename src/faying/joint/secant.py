"""Equilibrium in a basis by one tangent and secants: few products with all points of a joint, and no search."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from faying.joint.equilibrium import PreloadState, StickSlip
from faying.joint.groups import sprung
from faying.joint.joint_law import JointLaw
from faying.typing import Array

STEPS = 30  # after which Newton is asked
GROWN = 3.0  # times the least imbalance found, from which Newton is asked
AGAIN, FALLEN = 0.05, 0.03  # imbalance of a start whose tangent is that of groups, and where the one of points is made
ROUNDS = 4  # most times that the balance is found in full

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
    grips: list[StickSlip]
    forces: list[Array]


@dataclass(frozen=True, kw_only=True)
class Secants:
    """Solves the equilibrium of one load without history: no joint has slipped before.

    Broyden's good method from one tangent. The force out of balance is found in seven digits from step to step, since
    it is that of a change which grows ever smaller, and in full at the beginning and at the end. Tangential stiffness
    and the limit of friction follow the pressure at once.

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
        scale, u = float(np.linalg.norm(load)), start
        used, answer = 0, None
        for _ in range(ROUNDS):  # in full: at the beginning, at the end, and where that was not the end
            here = self._there([(motion.relative @ u).reshape(-1, 3) for motion, _ in self.joints])
            force = load - self.stiffness @ u
            for (motion, _), local in zip(self.joints, here.forces, strict=True):
                force = force - motion.relative.T @ local
            size = float(np.linalg.norm(force)) / scale
            if size < tolerance:
                return self._state(u, here, size, used)
            answer = answer or self._tangent(here, rough=size > AGAIN)
            if answer is None or used > STEPS:
                return None
            found = self._steps(u, here, force, scale, 0.5 * tolerance, answer)
            if found is None:
                return None
            u, steps, answer = found
            used += steps
        return None

    def _steps(
        self, u: Array, here: _There, force: Array, scale: float, tolerance: float, answer: _Answer
    ) -> tuple[Array, int, _Answer] | None:
        """The displacement in balance to seven digits, steps taken, and the last tangent; None where they fail."""
        least = float(np.linalg.norm(force)) / scale
        poor = least > AGAIN
        past: list[tuple[Array, float]] = []
        step = answer(force)
        for count in range(1, STEPS + 1):
            light = step.astype(np.float32)
            moves = [
                move + (motion.groups.light @ light).reshape(-1, 3)
                for (motion, _), move in zip(self.joints, here.moves, strict=True)
            ]
            ahead = self._there(moves)
            force = force - self.stiffness @ step
            for (motion, _), old, new in zip(self.joints, here.forces, ahead.forces, strict=True):
                force = force - motion.groups.light.T @ (new - old).astype(np.float32)
            u, here = u + step, ahead
            size = float(np.linalg.norm(force)) / scale
            if size < tolerance:
                return u, count, answer
            if not size < GROWN * least:
                return None
            least = min(least, size)
            if poor and size < FALLEN:
                again = self._tangent(here)
                if again is None:
                    return None
                answer, poor, past = again, False, []
                step = answer(force)
            else:
                step = _next(step, answer(force), past)
        return None

    def _there(self, moves: list[Array]) -> _There:
        there = _There(moves=moves, openings=[], pressures=[], k_n=[], grips=[], forces=[])
        for (motion, law), friction, move in zip(self.joints, self.friction, moves, strict=True):
            gap = move[:, 0] + motion.gap
            p, k_n, k_t = law.contact(-gap)
            limit = None if friction is None else friction * p
            grip = StickSlip(k_t=k_t, limit=limit, anchor=np.zeros((len(p), 2)))
            local = np.empty_like(move)
            local[:, 0] = -p
            local[:, 1:] = grip.shear(move[:, 1:])
            there.openings.append(gap)
            there.pressures.append(p)
            there.k_n.append(k_n)
            there.grips.append(grip)
            there.forces.append((local * motion.weights[:, None]).ravel())
        return there

    def _tangent(self, here: _There, *, rough: bool = False) -> _Answer | None:
        """What answers a force: springs of the joints as they are, without what slides; None where that is singular.

        rough: groups stand for the points.
        """
        from scipy.linalg import LinAlgError, cho_factor, cho_solve

        matrix = self.stiffness.copy()
        for (motion, _), move, k_n, grip in zip(self.joints, here.moves, here.k_n, here.grips, strict=True):
            k_t = np.where(grip.sliding(move[:, 1:]), 0.0, grip.k_t)
            springs, groups = motion.weights[:, None] * np.stack([k_n, k_t, k_t], axis=1), motion.groups
            matrix += sprung(groups.light_mean, groups.sums(springs)) if rough else sprung(groups.light, springs)
        try:
            factor = cho_factor(matrix)
        except LinAlgError:
            return None
        return lambda force: np.asarray(cho_solve(factor, force))

    def _state(self, u: Array, here: _There, size: float, steps: int) -> PreloadState:
        slipping = []
        for (motion, _), move, grip in zip(self.joints, here.moves, here.grips, strict=True):
            slides = grip.sliding(move[:, 1:])
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


def _next(step: Array, answer: Array, past: list[tuple[Array, float]]) -> Array:
    """Broyden's next step after `step`, from what the tangent answers to the force that it has left; keeps `past`."""
    past.append((step, float(step @ step)))
    for (old, square), (new, _) in pairwise(past):
        answer = answer + new * (float(old @ answer) / square)
    last, square = past[-1]
    return np.asarray(answer / (1 - float(last @ answer) / square))
