"""Gmsh's mesh files (.msh), format 2.2 and 4.1 as text: physical volumes are parts, physical surfaces are faces.

Formats after the Gmsh reference manual, section "Gmsh mesh file formats".
"""

from pathlib import Path

import numpy as np

from faying.decks.raw import RawMesh, face_blocks, from_edges, gathered, index
from faying.errors import ReadError

_KINDS = {4: ("tet4", 4), 5: ("hex8", 8), 6: ("wedge6", 6), 11: ("tet10", 10), 17: ("hex20", 20), 18: ("wedge15", 15)}
_FACES = {2: 3, 3: 4, 9: 6, 16: 8}
_PASSED = {1: 2, 8: 3, 15: 1}
_UNKNOWN = {
    7: "pyramids",
    10: "quadrangles of 9 nodes",
    12: "bricks of 27 nodes",
    13: "wedges of 18 nodes",
    14: "pyramids",
    19: "pyramids",
}
_ORDER = {
    "tet10": from_edges("tet10", ((0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3))),
    "hex20": from_edges(
        "hex20", ((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7))
    ),
    "wedge15": from_edges("wedge15", ((0, 1), (0, 2), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5))),
}


class _Words:
    """The words of one section, read in turn."""

    def __init__(self, words: list[str], name: str) -> None:
        self.words, self.at, self.name = words, 0, name

    def take(self, count: int) -> list[str]:
        if count < 0 or self.at + count > len(self.words):
            raise ReadError(f"${self.name} ends in the middle of a record; is the file whole?")
        self.at += count
        return self.words[self.at - count : self.at]

    def whole(self, count: int) -> list[int]:
        return [int(word) for word in self.take(count)]


def _sections(path: Path) -> dict[str, list[str]]:
    data = path.read_bytes()
    if b"$MeshFormat" not in data[:200]:
        raise ReadError(f"{path} is not a Gmsh mesh file (no $MeshFormat)")
    head = data.split(b"$MeshFormat", 1)[1].split()[:2]
    if head[1] != b"0":
        raise ReadError(f"{path} is a binary mesh file; save it as text (Mesh.Binary = 0)")
    if head[0] not in (b"2.2", b"4.1"):
        raise ReadError(f"{path} has format {head[0].decode()}; save it in 4.1 or 2.2 (Mesh.MshFileVersion)")
    lines = data.decode("utf-8", errors="replace").splitlines()
    out: dict[str, list[str]] = {"version": [head[0].decode()]}
    name = ""
    for line in lines:
        if line.startswith("$End"):
            name = ""
        elif line.startswith("$"):
            name = line[1:].strip()
            out[name] = []
        elif name:
            out[name].append(line)
    if name:
        raise ReadError(f"{path}: ${name} has no $End{name}; the file is cut short")
    for needed in ("Nodes", "Elements"):
        if needed not in out:
            raise ReadError(f"{path} has no ${needed}; the file is cut short or holds no mesh")
    return out


