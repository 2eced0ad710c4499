"""Nastran bulk data: read as meshes and DMIG matrices, and the joint written as CBUSH, CELAS2 and DMIG.

Read: GRID, CTETRA, CHEXA, CPENTA, PLOAD4 and SET1, in small, large and free fields, after the Nastran Quick Reference
Guide. A body is what has one property number; faces are the element faces that PLOAD4 cards of one load set name, or the
sets of nodes (SET1, or SET of the case control).

Written, in fields of 16 columns, after the MSC Nastran Quick Reference Guide and OptiStruct's: PBUSH (K, B, GE), CBUSH
with CID since its grids coincide, CELAS2 (K, G1, C1, G2, C2, GE), DMIG with one triangle of a symmetric matrix (form 6),
chosen in the case control by K2GG, B2GG and K42GG. MYSTRAN solves CBUSH and CELAS2 and passes DMIG over.
"""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from faying.decks.deck import JointDeck, grouped, real, springs_of
from faying.decks.raw import Matrices, RawMesh, gathered, index
from faying.errors import InputError, ReadError
from faying.fe.elements import SOLIDS
from faying.typing import Array

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


Field = int | float | str


def read_matrices(path: Path, names: tuple[str, str]) -> Matrices:
    """Read real DMIG entries: G and C of the column, then rows of G, C, value; form 6 gives one triangle."""
    from scipy.sparse import coo_array, diags_array

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
        i, j = [place[row] for row, _, _ in some], [place[column] for _, column, _ in some]
        A = coo_array(([value for *_, value in some], (i, j)), shape=(len(keys), len(keys))).tocsr()
        if heads.get(name.upper(), 6) == 6:
            A = (A + A.T - diags_array(A.diagonal())).tocsr()
        out.append(A)
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
    """Write CELAS2 elements in the basic axes; what an inclined face couples becomes springs that cancel on the diagonal.

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
