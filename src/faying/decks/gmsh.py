"""Gmsh's mesh files, 1, 2.0 to 2.2 and 4.1, text and binary: physical volumes are parts, physical surfaces are faces.

Formats after the Gmsh reference manual, section "Gmsh mesh file formats".
"""

import re
from pathlib import Path

import numpy as np

from faying.decks.raw import RawMesh, face_blocks, gathered, index, understood
from faying.errors import ReadError
from faying.fe.elements import from_edges
from faying.typing import Array, Index

_KINDS = {4: ("tet4", 4), 5: ("hex8", 8), 6: ("wedge6", 6), 11: ("tet10", 10), 17: ("hex20", 20), 18: ("wedge15", 15)}
_EARLIER = (b"1", b"2", b"2.0", b"2.1", b"2.2")  # their sections are the same
_FACES = {2: 3, 3: 4, 9: 6, 16: 8}
_PASSED = {1: 2, 8: 3, 15: 1}
_UNKNOWN = dict.fromkeys((7, 14, 19), "pyramids")
_UNKNOWN |= {10: "quadrangles of 9 nodes", 12: "bricks of 27 nodes", 13: "wedges of 18 nodes"}
_ORDER = {
    "tet10": from_edges("tet10", ((0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3))),
    "hex20": from_edges(
        "hex20", ((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7))
    ),
    "wedge15": from_edges("wedge15", ((0, 1), (0, 2), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5))),
}


class _Words:
    """The numbers of one section as text, read in turn; the same calls as of `_Bytes`."""

    def __init__(self, data: bytes, name: str) -> None:
        self.data, self.words, self.at, self.name = data, data.split(), 0, name

    def _take(self, count: int) -> list[bytes]:
        if count < 0 or self.at + count > len(self.words):
            raise ReadError(f"${self.name} ends in the middle of a record; is the file complete?")
        self.at += count
        return self.words[self.at - count : self.at]

    def ints(self, count: int) -> list[int]:
        return [int(i) for i in index(self._take(count))]

    def count(self) -> int:
        """How many records there are, each in a line of its own behind the line that says it."""
        count = self.ints(1)[0]
        lines = sum(bool(line.strip()) for line in self.data.splitlines()) - 1
        if lines != count:
            raise ReadError(f"${self.name} says {count} records and has {lines} lines of them; is the file complete?")
        return count

    sizes = ints

    def doubles(self, count: int) -> Array:
        return np.array(self._take(count), dtype=float)


class _Bytes:
    """The numbers of one section as Gmsh holds them in memory: int of 4 bytes, size_t and double of 8."""

    def __init__(self, data: bytes, name: str, order: str) -> None:
        self.data, self.at, self.name, self.order = data, 0, name, order

    def _take(self, kind: str, count: int) -> Array:
        end = self.at + int(kind[1]) * count
        if count < 0 or end > len(self.data):
            raise ReadError(f"${self.name} ends in the middle of a record; is the file complete?")
        self.at, start = end, self.at
        return np.frombuffer(self.data[start:end], dtype=self.order + kind)

    def count(self) -> int:
        line, _, _ = self.data[self.at :].partition(b"\n")
        self.at += len(line) + 1
        return int(line)

    def ints(self, count: int) -> list[int]:
        return [int(i) for i in self._take("i4", count)]

    def sizes(self, count: int) -> list[int]:
        return [int(i) for i in self._take("u8", count)]

    def doubles(self, count: int) -> Array:
        return np.asarray(self._take("f8", count), dtype=float)


def _sections(path: Path) -> tuple[bytes, dict[str, _Words | _Bytes]]:
    """The version of the format, and the sections that are read, which text and binary files share."""
    data = path.read_bytes()
    if re.match(rb"\s*\$NOD\s", data):  # format 1 states no version
        data = b"$MeshFormat\n1 0 8\n$EndMeshFormat\n" + data
        for early, late in ((b"NOD", b"Nodes"), (b"ELM", b"Elements")):
            data = data.replace(b"$" + early, b"$" + late).replace(b"$END" + early, b"$End" + late)
    if data[:200].split(b"$MeshFormat")[-1].split()[1:2] != [b"1"]:
        data = data.replace(b"\r\n", b"\n")
    if b"$MeshFormat" not in data[:200]:
        raise ReadError(f"{path} is not a Gmsh mesh file (no $MeshFormat)")
    head, _, rest = data.split(b"$MeshFormat", 1)[1].lstrip().partition(b"\n")
    words = head.split()
    after = rest.partition(b"$")[0].strip() if words[1:2] == [b"0"] else b""
    if after:
        raise ReadError(f"{path}: {after[:40].decode(errors='replace')!r} is in $MeshFormat, which has one line")
    if len(words) != 3 or words[0] not in (*_EARLIER, b"4.1") or words[1] not in (b"0", b"1") or not words[2].isdigit():
        kind = head.decode("utf-8", errors="replace")[:40]
        raise ReadError(f"{path} has format {kind!r}; save it in 4.1 or 2.2 (Mesh.MshFileVersion)")
    in_bytes = words[1] == b"1"
    if not in_bytes:
        _check_sections(data, path)
    elif words[2] != b"8" or rest[:4] not in (b"\1\0\0\0", b"\0\0\0\1"):
        raise ReadError(f"{path} is a binary file of unknown byte order; is the file complete?")
    order = ">" if rest[:1] == b"\0" else "<"
    out: dict[str, _Words | _Bytes] = {}
    for name in ("PhysicalNames", "Entities", "Nodes", "Elements"):
        begin, end = b"$" + name.encode() + b"\n", b"$End" + name.encode()
        start = data.find(begin)
        if start < 0 and name in ("Nodes", "Elements"):
            raise ReadError(f"{path} has no ${name}; the file is cut short or has no mesh")
        if start < 0:
            continue
        stop = data.find(end, start)
        if stop < 0:
            raise ReadError(f"{path}: ${name} has no $End{name}; the file is cut short")
        piece = data[start + len(begin) : stop]
        binary = in_bytes and name != "PhysicalNames"
        out[name] = _Bytes(piece, name, order) if binary else _Words(piece, name)
    return words[0], out


