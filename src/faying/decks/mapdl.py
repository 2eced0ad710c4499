"""MAPDL (ANSYS): archives read as meshes, and the joint written as MATRIX27, COMBIN14 and the stiffness of CONTA174.

Read: .cdb as CDWRITE writes it in blocked format: NBLOCK, EBLOCK, ET and CMBLOCK, after the description of CDWRITE in
the Mechanical APDL command reference. Components of nodes become faces, components of elements parts.

Written: MATRIX27 after the ANSYS element reference: directions UX UY UZ ROTX ROTY ROTZ of node I, then of J, in the
nodal axes; C1 to C78 are the upper triangle row by row; KEYOPT(2) = 0 symmetric; KEYOPT(3) = 4 stiffness, 5 damping. R
takes six constants, each RMORE six more. Not run in MAPDL: the archive is read back by mapdl-archive in the tests.
"""

import re
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path

import numpy as np

from faying.decks.deck import CondensedDeck, JointDeck, comments, grouped, members, real, reals
from faying.decks.raw import Pretension, RawMesh, gathered, index, joined, not_in_file, ranged, undoubled
from faying.decks.vocabulary import ANSYS_CONTACT, ANSYS_LEFT_OUT, ANSYS_SURFACES, BOLT, CONSTRAINT, CONTACT, left_out
from faying.errors import ReadError
from faying.typing import Array, Index

_SOLIDS = {"185": 8, "186": 20, "187": 10, "285": 4, "45": 8, "95": 20, "92": 10}
_SURFACE = frozenset(map(str, ANSYS_SURFACES))
_LEFT_OUT = {str(number): what for number, what in ANSYS_LEFT_OUT.items()}
# they make nodes and elements one by one, as of a mass or a pilot node; or change those of the blocks
_MAKERS = ("N", "E", "EN")
_OF_NODES = ("NGEN", "NMODIF", "NSCALE", "NDELE", "NSYM", "NUMMRG")
_OF_ELEMENTS = ("EGEN", "ENGEN", "ESYM", "ENSYM", "EDELE", "EMODIF")
_CONSTRAINTS = ("CE", "CP", "CERIG", "RBE3", "CEINTF", "CPINTF", "PSMESH", "SLOAD")


def read(path: Path) -> RawMesh:
    """Read an archive. Raises ReadError for unblocked archives, other elements, and files cut short."""
    archive = _Archive(path, path.read_text(encoding="utf-8-sig", errors="replace").splitlines())
    k = 0
    try:
        while k < len(archive.lines):
            k = archive.take(k)
    except ReadError:
        raise
    except (ValueError, IndexError, KeyError) as fault:
        why = "a block or a line ends too early" if isinstance(fault, IndexError) else fault
        raise ReadError(
            f"{path.name}, line {min(k, len(archive.lines)) + 1}: cannot be read ({why}); is the archive complete and "
            "in blocked format (CDWRITE)?"
        ) from None
    return archive.mesh()


