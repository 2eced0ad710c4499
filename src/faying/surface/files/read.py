"""Instrument files in: X3P and text in the core, everything else through SurfaceTopography when it is installed."""

import gzip
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import BinaryIO

import numpy as np

from faying.checks import instance, several
from faying.checks import path as checked_path
from faying.errors import FayingError, InputError, ReadError
from faying.file_kinds import X3P, kind_held, kind_of, taken
from faying.files import UTF16, end_of
from faying.surface.files.text import TextLayout
from faying.surface.heights import ASK_SIZE, ASK_UNITS, BYTES, check_points, sides_of, steps_of
from faying.surface.scan import Profile, Scan
from faying.units import scale

Lengths = float | str | tuple[float, float] | tuple[str, str] | None


@dataclass(frozen=True, kw_only=True)
class Lateral:
    """What the caller says of the lateral extent [m]: the size of the scan or the spacing of its points, (x, y)."""

    size: tuple[float, float] | None = None
    spacing: tuple[float, float] | None = None

    @classmethod
    def of(cls, size: Lengths, spacing: Lengths) -> "Lateral":
        """Check and pair the numbers. InputError where both are given, or one is not positive."""
        if size is not None and spacing is not None:
            raise InputError("size and spacing: give one of the two, in metres")
        return cls(size=_pair(size, "size"), spacing=_pair(spacing, "spacing"))

    def __bool__(self) -> bool:
        return self.size is not None or self.spacing is not None

    def steps(self, nx: int, ny: int) -> tuple[float, float]:
        """Distances (dx, dy) [m] of a map of nx by ny points."""
        if self.spacing is not None:
            return self.spacing
        assert self.size is not None
        return self.size[0] / nx, self.size[1] / ny


def _pair(value: Lengths, name: str) -> tuple[float, float] | None:
    if value is None:
        return None
    x, y = several(value, name, 2, "m", alike=True, least=0)
    return x, y


def read_scan(
    path: str | Path,
    xy_unit: str | None = None,
    z_unit: str | None = None,
    *,
    size: Lengths = None,
    spacing: Lengths = None,
    channel: str | None = None,
) -> Scan | Profile:
    """Read a measured surface.

    X3P (ISO 25178-72) and plain text (x,y,z on a regular grid, x,z of a line, or a matrix of heights) are read by
    Faying itself, all other formats by SurfaceTopography when it is installed (`pip install SurfaceTopography`), zip
    containers of contact.engineering among them. Files packed by gzip (.gz) are unpacked.

    Args:
        path: the file.
        xy_unit: unit of x and y where the file states none, such as "mm".
        z_unit: unit of the heights where the file states none, such as "um".
        size: length of the scan, one or (x, y), [m] or text with a unit, where the file states none
            or one that cannot be.
        spacing: distance between points [m], in place of `size`.
        channel: name of the map of heights, where the file holds several.

    Returns:
        Scan, or Profile where the file holds one line.

    Raises:
        InputError: when a unit, a size or a channel is needed and not given, or given against the file.
        ReadError: for files that are missing, damaged, of an unknown format, or of implausible size.
    """
    file = checked_path(path, "path of a scan")
    for name, unit in (("xy_unit", xy_unit), ("z_unit", z_unit)):
        if unit is not None:
            scale(instance(unit, str, name, 'give the name of a unit as text, "mm" say'), "m", name=name)
    lateral = Lateral.of(size, spacing)
    _check_there(file)
    with unpacked(file) as plain:
        if kind_held(plain) is not None:  # what is not known may be of an instrument that SurfaceTopography knows
            taken(plain, "scan", "numbers")
        if kind_of(plain) is X3P:
            from faying.surface.files import x3p

            _no_units(plain, xy_unit, z_unit)
            _no_channel(plain, channel)
            scan: Scan | Profile = x3p.read(plain)
        else:
            scan = _text_or_other(plain, (xy_unit, z_unit), lateral, channel)
        scan = without_sentinels(_resized(scan, lateral))
        plausible(scan)
        notes = [note.replace(str(plain), str(file)) for note in (*scan.notes, *end_of(plain))]
    return replace(scan, source=str(file), notes=tuple(notes))


def _check_there(file: Path) -> None:
    """Raise ReadError where there is no such file, or nothing in it."""
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


def _no_units(file: Path, xy_unit: str | None, z_unit: str | None) -> None:
    if xy_unit is not None or z_unit is not None:
        raise InputError(f"{file}: the file states its units; leave out xy_unit and z_unit")


def _no_channel(file: Path, channel: str | None) -> None:
    if channel is not None:
        raise InputError(f"{file}: the file holds one map of heights; leave out channel")


