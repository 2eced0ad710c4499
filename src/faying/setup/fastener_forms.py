"""Bodies that have the form of a fastener: stems with or without a head (screws, studs, pins), rings (nuts, washers).

What a body is, its faces say: cylinders about one axis, hexagons, and planes that look along the axis.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from faying.bolt.threads import METRIC, is_tapped, nearest_size
from faying.bolt.vdi2230 import Head
from faying.fe.line import FACING, Line, across
from faying.geometry.bores import Bore, tubes
from faying.geometry.face_facts import FaceFacts, GeometryFacts
from faying.geometry.seen_along import hits
from faying.typing import Array

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
TOUCH = 1e-5  # m: grooves of a thread that are no farther apart follow each other
DRAWN = 0.02  # of its diameter: how far a stem may be from the size that it is drawn as

_Span: TypeAlias = tuple[float, float, float, FaceFacts]  # of a face: where it begins and ends, its radius [m]


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
    corners = facts.corners_of(part)
    line = _axis([*holes, *shafts]) or _axis_of_planes(facts, faces, corners)
    if line is None:
        return None
    arm, depth = line.about(corners)
    flat = (corners - line.point) @ across(line.axis)
    ring = not np.any(hits(flat, depth.reshape(-1, 3), np.zeros((1, 2)))[0])
    whole = [tube for tube in (holes if ring else shafts) if tube.turn > ROUND]
    plain = {n for tube in whole if tube.high - tube.low > SHORT * 2 * tube.radius for n in tube.faces}
    round_it = _threads(facts, [face for face in faces if face.number not in plain], line, inside=ring)
    grooved = {n for thread in round_it for n in thread.faces}
    round_it += [t for t in whole if line.holds(t.line, ASIDE * t.radius) and grooved.isdisjoint(t.faces)]
    long = [tube.radius for tube in round_it if ring or tube.high - tube.low > SHORT * 2 * tube.radius]
    stems = [tube for tube in round_it if ring or (long and tube.radius <= STEM * min(long))]
    radius = (min if ring else max)((tube.radius for tube in stems), default=0.0)
    if not stems or (not ring and arm.max() > SLENDER * radius):
        return None
    own = [hole for hole in holes if hole.turn > ROUND or hole.radius > APART * radius]  # not the round ends of a mark
    if not all(line.holds(hole.line, ASIDE * hole.radius) for hole in own):
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


def _axis_of_planes(facts: GeometryFacts, faces: Sequence[FaceFacts], corners: Array) -> Line | None:
    """The axis of a body with a thread and no cylinder: normal to a plane, in the middle of the plane and the body."""
    for face in faces:
        if face.normal is not None:
            line = Line(point=np.array(face.centre), axis=np.array(face.normal))
            flat = (corners.reshape(-1, 3) - line.point) @ across(line.axis)
            central = np.all(np.abs(flat.max(axis=0) + flat.min(axis=0)) < ASIDE * np.ptp(flat, axis=0))
            if central and any(_threads(facts, faces, line, inside=inside) for inside in (True, False)):
                return line
    return None


def _threads(facts: GeometryFacts, faces: Sequence[FaceFacts], line: Line, *, inside: bool) -> list[Bore]:
    """Threads that are drawn with their grooves, helical or round, as cylinders at their crests.

    They are narrow faces, one behind the other along a line, no deeper than a thread, whose area is at least that of a
    cylinder.

    Args:
        facts: of the geometry.
        faces: of one part, but those of plain cylinders.
        line: the axis.
        inside: whether threads of a hole are sought.
    """
    found = []
    for face in faces:
        tris = facts.triangles(face)
        arm, depth = line.about(tris)
        if face.normal is None and len(tris) and arm.min() >= CORE * arm.max():
            middle = tris.mean(axis=1) - line.point
            normals = np.cross(tris[:, 1] - tris[:, 0], tris[:, 2] - tris[:, 0])
            if (np.sum(normals * (middle - np.outer(middle @ line.axis, line.axis))) < 0) == inside:
                found.append((depth.min(), depth.max(), arm.min() if inside else arm.max(), face))
    out, start = [], line.point @ line.axis
    for run in _runs(sorted(found, key=lambda one: one[0])):
        order = sorted(run, key=lambda one: one[2])
        areas = np.cumsum([one[3].area for one in order])
        radius = float(order[int(np.searchsorted(areas, areas[-1] / 2))][2])  # of most of the area
        own = [one for one in run if (one[2] >= (1 - PLAY) * radius if inside else one[2] <= (1 + PLAY) * radius)]
        low, high = min(one[0] for one in own), max(one[1] for one in own)  # without a fillet or a flange at its end
        if high - low > SHORT * 2 * radius and areas[-1] > ROUND * 2 * np.pi * radius * (high - low):
            out.append(
                Bore(
                    part=run[0][3].part,
                    radius=radius,
                    axis=line.axis,
                    point=line.point,
                    low=float(start + low),
                    high=float(start + high),
                    faces=tuple(one[3].number for one in run),
                )
            )
    return out


def _runs(spans: Iterable[_Span]) -> list[list[_Span]]:
    """Spans in the order of their beginnings, put together where one touches the last."""
    out: list[list[_Span]] = []
    end = -np.inf
    for one in spans:
        if one[0] <= end + TOUCH:
            out[-1].append(one)
        else:
            out.append([one])
        end = max(end, one[1])
    return out


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
