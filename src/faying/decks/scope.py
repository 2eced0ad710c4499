"""What one part, instance or the whole of an Abaqus input file holds, keyword by keyword."""

import re
from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, field

import numpy as np

from faying.decks.keywords import DATA, Block
from faying.decks.raw import index, ranged, understood
from faying.decks.vocabulary import abaqus_kind
from faying.errors import ReadError
from faying.typing import Array, Index

_SOLID = {"C3D4": "tet4", "C3D10": "tet10", "C3D8": "hex8", "C3D20": "hex20", "C3D6": "wedge6", "C3D15": "wedge15"}
_SHEET = re.compile(r"^(?:S|STRI|CPS|CPE|M3D|SFM3D|R3D)(\d+)")
_SHEET_COUNT = {"3": 3, "4": 4, "6": 6, "8": 8, "65": 6}
# elements that are left out, with their nodes; those that carry stiffness or mass are named in a note
_LINE = re.compile(
    r"^(T3D[23]|B3[123]|MASS|ROTARYI|SPRING[A12]|DASHPOT[A12]|CONN3D2|DCOUP3D|GAP\w*|JOINTC|PSI\w*|RB3D2|D$|U\w+$)"
)
_MAKERS = ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "IMPORT", "SYMMETRIC MODEL GENERATION")
_REFERENCES = {"COUPLING", "RIGID BODY", "KINEMATIC COUPLING", "DISTRIBUTING COUPLING", "PRE-TENSION SECTION"}


@dataclass(frozen=True)
class NumberSpan:
    """Numbers of GENERATE: those that there are among them."""

    numbers: Index


@dataclass(frozen=True)
class PretensionSection:
    """A pre-tension section: its words, the surface or the beam, the node that is pulled, and the direction."""

    text: str
    surface: str
    node: str
    axis: tuple[float, float, float] | None


Items = list[tuple[str, "Index | str | NumberSpan"]]


@dataclass
class Scope:
    """What one part, instance or the whole file holds; sets are lists of (instance, numbers or the name of a set)."""

    nodes: dict[int, tuple[float, ...]] = field(default_factory=dict)
    elements: dict[str, list[tuple[Index, Index]]] = field(default_factory=dict)
    sheets: dict[str, list[Index]] = field(default_factory=dict)
    extra: list[Index] = field(default_factory=list)
    element_sets: dict[str, Items] = field(default_factory=dict)
    node_sets: dict[str, Items] = field(default_factory=dict)
    node_surfaces: dict[str, Items] = field(default_factory=dict)
    surfaces: dict[str, list[tuple[str, str]]] = field(default_factory=dict)
    others: list[Index] = field(default_factory=list)  # numbers of elements that are not solids
    made: list[str] = field(default_factory=list)  # element sets that *ELEMENT itself names
    bolts: list["PretensionSection"] = field(default_factory=list)
    loads: list[tuple[str, float]] = field(default_factory=list)  # node or set, and its force in direction 1
    left_out: dict[str, list[str]] = field(default_factory=dict)  # keywords by their kind
    unknown: list[str] = field(default_factory=list)
    sections: list[str] = field(default_factory=list)
    references: list[str] = field(default_factory=list)
    turned: list[str] = field(default_factory=list)
    frame: tuple[Array, Array] = field(default_factory=lambda: (np.eye(3), np.zeros(3)))
    notes: list[str] = field(default_factory=list)


# what a keyword may say in its line, by the manuals of Abaqus and CalculiX
_OF_SETS = {"GENERATE", "INSTANCE", "INTERNAL", "UNSORTED"}
OPTIONS = {
    "NODE": {"NSET", "SYSTEM", "INPUT"},
    "ELEMENT": {"TYPE", "ELSET", "INPUT", "FILE", "OFFSET", "PARENT", "SOLID ELEMENT NUMBERING"},
    "NSET": {"NSET", "ELSET", *_OF_SETS},
    "ELSET": {"ELSET", *_OF_SETS},
}


