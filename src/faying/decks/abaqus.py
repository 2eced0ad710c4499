"""Abaqus (and CalculiX) input files: read as meshes, and the joint written as keywords.

Read: nodes in any system, elements, sets, surfaces, includes, parts and instances; what is not geometry is passed over.
Keywords after the Abaqus Keywords Reference Guide and the CalculiX manual.

Written: SPRING2 and DASHPOT2, connectors with structural damping, a matrix, and the law as a contact property. Keywords
after the Abaqus Keywords Reference Guide 2016 and 2017: MATRIX INPUT (entries "node, direction, node, direction,
value", one triangle), CONNECTOR DAMPING (TYPE=STRUCTURAL: a part of the elasticity), SPRING (ORIENTATION). Not run:
read back in the tests by a reader of that grammar.
"""

import re
from collections.abc import Mapping
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

from faying.decks.deck import CondensedDeck, JointDeck, comments, grouped, members, real, reals
from faying.decks.keywords import DATA, Block, blocks, interaction, orientations, springs
from faying.decks.raw import Pretension, RawMesh, index, joined, not_in_file, read_text
from faying.decks.scope import Items, NumberSpan, Scope, placed, take
from faying.decks.vocabulary import left_out
from faying.errors import ReadError
from faying.fe.elements import SOLIDS
from faying.typing import Index

STRUCTURAL = (
    "loss as a structural damping matrix, the imaginary part of the stiffness; frequency-domain steps with SIM only"
)


def read(path: Path) -> RawMesh:
    """Read an Abaqus or CalculiX input file. Raises ReadError for what it cannot read, naming line and keyword."""
    top = Scope()
    parts: dict[str, Scope] = {}
    instances: dict[str, Scope] = {}
    scope, opened = top, ""  # what END should close
    assembled = False
    last: Block | None = None
    for block in blocks(path):
        options, last = block.options, block
        if opened in ("PART", "INSTANCE") and block.keyword in ("PART", "INSTANCE", "ASSEMBLY", "END ASSEMBLY"):
            raise ReadError(f"{block.where}: *{block.keyword} comes before the *END {opened} of what began before it")
        if block.keyword == "PART":
            scope, opened = parts.setdefault(options.get("NAME", ""), Scope()), block.keyword
        elif block.keyword in ("END PART", "END INSTANCE"):
            scope, opened = top, "ASSEMBLY" if block.keyword == "END INSTANCE" else ""
        elif block.keyword == "ASSEMBLY":
            assembled, opened = True, block.keyword
        elif block.keyword == "END ASSEMBLY":
            opened = ""
        elif block.keyword == "INSTANCE" and assembled:
            name, part = options.get("NAME", ""), options.get("PART", "")
            same = next((one for one in parts if one.upper() == part.upper()), None)
            if same is None:
                raise ReadError(
                    f"{block.where}: instance {name!r} of the part {part!r}, which is not in the file; "
                    f"it has {', '.join(parts) or 'none'}"
                )
            scope, opened = placed(parts[same], block), block.keyword
            instances[name] = scope
        else:
            take(block, scope)
    if opened or (parts and not assembled):
        lost = f"*END {opened}; the file is cut short"
        none = "*ASSEMBLY; the file is cut short, or its part is the whole: then take *PART and *END PART out"
        raise ReadError(f"{path} ends without {lost if opened else none}")
    if last is not None and last.keyword in DATA and not read_text(path, "input file").endswith("\n"):
        top.notes.append(
            f"{path.name} ends in the middle of *{last.keyword} without an end of line: it may be cut short"
        )
    return replace(_merged(path, top, instances), counted=last is not None and last.keyword == "END STEP")


