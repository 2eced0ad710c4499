"""ANSYS archives (.cdb, written by CDWRITE in blocked format): NBLOCK, EBLOCK, ET and CMBLOCK.

Layout after the description of CDWRITE in the Mechanical APDL command reference. Components of nodes become faces,
components of elements parts.
"""

import re
from pathlib import Path

import numpy as np

from faying.errors import ReadError
from faying.fe.formats.raw import RawMesh, gathered, index, undoubled

_SOLIDS = {"185": 8, "186": 20, "187": 10, "285": 4, "45": 8, "95": 20, "92": 10}
_SURFACE = ("154", "152", "170", "171", "172", "173", "174", "175", "200", "21", "14")


def read(path: Path) -> RawMesh:
    """Read an archive. Raises ReadError for unblocked archives, other elements, and files cut short."""
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    kinds: dict[int, str] = {}
    numbers: list[int] = []
    points: list[list[float]] = []
    rows: dict[str, list[tuple[int, list[int]]]] = {}
    sets: dict[str, dict[str, np.ndarray]] = {"NODE": {}, "ELEM": {}}
    extra: list[int] = []
    k = 0
    try:
        while k < len(lines):
            words = [word.strip() for word in lines[k].split(",")]
            name = words[0].upper()
            if name == "ET" and len(words) > 2:
                kinds[int(words[1])] = re.sub(r"\D", "", words[2])
            elif name == "NBLOCK":
                k = _nodes(lines, k, numbers, points)
                continue
            elif name == "EBLOCK":
                k = _elements(lines, k, words, kinds, rows, extra)
                continue
            elif name == "CMBLOCK":
                width = _widths(lines[k + 1])[0]
                count = int(words[3].split("!")[0])
                k, values = _block(lines, k + 2, count, width)
                sets[words[2].upper()[:4]][words[1]] = _unrolled(values)
                continue
            k += 1
    except ReadError:
        raise
    except (ValueError, IndexError, KeyError) as fault:
        raise ReadError(
            f"{path.name}, line {min(k, len(lines)) + 1}: cannot be read ({fault}); is the archive whole and "
            "in blocked format (CDWRITE)?"
        ) from None
    if not numbers or not rows:
        raise ReadError(
            f"{path} holds {len(numbers)} nodes in NBLOCK and {sum(map(len, rows.values()))} solids in EBLOCK; "
            "write the archive with CDWRITE,DB in blocked format"
        )
    return RawMesh(
        numbers=index(numbers),
        points=np.array(points),
        elements=gathered(rows),
        element_sets=sets["ELEM"],
        node_sets=sets["NODE"],
        extra=index(extra),
    )


def _widths(form: str) -> tuple[int, int, int]:
    """Width of an integer, how many come first, and width of a real, from a Fortran format such as (3i9,6e21.13e3)."""
    found = re.search(r"\((\d+)i(\d+)(?:,\d+e(\d+))?", form.lower())
    if not found:
        raise ValueError(f"{form.strip()!r} is not a format")
    return int(found.group(2)), int(found.group(1)), int(found.group(3) or 0)


def _nodes(lines: list[str], k: int, numbers: list[int], points: list[list[float]]) -> int:
    width, count, real = _widths(lines[k + 1])
    k += 2
    while not re.match(r"\s*(-1|N,)", lines[k], re.I):
        line = lines[k]
        start = width * count
        cells = [line[start + i * real : start + (i + 1) * real].strip() for i in range(3)]
        numbers.append(int(line[:width]))
        points.append([float(cell.replace("D", "E")) if cell else 0.0 for cell in cells])
        k += 1
    return k + 1


def _elements(
    lines: list[str],
    k: int,
    words: list[str],
    kinds: dict[int, str],
    rows: dict[str, list[tuple[int, list[int]]]],
    extra: list[int],
) -> int:
    if len(words) < 3 or words[2].upper() != "SOLID":
        raise ReadError(f"line {k + 1}: EBLOCK without the key SOLID is not known; write the archive with CDWRITE,DB")
    width, _, _ = _widths(lines[k + 1])
    k += 2
    while True:
        head = _cut(lines[k], width)
        if head[0] == -1:
            return k + 1
        count, number, nodes = head[8], head[10], head[11:]
        k += 1
        while len(nodes) < count:
            nodes += _cut(lines[k], width)
            k += 1
        which = kinds[head[1]]
        if which in _SURFACE:
            extra += nodes
            continue
        if which not in _SOLIDS:
            raise ReadError(f"element {number} is of type {which}; known are SOLID185, 186, 187 and 285")
        kind, held = undoubled(
            nodes[: _SOLIDS[which]] if which != "285" else nodes[:4], f"element {number} (SOLID{which})"
        )
        rows.setdefault(kind, []).append((number, held))


def _cut(line: str, width: int) -> list[int]:
    cells = [line[i : i + width] for i in range(0, len(line.rstrip()), width)]
    return [int(cell) for cell in cells]


def _block(lines: list[str], k: int, count: int, width: int) -> tuple[int, list[int]]:
    values: list[int] = []
    while len(values) < count:
        values += _cut(lines[k], width)
        k += 1
    return k, values


def _unrolled(values: list[int]) -> np.ndarray:
    """A negative number ends a range that begins with the number before it."""
    out: list[int] = []
    for value in values:
        out += range(out[-1] + 1, -value + 1) if value < 0 else [value]
    return index(out)
