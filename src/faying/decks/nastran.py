"""Nastran bulk data: read as meshes and DMIG matrices, and the joint written as CBUSH, CELAS2 and DMIG.

Read: GRID in any system, CTETRA, CHEXA, CPENTA, skins of CTRIA and CQUAD, PLOAD4 and SET1, in small, large and free
fields, after the Nastran Quick Reference Guide. A body is what has one property number; faces are skins of one
property, the element faces that PLOAD4 cards of one load set name, or sets of nodes (SET1, or SET of the case control).

Written, in fields of 16 columns, after the MSC Nastran Quick Reference Guide and OptiStruct's: PBUSH (K, B, GE), CBUSH
with CID since its grids coincide, CELAS2 (K, G1, C1, G2, C2, GE), DMIG with one triangle of a symmetric matrix (form
6), chosen in the case control by K2GG, B2GG and K42GG. MYSTRAN solves CBUSH and CELAS2 and passes DMIG over.
"""

import re
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

from faying.decks import raw
from faying.decks.bulk import Bulk, cards, listed, number
from faying.decks.deck import CondensedDeck, JointDeck, comments, grouped, real, springs_of
from faying.decks.vocabulary import left_out
from faying.errors import InputError, ReadError
from faying.fe.elements import KINDS
from faying.fe.solids import least_jacobian
from faying.typing import Array, Index

# commands of the case control whose sets are of elements
OF_ELEMENTS = (
    *("STRE", "ELST", "STRA", "FORCE", "ELFO", "ESE", "EKE", "EDE", "GPSTRESS", "STRFIELD", "VOLUME", "SURFACE"),
    *("ELSDCON", "GPSTRAIN", "THERMALSTR", "FLUX", "NLSTRESS", "CRSHRF", "EPLAS", "BOUTPUT"),
)
Field = int | float | str


def read(path: Path) -> raw.RawMesh:
    """Read a bulk data file. Raises ReadError for what it cannot read, naming line and card."""
    case, notes = _case_sets(path)
    bulk = Bulk()
    for name, fields, where in cards(path):
        with raw.understood(f"{where}: {name} {fields[0]} cannot be read"):
            bulk.take(name, fields, where)
    if not bulk.grids or not bulk.solids:
        raise ReadError(
            f"{path} holds {len(bulk.grids)} GRID cards and {len(bulk.solid)} solid elements; write both into it"
        )
    notes += [
        f"{count} cards {name} are left out, with their stiffness and mass" for name, count in bulk.left_out.items()
    ]
    notes += left_out(bulk.constraints, "")
    numbers, points = raw.index(bulk.grids), np.array([bulk.place(grid) for grid in bulk.grids])
    notes += _turned(bulk, numbers, points)
    for name, some in case.items():
        single = raw.index(first for first, last in some if first == last)
        if len(np.setdiff1d(single, numbers)):
            notes.append(f"{name} of the case control has something that is not a grid; it is left out")
        else:
            bulk.sets.setdefault(name, some)
    if not bulk.ended:
        text = raw.read_text(path, "bulk data")
        if re.search(r"^[ \t]*+BEGIN\s+BULK", text, re.I | re.M):
            raise ReadError(f"{path} ends without ENDDATA; the file is cut short")
        notes.append(f"{path.name} has no ENDDATA: it may be cut short")
    loaded = (fields[1] for fields, _ in bulk.loads if fields[6].upper() != "THRU" and fields[1].isdigit())
    notes += raw.not_in_file("PLOAD4", "elements", map(int, loaded), bulk.solid.keys() | bulk.others)
    return raw.RawMesh(
        numbers=numbers,
        points=points,
        elements=raw.gathered(bulk.solids),
        bodies={key: raw.index(some) for key, some in bulk.bodies.items()},
        node_sets={name: _within(some, numbers) for name, some in bulk.sets.items()},
        side_sets=_loaded(bulk.loads, bulk.solid),
        face_elements={name: raw.face_blocks(some) for name, some in bulk.skins.items()},
        extra=raw.index(node for some in bulk.skins.values() for nodes in some for node in nodes),
        references=raw.index(bulk.references),
        turned=raw.index(n for n, (_, _, cd) in bulk.grids.items() if (bulk.default[1] if cd is None else cd) != 0),
        notes=tuple(notes),
    )


def _turned(bulk: Bulk, numbers: Index, points: Array) -> list[str]:
    """Turn the solids whose nodes run in the other sense, which Nastran takes as well; say how many."""
    count, order = 0, np.argsort(numbers)
    for kind, some in bulk.solids.items():
        given, mirrored = np.array([nodes for _, nodes in some]), list(KINDS[kind].mirrored)
        cells = order[np.minimum(np.searchsorted(numbers[order], given), len(numbers) - 1)]
        wrong = np.flatnonzero((numbers[cells] == given).all(axis=1) & (least_jacobian(points, cells) <= 0))
        for k in wrong[least_jacobian(points, cells[wrong][:, mirrored]) > 0]:
            some[k][1][:] = given[k, mirrored].tolist()
            count += 1
    return [f"{count} solids are numbered in the other sense; they are turned, as Nastran does"] if count else []


