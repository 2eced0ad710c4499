"""The bulk data of Nastran: cards with their continuations and includes, and what they hold of a mesh."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from faying.decks.raw import UPRIGHT_FIRST, check_included, read_text
from faying.decks.vocabulary import nastran_kind
from faying.errors import ReadError
from faying.fe.elements import SOLIDS
from faying.files import named_by
from faying.typing import Array

COUNTS = {"CTETRA": (4, 10), "CHEXA": (8, 20), "CPENTA": (6, 15)}
_SKINS = {"CTRIA3": (3, 3), "CTRIAR": (3, 3), "CTRIA6": (3, 6), "CQUAD4": (4, 4), "CQUADR": (4, 4), "CQUAD8": (4, 8)}
# what is left out, and the places of the grids that it names
_LEFT_OUT: dict[str, Sequence[int]] = {
    # the third grid of a beam orients it, where it is a grid and no real number
    **dict.fromkeys(("CBAR", "CBEAM", "CBEND", "CGAP", "CBUSH"), (2, 3, 4)),
    "CBEAM3": (2, 3, 4, 5),
    **dict.fromkeys(("CROD", "CTUBE", "CVISC", "CBUSH1D", "CBUSH2D"), (2, 3)),
    **dict.fromkeys(("CONROD", "PLOTEL"), (1, 2)),
    **dict.fromkeys(("CFAST", "CWELD", "CSEAM", "CGEN"), ()),
    **dict.fromkeys(("CONM1", "CONM2"), (1,)),
    **dict.fromkeys(("CELAS1", "CELAS2", "CDAMP1", "CDAMP2", "CMASS1", "CMASS2"), (2, 4)),
    **dict.fromkeys(("CELAS3", "CELAS4", "CDAMP3", "CDAMP4", "CDAMP5", "CMASS3", "CMASS4"), (2, 3)),
    "RBE1": (1, 3, 5),
    **dict.fromkeys(("RBAR", "RBAR1", "RROD"), (1, 2)),
    "RBE2": (1,),
    **dict.fromkeys(("RBE3", "RSPLINE"), (2,)),
    # plates in shear, of large strain, of revolution; sides for heat; acoustic absorbers and barriers
    "CSHEAR": range(2, 6),
    **dict.fromkeys(("CQUAD", "CQUADX"), range(2, 11)),
    **dict.fromkeys(("CTRIAX", "CTRIAX6"), range(2, 8)),
    "CHBDYE": (),
    "CHBDYG": range(8, 16),
    "CHBDYP": (5, 6, 7),
    "CAABSF": range(2, 6),
    **dict.fromkeys(("CHACAB", "CHACBR"), range(2, 22)),
}
# cards that begin with C and are not elements: loads, output, aerodynamics, symmetry, laws
_NO_ELEMENTS = (
    *("CSET", "CEND", "CONV", "CLOAD", "CBARAO", "CAERO", "CMFREE", "CONTRLT", "CREEP", "CSCHD", "CSSCHD", "CSUP"),
    *("CYAX", "CYSUP", "CYSYM", "CAMPBLL", "COMPUDS", "CINTC"),
)

Card = tuple[str, list[str], str]


def cards(path: Path, seen: tuple[Path, ...] = (), count: list[int] | None = None) -> Iterator[Card]:
    """Every card as (name, fields, where), its continuations joined; those of included files too; ENDDATA last."""
    count = [0] if count is None else count
    check_included(path, seen, count)
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
        if name == "DEQATN" and line[0] in " +*":
            continue  # more of an equation
        first, rest = ("", []) if found or ended else _fields(line, f"{path.name}, line {number}")
        if not found and not ended and (first == "" or first[0] in "+*"):
            fields += rest
            continue
        if name:
            yield name, fields, where
            name = ""
        if ended:
            yield "ENDDATA", [""], f"{path.name}, line {number}"
            return
        if found:
            yield from cards(named_by(path, found.group(1).strip()), (*seen, path.resolve()), count)
            continue
        name, fields, where = first.rstrip("*").upper(), rest, f"{path.name}, line {number}"
    if name:
        yield name, fields, where


def _fields(line: str, where: str) -> tuple[str, list[str]]:
    """First field, and the data fields of one line: eight small ones, four large ones, or those between commas."""
    if line.upper().startswith("DEQATN"):  # an equation, with commas of its own
        return "DEQATN", [""]
    if "," in line:
        first, *rest = (word.strip() for word in line.split(","))
        if re.fullmatch(r"[A-Za-z]\w* +\d+", first):  # blanks part fields as well
            first, rest = first.split()[0], [first.split()[1], *rest]
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
class Bulk:
    """What the cards of a file hold."""

    grids: dict[int, tuple[int | None, tuple[float, float, float], int | None]] = field(default_factory=dict)
    systems: dict[int, tuple[str, int, list[str]]] = field(default_factory=dict)
    default: tuple[int, int] = (0, 0)  # the systems of places and directions that GRDSET gives
    solids: dict[str, list[tuple[int, list[int]]]] = field(default_factory=dict)
    solid: dict[int, tuple[str, list[int]]] = field(default_factory=dict)
    bodies: dict[str, list[int]] = field(default_factory=dict)
    skins: dict[str, list[list[int]]] = field(default_factory=dict)
    others: set[int] = field(default_factory=set)  # numbers of skins, and of elements that are left out
    loads: list[tuple[list[str], str]] = field(default_factory=list)
    sets: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    left_out: dict[str, int] = field(default_factory=dict)
    references: list[int] = field(default_factory=list)
    constraints: dict[str, list[str]] = field(default_factory=dict)  # cards of contact, bolts, constraints
    ended: bool = False

    def take(self, name: str, fields: list[str], where: str) -> None:
        """Note one card."""
        if name.startswith("=") or any(word.startswith(("=", "*(")) for word in fields):
            raise ReadError(f"{where}: fields that repeat the card before (=, *(n)) are not read; write them out")
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
        elif name in COUNTS:
            self._solid(name, fields, where)
        elif name in _SKINS:
            few, many = _SKINS[name]
            nodes = [int(word) for word in fields[2 : 2 + many] if word]
            if not all(fields[2 : 2 + few]) or len(fields) < 2 + few:
                raise ReadError(f"{where}: {name} {fields[0]} has no {few} corners; is the file complete?")
            self.others.add(int(fields[0]))
            self.skins.setdefault(f"face{fields[1] or fields[0]}", []).append(
                nodes if len(nodes) == many else nodes[:few]
            )
        elif name == "PLOAD4":
            self.loads.append((fields, where))
        elif name == "SET1":
            self.sets[f"SET{fields[0]}"] = listed([word for word in fields[1:] if word])
        elif name in _LEFT_OUT:
            self.left_out[name] = self.left_out.get(name, 0) + 1
            self.others |= {int(word) for word in fields[:1] if word.isdigit()}
            self.references += [int(fields[k]) for k in _LEFT_OUT[name] if k < len(fields) and fields[k].isdigit()]
        elif name == "ENDDATA":
            self.ended = True
        elif kind := nastran_kind(name):
            self.constraints.setdefault(kind, []).append(name)
        elif name.startswith("C") and not name.startswith(_NO_ELEMENTS):
            raise ReadError(f"{where}: elements {name} are not known; the known ones are {', '.join(COUNTS)}")

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
        few, many = COUNTS[name]
        given = [int(word) for word in fields[2 : 2 + many] if word]
        if any(fields[2 + many :]):
            raise ReadError(f"{where}: {name} {fields[0]} has more than {many} nodes; is a line there twice?")
        if len(given) not in (few, many):
            raise ReadError(f"{where}: {name} {fields[0]} has {len(given)} nodes; {few} or {many} are known")
        ordered = [given[i] for i in UPRIGHT_FIRST.get(len(given), range(len(given)))]
        kind = SOLIDS[len(given)].name
        self.solids.setdefault(kind, []).append((int(fields[0]), ordered))
        self.solid[int(fields[0])] = (kind, ordered)
        if fields[1] and not fields[1].isdigit():
            raise ReadError(f"element {fields[0]}: its property {fields[1]!r} is not a whole number")
        self.bodies.setdefault(f"part{fields[1] or fields[0]}", []).append(int(fields[0]))

    def place(self, grid: int, seen: tuple[str, ...] = ()) -> Array:
        """Place of a grid in the basic system (3,)."""
        if grid not in self.grids:
            raise ReadError(f"GRID {grid} of a coordinate system is not in the file; is the file complete?")
        system, at, _ = self.grids[grid]
        return self._basic(np.array(at), self.default[0] if system is None else system, seen)

    def _basic(self, at: Array, system: int, seen: tuple[str, ...]) -> Array:
        """Coordinates in a system, brought to the basic one."""
        if system == 0:
            return at
        label = f"coordinate system {system}"
        if system not in self.systems or label in seen:
            raise ReadError(f"{label} is not in the file, or is given by itself; is the file complete?")
        name, reference, fields = self.systems[system]
        if name[4] == "1":
            origin, along, across = (self.place(int(word), (*seen, label)) for word in fields[1:4])
        else:
            nine = np.array([number(word) if word else 0.0 for word in fields[2:11]])
            origin, along, across = (self._basic(p, reference, (*seen, label)) for p in nine.reshape(3, 3))
        z = along - origin
        y = np.cross(z, across - origin)
        if np.linalg.norm(y) < 1e-9 * np.linalg.norm(z) * np.linalg.norm(across - origin) or not np.any(z):
            raise ReadError(f"{label}: its three points coincide or are on one line")
        z, y = z / np.linalg.norm(z), y / np.linalg.norm(y)
        if name[5] == "C":
            angle = np.deg2rad(at[1])
            at = np.array([at[0] * np.cos(angle), at[0] * np.sin(angle), at[2]])
        elif name[5] == "S":
            polar, angle = np.deg2rad(at[1:])
            at = at[0] * np.array([np.sin(polar) * np.cos(angle), np.sin(polar) * np.sin(angle), np.cos(polar)])
        return np.asarray(origin + at @ np.stack([np.cross(y, z), y, z]))


def listed(words: list[str]) -> list[tuple[int, int]]:
    """Numbers and ranges with THRU as (first, last)."""
    spans = re.sub(r" THRU +", ":", " ".join(words), flags=re.I).split()
    return [(int(first), int(last or first)) for first, _, last in (span.partition(":") for span in spans)]