def _check_sections(data: bytes, path: Path) -> None:
    """Raise ReadError unless all lines of a text file stand in sections $NAME to $EndNAME."""
    inside = b""
    for number, line in enumerate(data.splitlines(), 1):
        word = line.strip()
        begins = word.startswith(b"$") and not word.startswith(b"$End")
        right = not word or bool(inside) or begins
        if word.startswith(b"$End"):
            right, inside = word[4:] == inside and bool(inside), b""
        elif begins:
            right, inside = not inside, word[1:]
        if not right:
            shown = word[:40].decode("utf-8", errors="replace")
            raise ReadError(
                f"{path}, line {number}: {shown!r} is in no section from $NAME to $EndNAME; is a line missing before "
                "it?"
            )


def _names(words: _Words | _Bytes | None) -> dict[tuple[int, int], str]:
    """Names of physical groups: (dimension, tag) -> name."""
    out: dict[tuple[int, int], str] = {}
    if words is None:
        return out
    count, *lines = words.data.splitlines() or [b""]
    if count.strip() != str(len(lines)).encode():
        shown = count.decode(errors="replace")[:60]
        raise ReadError(f"$PhysicalNames announces {shown!r} names and has {len(lines)}; is the file complete?")
    for line in lines:
        found = re.fullmatch(rb'\s*(?:([0-3])\s+)?(\d+)(?:\s+|(?="))"?([^"]*)"?\s*', line)
        if found is None:
            raise ReadError(
                f"$PhysicalNames: {line.decode(errors='replace')[:60]!r} should be dimension, number and name"
            )
        for dimension in (found[1],) if found[1] else range(4):  # 2.0 does not say which
            out[int(dimension), int(found[2])] = found[3].decode("utf-8", errors="replace").strip()
    return out


def read(path: Path) -> RawMesh:
    """Read a .msh file, text or binary. Raises ReadError for other versions, and elements it does not know."""
    version, sections = _sections(path)
    names = _names(sections.get("PhysicalNames"))
    nodes, elements = sections["Nodes"], sections["Elements"]
    with understood(f"{path} has something that is not a number"):
        if version in _EARLIER:
            numbers, points = _nodes_22(nodes)
            rows = _once(_elements_1(elements) if version == b"1" else _elements_22(elements))
        else:
            groups = _entities(sections.get("Entities"))
            numbers, points = _nodes_41(nodes)
            rows = _elements_41(elements, groups)
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
    for name in ("Entities", "Nodes", "Elements"):
        _used_up(sections.get(name), path)
    own, same = _distinct(bodies)
    if not solids:
        raise ReadError(f"{path} has no solid elements; mesh the volumes (gmsh -3) and save them all")
    return RawMesh(
        numbers=numbers,
        points=points,
        elements=gathered(solids),
        bodies={name: index(some) for name, some in own.items()},
        face_elements={name: face_blocks(some) for name, some in faces.items()},
        extra=index(extra),
        lines=index(node for _, code, _, corners in rows if code in (1, 8) for node in corners),
        notes=(
            *(
                f"the physical volumes {other!r} and {name!r} have the same elements; the part is called {name!r}"
                for other, name in same.items()
            ),
            *(
                f"the physical {'volume' if dimension == 3 else 'surface'} {name!r} has no elements"
                for (dimension, _), name in names.items()
                if dimension > 1 and version not in (b"2", b"2.0") and name not in (bodies if dimension == 3 else faces)
            ),
        ),
    )


def _used_up(words: _Words | _Bytes | None, path: Path) -> None:
    """Raise ReadError where a section of text holds more numbers than its records take."""
    if isinstance(words, _Words) and words.at < len(words.words):
        shown = b" ".join(words.words[words.at : words.at + 6]).decode("utf-8", errors="replace")
        raise ReadError(
            f"{path}: ${words.name} continues after its last record with {shown[:60]!r}; is a line there twice, or a "
            "count wrong?"
        )


