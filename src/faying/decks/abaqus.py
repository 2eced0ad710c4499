"""Abaqus (and CalculiX) input files: read as meshes, and the joint written as keywords.

Read: nodes, elements, sets, surfaces, includes, parts and instances; what is not geometry is passed over. Keywords after the
Abaqus Analysis User's Guide and the CalculiX manual.

Written: SPRING2 and DASHPOT2, connectors with structural damping, a matrix, and the law as a contact property. Keywords
after the Abaqus Keywords Reference Guide 2016 and 2017: MATRIX INPUT (entries "node, direction, node, direction, value",
one triangle), CONNECTOR DAMPING (TYPE=STRUCTURAL: a part of the elasticity), SPRING (ORIENTATION). Not run: read back in
the tests by a reader of that grammar.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from faying.decks.deck import JointDeck, grouped, real
from faying.decks.keywords import elements, orientations, table
from faying.decks.raw import RawMesh, index
from faying.errors import ReadError
from faying.typing import Array, Index

_SOLID = {"C3D4": "tet4", "C3D10": "tet10", "C3D8": "hex8", "C3D20": "hex20", "C3D6": "wedge6", "C3D15": "wedge15"}
_SHEET = re.compile(r"^(?:S|STRI|CPS|CPE|M3D|SFM3D|R3D)(\d+)")
_SHEET_COUNT = {"3": 3, "4": 4, "6": 6, "8": 8, "65": 6}
_LINE = {"T3D2": 2, "T3D3": 3, "B31": 2, "B32": 3}


@dataclass(frozen=True)
class Block:
    """A keyword with its parameters and the data lines below it."""

    keyword: str
    options: dict[str, str]
    lines: list[str]
    where: str

    def numbers(self) -> list[str]:
        """All entries of the data lines."""
        return [word for line in self.lines for word in (w.strip() for w in line.split(",")) if word]


@dataclass
class Scope:
    """What one part or the whole file holds."""

    nodes: dict[int, tuple[float, ...]] = field(default_factory=dict)
    elements: dict[str, list[tuple[Index, Index]]] = field(default_factory=dict)
    sheets: dict[str, list[Index]] = field(default_factory=dict)
    extra: list[Index] = field(default_factory=list)
    element_sets: dict[str, list[Index]] = field(default_factory=dict)
    node_sets: dict[str, list[Index]] = field(default_factory=dict)
    surfaces: dict[str, list[tuple[str, str]]] = field(default_factory=dict)
    sections: list[str] = field(default_factory=list)


def blocks(path: Path, seen: tuple[Path, ...] = ()) -> Iterator[Block]:
    """Keyword blocks of a file and of the files it includes."""
    if path.resolve() in seen:
        raise ReadError(f"{path} includes itself")
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError as fault:
        raise ReadError(f"cannot read {path}: {fault.strerror or fault}") from None
    current: Block | None = None
    lines = iter(enumerate(text.splitlines(), 1))
    for number, line in lines:
        if line.startswith("**") or not line.strip():
            continue
        if not line.startswith("*"):
            if current is None:
                raise ReadError(f"{path}, line {number}: data before the first keyword; is this an Abaqus input file?")
            current.lines.append(line)
            continue
        while line.rstrip().endswith(","):
            line = line.rstrip() + next(lines, (0, ""))[1]
        if current is not None:
            yield current
            current = None
        name, *rest = line[1:].split(",")
        pairs = (part.partition("=") for part in rest if part.strip())
        options = {key.strip().upper(): value.strip().strip('"') for key, _, value in pairs}
        keyword = re.sub(r"\s+", " ", name.strip().upper())
        if keyword == "INCLUDE":
            if "INPUT" not in options:
                raise ReadError(f"{path}, line {number}: *INCLUDE without INPUT=file")
            yield from blocks(path.parent / options["INPUT"], (*seen, path.resolve()))
            continue
        current = Block(keyword, options, [], f"{path.name}, line {number}")
    if current is not None:
        yield current


def read(path: Path) -> RawMesh:
    """Read an Abaqus or CalculiX input file. Raises ReadError for what it cannot read, naming line and keyword."""
    top = Scope()
    parts: dict[str, Scope] = {}
    instances: dict[str, Scope] = {}
    scope, in_assembly = top, False
    for block in blocks(path):
        options = block.options
        if block.keyword == "PART":
            scope = parts.setdefault(options.get("NAME", ""), Scope())
        elif block.keyword in ("END PART", "END INSTANCE"):
            scope = top
        elif block.keyword == "ASSEMBLY":
            in_assembly = True
        elif block.keyword == "INSTANCE" and in_assembly:
            name, part = options.get("NAME", ""), options.get("PART", "")
            if part not in parts:
                raise ReadError(
                    f"{block.where}: instance {name!r} of the part {part!r}, which the file does not hold; "
                    f"it holds {', '.join(parts) or 'none'}"
                )
            scope = instances[name] = _placed(parts[part], block)
        else:
            _take(block, scope)
    if instances:
        _merge(top, instances)
    elif parts:
        _merge(top, parts)
    return _raw(path, top, tuple(instances or parts))


def _take(block: Block, scope: Scope) -> None:
    options = block.options
    try:
        if block.keyword == "NODE":
            rows = [line.split(",") for line in block.lines]
            for row in rows:
                x = [float(word) if word.strip() else 0.0 for word in row[1:4]]
                scope.nodes[int(row[0])] = (*x, *(0.0,) * (3 - len(x)))
            if "NSET" in options:
                _add(scope.node_sets, options["NSET"], index(int(row[0]) for row in rows))
        elif block.keyword == "ELEMENT":
            _elements(block, scope)
        elif block.keyword in ("NSET", "ELSET"):
            kind = scope.node_sets if block.keyword == "NSET" else scope.element_sets
            _set(block, kind, options.get(block.keyword))
        elif block.keyword == "SURFACE":
            name, kind_of = options.get("NAME", ""), options.get("TYPE", "ELEMENT").upper()
            rows = [[w.strip() for w in line.split(",")] for line in block.lines]
            if kind_of == "NODE":
                for row in rows:
                    _set(
                        Block("NSET", {"INSTANCE": options.get("INSTANCE", "")}, [row[0]], block.where),
                        scope.node_sets,
                        name,
                    )
            else:
                scope.surfaces.setdefault(name, []).extend((row[0], (row[1:] or [""])[0].upper()) for row in rows)
        elif block.keyword == "SOLID SECTION" and "ELSET" in options:
            scope.sections.append(options["ELSET"])
    except ReadError:
        raise
    except (ValueError, IndexError) as fault:
        raise ReadError(
            f"{block.where}: *{block.keyword} holds something that is not a number ({fault}); is the file whole?"
        ) from None


def _add(sets: dict[str, list[Index]], name: str, numbers: Index) -> None:
    sets.setdefault(name, []).append(numbers)


def _elements(block: Block, scope: Scope) -> None:
    kind = block.options.get("TYPE", "").upper()
    base = re.match(r"C3D\d+", kind)
    sheet = _SHEET.match(kind)
    if base and base.group() in _SOLID:
        count = int(base.group()[3:])
    elif sheet and sheet.group(1) in _SHEET_COUNT:
        count = _SHEET_COUNT[sheet.group(1)]
    elif kind in _LINE:
        count = _LINE[kind]
    else:
        raise ReadError(
            f"{block.where}: elements of type {kind or 'none'} are not known; known are "
            f"{', '.join(_SOLID)} with their variants, and triangles and quadrangles as faces"
        )
    words = block.numbers()
    if len(words) % (count + 1):
        raise ReadError(
            f"{block.where}: {len(words)} numbers do not make elements of {count} nodes; is the file whole?"
        )
    table = index(map(int, words)).reshape(-1, count + 1)
    numbers, nodes = table[:, 0], table[:, 1:]
    if base:
        scope.elements.setdefault(_SOLID[base.group()], []).append((numbers, nodes))
    else:
        scope.extra.append(nodes.ravel())
        if sheet:
            scope.sheets.setdefault(block.options.get("ELSET", "faces"), []).append(nodes)
    if "ELSET" in block.options and base:
        _add(scope.element_sets, block.options["ELSET"], numbers)


def _set(block: Block, sets: dict[str, list[Index]], name: str | None) -> None:
    if not name:
        raise ReadError(f"{block.where}: *{block.keyword} without a name")
    instance = block.options.get("INSTANCE", "")
    words = block.numbers()
    if "GENERATE" in block.options:
        for line in block.lines:
            first, last, *step = (int(w) for w in line.split(",") if w.strip())
            _add(sets, name, np.arange(first, last + 1, step[0] if step else 1))
        return
    numbers = []
    for word in words:
        if word.lstrip("-").isdigit():
            numbers.append(int(word))
            continue
        known = {key.upper(): value for key, value in sets.items()}
        if word.upper() not in known:
            raise ReadError(
                f"{block.where}: set {name!r} names the set {word!r}, which the file does not hold above it"
            )
        for some in known[word.upper()]:
            _add(sets, name, some)
    if numbers:
        # numbers of an instance are told apart when all are known
        _add(sets, f"{name}\0{instance}" if instance else name, index(numbers))


def _placed(part: Scope, block: Block) -> Scope:
    """A copy of a part, moved and turned as the data lines of *INSTANCE say."""
    numbers = [[float(w) for w in line.split(",") if w.strip()] for line in block.lines]
    points = np.array(list(part.nodes.values())).reshape(-1, 3)
    if numbers and len(numbers[0]) == 3:
        points = points + numbers[0]
    if len(numbers) > 1 and len(numbers[1]) == 7:
        from scipy.spatial.transform import Rotation

        start, end, angle = np.array(numbers[1][:3]), np.array(numbers[1][3:6]), numbers[1][6]
        axis = (end - start) / np.linalg.norm(end - start)
        points = Rotation.from_rotvec(np.deg2rad(angle) * axis).apply(points - start) + start
    nodes = {number: tuple(map(float, x)) for number, x in zip(part.nodes, points, strict=True)}
    return Scope(
        nodes=nodes,
        elements={k: list(v) for k, v in part.elements.items()},
        sheets={k: list(v) for k, v in part.sheets.items()},
        extra=list(part.extra),
        element_sets={k: list(v) for k, v in part.element_sets.items()},
        node_sets={k: list(v) for k, v in part.node_sets.items()},
        surfaces={k: list(v) for k, v in part.surfaces.items()},
        sections=list(part.sections),
    )


def _merge(top: Scope, scopes: dict[str, Scope]) -> None:
    """Put parts or instances into one numbering; where numbers clash, those of the later ones are raised."""
    node_shift, element_shift = 0, 0
    shifts = {}
    for name, one in scopes.items():
        clash = not set(one.nodes).isdisjoint(top.nodes)
        shift = node_shift if clash else 0
        numbers = [n for rows in one.elements.values() for n, _ in rows]
        have = [n for rows in top.elements.values() for n, _ in rows]
        rise = (
            element_shift
            if numbers and have and np.intersect1d(np.concatenate(numbers), np.concatenate(have)).size
            else 0
        )
        shifts[name] = (shift, rise)
        top.nodes.update({n + shift: x for n, x in one.nodes.items()})
        for kind, rows in one.elements.items():
            top.elements.setdefault(kind, []).extend((n + rise, nodes + shift) for n, nodes in rows)
        for label, sheets in one.sheets.items():
            top.sheets.setdefault(f"{name}.{label}", []).extend(nodes + shift for nodes in sheets)
        top.extra.extend(nodes + shift for nodes in one.extra)
        for label, several in one.element_sets.items():
            top.element_sets[f"{name}.{label}"] = [some + rise for some in several]
        for label, several in one.node_sets.items():
            top.node_sets[f"{name}.{label}"] = [some + shift for some in several]
        for label, rows_ in one.surfaces.items():
            top.surfaces[f"{name}.{label}"] = [
                (str(int(w) + rise) if w.isdigit() else f"{name}.{w}", s) for w, s in rows_
            ]
        top.element_sets[name] = [n + rise for n in numbers]
        node_shift = max(top.nodes, default=0)
        element_shift = max((int(n.max()) for rows in top.elements.values() for n, _ in rows), default=0)
    top.sections = list(scopes)
    for place, sets in enumerate((top.node_sets, top.element_sets)):
        for label in [key for key in sets if "\0" in key]:
            name, _, instance = label.partition("\0")
            if instance not in shifts:
                raise ReadError(f"set {name!r} is of the instance {instance!r}, which the file does not hold")
            for numbered in sets.pop(label):
                _add(sets, name, numbered + shifts[instance][place])


def _raw(path: Path, top: Scope, instances: tuple[str, ...]) -> RawMesh:
    if not top.nodes or not top.elements:
        raise ReadError(
            f"{path} holds {len(top.nodes)} nodes and {len(top.elements)} kinds of solid elements; write nodes "
            "and elements of the model into it"
        )
    element_sets = {
        name: np.unique(np.concatenate(some)) for name, some in top.element_sets.items() if "\0" not in name
    }
    node_sets = {name: np.unique(np.concatenate(some)) for name, some in top.node_sets.items() if "\0" not in name}
    upper = {name.upper(): numbers for name, numbers in element_sets.items()}
    side_sets: dict[str, Index] = {}
    skins: dict[str, Index] = {}
    for name, rows in top.surfaces.items():
        pairs: list[Index] = []
        for what, side in rows:
            if what.upper() in upper:
                numbers = upper[what.upper()]
            elif what.isdigit():
                numbers = index([what])
            else:
                raise ReadError(f"surface {name!r} names the element set {what!r}, which {path.name} does not hold")
            if side and not re.fullmatch(r"S[1-6]", side):
                raise ReadError(f"surface {name!r} names the side {side!r}; the sides of solids are S1 to S6")
            if side:
                pairs.append(np.column_stack([numbers, np.full(len(numbers), int(side[1:]) - 1)]))
            else:
                skins[name] = np.concatenate([skins[name], numbers]) if name in skins else numbers
        if pairs:
            side_sets[name] = np.concatenate(pairs)
    for name, numbers in skins.items():
        side_sets[name] = np.column_stack([numbers, np.full(len(numbers), -1)])
    helpers = {what.upper() for rows in top.surfaces.values() for what, _ in rows}
    wanted = [s for s in dict.fromkeys(top.sections) if s.upper() in upper]
    return RawMesh(
        numbers=index(top.nodes),
        points=np.array(list(top.nodes.values())),
        elements={
            kind: (np.concatenate([n for n, _ in rows]), np.concatenate([c for _, c in rows]))
            for kind, rows in top.elements.items()
        },
        bodies={name: upper[name.upper()] for name in wanted},
        element_sets={name: some for name, some in element_sets.items() if name.upper() not in helpers},
        node_sets=node_sets,
        side_sets=side_sets,
        face_elements={name: tuple(rows) for name, rows in top.sheets.items()},
        extra=np.concatenate(top.extra) if top.extra else np.zeros(0, dtype=np.int64),
    )


def decks(deck: JointDeck) -> dict[str, str]:
    """Files to include in an input deck before its first step, by name; one of them, not all."""
    out = {"joint_matrix.inp": matrix(deck)}
    if deck.uncoupled:
        out["joint_spring2.inp"] = spring2(deck)
    if deck.pairs.lumped:
        out["joint_connector.inp"] = connector(deck)
    if deck.contact is not None:
        out["joint_contact.inp"] = contact(deck)
    return out


def spring2(deck: JointDeck) -> str:
    """Write SPRING2 elements, and DASHPOT2 where there are dampers. Raises InputError as `NodePairs.own`."""
    lines = deck.header("**", deck.damping_note())
    axes, group = orientations(deck)
    springs, number = elements(
        deck, "SPRING2", "SPRING", "JK", deck.pairs.own(deck.stiffness), group, deck.first_element
    )
    dashpots: list[str] = []
    if deck.dampers is not None:
        dashpots, _ = elements(deck, "DASHPOT2", "DASHPOT", "JC", deck.pairs.own(deck.dampers), group, number)
    return "\n".join([*lines, *axes, *springs, *dashpots]) + "\n"


def connector(deck: JointDeck) -> str:
    """Write CONN3D2 elements of type CARTESIAN: component 1 is the normal; loss factors as structural damping."""
    k, lost = deck.pairs.own(deck.stiffness), deck.pairs.own(deck.loss)
    ratio = np.divide(lost, k, out=np.zeros_like(k), where=k != 0)
    dampers = deck.pairs.own(deck.dampers) if deck.paper and deck.dampers is not None else None
    note = deck.damping_note() if dampers is not None else "loss factors as structural damping of each component"
    lines = deck.header("**", note)
    axes, group = orientations(deck)
    lines += axes
    one, two = deck.ends
    key = [group[:, None], k / np.abs(k).max(), ratio]
    if dampers is not None:
        key.append(dampers / np.abs(dampers).max())
    first, alike = grouped(np.column_stack(key))
    number = deck.first_element
    for g, leader in enumerate(first):
        lines.append(f"*ELEMENT,TYPE=CONN3D2,ELSET=JN{g}")
        for i in np.flatnonzero(alike == g):
            lines.append(f"{number},{one[i]},{two[i]}")
            number += 1
        lines += [f"*CONNECTOR SECTION,ELSET=JN{g},BEHAVIOR=JB{g}", "CARTESIAN,", f"JKA{group[leader]},"]
        lines.append(f"*CONNECTOR BEHAVIOR,NAME=JB{g}")
        for c in range(3):
            lines += [f"*CONNECTOR ELASTICITY,COMPONENT={c + 1}", f"{real(k[leader, c], 20)},"]
            if dampers is not None:
                lines += [f"*CONNECTOR DAMPING,COMPONENT={c + 1}", f"{real(dampers[leader, c], 20)},"]
            elif ratio[leader, c]:
                lines += [f"*CONNECTOR DAMPING,COMPONENT={c + 1},TYPE=STRUCTURAL", f"{real(ratio[leader, c], 20)},"]
    return "\n".join(lines) + "\n"


def matrix(deck: JointDeck) -> str:
    """Write the joint as sparse matrices: stiffness, and structural damping or, after the JK paper, viscous."""
    paper = deck.paper and deck.dampers is not None
    lines = deck.header(
        "**",
        deck.damping_note()
        if paper
        else "loss as a structural damping matrix, the imaginary "
        "part of the stiffness; frequency-domain steps with SIM only",
    )
    lines += _entries("KJ", deck, deck.stiffness)
    assemble = "*MATRIX ASSEMBLE,STIFFNESS=KJ"
    if paper and deck.dampers is not None:
        lines += _entries("CJ", deck, deck.dampers)
        assemble += ",VISCOUS DAMPING=CJ"
    elif np.any(deck.loss):
        lines += _entries("SJ", deck, deck.loss)
        assemble += ",STRUCTURAL DAMPING=SJ"
    return "\n".join([*lines, assemble]) + "\n"


def _entries(name: str, deck: JointDeck, blocks: Array) -> list[str]:
    from scipy.sparse import triu

    upper = triu(deck.pairs.matrix(blocks)).tocoo()
    n = deck.mesh.numbers
    return [f"*MATRIX INPUT,NAME={name},TYPE=SYMMETRIC"] + [
        f"{n[i // 3]},{i % 3 + 1},{n[j // 3]},{j % 3 + 1},{real(v, 23)}"
        for i, j, v in zip(upper.row, upper.col, upper.data, strict=True)
        if v
    ]


def contact(deck: JointDeck) -> str:
    """Write a surface interaction with the law as pressure-overclosure table, and the contact pair."""
    rows, law = table(deck)
    slip = law.friction * law.mean_pressure / law.k_t * deck.system.metre
    lines = deck.header(
        "**",
        "contact in place of springs: needs a step with the bolts before *FREQUENCY",
        f"elastic slip: sticks with k_t at the mean pressure; friction {law.friction:g}"
        + ("" if law.given else ", not given by the study: check it"),
    )
    lines += ["*SURFACE INTERACTION,NAME=JK", "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=TABULAR", *rows]
    lines += [f"*FRICTION,ELASTIC SLIP={real(slip, 20)}", f"{real(law.friction, 20)},"]
    if deck.frequency is not None and law.loss_n:
        c = law.loss_n * law.k_n / (2 * np.pi * deck.frequency) * deck.system.density
        lines += ["*CONTACT DAMPING,DEFINITION=DAMPING COEFFICIENT", f"{real(c, 20)},"]
    lines += ["*CONTACT PAIR,INTERACTION=JK,TYPE=SURFACE TO SURFACE", ",".join(deck.faces)]
    return "\n".join(lines) + "\n"
