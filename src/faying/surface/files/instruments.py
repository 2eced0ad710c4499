"""All other instrument formats, through SurfaceTopography (extra "instruments"; MIT licence)."""

import warnings
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import FayingError, InputError, ReadError
from faying.surface.heights import ASK_SIZE, ASK_UNITS, Instrument, check_points
from faying.surface.scan import Profile, Scan
from faying.text import few
from faying.units import scale

ROUNDED = 0.1  # of a step: how far the positions of a line may be off an even grid
_BROKEN = (
    "SurfaceTopography, which reads formats of instruments, is installed but does not start ({fault}); install a "
    "version for the installed numpy"
)
Steps = Callable[[int, int], tuple[float, float]]


def _library() -> Any:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import SurfaceTopography
            import SurfaceTopography.IO
    except ModuleNotFoundError as fault:
        if fault.name == "SurfaceTopography":
            return None
        raise ReadError(_BROKEN.format(fault=fault)) from fault
    except ImportError as fault:
        raise ReadError(_BROKEN.format(fault=fault)) from fault
    return SurfaceTopography


@dataclass(frozen=True, kw_only=True)
class _Content:
    """What the library finds in a file.

    heights (nx, ny) or (n,); sizes in the file's unit, None where not stated; its unit; what it says of the instrument;
    the positions of an uneven line.
    """

    heights: Any
    sizes: Any
    unit: Any
    info: dict[str, Any]
    positions: Any


def read(file: Path, xy_unit: str | None, z_unit: str | None, steps: Steps | None) -> Scan | Profile:
    """Read a file by SurfaceTopography; `steps` gives the spacing [m] from the numbers of points (nx, ny).

    ReadError where the library is not installed or cannot read the file.
    """
    content = _content(file)
    if content.sizes is None and steps is None:
        raise InputError(f"{file}: the file does not state its physical size; {ASK_SIZE}")
    if content.unit is None:
        lateral = xy_unit is not None or content.sizes is None
        if not lateral or z_unit is None:
            raise InputError(f"{file}: the file states no unit; give both, {ASK_UNITS}")
        xy = scale(xy_unit, "m", name="xy_unit") if xy_unit is not None else 1.0
        z = scale(z_unit, "m", name="z_unit")
    else:
        if xy_unit is not None or z_unit is not None:
            raise InputError(f"{file}: the file states its units ({content.unit}); leave out xy_unit and z_unit")
        unit = str(content.unit).replace("µ", "u").replace("μ", "u").replace("Å", "angstrom")
        xy = z = scale(unit, "m", name="unit")
    if content.sizes is None:
        assert steps is not None
        counts = content.heights.shape
        spacing = steps(counts[0], counts[1] if len(counts) > 1 else 1)
        content = replace(content, sizes=[n * d / xy for n, d in zip(counts, spacing, strict=False)])
    try:
        return _scan(file, content, xy, z)
    except ReadError:
        raise
    except InputError as fault:
        raise ReadError(f"{file}: {fault}") from fault


def _content(file: Path) -> _Content:
    library = _library()
    if library is None:
        raise ReadError(
            f"{file}: neither X3P nor x,y,z text; for other instrument formats install SurfaceTopography "
            "(pip install SurfaceTopography)"
        )
    by_name = [
        kind.format() for kind in library.IO.readers if file.suffix.lower().lstrip(".") in kind.file_extensions()
    ]
    faults: list[Exception] = []
    for kind in (None, *by_name):  # what the content seems to be; a .nms may seem to be MATLAB's, without any data
        try:
            return _opened(file, library, kind)
        except FayingError:
            raise
        except Exception as fault:  # a reader of thirty formats fails in as many ways
            faults.append(fault)
    first = str(faults[0]).strip().splitlines()
    reason = first[0] if first else type(faults[0]).__name__
    raise ReadError(
        f"{file}: of no format that can be read, or damaged ({type(faults[0]).__name__}: {reason}){_packed(file)}"
    ) from faults[0]


def _opened(file: Path, library: Any, kind: str | None) -> _Content:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with library.open_topography(str(file), format=kind) as reader:
            channel = reader.default_channel
            stated = channel.physical_sizes is not None
            points = channel.nb_grid_pts
            if points is not None and len(points) > 0:
                check_points(str(file), float(np.prod([float(n) for n in points])))
            topography = channel.topography(**({} if stated else {"physical_sizes": channel.nb_grid_pts}))
            heights: Any = np.ma.filled(np.ma.asarray(topography.heights(), float), np.nan)
            return _Content(
                heights=heights,
                sizes=topography.physical_sizes if stated else None,
                unit=topography.unit,
                info=dict(topography.info or {}),
                positions=None if topography.is_uniform else np.asarray(topography.positions(), float),
            )


def _packed(file: Path) -> str:
    """What a zip archive of no known format holds, in words; "" for other files."""
    try:
        with zipfile.ZipFile(file) as archive:
            names = archive.namelist()
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError):
        return ""
    shown = few(names, 3)
    return f"; it is a zip archive of {len(names)} files ({shown}): unpack it and give one of them"


def _scan(file: Path, content: _Content, xy: float, z: float) -> Scan | Profile:
    heights, sizes, positions = content.heights, content.sizes, content.positions
    instrument = _instrument(content.info)
    if heights.size == 0 or not all(np.isfinite(s) and s > 0 for s in sizes):
        raise ReadError(f"{file}: the file has no points or no size; it is damaged")
    if heights.ndim == 2:
        nx, ny = heights.shape
        spacing = (sizes[0] * xy / nx, sizes[1] * xy / ny)
        return Scan(heights=heights.T * z, spacing=spacing, source=str(file), instrument=instrument)
    notes: tuple[str, ...] = ()
    if positions is None:
        step = sizes[0] / len(heights)
    else:
        gaps = np.diff(positions)
        step = float(np.ptp(positions)) / (len(positions) - 1)
        if gaps.min() <= 0:
            raise ReadError(f"{file}: the positions of the line scan do not increase")
        # positions rounded in the file differ a little from an even grid; heights between larger gaps are interpolated
        even = positions[0] + step * np.arange(len(positions))
        if np.abs(positions - even).max() > ROUNDED * step:
            heights = np.interp(even, positions, heights)
            notes = (
                f"{file}: the steps of the line are {gaps.min() * xy:.3g} to {gaps.max() * xy:.3g} m; heights are "
                f"interpolated at even steps of {step * xy:.3g} m",
            )
    return Profile(heights=heights * z, spacing=step * xy, source=str(file), instrument=instrument, notes=notes)


def _instrument(info: dict[str, Any]) -> Instrument:
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