@dataclass
class _Archive:
    """What the lines of an archive hold."""

    path: Path
    lines: list[str]
    kinds: dict[int, str] = field(default_factory=dict)
    numbers: list[int] = field(default_factory=list)
    points: list[list[float]] = field(default_factory=list)
    rows: dict[str, list[tuple[int, list[int]]]] = field(default_factory=dict)
    sets: dict[str, dict[str, Index]] = field(default_factory=lambda: {"NODE": {}, "ELEM": {}})
    extra: list[int] = field(default_factory=list)
    turned: list[int] = field(default_factory=list)
    dropped: dict[int, str] = field(default_factory=dict)  # numbers and types of elements that are not solids
    commands: list[str] = field(default_factory=list)
    parameters: dict[str, str] = field(default_factory=dict)  # whole numbers of *SET by name
    bolts: "_Bolts" = field(default_factory=lambda: _Bolts())
    last: int = -1  # the last line that is not read; a block that is read ends at any other line

    def take(self, k: int) -> int:
        """Note the command of line k with its block; the number of the line behind it."""
        words = [word.strip() for word in self.lines[k].split(",")]
        name = words[0].upper()
        blocks = {"ETBLOCK": self._types, "NBLOCK": self._nodes, "EBLOCK": self._elements, "CMBLOCK": self._component}
        if name in blocks:
            return blocks[name](k, words)
        if name == "*SET" and len(words) > 2 and words[2].isdigit():
            self.parameters[words[1].upper()] = words[2]
        if name == "ET" and len(words) > 2:
            number = self.parameters.get(words[1].upper(), words[1])
            if number.isdigit():
                self.kinds[int(number)] = re.sub(r"\D", "", words[2])
            return k + 1
        self.bolts.take(name, words)
        if name in (*_OF_NODES, *_OF_ELEMENTS, "CDREAD", "/INPUT"):
            raise ReadError(
                f"{self.path.name}, line {k + 1}: {name} changes nodes or elements or reads more of them, which is not "
                "done here; write the archive with CDWRITE once more"
            )
        if name in (*_CONSTRAINTS, *_MAKERS):
            self.commands.append(name)
        return self._passed(k)

    def mesh(self) -> RawMesh:
        """What was read, with notes on what was not."""
        if not self.numbers or not self.rows:
            raise ReadError(
                f"{self.path} holds {len(self.numbers)} nodes in NBLOCK, {sum(map(len, self.rows.values()))} solids "
                f"and {len(self.dropped)} other elements in EBLOCK; give solids, in blocked format (CDWRITE,DB)"
            )
        notes = _left_out([*self.dropped.values()], self.commands)
        if not any(line.strip().upper() == "FINISH" for line in self.lines):
            notes.append(f"{self.path.name} has no FINISH: it may be cut short")
        heads = [line.split(",") for line in self.lines if line.upper().startswith(("NBLOCK", "EBLOCK"))]
        elements = {*self.dropped, *(number for some in self.rows.values() for number, _ in some)}
        for kind, what, there in (("ELEM", "elements", elements), ("NODE", "nodes", {*self.numbers})):
            for name, numbers in self.sets[kind].items():
                notes += not_in_file(f"the component {name!r}", what, numbers.tolist(), there)
        return RawMesh(
            numbers=index(self.numbers),
            points=np.array(self.points),
            elements=gathered(self.rows),
            element_sets=self.sets["ELEM"],
            node_sets=self.sets["NODE"],
            extra=index(self.extra),
            turned=index(self.turned),
            notes=tuple(notes),
            pretensions=self.bolts.sections(),
            # every block of nodes and elements says how many it holds, which was then compared
            counted=all(len(words) > 4 and words[4].strip().isdigit() and int(words[4]) > 0 for words in heads),
        )

    def _passed(self, k: int) -> int:
        """Pass over a line that is a command, or numbers of another one (RLBLOCK, LCURV, *PREAD, ...).

        Raises ReadError where line k belongs to a block whose command or form is not there.
        """
        line = self.lines[k].strip()
        before = self.lines[k - 1].lstrip().upper()
        led = before.startswith(("(", "*VW", "*VR", "*MW")) or "BLOCK" in before.partition(",")[0]  # RLBLOCK has two
        if line.startswith("(") and not led:
            raise ReadError(
                f"{self.path.name}, line {k + 1}: {line!r} gives the form of a block, but the line before is not a "
                "command of one (NBLOCK, EBLOCK, CMBLOCK, ...); is it missing?"
            )
        numbers = re.fullmatch(r"[-+]?[\d.][-+\d.eEdD\s]*", line) is not None
        if numbers and line != "-1" and self.last != k - 1:
            raise ReadError(
                f"{self.path.name}, line {k + 1}: {line[:40]!r} is not in a block; does the block before it have more "
                "lines than its head says?"
            )
        self.last = k
        return k + 1

    def _types(self, k: int, words: list[str]) -> int:
        """Element types of an ETBLOCK: number and name of each, then key options."""
        form = self.lines[k + 1]
        width = _width(form)
        wide = re.search(r",\s*\d*a(\d+)", form.lower())
        start, k = k, k + 2
        while int(self.lines[k][:width]) != -1:
            line = self.lines[k]
            name = line[width : 2 * width]
            name = name if wide is None or name.strip().isdigit() else line.split()[1]
            self.kinds[int(line[:width])] = re.sub(r"\D", "", name)
            k += 1
        if words[1].isdigit() and int(words[1]) != k - start - 2:
            raise ReadError(f"line {start + 1}: ETBLOCK says {words[1]} types and has {k - start - 2}; is it complete?")
        return k + 1

    def _nodes(self, k: int, words: list[str]) -> int:
        """Numbers, places and, where their directions are turned, names of the nodes of an NBLOCK."""
        form = self.lines[k + 1]
        whole, real = _columns(form)
        head, k = k, k + 2
        before = len(self.numbers)
        while not re.match(r"\s*(-1|N,)", self.lines[k], re.I):
            line = self.lines[k]
            heads, cells = ([line[at].strip() for at in some] for some in (whole, real))
            if not all(re.fullmatch(r"[-+]?\d+", cell) for cell in heads if cell) or line[real[-1].stop :].strip():
                raise ReadError(
                    f"line {k + 1}: {line.strip()[:60]!r} should be {len(whole)} whole numbers and up to {len(real)} "
                    f"others in {form.strip()}; is it damaged?"
                )
            values = [float(cell.replace("D", "E")) if cell else 0.0 for cell in cells]
            self.numbers.append(int(heads[0]))
            self.points.append(values[:3])
            if any(values[3:]):
                self.turned.append(self.numbers[-1])
            k += 1
        _check_count(head, words, len(self.numbers) - before, "nodes")
        return k + 1

    def _elements(self, k: int, words: list[str]) -> int:
        """Solids of an EBLOCK, and nodes of what is left out; without the key SOLID nothing but such."""
        solid = len(words) > 2 and words[2].upper() == "SOLID"
        width = _width(self.lines[k + 1])
        begin, found, k = k, 0, k + 2
        while (head := _cut(self.lines[k], width))[0] != -1:
            found += 1
            count, number, nodes = (head[8], head[10], head[11:]) if solid else (len(head) - 5, head[0], head[5:])
            k, kind = k + 1, self.kinds.get(head[1], "none of them")
            if not (solid or kind in _SURFACE or kind in _LEFT_OUT):
                raise ReadError(
                    f"line {k}: EBLOCK without the key SOLID is read for surfaces, contacts and the like, and type "
                    f"{head[1]} is {kind}; write the archive with CDWRITE,DB"
                )
            while len(nodes) < count:
                nodes += _cut(self.lines[k], width)
                k += 1
            if len(nodes) > count:
                raise ReadError(
                    f"line {k}: element {number} should have {count} nodes and has {len(nodes)}; is it damaged?"
                )
            self._element(number, self.kinds[head[1]], head[3], nodes)
        _check_count(begin, words, found, "elements")
        return k + 1

    def _element(self, number: int, kind: str, section: int, nodes: list[int]) -> None:
        if kind == "179" and len(nodes) >= 2:
            self.bolts.pairs.setdefault(section, []).append((nodes[0], nodes[1]))
        if kind in _SURFACE or kind in _LEFT_OUT:
            self.extra += nodes
            self.dropped[number] = kind
            return
        if kind not in _SOLIDS:
            raise ReadError(f"element {number} is of type {kind}; the known ones are SOLID185, 186, 187 and 285")
        shape, ordered = undoubled(nodes[: _SOLIDS[kind]], f"element {number} (SOLID{kind})")
        self.rows.setdefault(shape, []).append((number, ordered))

    def _component(self, k: int, words: list[str]) -> int:
        """Numbers of a CMBLOCK."""
        width, count = _width(self.lines[k + 1]), int(words[3].split("!")[0])
        values: list[int] = []
        k += 2
        while len(values) < count:
            values += _cut(self.lines[k], width)
            k += 1
        # a negative number ends a range that begins with the number before it
        self.sets[words[2].upper()[:4]][words[1]] = joined(
            ranged(before + 1, -value, 1, "CMBLOCK") if value < 0 else index([value])
            for before, value in zip([0, *values], values, strict=False)
        )
        return k


