"""Nastran bulk data (.bdf, .nas, .dat): GRID, CTETRA, CHEXA, CPENTA, PLOAD4 and SET1, in small, large and free fields.

Fields after the Nastran Quick Reference Guide. A body is what has one property number; faces are the element faces that
PLOAD4 cards of one load set name, or the sets of nodes (SET1, or SET of the case control).
"""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from faying.errors import ReadError
from faying.fe.elements import SOLIDS
from faying.fe.formats.raw import RawMesh, gathered, index

# Nastran puts the nodes of the upright edges before those of the top
_ORDER = {
    20: [*range(12), *range(16, 20), *range(12, 16)],
    15: [*range(9), *range(12, 15), *range(9, 12)],
}
_COUNTS = {"CTETRA": (4, 10), "CHEXA": (8, 20), "CPENTA": (6, 15)}
_PASSED = ("CQUAD", "CTRIA", "CBAR", "CBEAM", "CROD", "CONROD", "PLOTEL")


def cards(path: Path, seen: tuple[Path, ...] = ()) -> Iterator[tuple[str, list[str], str]]:
    """Every card as (name, fields, where), its continuations joined; those of included files too."""
    if path.resolve() in seen:
        raise ReadError(f"{path} includes itself")
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError as fault:
        raise ReadError(f"cannot read {path}: {fault.strerror or fault}") from None
    bulk = not any(re.match(r"\s*BEGIN\s+BULK", line, re.I) for line in lines)
    name, fields, where = "", [""], ""
    for number, full in enumerate(lines, 1):
        line = full.partition("$")[0].rstrip().expandtabs(8)
        if not line.strip():
            continue
        if not bulk:
            bulk = bool(re.match(r"\s*BEGIN\s+BULK", line, re.I))
            continue
        if re.match(r"\s*ENDDATA", line, re.I):
            break
        found = re.match(r"\s*INCLUDE\s+['\"]?([^'\"]+)['\"]?", line, re.I)
        if found:
            yield from cards(path.parent / found.group(1).strip(), (*seen, path.resolve()))
            continue
        first, rest = _fields(line)
        if first == "" or first[0] in "+*":
            fields += rest
            continue
        if name:
            yield name, fields, where
        name, fields, where = first.rstrip("*").upper(), rest, f"{path.name}, line {number}"
    if name:
        yield name, fields, where


