"""March of sliders under a moving normal load: quasi-static steps, and steady cycles in Fourier coefficients.

A slider is a spring of stiffness k_t whose end is dragged along when its stretch reaches its limit. The limit is
`reach` times the approach beyond the slider's onset, so that it follows the normal load; a slider that opens drops its
shear. A step that goes beyond the limit is returned radially (implicit return mapping in two directions).
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from faying.errors import InputError
from faying.typing import Array, Index, Mask

BLOCK = 4096  # sliders marched together, so that the work stays in the cache
TINY = 1e-280
TOUCHES = 1e-9  # relative: a slider that comes back to its limit has not slid


@dataclass(frozen=True, kw_only=True)
class Sliders:
    """One-sided springs with sliders, s at each of q points; all arrays (q, s).

    onset: approach at which each closes [m]; k_n, k_t [Pa/m]; reach: greatest stretch over the closing beyond the
    onset [-].
    """

    onset: Array
    k_n: Array
    k_t: Array
    reach: Array


@dataclass(frozen=True, kw_only=True)
class SliderState:
    """Where the sliders are: tangential motion slip (q, 2) [m] and stretch (q, s, 2) [m]."""

    slip: Array
    stretch: Array


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


def fourier(harmonics: int, samples: int) -> tuple[Array, Array]:
    """Matrices (samples, 1 + 2H) and (1 + 2H, samples) from coefficients to a cycle, and back."""
    if samples < 2 * harmonics + 2:
        raise InputError(
            f"samples: {samples} cannot resolve {harmonics} harmonics; give at least {2 * harmonics + 2}, better 64"
        )
    phase = 2 * np.pi * np.arange(samples) / samples
    waves = [np.ones(samples)]
    for h in range(1, harmonics + 1):
        waves += [np.cos(h * phase), np.sin(h * phase)]
    to_time = np.stack(waves, axis=1)
    back = to_time.T * (2 / samples)
    back[0] /= 2
    return to_time, back


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
    depth = approach[:, None] - sliders.onset
    shut = depth > 0
    limit = np.where(shut, sliders.reach * depth, 0.0)
    trial = state.stretch + (slip - state.slip)[:, None, :]
    size = np.linalg.norm(trial, axis=2)
    slides = size > limit
    along = trial / np.where(size > 0, size, 1.0)[:, :, None]
    left = np.where(slides, limit / np.where(size > 0, size, 1.0), 1.0)
    stretch = trial * left[:, :, None]
    k_t = np.where(shut, sliders.k_t, 0.0)

    traction = np.empty((len(slip), 3))
    traction[:, 0] = -np.sum(np.where(shut, sliders.k_n * depth, 0.0), axis=1)
    traction[:, 1:] = np.einsum("qs,qsi->qi", k_t, stretch)
    tangent = np.zeros((len(slip), 3, 3))
    tangent[:, 0, 0] = np.sum(np.where(shut, sliders.k_n, 0.0), axis=1)
    dragged = np.where(slides, k_t * left, 0.0)
    tangent[:, 1:, 1:] = np.sum(k_t * left, axis=1)[:, None, None] * np.eye(2)
    tangent[:, 1:, 1:] -= np.einsum("qs,qsi,qsj->qij", dragged, along, along)
    tangent[:, 1:, 0] = -np.einsum("qs,qsi->qi", np.where(slides & shut, k_t * sliders.reach, 0.0), along)
    return SliderState(slip=slip, stretch=stretch), traction, tangent


@dataclass(frozen=True)
class _Motion:
    """A cycle in time: slip (samples, q, 2), approach (samples, q), with the Fourier matrices."""

    coefficients: Array
    gap: Array
    to_time: Array
    back: Array
    slip: tuple[Array, Array]
    approach: Array


def _in_time(coefficients: Array, gap: Array, samples: int) -> _Motion:
    to_time, back = fourier((len(coefficients) - 1) // 2, samples)
    opening, first, second = (to_time @ np.ascontiguousarray(coefficients[:, :, i]) for i in range(3))
    return _Motion(coefficients, gap, to_time, back, (first, second), -(opening + gap))


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
    slips in any direction up to a few percent of a point's mean shear, and .3 % of the loss of all.

    Args:
        sliders: (q, s).
        start: state from which the sliders set out.
        coefficients: of the motion (1 + 2H, q, 3) [m]: opening and two slips; mean, cos 1, sin 1, cos 2, ...
        gap: (q,) [m]; approach is minus (opening + gap).
        samples: instants in the cycle; the error falls with their square.
        derivative: whether it is asked for.
    """
    motion = _in_time(coefficients, gap, samples)
    count, q, _ = coefficients.shape
    answer = _Answer(
        traction=np.zeros((count, q, 3)),
        derivative=np.zeros((q, count, 3, count, 3)) if derivative else None,
        slid=np.zeros(q),
    )
    least, greatest = motion.approach.min(axis=0), motion.approach.max(axis=0)
    _normal(sliders, motion, least, greatest, answer)
    moved = np.sqrt(np.max(sum((u - start.slip[:, i]) ** 2 for i, u in enumerate(motion.slip)), axis=0))
    stays = np.linalg.norm(start.stretch, axis=2) + moved[:, None] <= sliders.reach * (least[:, None] - sliders.onset)
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


