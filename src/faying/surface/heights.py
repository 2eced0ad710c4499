"""Measured heights with their spacing: frozen, in metres, missing points as NaN."""

from dataclasses import dataclass, field, replace
from typing import Any, Self, final

import numpy as np

from faying.checks import instance, number, several, shown, text
from faying.errors import InputError, ReadError
from faying.memory import GB, available
from faying.typing import Array


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


def _describe(scan: "AreaHeights | LineHeights") -> None:
    """Raise InputError where what is said of the heights is not of its kind."""
    kind = type(scan).__name__
    instance(scan.source, str, f"{kind}: source", "give the name of the file or recipe as text")
    instance(
        scan.instrument, Instrument, f"{kind}: instrument", "give a faying.surface.heights.Instrument, or leave it out"
    )
    for name in ("history", "notes"):
        lines = getattr(scan, name)
        if not isinstance(lines, list | tuple) or not all(isinstance(line, str) for line in lines):
            raise InputError(f"{kind}: {name} = {shown(lines)}; give a tuple of texts, or leave it out")
        object.__setattr__(scan, name, tuple(lines))


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class _Points:
    """What both kinds of heights have."""

    heights: Array
    source: str = "array"
    instrument: Instrument = field(default_factory=Instrument)
    history: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def missing(self) -> int:
        """How many points have no height."""
        return int(np.isnan(self.heights).sum())

    def with_heights(self, heights: Any, note: str = "") -> Self:
        """Return the same heights with other values [m] and one more line of history."""
        return replace(self, heights=heights, history=(*self.history, note) if text(note, "note") else self.history)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class AreaHeights(_Points):
    """The data of `Scan`, which says what they are."""

    spacing: tuple[float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "heights", _frozen(self.heights, 2, "Scan"))
        object.__setattr__(self, "spacing", several(self.spacing, "Scan: spacing (dx, dy)", 2, "m", least=0))
        _describe(self)

    @property
    def shape(self) -> tuple[int, int]:
        """(ny, nx), as of the heights."""
        return self.heights.shape[0], self.heights.shape[1]

    @property
    def size(self) -> tuple[float, float]:
        """(Lx, Ly) [m]: number of points times spacing."""
        return self.shape[1] * self.spacing[0], self.shape[0] * self.spacing[1]

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


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class LineHeights(_Points):
    """The data of `Profile`, which says what they are."""

    spacing: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "heights", _frozen(self.heights, 1, "Profile"))
        object.__setattr__(self, "spacing", number(self.spacing, "Profile: spacing", "m", least=0))
        _describe(self)

    @property
    def length(self) -> float:
        """Number of points times spacing [m]."""
        return len(self.heights) * self.spacing


def steps_of(scan: AreaHeights | LineHeights) -> tuple[float, ...]:
    """Spacings [m] in the order of the axes of the heights."""
    return (scan.spacing,) if isinstance(scan, LineHeights) else (scan.spacing[1], scan.spacing[0])


def sides_of(scan: AreaHeights | LineHeights) -> tuple[float, ...]:
    """Sides [m] in the order of the axes of the heights."""
    return tuple(n * step for n, step in zip(scan.heights.shape, steps_of(scan), strict=True))


ASK_UNITS = 'for example xy_unit = "mm" and z_unit = "um" (on the command line --xy-unit mm --z-unit um)'
ASK_SIZE = 'give size or spacing, for example size = "4 mm" (on the command line --size "4 mm")'
MIN_POINTS = 16  # each way, that a statistic needs


def usable(scan: AreaHeights | LineHeights) -> None:
    """Raise InputError where the heights cannot carry a statistic: too few points, all missing, or all the same."""
    heights = scan.heights
    known = heights[~np.isnan(heights)]
    if known.size == 0:
        raise InputError(f"{scan.source}: every point is missing; there is nothing to analyse")
    if min(heights.shape) < MIN_POINTS:
        raise InputError(f"{scan.source}: {heights.shape} points; the analysis needs at least {MIN_POINTS} each way")
    if known.size < heights.size / 2:
        share = 100 * (1 - known.size / heights.size)
        raise InputError(f"{scan.source}: {share:.0f} % of the points are missing; at most half may be, crop the scan")
    if np.ptp(known) <= 1e-12 * float(np.abs(known).max()):
        raise InputError(f"{scan.source}: all heights are the same; there is no roughness to analyse")