def _fields(line: str) -> tuple[str, list[str]]:
    """First field, and the data fields of one line: eight small ones, four large ones, or those between commas."""
    if "," in line:
        first, *rest = (word.strip() for word in line.split(","))
        limit = 4 if first.endswith("*") or first.startswith("*") else 8
        return first, rest[:limit] + [""] * (limit - len(rest))
    first = line[:8].strip()
    width = 16 if "*" in first else 8
    return first, [line[8 + k * width : 8 + (k + 1) * width].strip() for k in range(64 // width)]


def number(text: str) -> float:
    """A Nastran real: 1.5+3 and 1.5D3 are 1500."""
    text = text.upper().replace("D", "E")
    return float(re.sub(r"(?<=[\d.])([+-]\d+)$", r"E\1", text))


def read(path: Path) -> RawMesh:
    """Read a bulk data file. Raises ReadError for what it cannot read, naming line and card."""
    nodes: dict[int, tuple[float, float, float]] = {}
    solids: dict[str, list[tuple[int, list[int]]]] = {}
    bodies: dict[str, list[int]] = {}
    loads: list[tuple[str, list[str], str]] = []
    sets: dict[str, list[int]] = _case_sets(path)
    where_of: dict[int, tuple[str, list[int]]] = {}
    extra: list[int] = []
    for name, fields, where in cards(path):
        try:
            if name == "GRID":
                if fields[1] not in ("", "0"):
                    raise ReadError(
                        f"{where}: GRID {fields[0]} is given in coordinate system {fields[1]}; write the mesh in "
                        "the basic system"
                    )
                x, y, z = (number(word) if word else 0.0 for word in fields[2:5])
                nodes[int(fields[0])] = (x, y, z)
            elif name in _COUNTS:
                few, many = _COUNTS[name]
                given = [int(word) for word in fields[2 : 2 + many] if word]
                if len(given) not in (few, many):
                    raise ReadError(f"{where}: {name} {fields[0]} has {len(given)} nodes; {few} or {many} are known")
                ordered = [given[i] for i in _ORDER.get(len(given), range(len(given)))]
                kind = SOLIDS[len(given)].name
                solids.setdefault(kind, []).append((int(fields[0]), ordered))
                where_of[int(fields[0])] = (kind, ordered)
                bodies.setdefault(f"part{fields[1] or fields[0]}", []).append(int(fields[0]))
            elif name == "PLOAD4":
                loads.append((name, fields, where))
            elif name == "SET1":
                sets[f"SET{fields[0]}"] = _listed([word for word in fields[1:] if word])
            elif name.startswith(_PASSED):
                extra += [int(word) for word in fields[2:6] if word.isdigit()]
            elif name.startswith("C") and not name.startswith(("CORD", "CSET", "CONM", "CELAS", "CBUSH", "CEND")):
                raise ReadError(f"{where}: elements {name} are not known; known are {', '.join(_COUNTS)}")
        except ReadError:
            raise
        except (ValueError, IndexError) as fault:
            raise ReadError(f"{where}: {name} {fields[0]} cannot be read ({fault}); is the file whole?") from None
    if not nodes or not solids:
        raise ReadError(f"{path} holds {len(nodes)} GRID cards and {len(where_of)} solid elements; write both into it")
    return RawMesh(
        numbers=index(nodes),
        points=np.array(list(nodes.values())),
        elements=gathered(solids),
        bodies={key: index(some) for key, some in bodies.items()},
        node_sets={key: index(some) for key, some in sets.items()},
        side_sets=_loaded(loads, where_of),
        extra=index(extra),
    )


def _listed(words: list[str]) -> list[int]:
    """Numbers with THRU ranges."""
    out: list[int] = []
    k = 0
    while k < len(words):
        if words[k].upper() == "THRU":
            out += range(out[-1] + 1, int(words[k + 1]) + 1)
            k += 2
        else:
            out.append(int(words[k]))
            k += 1
    return out


def _case_sets(path: Path) -> dict[str, list[int]]:
    """SET n = ... of the case control."""
    text = path.read_text(encoding="utf-8", errors="replace") if path.is_file() else ""
    head = re.split(r"BEGIN\s+BULK", text, maxsplit=1, flags=re.I)
    if len(head) < 2:
        return {}
    found = re.finditer(r"^\s*SET\s+(\d+)\s*=\s*((?:[^,\n]+,\s*)*[^,\n]+)$", head[0], re.I | re.M)
    sets = {}
    for one in found:
        words = re.sub(r",", " ", one.group(2)).split()
        if all(word.isdigit() or word.upper() == "THRU" for word in words):
            sets[f"SET{one.group(1)}"] = _listed(words)
    return sets


def _loaded(
    loads: list[tuple[str, list[str], str]], where_of: dict[int, tuple[str, list[int]]]
) -> dict[str, np.ndarray]:
    """Element faces that PLOAD4 cards name, by load set."""
    from faying.fe.elements import KINDS

    out: dict[str, list[tuple[int, int]]] = {}
    for _, fields, where in loads:
        element = int(fields[1])
        if element not in where_of:
            continue  # a load on a shell
        kind, nodes = where_of[element]
        corners = KINDS[kind].corners
        if not fields[6]:
            raise ReadError(f"{where}: PLOAD4 on the solid {element} names no corner G1 of the face")
        first, other = int(fields[6]), int(fields[7]) if fields[7] else None
        for side, places in enumerate(KINDS[kind].sides):
            here = {nodes[i] for i in places if i < corners}
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
