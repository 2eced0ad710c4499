"""Parts of a geometry that are fasteners: bolts that can be meshed, and those that are left out of the mesh."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import permutations
from math import pi

import numpy as np

from faying.geometry.face_facts import FaceFacts, GeometryFacts, PartFacts, TouchingFaces
from faying.text import listed
from faying.typing import Array

SLENDER = 1.5  # shank diameters from its axis, beyond which a part with a shank is not a bolt (but a spigot, say)
NUT = 1.25, 2.5  # shank diameters: the farthest that a nut reaches from the axis, and how long it is at most
SOLID = 0.75  # of the volume of a cylinder, below which a pin is hollow
TIGHT = 1e-2  # of the radius: gap between shank and hole below which they fit without play

Side = tuple[str, int]
Point = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class MeshedBolt:
    """A part that is a bolt with its nut: the part, its shank, and its faces under the head and at the nut."""

    part: str
    shank: FaceFacts
    head: FaceFacts
    nut: FaceFacts


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
        dowels: parts that are dowels, which are left out, too: pins without a mesh stand for them.
        others: parts that are left out: bolts, studs and nuts that beams stand for.
        shanks: part and number of the faces of holes in which a meshed bolt or a dowel runs.
    """

    meshed: tuple[MeshedBolt, ...] = ()
    dowels: tuple[DrawnPin, ...] = ()
    others: tuple[str, ...] = ()
    shanks: frozenset[Side] = field(default_factory=frozenset)

    @property
    def left_out(self) -> tuple[str, ...]:
        """Parts that the mesh leaves out."""
        return (*(pin.part for pin in self.dowels), *self.others)

    @property
    def remarks(self) -> list[str]:
        """What there is to say of the parts that are left out."""
        out = []
        if self.dowels:
            out.append(
                f"{quoted(pin.part for pin in self.dowels)}: dowels, which carry only shear. Left out of the mesh "
                "(geometry.leave_out); a [[dowel]] stands for each"
            )
        if self.others:
            out.append(
                f"{quoted(self.others)}: bolts, studs or nuts without one flat face under the head and one at the nut. "
                "Left out of the mesh (geometry.leave_out); beams stand for those whose holes are found"
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
    meshed, dowels, others = [], [], []
    shafts: list[FaceFacts] = []
    for part in facts.parts:
        mine = [pair for pair in pairs if pair[0].part == part.name]
        if not mine or _reach(facts, part.name, mine[0][0])[0] > 2 * SLENDER * (mine[0][0].radius or 0.0):
            continue
        shank = mine[0][0]
        low, high = _pressed(facts, joints, shank)
        if len(low) == len(high) == 1:
            head = max((low[0], high[0]), key=lambda face: face.area)
            nut = high[0] if head is low[0] else low[0]
            meshed.append(MeshedBolt(part=part.name, shank=shank, head=head, nut=nut))
            continue
        tight = {hole.part for _, hole, gap in mine if gap <= TIGHT * (shank.radius or 0.0)}
        if not low and not high and len(tight) > 1 and not any(_is_nut(facts, *pair) for pair in mine):
            holes = tuple(hole for _, hole, gap in mine if gap <= TIGHT * (shank.radius or 0.0))
            dowels.append(_pin(facts, part, shank, holes))
        else:
            others.append(part.name)
            shafts.append(shank)
    nuts = [pair[1].part for pair in pairs if pair[0] in shafts and _is_nut(facts, *pair)]
    owners = {*(bolt.part for bolt in meshed), *(pin.part for pin in dowels)}
    return Fasteners(
        meshed=tuple(meshed),
        dowels=tuple(dowels),
        others=tuple(dict.fromkeys((*others, *nuts))),
        shanks=frozenset((hole.part, hole.number) for shank, hole, _ in pairs if shank.part in owners),
    )


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
    return bool(_about(facts.triangles(face), shank)[0].max() > (1 + TIGHT) * shank.radius)


def _is_nut(facts: GeometryFacts, shank: FaceFacts, hole: FaceFacts, gap: float) -> bool:
    """Whether the part of a hole is a nut on a shank: small, and without play."""
    assert shank.radius is not None
    reach, length = _reach(facts, hole.part, shank)
    diameter = 2 * shank.radius
    return gap <= TIGHT * shank.radius and reach <= NUT[0] * diameter and length <= NUT[1] * diameter


def _reach(facts: GeometryFacts, part: str, shank: FaceFacts) -> tuple[float, float]:
    """How far a part reaches from the axis of a shank, and its length along it [m]."""
    arm, depth = _about(_corners(facts, part), shank)
    return float(arm.max()), float(np.ptp(depth))


def _corners(facts: GeometryFacts, part: str) -> Array:
    """Corners of the triangles of a part [m]."""
    numbers = [k for k, face in enumerate(facts.faces) if face.part == part]
    return np.asarray(facts.corners[np.isin(facts.face_of, numbers)])


def _about(points: Array, shank: FaceFacts) -> tuple[Array, Array]:
    """How far points (..., 3) [m] lie from the axis of a shank, and how far along it from its start [m]."""
    axis = np.array(shank.axis)
    arm = points.reshape(-1, 3) - np.array(shank.start)
    depth = arm @ axis
    return np.linalg.norm(arm - np.outer(depth, axis), axis=1), depth


def _pin(facts: GeometryFacts, part: PartFacts, shank: FaceFacts, holes: tuple[FaceFacts, ...]) -> DrawnPin:
    depth = _about(_corners(facts, part.name), shank)[1]
    low, high = (np.array(shank.start) + z * np.array(shank.axis) for z in (depth.min(), depth.max()))
    ends = to_nanometres(low), to_nanometres(high)
    cylinder = pi * (shank.radius or 0.0) ** 2 * float(np.linalg.norm(np.subtract(*ends)))
    return DrawnPin(part=part.name, shank=shank, holes=holes, ends=ends, hollow=part.volume < SOLID * cylinder)


def to_nanometres(place: Array) -> Point:
    """A point (3,) [m] to the last digit that a study needs."""
    x, y, z = (round(float(value), 9) + 0.0 for value in place)
    return x, y, z
