"""Measured heights with their spacing: frozen, in metres, missing points as NaN."""

from dataclasses import dataclass, field
from typing import Any, Self, final

import numpy as np

from faying.checks import instance, number, shown, whole
from faying.errors import InputError, ReadError
from faying.memory import GB, available
from faying.surface.heights import Heights
from faying.typing import Array
from faying.units import show


@final
@dataclass(frozen=True, kw_only=True)
class Instrument:
    """What the file says of the instrument; None where it says nothing. Lengths in metres.

    `resolution` is the shortest lateral wavelength that the instrument resolves, `noise` the rms height noise.
    """

    name: str = ""
    tip_radius: float | None = None
    resolution: float | None = None
    noise: float | None = None


BYTES = 160.0  # at the peak of reading and preparing, for each point


def check_points(source: str, count: float) -> None:
    """Raise ReadError where a scan of so many points does not fit into the machine's free memory."""
    need, free = BYTES * count, available()
    if free is not None and need > free:
        raise ReadError(
            f"{source}: {count:.3g} points need about {need / GB:.3g} GB and {free / GB:.3g} GB are free; crop the "
            "scan or take every second point before reading it, or set FAYING_MEMORY to the GB that may be taken"
        )


def _frozen(heights: Any, dimensions: int, name: str) -> Array:
    try:
        given = np.ma.asarray(heights)
        out = np.ma.filled(given.astype(np.float64), np.nan) if given.dtype.kind in "fiu" else None
    except (TypeError, ValueError):
        out = None
    if out is None:
        raise InputError(
            f"{name}: heights = {shown(heights)}; give real numbers in metres, NaN where a point is missing"
        )
    if out.ndim != dimensions:
        want = "rows and columns, heights[iy, ix]" if dimensions == 2 else "one row of points"
        raise InputError(f"{name}: heights have {out.ndim} dimensions; give {want}")
    if min(out.shape) < 2:
        raise InputError(f"{name}: heights of shape {out.shape} have too few points; at least 2 are needed each way")
    if np.isinf(out).any():
        raise InputError(f"{name}: some heights are infinite; mark missing points as NaN")
    out = np.array(out, copy=True)
    out.setflags(write=False)
    return out


