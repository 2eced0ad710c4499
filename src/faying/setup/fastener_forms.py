"""Bodies that have the form of a fastener: stems with or without a head (screws, studs, pins), rings (nuts, washers).

What a body is, its faces say: cylinders about one axis, hexagons, and planes that look along the axis.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

from faying.bolt.compliance import Head
from faying.bolt.standards import METRIC, is_tapped, nearest_size
from faying.geometry.face_facts import FACING, FaceFacts, GeometryFacts
from faying.geometry.seen_along import across, hits
from faying.typing import Array

SLENDER = 3.0  # radii of its stem, beyond which a body with a stem is no fastener, but a spigot, say
STEM = 1.4  # over the narrowest stem, up to which a cylinder is a stem, too: nominal over core diameter of M1.6 is 1.37
WIDER = 1.2  # over the stem, from which a body is a head there
SHORT = 0.3  # of its diameter: a cylinder that is shorter is no stem, but a point or a collar
ROUND = 0.6  # share of its full area that a cylinder has at least: a key or a hole across may cut it
CLOSED = 0.97  # the same of a washer, below which it is split, as a spring washer is
ASIDE = 1e-2  # of its radius: how far the axis of a cylinder of a fastener is from that of the fastener
FLATS = 6  # sides of a hexagon
THIN = 0.35  # of its hole: what a washer is thick at most; ISO 7089 has 0.2, spring washers 0.3
LARGE = 3.2  # of its hole: what a washer is wide at most; large ones of ISO 7093 have 3
PLAY = 0.01  # of the radius: what a nut or a thread is wider than a stem at most
CORE = 0.7  # of the radius of a stem: the narrowest hole of its nut or thread; ISO 724 has 0.73 for M1.6
NUT = 1.3, 2.5  # stem diameters: the farthest that a nut reaches from the axis, and how long it is at most
DRAWN = 0.02  # of its diameter: how far a stem may be from the size that it is drawn as


@dataclass(frozen=True, kw_only=True)
class Line:
    """An axis: a point (3,) [m] on it, its unit direction (3,)."""

    point: Array
    axis: Array

    def about(self, points: Array) -> tuple[Array, Array]:
        """How far points (..., 3) [m] lie from the axis, and how far along it from its point [m]."""
        arm = points.reshape(-1, 3) - self.point
        depth = arm @ self.axis
        return np.linalg.norm(arm - np.outer(depth, self.axis), axis=1), depth

    def span(self, line: "Line", low: float, high: float) -> tuple[float, float]:
        """Where a part of another line begins and ends along this one [m]."""
        ends = self.about(np.stack([line.point + low * line.axis, line.point + high * line.axis]))[1]
        return float(ends.min()), float(ends.max())

    def holds(self, line: "Line", aside: float) -> bool:
        """Whether another line is this one, no farther away than `aside` [m]."""
        return bool(abs(self.axis @ line.axis) > FACING and self.about(line.point)[0][0] <= aside)

    @property
    def reversed(self) -> "Line":
        """The same the other way."""
        return Line(point=self.point, axis=-self.axis)


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

    @property
    def stem(self) -> tuple[float, float]:
        """Where the stem begins and ends."""
        return min(low for _, low, _ in self.stems), max(high for _, _, high in self.stems)

    @property
    def is_washer(self) -> bool:
        """Whether it is a flat ring about a hole."""
        return (
            self.ring
            and self.flats is None
            and self.length <= THIN * self.diameter
            and self.reach <= LARGE * self.radius
        )

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


def forms(facts: GeometryFacts) -> Iterator[FastenerForm]:
    """The bodies that have the form of a fastener."""
    for part in facts.parts:
        found = _form(facts, part.name, part.volume)
        if found is not None:
            yield found


def _form(facts: GeometryFacts, part: str, volume: float) -> FastenerForm | None:
    faces = facts.by_part[part]
    line = _axis(faces)
    if line is None:
        return None
    corners = {face.number: facts.triangles(face) for face in faces}
    about = {number: line.about(some) for number, some in corners.items()}
    reach = max(float(arm.max()) for arm, _ in about.values())
    low, high = (float(end([end(depth) for _, depth in about.values()])) for end in (np.min, np.max))
    every = np.concatenate(list(corners.values()))
    middle = hits((every - line.point) @ across(line.axis), (every - line.point) @ line.axis, np.zeros((1, 2)))[0]
    ring = not np.any(middle)
    tubes = _cylinders(faces, line, hole=ring)
    stems = tubes if ring else _stems(tubes)
    if not stems or (not ring and reach > SLENDER * max(radius for radius, *_ in stems)):
        return None
    if any(face.hole and not line.holds(line_of(face), ASIDE * (face.radius or 0.0)) for face in faces):
        return None  # a part with holes for others
    radius = min(one[0] for one in stems) if ring else max(one[0] for one in stems)
    head = 0
    if not ring:
        ends = min(one[1] for one in stems), max(one[2] for one in stems)
        wide = np.concatenate([depth[arm > WIDER * radius] for arm, depth in about.values()])
        if np.any((wide > ends[0] + SHORT * radius) & (wide < ends[1] - SHORT * radius)):
            return None  # a collar between two stems
        sides = np.any(wide <= ends[0] + SHORT * radius), np.any(wide >= ends[1] - SHORT * radius)
        head = int(sides[1]) - int(sides[0])
    flats = _flats(faces, line)
    return FastenerForm(
        part=part,
        line=line,
        low=low,
        high=high,
        ring=ring,
        radius=radius,
        reach=reach,
        flats=flats,
        stems=tuple(one[:3] for one in stems),
        round_head=any(one[0] > WIDER * radius for one in tubes),
        head=head,
        bearings=dict(_bearings(faces, line, about, 0.0 if ring else radius, flats)),
        split=ring and min(one[3] for one in stems) < CLOSED,
        volume=volume,
    )


def line_of(face: FaceFacts) -> Line:
    """The axis of a cylinder."""
    return Line(point=np.array(face.start), axis=np.array(face.axis))


def _axis(faces: Sequence[FaceFacts]) -> Line | None:
    """The axis that most of the area of a body's cylinders is round."""
    found: list[tuple[Line, float]] = []
    for face in faces:
        if face.kind != "cylinder":
            continue
        line = line_of(face)
        near = [k for k, (one, _) in enumerate(found) if one.holds(line, 1e-3 * (face.radius or 0.0))]
        if near:
            found[near[0]] = (found[near[0]][0], found[near[0]][1] + face.area)
        else:
            found.append((line, face.area))
    return max(found, key=lambda one: one[1])[0] if found else None