def _check_count(head: int, words: list[str], found: int, what: str) -> None:
    """Raise ReadError where a block has more or fewer lines than its head says."""
    if len(words) > 4 and words[4].isdigit() and int(words[4]) not in (0, found):
        raise ReadError(f"line {head + 1}: {words[0]} says {words[4]} {what} and has {found}; is the archive complete?")


def _left_out(elements: list[str], commands: list[str]) -> list[str]:
    """Sentences on elements and commands that were left out."""
    notes = [
        f"{elements.count(kind)} elements of type {kind} ({_LEFT_OUT[kind]}) are left out, with their stiffness and "
        "mass" + ("; give the bolts in [[bolt]] of the study, or let faying new propose them" if kind == "179" else "")
        for kind in dict.fromkeys(elements)
        if kind in _LEFT_OUT
    ]
    made = [name for name in _MAKERS if name in commands]
    if made:
        notes.append(f"nodes and elements of the commands {', '.join(made)}, outside the blocks, are not read")
    bolts = [name for name in commands if name in ("PSMESH", "SLOAD")]
    rest = [name for name in commands if name not in (*bolts, *made)]
    touching = [f"CONTA{kind}" for kind in elements if kind in map(str, ANSYS_CONTACT)]
    return notes + left_out({BOLT: bolts, CONSTRAINT: rest, CONTACT: touching}, "")


