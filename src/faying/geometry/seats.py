"""What a bolt presses on beyond the end of a bore: a countersink, or the undersides of the lips of a T-slot."""

from dataclasses import dataclass

import numpy as np

from faying.fe.line import FACING, Line, across
from faying.geometry.bores import FULL_TURN, LEVEL, Bore
from faying.geometry.face_facts import FaceFacts, GeometryFacts
from faying.geometry.seen_along import circle, hits

CONE = 1e-3  # of the radius: how far the points of a face lie from a cone that it counts as
FARTHEST = 4.0  # outer diameters of a seat beyond the end of a bore, up to which lips are sought
COVERED = 0.15  # share of the ring of a seat that lips cover, at least
BALANCED = 0.3  # of the outer radius: how far the middle of what they cover lies from the axis, at most
SHANK = 0.95  # of the radius of a bolt: what must find a free way to the lips
ROOM = 0.5  # bolt diameters behind lips that are free for a nut; a thin one (ISO 4035) is as high
RADII = 4  # circles between the edges of a ring, at which lips are looked for


@dataclass(frozen=True, kw_only=True)
class Countersink:
    """The conical seat round the mouth of a bore: its faces, and the diameter [m] at its wide end."""

    faces: tuple[FaceFacts, ...]
    outer: float


def countersink(facts: GeometryFacts, bore: Bore, *, top: bool) -> Countersink | None:
    """The cone that widens from the end of a bore; None where there is none.

    Args:
        facts: of the geometry.
        bore: the bore.
        top: whether it is the end that lies farther along the axis.
    """
    outwards = bore.axis if top else -bore.axis
    found, area, widest, cone_area = [], 0.0, bore.radius, 0.0
    for number in sorted({other for mine in bore.faces for other in facts.face(bore.part, mine).neighbours}):
        face = facts.face(bore.part, number)
        if face.kind != "other":
            continue
        radius, depth = Line(point=bore.point, axis=outwards).about(facts.triangles(face))
        if np.ptp(depth) <= LEVEL or np.ptp(radius) <= CONE * bore.radius:
            continue
        slope, rest = np.polyfit(depth, radius, 1)
        if slope <= 0 or np.abs(slope * depth + rest - radius).max() > CONE * bore.radius:
            continue
        found.append(face)
        area += face.area
        widest = float(radius.max())
        cone_area = np.pi * (radius.min() + radius.max()) * float(np.hypot(np.ptp(depth), np.ptp(radius)))
    return Countersink(faces=tuple(found), outer=2 * widest) if found and area > FULL_TURN * cone_area else None


def lips(facts: GeometryFacts, bore: Bore, *, top: bool, shank: float, ring: tuple[float, float]) -> list[FaceFacts]:
    """Planes of other parts that a nut or head presses on through an opening beyond the end of a bore; often none.

    The bolt must find a free way along the axis to the nearest of such planes, which look away from the bore, and
    what they cover of the ring of the seat must lie about the axis, with room for a nut behind it.

    Args:
        facts: of the geometry.
        bore: the bore at the end of a row.
        top: whether it is the end that lies farther along the axis.
        shank: diameter of the bolt [m].
        ring: inner and outer diameter of the seat [m].
    """
    outwards = bore.axis if top else -bore.axis
    plane, origin = across(outwards), bore.line.at(bore.high if top else bore.low)
    far = FARTHEST * ring[1]
    faces = [
        face
        for part in facts.parts
        if part.name != bore.part and np.all((origin > np.array(part.low) - far) & (origin < np.array(part.high) + far))
        for face in facts.by_part[part.name]
    ]
    if not faces:
        return []
    arms = np.concatenate([facts.triangles(face) for face in faces]) - origin
    owner = np.repeat(np.arange(len(faces)), [len(facts.triangles(face)) for face in faces])
    flat, depth = arms @ plane, arms @ outwards
    near = (depth.max(axis=1) > LEVEL) & (depth.min(axis=1) < far)
    near &= np.all((flat.min(axis=1) < ring[1] / 2) & (flat.max(axis=1) > -ring[1] / 2), axis=1)
    flat, depth, owner = flat[near], depth[near], owner[near]
    levels = {
        k: float(depth[owner == k].mean()) for k in np.unique(owner).tolist() if faces[k].facing(outwards) > FACING
    }
    points = np.concatenate([circle(r) for r in np.linspace(ring[0] / 2, ring[1] / 2, RADII + 2)[1:-1]])
    over, deep = hits(flat, depth, points)
    way = hits(flat, depth, np.concatenate([np.zeros((1, 2)), circle(SHANK * shank / 2)]))
    for level in sorted({round(level / LEVEL) * LEVEL for level in levels.values()}):
        if not 0 < level < far or np.any(way[0] & (way[1] > LEVEL) & (way[1] < level - LEVEL)):
            continue
        alike = [k for k, one in levels.items() if abs(one - level) <= LEVEL]
        own = np.isin(owner, alike)[:, None]
        covered = np.any(over & own & (np.abs(deep - level) <= 2 * LEVEL), axis=0)
        covered &= ~np.any(over & ~own & (deep > level - 2 * LEVEL) & (deep < level + ROOM * shank), axis=0)
        aside = np.linalg.norm(points[covered].mean(axis=0)) if np.any(covered) else np.inf
        if covered.mean() > COVERED and aside < BALANCED * ring[1] / 2:
            return [faces[k] for k in alike if np.any(over[owner == k] & covered)]
    return []