def read(path: Path) -> RawMesh:
    """Read a .msh file. Raises ReadError for binary files, other versions, and elements it does not know."""
    sections = _sections(path)
    names = {}
    for line in sections.get("PhysicalNames", [])[1:]:
        dimension, group, label = line.split(maxsplit=2)
        names[int(dimension), int(group)] = label.strip().strip('"')
    nodes = _Words(" ".join(sections["Nodes"]).split(), "Nodes")
    elements = _Words(" ".join(sections["Elements"]).split(), "Elements")
    try:
        if sections["version"] == ["2.2"]:
            numbers, points = _nodes_22(nodes)
            rows = _elements_22(elements)
        else:
            groups = _entities(_Words(" ".join(sections.get("Entities", [])).split(), "Entities"))
            numbers, points = _nodes_41(nodes)
            rows = _elements_41(elements, groups)
    except ReadError:
        raise
    except (ValueError, OverflowError) as fault:
        raise ReadError(f"{path} holds something that is not a number ({fault}); is the file whole?") from None
    solids: dict[str, list[tuple[int, list[int]]]] = {}
    bodies: dict[str, list[int]] = {}
    faces: dict[str, list[list[int]]] = {}
    extra: list[int] = []
    for number, code, tags, corners in rows:
        if code in _KINDS:
            kind = _KINDS[code][0]
            solids.setdefault(kind, []).append((number, [corners[i] for i in _ORDER.get(kind, range(len(corners)))]))
            for tag in tags:
                bodies.setdefault(names.get((3, tag), f"part{tag}"), []).append(number)
        else:
            extra += corners
            for tag in tags if code in _FACES else ():
                faces.setdefault(names.get((2, tag), f"face{tag}"), []).append(corners)
    if not solids:
        raise ReadError(f"{path} holds no solid elements; mesh the volumes (gmsh -3) and save them all")
    return RawMesh(
        numbers=numbers,
        points=points,
        elements=gathered(solids),
        bodies={name: index(dict.fromkeys(some)) for name, some in bodies.items()},
        face_elements={name: face_blocks(some) for name, some in faces.items()},
        extra=index(extra),
    )


def _nodes_22(words: _Words) -> tuple[np.ndarray, np.ndarray]:
    (count,) = words.whole(1)
    taken = words.take(4 * count)
    return index(taken[::4]), np.array(taken, dtype=float).reshape(-1, 4)[:, 1:]


def _nodes_41(words: _Words) -> tuple[np.ndarray, np.ndarray]:
    blocks, _, _, _ = words.whole(4)
    numbers: list[int] = []
    points: list[np.ndarray] = []
    for _ in range(blocks):
        _, _, parametric, count = words.whole(4)
        if parametric:
            raise ReadError("the nodes carry parametric coordinates; save without (Mesh.SaveParametric = 0)")
        numbers += words.whole(count)
        points.append(np.array(words.take(3 * count), dtype=float).reshape(-1, 3))
    return index(numbers), np.concatenate(points)


def _entities(words: _Words) -> dict[tuple[int, int], list[int]]:
    """Physical groups of every entity: (dimension, tag) -> tags."""
    if not words.words:
        return {}
    out = {}
    for dimension, count in enumerate(words.whole(4)):
        for _ in range(count):
            (tag,) = words.whole(1)
            words.take(3 if dimension == 0 else 6)
            (groups,) = words.whole(1)
            out[dimension, tag] = [abs(g) for g in words.whole(groups)]
            if dimension:
                (bounds,) = words.whole(1)
                words.take(bounds)
    return out


def _count(code: int) -> int:
    if code in _KINDS:
        return _KINDS[code][1]
    if code in _FACES or code in _PASSED:
        return (_FACES | _PASSED)[code]
    what = _UNKNOWN.get(code, f"elements of Gmsh's type {code}")
    raise ReadError(
        f"{what} are not known; mesh with tetrahedra, wedges or bricks, of second order without nodes in the "
        "middle of faces (Mesh.SecondOrderIncomplete = 1)"
    )


def _elements_22(words: _Words) -> list[tuple[int, int, list[int], list[int]]]:
    (count,) = words.whole(1)
    out = []
    for _ in range(count):
        number, code, tags = words.whole(3)
        groups = words.whole(tags)[:1]
        out.append((number, code, [g for g in groups if g], words.whole(_count(code))))
    return out


def _elements_41(
    words: _Words, groups: dict[tuple[int, int], list[int]]
) -> list[tuple[int, int, list[int], list[int]]]:
    blocks, _, _, _ = words.whole(4)
    out = []
    for _ in range(blocks):
        dimension, entity, code, count = words.whole(4)
        width = 1 + _count(code)
        table = index(words.take(width * count)).reshape(-1, width).tolist()
        out += [(row[0], code, groups.get((dimension, entity), []), row[1:]) for row in table]
    return out
