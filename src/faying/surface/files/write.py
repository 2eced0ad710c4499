"""Scans out: X3P (metres, read by most programs) and x,y,z text."""

from pathlib import Path

from faying.checks import instance
from faying.checks import path as checked_path
from faying.errors import InputError
from faying.surface.files import text, x3p
from faying.surface.scan import Profile, Scan


def write_scan(
    scan: Scan | Profile,
    path: str | Path,
    *,
    precision: str = "F",
    xy_unit: str | None = None,
    z_unit: str | None = None,
) -> Path:
    """Write a scan as X3P (suffix .x3p) or as text (.csv, .txt, .xyz).

    Args:
        scan: what to write.
        path: of the file; its suffix decides the format.
        precision: of X3P heights: 4 bytes ("F"), 8 ("D"), or integer steps of 2 or 4 bytes ("I", "L").
        xy_unit: unit of x and y in text, for example "mm".
        z_unit: unit of the heights in text, for example "um".

    Returns:
        The path.

    Raises:
        InputError: for other suffixes and precisions, missing units, and where the file cannot be written.

    Source:
        ISO 25178-72 (X3P).
    """
    from faying.units import scale

    instance(scan, Scan | Profile, "scan", "give a Scan or a Profile")
    file = checked_path(path, "path")
    suffix = file.suffix.lower()
    try:
        if suffix == ".x3p":
            x3p.write(scan, file, precision=precision)
        elif suffix in (".csv", ".txt", ".xyz"):
            if xy_unit is None or z_unit is None:
                raise InputError(
                    f'{file}: a text file states no unit; give it: write_scan(..., xy_unit="mm", z_unit="um")'
                )
            text.write(scan, file, xy=scale(xy_unit, "m", name="xy_unit"), z=scale(z_unit, "m", name="z_unit"))
        else:
            raise InputError(f"{file}: scans are written as .x3p, .csv, .txt or .xyz; choose one of these suffixes")
    except OSError as fault:
        raise InputError(f"{file}: cannot be written ({fault.strerror}); check folder and permissions") from None
    return file