def _text_or_other(
    file: Path, units: tuple[str | None, str | None], lateral: Lateral, channel: str | None
) -> Scan | Profile:
    from faying.surface.files import instruments, text

    try:
        layout = text.layout(file)
        if layout is None:
            return instruments.read(file, *units, lateral.steps if lateral else None, channel)
        _no_channel(file, channel)
        if layout.units is not None:
            _no_units(file, *units)
        scales = _scales(file, layout, *units, lateral)
        scan = text.read(file, layout, scales, lateral.steps if lateral else None)
        if layout.units is not None or not layout.spoken:
            return scan
        return replace(scan, notes=(*scan.notes, f'{file}: "{layout.spoken}" is not read; the unit is the one given'))
    except FayingError:
        raise
    except (ValueError, MemoryError, OverflowError) as fault:
        raise ReadError(f"{file}: the text cannot be read as x,y,z ({fault})") from fault


def _scales(
    file: Path, layout: TextLayout, xy_unit: str | None, z_unit: str | None, lateral: Lateral
) -> tuple[float, float, float]:
    """Metres per unit of x, y and z of a text file."""
    unread = f'"{layout.spoken}" is in words that are not read' if layout.spoken else ""
    if layout.units is not None:
        x, y, z = layout.units
        return x, y, z
    if layout.matrix and (lateral or layout.across is None):
        if not lateral or z_unit is None or xy_unit is not None:
            raise InputError(
                f"{file}: a matrix of heights: {unread or 'it states no size and no unit'}; {ASK_SIZE},"
                f' and z_unit, for example "um" (--z-unit um), and no xy_unit: the size has its own'
            )
        return 1.0, 1.0, scale(z_unit, "m", name="z_unit")
    if xy_unit is None or z_unit is None:
        lacking = [n for n, u in (("xy_unit", xy_unit), ("z_unit", z_unit)) if u is None]
        raise InputError(f"{file}: {unread or 'the file states no unit'}; give {' and '.join(lacking)}, {ASK_UNITS}")
    xy = scale(xy_unit, "m", name="xy_unit")
    return xy, xy, scale(z_unit, "m", name="z_unit")


def _resized(scan: Scan | Profile, lateral: Lateral) -> Scan | Profile:
    """The scan with the extent that the caller gives, where its own cannot be. InputError where it can."""
    if not lateral:
        return scan
    counts = scan.heights.shape
    steps = lateral.steps(counts[-1], counts[0])
    own = scan.spacing if isinstance(scan, Scan) else (scan.spacing, steps[1])
    if all(abs(a / b - 1) < 1e-6 for a, b in zip(steps, own, strict=True)):
        return scan
    sizes = sides_of(scan)[::-1]
    if _believable(sizes, own):
        shown = " x ".join(f"{s:.4g} m" for s in sizes)
        raise InputError(f"{scan.source}: the file states its size, {shown}; leave out size and spacing")
    notes = (*scan.notes, "the size is that given by the caller, in place of what the file states")
    if isinstance(scan, Scan):
        return replace(scan, spacing=steps, notes=notes)
    return replace(scan, spacing=steps[0], notes=notes)


MIN_ALIKE = 3  # heights that are exactly alike, below which they are spikes


def without_sentinels(scan: Scan | Profile) -> Scan | Profile:
    """The scan with heights missing that stand for "no data": one value, many times, far from all others.

    The least, or the greatest, height of a scan is such a value where it stands three times or more, its distance to
    the next one is more than the range of all others (ten times it, where more than half of the points are such), and
    it has at most nine points of ten. A note says it.
    """
    known = scan.heights[np.isfinite(scan.heights)]
    if not known.size:
        return scan
    ends = [end for end in (float(known.min()), float(known.max())) if np.sum(known == end) >= MIN_ALIKE]
    for some in (ends, *([end] for end in ends)):
        rest = known[~np.isin(known, some)]
        if not some or 10 * rest.size < known.size:
            continue
        span = float(np.ptp(rest))
        gaps = [float(np.abs(rest - end).min()) for end in some]
        if span > 0 and min(gaps) > span * (1 if 2 * rest.size >= known.size else 10):
            heights = np.where(np.isin(scan.heights, some), np.nan, scan.heights)
            notes = (
                f"{np.sum(known == end)} points are exactly {end:.6g} m high, {gap:.3g} m from all others, which are "
                f"within {span:.3g} m: they are taken as missing"
                for end, gap in zip(some, gaps, strict=True)
            )
            return replace(scan, heights=heights, notes=(*scan.notes, *notes))
    return scan


def _believable(sizes: tuple[float, ...], spacing: tuple[float, ...]) -> bool:
    return max(sizes) <= 10 and min(spacing) >= 1e-11


