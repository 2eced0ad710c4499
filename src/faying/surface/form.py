"""Preparing heights: spikes and missing points found, counted and treated; levelling and form removal."""

from dataclasses import dataclass
from typing import Any, TypeVar, cast, final
from weakref import WeakKeyDictionary

import numpy as np

from faying.checks import whole
from faying.errors import InputError
from faying.surface.heights import AreaHeights, LineHeights, usable
from faying.typing import Array, Mask

Lines = TypeVar("Lines", bound=AreaHeights | LineHeights)

SPIKE = 12.0  # how many robust standard deviations above its neighbours' median makes a point a spike


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Prepared:
    """A scan ready for a statistic: no missing points, no spikes, form removed; with the counts of what was treated.

    `known` is False where the height was missing or a spike and has been filled in (same shape as the heights).
    """

    scan: Any
    known: Mask
    missing: int
    spikes: int


def _design(scan: AreaHeights | LineHeights, degree: int) -> list[Array]:
    """Monomials up to total `degree` over coordinates scaled to -1..1, each broadcastable to the heights' shape."""
    axes = [np.linspace(-1, 1, n) for n in scan.heights.shape]
    if len(axes) == 1:
        return [axes[0] ** k for k in range(degree + 1)]
    y, x = axes[0][:, None], axes[1][None, :]
    return [(x**i) * (y**j) for j in range(degree + 1) for i in range(degree + 1 - j)]


def check_degree(degree: object) -> None:
    """Raise InputError unless a polynomial of this degree can be taken out."""
    whole(degree, "degree", least=0, greatest=8)


def levelled(scan: Lines, degree: int = 1) -> Lines:
    """Subtract the least-squares polynomial of total degree `degree` (0 mean, 1 plane or line, 2.. form).

    Missing points take no part and stay missing. Raises InputError for degrees outside 0..8, or scans that do not
    hold enough points for the polynomial.
    """
    check_degree(degree)
    heights = scan.heights
    terms = _design(scan, degree)
    known = ~np.isnan(heights)
    if known.sum() < 2 * len(terms):
        raise InputError(f"{scan.source}: {int(known.sum())} known points cannot fix a polynomial of degree {degree}")
    offset = float(heights[known].mean())
    values = np.where(known, heights - offset, 0.0)
    size = len(terms)
    normal, right = np.empty((size, size)), np.empty(size)
    full = bool(known.all())
    for i, a in enumerate(terms):
        right[i] = np.sum(values * a)
        for j, b in enumerate(terms[: i + 1]):
            product = a * b
            # a separable product broadcast over the known points only
            count = np.sum(np.broadcast_to(product, heights.shape)) if full else np.sum(known * product)
            normal[i, j] = normal[j, i] = count
    weights = np.linalg.lstsq(normal, right, rcond=None)[0]
    form = sum((w * t for w, t in zip(weights, terms, strict=True)), start=np.zeros(heights.shape))
    return cast("Lines", scan.with_heights(heights - offset - form, f"levelled by a polynomial of degree {degree}"))


def filled(scan: Lines) -> Lines:
    """Fill missing points smoothly from their neighbours: coarse averages first, then relaxed to a harmonic fill.

    Isolated points get the mean of their four neighbours. Raises InputError when no point is known.
    """
    heights = scan.heights
    hole = np.isnan(heights)
    if not hole.any():
        return scan
    if hole.all():
        raise InputError(f"{scan.source}: every point is missing; nothing can be filled in")
    flat = heights[None, :] if heights.ndim == 1 else heights
    mask = hole[None, :] if heights.ndim == 1 else hole
    out = _pyramid(np.where(mask, 0.0, flat), (~mask).astype(float))
    rows, columns = np.nonzero(mask)
    up, down = np.maximum(rows - 1, 0), np.minimum(rows + 1, flat.shape[0] - 1)
    left, right = np.maximum(columns - 1, 0), np.minimum(columns + 1, flat.shape[1] - 1)
    for _ in range(30):
        if heights.ndim == 1:
            out[rows, columns] = (out[rows, left] + out[rows, right]) / 2
        else:
            out[rows, columns] = (out[up, columns] + out[down, columns] + out[rows, left] + out[rows, right]) / 4
    return cast("Lines", scan.with_heights(out.reshape(heights.shape), f"{int(hole.sum())} missing points filled in"))