@dataclass
class _Bolts:
    """PRETS179 by the number of their section: pairs of nodes, and what SECDATA and SLOAD say of it."""

    pairs: dict[int, list[tuple[int, int]]] = field(default_factory=dict)
    axes: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    forces: dict[int, float] = field(default_factory=dict)
    section: int = 0  # that SECDATA speaks of; 0 for one of another kind

    def take(self, name: str, words: list[str]) -> None:
        """Note a command."""
        if name == "SECTYPE":
            self.section = int(words[1]) if len(words) > 2 and words[2].upper().startswith("PRET") else 0
        elif name == "SECDATA" and self.section and len(words) > 4:
            x, y, z = (float(word or 0) for word in words[2:5])
            self.axes[self.section] = x, y, z
        elif name == "SLOAD" and len(words) > 1 and words[1].isdigit():
            labels = [word.upper() for word in words]
            at = labels.index("FORC") + 1 if "FORC" in labels else len(words)
            if at < len(words) and words[at]:
                self.forces[int(words[1])] = float(words[at])

    def sections(self) -> tuple[Pretension, ...]:
        """The sections that have elements."""
        return tuple(
            Pretension(
                text=f"{len(some)} PRETS179 of section {number}",
                nodes=index(one for one, _ in some),
                twins=index(two for _, two in some),
                axis=self.axes.get(number),
                force=self.forces.get(number),
            )
            for number, some in self.pairs.items()
        )


def _columns(form: str) -> tuple[list[slice], list[slice]]:
    """Where integers and reals stand in a line, from a Fortran format such as (3i9,6e21.13e3) or (1i7,2i9,6e21.13)."""
    group = r"(\d{1,2})([iea])(\d{1,2})(?:\.\d+(?:e\d+)?)?"
    if not re.fullmatch(rf"\(\d{{1,2}}i\d{{1,2}}(?:,{group})*\)", form.strip().lower()):
        raise ValueError(f"{form.strip()!r} is not a format")
    found = re.findall(group, form.lower())
    out: dict[str, list[slice]] = {"i": [], "e": [], "a": []}
    start = 0
    for times, kind, width in found:
        for _ in range(int(times)):
            out[kind].append(slice(start, start + int(width)))
            start += int(width)
    return out["i"], out["e"]


def _width(form: str) -> int:
    """Width of the integers that a format such as (19i9) consists of."""
    return int(_columns(form)[0][0].stop)


def _cut(line: str, width: int) -> list[int]:
    cells = [line[i : i + width] for i in range(0, len(line.rstrip()), width)]
    return [int(cell) for cell in cells]


TYPE = 9101  # of the stiffness; the next is that of the dampers
ROW, COLUMN = np.triu_indices(12)