def _merged(path: Path, top: Scope, instances: dict[str, Scope]) -> RawMesh:
    """Put instances into one numbering; where numbers clash, those of the later ones are raised."""
    shifts: dict[str, tuple[int, int]] = {"": (0, 0)}
    own = {"": (index(top.nodes), _element_numbers(top, everything=True))}
    _as_node_sets(top)
    for name, one in instances.items():
        _as_node_sets(one)
        have = _element_numbers(top)
        raised = int(have.max(initial=0)) if np.intersect1d(_element_numbers(one), have).size else 0
        shift = 0 if set(one.nodes).isdisjoint(top.nodes) else max(top.nodes)
        shifts[name] = shift, raised
        own[name] = index(one.nodes) + shift, _element_numbers(one, everything=True) + raised
        top.nodes.update({n + shift: x for n, x in one.nodes.items()})
        for kind, rows in one.elements.items():
            top.elements.setdefault(kind, []).extend((n + raised, nodes + shift) for n, nodes in rows)
        for label, sheets in one.sheets.items():
            top.sheets.setdefault(f"{name}.{label}", []).extend(nodes + shift for nodes in sheets)
        top.extra.extend(nodes + shift for nodes in one.extra)
        top.others.extend(numbers + raised for numbers in one.others)
        top.made += [f"{name}.{label}" for label in one.made]
        top.bolts += [
            replace(bolt, surface=bolt.surface and f"{name}.{bolt.surface}", node=_within(name, bolt.node, shift))
            for bolt in one.bolts
        ]
        top.loads += one.loads
        top.unknown += one.unknown
        for kind, words in one.left_out.items():
            top.left_out.setdefault(kind, []).extend(words)
        for mine, sets in ((one.element_sets, top.element_sets), (one.node_sets, top.node_sets)):
            for label, items in mine.items():
                sets[f"{name}.{label}"] = [(name, what) for _, what in items]
        for label, some in one.surfaces.items():
            top.surfaces[f"{name}.{label}"] = [(_within(name, what, raised), side) for what, side in some]
        top.references += [_within(name, what, shift) for what in one.references]
        top.turned += [f"{name}.{label}" for label in one.turned]
        top.notes += one.notes
        top.element_sets[name] = [("", _element_numbers(one) + raised)]
    if instances:
        top.sections = list(instances)
    if not top.nodes or not top.elements:
        raise ReadError(
            f"{path} holds {len(top.nodes)} nodes and {len(top.elements)} kinds of solid elements; write nodes "
            "and elements of the model into it"
        )
    node_sets, element_sets = (
        _resolved(sets, {name: (shifts[name][k], own[name][k]) for name in shifts}, top.notes)
        for k, sets in enumerate((top.node_sets, top.element_sets))
    )
    return _raw(path, top, node_sets, element_sets, {name: raised for name, (_, raised) in shifts.items()})


def _element_numbers(scope: Scope, *, everything: bool = False) -> Index:
    """Numbers of the solids, or of all elements."""
    solids = [numbers for rows in scope.elements.values() for numbers, _ in rows]
    return joined([*solids, *(scope.others if everything else [])])


def _as_node_sets(scope: Scope) -> None:
    """Take surfaces of nodes as sets of nodes; the two have names of their own in CalculiX and Abaqus."""
    taken = {name.upper() for name in scope.node_sets}
    for name, items in scope.node_surfaces.items():
        if all(isinstance(what, str) and what.upper() == name.upper() for _, what in items):
            continue  # the set of this name
        scope.node_sets[f"{name}_SURFACE" if name.upper() in taken else name] = items


def _within(instance: str, what: str, shift: int) -> str:
    """A number or the name of a set of an instance, in the numbers and names of the whole."""
    return str(int(what) + shift) if what.isdigit() else f"{instance}.{what}"


def _numbered(what: str, shifts: Mapping[str, int]) -> int | None:
    """A node or element as Instance.number, in the numbers of the whole; None for other words."""
    instance, _, number = what.rpartition(".")
    same = next((name for name in shifts if name and name.upper() == instance.upper()), None)
    return int(number) + shifts[same] if same is not None and number.isdecimal() else None


