"""March of sliders under a moving normal load: quasi-static steps, and steady cycles in Fourier coefficients.

A slider is a spring of stiffness k_t whose end is dragged along when its stretch reaches its limit. The limit is
`reach` times the approach beyond the slider's onset, so that it follows the normal load; a slider that opens drops its
shear. A step that goes beyond the limit is returned radially (implicit return mapping in two directions).
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from faying.microslip.sliders import Anchors, CycleMotion, MarchingSliders, Sliders, SliderState, in_time
from faying.typing import Array, Index, Mask

BLOCK = 8192  # sliders marched together, so that the work stays in the cache


@dataclass(frozen=True, kw_only=True)
class Cycle:
    """A steady cycle of q points with harmonics 0 to H.

    traction (1 + 2H, q, 3) [Pa]: coefficients of mean, cos 1, sin 1, cos 2, ...; derivative (q, 3(1+2H), 3(1+2H))
    [Pa/m] of the traction's coefficients by those of the motion, harmonic first, None where not asked for; dissipated
    (q,) [J/m2] in a cycle; slipping (q,): share of the limits of all springs that touch whose spring slides [-];
    open (q,): whether the point opens at any time.
    """

    traction: Array
    derivative: Array | None
    dissipated: Array
    slipping: Array
    open: Mask


def advance(sliders: Sliders, state: SliderState, slip: Array, approach: Array) -> tuple[SliderState, Array, Array]:
    """Take one quasi-static step.

    Args:
        sliders: (q, s).
        state: before the step.
        slip: tangential motion (q, 2) [m] after the step.
        approach: (q,) [m] after the step.

    Returns:
        The state after it, the traction (q, 3) [Pa] = (minus pressure, shear) and its derivative (q, 3, 3) [Pa/m] by
        the motion (opening, slip).
    """
    depth = np.maximum(approach[:, None] - sliders.onset, 0.0)
    shut = depth > 0
    limit = sliders.reach * depth
    stretch = np.moveaxis(np.empty((2, *depth.shape)), 0, -1)  # one direction after the other in memory
    one, two = stretch[..., 0], stretch[..., 1]
    moved = slip - state.slip
    np.add(state.stretch[..., 0], moved[:, :1], out=one)
    np.add(state.stretch[..., 1], moved[:, 1:], out=two)
    size = np.sqrt(one * one + two * two)
    some = np.where(size > 0, size, 1.0)
    slides = size > limit
    left = np.where(slides, limit / some, 1.0)
    k_t = np.where(shut, sliders.k_t, 0.0)
    sticking = k_t * left
    along = one / some, two / some
    one *= left
    two *= left

    traction = np.empty((len(slip), 3))
    traction[:, 0] = -np.sum(sliders.k_n * depth, axis=1)
    traction[:, 1] = np.sum(k_t * one, axis=1)
    traction[:, 2] = np.sum(k_t * two, axis=1)
    tangent = np.zeros((len(slip), 3, 3))
    tangent[:, 0, 0] = np.sum(np.where(shut, sliders.k_n, 0.0), axis=1)
    tangent[:, 1, 1] = tangent[:, 2, 2] = np.sum(sticking, axis=1)
    dragged = np.where(slides, sticking, 0.0)
    drawn = np.where(slides, k_t * sliders.reach, 0.0)
    for i in range(2):
        tangent[:, 1 + i, 0] = -np.sum(drawn * along[i], axis=1)
        for j in range(2):
            tangent[:, 1 + i, 1 + j] -= np.sum(dragged * along[i] * along[j], axis=1)
    return SliderState(slip=slip, stretch=stretch), traction, tangent


def steady(
    sliders: Sliders,
    start: SliderState,
    coefficients: Array,
    *,
    gap: Array,
    samples: int = 64,
    derivative: bool = True,
) -> Cycle:
    """March sliders from `start` round a cycle until it repeats itself, and transform it.

    Springs that stay shut or open throughout, and sliders that cannot slip, are linear and taken in closed form. Two
    turns forget the start wholly where the slip goes to and fro along a line, as it does nearly everywhere in a mode.
    Where it runs round an ellipse, some of the shear across it is left, as it would be after two real cycles: with
    slips in any direction up to a few percent of a point's mean shear, and 0.3 % of the loss of all.

    Args:
        sliders: (q, s).
        start: state from which the sliders set out.
        coefficients: of the motion (1 + 2H, q, 3) [m]: opening and two slips; mean, cos 1, sin 1, cos 2, ...
        gap: (q,) [m]; approach is minus (opening + gap).
        samples: instants in the cycle; the error falls with their square.
        derivative: whether it is asked for.
    """
    motion = in_time(coefficients, gap, samples)
    count, q, _ = coefficients.shape
    answer = _Answer(
        traction=np.zeros((count, q, 3)),
        derivative=np.zeros((q, count, 3, count, 3)) if derivative else None,
        slid=np.zeros(q),
    )
    least, greatest = motion.approach.min(axis=0), motion.approach.max(axis=0)
    _normal(sliders, motion, least, greatest, answer)
    moved = np.sqrt(np.max(sum((u - start.slip[:, i]) ** 2 for i, u in enumerate(motion.slip)), axis=0))
    stretched = np.hypot(start.stretch[..., 0], start.stretch[..., 1])
    stays = stretched + moved[:, None] <= sliders.reach * (least[:, None] - sliders.onset)
    _stuck(sliders, start, motion, stays, answer)
    active = ~stays & (greatest[:, None] > sliders.onset) & (sliders.k_t > 0)
    for points in _blocks(active.sum(axis=1)):
        _march(sliders, start, motion, points, active, answer)
    touch = sliders.k_n * np.maximum(greatest[:, None] - sliders.onset, 0.0)
    total = touch.sum(axis=1)
    return Cycle(
        traction=answer.traction,
        derivative=None if answer.derivative is None else answer.derivative.reshape(q, 3 * count, 3 * count),
        dissipated=_loop_area(coefficients, answer.traction),
        slipping=answer.slid / np.where(total > 0, total, 1.0),
        open=least <= np.where(sliders.k_n > 0, sliders.onset, np.inf).min(axis=1),
    )


@dataclass
class _Answer:
    """What is summed over springs: traction (1+2H, q, 3), its derivative (q, 1+2H, 3, 1+2H, 3), limits that slid."""

    traction: Array
    derivative: Array | None
    slid: Array


def _loop_area(motion: Array, traction: Array) -> Array:
    """Work per cycle (q,) of a traction on a motion: pi times the sum of h (t_sin u_cos - ...), exact for harmonics."""
    area = np.zeros(motion.shape[1])
    for h in range(1, (len(motion) + 1) // 2):
        cos, sin = 2 * h - 1, 2 * h
        area += np.pi * h * np.sum(traction[cos] * motion[sin] - traction[sin] * motion[cos], axis=1)
    return area


def _normal(sliders: Sliders, motion: CycleMotion, least: Array, greatest: Array, answer: _Answer) -> None:
    """Add the pressure: springs shut throughout in closed form, those that open and shut in time."""
    onset, k_n = sliders.onset, sliders.k_n
    shut = onset <= least[:, None]
    stiffness = np.sum(np.where(shut, k_n, 0.0), axis=1)
    answer.traction[:, :, 0] += stiffness * motion.coefficients[:, :, 0]
    answer.traction[0, :, 0] += stiffness * motion.gap + np.sum(np.where(shut, k_n * onset, 0.0), axis=1)
    if answer.derivative is not None:
        for a in range(len(motion.coefficients)):
            answer.derivative[:, a, 0, a, 0] += stiffness
    points, which = np.nonzero(~shut & (onset < greatest[:, None]) & (k_n > 0))
    if not points.size:
        return
    for part in np.array_split(np.arange(points.size), max(1, points.size // BLOCK)):
        owner, first = np.unique(points[part], return_index=True)
        k = k_n[points[part], which[part]]
        depth = motion.approach[:, points[part]]
        depth -= onset[points[part], which[part]]
        np.maximum(depth, 0.0, out=depth)
        answer.traction[:, owner, 0] -= np.add.reduceat((motion.back @ depth) * k, first, axis=1)
        if answer.derivative is not None:
            tangent = np.add.reduceat(np.where(depth > 0, k, 0.0), first, axis=1)
            found = np.einsum("at,tq,tb->qab", motion.back, tangent, motion.to_time, optimize=True)
            answer.derivative[owner, :, 0, :, 0] += found


def _stuck(sliders: Sliders, start: SliderState, motion: CycleMotion, stays: Mask, answer: _Answer) -> None:
    """Add the shear of sliders that never slip."""
    k = np.where(stays, sliders.k_t, 0.0)
    total = k.sum(axis=1)
    answer.traction[:, :, 1:] += total[:, None] * motion.coefficients[:, :, 1:]
    answer.traction[0, :, 1:] += np.einsum("qs,qsi->qi", k, start.stretch) - total[:, None] * start.slip
    if answer.derivative is not None:
        for a in range(len(motion.coefficients)):
            for i in (1, 2):
                answer.derivative[:, a, i, a, i] += total


def _blocks(counts: Index) -> Iterator[Index]:
    """Groups of points of which each has sliders to march, about BLOCK sliders in a group."""
    points = np.flatnonzero(counts)
    if points.size:
        group = np.cumsum(counts[points]) // BLOCK
        yield from np.split(points, np.flatnonzero(np.diff(group)) + 1)


def _march(
    sliders: Sliders, start: SliderState, motion: CycleMotion, points: Index, active: Mask, answer: _Answer
) -> None:
    """March the active sliders of some points, and add what they carry."""
    local, which = np.nonzero(active[points])
    set_ = MarchingSliders.of(sliders, start, motion, points[local], which)
    memory = Anchors.start(motion.to_time, set_, local) if answer.derivative is not None else None
    slid = set_.turn(motion, first=True, memory=memory)
    # a slider that did not slide in the first turn never will: it is linear
    loose = np.flatnonzero(~slid)
    stuck = np.zeros_like(active)
    stuck[points[local[loose]], which[loose]] = True
    _stuck(sliders, start, motion, stuck, answer)
    moving = np.flatnonzero(slid)
    if not moving.size:
        return
    set_, local = set_.only(moving), local[moving]
    kept, local = np.unique(local, return_inverse=True)
    first = np.flatnonzero(np.diff(local, prepend=-1))
    points = points[kept]
    if memory is not None:
        memory = memory.listening(moving, set_, local, first)
    slid = set_.turn(motion, first=False, memory=memory)
    for i in range(2):
        found = (motion.back @ set_.stretch[i]) * set_.k
        answer.traction[:, points, 1 + i] += np.add.reduceat(found, first, axis=1)
    deepest = np.maximum(motion.approach.max(axis=0)[set_.owner] - set_.onset, 0.0)
    touch = sliders.k_n[set_.owner, set_.which] * deepest
    answer.slid[points] += np.add.reduceat(np.where(slid, touch, 0.0), first)
    if memory is not None:
        assert answer.derivative is not None
        answer.derivative[points, :, 1:] += memory.coefficients(motion.back)
