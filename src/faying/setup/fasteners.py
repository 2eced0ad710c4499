"""Parts of a geometry that are fasteners: bolts that can be meshed, and those that are left out of the mesh."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import permutations
from math import pi

import numpy as np

from faying.geometry.face_facts import FaceFacts, GeometryFacts, PartFacts, TouchingFaces
from faying.setup.bolt_proposal import BoltProposal, to_nanometres
from faying.setup.drawn_bolts import drawn_bolts
from faying.setup.fastener_forms import PLAY, SLENDER, forms, line_of
from faying.text import listed
from faying.typing import Array

SOLID = 0.75  # of the volume of a cylinder, below which a pin is hollow

Side = tuple[str, int]
Pair = tuple[FaceFacts, FaceFacts, float]  # a shaft, the hole round it, and the gap [m]
Point = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class MeshedBolt:
    """A part that is a bolt with its nut: the part, its shank, and its faces under the head and at the nut.

    tight: whether it has no play in its holes, as a rivet has none.
    """

    part: str
    shank: FaceFacts
    head: FaceFacts
    nut: FaceFacts
    tight: bool = False


@dataclass(frozen=True, kw_only=True)
class DrawnPin:
    """A part that is a dowel.

    part, shank: its name and its face; holes: faces of the holes that it fits; ends: where it begins and ends [m];
    hollow: whether it has much less volume than a cylinder between its ends, as a spring pin has.
    """

    part: str
    shank: FaceFacts
    holes: tuple[FaceFacts, ...]
    ends: tuple[Point, Point]
    hollow: bool = False


@dataclass(frozen=True, kw_only=True)
class Fasteners:
    """What parts of a geometry are fasteners.

    Args:
        meshed: bolts that can be meshed.
        drawn: bolts that are left out with their nuts and washers: beams as they are drawn stand for them.
        dowels: parts that are dowels, which are left out, too: pins without a mesh stand for them.
        others: parts that are left out: bolts, studs and nuts whose holes or seats are not found.
        washers: washers that are not left out.
        shanks: part and number of the faces of holes in which a meshed bolt or a dowel runs, or another part without
            play.
    """

    meshed: tuple[MeshedBolt, ...] = ()
    drawn: tuple[BoltProposal, ...] = ()
    dowels: tuple[DrawnPin, ...] = ()
    others: tuple[str, ...] = ()
    washers: tuple[str, ...] = ()
    shanks: frozenset[Side] = field(default_factory=frozenset)

    @property
    def left_out(self) -> tuple[str, ...]:
        """Parts that the mesh leaves out."""
        return (*(pin.part for pin in self.dowels), *self.of_bolts, *self.others)

    @property
    def of_bolts(self) -> tuple[str, ...]:
        """Parts that are bolts with their nuts and washers: the stems of all, then the rest."""
        bodies = [bolt.drawn.names for bolt in self.drawn if bolt.drawn is not None]
        return (*(names[0] for names in bodies), *(name for names in bodies for name in names[1:]))

    @property
    def remarks(self) -> list[str]:
        """What there is to say of the parts that are left out."""
        out = []
        if self.dowels:
            out.append(
                f"{quoted(pin.part for pin in self.dowels)}: dowels, which carry only shear. Left out of the mesh "
                "(geometry.leave_out); a [[dowel]] stands for each"
            )
        if self.drawn:
            out.append(
                f"{quoted(self.of_bolts)}: bolts, their nuts and washers. Left out of the mesh (geometry.leave_out): a "
                "beam stands for each bolt, and what is not its shank rests as mass on its two seats"
            )
        if self.others:
            out.append(
                f"{quoted(self.others)}: bolts, studs or nuts whose holes, seats or size are not found. Left out of "
                "the mesh (geometry.leave_out), and no beam stands for them but where holes by themselves ask for one"
            )
        return out


def quoted(names: Iterable[str]) -> str:
    """Names in quotes, the first few."""
    return listed(map(repr, names), 4)


def find_fasteners(facts: GeometryFacts, joints: Sequence[TouchingFaces]) -> Fasteners:
    """Tell which parts are fasteners.

    Args:
        facts: of the geometry.
        joints: the planes that touch.
    """
    pairs = [
        (facts.face(*one), facts.face(*two), contact.gap)
        for contact in facts.contacts
        for one, two in permutations(contact.sides)
        if facts.face(*one).kind == "cylinder" and not facts.face(*one).hole
    ]
    shafts = {part.name: mine for part in facts.parts if (mine := _shaft(facts, part.name, pairs))}
    meshed = [bolt for mine in shafts.values() if (bolt := _meshed(facts, joints, mine)) is not None]
    solid = {bolt.part for bolt in meshed}
    found = [form for form in forms(facts) if form.part not in solid]
    drawn = drawn_bolts(facts, found, solid)
    taken = solid | {name for bolt in drawn if bolt.drawn is not None for name in bolt.drawn.names}
    dowels, others = [], []
    for part in facts.parts:
        mine = shafts.get(part.name, [])
        if not mine or part.name in taken:
            continue
        close = PLAY * (mine[0][0].radius or 0.0)
        holes = tuple(hole for _, hole, gap in mine if gap <= close)
        pressed = any(_pressed(facts, joints, mine[0][0]))
        nuts = [
            form.part for form in found if form.fits(mine[0][0].radius or 0.0) and form.part in {h.part for h in holes}
        ]
        if not pressed and not nuts and len({hole.part for hole in holes}) > 1:
            dowels.append(_pin(facts, part, mine[0][0], holes))
        else:
            others += [part.name, *nuts]
    owners = {*solid, *(pin.part for pin in dowels)}
    tight = {shank.part for shank, _, gap in pairs if shank.part in others and gap <= PLAY * (shank.radius or 0.0)}
    return Fasteners(
        meshed=tuple(meshed),
        drawn=tuple(drawn),
        dowels=tuple(dowels),
        others=tuple(one for one in dict.fromkeys(others) if one not in taken),
        washers=tuple(form.part for form in found if form.is_washer and form.part not in taken),
        shanks=frozenset((hole.part, hole.number) for shank, hole, _ in pairs if shank.part in owners | tight),
    )


def _shaft(facts: GeometryFacts, part: str, pairs: Sequence[Pair]) -> list[Pair]:
    """A shaft of a part that is slender enough for a fastener, with the holes that it runs in; none for other parts."""
    mine = [pair for pair in pairs if pair[0].part == part]
    if not mine or _about(facts, mine[0][0])[0].max() > SLENDER * (mine[0][0].radius or 0.0):
        return []
    return mine


def _meshed(facts: GeometryFacts, joints: Sequence[TouchingFaces], mine: Sequence[Pair]) -> MeshedBolt | None:
    """The bolt that a part is with its nut, from its shaft: one flat face presses at each end of its shank."""
    shank = mine[0][0]
    low, high = _pressed(facts, joints, shank)
    if len(low) != 1 or len(high) != 1:
        return None
    head = max((low[0], high[0]), key=lambda face: face.area)
    tight = all(gap <= PLAY * (shank.radius or 0.0) for _, _, gap in mine)
    return MeshedBolt(part=shank.part, shank=shank, head=head, nut=high[0] if head is low[0] else low[0], tight=tight)


def _pressed(
    facts: GeometryFacts, joints: Sequence[TouchingFaces], shank: FaceFacts
) -> tuple[list[FaceFacts], list[FaceFacts]]:
    """Flat faces of a bolt that press on other parts: those that look along its axis, and those that look back.

    The ends of the shank do not count, such as that of a dowel on the bottom of its hole.
    """
    axis = np.array(shank.axis)
    sides = [side for contact in joints for side in contact.sides if side[0] == shank.part]
    pressed = [face for side in dict.fromkeys(sides) if _beyond(facts, face := facts.face(*side), shank)]
    low = [face for face in pressed if face.normal is not None and np.array(face.normal) @ axis > 0.99]
    high = [face for face in pressed if face.normal is not None and np.array(face.normal) @ axis < -0.99]
    return low, high


def _beyond(facts: GeometryFacts, face: FaceFacts, shank: FaceFacts) -> bool:
    """Whether a face reaches farther from the axis than the shank does."""
    assert shank.radius is not None
    return bool(line_of(shank).about(facts.triangles(face))[0].max() > (1 + PLAY) * shank.radius)


def _about(facts: GeometryFacts, shank: FaceFacts) -> tuple[Array, Array]:
    """How far a part reaches from the axis of its shank, and how far along it from its start [m]: all its corners."""
    return line_of(shank).about(np.concatenate([facts.triangles(face) for face in facts.by_part[shank.part]]))


def _pin(facts: GeometryFacts, part: PartFacts, shank: FaceFacts, holes: tuple[FaceFacts, ...]) -> DrawnPin:
    depth = _about(facts, shank)[1]
    low, high = (np.array(shank.start) + z * np.array(shank.axis) for z in (depth.min(), depth.max()))
    ends = to_nanometres(low), to_nanometres(high)
    cylinder = pi * (shank.radius or 0.0) ** 2 * float(np.linalg.norm(np.subtract(*ends)))
    return DrawnPin(part=part.name, shank=shank, holes=holes, ends=ends, hollow=part.volume < SOLID * cylinder)
