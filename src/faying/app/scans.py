"""A scan to look at closely: a window of it as a map of at most so many points, and lines through it."""

from base64 import b64encode
from collections.abc import Sequence
from pathlib import Path
from typing import Any, final

import numpy as np

from faying.errors import InputError
from faying.result.fields import listed
from faying.surface.convention import density
from faying.surface.files.read import read_scan
from faying.surface.form import levelled, prepared
from faying.surface.fractal import fit_fractal
from faying.surface.scan import Scan
from faying.surface.spectrum import Spectrum, spectrum
from faying.typing import Array, Index
from faying.units import lengths

MAX_MAP_POINTS = 360  # points of a map along each side
MAX_LINE_POINTS = 1200  # points of a line
MISSING = 255  # in the bytes of a map
Window = tuple[float, float, float, float]


@final
class OpenScan:
    """An areal scan, levelled by a plane; spikes and missing points stay as they were measured.

    Args:
        scan: as read. Raises InputError for a line scan, which has no map.
    """

    def __init__(self, scan: Any) -> None:
        if not isinstance(scan, Scan):
            raise InputError("a line scan has no map; its picture shows the line")
        self.measured, self.scan = scan, levelled(scan, 1)
        self._spectrum: Spectrum | None = None

    @classmethod
    def read(
        cls, file: Path, xy_unit: str | None, z_unit: str | None, size: str | None, channel: str | None
    ) -> "OpenScan":
        """Read a file as `faying surface` does. Raises ReadError and InputError as that."""
        given = lengths(size, name="size") if size else None
        return cls(read_scan(file, xy_unit=xy_unit, z_unit=z_unit, size=given, channel=channel))

    def map(self, window: Window) -> dict[str, Any]:
        """Return mean heights in a window as bytes, row by row from least y, with their scale.

        Args:
            window: first x, first y, last x, last y, each as a share of the scan.

        Returns:
            width, height: of the map [points]; window: [m]; low, high: heights [m] of the bytes 0 and 254, the 1 and
            99 % of the window's; data: the bytes in base64, 255 where all points are missing.
        """
        (across, up), ends = self._edges(window)
        heights = self.scan.heights[up[0] : up[-1], across[0] : across[-1]]
        known = ~np.isnan(heights)
        columns, rows = across[:-1] - across[0], up[:-1] - up[0]
        total, count = (
            np.add.reduceat(np.add.reduceat(one, rows, axis=0), columns, axis=1)
            for one in (np.where(known, heights, 0.0), known.astype(float))
        )
        mean = np.divide(total, count, out=np.full_like(total, np.nan), where=count > 0)
        seen = mean[count > 0]
        low, high = np.quantile(seen, [0.01, 0.99]) if seen.size else (0.0, 0.0)
        span = high - low if high > low else 1.0
        levels = np.where(count > 0, np.clip((mean - low) / span, 0, 1) * (MISSING - 1), MISSING)
        return {
            "width": mean.shape[1],
            "height": mean.shape[0],
            "window": ends,
            "low": float(low),
            "high": float(high),
            "data": b64encode(np.round(np.nan_to_num(levels, nan=MISSING)).astype(np.uint8).tobytes()).decode(),
        }

    def line(self, along: str, at: float, window: Window) -> dict[str, Any]:
        """Return heights along "x" or "y" within a window, at a share `at` of the scan's other side.

        Of more than 1200 points each group gives its least and its greatest height, so that no peak is lost.

        Returns:
            along: places [m]; heights: [m], None where missing; at: where the line lies [m].

        Raises:
            InputError: along is neither.
        """
        if along not in ("x", "y"):
            raise InputError(f'along = "{along}"; give "x" or "y"')
        (across, up), _ = self._edges(window)
        heights, (dx, dy), (rows, columns) = self.scan.heights, self.scan.spacing, self.scan.shape
        if along == "x":
            index, first, step, other = _index(at, rows), across[0], dx, dy
            values = heights[index, across[0] : across[-1]]
        else:
            index, first, step, other = _index(at, columns), up[0], dy, dx
            values = heights[up[0] : up[-1], index]
        places = (first + np.arange(len(values)) + 0.5) * step
        keep = _outline(values)
        return {"along": places[keep].tolist(), "heights": listed(values[keep]), "at": float((index + 0.5) * other)}

    def spectrum(self, band: tuple[float, float] | None = None) -> dict[str, Any]:
        """Return the power spectrum with the power law that is fitted over a band, as `faying surface` fits it.

        Args:
            band: shortest and longest wavelength [m]; the one that the heights support where None.

        Returns:
            wavelength [m] and density [m3] of the bins; limits: of a band [m]; fit: D, G [m], their 95 % intervals,
            band [m], warnings, and density of the law at the ends of the band.

        Raises:
            InputError, NotConverged: the band is none, or holds no power law.
        """
        if self._spectrum is None:
            self._spectrum = spectrum(prepared(self.measured).scan)
        found = self._spectrum
        fit = fit_fractal(self.measured, band=band)
        ends = np.array(fit.band)
        law = density(fit.D, fit.G, fit.c) * ends ** (7 - 2 * fit.D) if fit.G > 0 else np.full(2, np.nan)
        good = found.density > 0
        return {
            "wavelength": (1 / found.frequency[good]).tolist(),
            "density": found.density[good].tolist(),
            "limits": [1 / found.nyquist, 1 / found.lowest],
            "fit": {
                "D": fit.D,
                "G": fit.G,
                "D_interval": list(fit.D_interval),
                "G_interval": list(fit.G_interval),
                "band": list(fit.band),
                "law": [float(one) if np.isfinite(one) else None for one in law],
                "warnings": list(fit.warnings),
            },
        }

    def _edges(self, window: Window) -> tuple[tuple[Index, Index], list[float]]:
        """Edges of the groups of points along x and y, and the window that they fill [m]."""
        x0, y0, x1, y1 = window
        if not (0 <= x0 < x1 <= 1 and 0 <= y0 < y1 <= 1):
            raise InputError(
                "a window has first x, first y, last x, last y, each from 0 to 1, the first below the last"
            )
        rows, columns = self.scan.shape
        dx, dy = self.scan.spacing
        found = []
        for low, high, count in ((x0, x1, columns), (y0, y1, rows)):
            first = min(int(low * count), count - 1)
            last = max(int(np.ceil(high * count - 1e-9)), first + 1)
            found.append(np.linspace(first, last, min(MAX_MAP_POINTS, last - first) + 1).astype(int))
        ends = [found[0][0] * dx, found[1][0] * dy, found[0][-1] * dx, found[1][-1] * dy]
        return (found[0], found[1]), [float(one) for one in ends]