def _resolved(
    sets: Mapping[str, Items], instances: Mapping[str, tuple[int, Index]], notes: list[str]
) -> dict[str, Index]:
    """Numbers of every set: those of instances shifted, those of sets it names filled in.

    instances: what is added to the numbers of each, and the numbers that it has then, "" for those outside.
    """
    shifts = {name: shift for name, (shift, _) in instances.items()}
    as_written = {name.upper(): name for name in instances}
    upper = {name.upper(): items for name, items in sets.items()}
    done: dict[str, Index] = {}
    everything = np.concatenate([held for _, held in instances.values()])

    written = {name.upper(): name for name in sets}

    def numbers(name: str, seen: tuple[str, ...]) -> Index:
        if name in done:
            return done[name]
        found: list[Index] = []
        for given, what in upper[name]:
            instance = as_written.get(given.upper())
            if instance is None:
                raise ReadError(f"set {written[name]!r} is of the instance {given!r}, which is not in the file")
            if isinstance(what, NumberSpan):
                there = np.intersect1d(what.numbers + shifts[instance], instances[instance][1])
                found.append(there)
                if what.numbers[-1] + shifts[instance] > instances[instance][1].max(initial=0):
                    notes.append(
                        f"the set {written[name]!r} is generated up to {what.numbers[-1]}, past the last number of the "
                        f"file; those in the file, {len(there)}, are taken"
                    )
            elif isinstance(what, str):
                label = (f"{instance}.{what}" if instance else what).upper()
                one = None if label in upper else _numbered(what, shifts)
                if one is not None:
                    found.append(index([one]))
                    continue
                if label not in upper or label in (*seen, name):
                    raise ReadError(
                        f"set {written[name]!r} names the set {what!r}, which is not in the file or is part of it"
                    )
                found.append(numbers(label, (*seen, name)))
            else:
                found.append(what + shifts[instance])
                absent = np.setdiff1d(found[-1], everything) - shifts[instance]
                notes.extend(not_in_file(f"the set {written[name]!r}", "numbers", absent.tolist()))
        done[name] = np.unique(joined(found))
        return done[name]

    return {name: numbers(name.upper(), ()) for name in sets}


def _surfaces(path: Path, top: Scope, upper: dict[str, Index], raised: Mapping[str, int]) -> dict[str, Index]:
    """Rows of (element, side) of every surface on solids; those of shells and beams are left out with a note."""
    others = joined(top.others)
    bolts = {bolt.surface.upper() for bolt in top.bolts}
    side_sets: dict[str, Index] = {}
    for name, rows in top.surfaces.items():
        if name.upper() in bolts:
            continue
        pairs: list[Index] = []
        lost = 0
        for what, side in rows:
            one = int(what) if what.isdigit() else None if what.upper() in upper else _numbered(what, raised)
            numbers = upper.get(what.upper()) if one is None else index([one])
            if numbers is None:
                raise ReadError(f"surface {name!r} names the element set {what!r}, which is not in {path.name}")
            if not len(numbers) or np.isin(numbers, others).all():
                lost += 1
                continue
            numbers = numbers[~np.isin(numbers, others)]
            if side and not re.fullmatch(r"S[1-6]", side):
                raise ReadError(f"surface {name!r} has the side {side!r}; the sides of solids are S1 to S6")
            pairs.append(np.column_stack([numbers, np.full(len(numbers), int(side[1:]) - 1 if side else -1)]))
        if lost:
            top.notes.append(
                f"the surface {name!r} lies on elements that are not solids in {lost} lines, which are left out"
            )
        if pairs or not lost:
            side_sets[name] = np.concatenate(pairs or [np.zeros((0, 2), dtype=np.int64)])
    return side_sets