def _describe(scan: "Scan | Profile") -> None:
    """Raise InputError where what is said of the heights is not of its kind."""
    kind = type(scan).__name__
    instance(scan.source, str, f"{kind}: source", "give the name of the file or recipe as text")
    instance(
        scan.instrument, Instrument, f"{kind}: instrument", "give a faying.surface.scan.Instrument, or leave it out"
    )
    for name in ("history", "notes"):
        lines = getattr(scan, name)
        if not isinstance(lines, list | tuple) or not all(isinstance(line, str) for line in lines):
            raise InputError(f"{kind}: {name} = {shown(lines)}; give a tuple of texts, or leave it out")
        object.__setattr__(scan, name, tuple(lines))


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Scan(Heights):
    """An areal scan.

    Args:
        heights: heights[iy, ix] [m], shape (ny, nx), NaN where a point is missing; copied and made read-only.
        spacing: (dx, dy) [m], positive; each also as text with a unit, for example "5 um".
        source: the file or recipe.
        instrument: the limits that the file states.
        history: what was done to the heights since.
        notes: what a reader of the results should know of the file.

    Raises:
        InputError: for heights that are not two-dimensional or not finite, and spacings that are not positive.
    """

    heights: Array
    spacing: tuple[float, float]
    source: str = "array"
    instrument: Instrument = field(default_factory=Instrument)
    history: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "heights", _frozen(self.heights, 2, "Scan"))
        if not isinstance(self.spacing, (tuple, list, np.ndarray)) or len(self.spacing) != 2:
            raise InputError(f"Scan: spacing = {shown(self.spacing)}; give the two distances (dx, dy) in metres")
        dx, dy = self.spacing
        steps = number(dx, "Scan: dx", "m", least=0), number(dy, "Scan: dy", "m", least=0)
        object.__setattr__(self, "spacing", steps)
        _describe(self)

    @property
    def shape(self) -> tuple[int, int]:
        """(ny, nx), as of the heights."""
        return self.heights.shape[0], self.heights.shape[1]

    @property
    def size(self) -> tuple[float, float]:
        """(Lx, Ly) [m]: number of points times spacing."""
        return self.shape[1] * self.spacing[0], self.shape[0] * self.spacing[1]

    def summary(self) -> tuple[str, dict[str, str]]:
        """Size, points, spacing, Sq, missing points and source."""
        rows, columns = self.shape
        dx, dy = self.spacing
        step = show(dx, "m") if abs(dx - dy) <= 1e-9 * dx else f"{show(dx, 'm')} x {show(dy, 'm')}"
        name, words = self._statistics()
        return "Scan", {
            "size": " x ".join(show(side, "m") for side in self.size),
            "points": f"{columns} x {rows}",
            "spacing": step,
            name: words,
            **self._origin(),
        }

    def cropped(self, share: float) -> Self:
        """Return the middle part of the scan.

        Args:
            share: length of each side of the part over that of the scan, 0 < share <= 1.

        Returns:
            The part, of whole points; its spacing is that of the scan.

        Raises:
            InputError: for a share outside 0 .. 1, and where fewer than 5 points a side are left.
        """
        share = number(share, "share", least=0, greatest=1, ends="(]")
        rows, columns = (max(1, round(share * n)) for n in self.shape)
        if min(rows, columns) < 5:
            raise InputError(
                f"share = {share} of {self.shape} points leaves {rows} x {columns}; at least 5 points a side are "
                "needed: give a larger share"
            )
        top, left = (self.shape[0] - rows) // 2, (self.shape[1] - columns) // 2
        part = self.heights[top : top + rows, left : left + columns]
        return self.with_heights(part, f"cropped to the middle {rows} x {columns} points")

    def profile(self, along: str, index: int) -> "Profile":
        """Return one row (along="x") or one column (along="y") as a Profile."""
        if not isinstance(along, str) or along not in ("x", "y"):
            raise InputError(f'along = {shown(along)}: a profile runs along "x" or "y"')
        count = self.shape[0] if along == "x" else self.shape[1]
        if not -count <= whole(index, "index of a profile") < count:
            raise InputError(f"profile {index} along {along}: the scan has {count} of them")
        heights = self.heights[index] if along == "x" else self.heights[:, index]
        return Profile(
            heights=heights,
            spacing=self.spacing[0 if along == "x" else 1],
            source=self.source,
            instrument=self.instrument,
            history=(*self.history, f"profile {index} along {along}"),
            notes=self.notes,
        )


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Profile(Heights):
    """A line scan.

    Args:
        heights: [m], shape (n,), NaN where a point is missing; copied and made read-only.
        spacing: [m], positive; or text with a unit, for example "5 um".
        source: the file or recipe.
        instrument: the limits that the file states.
        history: what was done to the heights since.
        notes: what a reader of the results should know of the file.

    Raises:
        InputError: as for Scan.
    """

    heights: Array
    spacing: float
    source: str = "array"
    instrument: Instrument = field(default_factory=Instrument)
    history: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "heights", _frozen(self.heights, 1, "Profile"))
        object.__setattr__(self, "spacing", number(self.spacing, "Profile: spacing", "m", least=0))
        _describe(self)

    @property
    def length(self) -> float:
        """Number of points times spacing [m]."""
        return len(self.heights) * self.spacing

    def summary(self) -> tuple[str, dict[str, str]]:
        """Length, points, spacing, Rq, missing points and source."""
        name, words = self._statistics()
        return "Profile", {
            "length": show(self.length, "m"),
            "points": str(len(self.heights)),
            "spacing": show(self.spacing, "m"),
            name: words,
            **self._origin(),
        }


def steps_of(scan: Scan | Profile) -> tuple[float, ...]:
    """Spacings [m] in the order of the axes of the heights."""
    return (scan.spacing,) if isinstance(scan, Profile) else (scan.spacing[1], scan.spacing[0])


def sides_of(scan: Scan | Profile) -> tuple[float, ...]:
    """Sides [m] in the order of the axes of the heights."""
    return tuple(n * step for n, step in zip(scan.heights.shape, steps_of(scan), strict=True))


FEWEST = 16  # points each way that a statistic needs


def usable(scan: Scan | Profile) -> None:
    """Raise InputError where the heights cannot carry a statistic: too few points, all missing, or all the same."""
    heights = scan.heights
    known = heights[~np.isnan(heights)]
    if known.size == 0:
        raise InputError(f"{scan.source}: every point is missing; there is nothing to analyse")
    if min(heights.shape) < FEWEST:
        raise InputError(f"{scan.source}: {heights.shape} points; the analysis needs at least {FEWEST} each way")
    if known.size < heights.size / 2:
        share = 100 * (1 - known.size / heights.size)
        raise InputError(f"{scan.source}: {share:.0f} % of the points are missing; at most half may be, crop the scan")
    if np.ptp(known) <= 1e-12 * float(np.abs(known).max()):
        raise InputError(
            f"{scan.source}: all heights are the same ({known[0]:.4g} m); there is no roughness to analyse"
        )
