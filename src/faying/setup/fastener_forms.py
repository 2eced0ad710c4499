"""Bodies that have the form of a fastener: stems with or without a head (screws, studs, pins), rings (nuts, washers).

What a body is, its faces say: cylinders about one axis, hexagons, and planes that look along the axis.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faying.bolt.compliance import Head
from faying.bolt.standards import METRIC, is_tapped, nearest_size
from faying.fe.line import FACING, Line, across
from faying.geometry.bores import Bore, tubes
from faying.geometry.face_facts import FaceFacts, GeometryFacts
from faying.geometry.seen_along import hits

SLENDER = 3.0  # radii of its stem, beyond which a body with a stem is no fastener, but a spigot, say
STEM = 1.4  # over the narrowest stem, up to which a cylinder is a stem, too: nominal over core diameter of M1.6 is 1.37
WIDER = 1.2  # over the stem, from which a body is a head there
SHORT = 0.3  # of its diameter: a cylinder that is shorter is no stem, but a point or a collar
ROUND = 0.6  # share of its full area that a cylinder has at least: a key or a hole across may cut it
CLOSED = 0.97  # the same of a washer, below which it is split, as a spring washer is
ASIDE = 1e-2  # of its radius: how far the axis of a cylinder of a fastener is from that of the fastener
APART = 0.2  # of the radius of a stem: how far the axes of its holes, nuts and washers lie from its own
FLATS = 6  # sides of a hexagon
THIN = 0.35  # of its hole: what a washer is thick at most; ISO 7089 has 0.2, spring washers 0.3
LARGE = 3.2  # of its hole: what a washer is wide at most; large ones of ISO 7093 have 3
PLAY = 0.01  # of the radius: what a nut or a thread is wider than a stem at most
CORE = 0.7  # of the radius of a stem: the narrowest hole of its nut or thread; ISO 724 has 0.73 for M1.6
NUT = 1.3, 2.5  # stem diameters: the farthest that a nut reaches from the axis, and how long it is at most
DRAWN = 0.02  # of its diameter: how far a stem may be from the size that it is drawn as


@dataclass(frozen=True, kw_only=True)
class Bearing:
    """A plane of a fastener that can press: its face, its depth along the axis, and its outer diameter [m]."""

    face: FaceFacts
    depth: float
    outer: float


@dataclass(frozen=True, kw_only=True, eq=False)
class FastenerForm:
    """A body of the form of a fastener; lengths [m], depths along its line.

    Args:
        part: its name.
        line: its axis.
        low, high: where it begins and ends.
        ring: whether a hole goes through it.
        radius: of its stem, the widest of several, or of the hole of a ring, the narrowest.
        reach: how far it reaches from its axis.
        flats: width across the flats of a hexagon; None without.
        stems: radius, begin and end of each cylinder of the stem.
        round_head: whether a cylinder is the widest of it.
        head: +1 for a head at its end, -1 for one at its beginning, 0 for none, or for two.
        bearings: planes that look back (-1) and ahead (+1).
        split: whether it is a ring that does not close.
        volume: [m3].
    """

    part: str
    line: Line
    low: float
    high: float
    ring: bool
    radius: float
    reach: float
    flats: float | None
    stems: tuple[tuple[float, float, float], ...]
    round_head: bool
    head: int
    bearings: dict[int, Bearing]
    split: bool
    volume: float

    @property
    def diameter(self) -> float:
        """Of the stem or the hole [m]."""
        return 2 * self.radius

    @property
    def length(self) -> float:
        """From end to end [m]."""
        return self.high - self.low

    def holds(self, body: "Bore | FastenerForm", play: float = 0.0) -> bool:
        """Whether a hole, a nut or a washer is on the axis of this stem, with a play in it [m]."""
        return self.line.holds(body.line, APART * self.radius + play)

    @property
    def is_washer(self) -> bool:
        """Whether it is a flat ring about a hole."""
        flat = self.length <= THIN * self.diameter and self.reach <= LARGE * self.radius
        return self.ring and self.flats is None and flat

    def fits(self, radius: float) -> bool:
        """Whether it is a nut of a stem of a radius [m]: a ring that is small and has no play on it."""
        tight = CORE * radius <= self.radius <= (1 + PLAY) * radius
        return self.ring and tight and self.reach <= NUT[0] * 2 * radius and self.length <= NUT[1] * 2 * radius

    @property
    def shape(self) -> Head:
        """What the compliance of its head is taken of."""
        return "socket" if self.round_head and self.flats is None else "hexagon"

    @property
    def size(self) -> float | None:
        """Nominal diameter [mm]: of the sizes that its stem or hole may be drawn as, the one of its hexagon or head.

        Else the one whose nominal diameter it has, else the least whose core or tap drill it may be.
        """
        wide = 1e3 * self.diameter
        nominal = nearest_size(wide, lambda one: one.size, DRAWN)
        fitting = [size for size in METRIC if is_tapped(self.diameter, size) or size == nominal]
        across = 1e3 * (self.flats or 2 * self.reach)
        by_head = [
            size for size in fitting if (METRIC[size].flats if self.flats else METRIC[size].socket) == round(across, 2)
        ]
        return next(iter(by_head), nominal if nominal is not None else next(iter(fitting), None))


def forms(facts: GeometryFacts) -> list[FastenerForm]:
    """The bodies that have the form of a fastener."""
    return [found for part in facts.parts if (found := _form(facts, part.name, part.volume)) is not None]


def _form(facts: GeometryFacts, part: str, volume: float) -> FastenerForm | None:
    faces = facts.by_part[part]
    holes, shafts = tubes(faces, hole=True), tubes(faces, hole=False)
    line = _axis([*holes, *shafts])
    if line is None:
        return None
    corners = facts.corners_of(part)
    arm, depth = line.about(corners)
    flat = (corners - line.point) @ across(line.axis)
    ring = not np.any(hits(flat, depth.reshape(-1, 3), np.zeros((1, 2)))[0])
    round_it = [
        tube for tube in (holes if ring else shafts) if tube.turn > ROUND and line.holds(tube.line, ASIDE * tube.radius)
    ]
    long = [tube.radius for tube in round_it if ring or tube.high - tube.low > SHORT * 2 * tube.radius]
    stems = [tube for tube in round_it if ring or (long and tube.radius <= STEM * min(long))]
    radius = (min if ring else max)((tube.radius for tube in stems), default=0.0)
    if not stems or (not ring and arm.max() > SLENDER * radius):
        return None
    if not all(line.holds(hole.line, ASIDE * hole.radius) for hole in holes):
        return None  # a part with holes for others
    spans = [(tube.radius, *line.span(tube.line, tube.low, tube.high)) for tube in stems]
    head = 0
    if not ring:
        wide, ends = depth[arm > WIDER * radius], (min(low for _, low, _ in spans), max(high for *_, high in spans))
        sides = np.any(wide <= ends[0] + SHORT * radius), np.any(wide >= ends[1] - SHORT * radius)
        head = int(sides[1]) - int(sides[0])
    flats = _flats(faces, line)
    return FastenerForm(
        part=part,
        line=line,
        low=float(depth.min()),
        high=float(depth.max()),
        ring=ring,
        radius=radius,
        reach=float(arm.max()),
        flats=flats,
        stems=tuple(spans),
        round_head=any(tube.radius > WIDER * radius for tube in round_it),
        head=head,
        bearings=_bearings(facts, faces, line, 0.0 if ring else radius, flats),
        split=ring and min(tube.turn for tube in stems) < CLOSED,
        volume=volume,
    )


def _axis(cylinders: Sequence[Bore]) -> Line | None:
    """The axis that most of the area of a body's cylinders is round."""

    def area_about(line: Line) -> float:
        alike = [one for one in cylinders if line.holds(one.line, 1e-3 * one.radius)]
        return sum(one.radius * one.turn * (one.high - one.low) for one in alike)

    return max((one.line for one in cylinders), key=area_about, default=None)