def _raw(
    path: Path, top: Scope, node_sets: dict[str, Index], element_sets: dict[str, Index], raised: Mapping[str, int]
) -> RawMesh:
    upper = {name.upper(): numbers for name, numbers in element_sets.items()}
    nodes = {name.upper(): numbers for name, numbers in node_sets.items()}
    side_sets = _surfaces(path, top, upper, raised)
    helpers = {what.upper() for rows in top.surfaces.values() for what, _ in rows} - {n.upper() for n in top.made}
    notes = [*top.notes, *left_out(top.left_out)]
    if top.unknown:
        notes.append(f"{', '.join(f'*{word}' for word in dict.fromkeys(top.unknown))}: not known, and passed over")
    return RawMesh(
        numbers=index(top.nodes),
        points=np.array(list(top.nodes.values())),
        elements={
            kind: (np.concatenate([n for n, _ in rows]), np.concatenate([c for _, c in rows]))
            for kind, rows in top.elements.items()
        },
        bodies={name: upper[name.upper()] for name in dict.fromkeys(top.sections) if len(upper.get(name.upper(), ()))},
        element_sets={name: some for name, some in element_sets.items() if len(some) and name.upper() not in helpers},
        node_sets=node_sets,
        side_sets=side_sets,
        face_elements={name: tuple(rows) for name, rows in top.sheets.items()},
        extra=joined(top.extra),
        turned=joined(nodes.get(name.upper(), index([])) for name in top.turned),
        references=np.unique(joined(_named(what, nodes) for what in top.references)),
        notes=tuple(notes),
        pretensions=_pretensions(top, (nodes, upper), raised),
    )


def _pretensions(
    top: Scope, sets: tuple[dict[str, Index], dict[str, Index]], raised: Mapping[str, int]
) -> tuple[Pretension, ...]:
    """The pre-tension sections with surfaces on solids, with their nodes and forces; sets: of nodes, of elements."""
    nodes, elements = sets
    surfaces = {name.upper(): rows for name, rows in top.surfaces.items()}
    found = []
    for bolt in top.bolts:
        section: list[Index] = []
        for what, side in surfaces.get(bolt.surface.upper(), []):
            one = _numbered(what, raised)
            chosen = index([one]) if one is not None else _named(what, elements)
            for numbers, corners in (row for rows in top.elements.values() for row in rows):
                sides = SOLIDS[corners.shape[1]].sides
                if re.fullmatch(r"S[1-6]", side) and int(side[1:]) <= len(sides):
                    section.append(corners[np.isin(numbers, chosen)][:, sides[int(side[1:]) - 1]].ravel())
        pulled = _named(bolt.node, nodes)
        forces = [force for what, force in top.loads if len(pulled) and np.array_equal(_named(what, nodes), pulled)]
        found.append(
            Pretension(
                text=bolt.text, nodes=np.unique(joined(section)), axis=bolt.axis, force=forces[-1] if forces else None
            )
        )
    return tuple(found)


def _named(what: str, sets: Mapping[str, Index]) -> Index:
    """The number that a word is, or those of the set that it names; none where there is no such set."""
    return index([what]) if what.isdigit() else sets.get(what.upper(), index([]))


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
    return springs(deck, deck.damping_note(), deck.dampers)


def connector(deck: JointDeck) -> str:
    """Write CONN3D2 elements of type CARTESIAN: component 1 is the normal; loss factors as structural damping."""
    k, lost = deck.own()
    ratio = np.divide(lost, k, out=np.zeros_like(k), where=k != 0)
    axes, group = orientations(deck)
    lines = [*deck.header("**", "loss factors as structural damping of each component"), *axes]
    one, two = deck.ends
    first, alike = grouped(np.column_stack([group, k / np.abs(k).max(), ratio]))
    number = count(deck.first_element)
    for g, (leader, some) in enumerate(zip(first, members(alike), strict=True)):
        lines.append(f"*ELEMENT,TYPE=CONN3D2,ELSET=JN{g}")
        lines += [f"{next(number)},{one[i]},{two[i]}" for i in some]
        lines += [f"*CONNECTOR SECTION,ELSET=JN{g},BEHAVIOR=JB{g}", "CARTESIAN,", f"JKA{group[leader]},"]
        lines.append(f"*CONNECTOR BEHAVIOR,NAME=JB{g}")
        for c in range(3):
            lines += [f"*CONNECTOR ELASTICITY,COMPONENT={c + 1}", f"{real(k[leader, c], 20)},"]
            if ratio[leader, c]:
                lines += [f"*CONNECTOR DAMPING,COMPONENT={c + 1},TYPE=STRUCTURAL", f"{real(ratio[leader, c], 20)},"]
    return "\n".join(lines) + "\n"


