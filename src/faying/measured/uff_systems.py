"""Coordinate systems of universal files, data sets 18 and 2420, and modes of data set 2414, from their text.

The formats: University of Cincinnati, Structural Dynamics Research Lab, https://www.ceas3.uc.edu/sdrluff.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import ReadError
from faying.typing import Array

KINDS = {0: "Cartesian", 1: "cylindrical", 2: "spherical"}
COMPLEX = {5: True, 6: True, 2: False, 4: False}  # data types of data set 2414
MODES = (2, 3, 7)  # analysis types: normal modes, complex ones of first and of second order
DISPLACEMENT = 8  # result type


@dataclass(frozen=True, kw_only=True)
class UffSystem:
    """A coordinate system of a test: kind (0 Cartesian, 1 cylindrical, 2 spherical), rows of its axes (3, 3) and its
    origin (3,) in the axes and units of the file."""

    kind: int
    axes: Array
    origin: Array

    def place(self, xyz: Array) -> Array:
        """A place (3,) of this system in the axes of the file."""
        return np.asarray(xyz @ self.axes + self.origin)

    @property
    def turned(self) -> bool:
        """Whether its axes are not those of the file."""
        return not np.allclose(self.axes, np.eye(3), atol=1e-9)


def blocks(file: Path, kind: int) -> list[list[str]]:
    """The lines of each data set of one number, in the order of the file."""
    lines = file.read_bytes().split(b"\n")
    marks = [k for k, line in enumerate(lines) if line.strip() == b"-1"]
    out = []
    for k in marks:
        if k + 1 < len(lines) and lines[k + 1].split()[:1] == [str(kind).encode()]:
            end = next((m for m in marks if m > k), len(lines))
            out.append([line.decode("utf-8", "replace").rstrip("\r") for line in lines[k + 2 : end]])
    return out


def systems(file: Path, sets: Iterable[Mapping[str, Any]]) -> dict[int, UffSystem]:
    """All coordinate systems of a file by their numbers. ReadError where one is damaged or given twice, differently."""
    out: dict[int, UffSystem] = {}
    for s in sets:
        if s["type"] == 2420:
            for label, kind, matrix in zip(s["CS_sys_labels"], s["CS_types"], s["CS_matrices"], strict=True):
                m = np.asarray(matrix, float)
                _add(out, file, int(label), UffSystem(kind=int(kind), axes=m[:3], origin=m[3]))
    own: dict[int, tuple[int, int, Array]] = {}
    for lines in blocks(file, 18):
        for label, record in _records(file, lines).items():
            before = own.setdefault(label, record)
            if before[:2] != record[:2] or not np.allclose(before[2], record[2], rtol=1e-5, atol=1e-9):
                raise ReadError(f"{file}: coordinate system {label} appears twice, differently; export the test again")
    for label in own:
        _add(out, file, label, _resolved(file, label, own, ()))
    return out


def _add(out: dict[int, UffSystem], file: Path, label: int, system: UffSystem) -> None:
    before = out.get(label)
    same = before is None or (
        before.kind == system.kind
        and np.allclose(before.axes, system.axes, atol=1e-5)
        and np.allclose(before.origin, system.origin, atol=1e-5 * max(1.0, float(np.abs(system.origin).max())))
    )
    if not same:
        raise ReadError(f"{file}: coordinate system {label} appears twice, differently; export the test again")
    if system.kind not in KINDS or not (np.all(np.isfinite(system.axes)) and np.all(np.isfinite(system.origin))):
        raise ReadError(f"{file}: coordinate system {label} is damaged or of kind {system.kind}; export the test again")
    out.setdefault(label, system)


def _records(file: Path, lines: list[str]) -> dict[int, tuple[int, int, Array]]:
    """Kind, reference system, and origin, point on x, point in xz (3, 3) of each system of data set 18."""
    out = {}
    rows = [line for line in lines if line.strip()]
    for k in range(0, len(rows), 4):
        try:
            label, kind, reference = (int(rows[k][10 * i : 10 * i + 10]) for i in range(3))
            words = [rows[j][13 * i : 13 * i + 13] for j in (k + 2, k + 3) for i in range(6)]
            points = np.array([float(word.replace("D", "E").replace("d", "e")) for word in words if word.strip()])
            out[label] = kind, reference, points.reshape(3, 3)
        except (ValueError, IndexError):
            shown = " / ".join(row.strip() for row in rows[k : k + 4])[:120]
            raise ReadError(
                f'{file}: the coordinate system "{shown}" of data set 18 has no three points in three coordinates; the '
                "file is damaged, export it again"
            ) from None
    return out


def _resolved(file: Path, label: int, own: Mapping[int, tuple[int, int, Array]], above: tuple[int, ...]) -> UffSystem:
    """One system of data set 18 in the axes of the file, through the systems that it refers to."""
    if label in above:
        raise ReadError(f"{file}: coordinate systems {above} of data set 18 refer to each other; export the test again")
    kind, reference, points = own[label]
    if reference in own and reference != label:
        base = _resolved(file, reference, own, (*above, label))
        if base.kind != 0:
            raise ReadError(
                f"{file}: coordinate system {label} is given in the {KINDS.get(base.kind)} system {reference}; export "
                "it in a Cartesian one"
            )
        points = np.array([base.place(p) for p in points])
    elif reference not in (0, label):
        raise ReadError(
            f"{file}: coordinate system {label} refers to system {reference}, which is not in the file; export it"
        )
    origin, on_x, in_xz = points
    x, z = on_x - origin, in_xz - origin
    y = np.cross(z, x)
    size = np.linalg.norm(x), np.linalg.norm(y)
    if not min(size) > 1e-6 * max(float(np.linalg.norm(z)), float(size[0]), 1e-300):
        raise ReadError(
            f"{file}: the three points of coordinate system {label} (data set 18) are on one line; export it again"
        )
    x, y = x / size[0], y / size[1]
    return UffSystem(kind=kind, axes=np.stack([x, y, np.cross(x, y)]), origin=origin)


def export_note(file: Path, labels: Iterable[int]) -> str:
    """What the reader of a test and that of a mesh say where points of data set 2411 name an export system."""
    shown = ", ".join(str(label) for label in sorted(labels))
    return (
        f"{file}: points of data set 2411 name the export system {shown}; the format gives their places in the axes of "
        "the part, and so they are taken; check the shape"
    )


NodalShape = tuple[float, float, list[int], Array]  # frequency [Hz], loss factor, points (p,) and motion (p, 3)


def shapes_2414(file: Path) -> tuple[list[NodalShape], list[str]]:
    """The modes of data sets 2414, and a sentence for what else such data sets hold. ReadError where one is damaged."""
    found, notes = [], []
    for k, lines in enumerate(blocks(file, 2414)):
        try:
            head = [int(word) for word in lines[8].split()]
            location, title, _ = int(lines[2]), lines[1].strip(), head[5]
        except (ValueError, IndexError):
            raise ReadError(
                f"{file}: data set 2414 (the {k + 1}. of them) has no head in numbers; export it again"
            ) from None
        if location != 1 or head[1] not in MODES or head[3] != DISPLACEMENT:
            notes.append(
                f'{file}: the data set 2414 "{title}" holds results of analysis type {head[1]}, result type '
                f"{head[3]}, at location {location}, which are not mode shapes; it is left out"
            )
            continue
        try:
            found.append(_shape(lines, head))
        except (ValueError, IndexError):
            raise ReadError(
                f'{file}: the mode "{title}" of data set 2414 should have two lines of six numbers, then {head[5]} at '
                "each point; the file is damaged, export it again"
            ) from None
    return found, notes


def _numbers(line: str) -> list[float]:
    """The numbers of a line of 6E13.5, which may touch each other."""
    words = line.split()
    if any(len(word) > 13 for word in words):
        words = [line[i : i + 13] for i in range(0, len(line.rstrip()), 13)]
    return [float(word.replace("D", "E").replace("d", "e")) for word in words]


def _shape(lines: list[str], head: list[int]) -> NodalShape:
    times, poles = _numbers(lines[11]), _numbers(lines[12])
    count = head[5] * (2 if COMPLEX[head[4]] else 1) if head[4] in COMPLEX else -1
    if head[5] not in (3, 6) or len(times) != 6 or len(poles) != 6:
        raise ValueError
    points, values = [], []
    body = [line for line in lines[13:] if line.strip()]
    k = 0
    while k < len(body):
        points.append(int(body[k]))
        row: list[float] = []
        k += 1
        while len(row) < count:
            row += _numbers(body[k])
            k += 1
        if len(row) != count:
            raise ValueError
        numbers = np.array(row)
        values.append((numbers[::2] + 1j * numbers[1::2] if COMPLEX[head[4]] else numbers)[:3])
    if not points:
        raise ValueError
    pole = complex(poles[0], poles[1])
    frequency, loss = of_pole(pole) if head[1] != 2 and pole else (times[1], 2 * times[4] or times[5])
    return frequency, loss, points, np.array(values)


def of_pole(pole: complex) -> tuple[float, float]:
    """Frequency [Hz] and loss factor of a pole [1/s]."""
    return abs(pole) / (2 * np.pi), -2 * pole.real / abs(pole) if abs(pole) else 0.0
