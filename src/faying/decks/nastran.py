"""Nastran bulk data: read as meshes and DMIG matrices, and the joint written as CBUSH, CELAS2 and DMIG.

Read: GRID in any system, CTETRA, CHEXA, CPENTA, skins of CTRIA and CQUAD, PLOAD4 and SET1, in small, large and free
fields, after the Nastran Quick Reference Guide. A body is what has one property number; faces are skins of one
property, the element faces that PLOAD4 cards of one load set name, or sets of nodes (SET1, or SET of the case control).

Written, in fields of 16 columns, after the MSC Nastran Quick Reference Guide and OptiStruct's: PBUSH (K, B, GE), CBUSH
with CID since its grids coincide, CELAS2 (K, G1, C1, G2, C2, GE), DMIG with one triangle of a symmetric matrix (form
6), chosen in the case control by K2GG, B2GG and K42GG. MYSTRAN solves CBUSH and CELAS2 and passes DMIG over.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from faying.decks.deck import CondensedDeck, JointDeck, comments, grouped, real, springs_of
from faying.decks.raw import Matrices, RawMesh, both_triangles, face_blocks, gathered, index, once, read_text
from faying.errors import InputError, ReadError
from faying.fe.elements import KINDS, SOLIDS
from faying.typing import Array, Index

# Nastran puts the nodes of the upright edges before those of the top
_ORDER = {
    20: [*range(12), *range(16, 20), *range(12, 16)],
    15: [*range(9), *range(12, 15), *range(9, 12)],
}
_COUNTS = {"CTETRA": (4, 10), "CHEXA": (8, 20), "CPENTA": (6, 15)}
_SKINS = {"CTRIA3": (3, 3), "CTRIAR": (3, 3), "CTRIA6": (3, 6), "CQUAD4": (4, 4), "CQUADR": (4, 4), "CQUAD8": (4, 8)}
# what is left out, by the places of the grids it names
_LEFT_OUT = {
    "CBAR": (2, 3),
    "CBEAM": (2, 3),
    "CROD": (2, 3),
    "CONROD": (1, 2),
    "PLOTEL": (1, 2),
    "CONM1": (1,),
    "CONM2": (1,),
    "CELAS1": (2, 4),
    "CELAS2": (2, 4),
    "CBUSH": (2, 3),
    "CDAMP1": (2, 4),
    "CDAMP2": (2, 4),
    "CMASS2": (2, 4),
    "RBE2": (1,),
    "RBE3": (2,),
    "RBAR": (1, 2),
    "RROD": (1, 2),
}
_MOST_FILES = 500

Card = tuple[str, list[str], str]
Field = int | float | str


def cards(path: Path, seen: tuple[Path, ...] = (), count: list[int] | None = None) -> Iterator[Card]:
    """Every card as (name, fields, where), its continuations joined; those of included files too; ENDDATA last."""
    count = [0] if count is None else count
    count[0] += 1
    if path.resolve() in seen:
        raise ReadError(f"{path} includes itself")
    if len(seen) > 20 or count[0] > _MOST_FILES:
        raise ReadError(f"{path}: more than {_MOST_FILES} files are included, or 20 deep; write them into one")
    lines = read_text(path, "bulk data").splitlines()
    bulk = not any(re.match(r"\s*BEGIN\s+BULK", line, re.I) for line in lines)
    name, fields, where = "", [""], ""
    for number, full in enumerate(lines, 1):
        line = full.partition("$")[0].rstrip().expandtabs(8)
        if not line.strip():
            continue
        if not bulk:
            bulk = bool(re.match(r"\s*BEGIN\s+BULK", line, re.I))
            continue
        found = re.match(r"\s*INCLUDE\s+['\"]?([^'\"]+)['\"]?", line, re.I)
        ended = re.match(r"\s*ENDDATA", line, re.I)
        first, rest = ("", []) if found or ended else _fields(line, f"{path.name}, line {number}")
        if not found and not ended and (first == "" or first[0] in "+*"):
            fields += rest
            continue
        if name:
            yield name, fields, where
            name = ""
        if ended:
            yield "ENDDATA", [], f"{path.name}, line {number}"
            return
        if found:
            yield from (c for c in cards(path.parent / found.group(1).strip(), (*seen, path.resolve()), count))
            continue
        name, fields, where = first.rstrip("*").upper(), rest, f"{path.name}, line {number}"
    if name:
        yield name, fields, where


def _fields(line: str, where: str) -> tuple[str, list[str]]:
    """First field, and the data fields of one line: eight small ones, four large ones, or those between commas."""
    if "," in line:
        first, *rest = (word.strip() for word in line.split(","))
        limit = 4 if first.endswith("*") or first.startswith("*") else 8
        if len(rest) > limit + 1:
            raise ReadError(f"{where}: {len(rest)} fields, {limit} fit; a number has a decimal point, not a comma")
        return first, rest[:limit] + [""] * (limit - len(rest))
    first = line[:8].strip()
    width = 16 if "*" in first else 8
    return first, [line[8 + k * width : 8 + (k + 1) * width].strip() for k in range(64 // width)]


def number(text: str) -> float:
    """A Nastran real: 1.5+3 and 1.5D3 are 1500."""
    text = text.upper().replace("D", "E")
    return float(re.sub(r"(?<=[\d.])([+-]\d+)$", r"E\1", text))


@dataclass
class _Bulk:
    """What the cards of a file hold."""

    grids: dict[int, tuple[int | None, tuple[float, float, float], int | None]] = field(default_factory=dict)
    systems: dict[int, tuple[str, int, list[str]]] = field(default_factory=dict)
    default: tuple[int, int] = (0, 0)  # the systems of places and directions that GRDSET gives
    solids: dict[str, list[tuple[int, list[int]]]] = field(default_factory=dict)
    solid: dict[int, tuple[str, list[int]]] = field(default_factory=dict)
    bodies: dict[str, list[int]] = field(default_factory=dict)
    skins: dict[str, list[list[int]]] = field(default_factory=dict)
    loads: list[tuple[list[str], str]] = field(default_factory=list)
    sets: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    left_out: dict[str, int] = field(default_factory=dict)
    references: list[int] = field(default_factory=list)
    ended: bool = False

    def take(self, name: str, fields: list[str], where: str) -> None:
        """Note one card."""
        if name == "GRID":
            self._grid(fields, where)
        elif name == "GRDSET":
            self.default = int(fields[1] or 0), int(fields[5] or 0)
        elif re.fullmatch(r"CORD[12][RCS]", name):
            halves = [fields] if name[4] == "2" or not any(fields[4:8]) else [fields[:4], fields[4:8]]
            for half in halves:
                self.systems[int(half[0])] = (name, int(half[1] or 0) if name[4] == "2" else 0, half)
        elif re.match(r"CORD", name):
            raise ReadError(f"{where}: {name} is not known; give the system as CORD2R, CORD2C or CORD2S")
        elif name in _COUNTS:
            self._solid(name, fields, where)
        elif name in _SKINS:
            few, many = _SKINS[name]
            nodes = [int(word) for word in fields[2 : 2 + many] if word]
            self.skins.setdefault(f"face{fields[1] or fields[0]}", []).append(
                nodes if len(nodes) == many else nodes[:few]
            )
        elif name == "PLOAD4":
            self.loads.append((fields, where))
        elif name == "SET1":
            self.sets[f"SET{fields[0]}"] = _listed([word for word in fields[1:] if word])
        elif name in _LEFT_OUT:
            self.left_out[name] = self.left_out.get(name, 0) + 1
            self.references += [int(fields[k]) for k in _LEFT_OUT[name] if k < len(fields) and fields[k].isdigit()]
        elif name == "ENDDATA":
            self.ended = True
        elif name.startswith("C") and not name.startswith(("CSET", "CEND")):
            raise ReadError(f"{where}: elements {name} are not known; known are {', '.join(_COUNTS)}")

    def _grid(self, fields: list[str], where: str) -> None:
        x, y, z = (number(word) if word else 0.0 for word in fields[2:5])
        if any(fields[6:8]) and any(word and "." not in word for word in fields[2:5]):
            raise ReadError(
                f"{where}: GRID {fields[0]} has more than three coordinates; a number has a decimal point, not a comma"
            )
        one = (int(fields[1]) if fields[1] else None, (x, y, z), int(fields[5]) if fields[5] else None)
        if self.grids.setdefault(int(fields[0]), one) != one:
            raise ReadError(f"{where}: GRID {fields[0]} is given twice, at different places")

    def _solid(self, name: str, fields: list[str], where: str) -> None:
        few, many = _COUNTS[name]
        given = [int(word) for word in fields[2 : 2 + many] if word]
        if len(given) not in (few, many):
            raise ReadError(f"{where}: {name} {fields[0]} has {len(given)} nodes; {few} or {many} are known")
        ordered = [given[i] for i in _ORDER.get(len(given), range(len(given)))]
        kind = SOLIDS[len(given)].name
        self.solids.setdefault(kind, []).append((int(fields[0]), ordered))
        self.solid[int(fields[0])] = (kind, ordered)
        self.bodies.setdefault(f"part{fields[1] or fields[0]}", []).append(int(fields[0]))

    def place(self, grid: int, seen: tuple[str, ...] = ()) -> Array:
        """Place of a grid in the basic system (3,)."""
        if grid not in self.grids:
            raise ReadError(f"GRID {grid} of a coordinate system is not in the file; is the file whole?")
        system, at, _ = self.grids[grid]
        return self._basic(np.array(at), self.default[0] if system is None else system, seen)

    def _basic(self, at: Array, system: int, seen: tuple[str, ...]) -> Array:
        """Coordinates in a system, brought to the basic one."""
        if system == 0:
            return at
        label = f"coordinate system {system}"
        if system not in self.systems or label in seen:
            raise ReadError(f"{label} is not in the file, or is given by itself; is the file whole?")
        name, reference, fields = self.systems[system]
        if name[4] == "1":
            origin, along, across = (self.place(int(word), (*seen, label)) for word in fields[1:4])
        else:
            nine = np.array([number(word) if word else 0.0 for word in fields[2:11]])
            origin, along, across = (self._basic(p, reference, (*seen, label)) for p in nine.reshape(3, 3))
        z = along - origin
        y = np.cross(z, across - origin)
        if np.linalg.norm(y) < 1e-9 * np.linalg.norm(z) * np.linalg.norm(across - origin) or not np.any(z):
            raise ReadError(f"{label}: its three points coincide or lie on one line")
        z, y = z / np.linalg.norm(z), y / np.linalg.norm(y)
        if name[5] == "C":
            angle = np.deg2rad(at[1])
            at = np.array([at[0] * np.cos(angle), at[0] * np.sin(angle), at[2]])
        elif name[5] == "S":
            polar, angle = np.deg2rad(at[1:])
            at = at[0] * np.array([np.sin(polar) * np.cos(angle), np.sin(polar) * np.sin(angle), np.cos(polar)])
        return np.asarray(origin + at @ np.stack([np.cross(y, z), y, z]))


def read(path: Path) -> RawMesh:
    """Read a bulk data file. Raises ReadError for what it cannot read, naming line and card."""
    bulk = _Bulk(sets=_case_sets(path))
    for name, fields, where in cards(path):
        try:
            bulk.take(name, fields, where)
        except ReadError:
            raise
        except (ValueError, IndexError) as fault:
            raise ReadError(f"{where}: {name} {fields[0]} cannot be read ({fault}); is the file whole?") from None
    if not bulk.grids or not bulk.solids:
        raise ReadError(
            f"{path} holds {len(bulk.grids)} GRID cards and {len(bulk.solid)} solid elements; write both into it"
        )
    notes = [
        f"{count} cards {name} are left out, with their stiffness and mass" for name, count in bulk.left_out.items()
    ]
    if not bulk.ended:
        text = read_text(path, "bulk data")
        if re.search(r"^\s*BEGIN\s+BULK", text, re.I | re.M):
            raise ReadError(f"{path} ends without ENDDATA; the file is cut short")
        notes.append(f"{path.name} has no ENDDATA: it may be cut short")
    numbers = index(bulk.grids)
    turned = [n for n, (_, _, cd) in bulk.grids.items() if (bulk.default[1] if cd is None else cd) != 0]
    return RawMesh(
        numbers=numbers,
        points=np.array([bulk.place(grid) for grid in bulk.grids]),
        elements=gathered(bulk.solids),
        bodies={key: index(some) for key, some in bulk.bodies.items()},
        node_sets={name: _within(some, numbers) for name, some in bulk.sets.items()},
        side_sets=_loaded(bulk.loads, bulk.solid),
        face_elements={name: face_blocks(some) for name, some in bulk.skins.items()},
        extra=index(node for some in bulk.skins.values() for nodes in some for node in nodes),
        references=index(bulk.references),
        turned=index(turned),
        notes=tuple(notes),
    )


def _listed(words: list[str]) -> list[tuple[int, int]]:
    """Numbers and ranges with THRU as (first, last)."""
    out: list[tuple[int, int]] = []
    k = 0
    while k < len(words):
        if words[k].upper() == "THRU":
            out[-1] = out[-1][0], int(words[k + 1])
            k += 2
        else:
            out.append((int(words[k]), int(words[k])))
            k += 1
    return out


def _within(ranges: list[tuple[int, int]], numbers: Index) -> Index:
    """Numbers of a set: those given one by one, and those of a range that there are."""
    ranked = np.sort(numbers)
    found = [
        index([first]) if first == last else ranked[slice(*np.searchsorted(ranked, [first, last + 1]))]
        for first, last in ranges
    ]
    return np.unique(np.concatenate([index([]), *found]))


def _case_sets(path: Path) -> dict[str, list[tuple[int, int]]]:
    """SET n = ... of the case control."""
    head = re.split(r"BEGIN\s+BULK", read_text(path, "bulk data"), maxsplit=1, flags=re.I)
    if len(head) < 2:
        return {}
    found = re.finditer(r"^\s*SET\s+(\d+)\s*=\s*((?:[^,\n]+,\s*)*[^,\n]+)$", head[0], re.I | re.M)
    sets = {}
    for one in found:
        words = re.sub(r",", " ", one.group(2)).split()
        if words[0].isdigit() and words[-1].isdigit() and all(w.isdigit() or w.upper() == "THRU" for w in words):
            sets[f"SET{one.group(1)}"] = _listed(words)
    return sets


def _loaded(loads: list[tuple[list[str], str]], where_of: dict[int, tuple[str, list[int]]]) -> dict[str, Index]:
    """Element faces that PLOAD4 cards name, by load set."""
    out: dict[str, list[tuple[int, int]]] = {}
    for fields, where in loads:
        if not all(word.isdigit() for word in (fields[1], *filter(None, fields[6:8]))):
            raise ReadError(f"{where}: PLOAD4 names {', '.join(fields[1:8:3])}, which are no elements and nodes")
        element = int(fields[1])
        if element not in where_of:
            continue  # a load on a shell
        kind, nodes = where_of[element]
        if not fields[6]:
            raise ReadError(f"{where}: PLOAD4 on the solid {element} names no corner G1 of the face")
        first, other = int(fields[6]), int(fields[7]) if fields[7] else None
        for side, places in enumerate(KINDS[kind].sides):
            here = {nodes[i] for i in places if i < KINDS[kind].corners}
            if first not in here:
                continue
            if kind.startswith("tet"):
                good = other is not None and other not in here
            else:
                good = other in here if other is not None else len(here) == 3
            if good:
                out.setdefault(f"PLOAD4_{fields[0]}", []).append((element, side))
                break
        else:
            raise ReadError(
                f"{where}: PLOAD4 names the nodes {first} and {other}, which tell no face of element {element}"
            )
    return {name: np.array(rows) for name, rows in out.items()}


def read_matrices(path: Path, names: tuple[str, str]) -> Matrices:
    """Read real DMIG entries: G and C of the column, then rows of G, C, value; form 6 gives one triangle."""
    from scipy.sparse import coo_array

    if not read_text(path, "bulk data").endswith("\n"):
        raise ReadError(f"{path} ends in the middle of a line; it is cut short")
    heads: dict[str, int] = {}
    entries: dict[str, list[tuple[tuple[int, int], tuple[int, int], float]]] = {}
    for card, fields, where in cards(path):
        if card != "DMIG":
            continue
        name = fields[0].upper()
        try:
            if fields[1] == "0":
                if int(fields[3] or 1) > 2:
                    raise ReadError(f"{where}: DMIG {name} is complex; stiffness and mass are real")
                heads[name] = int(fields[2])
                continue
            column = int(fields[1]), int(fields[2] or 0)
            for k in range(4, len(fields) - 2, 4):
                if fields[k]:
                    entry = (int(fields[k]), int(fields[k + 1] or 0)), column, number(fields[k + 2])
                    entries.setdefault(name, []).append(entry)
        except ReadError:
            raise
        except (ValueError, IndexError) as fault:
            raise ReadError(f"{where}: DMIG {name} cannot be read ({fault}); is the file whole?") from None
    for name in names:
        if name.upper() not in entries:
            raise ReadError(f"{path} holds no DMIG {name}; it holds {', '.join(sorted(entries)) or 'none'}")
    found = [entries[name.upper()] for name in names]
    keys = sorted({key for some in found for row, column, _ in some for key in (row, column)})
    place = {key: i for i, key in enumerate(keys)}
    out = []
    for name, some in zip(names, found, strict=True):
        i, j = index(place[row] for row, _, _ in some), index(place[column] for _, column, _ in some)
        one = heads.get(name.upper(), 6) == 6
        once(f"{path.name}, DMIG {name}", np.minimum(i, j) if one else i, np.maximum(i, j) if one else j, len(keys))
        A = coo_array(([value for *_, value in some], (i, j)), shape=(len(keys), len(keys))).tocsr()
        out.append(both_triangles(A) if one else A)
    return out[0], out[1], np.array(keys, dtype=np.int64)


def decks(deck: JointDeck) -> dict[str, str]:
    """Bulk data to include, by name; one of them, not all."""
    out = {"joint_dmig.bdf": dmig(deck), "joint_celas2.bdf": celas2(deck)}
    if deck.pairs.lumped:
        out["joint_cbush.bdf"] = cbush(deck)
    return out


def card(name: str, *values: Field) -> list[str]:
    """One card in fields of 16 columns, four in each line."""
    words = [real(v, 16) if isinstance(v, float) else str(v) for v in values]
    rows = [words[k : k + 4] for k in range(0, len(words), 4)]
    return [
        f"{name + '*' if k == 0 else '*':<8}" + "".join(f"{word:<16}" for word in row).rstrip()
        for k, row in enumerate(rows)
    ]


def cbush(deck: JointDeck) -> str:
    """Write CBUSH elements in coordinate systems of the face: direction 1 is the normal. Raises as `NodePairs.own`."""
    k, lost = deck.pairs.own(deck.stiffness), deck.pairs.own(deck.loss)
    ratio = np.divide(lost, k, out=np.zeros_like(k), where=k != 0)
    dampers = deck.pairs.own(deck.dampers) if deck.paper and deck.dampers is not None else np.zeros_like(k)
    note = (
        deck.damping_note()
        if dampers.any()
        else "GE of directions 1, 2, 3; a solver that reads one GE takes that of the normal"
    )
    lines = deck.header("$", note)
    axes, frame = grouped(deck.axes)
    number = deck.first_element
    for g, leader in enumerate(axes):
        n, _, t2 = (tuple(float(x) for x in row) for row in deck.axes[leader])
        lines += card("CORD2R", number + g, 0, 0.0, 0.0, 0.0, *t2, *n)
    size = np.abs(k).max()
    first, alike = grouped(np.column_stack([k / size, ratio, dampers / max(dampers.max(), 1e-300)]))
    for g, leader in enumerate(first):
        words: list[Field] = [number + g, "K", *map(float, k[leader]), "", "", ""]
        if dampers[leader].any():
            words += ["", "B", *map(float, dampers[leader]), "", "", ""]
        elif ratio[leader].any():
            words += ["", "GE", *map(float, ratio[leader]), "", "", ""]
        lines += card("PBUSH", *words)
    for i, (one, two) in enumerate(zip(*deck.ends, strict=True)):
        lines += card(
            "CBUSH", number + i, number + int(alike[i]), int(one), int(two), "", "", "", number + int(frame[i])
        )
    return "\n".join(lines) + "\n"


def celas2(deck: JointDeck) -> str:
    """Write CELAS2 elements in the basic axes.

    What an inclined face couples becomes springs that cancel on the diagonal.

    Grids must have their displacements in the basic axes (CD = 0). Raises InputError where a spring that couples has a
    loss factor of another sign than its stiffness.
    """
    note = (
        deck.damping_note()
        if deck.paper
        else "loss factors in GE; springs in the basic axes: leave CD of the grids blank"
    )
    lines = deck.header("$", note)
    number = deck.first_element
    grids = deck.ends
    lost = springs_of(deck.loss, deck.stiffness)
    for (a, c, b, d, values), (*_, loss) in zip(springs_of(deck.stiffness), lost, strict=True):
        for i in np.flatnonzero((values != 0) | (loss != 0)):
            if values[i] == 0:
                raise InputError("a spring with loss but no stiffness has no loss factor; take matrix or dmig")
            factor = 0.0 if deck.paper else float(loss[i] / values[i])
            lines += card(
                "CELAS2",
                number,
                float(values[i]),
                int(grids[a][i]),
                c + 1,
                int(grids[b][i]),
                d + 1,
                *([factor] if factor else []),
            )
            number += 1
    if deck.paper and deck.dampers is not None:
        for a, c, b, d, values in springs_of(deck.dampers):
            for i in np.flatnonzero(values):
                lines += card("CDAMP2", number, float(values[i]), int(grids[a][i]), c + 1, int(grids[b][i]), d + 1)
                number += 1
    return "\n".join(lines) + "\n"


def dmig(deck: JointDeck) -> str:
    """Write the joint as DMIG matrices KJOINT and, for the loss, K4JOINT (structural) or BJOINT (viscous)."""
    chosen = ["case control: K2GG = KJOINT"]
    bulk = _dmig("KJOINT", deck, deck.stiffness)
    if deck.paper and deck.dampers is not None:
        chosen += ["case control: B2GG = BJOINT", deck.damping_note()]
        bulk += _dmig("BJOINT", deck, deck.dampers)
    elif np.any(deck.loss):
        chosen.append("case control: K42GG = K4JOINT, the loss as a structural damping matrix")
        bulk += _dmig("K4JOINT", deck, deck.loss)
    return "\n".join([*deck.header("$", *chosen), *bulk]) + "\n"


def _dmig(name: str, deck: JointDeck, blocks: Array) -> list[str]:
    from scipy.sparse import tril

    lower = tril(deck.pairs.matrix(blocks)).tocsc()
    n = deck.mesh.numbers
    lines = card("DMIG", name, 0, 6, 2, 0)
    for j in np.flatnonzero(np.diff(lower.indptr)):
        here = slice(lower.indptr[j], lower.indptr[j + 1])
        words: list[Field] = [name, int(n[j // 3]), int(j % 3 + 1), ""]
        for i, v in zip(lower.indices[here], lower.data[here], strict=True):
            if v:
                words += [int(n[i // 3]), int(i % 3 + 1), float(v), ""]
        if len(words) > 4:
            lines += card("DMIG", *words)
    return lines


COUPLED = 1e-2  # of the mean of two diagonals: a coupling above it a CBUSH cannot leave out


def condensed(deck: CondensedDeck) -> dict[str, str]:
    """Bulk data of a condensed joint, by name: a DMIG, and a CBUSH where both points coincide and little couples."""
    grids = [
        line
        for node, at in zip(deck.nodes, deck.places, strict=True)
        for line in card("GRID", node, 0, *map(float, at), 0)
    ]
    chosen = ["case control: K2GG = KJOINT"]
    lines = _triangle("KJOINT", deck, deck.in_units(deck.stiffness))
    if np.any(deck.loss):
        chosen.append("case control: K42GG = K4JOINT, the loss as a structural damping matrix")
        lines += _triangle("K4JOINT", deck, deck.in_units(deck.loss))
    out = {"condensed_dmig.bdf": "\n".join([*comments("$", *deck.facts, *chosen), *grids, *lines]) + "\n"}
    bush = _bush(deck)
    if bush:
        note, cards = bush
        out["condensed_cbush.bdf"] = "\n".join([*comments("$", *deck.facts, note), *grids, *cards]) + "\n"
    return out


def _triangle(name: str, deck: CondensedDeck, matrix: Array) -> list[str]:
    lines = card("DMIG", name, 0, 6, 2, 0)
    for j, (node, direction) in enumerate(deck.entries):
        words: list[Field] = [name, node, direction, ""]
        for i in range(j, 12):
            if matrix[i, j]:
                words += [*deck.entries[i], float(matrix[i, j]), ""]
        if len(words) > 4:
            lines += card("DMIG", *words)
    return lines


def _bush(deck: CondensedDeck) -> tuple[str, list[str]] | None:
    """A note and the cards of a CBUSH in the principal axes of the rotations; None where it leaves out too much."""
    one, two = deck.points
    if np.linalg.norm(two - one) > 0:
        return None
    K, lost = deck.in_units(deck.stiffness)[6:, 6:], deck.in_units(deck.loss)[6:, 6:]
    _, axes = np.linalg.eigh(K[3:, 3:])
    axes = axes * np.where(axes[np.abs(axes).argmax(axis=0), range(3)] < 0, -1.0, 1.0)
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    axes = axes + 0.0  # no -0
    turn = np.kron(np.eye(2), axes)
    K, lost = turn.T @ K @ turn, turn.T @ lost @ turn
    own = np.diag(K)
    coupling = float(np.abs((K - np.diag(own)) / np.sqrt(np.outer(own, own))).max())
    if coupling > COUPLED:
        return None
    note = f"GE of directions 1 to 6; a CBUSH couples none of them: it leaves out couplings of up to {coupling:.1e}"
    lines = card("CORD2R", deck.element, 0, 0.0, 0.0, 0.0, *map(float, axes[:, 2]), *map(float, axes[:, 0]))
    words: list[Field] = [deck.element, "K", *map(float, own)]
    if np.any(lost):
        words += ["", "GE", *map(float, np.diag(lost) / own)]
    lines += card("PBUSH", *words)
    return note, lines + card("CBUSH", deck.element, deck.element, *deck.nodes, "", "", "", deck.element)