def _distinct(bodies: dict[str, list[int]]) -> tuple[dict[str, list[int]], dict[str, str]]:
    """Bodies of different elements, and the name of the first one by that of each later one with the same elements."""
    first: dict[frozenset[int], str] = {}
    named = {name: first.setdefault(frozenset(some), name) for name, some in bodies.items()}
    own = {name: list(dict.fromkeys(bodies[name])) for name in first.values()}
    return own, {name: other for name, other in named.items() if name != other}


Rows = list[tuple[int, int, list[int], list[int]]]


def _once(rows: Rows) -> Rows:
    """Elements that stand once for each of their physical groups, as Gmsh 2.2 writes them, as one with all groups."""
    out: Rows = []
    place: dict[tuple[int, tuple[int, ...]], int] = {}
    for number, code, tags, corners in rows:
        at = place.setdefault((code, tuple(corners)), len(out))
        if at < len(out) and not set(tags) <= set(out[at][2]):
            out[at][2].extend(tags)
        else:
            out.append((number, code, list(tags), corners))
    return out


def _nodes_22(words: _Words | _Bytes) -> tuple[Index, Array]:
    count = words.count()
    if isinstance(words, _Bytes):
        record = np.dtype([("number", words.order + "i4"), ("place", words.order + "f8", 3)])
        piece = words.data[words.at : words.at + record.itemsize * max(count, 0)]
        if count < 0 or len(piece) != record.itemsize * count:
            raise ReadError("$Nodes ends in the middle of a record; is the file complete?")
        table = np.frombuffer(piece, dtype=record)
        return table["number"].astype(np.int64), np.asarray(table["place"], dtype=float)
    flat = words.doubles(4 * count).reshape(-1, 4)
    return index(words.words[1 : 1 + 4 * count : 4]), flat[:, 1:]


def _nodes_41(words: _Words | _Bytes) -> tuple[Index, Array]:
    blocks, _, _, _ = words.sizes(4)
    numbers: list[int] = []
    points: list[Array] = []
    for _ in range(blocks):
        _, _, parametric = words.ints(3)
        (count,) = words.sizes(1)
        if parametric:
            raise ReadError("the nodes carry parametric coordinates; save without (Mesh.SaveParametric = 0)")
        numbers += words.sizes(count)
        points.append(words.doubles(3 * count).reshape(-1, 3))
    return index(numbers), np.concatenate([np.zeros((0, 3)), *points])


def _entities(words: _Words | _Bytes | None) -> dict[tuple[int, int], list[int]]:
    """Physical groups of every entity: (dimension, tag) -> tags."""
    out: dict[tuple[int, int], list[int]] = {}
    if words is None:
        return out
    for dimension, count in enumerate(words.sizes(4)):
        for _ in range(count):
            (tag,) = words.ints(1)
            words.doubles(3 if dimension == 0 else 6)
            (groups,) = words.sizes(1)
            out[dimension, tag] = [abs(g) for g in words.ints(groups)]
            if dimension:
                (bounds,) = words.sizes(1)
                words.ints(bounds)
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


def _elements_1(words: _Words | _Bytes) -> Rows:
    """Number, kind, physical group, entity, count of nodes, and the nodes of each element."""
    out: Rows = []
    for _ in range(words.count()):
        number, code, group, _, count = words.ints(5)
        if count != _count(code):
            raise ReadError(f"element {number} has {count} nodes, where its kind has {_count(code)}")
        out.append((number, code, [group] if group else [], words.ints(count)))
    return out


def _elements_22(words: _Words | _Bytes) -> Rows:
    count = words.count()
    out: Rows = []
    while len(out) < count:
        number, code, tags = words.ints(3)
        if isinstance(words, _Bytes):  # a head for several: kind, how many, tags
            several, code = code, number
            width = 1 + tags + _count(code)
            table = np.array(words.ints(width * several)).reshape(-1, width).tolist()
            if not table or tags < 0:
                raise ReadError("$Elements has a head without elements; is the file complete?")
            out += [(row[0], code, [g for g in row[1 : 1 + tags][:1] if g], row[1 + tags :]) for row in table]
            continue
        groups = words.ints(tags)[:1]
        out.append((number, code, [g for g in groups if g], words.ints(_count(code))))
    return out


def _elements_41(words: _Words | _Bytes, groups: dict[tuple[int, int], list[int]]) -> Rows:
    blocks, _, _, _ = words.sizes(4)
    out: Rows = []
    for _ in range(blocks):
        dimension, entity, code = words.ints(3)
        (count,) = words.sizes(1)
        width = 1 + _count(code)
        table = index(words.sizes(width * count)).reshape(-1, width).tolist()
        out += [(row[0], code, groups.get((dimension, entity), []), row[1:]) for row in table]
    return out