def matrix(deck: JointDeck) -> str:
    """Write the joint as sparse matrices: stiffness, and structural damping."""
    blocks = [("STIFFNESS", "KJ", deck.stiffness)]
    if np.any(deck.loss):
        blocks.append(("STRUCTURAL DAMPING", "SJ", deck.loss))
    lines = _assembled(deck.entries, [(kind, name, deck.pairs.matrix(values)) for kind, name, values in blocks])
    return "\n".join([*deck.header("**", STRUCTURAL), *lines]) + "\n"


def _assembled(entries: Index, matrices: list[tuple[str, str, Any]]) -> list[str]:
    """Matrices as (kind, name, values), and the line that adds them to the model; entries: node and direction."""
    from scipy.sparse import triu

    lines = []
    for _, name, values in matrices:
        upper = triu(values).tocoo()
        lines.append(f"*MATRIX INPUT,NAME={name},TYPE=SYMMETRIC")
        lines += [
            f"{entries[i, 0]},{entries[i, 1]},{entries[j, 0]},{entries[j, 1]},{real(float(value), 23)}"
            for i, j, value in zip(upper.row, upper.col, upper.data, strict=True)
            if value
        ]
    return [*lines, "*MATRIX ASSEMBLE," + ",".join(f"{kind}={name}" for kind, name, _ in matrices)]


def contact(deck: JointDeck) -> str:
    """Write a surface interaction with the law as pressure-overclosure table, and the contact pair."""
    rows, law = interaction(deck)
    slip = law.friction * law.mean_pressure / law.k_t * deck.system.metre
    lines = deck.header(
        "**",
        "contact in place of springs: needs a step with the bolts before *FREQUENCY",
        f"elastic slip: sticks with k_t at the mean pressure; {law.friction_note}",
    )
    lines += [*rows, f"*FRICTION,ELASTIC SLIP={real(slip, 20)}", f"{real(law.friction, 20)},"]
    if deck.frequency is not None and law.loss_n:
        c = law.loss_n * law.k_n / (2 * np.pi * deck.frequency) * deck.system.density
        lines += ["*CONTACT DAMPING,DEFINITION=DAMPING COEFFICIENT", f"{real(c, 20)},"]
    lines += ["*CONTACT PAIR,INTERACTION=JK,TYPE=SURFACE TO SURFACE", ",".join(deck.faces)]
    return "\n".join(lines) + "\n"


def condensed(deck: CondensedDeck) -> dict[str, str]:
    """Points and matrices between them, to include in an input deck before its first step, by name.

    A mode is direction 1 of a node of its own.
    """
    matrices = [("STIFFNESS", "KJ", deck.in_units(deck.stiffness))]
    if deck.mass is not None:
        matrices.append(("MASS", "MJ", deck.in_units(deck.mass)))
    if np.any(deck.loss):
        matrices.append(("STRUCTURAL DAMPING", "SJ", deck.in_units(deck.loss)))
    lines = [*comments("**", *deck.facts, *([STRUCTURAL] if np.any(deck.loss) else [])), "*NODE"]
    lines += [f"{node},{reals(at)}" for node, at in zip(deck.nodes, deck.places, strict=True)]
    lines += [f"{number},{reals(deck.places[0])}" for number in deck.modes]
    return {f"{deck.name}_matrix.inp": "\n".join([*lines, *_assembled(np.maximum(deck.entries, 1), matrices)]) + "\n"}
