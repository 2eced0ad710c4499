"""All other instrument formats, through SurfaceTopography (extra "instruments"; MIT licence)."""

import warnings
import zipfile
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from faying.columns import plain_unit
from faying.errors import FayingError, InputError, ReadError
from faying.surface.files.text import refuse_lost, uneven_line
from faying.surface.heights import ASK_SIZE, ASK_UNITS, Instrument, check_points
from faying.surface.scan import Profile, Scan
from faying.text import few
from faying.units import scale

Steps = Callable[[int, int], tuple[float, float]]
_ANY_TEXT = ("AscReader", "XYZReader")  # of the library: they pass over every line that they cannot read


def _library() -> Any:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import SurfaceTopography
            import SurfaceTopography.IO
    except ImportError as fault:
        if isinstance(fault, ModuleNotFoundError) and fault.name == "SurfaceTopography":
            return None
        raise ReadError(
            f"SurfaceTopography, which reads formats of instruments, is installed but does not start ({fault}); "
            "install a version for the installed numpy"
        ) from fault
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


def read(
    file: Path, xy_unit: str | None, z_unit: str | None, steps: Steps | None, channel: str | None
) -> Scan | Profile:
    """Read a file by SurfaceTopography; `steps` gives the spacing [m] from the numbers of points (nx, ny).

    ReadError where the library is not installed or cannot read the file, InputError where the file holds several maps
    of heights and `channel` names none of them.
    """
    content = _content(file, channel)
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
        unit = plain_unit(str(content.unit)).replace("Å", "angstrom")
        xy = z = scale(unit, "m", name=f"{file}: its unit")
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


def _content(file: Path, wanted: str | None) -> _Content:
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
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if {"meta.yml", "index.json"} & {*_members(file)}:
            return _contained(file, wanted)
        for kind in (None, *by_name):  # what the content seems to be; a .nms may seem to be MATLAB's, without any data
            try:
                return _opened(file, library, kind, wanted)
            except FayingError:
                raise
            except Exception as fault:  # a reader of thirty formats fails in as many ways
                faults.append(fault)
    known = next((fault for fault in faults if type(fault).__name__ != "CannotDetectFileFormat"), None)
    reason = "" if known is None else f" ({type(known).__name__}: {(str(known).strip() or '-').splitlines()[0]})"
    names = _members(file)
    packed = f"; it is a zip archive of {len(names)} files ({few(names, 3)}): unpack it and give one of them"
    raise ReadError(f"{file}: of no format that can be read, or damaged{reason}{packed if names else ''}") from faults[
        0
    ]


def _opened(file: Path, library: Any, kind: str | None, wanted: str | None) -> _Content:
    """The map of heights of a file, by its format; the library calls maps of other things heights without a unit."""
    with library.open_topography(str(file), format=kind) as reader:
        maps = [one for one in reader.channels if one.is_height_channel and not isinstance(one.unit, tuple)]
        maps = maps or [reader.default_channel]
        channel = maps[_chosen(file, [one.channel_id for one in maps], wanted)]
        points, generic = channel.nb_grid_pts, type(reader).__name__ in _ANY_TEXT
        stated = channel.physical_sizes is not None and not (generic and channel.unit is None)  # else pixels, perhaps
        if points is not None and len(points) > 0:
            check_points(str(file), float(np.prod([float(n) for n in points])))
        lengths = {} if channel.physical_sizes is not None else {"physical_sizes": channel.nb_grid_pts}
        found = _of(channel.topography(**lengths), stated=stated)
    if generic and len(maps) == 1:
        refuse_lost(file, found.heights.size, unit=found.unit is not None)
    return found


def _contained(file: Path, wanted: str | None) -> _Content:
    """One measurement of a container of contact.engineering, with the form that its author has taken off."""
    from SurfaceTopography.Container.IO import CEReader

    try:
        reader = CEReader(str(file))
        places = [(k, i) for k in range(reader.nb_containers) for i in range(len(reader.members(k)))]
        names = [f"{k + 1}: " * (reader.nb_containers > 1) + reader.members(k)[i].name for k, i in places]
        surface, place = places[_chosen(file, names, wanted)]
        found = reader.container(surface)[place]
        return _of(found.parent_topography if hasattr(found, "detrend_mode") else found, stated=True)
    except FayingError:
        raise
    except Exception as fault:
        raise ReadError(f"{file}: the container is damaged ({type(fault).__name__}: {fault})") from fault


def _chosen(file: Path, names: Sequence[str], wanted: str | None) -> int:
    """The place of the map of heights that the caller wants; InputError where the name is missing or unknown."""
    if wanted in names:
        return names.index(wanted)
    if wanted is None and len(names) == 1:
        return 0
    shown = ", ".join(map(repr, names))
    raise InputError(
        f"{file} holds {len(names)} maps of heights: {shown}; "
        f"{'name one' if wanted is None else f'there is no {wanted!r}, name one of these'}, for example "
        f'channel = "{names[0]}" (--channel "{names[0]}")'
    )


def _of(topography: Any, *, stated: bool) -> _Content:
    """What a topography of the library holds; stated: whether its file states the size."""
    return _Content(
        heights=np.ma.filled(np.ma.asarray(topography.heights(), float), np.nan),
        sizes=topography.physical_sizes if stated else None,
        unit=topography.unit,
        info=dict(topography.info or {}),
        positions=None if topography.is_uniform else np.asarray(topography.positions(), float),
    )


def _members(file: Path) -> list[str]:
    """The names of the files in a zip archive; none of other files."""
    try:
        with zipfile.ZipFile(file) as archive:
            return archive.namelist()
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError):
        return []


def _scan(file: Path, content: _Content, xy: float, z: float) -> Scan | Profile:
    heights, sizes, positions = content.heights, content.sizes, content.positions
    instrument = _instrument(content.info)
    if heights.size == 0 or not all(np.isfinite(s) and s > 0 for s in sizes):
        raise ReadError(f"{file}: the file has no points or no size; it is damaged")
    if heights.ndim == 2:
        nx, ny = heights.shape
        spacing = (sizes[0] * xy / nx, sizes[1] * xy / ny)
        return Scan(heights=heights.T * z, spacing=spacing, source=str(file), instrument=instrument)
    if positions is None:
        spacing_x = sizes[0] * xy / len(heights)
        return Profile(heights=heights * z, spacing=spacing_x, source=str(file), instrument=instrument)
    if np.diff(positions).min() <= 0:
        raise ReadError(f"{file}: the positions of the line scan do not increase")
    return replace(uneven_line(file, positions * xy, heights * z), instrument=instrument)


def _instrument(info: dict[str, Any]) -> Instrument:
    data = info.get("instrument") or {}
    parameters = data.get("parameters") or {}
    values = {}
    for name in ("tip_radius", "resolution"):
        entry = parameters.get(name)
        if isinstance(entry, dict) and entry.get("value") is not None:
            with suppress(InputError, TypeError, ValueError):
                values[name] = float(entry["value"]) * scale(plain_unit(str(entry.get("unit", "m"))), "m")
    return Instrument(name=str(data.get("name") or ""), **values)
