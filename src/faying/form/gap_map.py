"""Measured form: the gap between two faces, or the heights of one, laid on a joint as its gap before any load."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from faying.columns import Wanted, read_list
from faying.errors import InputError
from faying.file_kinds import kind_of
from faying.form.face_axes import FaceAxes
from faying.form.fit import minimum_zone
from faying.misuse import checked_call, numbers
from faying.style import Summary
from faying.typing import Array

MAX_PLACES = 150  # places kept along each side of a scan: roughness is the law's, and is averaged out of the form


def _summary(name: str, places: Array, what: str, values: Array) -> tuple[str, dict[str, str]]:
    """A heading, and size and range of a map of values [m] at places (n, 2) [m]."""
    width, length = 1e3 * np.ptp(places, axis=0)
    low, high = 1e6 * np.nanmin(values), 1e6 * np.nanmax(values)
    size = f"{width:.4g} x {length:.4g} mm"
    return f"{name} of {len(places)} points", {"size": size, what: f"{low:.4g} to {high:.4g} um"}


@checked_call
@dataclass(frozen=True, kw_only=True, repr=False)
class GapMap(Summary):
    """Measured gaps between two faces, before any load.

    Args:
        places: (n, 2) [m], in the plane of the map.
        gaps: (n,) [m]; NaN are left out, and of several at one place the mean is taken.
        origin: (3,) [m], where x = y = 0 lies in the structure.
        x_axis, y_axis: directions (3,) of the map's axes.

    Raises:
        InputError: for fewer than four points with numbers, and for points on one line.
    """

    places: Array
    gaps: Array
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    x_axis: tuple[float, float, float] = (1.0, 0.0, 0.0)
    y_axis: tuple[float, float, float] = (0.0, 1.0, 0.0)

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and size and range of the map."""
        return _summary("GapMap", self.places, "gaps", self.gaps)

    def __post_init__(self) -> None:
        places = numbers(self.places, "places", "points", 2)
        gaps = numbers(self.gaps, "gaps", len(places))
        good = np.isfinite(gaps) & np.isfinite(places).all(axis=1)
        places, gaps = places[good], gaps[good]
        if len(gaps) < 4:
            raise InputError(f"the map has {len(gaps)} points with numbers; a map needs four or more")
        spread = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
        if spread[1] < 1e-9 * spread[0]:
            raise InputError("the points of the map are on one line; a map covers an area, with x and y both varying")
        once, where, counts = np.unique(places, axis=0, return_inverse=True, return_counts=True)
        if len(once) < len(places):
            places, gaps = once, np.bincount(where.ravel(), gaps) / counts
        object.__setattr__(self, "places", places)
        object.__setattr__(self, "gaps", gaps)

    def at(self, positions: Array) -> Array:
        """Gap [m] at positions (q, 3) [m]: linear between the points of the map, the nearest point's outside them."""
        from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator

        axes = np.stack([np.array(axis) / np.linalg.norm(axis) for axis in (self.x_axis, self.y_axis)])
        if abs(axes[0] @ axes[1]) > 1e-6:
            raise InputError("the axes of the map are not at right angles; give x_axis and y_axis that are")
        local = (positions - np.array(self.origin)) @ axes.T
        low, high = self.places.min(axis=0), self.places.max(axis=0)
        outside = np.any((local < low - 0.25 * (high - low)) | (local > high + 0.25 * (high - low)), axis=1)
        if outside.mean() > 0.2:
            raise InputError(
                f"{outside.mean():.0%} of the joint is far from the map, which covers {_box(low, high)} while "
                f"the joint is at {_box(local.min(axis=0), local.max(axis=0))}; check origin, axes and units"
            )
        inside = LinearNDInterpolator(self.places, self.gaps)(local)
        return np.asarray(np.where(np.isfinite(inside), inside, NearestNDInterpolator(self.places, self.gaps)(local)))


def _box(low: Array, high: Array) -> str:
    return " x ".join(f"{1e3 * a:.4g} to {1e3 * b:.4g} mm" for a, b in zip(low, high, strict=True))