def decks(deck: JointDeck) -> dict[str, str]:
    """Files for /INPUT in /PREP7, by name; one of them, not all. The archive (.cdb) is for CDREAD,COMB."""
    out = {"joint_matrix27.inp": matrix27(deck), "joint_matrix27.cdb": archive(deck)}
    if deck.pairs.lumped:
        out["joint_combin14.inp"] = combin14(deck)
    if deck.contact is not None:
        out["joint_contact.inp"] = contact(deck)
    return out


def constants(blocks: Array) -> Array:
    """C1 to C78 (p, 78) of pairs with blocks (p, 3, 3)."""
    whole = np.zeros((len(blocks), 12, 12))
    for a, b, sign in ((0, 0, 1), (6, 6, 1), (0, 6, -1), (6, 0, -1)):
        whole[:, a : a + 3, b : b + 3] = sign * blocks
    return whole[:, ROW, COLUMN]


def _element_type(kind: int, name: str = "MATRIX27") -> list[str]:
    """Commands of the element type of stiffness or dampers."""
    return [f"ET,{kind},{name}", f"KEYOPT,{kind},2,0", f"KEYOPT,{kind},3,{4 if kind == TYPE else 5}"]


def _real_constants(number: int, values: Array) -> list[str]:
    """C1 to C78 of one set as commands, six in a line of 128 columns."""
    words = ["0" if v == 0 else real(float(v), 17) for v in values]
    rows = [",".join(words[j : j + 6]) for j in range(0, len(words), 6)]
    return [f"R,{number},{rows[0]}", *(f"RMORE,{row}" for row in rows[1:])]


def _sets(deck: JointDeck) -> list[tuple[int, dict[int, Array], Index]]:
    """(type, constants by the number of their set, number of the set of each pair) of stiffness and dampers."""
    out, number = [], deck.first_element
    for kind, blocks in ((TYPE, deck.stiffness), (TYPE + 1, deck.dampers)):
        if blocks is not None:
            first, group = grouped(blocks)
            out.append((kind, dict(enumerate(constants(blocks[first]), number)), number + group))
            number += len(first)
    return out


def _notes(deck: JointDeck) -> tuple[str, ...]:
    return (
        deck.damping_note(),
        *["solve with MODOPT,QRDAMP or MODOPT,DAMP: LANB leaves dampers out"] * (deck.dampers is not None),
        "nodes keep their axes along the global ones (no NROTAT); a face at an angle is in the full 3 x 3 blocks",
    )


def matrix27(deck: JointDeck) -> str:
    """Write MATRIX27 elements as commands."""
    lines = [*deck.header("!", *_notes(deck)), "/PREP7"]
    one, two = deck.ends
    number = count(deck.first_element)
    for kind, sets, of in _sets(deck):
        lines += _element_type(kind)
        for label, row in sets.items():
            lines += _real_constants(label, row)
        lines.append(f"TYPE,{kind}")
        for label, some in zip(sets, members(of - min(sets)), strict=True):
            lines += [f"REAL,{label}", *(f"EN,{next(number)},{one[i]},{two[i]}" for i in some)]
    return "\n".join(lines) + "\n"


def archive(deck: JointDeck) -> str:
    """Write the same elements as an archive: ET, RLBLOCK and EBLOCK, for CDREAD,COMB after the model."""
    lines = [*deck.header("!", *_notes(deck)), "/PREP7"]
    sets = _sets(deck)
    for kind, _, _ in sets:
        lines += _element_type(kind, "27")
    total = sum(len(of) for *_, of in sets)
    lines += [f"EBLOCK,19,SOLID,{deck.first_element + total - 1},{total}", "(19i10)"]
    number = count(deck.first_element)
    for kind, _, of in sets:
        for label, one, two in zip(of, *deck.ends, strict=True):
            head = [1, kind, label, 1, 0, 0, 0, 0, 2, 0, next(number), one, two]
            lines.append("".join(f"{w:10d}" for w in head))
    rows = {label: row for _, some, _ in sets for label, row in some.items()}
    lines += [f"{-1:10d}", f"RLBLOCK,{len(rows)},{max(rows)},78,7", "(2i8,6g16.9)", "(7g16.9)"]
    for label, row in rows.items():
        words = [f"{v:16.9E}" for v in row]
        lines.append(f"{label:8d}{78:8d}" + "".join(words[:6]))
        lines += ["".join(words[j : j + 7]) for j in range(6, 78, 7)]
    return "\n".join([*lines, "FINISH"]) + "\n"


