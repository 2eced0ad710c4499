"""Universal files with meshes (.unv), of I-DEAS, SALOME and others: groups are parts and faces.

Data sets 2411 (nodes), 2412 (elements), and 2467, 2477, 2452, 2435 (groups), after the universal file datasets of the
Structural Dynamics Research Laboratory, University of Cincinnati.
"""

import re
from pathlib import Path

import numpy as np

from faying.data_sets import check_data_sets
from faying.decks.raw import RawMesh, face_blocks, gathered, index, not_in_file, read_text
from faying.errors import ReadError

_NODES, _ELEMENTS, _GROUPS = ("2411", "781"), ("2412", "780"), ("2467", "2477", "2452", "2435")
# code of a finite element: kind, and the places of its nodes, which run round: corner, middle, corner, ...
_KINDS = {
    111: ("tet4", range(4)),
    112: ("wedge6", range(6)),
    115: ("hex8", range(8)),
    118: ("tet10", (0, 2, 4, 9, 1, 3, 5, 6, 7, 8)),
    113: ("wedge15", (0, 2, 4, 9, 11, 13, 1, 3, 5, 10, 12, 14, 6, 7, 8)),
    116: ("hex20", (0, 2, 4, 6, 12, 14, 16, 18, 1, 3, 5, 7, 13, 15, 17, 19, 8, 9, 10, 11)),
}
_FACES = {code: tuple(range(3)) for code in (41, 51, 61, 74, 81, 91)}
_FACES |= {code: tuple(range(4)) for code in (44, 54, 64, 71, 84, 94)}
_FACES |= dict.fromkeys((42, 52, 62, 72, 82, 92), (0, 2, 4, 1, 3, 5))
_FACES |= dict.fromkeys((45, 55, 65, 75, 85, 95), (0, 2, 4, 6, 1, 3, 5, 7))
_BEAMS = (11, 21, 22, 23, 24)  # with a line of their own between head and nodes


def _datasets(path: Path) -> list[tuple[str, list[str]]]:
    """Number and lines of every data set."""
    lines = [line.rstrip("\r") for line in read_text(path, "universal file").split("\n")]
    marks = [k for k, line in enumerate(lines) if line.strip() == "-1"]
    if not marks:
        raise ReadError(f"{path} is not a universal file (no line -1)")
    if len(marks) % 2:
        raise ReadError(f"{path}: the last data set has no end (-1); the file is cut short")
    check_data_sets(lines, path.name)
    return [(lines[a + 1].strip(), lines[a + 2 : b]) for a, b in zip(marks[::2], marks[1::2], strict=True)]


def read(path: Path) -> RawMesh:
    """Read a mesh from a universal file. Raises ReadError for files cut short and elements it does not know."""
    points: dict[int, list[float]] = {}
    solids: dict[str, list[tuple[int, list[int]]]] = {}
    shells: dict[int, list[int]] = {}
    extra: list[int] = []
    groups: dict[str, tuple[list[int], list[int]]] = {}
    notes: list[str] = []
    exported: set[int] = set()
    known_elements: set[int] = set()  # numbers of all elements, those that are left out among them
    datasets = _datasets(path)
    moved = {label for number, lines in datasets if number == "2420" for label in _moved(lines)}
    for number, lines in datasets:
        if number == "164":
            notes.append(
                f"the file states its units, {lines[0].strip()!r}, in data set 164; they are not read, the unit is the "
                "one that the study gives"
            )
        elif number in _NODES:
            for head, place in zip(lines[::2], lines[1::2], strict=True):
                label, system, _, _ = _whole_numbers(path, head, 4)
                exported |= {system} & moved
                at = [float(word.replace("D", "E")) for word in place.split()]
                if len(at) != 3:
                    raise ReadError(f"{path}: node {label} has no three coordinates; is the file complete?")
                if points.setdefault(label, at) != at:
                    raise ReadError(f"{path}: node {label} is given twice, at different places")
        elif number in _ELEMENTS:
            extra += _elements(path, lines, solids, shells, known_elements)
        elif number in _GROUPS:
            groups |= _groups(path, lines)
    if exported:
        notes.append(
            f"nodes of data set 2411 name the export system {', '.join(map(str, sorted(exported)))}; the format gives "
            "their places in the axes of the part, and so they are taken; check the shape"
        )
    for name, (elements, _) in groups.items():
        notes += not_in_file(f"the group {name!r}", "elements", elements, known_elements)
    faces = {name: [shells[e] for e in elements if e in shells] for name, (elements, _) in groups.items()}
    bodies = {name: index(e for e in elements if e not in shells) for name, (elements, _) in groups.items()}
    return RawMesh(
        numbers=index(points),
        points=np.array(list(points.values())).reshape(-1, 3),
        elements=gathered(solids),
        element_sets={name: some for name, some in bodies.items() if len(some)},
        node_sets={name: index(nodes) for name, (_, nodes) in groups.items() if nodes},
        face_elements={name: face_blocks(some) for name, some in faces.items() if some},
        extra=index([*extra, *(n for nodes in shells.values() for n in nodes)]),
        lines=index(extra),
        notes=tuple(notes),
    )


