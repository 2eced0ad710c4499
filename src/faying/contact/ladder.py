"""The contacts of one map at rising pressures, at three resolutions, and what they say of each other.

A large map is solved at every fourth pressure only. Between them stands the map on half as many points each way, solved
at every second, and that on a quarter, solved at all: ln k_n(full) is ln k_n(quarter) plus the two differences. These
change little from one pressure to the next and are interpolated. A small map is solved everywhere.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import log
from pathlib import Path
from typing import Any, Protocol, final

import numpy as np

from faying.cache import kept
from faying.errors import NotConverged
from faying.halfspace.solution import HalfSpaceContact
from faying.halfspace.solve import halved_map
from faying.typing import Array

LARGE = 256  # points on the shorter side above which a map is not solved at every pressure
STRIDES = 4, 2, 1
GROWTH = 2.5  # four times the points each way are two doublings; a quarter on top of what the last ones changed
MOST = log(1e3)  # a range wider than this says no more: next to full contact the stiffness of a map has no limit
ALIKE = 0.75  # correlation; an odd number of rows leaves half of what the next row differs by
FEWEST_CELLS = 16  # on the side of a quarter of the window
STORED = 2  # version of what the cache holds


class Solve(Protocol):
    """Solves one map at one pressure [Pa], from an earlier contact of it."""

    def __call__(
        self, heights: Array, spacing: tuple[float, float], pressure: float, *, start: HalfSpaceContact | None
    ) -> HalfSpaceContact:
        """Return the contact."""


Numbers = Callable[[HalfSpaceContact, bool], dict[str, float]]


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Ladder:
    """Numbers of the contact at rising pressures.

    Args:
        pressure: [Pa] (n,).
        values: numbers by name (n,), on the full map.
        points: how many points touch (n,).
        change: of ln k_n from half of the points each way to all, and from a quarter to half [-] (2, n).
        window: standard error of ln k_n that comes from the size of the window [-] (n,).
    """

    pressure: Array
    values: Mapping[str, Array]
    points: Array
    change: Array
    window: Array

    @property
    def least_factor(self) -> Array:
        """Lower end of the range of k_n over k_n [-] (n,)."""
        return np.asarray(np.exp(-np.minimum(np.abs(self.change).max(axis=0) + self.window, MOST)))

    @property
    def greatest_factor(self) -> Array:
        """Upper end of the range of k_n over k_n [-] (n,): four times the points each way, at the larger rate seen."""
        return np.asarray(np.exp(np.minimum(GROWTH * np.abs(self.change).max(axis=0) + self.window, MOST)))


def climb(
    heights: Array,
    spacing: tuple[float, float],
    pressure: Array,
    solve: Solve,
    numbers: Numbers,
    progress: Callable[[int, int], object] | None = None,
) -> Ladder:
    """Solve a map at rising pressures.

    Args:
        heights: [m] (ny, nx), whole and levelled; spacing (dx, dy) [m].
        pressure: [Pa] (n,), n >= 4.
        solve: solves a map at a pressure.
        numbers: area, k_n, energy_n of a contact; with True also k_t, k_load and the losses.
        progress: called with (solutions done, solutions in all).

    Returns:
        The ladder, up to the last pressure at which some point of every map is open.
    """
    large = min(heights.shape) > LARGE
    maps = [(heights, spacing)]
    for _ in STRIDES[1:]:
        maps.append(halved_map(*maps[-1]))
    strides = STRIDES if large else (1, 1, 1)
    n = len(pressure)
    rungs = [_rungs(n, stride) for stride in strides]
    twofold = is_twofold(heights)
    parts = quarters(*maps[1 if large else 0])[: 2 if twofold else 4]
    few = _rungs(n, STRIDES[0])
    total = sum(map(len, rungs)) + len(parts) * len(few)
    detailed = len(maps) - 1 if large else 0
    rows: list[dict[int, dict[str, float]]] = [{} for _ in maps]
    pieces: list[dict[int, dict[str, float]]] = [{} for _ in parts]
    done = 0

    def solved(on: tuple[Array, tuple[float, float]], i: int, start: HalfSpaceContact | None) -> HalfSpaceContact:
        nonlocal done
        contact = solve(*on, float(pressure[i]), start=start)
        done += 1
        if progress is not None:
            progress(done, total)
        return contact

    def counted(contact: HalfSpaceContact, detail: bool) -> dict[str, float]:
        return numbers(contact, detail) | {"points": float(np.count_nonzero(contact.traction))}

    last = None
    for i in range(n):
        contact = last  # from the pressure before on the coarsest map, from the coarser map on the finer ones
        for level in reversed(range(len(maps))):
            if i in rungs[level]:
                contact = solved(maps[level], i, contact)
                rows[level][i] = counted(contact, level == detailed)
                last = contact if level == len(maps) - 1 else last
    for piece, part in zip(pieces, parts, strict=True):
        contact = None
        for i in few:
            contact = solved(part, i, contact)
            piece[i] = counted(contact, False)
    top = min(_closed(level, n) for level in rows)
    if top < 2:
        raise NotConverged(
            f"every point of the scan touches from {pressure[max(top - 1, 0)]:.4g} Pa on: it has no roughness that a "
            "joint feels; check the unit of its heights"
        )
    return _joined(np.asarray(pressure), rows, pieces, top, detailed, 2 if twofold else 1)


def _rungs(n: int, stride: int) -> list[int]:
    return sorted({*range(0, n, stride), n - 1})


def _closed(level: Mapping[int, Mapping[str, float]], n: int) -> int:
    """The first rung at which every point of a map touches; n where there is none."""
    return min((i for i, row in level.items() if not np.isfinite(row["k_n"])), default=n)


def _joined(
    pressure: Array, rows: list[dict[int, Any]], pieces: list[dict[int, Any]], top: int, detailed: int, copies: int
) -> Ladder:
    """Put the levels together: the coarsest at all pressures, each finer one by what it changes.

    copies: how often the map holds each contact.
    """
    p = pressure[:top]
    x = np.log(p)

    def curve(level: Mapping[int, Mapping[str, float]], name: str) -> Array:
        return np.array([level[i][name] for i in sorted(level) if i < top])

    def at(level: Mapping[int, Any]) -> Array:
        return np.array([i for i in sorted(level) if i < top])

    def on_all(name: str) -> list[Array]:
        """Logarithms of a positive number on each map, from the coarsest to the full one, at all pressures."""
        known = [np.log(curve(rows[-1], name))]
        for level in reversed(rows[:-1]):
            rungs = at(level)
            known.append(known[-1] + _between(x[rungs], np.log(curve(level, name)) - known[-1][rungs], x))
        return known

    coarse, half, full = on_all("k_n")
    values = {name: np.exp(on_all(name)[-1]) for name in ("area", "energy_n")} | {"k_n": np.exp(full)}
    base = {name: curve(rows[detailed], name) for name in rows[detailed][0]}
    for name in set(base) - {*values, "points"}:
        over = {"k_t": "k_n", "k_load": "k_n", "energy_t": "energy_n"}.get(name)
        values[name] = base[name] if over is None else base[name] / base[over] * values[over]
    points = np.exp(on_all("points")[-1])
    return Ladder(
        pressure=p,
        values=values,
        points=points,
        change=np.stack([full - half, half - coarse]),
        window=np.sqrt(_spread(pieces, x, at, curve, half if detailed else full) ** 2 + copies / points),
    )


def _between(x: Array, y: Array, at: Array) -> Array:
    from scipy.interpolate import PchipInterpolator

    return np.asarray(PchipInterpolator(x, y)(at)) if len(x) > 1 else np.full(at.shape, y[0])


def _spread(pieces: list[dict[int, Any]], x: Array, at: Any, curve: Any, whole: Array) -> Array:
    """Standard error of ln k_n from the quarters of the window, with what their mean lies beside the whole."""
    if not pieces:
        return np.zeros(x.shape)
    rungs = at(pieces[0])
    logs = np.log(np.stack([curve(piece, "k_n") for piece in pieces]))
    kept = rungs[np.all(np.isfinite(logs), axis=0)]
    if not len(kept):
        return np.zeros(x.shape)
    logs = logs[:, np.all(np.isfinite(logs), axis=0)]
    error = logs.std(axis=0, ddof=1) / np.sqrt(len(pieces))
    beside = logs.mean(axis=0) - whole[kept]
    return np.asarray(np.interp(x, x[kept], np.hypot(error, beside)))


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
    if min(rows, columns) < FEWEST_CELLS:
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


def cached(make: Callable[[], Ladder], folder: Path | None, key: Mapping[str, object], heights: Array) -> Ladder:
    """Return a ladder from the cache, or make it and keep it there.

    Args:
        make: solves it.
        folder: where it is kept; see `faying.cache.kept`.
        key: all that the ladder depends on beside the heights [m].
    """
    own = ("pressure", "points", "change", "window")

    def arrays() -> dict[str, Array]:
        ladder = make()
        return {f"value_{name}": value for name, value in ladder.values.items()} | {
            name: getattr(ladder, name) for name in own
        }

    data = cached_numbers(arrays, folder, "half-space", key, heights)
    values = {name.removeprefix("value_"): array for name, array in data.items() if name.startswith("value_")}
    return Ladder(values=values, **{name: data[name] for name in own})


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
