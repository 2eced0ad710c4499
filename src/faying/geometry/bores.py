"""Holes through parts, and rows of holes on one axis through several parts: where bolts go."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from faying.fe.line import FACING, Line
from faying.fe.outline import edges_of
from faying.geometry.face_facts import FaceFacts, GeometryFacts
from faying.geometry.face_triangles import welded
from faying.typing import Array

FULL_TURN = 0.95  # share of a turn from which the faces of a bore close
AXIS_OFFSET = 0.2  # of the radius: axes that lie farther apart are two
ROOM = 1.3  # hole diameters that a nut and a head take, 0.8 and 0.64 diameters of their bolt (ISO 4032, ISO 4014)
LEVEL = 1e-6  # m: within which a plane begins where a bore ends


@dataclass(frozen=True, kw_only=True, eq=False)
class Bore:
    """A round hole in a part, or a round shaft; two are the same only where they are one object.

    Args:
        part: the part.
        radius: [m].
        axis: unit direction (3,).
        point: on the axis (3,) [m].
        low, high: where it begins and ends, measured along the axis from the origin [m].
        faces: numbers of its faces.
        turn: the share of a whole turn that its faces go round [-].
        slot: of a slotted hole, from the axis of one end to that of the other (3,) [m]; its radius is half its width,
            and its point lies half-way.
    """

    part: str
    radius: float
    axis: Array
    point: Array
    low: float
    high: float
    faces: tuple[int, ...]
    turn: float = 1.0
    slot: Array | None = None

    @property
    def sides(self) -> frozenset[tuple[str, int]]:
        """Part and number of its faces."""
        return frozenset((self.part, number) for number in self.faces)

    @property
    def line(self) -> Line:
        """The axis; depths along it are from the origin."""
        return Line(point=self.point - (self.point @ self.axis) * self.axis, axis=self.axis)


@dataclass(frozen=True, kw_only=True, eq=False)
class Stack:
    """Bores of different parts on one axis, from low to high; in each part the narrowest.

    Where a part has several, as a tube has in its two walls, or a fork, they are one from the first to the last.
    """

    bores: tuple[Bore, ...]

    @property
    def ends(self) -> tuple[Bore, Bore]:
        """The bores that begin first and end last."""
        return self.bores[0], max(self.bores, key=lambda bore: bore.high)

    @property
    def parts(self) -> tuple[str, ...]:
        """The parts, from low to high."""
        return tuple(bore.part for bore in self.bores)

    @property
    def axis(self) -> Array:
        """Unit direction (3,)."""
        return self.bores[0].axis

    @property
    def middle(self) -> Array:
        """The point of the axis (3,) [m] in the middle of the stack: on the axis of a round hole, if there is one."""
        round_ones = [bore for bore in self.bores if bore.slot is None]
        return (round_ones or self.bores)[0].line.at((self.ends[0].low + self.ends[1].high) / 2)


def tubes(faces: Sequence[FaceFacts], *, hole: bool) -> list[Bore]:
    """The cylinders of a part, holes or shafts; halves and quarters of one are put together."""
    out = []
    left = [face for face in faces if face.hole is hole and face.radius]
    while left:
        first = left[0]
        line = first.line
        line = replace(line, point=line.at(float(-line.point @ line.axis)))  # its depths are from the origin
        same = [face for face in left if _one_cylinder(first, face)]
        left = [face for face in left if face not in same]
        spans = [line.span(face.line, 0.0, face.length or 0.0) for face in same]
        low, high = min(a for a, _ in spans), max(b for _, b in spans)
        turned = sum((face.turn or 0.0) * (b - a) for face, (a, b) in zip(same, spans, strict=True))
        out.append(
            Bore(
                part=first.part,
                radius=first.radius or 0.0,
                axis=line.axis,
                point=first.line.point,
                low=low,
                high=high,
                faces=tuple(face.number for face in same),
                turn=turned / (high - low) if high > low else 0.0,
            )
        )
    return out


def bores(facts: GeometryFacts) -> list[Bore]:
    """The holes of all parts, round or slotted."""
    out = []
    for part, faces in facts.by_part.items():
        found = tubes(faces, hole=True)
        out += [bore for bore in found if bore.turn >= FULL_TURN]
        out += _slots(facts, part, [bore for bore in found if abs(bore.turn - 0.5) < 1 - FULL_TURN])
    return out


def _slots(facts: GeometryFacts, part: str, halves: Sequence[Bore]) -> list[Bore]:
    """Slotted holes: two half cylinders of one radius and one length, joined by two planes along their axes."""
    out: list[Bore] = []
    used: set[int] = set()
    for one, two in combinations(halves, 2):
        axis = one.axis
        arm = two.point - one.line.at(float(two.point @ axis))
        ends = one.line.span(two.line, two.low, two.high)
        alike = abs(axis @ two.axis) >= FACING and abs(one.radius - two.radius) <= 1e-4 * one.radius
        level = max(abs(ends[0] - one.low), abs(ends[1] - one.high)) <= LEVEL
        near = [{number for face in half.faces for number in facts.face(part, face).neighbours} for half in (one, two)]
        planes = [face for number in near[0] & near[1] if (face := facts.face(part, number)).normal is not None]
        sides = sum(abs(face.facing(axis)) < 1e-3 for face in planes)
        if used & {*one.faces, *two.faces} or not alike or not level or sides < 2 or not np.any(arm):
            continue
        used |= {*one.faces, *two.faces}
        out.append(replace(one, point=one.point + arm / 2, faces=(*one.faces, *two.faces), turn=1.0, slot=arm))
    return out


def rows(found: Sequence[Bore], *, reach: float) -> list[Stack]:
    """Rows of bores on one axis, those of a single part among them.

    Args:
        found: the bores of all parts.
        reach: distance between the end of one and the beginning of the next up to which they belong together [m]; two
            diameters of the hole, if that is more, as across the gap between raised faces.
    """
    out = []
    left = sorted(found, key=lambda bore: bore.slot is not None)  # a slot belongs to the round hole in its reach
    while left:
        first = left[0]
        line = [bore for bore in left if on_one_axis(first, bore)]
        left = [bore for bore in left if bore not in line]
        narrow = [_narrowest([bore for bore in line if bore.part == part]) for part in {bore.part: 0 for bore in line}]
        row: list[Bore] = []
        for bore in sorted(narrow, key=lambda bore: bore.low):
            before = [one.high for one in line if one.part in [some.part for some in row]]
            gap = min(one.low for one in line if one.part == bore.part) - max(before, default=np.inf)
            if gap > max(reach, 4 * bore.radius):
                out += _apart(row)
                row = []
            row.append(bore)
        out += _apart(row)
    return out


def _narrowest(alike: Sequence[Bore]) -> Bore:
    """The narrowest of the bores of a part on one axis; several of one radius are one from the first to the last."""
    least = min(bore.radius for bore in alike)
    thin = [bore for bore in alike if bore.radius <= least * (1 + 1e-4)]
    if len(thin) == 1:
        return thin[0]
    low, high = min(bore.low for bore in thin), max(bore.high for bore in thin)
    return replace(thin[0], low=low, high=high, faces=tuple(number for bore in thin for number in bore.faces))


def _apart(row: Sequence[Bore]) -> list[Stack]:
    """A row in two where it has room for a nut and a head in the middle, and two parts or more on either side."""
    for k in range(2, len(row) - 1):
        gap = row[k].low - max(bore.high for bore in row[:k])
        if gap > ROOM * 2 * row[k].radius:
            return [*_apart(row[:k]), *_apart(row[k:])]
    return [Stack(bores=tuple(row))]


def seat(facts: GeometryFacts, bore: Bore, *, top: bool) -> FaceFacts | None:
    """The plane at the end of a bore that head or nut press on; None where there is none.

    Args:
        facts: of the geometry.
        bore: the bore of the first or last part.
        top: whether it is the end that lies farther along the axis.
    """
    outwards = bore.axis if top else -bore.axis
    depth = bore.high if top else bore.low
    neighbours = {other for number in bore.faces for other in facts.face(bore.part, number).neighbours}
    past_chamfer = {other for number in neighbours for other in facts.face(bore.part, number).neighbours}
    near = neighbours | past_chamfer
    fitting = []
    for number in near:
        face = facts.face(bore.part, number)
        level = (np.array(face.centre) - bore.line.at(depth)) @ outwards
        if face.facing(outwards) >= FACING and -LEVEL <= level <= bore.radius:
            fitting.append((number not in neighbours, level, number))
    return facts.face(bore.part, min(fitting)[2]) if fitting else None


def room_around(facts: GeometryFacts, face: FaceFacts, bore: Bore) -> float:
    """Distance [m] from the axis of a bore to the nearest edge of a plane around it, the edge of the bore aside."""
    points, triangles = welded(facts.triangles(face), 1e-9)
    edges, first, last = edges_of(triangles)
    rim = points[edges[first == last]]
    start, along = rim[:, 0], rim[:, 1] - rim[:, 0]
    point = bore.point + ((np.array(face.centre) - bore.point) @ bore.axis) * bore.axis
    share = np.clip(np.einsum("ei,ei->e", point - start, along) / np.einsum("ei,ei->e", along, along), 0.0, 1.0)
    away = np.linalg.norm(start + share[:, None] * along - point, axis=1)
    ends = np.linalg.norm(rim - point, axis=2)
    if bore.slot is not None:
        shift = np.clip((rim - point) @ bore.slot / (bore.slot @ bore.slot), -0.5, 0.5)
        ends = np.linalg.norm(rim - point - shift[..., None] * bore.slot, axis=2)
    own = np.all(ends < 1.001 * ends.min(), axis=1)  # the edge of the bore, or of its chamfer
    return float(away[~own].min()) if np.any(~own) else np.inf


def _one_cylinder(one: FaceFacts, two: FaceFacts) -> bool:
    radius, other = one.radius or 0.0, two.radius or 0.0
    if abs(radius - other) > 1e-4 * radius or not one.line.holds(two.line, 1e-3 * radius):
        return False
    low, high = one.line.span(two.line, 0.0, two.length or 0.0)
    return low <= (one.length or 0.0) + LEVEL and high >= -LEVEL


def on_one_axis(one: Bore, two: Bore) -> bool:
    """Whether one bolt may run through two bores."""
    point = two.point
    for slot in (one.slot, two.slot):
        if slot is not None:  # a bolt may stand anywhere between the ends of a slot
            point = point - float(np.clip((point - one.point) @ slot / (slot @ slot), -0.5, 0.5)) * slot
    return Line(point=one.point, axis=one.axis).holds(
        Line(point=point, axis=two.axis), AXIS_OFFSET * min(one.radius, two.radius)
    )