def _pyramid(values: Array, weight: Array) -> Array:
    """Replace points of weight 0 by the weighted mean of the smallest block of 2^k that holds a known point."""
    if (weight > 0).all():
        return values / weight if (weight != 1).any() else values.copy()
    rows, columns = values.shape
    pad = ((0, rows % 2 if rows > 1 else 0), (0, columns % 2 if columns > 1 else 0))
    v, w = np.pad(values, pad), np.pad(weight, pad)
    for axis in (0, 1):
        if v.shape[axis] > 1:
            even, odd = [slice(None)] * 2, [slice(None)] * 2
            even[axis], odd[axis] = slice(0, None, 2), slice(1, None, 2)
            v, w = v[tuple(even)] + v[tuple(odd)], w[tuple(even)] + w[tuple(odd)]
    coarse = _pyramid(v, w)
    for axis in (0, 1):
        if values.shape[axis] > 1:
            coarse = np.repeat(coarse, 2, axis=axis)
    return np.where(weight > 0, values / np.where(weight > 0, weight, 1.0), coarse[:rows, :columns])


def find_spikes(scan: AreaHeights | LineHeights) -> Mask:
    """Mark single points that stand out from the median of their neighbours (5 points of a line, 3 x 3 of a scan).

    A point is a spike where it differs from that median by more than `SPIKE` times the robust standard deviation
    (1.4826 times the median of the absolute differences, or a quarter of the median step if more) and by more than
    `SPIKE` times the mean difference in the 15 points (15 x 15) around it. Missing points are never spikes.
    """
    from scipy.ndimage import median_filter, uniform_filter

    hole = np.isnan(scan.heights)
    heights = filled(scan).heights
    away = np.abs(heights - median_filter(heights, size=5 if heights.ndim == 1 else 3, mode="nearest"))
    # on smooth heights the median differs from the point at crests alone, so the step between neighbours sets a floor
    steps = np.concatenate([np.abs(np.diff(heights, axis=axis)).ravel() for axis in range(heights.ndim)])
    positive = away[(away > 0) & ~hole]
    if positive.size == 0:
        return np.zeros(hole.shape, bool)
    scale = max(1.4826 * float(np.median(positive)), 0.25 * float(np.median(steps)))
    candidates = (away > SPIKE * scale) & ~hole
    if not candidates.any():
        return np.zeros(hole.shape, bool)
    # a rough patch is not a spike: compare with the mean difference around, single large ones cut down to the threshold
    around = uniform_filter(np.minimum(away, SPIKE * scale), size=15, mode="nearest")
    return np.asarray(candidates & (away > SPIKE * around), bool)


_PREPARED: WeakKeyDictionary[AreaHeights | LineHeights, dict[tuple[int, bool], Prepared]] = WeakKeyDictionary()


def prepared(scan: AreaHeights | LineHeights, *, degree: int = 1, spikes: bool = True) -> Prepared:
    """Level a scan, treat spikes as missing points (unless spikes=False), fill all missing points, count both.

    Raises InputError when more than half the points are missing, all heights are equal, or there are under 16 points
    each way. What was prepared is kept as long as the scan is.
    """
    check_degree(degree)
    made = _PREPARED.setdefault(scan, {})
    if (degree, spikes) not in made:
        made[degree, spikes] = _prepared(scan, degree, spikes)
    return made[degree, spikes]


def _prepared(scan: AreaHeights | LineHeights, degree: int, spikes: bool) -> Prepared:
    usable(scan)
    missing = scan.missing
    level: AreaHeights | LineHeights = levelled(scan, degree)
    found = find_spikes(level) if spikes else np.zeros(scan.heights.shape, bool)
    count = int(found.sum())
    if count:
        cleaned = scan.with_heights(np.where(found, np.nan, scan.heights), f"{count} spikes taken out")
        level = levelled(cleaned, degree)
    known = ~np.isnan(level.heights)
    known.setflags(write=False)
    usable(level)
    return Prepared(scan=filled(level), known=known, missing=missing, spikes=count)