@checked_call
@dataclass(frozen=True, kw_only=True, repr=False)
class FaceMap(Summary):
    """Measured heights of one face, its form: the higher, the nearer to the other face.

    Args:
        places: Where the heights were measured (n, 2) [m], in the instrument's own axes; seen from outside the face x
            goes to the right and y up, unless y_axis says otherwise.
        heights: Heights out of the face (n,) [m]; NaN are left out. Tilt and offset are those of the instrument and do
            not count: depths are taken from the upper plane of the minimum zone.
        origin: Where x = y = 0 lies in the model (3,) [m]; None puts the middle of the map on the middle of the joint.
        x_axis, y_axis: Directions of x and y in the model (3,); None takes the longer side of the joint as x, and the y
            that an observer outside the face sees.

    Raises:
        InputError: Fewer than four points, or points on one line.
    """

    places: Array
    heights: Array
    origin: tuple[float, float, float] | None = None
    x_axis: tuple[float, float, float] | None = None
    y_axis: tuple[float, float, float] | None = None

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and size and range of the map."""
        return _summary("FaceMap", self.places, "heights", self.heights)

    def __post_init__(self) -> None:
        checked = GapMap(places=self.places, gaps=self.heights)
        object.__setattr__(self, "places", checked.places)
        object.__setattr__(self, "heights", checked.gaps)

    def placed(self, axes: FaceAxes, outward: Array) -> GapMap:
        """Return the depths below the highest plane on a joint with these axes; outward (3,): normal of this face."""
        if self.x_axis is None:
            axes.check("a map without x_axis")
        x = axes.x_axis if self.x_axis is None else np.array(self.x_axis)
        y = np.cross(outward, x) if self.y_axis is None else np.array(self.y_axis)
        if self.origin is None:
            middle = (self.places.min(axis=0) + self.places.max(axis=0)) / 2
            origin = axes.origin - (middle[0] * x / np.linalg.norm(x) + middle[1] * y / np.linalg.norm(y))
        else:
            origin = np.array(self.origin)
        depth = minimum_zone(self.places, self.heights).depth(self.places, self.heights)
        return GapMap(places=self.places, gaps=depth, origin=_three(origin), x_axis=_three(x), y_axis=_three(y))


def _three(vector: Array) -> tuple[float, float, float]:
    return float(vector[0]), float(vector[1]), float(vector[2])


def read_gap_map(
    path: Path,
    *,
    xy_unit: str | None,
    gap_unit: str | None,
    origin: tuple[float, float, float],
    x_axis: tuple[float, float, float],
    y_axis: tuple[float, float, float],
) -> GapMap:
    """Read three columns x, y, gap; a heading may name them in any order and state units, else both are given."""
    gap = Wanted(names=("gap",), unit="m", given=gap_unit, key="gap_unit")
    places, gaps = _points(path, xy_unit, gap, "a gap map has the columns x, y, gap")
    return GapMap(places=places, gaps=gaps, origin=origin, x_axis=x_axis, y_axis=y_axis)


def _points(path: Path, xy_unit: str | None, z: Wanted, form: str) -> tuple[Array, Array]:
    """Places (n, 2) [m] and values (n,) [m] of a list of points x, y, z."""
    x, y = (Wanted(names=(name,), unit="m", given=xy_unit, key="xy_unit") for name in "xy")
    table = read_list(path, (x, y, z), form)
    refuse_lonely(table[:, :2], table[:, 2], path.name)
    return table[:, :2], table[:, 2]


def read_heights(
    path: Path,
    *,
    xy_unit: str | None = None,
    z_unit: str | None = None,
    channel: str | None = None,
    is_gap: bool = False,
) -> tuple[Array, Array]:
    """Read measured form: places (n, 2) [m] and heights, or gaps, (n,) [m].

    A text of numbers holds three columns x, y, z, anywhere; a heading may name them in any order and
    state their units, else both are given. Any other is a scan, whose spikes are left out and which is averaged over
    cells to at most `MAX_PLACES` places along each side; units are given where it states none, and the channel where
    it holds several maps. Raises InputError and ReadError.
    """
    kind = kind_of(path, "numbers")
    if kind is not None and "numbers" in kind.serves:
        names = ("gap", "z") if is_gap else ("z", "height", "heights")
        z = Wanted(names=names, unit="m", given=z_unit, key="z_unit")
        return _points(path, xy_unit, z, "a list of measured points has the columns x, y, z")
    from faying.surface.files.read import read_scan
    from faying.surface.form import find_spikes, levelled

    scan: Any = read_scan(path, xy_unit=xy_unit, z_unit=z_unit, channel=channel)
    if scan.heights.ndim != 2:
        raise InputError(f"{path.name} is a profile; the form of a face takes an areal scan or a list of points")
    spikes = find_spikes(levelled(scan))
    return _averaged(scan.with_heights(np.where(spikes, np.nan, scan.heights), "spikes left out"))


def _averaged(scan: Any) -> tuple[Array, Array]:
    """Places (n, 2) and mean heights (n,) of cells of a scan; cells without a known point are left out."""
    rows, columns = (np.minimum(np.arange(n) * min(n, MAX_PLACES) // n, MAX_PLACES - 1) for n in scan.shape)
    shape = rows[-1] + 1, columns[-1] + 1
    cell = (rows[:, None] * shape[1] + columns[None, :]).ravel()
    values = scan.heights.ravel()
    known = np.isfinite(values)
    y, x = np.divmod(np.arange(values.size), scan.shape[1])
    count = np.bincount(cell[known], minlength=shape[0] * shape[1])
    here = count > 0
    means = [
        np.bincount(cell[known], value[known], minlength=len(count))[here] / count[here]
        for value in (x * scan.spacing[0], y * scan.spacing[1], values)
    ]
    return np.stack(means[:2], axis=1), means[2]


NEIGHBOURS = 8
MIN_POINTS = 16  # below which neighbours say nothing of a point
SCATTERS = 20.0  # robust standard deviations of the difference from the neighbours' median
RANGES = 5.0  # times the range of the neighbours
SPANS = 3.0  # times the range of all heights but the outer 5 % on both sides
QUANTA = 20.0  # times the least difference of two heights, the last digit of the instrument


def refuse_lonely(places: Array, heights: Array, name: str) -> None:
    """Raise InputError where single points stand so far off that a flatness, or a gap, would be theirs alone.

    Args:
        places: (n, 2) [m].
        heights: or gaps, (n,) [m]; what is not finite is passed over.
        name: of the file, for the message.
    """
    from scipy.spatial import cKDTree

    good = np.isfinite(heights) & np.isfinite(places).all(axis=1)
    rows = np.flatnonzero(good)
    xy, z = places[good], heights[good]
    if len(z) < MIN_POINTS or np.ptp(z) == 0:
        return
    base = np.column_stack([np.ones(len(z)), xy - xy.mean(axis=0)])
    low, high = np.quantile(z, [0.05, 0.95])
    inner = (z >= low) & (z <= high)
    level = z - base @ np.linalg.lstsq(base[inner], z[inner], rcond=None)[0]
    unit = xy / max(float(np.abs(xy).max()), 1e-300)  # whose distances have a square
    around = level[cKDTree(unit).query(unit, k=NEIGHBOURS + 1)[1][:, 1:]]
    away = np.abs(level - np.median(around, axis=1))
    middle = np.sort(around, axis=1)[:, 1:-1]  # so that one lonely point does not hide another
    steps = np.diff(np.unique(z))
    limit = np.maximum.reduce(
        [
            np.full(len(z), SCATTERS * 1.4826 * float(np.median(away))),
            RANGES * np.ptp(middle, axis=1),
            np.full(len(z), SPANS * float(np.subtract(*np.quantile(level, [0.95, 0.05])))),
            np.full(len(z), QUANTA * float(steps[steps > 1e-9 * np.ptp(z)].min())),
        ]
    )
    nearest = np.abs(level[:, None] - around).min(axis=1)  # the end of a ridge has a neighbour like itself
    alone = np.flatnonzero((away > limit) & (nearest > away / 2))
    if len(alone):
        worst = alone[np.argmax(away[alone])]
        x, y = (1e3 * v for v in xy[worst])
        raise InputError(
            f"{name}: {len(alone)} of {len(z)} points are alone; row {rows[worst] + 1} of the numbers, at "
            f"x = {x:.4g} mm, y = {y:.4g} mm, is {1e6 * away[worst]:.4g} um off the median of its {NEIGHBOURS} "
            f"neighbours, where half of the points are within {1e6 * float(np.median(away)):.3g} um. Leave such points "
            "out, or measure more points there where the step is real"
        )