def take(block: Block, scope: Scope) -> None:
    """Note what a keyword and its lines say. Raises ReadError, naming both, where they cannot be read."""
    options, keyword = block.options, block.keyword
    kind = abaqus_kind(keyword)
    if kind:
        scope.left_out.setdefault(kind, []).append(keyword)
    elif kind is None and keyword not in _MAKERS:
        scope.unknown.append(keyword)
    if keyword in DATA and not block.words():
        scope.notes.append(f"{block.where}: *{keyword} has no data lines: the file may be cut short")
    strange = [key for key in options if keyword in OPTIONS and key not in OPTIONS[keyword]]
    if strange:
        scope.notes.append(f"{block.where}: *{keyword}: not known, and passed over: {', '.join(strange)}")
    with understood(f"{block.where}: *{keyword} has something that is not a number"):
        if keyword == "NODE":
            _nodes(block, scope)
        elif keyword == "SYSTEM":
            scope.frame = _frame(block)
        elif keyword == "ELEMENT":
            _elements(block, scope)
        elif keyword in ("NSET", "ELSET"):
            _set(block, scope.node_sets if keyword == "NSET" else scope.element_sets, options.get(keyword))
        elif keyword == "SURFACE":
            _surface(block, scope)
        elif keyword == "SOLID SECTION" and "ELSET" in options:
            scope.sections.append(options["ELSET"])
        elif keyword in _MAKERS:
            raise ReadError(
                f"{block.where}: *{keyword} makes nodes or elements, which is not done here; write them out"
            )
        elif keyword in _REFERENCES:
            scope.references.extend(options[key] for key in ("REF NODE", "ROT NODE", "NODE") if key in options)
            if keyword == "PRE-TENSION SECTION":
                _bolt(block, scope)
        elif keyword == "CLOAD":
            rows = [row for row in block.rows() if len(row) > 2 and row[1] == "1" and row[2]]
            scope.loads += [(row[0], float(row[2])) for row in rows]
        elif keyword == "TRANSFORM":
            scope.turned.append(options.get("NSET", ""))


def _nodes(block: Block, scope: Scope) -> None:
    """Nodes in the local system, cylindrical with SYSTEM=C, of *SYSTEM."""
    system = block.options.get("SYSTEM", "R").upper()
    if system not in ("R", "C"):
        raise ReadError(f"{block.where}: *NODE, SYSTEM={system} is not known; write the nodes in R or C")
    rows = block.rows()
    numbers = [int(row[0]) for row in rows]
    table = np.zeros((len(rows), 6))
    for k, row in enumerate(rows):
        given = [float(word) if word else 0.0 for word in row[1:]]
        if len(given) > 6 or not np.all(np.isfinite(given)):
            raise ReadError(
                f"{block.where}: node {row[0]} has {len(given)} finite numbers; three coordinates are wanted"
            )
        table[k, : len(given)] = given
    # three more numbers are the cosines of a normal
    size = np.linalg.norm(table[:, 3:], axis=1)
    wrong = np.flatnonzero((size > 0) & (np.abs(size - 1) > 0.01))
    if len(wrong):
        raise ReadError(
            f"{block.where}: node {numbers[wrong[0]]} has more than three coordinates; a number has a decimal point, "
            "not a comma"
        )
    x = table[:, :3]
    if system == "C":
        angle = np.deg2rad(x[:, 1])
        x = np.column_stack([x[:, 0] * np.cos(angle), x[:, 0] * np.sin(angle), x[:, 2]])
    turn, origin = scope.frame
    for number, place in zip(numbers, x @ turn + origin, strict=True):
        at = (float(place[0]), float(place[1]), float(place[2]))
        if scope.nodes.setdefault(number, at) != at:
            raise ReadError(f"{block.where}: node {number} is given twice, at different places")
    if "NSET" in block.options:
        _add(scope.node_sets, block.options["NSET"], "", index(numbers))