def _within(ranges: list[tuple[int, int]], numbers: Index) -> Index:
    """Numbers of a set: those given one by one, and those of a range that there are."""
    ranked = np.sort(numbers)
    found = [
        raw.index([first]) if first == last else ranked[slice(*np.searchsorted(ranked, [first, last + 1]))]
        for first, last in ranges
    ]
    return np.unique(raw.joined(found))


def _case_sets(path: Path) -> tuple[dict[str, list[tuple[int, int]]], list[str]]:
    """SET n = ... of the case control that no command takes as elements, and notes on those that one does."""
    head = re.split(r"BEGIN\s+BULK", raw.read_text(path, "bulk data"), maxsplit=1, flags=re.I)
    if len(head) < 2:
        return {}, []
    used = re.finditer(r"^[ \t]*+([A-Z0-9]+)\s*+(?:\([^)]*\))?\s*=\s*(\d+)\s*(?:\$.*)?$", head[0], re.I | re.M)
    by_elements = {f"SET{one[2]}": one[1].upper() for one in used if one[1].upper().startswith(OF_ELEMENTS)}
    found = re.finditer(r"^[ \t]*+SET\s+(\d+)\s*=\s*((?:[^,\n]+,\s*+)*+[^,\n]+)$", head[0], re.I | re.M)
    sets = {}
    for one in found:
        words = re.sub(r",", " ", one.group(2)).split()
        if words[0].isdigit() and words[-1].isdigit() and all(w.isdigit() or w.upper() == "THRU" for w in words):
            sets[f"SET{one.group(1)}"] = listed(words)
    notes = [
        f"{name} of the case control holds elements, as {command} = {name[3:]} says, and is left out"
        for name, command in by_elements.items()
        if sets.pop(name, None) is not None
    ]
    return sets, notes


def _loaded(loads: list[tuple[list[str], str]], where_of: dict[int, tuple[str, list[int]]]) -> dict[str, Index]:
    """Element faces that PLOAD4 cards name, by load set."""
    out: dict[str, list[tuple[int, int]]] = {}
    for fields, where in loads:
        if fields[6].upper() == "THRU" and fields[1].isdigit() and fields[7].isdigit():
            solid = next((e for e in where_of if int(fields[1]) <= e <= int(fields[7])), None)
            if solid is None:
                continue  # a load on shells
            raise ReadError(
                f"{where}: PLOAD4 with THRU, which is for shells, names the solid {solid}; write a card with G1 for it"
            )
        if not all(word.isdigit() for word in (*fields[:2], *filter(None, fields[6:8]))):
            given = ", ".join((*fields[:2], *fields[6:8]))
            raise ReadError(f"{where}: PLOAD4 names {given}, which are not numbers of a load set, an element and nodes")
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
                f"{where}: PLOAD4 names the nodes {first} and {other}, which are on no common face of element {element}"
            )
    return {name: np.array(rows) for name, rows in out.items()}


