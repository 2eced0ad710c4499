"""Sliders on springs, their motion in time, and their march round a cycle with its derivative."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from faying.errors import InputError
from faying.typing import Array, Index, Mask

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


@dataclass(frozen=True)
class CycleMotion:
    """A cycle in time: slip (samples, q, 2), approach (samples, q), with the Fourier matrices."""

    coefficients: Array
    gap: Array
    to_time: Array
    back: Array
    slip: tuple[Array, Array]
    approach: Array


def in_time(coefficients: Array, gap: Array, samples: int) -> CycleMotion:
    """The cycle of Fourier coefficients (1 + 2H, q, 3) over gaps (q,) [m], at `samples` instants."""
    to_time, back = fourier((len(coefficients) - 1) // 2, samples)
    opening, first, second = (to_time @ np.ascontiguousarray(coefficients[:, :, i]) for i in range(3))
    return CycleMotion(coefficients, gap, to_time, back, (first, second), -(opening + gap))


@dataclass
class MarchingSliders:
    """Sliders that are marched together: n of them, sorted by point.

    owner, which: point and spring of each; onset, k, reach as in Sliders; points, many (p,): their points, and how many
    of the sliders each has; begin: move since the start until the first instant (2 directions); stretch (samples, n):
    what is left of the moves, instant by instant.
    """

    owner: Index
    which: Index
    onset: Array
    k: Array
    reach: Array
    points: Index
    many: Index
    begin: tuple[Array, Array]
    stretch: tuple[Array, Array]

    @classmethod
    def of(cls, sliders: Sliders, start: SliderState, motion: CycleMotion, owner: Index, which: Index) -> Self:
        """Sliders `which` of points `owner`, at their start."""
        points, many = np.unique(owner, return_counts=True)
        return cls(
            owner=owner,
            which=which,
            onset=sliders.onset[owner, which],
            k=sliders.k_t[owner, which],
            reach=sliders.reach[owner, which],
            points=points,
            many=many,
            begin=_both(lambda i: (motion.slip[i][0] - start.slip[:, i])[owner] + start.stretch[owner, which, i]),
            stretch=_both(lambda _: np.empty((len(motion.to_time), len(owner)))),
        )

    def only(self, kept: Index) -> Self:
        """Some of the sliders, at the last instant of the cycle."""

        def last(direction: int) -> Array:
            old = self.stretch[direction]
            new = np.empty((len(old), len(kept)))
            new[-1] = old[-1, kept]
            return new

        points, many = np.unique(self.owner[kept], return_counts=True)
        some = {name: getattr(self, name)[kept] for name in ("owner", "which", "onset", "k", "reach")}
        return replace(
            self,
            **some,
            points=points,
            many=many,
            begin=_both(lambda i: self.begin[i][kept]),
            stretch=_both(last),
        )

    def turn(self, motion: CycleMotion, *, first: bool, memory: "Anchors | None") -> Mask:
        """Take them round the cycle once, the first time from the start; return which slid."""
        slid = np.zeros(len(self.k), dtype=bool)
        approach = motion.approach[:, self.points]
        steps = _both(lambda i: np.diff(motion.slip[i], axis=0, prepend=motion.slip[i][-1:])[:, self.points])
        for t in range(len(approach)):
            depth = np.repeat(approach[t], self.many)
            depth -= self.onset
            np.maximum(depth, 0.0, out=depth)
            one, two = self.stretch[0][t], self.stretch[1][t]
            if first and t == 0:
                one[:], two[:] = self.begin
            else:
                np.add(self.stretch[0][t - 1], np.repeat(steps[0][t], self.many), out=one)
                np.add(self.stretch[1][t - 1], np.repeat(steps[1][t], self.many), out=two)
            size = one * one
            size += two * two
            np.sqrt(size, out=size)
            left = self.reach * depth
            left /= np.maximum(size, TINY)
            slides = left < 1
            if memory is not None and slides.any():
                memory.slide(t, np.flatnonzero(slides), (one, two), size, left, depth)
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
class Anchors:
    """Derivatives of the anchors by the coefficients of opening and of both slips.

    A slider's stretch is slip minus anchor. The anchor moves only while it slides, so its derivative does. Along the
    direction n of the last slide it depends on that instant alone: n times (reach, n1, n2) times the waves then. So
    those parts are summed over the sliders of a point by instant, `carried` (samples, 5, points). Across n it remembers
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
    carried: Array | None = None
    history: Array | None = None

    @classmethod
    def start(cls, to_time: Array, sliders: MarchingSliders, local: Index) -> "Anchors":
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

    def listening(self, kept: Index, sliders: MarchingSliders, local: Index, first: Index) -> "Anchors":
        """Some of the sliders, of which the derivative of the forces that a point's anchors hold together is kept."""
        samples, count = self.to_time.shape
        found = replace(
            self,
            k=sliders.k,
            reach=sliders.reach,
            local=local,
            first=first,
            along=self.along[:, kept],
            when=self.when[kept],
            across=self.across[..., kept],
            carried=np.zeros((samples, 5, len(first))),
            history=np.empty((samples, count, 2, 3, len(first))),
        )
        found._add_carried(np.arange(len(kept)), found.along, 1.0)
        return found

    def _add_carried(self, which: Index, along: Array, sign: float) -> None:
        """Add or take away what sliders hold along their last slide: (n1 reach, n2 reach, n1 n1, n1 n2, n2 n2)."""
        assert self.carried is not None
        n1, n2, reach = along
        points = len(self.first)
        place = self.when[which] * (5 * points) + self.local[which]
        one, two = (sign * self.k[which] * n for n in (n1, n2))
        for i, force in enumerate((one * reach, two * reach, one * n1, one * n2, two * n2)):
            np.add.at(self.carried.reshape(-1), place + i * points, force)

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
        slipped = 1 - left
        across = self.across.take(which, axis=-1)
        across *= _single(left * (new[0] * old[0] + new[1] * old[1]))
        for i, by in enumerate((old[2], old[0], old[1])):
            across[:, i] += _single(turn * by) * then
        across[:, 1] -= _single(slipped * new[1]) * now
        across[:, 2] += _single(slipped * new[0]) * now
        self.across[..., which] = across
        if self.carried is not None:
            self._add_carried(which, old, -1.0)
        self.along[:, which] = new
        self.when[which] = t
        if self.carried is not None:
            self._add_carried(which, new, 1.0)

    def read(self, t: int) -> None:
        """Note the derivative at an instant."""
        assert self.carried is not None
        assert self.history is not None
        samples, count = self.to_time.shape
        carried = (self.to_time.T @ self.carried.reshape(samples, -1)).reshape(count, 5, -1)
        now = self.history[t]
        now[:, 0], now[:, 1] = carried[:, [0, 2, 3]], carried[:, [1, 3, 4]]
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