def _frame(block: Block) -> tuple[Array, Array]:
    """Axes (rows) and origin of *SYSTEM: none, the origin, a point of the x axis, a point of the xy plane."""
    given = [float(word) for word in block.words()]
    if len(given) not in (0, 3, 6, 9) or not np.all(np.isfinite(given)):
        raise ReadError(f"{block.where}: *SYSTEM has {len(given)} numbers; it takes up to three points of three each")
    points = np.zeros((3, 3))
    points[: len(given) // 3] = np.reshape(given, (-1, 3))
    origin, along, across = points
    if len(given) < 6:
        return np.eye(3), origin
    x = along - origin
    z = np.cross(x, across - origin) if len(given) == 9 else np.array([0.0, 0.0, 1.0])
    if len(given) == 6:  # x turned about the global z axis
        x = x - (x @ z) * z
    size = np.linalg.norm(x), np.linalg.norm(z)
    if min(size) < 1e-9 * max(1.0, float(np.abs(points).max())) ** 2:
        raise ReadError(f"{block.where}: the points of *SYSTEM coincide or are on one line")
    x, z = x / size[0], z / size[1]
    return np.stack([x, np.cross(z, x), z]), origin


def _key(sets: Mapping[str, object], name: str) -> str:
    """The name of a set as it was first written: Abaqus does not tell upper from lower case."""
    return next((key for key in sets if key.upper() == name.upper()), name)


def _add(sets: dict[str, Items], name: str, instance: str, what: Index | str | NumberSpan) -> None:
    sets.setdefault(_key(sets, name), []).append((instance, what))


def _elements(block: Block, scope: Scope) -> None:
    kind = block.options.get("TYPE", "").upper()
    base = re.match(r"C3D\d+", kind)
    sheet = _SHEET.match(kind)
    if _LINE.match(kind):
        scope.extra.extend(index(word for word in row[1:] if word) for row in block.rows())
        _other(block, scope, index(row[0] for row in block.rows()))
        scope.notes.append(
            f"{block.where}: {len(block.lines)} elements {kind} are left out, with their stiffness and mass"
        )
        return
    if base and base.group() in _SOLID:
        count = int(base.group()[3:])
    elif sheet and sheet.group(1) in _SHEET_COUNT:
        count = _SHEET_COUNT[sheet.group(1)]
    else:
        raise ReadError(
            f"{block.where}: elements of type {kind or 'none'} are not known; the known ones are "
            f"{', '.join(_SOLID)} with their variants, and triangles and quadrangles as faces"
        )
    table = index(_of_equal_length(block, count + 1)).reshape(-1, count + 1)
    numbers, nodes = table[:, 0], table[:, 1:]
    if base:
        scope.elements.setdefault(_SOLID[base.group()], []).append((numbers, nodes))
    else:
        scope.extra.append(nodes.ravel())
        _other(block, scope, numbers)
        scope.sheets.setdefault(block.options.get("ELSET", "faces"), []).append(nodes)
    if "ELSET" in block.options and base:
        scope.made.append(block.options["ELSET"])
        _add(scope.element_sets, block.options["ELSET"], "", numbers)


def _of_equal_length(block: Block, width: int) -> list[str]:
    """All numbers of a block of elements, each of which begins on a line of its own and has so many."""
    words: list[str] = []
    for row in block.rows():
        begun = len(words) // width
        words += [word for word in row if word]
        if len(words) % width and len(words) // width > begun:
            raise ReadError(
                f"{block.where}: the lines of element {words[begun * width]} hold {len(words) - begun * width} "
                f"numbers, where one of type {block.options.get('TYPE', '')} has {width}; is it of another type?"
            )
    if not words or len(words) % width:
        raise ReadError(
            f"{block.where}: {len(words)} numbers do not make elements of {width - 1} nodes; is the file complete?"
        )
    return words


def _other(block: Block, scope: Scope, numbers: Index) -> None:
    """Note elements that are not solids: their numbers, and the set that they are put into, which others may name."""
    scope.others.append(numbers)
    if "ELSET" in block.options:
        _add(scope.element_sets, block.options["ELSET"], "", index([]))


def _bolt(block: Block, scope: Scope) -> None:
    """Note a pre-tension section with its words: its surface is a cut inside the bolt, or it is a beam."""
    options_text = ", ".join(f"{key}={value}" for key, value in block.options.items())
    along = f", direction {block.lines[0].strip()}" if block.lines else ""
    given = [float(word) for word in block.words()[:3]]
    text = f"{block.where}: *PRE-TENSION SECTION, {options_text}{along}"
    scope.bolts.append(
        PretensionSection(
            text=text,
            surface=block.options.get("SURFACE", ""),
            node=block.options.get("NODE", ""),
            axis=(given[0], given[1], given[2]) if len(given) == 3 and any(given) else None,
        )
    )
    scope.notes.append(
        f"{text}: the preload of this bolt is left out, with the surface inside it; give the bolt in [[bolt]] of the "
        "study, or let faying new propose it"
    )


def _set(block: Block, sets: dict[str, Items], name: str | None) -> None:
    if not name:
        raise ReadError(f"{block.where}: *{block.keyword} without a name")
    instance = block.options.get("INSTANCE", "")
    if block.keyword == "NSET" and "ELSET" in block.options:
        raise ReadError(f"{block.where}: *NSET, ELSET= takes the nodes of elements, which is not done; list the nodes")
    if "GENERATE" in block.options:
        for row in block.rows():
            first, last, *step = (int(word) for word in row if word)
            _add(sets, name, instance, NumberSpan(ranged(first, last, step[0] if step else 1, block.where)))
        return
    numbers = []
    for word in block.words():
        if word.lstrip("-").isdigit():
            numbers.append(word)
        else:
            _add(sets, name, instance, word)
    if numbers:
        _add(sets, name, instance, index(numbers))


def _surface(block: Block, scope: Scope) -> None:
    name, kind = block.options.get("NAME", ""), block.options.get("TYPE", "ELEMENT").upper()
    if kind == "NODE":
        words = [row[0] for row in block.rows()]
        options = {"INSTANCE": block.options.get("INSTANCE", "")}
        _set(Block("NSET", options, words, block.where), scope.node_surfaces, name)
        return
    if kind != "ELEMENT" or "COMBINE" in block.options:
        raise ReadError(f"{block.where}: *SURFACE of this type is not known; write one of TYPE=ELEMENT or NODE")
    rows = [(row[0], row[1].upper() if len(row) > 1 else "") for row in block.rows()]
    scope.surfaces.setdefault(_key(scope.surfaces, name), []).extend(rows)


def placed(part: Scope, block: Block) -> Scope:
    """A copy of a part, moved and turned as the data lines of *INSTANCE say; so are nodes that the instance adds."""
    numbers = [[float(word) for word in row if word] for row in block.rows()]
    if any(len(row) != count for row, count in zip(numbers, (3, 7), strict=False)) or len(numbers) > 2:
        raise ReadError(f"{block.where}: *INSTANCE takes a line of 3 numbers that move it and one of 7 that turn it")
    turn, shift = np.eye(3), np.array(numbers[0] if numbers else [0.0] * 3)
    if len(numbers) > 1:
        from scipy.spatial.transform import Rotation

        start, end, angle = np.array(numbers[1][:3]), np.array(numbers[1][3:6]), numbers[1][6]
        length = float(np.linalg.norm(end - start))
        if not length > 0:
            raise ReadError(f"{block.where}: the two points of the axis of *INSTANCE coincide")
        turn = Rotation.from_rotvec(np.deg2rad(angle) * (end - start) / length).as_matrix().T
        shift = (shift - start) @ turn + start
    points = np.array(list(part.nodes.values())).reshape(-1, 3) @ turn + shift
    copy = deepcopy(part)
    copy.nodes = {number: tuple(map(float, x)) for number, x in zip(part.nodes, points, strict=True)}
    copy.frame = turn, shift
    return copy
