"""Text files of points: x, y, z on a regular grid (Nanovea and the like), x, z of a line, or a matrix of heights."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from faying.columns import line_count, mark_of, plain_unit, row_of_units, split_heading, states_unit, table_in_one_go
from faying.errors import ReadError
from faying.files import LATIN, refuse_decimal_comma
from faying.surface.heights import BYTES, check_points
from faying.surface.scan import Profile, Scan
from faying.typing import Array
from faying.units import scale

_UNITS = ("m", "mm", "um", "µm", "nm", "Å")  # that SurfaceTopography finds in a heading
Steps = Callable[[int, int], tuple[float, float]]
_NUMBER = re.compile(r"[+-]?(\d+(?:\.\d*)?|\.\d+)([eE][+-]?\d+)?$")
_SIZE = re.compile(r"#\s*(?:Width|Breite|Height|Höhe):\s*(\S+)\s*(\S+)\s*$")
_LATERAL = re.compile(r"#\s*Lateral units:\s*(\S+)\s*$")
_HEIGHTS = re.compile(r"#\s*Value units:\s*(\S+)\s*$")
_DEKTAK, _HFM = "Scan Data", "X;Y;valid"  # lines of two heads that the library of instruments reads
_MISSING = {"", "nan", "na", "n/a", "bad", "---", "***", "*"}


def _value(word: str) -> float | None:
    word = word.strip()
    if word.lower() in _MISSING:
        return float("nan")
    return float(word) if _NUMBER.match(word) else None


def _row(line: str, columns: int = 2) -> list[float] | None:
    """Numbers of a line, or None where it is a heading; empty ends beyond so many columns are not missing numbers."""
    words = line.split(";") if ";" in line else line.split(",") if "," in line else line.split()
    while len(words) > columns and not words[-1].strip():
        words.pop()
    values = [_value(w) for w in words]
    return None if len(values) < 2 or any(v is None for v in values) else [v for v in values if v is not None]


@dataclass(frozen=True, kw_only=True)
class TextLayout:
    """How a text file is laid out: numbers in a row (2: x,z; 3: x,y,z; more: a matrix of heights), lines of heading,
    metres per unit of x, y, z where the heading states them, places of x, y, z (or x, z) in a row; size (x, y) [m] of
    a matrix that states it; across: positions of its columns, where they stand above it, as those of its rows then do
    before each row; spoken: a line above the numbers that speaks of a unit and is not read."""

    columns: int
    heading: int
    units: tuple[float, float, float] | None = None
    order: tuple[int, ...] | None = None
    size: tuple[float, float] | None = None
    across: tuple[float, ...] | None = None
    spoken: str = ""

    @property
    def matrix(self) -> bool:
        """Whether the numbers are heights, with their positions or without."""
        return self.columns > 3 or self.size is not None


def layout(path: Path) -> TextLayout | None:
    """Return the layout of a text of numbers, None for any other file.

    A heading is a line such as "x [mm],y [mm],z [um]", or a comment, maybe with other lines above it and a row of units
    below it. A matrix has four numbers in a row or more, and either no heading, or a row and a column of positions with
    a word or nothing in their corner, or the comments of Gwyddion, which state size and unit. Raises ReadError for
    decimal commas.
    """
    with path.open("rb") as handle:
        head = handle.read(65536)
    if not head.strip() or b"\0" in head:
        return None
    lines = [line for line in head.decode("utf-8-sig", LATIN).splitlines() if line.strip()]
    comments = [line.strip() for line in lines if line.lstrip().startswith("#")]
    if sum(_SIZE.match(line) is not None for line in comments) > 2:
        raise ReadError(f"{path}: its comments state more than one size; export each map to a file of its own")
    size, units = _comments(comments, path)
    lines = [line for line in lines if not line.lstrip().startswith("#")]
    across = _positions_above(lines[: -1 or None])
    if across is not None:
        return TextLayout(columns=len(across) + 1, heading=1, across=across)
    above = next((k for k, line in enumerate(lines) if _row(line) is not None), 0)
    for line in lines[: above + 2]:
        refuse_decimal_comma(line, str(path))
    rows = lines[above:]
    found = [_row(line) for line in (rows[:-1] or rows)[:31]]
    if not found or found[0] is None:
        return None
    columns = _columns(rows[:-1] or rows, len(found[0]))
    words = [*comments, *lines[:above]]
    of_unit = (line.strip()[:80] for line in words if _states_size(line.strip()))
    spoken = next(of_unit, "") if units is None else ""
    if size is not None:
        return TextLayout(columns=len(found[0]), heading=above, units=units, size=size)
    heading = _headed(comments, lines[:above], columns, path)
    if heading is not None:
        units, order = heading
        return TextLayout(columns=max(columns, len(order)), heading=above, units=units, order=order, spoken=spoken)
    if any(line.strip().startswith((_DEKTAK, _HFM)) for line in lines[:above]):
        return None
    if any(row is not None and len(row) in (2, 3) for row in found):
        return TextLayout(columns=columns, heading=above, units=units, spoken=spoken) if columns in (2, 3) else None
    if above:
        return None
    alike = sum(row is not None and len(row) == len(found[0]) for row in found)
    if len(rows) > 2 and columns > 3 and alike > len(found) / 2:
        _refuse_more(path, [row for row in found if row is not None and len(row) == columns], columns)
        return TextLayout(columns=columns, heading=0, spoken=spoken)
    return None


def _positions_above(lines: list[str]) -> tuple[float, ...] | None:
    """The positions of the columns of a matrix, from a first line whose first cell is a word or empty; else None.

    They and the first numbers of the rows below it rise or fall in equal steps.
    """
    rows = [row for row in map(_row, lines[1:31]) if row is not None]
    if len(rows) < 4 or len(rows[0]) < 5 or any(len(row) != len(rows[0]) for row in rows):
        return None
    mark = mark_of(lines[0])
    corner, *words = lines[0].rstrip().split(mark) if mark else lines[0].split()
    values, first = [_value(word) for word in words], _value(corner)
    if (first is not None and np.isfinite(first)) or len(values) != len(rows[0]) - 1:
        return None
    across = [float("nan") if value is None else value for value in values]
    return tuple(across) if _in_equal_steps(np.array(across)) and _in_equal_steps(np.array(rows)[:, 0]) else None


def _refuse_more(path: Path, rows: list[list[float]], columns: int) -> None:
    """Raise ReadError where rows are x, y, z and more: one of the first two numbers runs on while the other stays."""
    first, second = np.array(rows)[:, :2].T
    stays = [int(np.argmax(np.append(values != values[0], True))) for values in (first, second)]
    if columns <= 6 and (_in_equal_steps(first[: stays[1]]) or _in_equal_steps(second[: stays[0]])):
        raise ReadError(
            f"{path}: rows of {columns} numbers, of which the first two run over a grid: x, y, z and {columns - 3} "
            f"column{'s' * (columns > 4)} more; leave only x, y, z in the file"
        )


def _columns(rows: list[str], first: int) -> int:
    """How many numbers a row has, where the last one of the first rows may be empty, a missing height."""
    if not rows or rows[0].strip()[-1:] not in (",", ";"):
        return first
    found = [_row(line) for line in rows]
    return max((len(row) for row in found if row is not None and len(row) <= first + 1), default=first)


def _comments(lines: list[str], path: Path) -> tuple[tuple[float, float] | None, tuple[float, float, float] | None]:
    """Size (x, y) [m] of a matrix, and metres per unit of x, y, z, from the comments of Gwyddion; None without them."""
    sizes, laterals, heights = (
        [found for line in lines if (found := one.match(line))] for one in (_SIZE, _LATERAL, _HEIGHTS)
    )
    if len(heights) != 1 or (len(sizes) != 2 and len(laterals) != 1):
        return None, None

    def metres(number: str, unit: str) -> float:
        value = _value(number)
        if value is None or not value > 0:
            raise ReadError(f"{path}: a size of {number} {unit} in its head; write a positive number such as 12.5 um")
        return value * scale(plain_unit(unit), "m", name=f"{path}, head")

    z = metres("1", heights[0][1])
    if len(sizes) == 2:
        return (metres(sizes[0][1], sizes[0][2]), metres(sizes[1][1], sizes[1][2])), (1.0, 1.0, z)
    xy = metres("1", laterals[0][1])
    return None, (xy, xy, z)


Heading = tuple[tuple[float, float, float] | None, tuple[int, ...]]


def _headed(comments: list[str], lines: list[str], columns: int, path: Path) -> Heading | None:
    """The heading: the last line above the numbers, or the one above a row of units; else a comment that is one."""
    if not lines:
        bare = [line.lstrip("# ") for line in comments]
        return next((_heading(line, path) for line in bare if len(split_heading(line)) == columns), None)
    units = row_of_units(split_heading(lines[-1]), ("m",) * columns)
    if units is None or len(lines) < 2:
        return _heading(lines[-1], path)
    found = _heading(lines[-2], path)
    factors = [scale(units[k], "m") for k in found[1]] if found is not None else []
    return found and ((factors[0], factors[-2], factors[-1]), found[1])


def _heading(line: str, path: Path) -> Heading | None:
    """Metres per unit of x, y, z, None where none is stated, and their places in a row; None where it is not a heading.

    Raises ReadError where columns beyond x, y, z stand in it, or only some state a unit.
    """
    if any(value is not None for value in map(_value, re.split(r"[,;\s]+", line.strip()))):
        return None
    cells = split_heading(line)
    names = ["z" if one.name in ("height", "h") else one.name for one in cells]
    wanted = "xyz" if {"x", "y", "z"} <= set(names) else "xz"
    if not set(wanted) <= set(names):
        return None
    if sorted(names) != sorted(wanted):
        odd = next(one.text for one, name in zip(cells, names, strict=True) if names.count(name) > (name in wanted))
        raise ReadError(
            f'{path}: the heading "{line.strip()[:80]}" has the column "{odd}", which is not read; leave only x, y, z '
            "(or x, z) in the file"
        )
    order = tuple(names.index(name) for name in wanted)
    stated = [cells[k].unit for k in order]
    if not any(stated):
        return None, order
    for k, unit in zip(order, stated, strict=True):
        if not unit:
            raise ReadError(f'{path}: the column "{cells[k].text}" of the heading states no unit; the others do')
    factors = [scale(unit, "m", name=f"{path}, heading") for unit in stated]
    return (factors[0], factors[-2], factors[-1]), order


def read(path: Path, how: TextLayout, scales: tuple[float, float, float], steps: Steps | None) -> Scan | Profile:
    """Read the points; `scales` are metres per unit of x, y, z, `steps` gives a matrix's spacing from its points.

    Raises ReadError for anything but a regular grid.
    """
    data = _table(path, how)
    x, y, z = scales
    if how.matrix:
        spacing = None
        if how.across is not None:
            (ix, dx), (iy, dy) = _axis(np.array(how.across), path, "x"), _axis(data[:, 0], path, "y")
            if len(np.unique(ix)) < len(ix) or len(np.unique(iy)) < len(iy):
                raise ReadError(f"{path}: two rows or two columns have one position; export the scan again")
            heights = np.full((int(iy.max()) + 1, int(ix.max()) + 1), np.nan)  # a row that is left out stays empty
            heights[iy[:, None], ix] = data[:, 1:]
            data, spacing = heights, (dx * x, dy * y)
        elif how.size is None:
            _refuse_positions(path, data)
        else:
            spacing = how.size[0] / data.shape[1], how.size[1] / data.shape[0]
        if how.size is None and steps is not None:
            spacing = steps(data.shape[1], data.shape[0])
        assert spacing is not None
        return Scan(heights=data * z, spacing=spacing, source=str(path))
    if how.order is not None:
        data = data[:, list(how.order)]
    return _line(path, data, x, z) if how.columns == 2 else _grid(path, data, x, y, z)


def _table(path: Path, how: TextLayout) -> Array:
    """Every row of numbers (n, columns). Raises ReadError that names the first line that is none."""
    points = line_count(path) * (how.columns if how.matrix else 1)
    check_points(str(path), points + 4 * path.stat().st_size / BYTES)
    table = _quickly(path, how)
    return _line_by_line(path, how) if table is None else table


def _quickly(path: Path, how: TextLayout) -> Array | None:
    """All rows in one go; None where something is to be said of one, or some words are not numbers."""
    skip, heading, first = 0, how.heading, ""
    with path.open(encoding="utf-8-sig", errors=LATIN) as handle:
        for line in handle:
            if line.strip() and not line.lstrip().startswith("#"):
                if not heading:
                    first = line
                    break
                heading -= 1
            skip += 1
    delimiter = next((mark for mark in ";," if mark in first), None)
    table = table_in_one_go(path, how.columns, delimiter=delimiter, skip=skip, comments=None)
    return None if table is None or len(table) < 4 else np.asarray(table)


def _line_by_line(path: Path, how: TextLayout) -> Array:
    rows: list[list[float]] = []
    skip = how.heading
    expected = f"a row of {how.columns} heights" if how.matrix else "x,y,z (or x,z)"
    for number, line in enumerate(path.read_text(encoding="utf-8-sig", errors=LATIN).splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        if skip:
            skip -= 1
            continue
        values = _row(line, how.columns)
        if values is None or len(values) != how.columns:
            refuse_decimal_comma(line, f"{path}, line {number}")
            shown = line.strip()[:40]
            raise ReadError(f'{path}: line {number} "{shown}" is not {expected} in numbers; the file is damaged')
        rows.append(values)
    if len(rows) < (2 if how.matrix else 4):
        raise ReadError(f"{path}: {len(rows)} points; a scan needs at least 2 x 2, the file is empty or cut off")
    return np.array(rows)


def refuse_lost(path: Path, points: int, *, unit: bool) -> None:
    """Raise ReadError where somebody else has read a text and not all of its numbers.

    points: how many heights were found; unit: whether one was. Readers that take any text lose lines without a row of
    numbers, marks of points that are not valid, and units that they do not know.
    """
    numbered = enumerate(path.read_text(encoding="utf-8-sig", errors=LATIN).splitlines(), 1)
    lines = [(number, line.strip()) for number, line in numbered if line.strip() and not line.lstrip().startswith("#")]
    start = next((k for k, (_, line) in enumerate(lines) if _row(line) is not None), len(lines))
    head = [line for _, line in lines[:start]]
    spoken = next((line[:80] for line in head if not unit and _states_size(line)), None)
    if spoken is not None:
        raise ReadError(f'{path}: "{spoken}" speaks of a unit and is not read; take the line out, and give the unit')
    width = 0
    for number, line in lines[start:]:
        row = _row(line)
        width = width or len(row or ())
        if row is None or len(row) != width:
            refuse_decimal_comma(line, f"{path}, line {number}")
            raise ReadError(f'{path}: line {number} "{line[:40]}" is not a row of numbers as those above it')
        if _HFM in head and row[-1] != 1:
            raise ReadError(f"{path}: line {number} is marked as not valid; take such lines out of the file")
    units = [words.split()[-1] for words in head[-1].strip(", ").split(",")[:2]] if _DEKTAK in head else []
    if units != ["um", "Micrometer"] and any(unit not in _UNITS for unit in units):
        raise ReadError(f'{path}: "{head[-1]}": the units that are read are {", ".join(_UNITS)}; write them there')
    count = len(lines) - start
    if not count:
        raise ReadError(f"{path}: no row of two numbers or more; write x,z or x,y,z in rows, or a matrix of heights")
    if points not in (count, count * width):
        raise ReadError(
            f"{path}: {points} heights were read of {count} rows of numbers: the form of its head is not known"
        )


def _states_size(line: str) -> bool:
    """Whether a line of words speaks of a unit or a size."""
    bare = any(plain_unit(word) in _UNITS for word in re.split(r"[,;\s]+", line))
    return bare or states_unit(line, ("m",)) or bool(_SIZE.match(line)) or line.lower().startswith("cellsize")


def _refuse_positions(path: Path, data: Array) -> None:
    """Raise ReadError where a matrix of heights holds positions or numbers of rows."""
    row, column = (
        _in_equal_steps(data[0, 1:]) and not _in_equal_steps(data[1, 1:]),
        _in_equal_steps(data[1:, 0]) and not _in_equal_steps(data[1:, 1]),
    )
    if row or column:
        which = " and ".join(["the first row"] * row + ["the first column"] * column)
        raise ReadError(
            f"{path}: {which} of the matrix rise{'s' * (row != column)} evenly, as positions or numbers of rows do and "
            "heights do not; take them out, so that the file has heights alone"
        )


def _in_equal_steps(values: Array) -> bool:
    """Whether four numbers or more rise or fall in equal steps."""
    if len(values) < 4 or not np.isfinite(values).all():
        return False
    steps = np.diff(values)
    mean = float(steps.mean())
    return abs(mean) > 0 and bool(np.abs(steps - mean).max() < 1e-3 * abs(mean))


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
    # positions rounded in the file have a median gap that is a little off: where none is missing, their number counts
    for count in (round(span / step), len(ordered) - 1):
        step = span / count
        index = np.rint((values - low) / step)
        if np.abs(values - low - index * step).max() <= 0.2 * step:
            break
    else:
        raise ReadError(f"{path}: the {name} are not evenly spaced (step {step:g}); export the scan on a regular grid")
    return index.astype(np.int64), step


def _grid(path: Path, data: Array, x: float, y: float, z: float) -> Scan:
    ix, dx = _axis(data[:, 0], path, "x")
    iy, dy = _axis(data[:, 1], path, "y")
    nx, ny = int(ix.max()) + 1, int(iy.max()) + 1
    cells = ix + nx * iy
    if nx * ny > 4 * len(data) or len(np.unique(cells)) != len(data):
        raise ReadError(
            f"{path}: {len(data)} points do not fill a grid of {nx} x {ny} once each; is it cut off, or not x, y and z?"
        )
    # in the order of the file, whichever way it runs: a file that was cut lacks the end of its last row
    row, along, length = (iy, ix, nx) if iy[0] == iy[1] else (ix, iy, ny)
    last = along[row == row[-1]]
    rises = last[-1] > last[0] if len(last) > 1 else along[1] > along[0]
    short = last[-1] != (length - 1 if rises else 0) and len(last) < length <= np.sum(row == row[0])
    top = ix[iy == ny - 1]
    if short or (len(top) < nx <= np.sum(iy == 0) and np.ptp(top) < nx - 1):
        raise ReadError(f"{path}: the last row has fewer points than the others; the file is cut off")
    heights = np.full(nx * ny, np.nan)
    heights[cells] = data[:, 2]
    return Scan(heights=heights.reshape(ny, nx) * z, spacing=(dx * x, dy * y), source=str(path))


def _line(path: Path, data: Array, x: float, z: float) -> Profile:
    if not np.isfinite(data[:, 0]).all():
        raise ReadError(f"{path}: some x are missing; only z may be")
    places, again = np.unique(data[:, 0], return_index=True)
    if len(places) != len(data):
        raise ReadError(f"{path}: two points share one x; a line scan has one height for each x")
    try:
        ix, dx = _axis(places, path, "x")
    except ReadError:
        if np.ptp(np.sign(np.diff(data[:, 0]))):  # they go to and fro
            raise
        return uneven_line(path, places * x, data[again, 1] * z)
    heights = np.full(int(ix.max()) + 1, np.nan)
    heights[ix] = data[again, 1]
    return Profile(heights=heights * z, spacing=dx * x, source=str(path))


ROUNDED = 0.1  # of a step: how far the positions of a line may be off an even grid


def uneven_line(path: Path, places: Array, heights: Array) -> Profile:
    """A line from rising positions [m] and heights [m]; those between larger gaps are interpolated, which a note says.

    Positions that are rounded in the file differ a little from an even grid, and stand for it.
    """
    gaps = np.diff(places)
    step = float(np.ptp(places)) / (len(places) - 1)
    even = places[0] + step * np.arange(len(places))
    if np.abs(places - even).max() <= ROUNDED * step:
        return Profile(heights=heights, spacing=step, source=str(path))
    note = (
        f"{path}: the steps of the line are {gaps.min():.3g} to {gaps.max():.3g} m; heights are interpolated at even "
        f"steps of {step:.3g} m"
    )
    return Profile(heights=np.interp(even, places, heights), spacing=step, source=str(path), notes=(note,))


def write(scan: Scan | Profile, path: Path, *, xy: float, z: float) -> None:
    """Write x,y,z (or x,z) lines without a heading, as the Nanovea instruments do; missing heights as "nan"."""
    n = scan.heights.shape
    if isinstance(scan, Profile):
        table = np.column_stack([np.arange(n[0]) * scan.spacing / xy, scan.heights / z])
    else:
        x, y = np.meshgrid(np.arange(n[1]) * scan.spacing[0] / xy, np.arange(n[0]) * scan.spacing[1] / xy)
        table = np.column_stack([x.ravel(), y.ravel(), scan.heights.ravel() / z])
    np.savetxt(path, table, fmt="%.10g", delimiter=",")
