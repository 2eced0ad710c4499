"""All other instrument formats, through SurfaceTopography (extra "instruments"; MIT licence)."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import InputError, ReadError
from faying.surface.scan import Instrument, Profile, Scan
from faying.units import scale


def _library() -> Any:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import SurfaceTopography
            import SurfaceTopography.IO
    except ImportError:
        return None
    return SurfaceTopography


def read(file: Path, xy_unit: str | None, z_unit: str | None) -> Scan | Profile:
    """Read a file by SurfaceTopography. ReadError where it is not installed or cannot read the file."""
    library = _library()
    if library is None:
        raise ReadError(
            f"{file}: neither X3P nor x,y,z text; for other instrument formats install SurfaceTopography "
            "(pip install faying[instruments])"
        )
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            topography = library.read_topography(str(file))
            heights: Any = np.ma.filled(np.ma.asarray(topography.heights(), float), np.nan)
            sizes = topography.physical_sizes
            unit = topography.unit
            info = dict(topography.info or {})
            uniform = topography.is_uniform
            positions = None if uniform else np.asarray(topography.positions(), float)
    except Exception as fault:  # a reader of thirty formats fails in as many ways
        first = str(fault).strip().splitlines()
        reason = first[0] if first else type(fault).__name__
        raise ReadError(
            f"{file}: of no format that can be read, or damaged ({type(fault).__name__}: {reason})"
        ) from fault
    if unit is None:
        if xy_unit is None or z_unit is None:
            raise InputError(
                f'{file}: the file states no unit; give both, for example read_scan("{file.name}", xy_unit="um", '
                'z_unit="nm"), or on the command line --xy-unit um --z-unit nm'
            )
        xy, z = scale(xy_unit, "m", name="xy_unit"), scale(z_unit, "m", name="z_unit")
    else:
        if xy_unit is not None or z_unit is not None:
            raise InputError(f"{file}: the file states its units ({unit}); leave out xy_unit and z_unit")
        xy = z = scale(str(unit).replace("µ", "u").replace("μ", "u").replace("Å", "angstrom"), "m", name="unit")
    try:
        return _scan(file, heights, sizes, positions, xy, z, _instrument(info, xy))
    except InputError as fault:
        raise ReadError(f"{file}: {fault}") from fault


def _scan(
    file: Path, heights: Any, sizes: Any, positions: Any, xy: float, z: float, instrument: Instrument
) -> Scan | Profile:
    if heights.size == 0 or not all(np.isfinite(s) and s > 0 for s in sizes):
        raise ReadError(f"{file}: the file holds no points or no size; it is damaged")
    if heights.ndim == 2:
        nx, ny = heights.shape
        spacing = (sizes[0] * xy / nx, sizes[1] * xy / ny)
        return Scan(heights=heights.T * z, spacing=spacing, source=str(file), instrument=instrument)
    if positions is None:
        step = sizes[0] / len(heights)
    else:
        gaps = np.diff(positions)
        step = float(np.ptp(positions)) / (len(positions) - 1)
        if gaps.min() <= 0:
            raise ReadError(f"{file}: the positions of the line scan do not increase")
        # positions rounded in the file differ a little from an even grid; larger gaps are interpolated
        even = positions[0] + step * np.arange(len(positions))
        if np.abs(positions - even).max() > 0.51 * step:
            heights = np.interp(even, positions, heights)
    return Profile(heights=heights * z, spacing=step * xy, source=str(file), instrument=instrument)


def _instrument(info: dict[str, Any], xy: float) -> Instrument:
    data = info.get("instrument") or {}
    parameters = data.get("parameters") or {}
    values = {}
    for name in ("tip_radius", "resolution"):
        entry = parameters.get(name)
        if isinstance(entry, dict) and entry.get("value") is not None:
            try:
                values[name] = float(entry["value"]) * scale(str(entry.get("unit", "m")).replace("µ", "u"), "m")
            except (InputError, TypeError, ValueError):
                continue
    return Instrument(name=str(data.get("name") or ""), **values)