def _whole_numbers(path: Path, line: str, count: int, what: str = "a node") -> list[int]:
    """The numbers of a line that holds so many whole ones. Raises ReadError for another line."""
    words = line.split()
    if len(words) != count or not all(re.fullmatch(r"[-+]?\d+", word) for word in words):
        raise ReadError(
            f"{path}: {line.strip()[:60]!r} heads {what} and should be {count} whole numbers; is it damaged?"
        )
    return [int(word) for word in words]


def _moved(lines: list[str]) -> list[int]:
    """Numbers of the coordinate systems of data set 2420 that are not the axes of the part."""
    out = []
    for k in range(2, len(lines) - 5, 6):
        rows = np.array([[float(w.replace("D", "E")) for w in line.split()] for line in lines[k + 2 : k + 6]])
        if not np.allclose(rows, np.eye(4, 3), atol=1e-9):
            out.append(int(lines[k].split()[0]))
    return out


def _elements(
    path: Path,
    lines: list[str],
    solids: dict[str, list[tuple[int, list[int]]]],
    shells: dict[int, list[int]],
    known_elements: set[int],
) -> list[int]:
    """Sort the elements of a data set into solids and shells; return the nodes of beams."""
    beams: list[int] = []
    k = 0
    while k < len(lines):
        head = index(lines[k].split())
        if len(head) < 6:
            raise ReadError(f"{path}: the element {lines[k].strip()!r} has no six numbers; is the file complete?")
        number, code, count = int(head[0]), int(head[1]), int(head[5])
        known_elements.add(number)
        k += 2 if code in _BEAMS else 1
        nodes: list[int] = []
        while len(nodes) < count and k < len(lines):
            nodes += index(lines[k].split()).tolist()
            k += 1
        places = _KINDS[code][1] if code in _KINDS else _FACES.get(code, range(count))
        if len(nodes) != count or len(places) != count:
            raise ReadError(f"{path}: element {number} (kind {code}) has {len(nodes)} nodes; is the file complete?")
        ordered = [nodes[i] for i in places]
        if code in _KINDS:
            solids.setdefault(_KINDS[code][0], []).append((number, ordered))
        elif code in _FACES:
            shells[number] = ordered
        elif code in _BEAMS or count < 3:
            beams += nodes
        else:
            known = ", ".join(f"{c} ({kind})" for c, (kind, _) in _KINDS.items())
            raise ReadError(f"{path}: elements of kind {code} are not known; the known ones are {known}")
    return beams


def _groups(path: Path, lines: list[str]) -> dict[str, tuple[list[int], list[int]]]:
    """Elements and nodes of every group by its name."""
    out: dict[str, tuple[list[int], list[int]]] = {}
    k = 0
    while k + 1 < len(lines):
        if not lines[k].strip():  # SALOME writes an empty line after a group of no members
            k += 1
            continue
        count, name = _whole_numbers(path, lines[k], 8, "a group")[-1], lines[k + 1].strip()
        if re.fullmatch(r"(\d+\s+){3,}\d+", name):
            raise ReadError(f"{path}: {name[:60]!r} is where a group has its name; is the count of one wrong?")
        words: list[int] = []
        k += 2
        while len(words) < 4 * count and k < len(lines):
            words += index(lines[k].split()).tolist()
            k += 1
        if len(words) != 4 * count:
            raise ReadError(f"{path}: group {name!r} names {count} things and has {len(words) // 4}")
        pairs = list(zip(words[::4], words[1::4], strict=True))
        out[name] = ([tag for kind, tag in pairs if kind == 8], [tag for kind, tag in pairs if kind == 7])
    return out
