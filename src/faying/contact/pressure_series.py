"""The contacts of one map at rising pressures, at three resolutions, and what they say of each other.

The map on a quarter of the points each way is solved at every pressure, the map itself and its half at a few of them:
a quantity of the map is that of the quarter plus two differences, which change little from one pressure to the next
and are interpolated. Where the closing that this predicts differs from the solved one, more pressures are solved
between.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from heapq import heappop, heappush
from math import inf, isfinite, log, nan, sqrt
from pathlib import Path
from typing import Protocol, final

import numpy as np

from faying.cache import kept
from faying.errors import NotConverged
from faying.halfspace.solution import HalfSpaceContact
from faying.halfspace.solve import halved_map
from faying.typing import Array

STRIDE = 4  # a large map itself is solved at every fourth pressure first
MAX_MISS = 0.015  # miss of a predicted closing, over what a threefold pressure closes, at which no pressure is added
MAX_MISS_ALONE = 0.01  # the same of a map whose curve no coarser map carries
SHAPE = 600  # points a side from which on the map on a quarter of them may carry the shape of the curves
MIN_PRESSURE_RATIO = 1.08  # least factor between two pressures
COLUMNS = 8, 60  # pressures at which the map itself may be solved: at least and at most, and between them
MAX_POINTS = 3e6  # as many as make this number of points together
EDGES = 6  # the quarters of the window are solved at every sixth pressure
GROWTH = 2.5  # four times the points each way are two doublings; a quarter on top of what the last ones changed
# a range wider than this says no more: next to full contact the stiffness of a map has no limit
MAX_LOG_RANGE = log(1e3)
ALIKE = 0.75  # correlation; an odd number of rows leaves half of what the next row differs by
MIN_CELLS = 16  # on the side of a quarter of the window
HARDNESS_DOUBT = 1.35  # factor either way: scatter of Brinell hardness of one steel, and of small indentations
STORED = 6  # version of what the cache holds


class Solve(Protocol):
    """Solves one map at one pressure [Pa], from an earlier contact of it."""

    def __call__(
        self,
        heights: Array,
        spacing: tuple[float, float],
        pressure: float,
        *,
        start: HalfSpaceContact | None,
        harder: float = 1.0,
    ) -> HalfSpaceContact:
        """Return the contact; `harder` multiplies the hardness."""


Numbers = Callable[[HalfSpaceContact, bool], dict[str, float]]
Map = tuple[Array, tuple[float, float]]


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class PressureSeries:
    """Numbers of the contact at rising pressures.

    Args:
        pressure: [Pa] (n,).
        values: positive numbers by name (n,), on the full map; k_n is the stiffness on unloading.
        closing: how far the plane lies below the mean height [m] (n,), growing: the loading curve.
        spots: how many spots touch (n,).
        coarse: share of the stiffness that rests on spots of fewer than 4 points [-] (n,).
        change: of ln k_n from half of the points each way to all, and from a quarter to half [-] (2, n).
        change_loading: the same of the slope of the loading curve [-] (2, n).
        window: standard error of ln k_n that comes from the size of the window [-] (n,).
        doubt: change of ln k_n with a hardness of 1.35 times and of 1/1.35 times as much [-] (n,), the larger.
        solved: at which pressures the map itself was solved (m,).
    """

    pressure: Array
    values: Mapping[str, Array]
    closing: Array
    spots: Array
    coarse: Array
    change: Array
    change_loading: Array
    window: Array
    doubt: Array
    solved: Array

    def _error(self, loading: bool) -> tuple[Array, Array]:
        change = np.abs(self.change_loading if loading else self.change).max(axis=0)
        return change, np.hypot(self.window, self.doubt)

    def least_factor(self, *, loading: bool) -> Array:
        """Lower end of the range of k_n over k_n [-] (n,), of one of its two branches."""
        change, other = self._error(loading)
        return np.asarray(np.exp(-np.minimum(change + other, MAX_LOG_RANGE)))

    def greatest_factor(self, *, loading: bool) -> Array:
        """Upper end of the range of k_n over k_n [-] (n,): four times the points each way, at the larger rate seen."""
        change, other = self._error(loading)
        return np.asarray(np.exp(np.minimum(GROWTH * change + other, MAX_LOG_RANGE)))


def solve_series(
    heights: Array,
    spacing: tuple[float, float],
    pressure: Array,
    solve: Solve,
    numbers: Numbers,
    progress: Callable[[int, int], object] | None = None,
    *,
    sized: bool = False,
) -> PressureSeries:
    """Solve a map at rising pressures.

    Args:
        heights: [m] (ny, nx), complete and levelled; spacing (dx, dy) [m].
        pressure: [Pa] (n,), n >= 4.
        solve: solves a map at a pressure.
        numbers: positive numbers of a contact, k_n among them; with True also those that take longer.
        progress: called with (solutions done, solutions in all), of which the second grows where pressures are added.
        sized: whether `solve` takes a factor of the hardness.

    Returns:
        The series, up to the last pressure at which some point of every map is open.
    """
    series = _Levels(heights, spacing, np.asarray(pressure), solve, numbers, progress)
    series.solve_all()
    if len(series.grid()) < 2:
        raise NotConverged(
            f"every point of the scan touches from {series.top():.4g} Pa on: it has no roughness that a joint feels; "
            "check the unit of its heights"
        )
    series.refine()
    found = series.joined(sized)
    if progress is not None:
        progress(series.done, series.done)
    return found


@dataclass(eq=False)
class _Levels:
    """What is known of the map and of its coarser versions while they are solved; level 0 is the map itself.

    `rows` holds for each level the numbers of the contact by pressure [Pa].
    """

    heights: Array
    spacing: tuple[float, float]
    pressure: Array
    solve: Solve
    numbers: Numbers
    progress: Callable[[int, int], object] | None
    rows: list[dict[float, dict[str, float]]] = field(default_factory=lambda: [{}, {}, {}])
    done: int = 0
    kept: dict[float, HalfSpaceContact] = field(default_factory=dict)  # of the coarsest map, at the few pressures

    def __post_init__(self) -> None:
        self.maps: list[Map] = [(self.heights, self.spacing)]
        for _ in self.rows[1:]:
            self.maps.append(halved_map(*self.maps[-1]))
        self.large = self.heights.size > 256**2
        # the coarser maps of a small one are too unlike it to carry the shape of its curves
        self.alone = self.heights.size < SHAPE**2
        self.detailed = len(self.maps) - 1 if self.large else 0
        n, stride = len(self.pressure), STRIDE if self.large else 1
        while stride > 1 and (n - 1) // stride < 3:
            stride //= 2
        self.first = [float(self.pressure[i]) for i in sorted({*range(0, n, stride), n - 1})]
        edges = max(EDGES * (n - 1) // 24, 1)
        self.few = [float(self.pressure[i]) for i in sorted({*range(0, n, edges), n - 1})]
        self.parts = quarters(*self.maps[1 if self.large else 0])
        self.twofold = is_twofold(self.heights)
        if self.twofold:
            self.parts = self.parts[:2]
        self.total = (0 if self.alone else n + n // 4) + 3 * len(self.first) + len(self.parts) * len(self.few)

    def _solved(self, on: Map, p: float, start: HalfSpaceContact | None, harder: float = 1.0) -> HalfSpaceContact:
        contact = self.solve(*on, p, start=start, harder=harder)
        self.done += 1
        if self.progress is not None:
            self.total = max(self.total, self.done)
            self.progress(self.done, self.total)
        return contact

    def _record(self, level: int, p: float, contact: HalfSpaceContact, detail: bool) -> None:
        row = self.numbers(contact, detail) | {"closing": contact.closing}
        if level == 0:
            spots = contact.spots
            row |= {"spots": float(spots.count), "coarse": spots.share_below(4)}
        self.rows[level][p] = row

    def _column(self, p: float, coarsest: HalfSpaceContact | None) -> None:
        """Solve all maps at one pressure, each from the next coarser one."""
        last = len(self.maps) - 1
        contact = coarsest or self._solved(self.maps[last], p, None)
        self._record(last, p, contact, last == self.detailed)
        for level in range(last - 1, -1, -1):
            contact = self._solved(self.maps[level], p, contact)
            self._record(level, p, contact, level == self.detailed)

    def solve_all(self) -> None:
        """The coarsest map at every pressure, the finer ones at the first few."""
        last, contact = len(self.maps) - 1, None
        for i, p in enumerate(map(float, self.pressure)):
            if self.alone and p not in self.first:
                continue
            contact = self._solved(self.maps[last], p, contact)
            if p in self.few:
                self.kept[p] = contact
            if p in self.first:
                self._column(p, contact)
                continue
            self._record(last, p, contact, False)
            if i % 2 == 0:
                self._record(1, p, self._solved(self.maps[1], p, contact), False)

    def refine(self) -> None:
        """Solve more pressures where the closing between solved ones is not predicted well, the worst first."""
        top = self.top()
        at = [p for p in self.first if p < top]
        triples = list(zip(at, at[1:], at[2:], strict=False))
        if not self.alone:  # the coarsest map carries the shape of the curves where that predicts them better
            carried = sum(self._miss(*three) for three in triples)
            self.alone = True
            self.alone = sum(self._miss(*three) for three in triples) < carried
        many, few = COLUMNS[1], COLUMNS[0]
        most = many if self.alone else min(max(int(MAX_POINTS / self.heights.size), few), many)
        close = MAX_MISS_ALONE if self.alone else MAX_MISS
        waiting: list[tuple[float, float, float]] = []
        seen: set[tuple[float, float]] = set()

        def split(a: float, b: float, miss: float) -> None:
            if miss > close and b / a > MIN_PRESSURE_RATIO**2 and (a, b) not in seen:
                seen.add((a, b))
                heappush(waiting, (-miss, a, b))

        def judge(a: float, b: float, c: float) -> None:
            miss = self._miss(a, b, c)
            split(a, b, miss)
            split(b, c, miss)

        for a, b, c in triples:
            judge(a, b, c)
        while waiting and len(self.rows[0]) < most:
            _, a, b = heappop(waiting)
            middle = self._between_solved(a, b)
            self._column(middle, None)
            judge(a, middle, b)

    def _between_solved(self, a: float, b: float) -> float:
        """A pressure near the geometric mean of two; one at which the coarsest map is solved where there is one."""
        middle = sqrt(a * b)
        near = [p for p in self.rows[-1] if a < p < b and abs(log(p / middle)) < 0.1 * log(b / a)]
        return min(near, key=lambda p: abs(log(p / middle)), default=middle)

    def _miss(self, a: float, b: float, c: float) -> float:
        """Miss of the closing at b predicted from all other pressures, over what a threefold pressure closes [-]."""
        rows = self.rows[0]
        if self.alone:
            predicted = float(_between(*self._curve(0, "closing", b), np.log([b]))[0])
        else:
            predicted = float(self._on_all("closing", without=b)[0][np.searchsorted(self.grid(), b)])
        threefold = (rows[c]["closing"] - rows[a]["closing"]) * max(1.0, log(3) / log(c / a))
        return abs(predicted - rows[b]["closing"]) / max(threefold, 1e-300)

    def top(self) -> float:
        """The least pressure at which every point of a map touches; infinite where there is none."""
        return min((p for level in self.rows for p, row in level.items() if not np.isfinite(row["k_n"])), default=inf)

    def grid(self) -> Array:
        """The pressures of the result, below that at which every point touches.

        Those of the coarsest map where it carries the shape of the curves, else those of the map itself.
        """
        top = self.top()
        return np.array([p for p in sorted(self.rows[0 if self.alone else -1]) if p < top])

    def _where(self, level: int, name: str, without: float | None = None) -> list[float]:
        """The pressures at which a number of one map is known."""
        top, rows = self.top(), self.rows[level]
        among = self.rows[0] if self.alone else rows
        return [p for p in sorted(among) if p < top and p != without and name in rows.get(p, {})]

    def _curve(self, level: int, name: str, without: float | None = None) -> tuple[Array, Array]:
        """ln pressure, and a number of one map where it is known."""
        at = self._where(level, name, without)
        return np.log(at), np.array([self.rows[level][p][name] for p in at])

    def _on_all(self, name: str, *, without: float | None = None, logarithm: bool = False) -> list[Array]:
        """A number, or its logarithm, on each map at all pressures, from the map itself to the coarsest.

        The coarsest is known at all of them; each finer one is the coarser one plus their difference, interpolated.
        """
        x = np.log(self.grid())
        known: list[Array] = []
        for level in range(len(self.maps) - 1, -1, -1):
            at, values = self._curve(level, name, without if known else None)
            values = np.log(values) if logarithm else values
            if known:
                coarser = known[-1]
                values = coarser + _between(at, values - np.interp(at, x, coarser), x)
            known.append(values)
        return known[::-1]

    def joined(self, sized: bool) -> PressureSeries:
        """Put the maps together."""
        x = np.log(self.grid())
        full, half, coarse = self._on_all("k_n", logarithm=True)
        names = set(next(iter(self.rows[1].values()))) - {"k_n", "closing"}
        values = {name: np.exp(self._on_all(name, logarithm=True)[0]) for name in names} | {"k_n": np.exp(full)}
        detail = set().union(*self.rows[self.detailed].values()) - {*values, "closing", "spots", "coarse"}
        for name in detail:
            at, own = self._curve(self.detailed, name)
            over = {"k_t": "k_n", "energy_t": "energy_n"}.get(name)
            if over is None:
                values[name] = _between(at, own, x)
            else:
                rows = self.rows[self.detailed]
                base = np.array([rows[p][over] for p in self._where(self.detailed, name)])
                values[name] = np.exp(_between(at, np.log(own / base), x)) * values[over]
        closings = self._on_all("closing")
        if np.any(np.diff(closings[0]) <= 0):  # the differences of the maps outweigh the closing: the map alone
            closings[0] = np.maximum.accumulate(_between(*self._curve(0, "closing"), x))
        slopes = [np.log(np.maximum(np.gradient(c, x), 1e-300)) for c in closings]
        at, count = self._curve(0, "spots")
        spots = np.exp(_between(at, np.log(count), x))
        window = self._spread(half if self.large else full)
        return PressureSeries(
            pressure=self.grid(),
            values=values,
            closing=closings[0],
            spots=spots,
            coarse=_between(*self._curve(0, "coarse"), x),
            change=np.stack([full - half, half - coarse]),
            change_loading=np.stack([slopes[1] - slopes[0], slopes[2] - slopes[1]]),
            window=np.sqrt(window**2 + (2 if self.twofold else 1) / spots),
            doubt=self._hardness_doubt() if sized else np.zeros(len(x)),
            solved=np.array(self._where(0, "spots")),
        )

    def _log_k_n(self, contact: HalfSpaceContact) -> float:
        """ln k_n of a contact; NaN where all touches."""
        k_n = self.numbers(contact, False)["k_n"]
        return log(k_n) if isfinite(k_n) else nan

    def _chain(self, on: Map) -> Array:
        """ln k_n of one map at the few pressures; NaN where all touches."""
        contact, out = None, []
        for p in self.few:
            contact = self._solved(on, p, contact)
            out.append(self._log_k_n(contact))
        return np.array(out)

    def _over_all(self, values: Array) -> Array:
        """A number of the few pressures at all of them, linear in ln p; 0 where none is known."""
        good = np.isfinite(values) & (np.array(self.few) < self.top())
        x = np.log(self.grid())
        return np.asarray(np.interp(x, np.log(self.few)[good], values[good])) if good.any() else np.zeros(x.shape)

    def _spread(self, full: Array) -> Array:
        """Standard error of ln k_n from the quarters of the window, and how far their mean is from the full one."""
        if not self.parts:
            return np.zeros(full.shape)
        logs = np.stack([self._chain(part) for part in self.parts])
        error = logs.std(axis=0, ddof=1) / np.sqrt(len(self.parts))
        off = logs.mean(axis=0) - np.interp(np.log(self.few), np.log(self.grid()), full)
        return self._over_all(np.hypot(error, off))

    def _hardness_doubt(self) -> Array:
        """Change of ln k_n of the coarsest map with a harder and a softer metal, the larger, at all pressures."""
        coarsest, changes = self.maps[-1], []
        for p in self.few:
            base = self.kept.get(p) or self._solved(coarsest, p, None)
            carried = [f for f in (HARDNESS_DOUBT, 1 / HARDNESS_DOUBT) if p <= f * self.few[-1]]
            logs = [self._log_k_n(self._solved(coarsest, p, base, f)) for f in carried]
            changes.append(np.fmax.reduce(np.abs(np.array(logs) - self._log_k_n(base))))
        return self._over_all(np.array(changes))


def _between(x: Array, y: Array, at: Array) -> Array:
    from scipy.interpolate import PchipInterpolator

    return np.asarray(PchipInterpolator(x, y)(at)) if len(x) > 1 else np.full(at.shape, y[0])


def monotone(x: Array, values: Array) -> Callable[[Array], Array]:
    """A monotone cubic through the logarithms where all values are positive, through the values else."""
    from scipy.interpolate import PchipInterpolator

    if not np.all(values > 0):
        return lambda at: np.asarray(PchipInterpolator(x, values)(at))
    curve = PchipInterpolator(x, np.log(values))
    return lambda at: np.asarray(np.exp(curve(at)))


def is_twofold(heights: Array) -> bool:
    """Whether a map is its own mirror image, shifted by half a side, as one laid on its like is.

    Its halves then have the same contacts, and its four quarters are two.
    """
    rows = heights.shape[0] // 2
    first, second = heights[:rows], heights[heights.shape[0] - rows :, ::-1]
    size = float(first.std() * second.std())
    return size > 0 and float(((first - first.mean()) * (second - second.mean())).mean()) > ALIKE * size


def quarters(heights: Array, spacing: tuple[float, float]) -> list[tuple[Array, tuple[float, float]]]:
    """The four quarters of a map, each levelled, two beside each other first; none if below 16 points a side."""
    rows, columns = (n // 2 for n in heights.shape)
    if min(rows, columns) < MIN_CELLS:
        return []
    out = []
    y, x = np.meshgrid(np.linspace(-1, 1, rows), np.linspace(-1, 1, columns), indexing="ij")
    for top in (0, heights.shape[0] - rows):
        for left in (0, heights.shape[1] - columns):
            part = heights[top : top + rows, left : left + columns]
            part = part - part.mean()
            part = part - x * ((x * part).mean() / (x * x).mean()) - y * ((y * part).mean() / (y * y).mean())
            out.append((part, spacing))
    return out


def cached(
    make: Callable[[], PressureSeries], folder: Path | None, key: Mapping[str, object], heights: Array
) -> PressureSeries:
    """Return a series from the cache, or make it and keep it there.

    Args:
        make: solves it.
        folder: where it is kept; see `faying.cache.kept`.
        key: all that the series depends on beside the heights [m].
    """
    own = [f.name for f in fields(PressureSeries) if f.name != "values"]

    def arrays() -> dict[str, Array]:
        series = make()
        return {f"value_{name}": value for name, value in series.values.items()} | {
            name: getattr(series, name) for name in own
        }

    data = cached_numbers(arrays, folder, "half-space", key, heights)
    values = {name.removeprefix("value_"): array for name, array in data.items() if name.startswith("value_")}
    return PressureSeries(values=values, **{name: data[name] for name in own})


def cached_numbers(
    make: Callable[[], Mapping[str, Array]], folder: Path | None, kind: str, key: Mapping[str, object], heights: Array
) -> Mapping[str, Array]:
    """Return numbers of a map's contacts from the cache, or make them and keep them there, as `faying.cache.kept` does.

    Args:
        make, folder, kind: as `kept` takes them.
        key: all that the numbers depend on beside the heights [m].
    """
    text = repr(sorted(key.items())) + f" {STORED}"
    return kept(make, folder, kind=kind, key=text, data=np.ascontiguousarray(heights).tobytes())
