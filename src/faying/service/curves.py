"""Level curves of the modes of a structure, marched up to the amplitude that an excitation makes of each."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying.case.level_damping import SPRINGS_AT_ENDS, moved_by_loss, rest_damping
from faying.errors import InputError
from faying.joint.bolted import BoltedStructure
from faying.joint.equilibrium import PreloadState
from faying.joint.modal import Vibration
from faying.microslip.levels import SPRINGS, LevelCycle, LevelModel, cut_laws, level_basis, level_model
from faying.microslip.microslip import Microslip
from faying.service.mode_curve import LEAST_SLIP, ModeCurve
from faying.typing import Array

MEDIAN = 1  # of friction, among 5 %, median and 95 %
LOWEST = 0.02  # of the amplitude that a mode would have with the least damping at rest: where its curve begins
STEP = 2.0  # from level to level: between them a curve of two plateaus is smooth to 1 %
STEP_AT_ENDS = 4.0  # the same at the ends of friction, where 3 % do
BEND = 0.5  # change of the power of slip from step to step that asks for smaller ones: between them it is right to 5 %
LONGER = 1.5  # power of a step that the next one may be
FINEST_STEP = 1.15  # the smallest: two blocks that begin to slide as a whole have 90 times the damping over a step of 2
NO_SLIP = 0.05  # of the least damping at rest: a mode with less slip at the greatest amplitude has one point there
SLIGHT = 0.1  # of the damping at rest: a curve that begins with more slip goes down first, in steps of
DOWN = 8.0
MOST_DOWN = 6  # at most so many of them
MOST_SHORT = 20  # levels in a row that are not reached in one step: a joint that slides as a whole goes on for ever
NOTHING = 1e-3  # of the level of the mode that is shaken most: modes below it are taken as at rest


@dataclass(frozen=True, kw_only=True)
class CurveSets:
    """The curves of all elastic modes at the median of friction, and at its ends where it is not given.

    Args:
        best: Of each mode (m).
        least, most: At the least and the greatest friction; None where it is known of each joint.
        rest: Damping ratio at rest [-], 5 %, median and 95 % (3, m).
        ended: Modes, from 1, whose joints would slide without end below the amplitude that is looked for.
    """

    best: tuple[ModeCurve, ...]
    least: tuple[ModeCurve, ...] | None
    most: tuple[ModeCurve, ...] | None
    rest: Array
    ended: tuple[int, ...] = ()

    def at_rest(self, end: int) -> tuple[ModeCurve, ...]:
        """The best curves with the damping at rest of an end: 0, 1 or 2."""
        return _with_rest(self.best, self.rest[end])


def _with_rest(curves: Sequence[ModeCurve], rest: Array) -> tuple[ModeCurve, ...]:
    """Curves with other damping ratios at rest [-] (m,)."""
    return tuple(replace(curve, rest=float(z)) for curve, z in zip(curves, rest, strict=True))


def curve_sets(
    structure: BoltedStructure,
    preload: PreloadState,
    found: Vibration,
    needs: Sequence[Callable[[ModeCurve], float]],
    greatest: Array,
    frictions: Array,
    parts_loss: float = 0.0,
) -> CurveSets:
    """March the modes of a structure.

    Args:
        structure: The structure.
        preload: Its equilibrium under the bolts.
        found: Its modes at rest.
        needs: Of each elastic mode (m), the amplitude of its coordinate up to which its curve is wanted.
        greatest: Displacement of the node that moves most in each mode [kg^-1/2] (m,).
        frictions: Coefficient of each joint (3, j), 5 %, median and 95 %.
        parts_loss: Loss factor of the parts themselves [-].
    """
    rest = rest_damping(structure, found, parts_loss)
    speeds = 2 * np.pi * found.damped.frequencies
    plain = tuple(ModeCurve(speed=float(w), rest=float(z)) for w, z in zip(speeds, rest[1], strict=True))
    slips = bool(structure.joints) and not any(joint.per_node for joint in structure.joints)
    laws = _laws(structure, preload, frictions) if slips else {}
    if not laws:
        return CurveSets(best=plain, least=None, most=None, rest=rest)
    lossless, damped = _with_rest(plain, rest[0]), _with_rest(plain, rest[2])
    expected, likely = (
        np.array([need(c) for need, c in zip(needs, curves, strict=True)]) for curves in (lossless, damped)
    )
    scale = greatest * speeds**2
    wanted = expected * scale > NOTHING * (expected * scale).max(initial=0.0)
    basis = level_basis(structure, preload, found, list(laws.values())[:2], np.where(wanted, likely * scale, 0.0))
    laws[MEDIAN] = cut_laws(structure, preload, frictions[MEDIAN], SPRINGS)
    moved = moved_by_loss(structure, found)
    sets, ended = {}, set()
    for end, own in laws.items():
        model = level_model(structure, preload, basis, own)
        marched = [
            _march(model, k, curve, need, scale[k], moved[k], STEP if end == MEDIAN else STEP_AT_ENDS)
            if wanted[k]
            else (curve, False)
            for k, (curve, need) in enumerate(zip(lossless, needs, strict=True))
        ]
        sets[end] = _with_rest([curve for curve, _ in marched], rest[1])
        ended |= {k + 1 for k, (_, stopped) in enumerate(marched) if stopped and end == MEDIAN}
    least, most = sets.get(0), sets.get(2)
    return CurveSets(best=sets[MEDIAN], least=least, most=most, rest=rest, ended=tuple(sorted(ended)))


def _laws(structure: BoltedStructure, preload: PreloadState, frictions: Array) -> dict[int, list[Microslip]]:
    """The laws cut coarsely, by the end of the friction; at the median alone where it is known of each joint.

    None at all where a law has no stiffness that slips.
    """
    ends = range(3) if np.any(np.ptp(frictions, axis=0)) else (MEDIAN,)
    try:
        return {end: cut_laws(structure, preload, frictions[end], SPRINGS_AT_ENDS) for end in ends}
    except InputError:
        return {}


def _march(
    model: LevelModel,
    mode: int,
    curve: ModeCurve,
    needs: Callable[[ModeCurve], float],
    scale: float,
    moved: float,
    step: float,
) -> tuple[ModeCurve, bool]:
    """The curve of a mode from small amplitudes up to what is needed of it; whether it ends before.

    scale: acceleration of the node that moves most over the amplitude at rest; moved: what loss makes of frequencies;
    step: from level to level.
    """
    points: list[tuple[float, float, float]] = []
    longest = step
    last: LevelCycle | None = None
    settles, short = True, 0  # where passes do not settle, they seldom do again above
    top = needs(curve) * scale
    cycle = model.passes(top, mode)
    if cycle.converged and cycle.damping < NO_SLIP * curve.rest:  # and less below
        return _through(curve, [_point(cycle, moved)]), False
    level = LOWEST * top
    cycle = model.passes(level, mode)
    for _ in range(MOST_DOWN):
        if cycle.damping < SLIGHT * curve.rest or level == 0:  # False where there is no answer
            break
        level /= DOWN
        cycle = model.passes(level, mode)
    while level > 0 and np.isfinite(cycle.frequency) and short <= MOST_SHORT:
        point = _point(cycle, moved)
        if last is not None and _bends([*points, point], curve.rest) and step > FINEST_STEP:
            level, step = np.sqrt(last.level * cycle.level), np.sqrt(step)
        else:
            if not points or point[0] > points[-1][0]:  # else its shape changed by more than the level
                points.append(point)
                curve = _through(curve, points)
                if point[0] >= needs(curve):
                    return curve, False
            last, level = cycle, cycle.level * step
            step = min(longest, step**LONGER)
        settles = settles and (cycle := model.passes(level, mode)).converged
        if not settles and last is not None:
            # as far as harmonic balance gets, else by passes a little farther
            found = model.balanced(last, level, mode) if last.converged else last
            farther = found.level > FINEST_STEP**0.25 * last.level
            cycle = found if farther else model.passes(min(level, FINEST_STEP * last.level), mode)
        short = short + 1 if cycle.level < level else 0
    return curve, level > 0


def _point(cycle: LevelCycle, moved: float) -> tuple[float, float, float]:
    """Amplitude, circular frequency [rad/s] and damping ratio of slip."""
    return float(np.linalg.norm(cycle.motion[1:3])), 2 * np.pi * cycle.frequency * moved, cycle.damping


def _through(curve: ModeCurve, points: Sequence[tuple[float, float, float]]) -> ModeCurve:
    amplitudes, speeds, slips = np.array(points).T
    return replace(curve, amplitudes=amplitudes, speeds=speeds, slips=slips)


def _bends(points: Sequence[tuple[float, float, float]], rest: float) -> bool:
    """Whether the power of the amplitude with which slip goes changes much at the last point but one.

    rest: damping at rest, beside which slip counts.
    """
    amplitudes, _, slips = np.log(np.maximum(np.array(points[-3:]).T, [[0.0], [0.0], [LEAST_SLIP]]))
    along = np.diff(amplitudes)
    if np.any(along <= 0):
        return False
    # below the first point slip is in proportion to the amplitude
    change = float(np.ptp(np.concatenate([[1.0], np.diff(slips) / along])[-2:]))
    return change * points[-1][2] > BEND * (points[-1][2] + rest)
