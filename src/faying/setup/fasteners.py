"""Parts of a geometry that are fasteners: bolts that can be meshed, and those that are left out of the mesh."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import permutations
from math import pi

import numpy as np

from faying.bolt.threads import nearest_size
from faying.fe.line import Line
from faying.geometry.face_facts import FaceFacts, GeometryFacts, Point, TouchingFaces
from faying.setup.bolt_proposal import BoltProposal, to_nanometres
from faying.setup.drawn_bolts import drawn_bolts
from faying.setup.fastener_forms import DRAWN, PLAY, SLENDER, forms
from faying.text import listed
from faying.units import show

WIDEST_PIN = 50e-3  # m: of ISO 2338; wider shafts without play are parts of a structure
SOLID = 0.75  # of the volume of a cylinder, below which a pin is hollow

Side = tuple[str, int]


@dataclass(frozen=True, kw_only=True)
class DowelProposal:
    """A dowel.

    Args:
        faces: its walls, those of each part together.
        part: the body that it is; "" for none.
        ends: where it begins and ends [m], where no hole says it.
        remark: where it is from.
        name, walls: what tables call it, and names of its walls, once they have names.
    """

    faces: tuple[tuple[FaceFacts, ...], ...]
    part: str = ""
    ends: tuple[Point, Point] | None = None
    remark: str = ""
    name: str = ""
    walls: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Fasteners:
    """What parts of a geometry are fasteners.

    Args:
        bolts: those that are a part and can be meshed, and those that are left out with their nuts and washers: beams
            as they are drawn stand for them.
        dowels: parts that are dowels, which are left out, too: pins without a mesh stand for them.
        others: parts that are left out: bolts, studs and nuts whose holes or seats are not found.
        washers: washers that are not left out.
        shanks: part and number of the faces of holes in which a meshed bolt or a dowel runs, or another part without
            play.
    """

    bolts: tuple[BoltProposal, ...]
    dowels: tuple[DowelProposal, ...]
    others: tuple[str, ...]
    washers: tuple[str, ...]
    shanks: frozenset[Side]

    @property
    def left_out(self) -> tuple[str, ...]:
        """Parts that the mesh leaves out."""
        return (*(pin.part for pin in self.dowels), *self.of_bolts, *self.others)

    @property
    def of_bolts(self) -> tuple[str, ...]:
        """Parts that are bolts with their nuts and washers: the stems of all, then the rest."""
        bodies = [bolt.drawn.names for bolt in self.bolts if bolt.drawn is not None]
        return (*(names[0] for names in bodies), *(name for names in bodies for name in names[1:]))

    @property
    def solid(self) -> tuple[tuple[str, ...], ...]:
        """Bodies of each bolt that can be meshed as one part."""
        return tuple(bolt.drawn.solid for bolt in self.bolts if bolt.drawn is not None and bolt.drawn.solid)

    @property
    def remarks(self) -> list[str]:
        """What there is to say of the parts that are left out."""
        out = "Left out of the mesh (geometry.leave_out)"
        beams = "a beam stands for each bolt, and what is not its shank rests as mass on its two seats"
        no_beams = "no beam stands for them but where holes by themselves ask for one"
        words = (
            ([pin.part for pin in self.dowels], f"dowels, which carry only shear. {out}; a [[dowel]] stands for each"),
            (self.of_bolts, f"bolts, their nuts and washers. {out}: {beams}"),
            (self.others, f"bolts, studs or nuts whose holes, seats or size are not found. {out}, and {no_beams}"),
        )
        return [f"{quoted(names)}: {text}" for names, text in words if names]


def quoted(names: Iterable[str]) -> str:
    """Names in quotes, the first few."""
    return listed(map(repr, names), 4)


def find_fasteners(facts: GeometryFacts, joints: Sequence[TouchingFaces]) -> Fasteners:
    """Tell which parts are fasteners.

    Args:
        facts: of the geometry.
        joints: the planes that touch.
    """
    shafts = [shaft for part in facts.parts if (shaft := _shaft(facts, part.name)) is not None]
    bodies = forms(facts)
    stems = {form.part for form in bodies if not form.ring}
    own = (_meshed(facts, joints, shaft) for shaft in shafts if shaft.part in stems)
    meshed = {bolt.part: bolt for bolt in own if bolt is not None and bolt.part is not None}
    found = [form for form in bodies if form.part not in meshed]
    drawn = drawn_bolts(facts, found, meshed)
    taken = {*meshed} | {name for bolt in drawn if bolt.drawn is not None for name in bolt.drawn.names}
    dowels, others = [], []
    for shaft in shafts:
        if shaft.part in taken:
            continue
        fitted = {hole.part for hole in shaft.tight}
        nuts = [form.part for form in found if form.part in fitted and form.fits(shaft.radius)]
        is_pin = len(fitted) > 1 and shaft.radius <= (1 + PLAY) * WIDEST_PIN / 2
        if is_pin and not nuts and not any(_pressed(facts, joints, shaft)):
            dowels.append(_pin(facts, shaft))
        elif shaft.part in stems:
            others += [shaft.part, *nuts]
    fill = [shaft for shaft in shafts if shaft.part in meshed or (shaft.tight and shaft.part not in taken)]
    return Fasteners(
        bolts=(*meshed.values(), *drawn),
        dowels=tuple(dowels),
        others=tuple(one for one in dict.fromkeys(others) if one not in taken),
        washers=tuple(form.part for form in found if form.is_washer and form.part not in taken),
        shanks=frozenset(hole.side for shaft in fill for hole, _ in shaft.holes),
    )


@dataclass(frozen=True, kw_only=True)
class _Shaft:
    """A shaft of a part in holes: its axis, its radius [m], the faces of the holes and the gap of each [m]."""

    part: str
    line: Line
    radius: float
    holes: tuple[tuple[FaceFacts, float], ...]

    @property
    def tight(self) -> tuple[FaceFacts, ...]:
        """Holes in which it has no play."""
        return tuple(hole for hole, gap in self.holes if gap <= PLAY * self.radius)


def _shaft(facts: GeometryFacts, part: str) -> _Shaft | None:
    """The shaft of a part that is slender enough for a fastener, with the holes that it runs in; None for others."""
    pairs = [
        (facts.face(*one), facts.face(*two), contact.gap)
        for contact in facts.contacts
        for one, two in permutations(contact.sides)
        if one[0] == part and facts.face(*one).hole is False
    ]
    if not pairs:
        return None
    line, radius = pairs[0][0].line, pairs[0][0].radius or 0.0
    if line.about(facts.corners_of(part))[0].max() > SLENDER * radius:
        return None
    return _Shaft(part=part, line=line, radius=radius, holes=tuple((hole, gap) for _, hole, gap in pairs))


def _meshed(facts: GeometryFacts, joints: Sequence[TouchingFaces], shaft: _Shaft) -> BoltProposal | None:
    """The bolt that a part is with its nut, from its shaft: two flat faces that look at each other clamp the others."""
    along, back = _pressed(facts, joints, shaft)
    if len(along) != 1 or len(back) != 1 or (np.subtract(back[0].centre, along[0].centre) @ shaft.line.axis) <= 0:
        return None
    head, nut = sorted((along[0], back[0]), key=lambda face: -face.area)
    clamped = {part for contact in facts.contacts if shaft.part in contact.parts for part in contact.parts}
    tight = len(shaft.tight) == len(shaft.holes)  # as a rivet is
    return BoltProposal(
        axis=shaft.line.axis,
        parts=tuple(sorted(clamped - {shaft.part})),
        head=(head,),
        end=(nut,),
        words=("head", "nut"),
        size=nearest_size(2e3 * shaft.radius, lambda one: one.size, DRAWN),
        part=shaft.part,
        remark=f"the part {shaft.part!r} is the bolt"
        + "; it has no play: if it is a rivet, give the force that it was set with" * tight,
    )


def _pressed(
    facts: GeometryFacts, joints: Sequence[TouchingFaces], shaft: _Shaft
) -> tuple[list[FaceFacts], list[FaceFacts]]:
    """Flat faces of a bolt that press on other parts: those that look along its axis, and those that look back.

    The ends of the shank do not count, such as that of a dowel on the bottom of its hole.
    """
    sides = dict.fromkeys(side for contact in joints for side in contact.sides if side[0] == shaft.part)

    def reach(face: FaceFacts) -> float:
        return float(shaft.line.about(facts.triangles(face))[0].max())

    pressed = [face for side in sides if reach(face := facts.face(*side)) > (1 + PLAY) * shaft.radius]
    along, back = ([face for face in pressed if face.facing(way * shaft.line.axis) > 0.99] for way in (1, -1))
    return along, back


def _pin(facts: GeometryFacts, shaft: _Shaft) -> DowelProposal:
    """The dowel that a part is; hollow, as a spring pin, where it has much less volume than a cylinder."""
    depth = shaft.line.about(facts.corners_of(shaft.part))[1]
    low, high = float(depth.min()), float(depth.max())
    volume = next(part.volume for part in facts.parts if part.name == shaft.part)
    hollow = volume < SOLID * pi * shaft.radius**2 * (high - low)
    walls: dict[str, list[FaceFacts]] = {}
    for hole in shaft.tight:
        walls.setdefault(hole.part, []).append(hole)
    return DowelProposal(
        faces=tuple(map(tuple, walls.values())),
        part=shaft.part,
        ends=(to_nanometres(shaft.line.at(low)), to_nanometres(shaft.line.at(high))),
        remark=f"{show(2 * shaft.radius, 'm')}, a pin of the file"
        + "; it is hollow and counts as solid, too stiff and too heavy: take it out or soften it" * hollow,
    )