OUTLYING = 100.0  # sides of the scan: no point of a face lies so far from the others


def plausible(scan: Scan | Profile) -> None:
    """Raise ReadError where sizes or heights cannot be those of a measured surface: as a rule, a wrong unit."""
    sizes, spacing = sides_of(scan)[::-1], steps_of(scan)
    hint = "check the unit that the file states or that you gave"
    if not _believable(sizes, spacing):
        shown = " x ".join(f"{s:.3g} m" for s in sizes)
        raise ReadError(
            f"{scan.source}: a scan of {shown} with points {min(spacing):.3g} m apart; {hint}, or give the scan's true "
            "size or spacing in metres (size=4e-3)"
        )
    known = scan.heights[~np.isnan(scan.heights)]
    if known.size == 0:
        raise ReadError(f"{scan.source}: every point is missing; measure the surface again")
    low, high = np.quantile(known, [0.05, 0.95])
    span = float(high - low)
    if span > 3 * max(sizes):
        raise ReadError(f"{scan.source}: heights over {span:.3g} m on a scan of {max(sizes):.3g} m; {hint}")
    farthest = float(known[np.argmax(np.abs(known - np.median(known)))])
    if abs(farthest - float(np.median(known))) > OUTLYING * max(sizes):
        raise ReadError(
            f"{scan.source}: one height of {farthest:.3g} m on a scan of {max(sizes):.3g} m; the number is damaged, or "
            "stands for a missing point: take it out"
        )
    if 0 < span < max(1e-13, 1e-10 * max(sizes)):
        raise ReadError(f"{scan.source}: heights over {span:.3g} m, less than an atom; {hint}")


GZIP, DIGITAL_SURF, COMPRESSED = b"\x1f\x8b", b"DIGITAL SURF", b"DSCOMPRESSED"
HEADER = 512  # bytes of the header of Digital Surf, before the comment and the private zone
ZONES = 334  # where the header gives the length of these two, as two words
BLOCK = 1 << 20  # bytes that are unpacked at once
TIMES = 4  # as much memory as what is unpacked, while it is read: its text or bytes, and its numbers


@contextmanager
def unpacked(file: Path) -> Iterator[Path]:
    """The file, or a temporary one with what is compressed in it; faults that name the latter name the file.

    Raises ReadError where what is compressed is damaged, or does not fit into the memory.
    """
    with file.open("rb") as handle:
        head = handle.read(len(COMPRESSED))
    if not head.startswith((GZIP, COMPRESSED, *UTF16)):
        yield file
        return
    with TemporaryDirectory() as folder:
        plain = Path(folder) / file.name.removesuffix(".gz")
        try:
            with plain.open("wb") as out:
                (_gunzip if head.startswith(GZIP) else _points if head.startswith(COMPRESSED) else _utf8)(file, out)
        except (OSError, EOFError, zlib.error, struct.error) as fault:
            raise ReadError(f"{file}: it is compressed, and damaged or cut short ({fault}); copy it again") from None
        try:
            yield plain
        except FayingError as fault:
            raise type(fault)(str(fault).replace(str(plain), str(file))) from fault


def _gunzip(file: Path, out: BinaryIO) -> None:
    """Unpack a file of gzip."""
    size = 0
    with gzip.open(file) as packed:
        while block := packed.read(BLOCK):
            size += len(block)
            check_points(str(file), TIMES * size / BYTES)
            out.write(block)


def _utf8(file: Path, out: BinaryIO) -> None:
    """Write a text in UTF-16 as UTF-8."""
    check_points(str(file), TIMES * file.stat().st_size / BYTES)
    out.write(file.read_text("utf-16", "replace").encode())


def _points(file: Path, out: BinaryIO) -> None:
    """Write a file of Digital Surf with its points unpacked.

    Behind header, comment and private zone stand the number of pieces, the sizes of each, unpacked and packed, and the
    pieces, by zlib.
    """
    data = file.read_bytes()
    start = HEADER + sum(struct.unpack_from("<HH", data, ZONES))
    (count,) = struct.unpack_from("<I", data, start)
    sizes = [struct.unpack_from("<II", data, start + 4 + 8 * k) for k in range(count)]
    check_points(str(file), TIMES * sum(size for size, _ in sizes) / BYTES)
    out.write(DIGITAL_SURF + data[len(COMPRESSED) : start])
    at = start + 4 + 8 * count
    for size, packed in sizes:
        piece = zlib.decompressobj().decompress(data[at : at + packed], size)
        if len(piece) < size:
            raise EOFError(f"{len(piece)} of {size} bytes")
        out.write(piece)
        at += packed