def read_matrices(path: Path, names: tuple[str, str]) -> raw.Matrices:
    """Read real DMIG entries: G and C of the column, then rows of G, C, value; form 6 gives one triangle."""
    from scipy.sparse import coo_array

    if not raw.read_text(path, "bulk data").endswith("\n"):
        raise ReadError(f"{path} ends in the middle of a line; it is cut short")
    heads: dict[str, int] = {}
    entries: dict[str, list[tuple[tuple[int, int], tuple[int, int], float]]] = {}
    for card, fields, where in cards(path):
        if card != "DMIG":
            continue
        name = fields[0].upper()
        with raw.understood(f"{where}: DMIG {name} cannot be read"):
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
    for name in names:
        if name.upper() not in entries:
            raise ReadError(f"{path} has no DMIG {name}; it has {', '.join(sorted(entries)) or 'none'}")
    found = [entries[name.upper()] for name in names]
    keys = sorted({key for some in found for row, column, _ in some for key in (row, column)})
    place = {key: i for i, key in enumerate(keys)}
    out = []
    for name, some in zip(names, found, strict=True):
        i, j = raw.index(place[row] for row, _, _ in some), raw.index(place[column] for _, column, _ in some)
        one = heads.get(name.upper(), 6) == 6
        raw.once(f"{path.name}, DMIG {name}", np.minimum(i, j) if one else i, np.maximum(i, j) if one else j, len(keys))
        A = coo_array(([value for *_, value in some], (i, j)), shape=(len(keys), len(keys))).tocsr()
        out.append(raw.both_triangles(A) if one else A)
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
    k, lost = deck.own()
    ratio = np.divide(lost, k, out=np.zeros_like(k), where=k != 0)
    lines = deck.header("$", "GE of directions 1, 2, 3; a solver that reads one GE takes that of the normal")
    axes, frame = grouped(deck.axes)
    number = deck.first_element
    for g, leader in enumerate(axes):
        n, _, t2 = (tuple(float(x) for x in row) for row in deck.axes[leader])
        lines += card("CORD2R", number + g, 0, 0.0, 0.0, 0.0, *t2, *n)
    size = np.abs(k).max()
    first, alike = grouped(np.column_stack([k / size, ratio]))
    for g, leader in enumerate(first):
        words: list[Field] = [number + g, "K", *map(float, k[leader]), "", "", ""]
        if ratio[leader].any():
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
    lines = deck.header("$", "loss factors in GE; springs in the basic axes: leave CD of the grids blank")
    number, grids = count(deck.first_element), deck.ends
    lost = springs_of(deck.loss, deck.stiffness)
    for (a, c, b, d, values), (*_, loss) in zip(springs_of(deck.stiffness), lost, strict=True):
        for i in np.flatnonzero((values != 0) | (loss != 0)):
            if values[i] == 0:
                raise InputError("a spring with loss but no stiffness has no loss factor; take matrix or dmig")
            factor = float(loss[i] / values[i])
            ends = int(grids[a][i]), c + 1, int(grids[b][i]), d + 1
            lines += card("CELAS2", next(number), float(values[i]), *ends, *([factor] if factor else []))
    return "\n".join(lines) + "\n"


def dmig(deck: JointDeck) -> str:
    """Write the joint as DMIG matrices KJOINT and, for the loss, K4JOINT."""
    chosen = ["case control: K2GG = KJOINT"]
    bulk = _dmig("KJOINT", deck.entries, deck.pairs.matrix(deck.stiffness))
    if np.any(deck.loss):
        chosen.append("case control: K42GG = K4JOINT, the loss as a structural damping matrix")
        bulk += _dmig("K4JOINT", deck.entries, deck.pairs.matrix(deck.loss))
    return "\n".join([*deck.header("$", *chosen), *bulk]) + "\n"


def _dmig(name: str, entries: Index, matrix: Any) -> list[str]:
    """The lower triangle of a matrix, column by column; entries: node and direction of each row."""
    from scipy.sparse import tril

    lower = tril(matrix).tocsc()
    lines = card("DMIG", name, 0, 6, 2, 0)
    for j in np.flatnonzero(np.diff(lower.indptr)):
        here = slice(lower.indptr[j], lower.indptr[j + 1])
        words: list[Field] = [name, *entries[j].tolist(), ""]
        for i, v in zip(lower.indices[here], lower.data[here], strict=True):
            if v:
                words += [*entries[i].tolist(), float(v), ""]
        if len(words) > 4:
            lines += card("DMIG", *words)
    return lines


COUPLED = 1e-2  # of the mean of two diagonals: a coupling above it a CBUSH cannot leave out


def condensed(deck: CondensedDeck) -> dict[str, str]:
    """Bulk data of matrices, by name: DMIG; of a joint also a CBUSH where both points coincide and little couples."""
    grids: list[str] = []
    for node, at in zip(deck.nodes, deck.places, strict=True):
        grids += card("GRID", node, 0, *map(float, at), 0)
    scalar = [line for number in deck.modes for line in card("SPOINT", number)]
    matrices = {"K2GG": ("KJOINT", deck.stiffness), "K42GG": ("K4JOINT", deck.loss)}
    if deck.mass is not None:
        matrices = {"K2GG": ("KAAX", deck.stiffness), "M2GG": ("MAAX", deck.mass), "K42GG": ("K4AAX", deck.loss)}
    chosen, lines = [], []
    for command, (name, matrix) in matrices.items():
        if np.any(matrix):
            more = ", the loss as a structural damping matrix" if command == "K42GG" else ""
            chosen.append(f"case control: {command} = {name}{more}")
            lines += _dmig(name, deck.entries, deck.in_units(matrix))
    head = [*comments("$", *deck.facts, *chosen), *grids, *scalar]
    out = {f"{deck.name}_dmig.bdf": "\n".join([*head, *lines]) + "\n"}
    bush = None if deck.mass is not None else _bush(deck)
    if bush:
        note, cards = bush
        out["condensed_cbush.bdf"] = "\n".join([*comments("$", *deck.facts, note), *grids, *cards]) + "\n"
    return out


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