def combin14(deck: JointDeck) -> str:
    """Write three COMBIN14 for each pair, along nodal axes that are turned into the face: X is the normal."""
    k = deck.pairs.own(deck.stiffness)
    c = np.zeros_like(k) if deck.dampers is None else deck.pairs.own(deck.dampers)
    axes, frame = grouped(deck.axes)
    lines = deck.header(
        "!",
        deck.damping_note(),
        "NROTAT turns the axes of the nodes of both faces: supports and loads on them are then in those axes; "
        "MATRIX27 leaves them alone",
    )
    lines.append("/PREP7")
    one, two = deck.ends
    for g, (leader, some) in enumerate(zip(axes, members(frame), strict=True)):
        n, t1, _ = deck.axes[leader]
        # LOCAL by three points: origin, a point on x, a point in the plane x y
        lines += ["*GET,JKCS,ACTIVE,0,CSYS", "CSYS,0", "*GET,JKN,NODE,0,NUM,MAX"]
        lines += [f"N,JKN+{j},{reals(at)}" for j, at in enumerate((np.zeros(3), n, t1), 1)]
        lines += [f"CS,{TYPE + g},0,JKN+1,JKN+2,JKN+3", f"CSYS,{TYPE + g}"]
        lines += [f"NROTAT,{node}" for i in some for node in (one[i], two[i])]
        lines += ["NDELE,JKN+1,JKN+3", "CSYS,JKCS"]
    number, sets = count(deck.first_element), count(deck.first_element)
    for axis in range(3):
        kind = TYPE + axis
        lines += [f"ET,{kind},COMBIN14", f"KEYOPT,{kind},2,{axis + 1}", f"TYPE,{kind}"]
        values = np.column_stack([k[:, axis], c[:, axis]])
        first, group = grouped(values / np.maximum(np.abs(values).max(axis=0), 1e-300))
        for leader, some, label in zip(first, members(group), sets, strict=False):
            lines += [f"R,{label},{reals(values[leader])}", f"REAL,{label}"]
            lines += [f"EN,{next(number)},{one[i]},{two[i]}" for i in some]
    return "\n".join(lines) + "\n"


def contact(deck: JointDeck) -> str:
    """Write the contact stiffness of one contact region as commands: k_n and k_t at its mean pressure."""
    law = deck.contact
    assert law is not None
    scale = deck.system.density
    lines = deck.header(
        "!",
        "commands for a contact region of CONTA174 in Workbench, where cid is its number; else set cid first",
        "FKN and FKT below zero are absolute, force per length cubed; one value for the region: cut the face into "
        "regions to follow the pressure",
        f"k_n and k_t at the mean pressure {law.mean_pressure * deck.system.pressure:.6g}",
    )
    lines += [
        "KEYOPT,cid,2,1",
        f"RMODIF,cid,3,{real(-law.k_n * scale, 20)}",
        f"RMODIF,cid,12,{real(-law.k_t * scale, 20)}",
    ]
    return "\n".join(lines) + "\n"


def condensed(deck: CondensedDeck) -> dict[str, str]:
    """Commands for /PREP7 that make two nodes and one MATRIX27 between them, by name."""
    lost = np.diag(deck.loss)[6:] / np.diag(deck.stiffness)[6:]
    factors = ", ".join(f"{value:.3g}" for value in lost)
    note = f"MATRIX27 takes no loss factor; those of the six motions are {factors}" if np.any(lost) else "no loss"
    lines = [*comments("!", *deck.facts, note), "/PREP7"]
    lines += [f"N,{node},{reals(at)}" for node, at in zip(deck.nodes, deck.places, strict=True)]
    lines += [*_element_type(TYPE), *_real_constants(deck.element, deck.in_units(deck.stiffness)[ROW, COLUMN])]
    lines += [f"TYPE,{TYPE}", f"REAL,{deck.element}", f"EN,{deck.element},{deck.nodes[0]},{deck.nodes[1]}"]
    return {"condensed_matrix27.inp": "\n".join(lines) + "\n"}
