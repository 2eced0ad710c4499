"""Text files of points: x, y, z on a regular grid (Nanovea and the like), or x, z of a line; no unit inside."""

import re
from pathlib import Path

import numpy as np

from faying.errors import ReadError
from faying.surface.scan import Profile, Scan
from faying.typing import Array

SUFFIXES = (".csv", ".txt", ".xyz", ".dat", ".asc")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$")
_MISSING = {"", "nan", "na", "n/a", "bad", "---", "***", "*"}


def _value(word: str) -> float | None:
    word = word.strip()
    if word.lower() in _MISSING:
        return float("nan")
    return float(word) if _NUMBER.match(word) else None


def _row(line: str) -> list[float] | None:
    """Numbers of a line, or None where it is a heading."""
    words = line.split(",") if "," in line else line.split(";") if ";" in line else line.split()
    while len(words) > 2 and not words[-1].strip():
        words.pop()
    values = [_value(w) for w in words]
    return None if len(values) < 2 or any(v is None for v in values) else [v for v in values if v is not None]


def looks_like(path: Path) -> bool:
    """Whether the file is text whose lines hold two or three numbers after at most 30 lines of heading."""
    with path.open("rb") as handle:
        head = handle.read(8192)
    if not head.strip() or b"\0" in head:
        return False
    lines = head.decode("latin-1").splitlines()
    rows = [_row(line) for line in lines[:-1] or lines if line.strip()]
    good = [r for r in rows[:31] if r is not None and len(r) in (2, 3)]
    return len(good) >= 1 and rows[0] is not None


def read(path: Path, xy: float, z: float) -> Scan | Profile:
    """Read the points; `xy` and `z` are metres per unit of the file. ReadError for anything but a regular grid."""
    data = _table(path)
    if data.shape[1] == 2:
        return _line(path, data, xy, z)
    return _grid(path, data, xy, z)


def _table(path: Path) -> Array:
    text = path.read_text(encoding="latin-1")
    rows: list[list[float]] = []
    columns = 0
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        values = _row(line)
        if values is None or len(values) not in (2, 3) or (columns and len(values) != columns):
            shown = line.strip()[:40]
            raise ReadError(f'{path}: line {number} "{shown}" is not x,y,z (or x,z) in numbers; the file is damaged')
        columns = len(values)
        rows.append(values)
    if len(rows) < 4:
        raise ReadError(f"{path}: {len(rows)} points; a scan needs at least 2 x 2, the file is empty or cut off")
    return np.array(rows)


def _axis(values: Array, path: Path, name: str) -> tuple[Array, float]:
    """Index of each value on an evenly spaced axis, and the spacing."""
    if not np.isfinite(values).all():
        raise ReadError(f"{path}: some {name} are missing; only z may be")
    low, span = float(values.min()), float(np.ptp(values))
    ordered = np.unique(values)
    gaps = np.diff(ordered)
    gaps = gaps[gaps > 1e-9 * span] if span > 0 else gaps[:0]
    if gaps.size == 0:
        raise ReadError(f"{path}: all {name} are the same ({low:g}); this is a single line, give x,z in two columns")
    step = float(np.median(gaps))
    count = round(span / step)
    step = span / count
    index = np.rint((values - low) / step)
    if np.abs(values - low - index * step).max() > 0.2 * step:
        raise ReadError(f"{path}: the {name} are not evenly spaced (step {step:g}); export the scan on a regular grid")
    return index.astype(np.int64), step


def _grid(path: Path, data: Array, xy: float, z: float) -> Scan:
    ix, dx = _axis(data[:, 0], path, "x")
    iy, dy = _axis(data[:, 1], path, "y")
    nx, ny = int(ix.max()) + 1, int(iy.max()) + 1
    cells = ix + nx * iy
    if nx * ny > 4 * len(data) or len(np.unique(cells)) != len(data):
        raise ReadError(
            f"{path}: {len(data)} points do not fill a grid of {nx} x {ny} once each; the file is cut off or damaged"
        )
    if int((iy == iy.max()).sum()) < nx <= int((iy == 0).sum()) and len(data) < nx * ny:
        raise ReadError(f"{path}: the last row holds fewer points than the others; the file is cut off")
    heights = np.full(nx * ny, np.nan)
    heights[cells] = data[:, 2]
    return Scan(heights=heights.reshape(ny, nx) * z, spacing=(dx * xy, dy * xy), source=str(path))


def _line(path: Path, data: Array, xy: float, z: float) -> Profile:
    ix, dx = _axis(data[:, 0], path, "x")
    if len(np.unique(ix)) != len(ix):
        raise ReadError(f"{path}: two points share one x; a line scan has one height for each x")
    heights = np.full(int(ix.max()) + 1, np.nan)
    heights[ix] = data[:, 1]
    return Profile(heights=heights * z, spacing=dx * xy, source=str(path))


def write(scan: Scan | Profile, path: Path, *, xy: float, z: float) -> None:
    """Write x,y,z (or x,z) lines without a heading, as the Nanovea instruments do; missing heights as "nan"."""
    n = scan.heights.shape
    if isinstance(scan, Profile):
        table = np.column_stack([np.arange(n[0]) * scan.spacing / xy, scan.heights / z])
    else:
        x, y = np.meshgrid(np.arange(n[1]) * scan.spacing[0] / xy, np.arange(n[0]) * scan.spacing[1] / xy)
        table = np.column_stack([x.ravel(), y.ravel(), scan.heights.ravel() / z])
    np.savetxt(path, table, fmt="%.10g", delimiter=",")