def _flats(faces: Sequence[FaceFacts], line: Line) -> float | None:
    """Width [m] across the flats of a hexagon that looks away from a line; None without one."""
    upright = [face for face in faces if face.normal is not None and abs(face.facing(line.axis)) <= 1e-3]
    away = [face.facing(np.array(face.centre) - line.point) for face in upright]
    widths = [one for one in away if one > 0 and sum(abs(one - other) < 1e-3 * one for other in away) == FLATS]
    return 2 * max(widths) if widths else None


def _bearings(
    facts: GeometryFacts, faces: Sequence[FaceFacts], line: Line, radius: float, flats: float | None
) -> dict[int, Bearing]:
    """The planes of a body that look back and ahead along a line and reach beyond a radius [m], the outermost ones."""
    found: dict[int, Bearing] = {}
    for face in faces:
        side = round(face.facing(line.axis))
        arm, depth = line.about(facts.triangles(face))
        outer, at = 2 * float(arm.max()), float(depth.mean())
        if abs(face.facing(line.axis)) < FACING or outer <= 1.05 * 2 * radius:
            continue
        if flats is not None and abs(outer * 3**0.5 / 2 - flats) < 1e-2 * flats:  # the corners of the hexagon
            outer = flats
        if side not in found or side * at > side * found[side].depth:
            found[side] = Bearing(face=face, depth=at, outer=outer)
    return found
