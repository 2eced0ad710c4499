"""Instrument files in: X3P and text in the core, everything else through SurfaceTopography when it is installed."""

from pathlib import Path

import numpy as np

from faying.errors import FayingError, InputError, ReadError
from faying.surface.scan import Profile, Scan

ASK = 'for example read_scan("{name}", xy_unit="mm", z_unit="um"), or on the command line --xy-unit mm --z-unit um'


def read_scan(path: str | Path, xy_unit: str | None = None, z_unit: str | None = None) -> Scan | Profile:
    """Read a measured surface: a Scan, or a Profile where the file holds one line.

    X3P (ISO 25178-72) and plain text (`x,y,z` on a regular grid, or `x,z`) are read by Faying itself, all other
    formats by SurfaceTopography when it is installed (`pip install faying[instruments]`).
    `xy_unit` and `z_unit` (such as "mm", "um") are needed where the file states no unit, and refused where it does.
    Raises InputError when a unit is needed and not given, or given against the file; ReadError for files that are
    missing, damaged, of an unknown format, or of implausible size.
    """
    from faying.surface import x3p

    file = Path(path)
    if not file.exists():
        raise ReadError(f"{file}: no such file; check the path")
    if not file.is_file():
        raise ReadError(f"{file}: not a file; give the file that the instrument wrote")
    try:
        with file.open("rb") as handle:
            head = handle.read(4096)
    except OSError as fault:
        raise ReadError(f"{file}: cannot be opened ({fault.strerror}); check the permissions") from None
    if not head.strip(b"\0 \r\n\t"):
        raise ReadError(f"{file}: the file is empty; export it again")
    if head[:2] == b"PK":
        _no_units(file, xy_unit, z_unit)
        scan: Scan | Profile = x3p.read(file)
    else:
        scan = _text_or_other(file, xy_unit, z_unit)
    plausible(scan)
    return scan


def _no_units(file: Path, xy_unit: str | None, z_unit: str | None) -> None:
    if xy_unit is not None or z_unit is not None:
        raise InputError(f"{file}: the file states its units; leave out xy_unit and z_unit")


def _text_or_other(file: Path, xy_unit: str | None, z_unit: str | None) -> Scan | Profile:
    from faying.surface import text
    from faying.units import scale

    if file.suffix.lower() == ".x3p":
        raise ReadError(f"{file}: not an X3P (zip) archive; the file is cut off or damaged, export it again")
    if text.looks_like(file):
        if xy_unit is None or z_unit is None:
            lacking = [n for n, u in (("xy_unit", xy_unit), ("z_unit", z_unit)) if u is None]
            raise InputError(
                f"{file}: the file states no unit; give {' and '.join(lacking)}, {ASK.format(name=file.name)}"
            )
        try:
            return text.read(file, scale(xy_unit, "m", name="xy_unit"), scale(z_unit, "m", name="z_unit"))
        except FayingError:
            raise
        except (ValueError, MemoryError, OverflowError) as fault:
            raise ReadError(f"{file}: the text cannot be read as x,y,z ({fault})") from fault
    from faying.surface import instruments

    return instruments.read(file, xy_unit, z_unit)


def plausible(scan: Scan | Profile) -> None:
    """Raise ReadError where sizes or heights cannot be those of a measured surface: as a rule, a wrong unit."""
    sizes = scan.size if isinstance(scan, Scan) else (scan.length,)
    spacing = scan.spacing if isinstance(scan, Scan) else (scan.spacing,)
    hint = "check the unit that the file states or that you gave"
    if max(sizes) > 10 or min(spacing) < 1e-11:
        shown = " x ".join(f"{s:.3g} m" for s in sizes)
        raise ReadError(f"{scan.source}: a scan of {shown} with points {min(spacing):.3g} m apart; {hint}")
    known = scan.heights[~np.isnan(scan.heights)]
    if known.size == 0:
        raise ReadError(f"{scan.source}: every point is missing; measure the surface again")
    low, high = np.quantile(known, [0.05, 0.95])
    reach = float(high - low)
    if reach > 3 * max(sizes):
        raise ReadError(f"{scan.source}: heights over {reach:.3g} m on a scan of {max(sizes):.3g} m; {hint}")
    if 0 < reach < max(1e-13, 1e-10 * max(sizes)):
        raise ReadError(f"{scan.source}: heights over {reach:.3g} m, less than an atom; {hint}")