def _cylinders(faces: Sequence[FaceFacts], line: Line, *, hole: bool) -> list[tuple[float, float, float, float]]:
    """Radius, begin, end and share of the full area of the cylinders about a line, those of one radius together."""
    found: dict[float, list[FaceFacts]] = {}
    for face in faces:
        if face.kind != "cylinder" or face.hole is not hole or face.radius is None:
            continue
        if line.holds(line_of(face), ASIDE * face.radius):
            same = next((radius for radius in found if abs(radius - face.radius) < 1e-4 * radius), face.radius)
            found.setdefault(same, []).append(face)
    out = []
    for radius, some in found.items():
        spans = [line.span(line_of(face), 0.0, face.length or 0.0) for face in some]
        low, high = min(span[0] for span in spans), max(span[1] for span in spans)
        share = sum(face.area for face in some) / (2 * pi * radius * (high - low))
        if share > ROUND:
            out.append((radius, low, high, share))
    return out


def _stems(tubes: Sequence[tuple[float, float, float, float]]) -> list[tuple[float, float, float, float]]:
    """Of the outer cylinders of a body, those of its shank and its thread."""
    long = [radius for radius, low, high, _ in tubes if high - low > SHORT * 2 * radius]
    return [one for one in tubes if long and one[0] <= STEM * min(long)]


def _flats(faces: Sequence[FaceFacts], line: Line) -> float | None:
    """Width [m] across the flats of a hexagon that looks away from a line; None without one."""
    away = []
    for face in faces:
        if face.normal is None or abs(np.array(face.normal) @ line.axis) > 1e-3:
            continue
        away.append(float((np.array(face.centre) - line.point) @ np.array(face.normal)))
    widths = [one for one in away if one > 0 and sum(abs(one - other) < 1e-3 * one for other in away) == FLATS]
    return 2 * max(widths) if widths else None


def _bearings(
    faces: Sequence[FaceFacts], line: Line, about: dict[int, tuple[Array, Array]], radius: float, flats: float | None
) -> Iterator[tuple[int, Bearing]]:
    """The planes of a body that look back and ahead along a line and reach beyond a radius [m], the outermost ones."""
    for side in (-1, 1):
        fitting = []
        for face in faces:
            arm, depth = about[face.number]
            if face.normal is None or side * (np.array(face.normal) @ line.axis) < FACING or arm.max() <= 1.05 * radius:
                continue
            outer = 2 * float(arm.max())
            if flats is not None and abs(outer * 3**0.5 / 2 - flats) < 1e-2 * flats:  # the corners of the hexagon
                outer = flats
            fitting.append(Bearing(face=face, depth=float(depth.mean()), outer=outer))
        if fitting:
            yield side, max(fitting, key=lambda one: side * one.depth)