def band_of(text: str | None) -> tuple[float, float] | None:
    """Read a band from a request: shortest and longest wavelength [m]. Raises InputError for anything else."""
    if not text:
        return None
    try:
        shortest, longest = (float(one) for one in text.split(","))
    except ValueError:
        raise InputError("a band has two wavelengths in metres, the shortest and the longest") from None
    return shortest, longest


def window_of(text: str) -> Window:
    """Read a window from a request: four numbers with commas. Raises InputError for anything else."""
    try:
        x0, y0, x1, y1 = (float(one) for one in text.split(","))
    except ValueError:
        raise InputError("a window has four numbers, each from 0 to 1: first x, first y, last x, last y") from None
    return x0, y0, x1, y1


def _index(share: float, count: int) -> int:
    if not 0 <= share <= 1:
        raise InputError(f"at = {share:g}; give a share of the side, from 0 to 1")
    return min(int(share * count), count - 1)


def _outline(values: Array) -> Index:
    """Which points are drawn: all where they are few, else the least and the greatest of each group."""
    if len(values) <= MAX_LINE_POINTS:
        return np.arange(len(values))
    keep: list[int] = []
    for group in np.array_split(np.arange(len(values)), MAX_LINE_POINTS // 2):
        part = values[group]
        if np.isnan(part).all():
            keep.append(int(group[0]))
            continue
        ends: Sequence[int] = sorted({int(np.nanargmin(part)), int(np.nanargmax(part))})
        keep += [int(group[k]) for k in ends]
    return np.array(keep)