def _normal(sliders: Sliders, motion: _Motion, least: Array, greatest: Array, answer: _Answer) -> None:
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


def _stuck(sliders: Sliders, start: SliderState, motion: _Motion, stays: Mask, answer: _Answer) -> None:
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


def _march(sliders: Sliders, start: SliderState, motion: _Motion, points: Index, active: Mask, answer: _Answer) -> None:
    """March the active sliders of some points, and add what they carry."""
    local, which = np.nonzero(active[points])
    set_ = _Set.of(sliders, start, motion, points[local], which)
    memory = _Memory.start(motion.to_time, set_, local) if answer.derivative is not None else None
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
    touch = sliders.k_n[set_.owner, set_.which] * set_.depth.max(axis=0)
    answer.slid[points] += np.add.reduceat(np.where(slid, touch, 0.0), first)
    if memory is not None:
        assert answer.derivative is not None
        answer.derivative[points, :, 1:] += memory.coefficients(motion.back)


@dataclass
class _Set:
    """Sliders that are marched together: n of them, sorted by point.

    owner, which: point and spring of each; k, reach as in Sliders; depth, limit (samples, n): closing beyond the onset
    and greatest stretch; step: move since the instant before, begin: since the start (2 directions); stretch: what is
    left of both, instant by instant.
    """

    owner: Index
    which: Index
    k: Array
    reach: Array
    depth: Array
    limit: Array
    step: tuple[Array, Array]
    begin: tuple[Array, Array]
    stretch: tuple[Array, Array]

    @classmethod
    def of(cls, sliders: Sliders, start: SliderState, motion: _Motion, owner: Index, which: Index) -> "_Set":
        """Sliders `which` of points `owner`, at their start."""
        reach = sliders.reach[owner, which]
        depth = motion.approach[:, owner]
        depth -= sliders.onset[owner, which]
        np.maximum(depth, 0.0, out=depth)
        return cls(
            owner=owner,
            which=which,
            k=sliders.k_t[owner, which],
            reach=reach,
            depth=depth,
            limit=reach * depth,
            step=_both(lambda i: np.diff(motion.slip[i], axis=0, prepend=motion.slip[i][-1:])[:, owner]),
            begin=_both(lambda i: (motion.slip[i][0] - start.slip[:, i])[owner] + start.stretch[owner, which, i]),
            stretch=_both(lambda _: np.empty(depth.shape)),
        )

    def only(self, kept: Index) -> "_Set":
        """Some of the sliders, where they are."""

        def part(pair: tuple[Array, Array]) -> tuple[Array, Array]:
            return pair[0][..., kept], pair[1][..., kept]

        return _Set(
            owner=self.owner[kept],
            which=self.which[kept],
            k=self.k[kept],
            reach=self.reach[kept],
            depth=self.depth[:, kept],
            limit=self.limit[:, kept],
            step=part(self.step),
            begin=part(self.begin),
            stretch=part(self.stretch),
        )

    def turn(self, motion: _Motion, *, first: bool, memory: "_Memory | None") -> Mask:
        """Take them round the cycle once, the first time from the start; return which slid."""
        slid = np.zeros(len(self.k), dtype=bool)
        for t in range(len(self.limit)):
            one, two = self.stretch[0][t], self.stretch[1][t]
            if first and t == 0:
                one[:], two[:] = self.begin
            else:
                np.add(self.stretch[0][t - 1], self.step[0][t], out=one)
                np.add(self.stretch[1][t - 1], self.step[1][t], out=two)
            size = one * one
            size += two * two
            np.sqrt(size, out=size)
            left = self.limit[t] / np.maximum(size, TINY)
            slides = left < 1
            if memory is not None and slides.any():
                memory.slide(t, np.flatnonzero(slides), (one, two), size, left, self.depth[t])
            slid |= left < 1 - TOUCHES
            np.minimum(left, 1.0, out=left)
            one *= left
            two *= left
            if memory is not None and not first:
                memory.read(t)
        return slid


def _both(make: Callable[[int], Array]) -> tuple[Array, Array]:
    """What is made for both directions of slip."""
    return make(0), make(1)


