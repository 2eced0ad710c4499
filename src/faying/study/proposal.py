"""A study proposed from CAD facts: joints where parts touch, bolts where holes line up, a size of mesh."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from math import floor, log10
from pathlib import Path

import numpy as np

from faying.errors import InputError
from faying.fe.bores import Bore, Stack, bores, room_around, seat, stacks
from faying.fe.face_facts import Contact, FaceFacts, GeometryFacts, PartFacts, part_distance
from faying.fe.memory import guessed
from faying.fe.selectors import AXES, TOUCHING, Selector, chosen
from faying.joint.threads import CLEARANCE_HOLES, HEADS, WASHERS, Fastener, Thread, is_tapped, size_for_hole
from faying.memory import available
from faying.study.expected import unknowns_of
from faying.units import show

GRADE, SHARE = "8.8", 0.7  # of the bolts, and the share of the proof load that they are tightened to
ACROSS = 2  # elements across the thinnest part
MOST = 300_000  # unknowns beyond which the mesh is proposed coarser
CHORDS = 1.02  # by so much a round edge is wider than its chords
WIDEST = 1.1e-3 * CLEARANCE_HOLES[max(CLEARANCE_HOLES)][2]  # m: wider holes are for no bolt that is known here
LEAST = 1e-3  # share of a face's area from which a contact counts


@dataclass(frozen=True, kw_only=True)
class JointProposal:
    """Two faces that meet: their names in the study, the gap between them [m] and the area [m2]."""

    name: str
    faces: tuple[str, str]
    gap: float
    area: float


@dataclass(frozen=True, kw_only=True)
class BoltProposal:
    """A bolt through a row of holes, or a part that is a bolt.

    Args:
        name: what tables call it.
        faces: names of the seats; of a meshed bolt, of its faces under head and nut.
        size: nominal diameter [mm]; None where it is not known.
        at: point on the axis [m]; None where a tapped hole says it.
        ring: inner and outer diameter of the seat [m].
        part: the part that it is, if it is one.
        remark: where size and ring come from.
    """

    name: str
    faces: tuple[str, str]
    size: int | None = None
    at: tuple[float, float, float] | None = None
    ring: tuple[float, float] | None = None
    part: str | None = None
    remark: str = ""

    @property
    def preload(self) -> float | None:
        """70 % of the proof load of class 8.8 [N], three digits; None where the size is not known."""
        if self.size is None:
            return None
        force = SHARE * Fastener(thread=Thread.coarse(self.size * 1e-3), grade=GRADE).proof_load
        return rounded(force, 3)


@dataclass(frozen=True, kw_only=True)
class Proposal:
    """What a study of a geometry may be.

    Args:
        facts: of the geometry.
        faces: name -> selector, of faces that the file does not name.
        joints, bolts: what was found.
        size: largest element [m].
        snap: gap up to which faces count as touching [m]; 0 where all touch.
        remarks: what was assumed, and what was left out.
    """

    facts: GeometryFacts
    faces: dict[str, Selector]
    joints: tuple[JointProposal, ...]
    bolts: tuple[BoltProposal, ...]
    size: float
    snap: float
    remarks: tuple[str, ...]

    @property
    def unknowns(self) -> int:
        """Unknowns of the mesh, as counted on other structures."""
        return unknowns_of(self.facts, self.size)


@dataclass
class _Names:
    """Names of faces: that of the file, or one that is made up, with the selector that finds the face."""

    facts: GeometryFacts
    snap: float
    selectors: dict[str, Selector] = field(default_factory=dict)
    given: dict[tuple[str, int], str] = field(default_factory=dict)

    def of(self, face: FaceFacts, word: str, touching: str | None = None) -> str:
        """The name of a face; word: what it is for; touching: the part that it touches, if it does."""
        key = (face.part, face.number)
        if key not in self.given:
            alike = [one for one in self.facts.faces if one.name == face.name]
            if face.name and len(alike) == 1:
                self.given[key] = face.name
            else:
                self.given[key] = name = self._free(f"{face.part}.{word}")
                self.selectors[name] = self._selector(face, touching)
        return self.given[key]

    def of_several(self, faces: Sequence[FaceFacts], word: str) -> str:
        """The name of faces that are meant together, such as the halves of a cylinder."""
        if len(faces) == 1:
            return self.of(faces[0], word)
        name = self._free(f"{faces[0].part}.{word}")
        self.selectors[name] = Selector(part=faces[0].part, number=tuple(sorted(face.number for face in faces)))
        return name

    def _free(self, name: str) -> str:
        taken = {one.name for one in self.facts.faces} | set(self.selectors)
        return next(n for n in (name, *(f"{name} {k}" for k in range(2, 10_000))) if n not in taken)

    def _selector(self, face: FaceFacts, touching: str | None) -> Selector:
        """The first of touching, normal and number that means this face alone."""
        tries = [Selector(part=face.part, touching=touching)] if touching is not None else []
        tries += [
            Selector(part=face.part, normal=axis)
            for axis in AXES.values()
            if face.normal is not None and np.allclose(axis, face.normal)
        ]
        for selector in tries:
            try:
                if chosen("", selector, self.facts, snap=self.snap) == (face,):
                    return selector
            except InputError:
                continue
        return Selector(part=face.part, number=face.number)


def propose(facts: GeometryFacts, path: Path) -> Proposal:
    """Propose joints, bolts and a mesh for a geometry.

    Args:
        facts: what `read_facts` says of it.
        path: the STEP file, to measure how far parts lie apart.

    Raises:
        InputError: a single part, no parts that touch, or parts that touch no other.
    """
    if len(facts.parts) < 2:
        raise InputError(f"{facts.file} holds one part, {facts.parts[0].name!r}; a joint needs two that touch")
    contacts = _joints(facts)
    _check_joined(facts, contacts, path)
    close = TOUCHING * facts.size
    widest = max(abs(contact.gap) for contact in contacts)
    snap = 0.0 if widest <= close else rounded(1.01 * widest, 2, up=True)
    names = _Names(facts, snap)
    remarks: list[str] = []
    if snap:
        remarks.append(f"faces up to {show(widest, 'm')} apart are taken for touching (geometry.snap)")
    joints = []
    for k, contact in enumerate(contacts, 1):
        word = "joint" if len(contacts) == 1 else f"joint {k}"
        pair = [facts.face(*side) for side in (contact.first, contact.second)]
        faces = [names.of(one, word, other.part) for one, other in zip(pair, reversed(pair), strict=True)]
        joints.append(JointProposal(name=word, faces=(faces[0], faces[1]), gap=contact.gap, area=contact.area))
    solid = _solid_bolts(facts, contacts, names)
    beams = [*_beams(facts, names, {bolt.part for bolt in solid}, remarks)]
    bolts = tuple(replace(bolt, name=f"bolt {k}") for k, bolt in enumerate((*solid, *beams), 1))
    if not bolts:
        remarks.append("no bolt was found: fill in [[bolt]] by hand before you run the study")
    size, words = mesh_size(facts, {bolt.part for bolt in solid})
    remarks.append(words)
    return Proposal(
        facts=facts,
        faces=names.selectors,
        joints=tuple(joints),
        bolts=bolts,
        size=size,
        snap=snap,
        remarks=tuple(remarks),
    )


def rounded(value: float, digits: int, *, up: bool = False) -> float:
    """A value to so many digits, the nearest or the next above."""
    step: float = 10.0 ** (floor(log10(value)) - digits + 1)
    return round((np.ceil(value / step) if up else round(value / step)) * step, 15)


def _joints(facts: GeometryFacts) -> list[Contact]:
    """Planes that touch; where two parts touch nowhere, those that nearly do."""
    close = TOUCHING * facts.size
    plane = [
        one
        for one in facts.contacts
        if facts.face(*one.first).kind == "plane"
        and one.area >= LEAST * min(facts.face(*one.first).area, facts.face(*one.second).area)
    ]
    touching = [one for one in plane if abs(one.gap) <= close]
    met = {frozenset((one.first[0], one.second[0])) for one in touching}
    near = [one for one in plane if frozenset((one.first[0], one.second[0])) not in met and one.gap > 0]
    least = {frozenset((one.first[0], one.second[0])): np.inf for one in near}
    for one in near:
        pair = frozenset((one.first[0], one.second[0]))
        least[pair] = min(least[pair], one.gap)
    near = [one for one in near if one.gap <= least[frozenset((one.first[0], one.second[0]))] + close]
    return [*touching, *near]


def _check_joined(facts: GeometryFacts, contacts: Sequence[Contact], path: Path) -> None:
    if not contacts:
        apart = part_distance(path)
        assert apart is not None
        raise InputError(
            f"{facts.file}: no flat faces of two parts touch; the nearest parts are {apart[0]!r} and {apart[1]!r}, "
            f"{show(apart[2], 'm')} apart. Move them together in the CAD program, or check what `faying faces` lists"
        )
    joined = {part for contact in contacts for part in (contact.first[0], contact.second[0])}
    loose = [part.name for part in facts.parts if part.name not in joined]
    if loose:
        raise InputError(
            f"{facts.file}: {', '.join(map(repr, loose))} touch no other part with a flat face; leave them out of the "
            "file, move them in the CAD program, or write the study by hand (`faying init`)"
        )


def _solid_bolts(facts: GeometryFacts, contacts: Sequence[Contact], names: _Names) -> list[BoltProposal]:
    """Parts whose shank runs through holes of others and whose flat faces, towards each other, press on them."""
    out = []
    for part in facts.parts:
        through = [
            (facts.face(*one), facts.face(*two))
            for contact in facts.contacts
            for one, two in ((contact.first, contact.second), (contact.second, contact.first))
            if one[0] == part.name and facts.face(*one).kind == "cylinder" and not facts.face(*one).hole
        ]
        if not through:
            continue
        shank = through[0][0]
        axis = np.array(shank.axis)
        sides = [side for contact in contacts for side in (contact.first, contact.second) if side[0] == part.name]
        pressed = [facts.face(*side) for side in dict.fromkeys(sides)]
        low = [face for face in pressed if face.normal is not None and np.array(face.normal) @ axis > 0.99]
        high = [face for face in pressed if face.normal is not None and np.array(face.normal) @ axis < -0.99]
        if len(low) != 1 or len(high) != 1:
            raise InputError(
                f"part {part.name!r} runs through holes like a bolt, but {len(low)} and {len(high)} flat faces of it "
                "press on the parts, and one each is needed, under the head and at the nut; unite the bolt and its "
                "nut in the CAD program, or leave both out of the file and let a beam stand for them"
            )
        head = max((low[0], high[0]), key=lambda face: face.area)
        nut = high[0] if head is low[0] else low[0]
        assert shank.radius is not None
        size = round(2e3 * shank.radius) if abs(2e3 * shank.radius - round(2e3 * shank.radius)) < 0.05 else None
        size = size if size in WASHERS else None
        faces = (names.of(head, "head"), names.of(nut, "nut"))
        remark = f"the part {part.name!r} is the bolt"
        out.append(BoltProposal(name="", faces=faces, size=size, part=part.name, remark=remark))
    return out


def _beams(facts: GeometryFacts, names: _Names, solid: set[str | None], remarks: list[str]) -> Iterator[BoltProposal]:
    """Bolts through the rows of holes in which no part runs."""
    shanks = {
        side
        for contact in facts.contacts
        for one, side in ((contact.first, contact.second), (contact.second, contact.first))
        if one[0] in solid
    }
    reach = 0.01 * facts.size
    for stack in stacks([bore for bore in bores(facts) if bore.part not in solid], reach=reach):
        if any((bore.part, number) in shanks for bore in stack.bores for number in bore.faces):
            continue
        where = f"the holes about ({', '.join(f'{1e3 * x:.4g}' for x in stack.middle)}) mm"
        found = _size(stack)
        if found is None and 2 * min(bore.radius for bore in stack.bores) > WIDEST:
            continue  # a pipe, a bearing
        if found is None:
            widths = ", ".join(f"{2e3 * bore.radius:.4g} mm in {bore.part!r}" for bore in stack.bores)
            remarks.append(f"{where} ({widths}) are clearance holes of no common bolt (M3 to M24, ISO 273): left out")
            continue
        size, tapped = found
        low, high = stack.bores[0], stack.bores[-1]
        if tapped is not None:
            end, top = (high, True) if tapped is low else (low, False)
            under = seat(facts, end, top=top)
            if under is None:
                remarks.append(f"{where} have no flat face for a head: left out")
                continue
            yield _screw(facts, names, (end, under), tapped, size)
            continue
        ends = seat(facts, low, top=False), seat(facts, high, top=True)
        if ends[0] is None or ends[1] is None:
            remarks.append(f"{where} have no flat face for head or nut at an end (a blind hole?): left out")
            continue
        yield _beam(facts, names, stack, (ends[0], ends[1]), size)


def _size(stack: Stack) -> tuple[int, Bore | None] | None:
    """Nominal diameter [mm] of the bolt of a row of holes, and the hole that is its thread; None where none fits."""
    sizes = [size_for_hole(2 * bore.radius) for bore in stack.bores]
    ends = [(stack.bores[-1], sizes[:-1]), (stack.bores[0], sizes[1:])]
    if sizes[0] is not None and len(set(sizes)) == 1:
        return sizes[0], None
    for end, others in ends:
        if others[0] is not None and len(set(others)) == 1 and is_tapped(2 * end.radius, others[0]):
            return others[0], end
    return None


def _screw(facts: GeometryFacts, names: _Names, head: tuple[Bore, FaceFacts], tapped: Bore, size: int) -> BoltProposal:
    """A screw into a tapped hole; head: the hole under its head, and the face that it presses."""
    bore, under = head
    outer, why = HEADS[size] / 1e3, "of its head, ISO 4762"
    walls = [facts.face(tapped.part, number) for number in tapped.faces]
    return BoltProposal(
        name="",
        faces=(names.of(under, "seat"), names.of_several(walls, "thread")),
        size=size,
        ring=(round(2 * bore.radius, 9), outer),
        remark=(
            f"M{size} for a hole of {show(2 * bore.radius, 'm')} (ISO 273), screwed into the hole of "
            f"{show(2 * tapped.radius, 'm')} in {tapped.part!r}; seat: from the hole to the diameter {why}"
        ),
    )


def _beam(
    facts: GeometryFacts, names: _Names, stack: Stack, ends: tuple[FaceFacts, FaceFacts], size: int
) -> BoltProposal:
    hole = 2 * max(stack.bores[0].radius, stack.bores[-1].radius)
    last = (stack.bores[0], stack.bores[-1])
    room = 2 * CHORDS * min(room_around(facts, end, bore) for end, bore in zip(ends, last, strict=True))
    washer, head = WASHERS[size] / 1e3, HEADS[size] / 1e3
    outer, why = (washer, "of its washer, ISO 7089") if washer <= room else (head, "of its head, ISO 4762")
    if outer > room:
        why += f", although the face ends {show(room / 2, 'm')} from the axis"
    x, y, z = (round(float(v), 9) + 0.0 for v in stack.middle)
    return BoltProposal(
        name="",
        faces=(names.of(ends[0], "seat"), names.of(ends[1], "seat")),
        size=size,
        at=(x, y, z),
        ring=(round(hole, 9), outer),
        remark=f"M{size} for a hole of {show(hole, 'm')} (ISO 273); seat: from the hole to the diameter {why}",
    )


def mesh_size(facts: GeometryFacts, bolts: set[str | None]) -> tuple[float, str]:
    """Largest element [m], and why: two across the thinnest part, more where memory or time would not do."""
    plates = [part for part in facts.parts if part.name not in bolts]
    thin = min(plates, key=_thickness)
    size = rounded(_thickness(thin) / ACROSS, 2)
    why = f"{ACROSS} elements across {thin.name!r}, which is about {show(_thickness(thin), 'm', digits=2)} thick"
    free, widest = available(), _thickness(thin)
    while size < widest:
        unknowns = unknowns_of(facts, size)
        if unknowns <= MOST and (free is None or guessed(unknowns) <= free / 2):
            break
        size = min(rounded(1.1 * size, 2), widest)
        why = "coarser than two elements across the thinnest part, for memory and time; try a finer one, too"
    return size, f"mesh of {show(size, 'm')}: {why}"


def _thickness(part: PartFacts) -> float:
    """The least side of the box around a part, or twice volume over area where it is much less than a plate's."""
    low, high = np.array(part.low), np.array(part.high)
    least, mean = float((high - low).min()), part.thickness
    return least if mean > least / 2 else mean
