"""A study proposed from CAD facts: joints where parts touch, bolts where holes line up, a size of mesh."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from faying.errors import InputError
from faying.geometry.face_facts import GeometryFacts, PartFacts, TouchingFaces, part_distance, read_facts
from faying.geometry.selectors import TOUCHING, Selector
from faying.memory import available
from faying.setup.bolt_proposal import BoltProposal, rounded
from faying.setup.expected import memory_of_run, unknowns_of
from faying.setup.face_names import FaceNames
from faying.setup.fasteners import DowelProposal, find_fasteners, quoted
from faying.setup.found_bolts import found_bolts, found_dowels, free_rows
from faying.units import show

ROOM = 0.7  # of the free memory that a proposed run takes, whose unknowns are an estimate
ACROSS = 2  # elements across the thinnest part
MAX_UNKNOWNS = 300_000  # unknowns beyond which the mesh is proposed coarser
MIN_AREA_SHARE = 1e-3  # share of a face's area from which a contact counts


@dataclass(frozen=True, kw_only=True)
class JointProposal:
    """Two faces that meet: their names in the study, the gap between them [m] and the area [m2]."""

    name: str
    faces: tuple[str, str]
    gap: float
    area: float


@dataclass(frozen=True, kw_only=True)
class Proposal:
    """What a study of a geometry may be.

    Args:
        facts: of the geometry.
        faces: name -> selector, of faces that the file does not name.
        joints, bolts, dowels: what was found.
        size: largest element [m].
        snap: gap up to which faces count as touching [m]; 0 where all touch.
        left_out: parts of the file that the mesh leaves out; `facts` does not hold them.
        remarks: what was assumed, and what was left out.
        unit: length unit of a mesh file; "" for a STEP file, which is meshed.
        sets: parts of a mesh file that are several of its sets.
        counted: unknowns of a mesh file.
        unite: bodies of the file that are one part each: bolts that are meshed, with their nuts.
    """

    facts: GeometryFacts
    faces: dict[str, Selector]
    joints: tuple[JointProposal, ...]
    bolts: tuple[BoltProposal, ...]
    size: float
    snap: float
    left_out: tuple[str, ...]
    remarks: tuple[str, ...]
    unit: str = ""
    sets: dict[str, str] = field(default_factory=dict)
    counted: int = 0
    dowels: tuple[DowelProposal, ...] = ()
    unite: tuple[tuple[str, ...], ...] = ()

    @property
    def alone(self) -> bool:
        """Whether it is one part, which has no joint."""
        return len(self.facts.parts) == 1

    @property
    def unknowns(self) -> int:
        """Unknowns of the mesh file, or of the mesh as counted on other structures."""
        return self.counted or unknowns_of(self.facts, self.size)


def propose(facts: GeometryFacts, path: Path, *, mesh_bolts: bool = False) -> Proposal:
    """Propose joints, bolts and a mesh for a geometry.

    Args:
        facts: what `read_facts` says of it.
        path: the STEP file, to measure how far parts lie apart.
        mesh_bolts: whether bolts that are drawn with their nuts are meshed; else beams stand for them.

    Raises:
        InputError: several parts, of which none touch.
    """
    if len(facts.parts) == 1:
        size, words = mesh_size(facts, set())
        return Proposal(facts=facts, faces={}, joints=(), bolts=(), size=size, snap=0.0, left_out=(), remarks=(words,))
    fasteners = find_fasteners(facts, touching(facts))
    unite = fasteners.solid if mesh_bolts else ()
    if unite:
        facts = read_facts(path, unite=unite)
        fasteners = find_fasteners(facts, touching(facts))
    facts = facts.without(fasteners.left_out)
    alone = _alone(facts, path, fasteners.left_out)
    facts = facts.without(alone)
    contacts = touching(facts)
    free = free_rows(facts, fasteners)
    bolts, left = found_bolts(facts, fasteners, free, contacts)
    contacts, unpressed = _pressed(facts, contacts, bolts)
    snap, remarks = snapped(facts, contacts)
    names = FaceNames(facts, snap)
    joints = named_joints(facts, contacts, names)
    remarks += fasteners.remarks
    if alone:
        remarks.append(f"{quoted(alone)}: no flat face touches another part; left out of the mesh (geometry.leave_out)")
    remarks += [*unpressed, *left]
    if not bolts:
        remarks.append("no bolt was found: fill in [[bolt]] by hand before you run the study")
    size, words = mesh_size(facts, {*(bolt.part for bolt in bolts), *fasteners.washers})
    remarks.append(words)
    named_bolts = tuple(
        replace(
            bolt,
            name=f"bolt {k}",
            faces=(names.of_several(bolt.head, bolt.words[0]), names.of_several(bolt.end, bolt.words[1])),
        )
        for k, bolt in enumerate(bolts, 1)
    )
    return Proposal(
        facts=facts,
        faces=names.selectors,
        joints=joints,
        bolts=named_bolts,
        dowels=found_dowels(facts, fasteners, free, names),
        size=size,
        snap=snap,
        left_out=(*fasteners.left_out, *alone),
        remarks=tuple(remarks),
        unite=unite,
    )


def named_joints(
    facts: GeometryFacts, contacts: Sequence[TouchingFaces], names: FaceNames
) -> tuple[JointProposal, ...]:
    """The joints of planes that touch, with names of their faces."""
    joints = []
    for k, contact in enumerate(contacts, 1):
        word = "joint" if len(contacts) == 1 else f"joint {k}"
        pair = [facts.face(*side) for side in contact.sides]
        faces = [names.of(one, word, other.part) for one, other in zip(pair, reversed(pair), strict=True)]
        joints.append(JointProposal(name=word, faces=(faces[0], faces[1]), gap=contact.gap, area=contact.area))
    return tuple(joints)


def snapped(facts: GeometryFacts, contacts: Sequence[TouchingFaces]) -> tuple[float, list[str]]:
    """The gap [m] up to which faces count as touching, 0 where all touch; and what there is to say of it."""
    widest = max((abs(contact.gap) for contact in contacts), default=0.0)
    if widest <= TOUCHING * facts.size:
        return 0.0, []
    words = f"faces up to {show(widest, 'm')} apart are taken for touching (geometry.snap)"
    return rounded(1.01 * widest, 2, up=True), [words]


def touching(facts: GeometryFacts) -> list[TouchingFaces]:
    """Planes that touch; where two parts touch nowhere, those that nearly do."""
    close = TOUCHING * facts.size
    plane = [
        one
        for one in facts.contacts
        if facts.face(*one.first).kind == "plane"
        and one.area >= MIN_AREA_SHARE * min(facts.face(*side).area for side in one.sides)
    ]
    touching = [one for one in plane if abs(one.gap) <= close]
    met = {frozenset(one.parts) for one in touching}
    near = [one for one in plane if frozenset(one.parts) not in met and one.gap > 0]
    least: dict[frozenset[str], float] = {}
    for one in sorted(near, key=lambda one: one.gap):
        least.setdefault(frozenset(one.parts), one.gap)
    return [*touching, *(one for one in near if one.gap <= least[frozenset(one.parts)] + close)]


def _pressed(
    facts: GeometryFacts, contacts: Sequence[TouchingFaces], bolts: Sequence[BoltProposal]
) -> tuple[list[TouchingFaces], list[str]]:
    """The faces that are joints; and what there is to say of those that no bolt presses.

    These only nearly touch, of parts that no bolt clamps together and that other parts touch, or touch along the bolts
    of their two parts, as the shoulder of a stepped lap.
    """
    close = TOUCHING * facts.size
    touched = {part for one in contacts if abs(one.gap) <= close for part in one.parts}
    apart, aside = [], []
    for contact in contacts:
        axes = [bolt.axis for bolt in bolts if {*contact.parts} <= {*bolt.parts}]
        if not axes and abs(contact.gap) > close and touched.issuperset(contact.parts):
            apart.append(contact)
        elif axes and max(abs(facts.face(*contact.first).facing(axis)) for axis in axes) < 0.5:
            aside.append(contact)
    remarks = []
    if apart:
        gap = show(max(contact.gap for contact in apart), "m")
        text = f"{len(apart)} pairs of faces up to {gap} apart, which no bolt closes, are not joints: left out; add a "
        remarks.append(text + "[[joint]] if they do meet")
    if aside:
        between = "; ".join(quoted(pair) for pair in dict.fromkeys(contact.parts for contact in aside))
        text = f"{len(aside)} pairs of faces that touch along the bolts of {between} (shoulders, registers) are not"
        remarks.append(text + " joints, since no bolt presses them: left out; add a [[joint]] if they do carry load")
    return [contact for contact in contacts if contact not in aside and contact not in apart], remarks


def _alone(facts: GeometryFacts, path: Path, fasteners: Sequence[str]) -> tuple[str, ...]:
    """Parts of which no flat face touches another part. Raises InputError where that holds for all."""
    contacts = touching(facts)
    if not contacts:
        apart = None if fasteners else part_distance(path)
        why = f" beside {quoted(fasteners)}, taken for bolts, nuts, washers, dowels; faying init begins a study by hand"
        if apart is not None:
            why = f"; the nearest parts are {apart[0]!r} and {apart[1]!r}, {show(apart[2], 'm')} apart. Move them "
            why += "together in the CAD program, or check what `faying faces` lists"
        raise InputError(f"{facts.file}: no flat faces of two parts touch{why}")
    joined = {part for contact in contacts for part in contact.parts}
    return tuple(part.name for part in facts.parts if part.name not in joined)


def mesh_size(facts: GeometryFacts, bolts: set[str | None]) -> tuple[float, str]:
    """Largest element [m], and why: two across the thinnest part, more where memory or time would not do.

    bolts: parts that do not count: bolts and washers.
    """
    plates = [part for part in facts.parts if part.name not in bolts] or list(facts.parts)
    thin = min(plates, key=_thickness)
    size = rounded(_thickness(thin) / ACROSS, 2)
    why = f"{ACROSS} elements across {thin.name!r}, which is about {show(_thickness(thin), 'm', digits=3)} thick"
    free, widest = available(), max(_thickness(part) for part in plates)

    def fits(unknowns: int) -> bool:
        return unknowns <= MAX_UNKNOWNS and (free is None or memory_of_run(unknowns) <= ROOM * free)

    tried = [(unknowns_of(facts, size), size)]
    while not fits(tried[-1][0]) and tried[-1][1] < widest:
        larger = min(rounded(1.1 * tried[-1][1], 2), widest)
        tried.append((unknowns_of(facts, larger), larger))
    # the estimate for small holes may rise with the size
    unknowns, found = tried[-1] if fits(tried[-1][0]) else min(tried, key=lambda one: (one[0], -one[1]))
    if found > size:
        why = "coarser than two elements across the thinnest part, for memory and time; try a finer one, too"
    if free is not None and memory_of_run(unknowns) > ROOM * free:
        why = (
            f"about {unknowns:,} unknowns at any size, more than fits into memory; small holes and curved faces ask "
            "for them: leave them out of the geometry"
        )
    return found, f"mesh of {show(found, 'm')}: {why}"


def _thickness(part: PartFacts) -> float:
    """The least side of the box around a part, or twice volume over area where it is much less than a plate's."""
    low, high = np.array(part.low), np.array(part.high)
    least, mean = float((high - low).min()), part.thickness
    return least if mean > least / 2 else mean