@dataclass
class _Memory:
    """Derivatives of the anchors by the coefficients of opening and of both slips.

    A slider's stretch is slip minus anchor. The anchor moves only while it slides, so its derivative does. Along the
    direction n of the last slide it depends on that instant alone: n times (reach, n1, n2) times the waves then. So
    those parts are summed over the sliders of a point by instant, `held` (samples, 5, points). Across n it remembers
    what was before: `across` (1+2H, 3, sliders), in single precision, with which Newton's method converges as fast.
    """

    to_time: Array
    k: Array
    reach: Array
    local: Index
    first: Index
    along: Array  # (3, sliders): n1, n2 and reach at the last slide; 0 before the first
    when: Index
    across: NDArray[np.float32]
    held: Array | None = None
    history: Array | None = None

    @classmethod
    def start(cls, to_time: Array, sliders: _Set, local: Index) -> "_Memory":
        """Return anchors that do not depend on the motion."""
        n = len(sliders.k)
        return cls(
            to_time=to_time,
            k=sliders.k,
            reach=sliders.reach,
            local=local,
            first=np.zeros(0, dtype=np.int64),
            along=np.zeros((3, n)),
            when=np.zeros(n, dtype=np.int64),
            across=np.zeros((to_time.shape[1], 3, n), dtype=np.float32),
        )

    def listening(self, kept: Index, sliders: _Set, local: Index, first: Index) -> "_Memory":
        """Some of the sliders, of which the derivative of the forces that a point's anchors hold together is kept."""
        samples, count = self.to_time.shape
        found = _Memory(
            to_time=self.to_time,
            k=sliders.k,
            reach=sliders.reach,
            local=local,
            first=first,
            along=self.along[:, kept],
            when=self.when[kept],
            across=self.across[..., kept],
            held=np.zeros((samples, 5, len(first))),
            history=np.empty((samples, count, 2, 3, len(first))),
        )
        found._hold(np.arange(len(kept)), found.along, 1.0)
        return found

    def _hold(self, which: Index, along: Array, sign: float) -> None:
        """Add or take away what sliders hold along their last slide: (n1 reach, n2 reach, n1 n1, n1 n2, n2 n2)."""
        assert self.held is not None
        n1, n2, reach = along
        points = len(self.first)
        place = self.when[which] * (5 * points) + self.local[which]
        one, two = (sign * self.k[which] * n for n in (n1, n2))
        for i, force in enumerate((one * reach, two * reach, one * n1, one * n2, two * n2)):
            np.add.at(self.held.reshape(-1), place + i * points, force)

    def slide(self, t: int, which: Index, trial: tuple[Array, Array], size: Array, left: Array, depth: Array) -> None:
        """Sliders `which` are dragged along the trial stretch, of length `size`, of which `left` is left.

        Along it the stretch is the limit, whatever was before; across it the trial stretch shrinks by `left`.
        """
        size, left = size[which], left[which]
        old, new = self.along.take(which, axis=1), np.empty((3, len(which)))
        moves = size > 0  # an open slider that does not move has no direction: any will do, for nothing is left
        new[0], new[1] = (e[which] / np.where(moves, size, 1.0) for e in trial)
        new[0, ~moves] = 1.0
        new[2] = np.where(depth[which] > 0, self.reach[which], 0.0)
        waves = self.to_time.astype(np.float32)
        now, then = waves[t][:, None], waves.T.take(self.when[which], axis=1)
        turn = left * (new[0] * old[1] - new[1] * old[0])
        gone = 1 - left
        across = self.across.take(which, axis=-1)
        across *= _single(left * (new[0] * old[0] + new[1] * old[1]))
        for i, by in enumerate((old[2], old[0], old[1])):
            across[:, i] += _single(turn * by) * then
        across[:, 1] -= _single(gone * new[1]) * now
        across[:, 2] += _single(gone * new[0]) * now
        self.across[..., which] = across
        if self.held is not None:
            self._hold(which, old, -1.0)
        self.along[:, which] = new
        self.when[which] = t
        if self.held is not None:
            self._hold(which, new, 1.0)

    def read(self, t: int) -> None:
        """Note the derivative at an instant."""
        assert self.held is not None
        assert self.history is not None
        samples, count = self.to_time.shape
        held = (self.to_time.T @ self.held.reshape(samples, -1)).reshape(count, 5, -1)
        now = self.history[t]
        now[:, 0], now[:, 1] = held[:, [0, 2, 3]], held[:, [1, 3, 4]]
        now[:, 0] -= np.add.reduceat(self.across * _single(self.k * self.along[1]), self.first, axis=-1)
        now[:, 1] += np.add.reduceat(self.across * _single(self.k * self.along[0]), self.first, axis=-1)

    def coefficients(self, back: Array) -> Array:
        """Derivative of the shear's coefficients (points, 1+2H, 2, 1+2H, 3) [Pa/m]."""
        assert self.history is not None
        samples, count = self.to_time.shape
        found = -(back @ self.history.reshape(samples, -1)).reshape(count, count, 2, 3, -1)
        stiffness = np.add.reduceat(self.k, self.first)
        for a in range(count):
            for i in range(2):
                found[a, a, i, 1 + i] += stiffness
        return found.transpose(4, 0, 2, 1, 3)


def _single(values: Array) -> NDArray[np.float32]:
    return values.astype(np.float32)
