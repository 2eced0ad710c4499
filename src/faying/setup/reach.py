"""How far the laws of a study reach beside the pressures that its bolts will make.

How the force of each bolt is shared by the joints that it clamps, before anything is solved.

Each of several joints one behind the other carries all of the force. Joints at one depth lie side by side, as on both
sides of a T-slot: pressure falls linearly from the hole to zero at the edge of the cone of VDI 2230, and each
joint has the part of it that lies on its faces.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import pi
from typing import Any, Literal

import numpy as np

from faying.bolt.bolt import BoltPlace
from faying.bolt.solid_bolt import SolidPlace
from faying.bolt.vdi2230 import cone_angle, cone_pressure
from faying.contact.build import AUTO
from faying.contact.law import ContactLaw
from faying.contact.mates import line_of
from faying.contact.models.half_space import HalfSpace
from faying.errors import FayingError, InputError
from faying.fe.line import across
from faying.fe.sides import NamedFaces
from faying.form.face_axes import FaceAxes
from faying.geometry.mesh_facts import nearest_places
from faying.geometry.seen_along import RING, circle, hits
from faying.joint.joint_law import JointLaw
from faying.joint.load_path import BoltLine
from faying.materials import Material
from faying.setup.sketch import Sketch
from faying.study.keys.joint import JointChoice
from faying.study.keys.surface import Surface
from faying.typing import Array
from faying.units import show, show_area

RADII = 40  # circles between the hole and the edge of the cone
WIDE = 2.5  # diameters of the seat: the outer diameter of the parts that the angle of the cone is taken for
LEVEL = 0.05  # of the clamped length: joints that differ by less in depth lie side by side


@dataclass(frozen=True, kw_only=True)
class Share:
    """What a joint has of the force of a bolt.

    Args:
        place: the bolt.
        depth: of the joint below the head [m].
        share: of the force [-].
        rise: pressure over that of a joint which covers the cone [-].
    """

    place: BoltPlace | SolidPlace
    depth: float
    share: float = 1.0
    rise: float = 1.0


def load_shares(
    mesh: NamedFaces,
    faces: Mapping[str, tuple[str, str]],
    through: Mapping[str, Sequence[tuple[BoltPlace | SolidPlace, float]]],
    areas: Mapping[str, float],
) -> dict[str, list[Share]]:
    """Share the force of each bolt among the joints that it clamps.

    Args:
        mesh: the named faces as triangles.
        faces: joint -> its two faces.
        through: joint -> the bolts that clamp it, with its depth below the head [m].
        areas: joint -> area over which its faces meet [m2]; shares go by it where a bolt has no cone.
    """
    out: dict[str, list[Share]] = {name: [] for name in faces}
    bolts = {id(place): place for some in through.values() for place, _ in some}
    for key, place in bolts.items():
        depths = {name: depth for name, some in through.items() for one, depth in some if id(one) == key}
        left = sorted(depths, key=lambda name: depths[name])
        while left:
            level = [name for name in left if depths[name] - depths[left[0]] <= LEVEL * place.length]
            left = left[len(level) :]
            if len(level) == 1:
                out[level[0]].append(Share(place=place, depth=depths[level[0]]))
                continue
            weights, cone = _weights(mesh, place, [faces[name] for name in level], depths[level[0]])
            total = weights.sum()
            known = total > 0
            parts = weights / total if known else np.array([areas[name] for name in level])
            for name, part in zip(level, parts / parts.sum(), strict=True):
                rise = cone / total if known else 1.0
                out[name].append(Share(place=place, depth=depths[name], share=float(part), rise=float(rise)))
    return out


def _weights(
    mesh: NamedFaces, place: BoltPlace | SolidPlace, pairs: Sequence[tuple[str, str]], depth: float
) -> tuple[Array, float]:
    """Integral of the pressure of a bolt over each joint, 1 at its hole [m2] (j,), and over its cone."""
    if isinstance(place, SolidPlace) or not place.pressed[0].is_ring:
        return np.zeros(len(pairs)), 0.0
    hole, seat = place.pressed[0].diameters
    near = min(depth, place.length - depth)
    wide = seat + 2 * near * max(cone_angle(place.length, seat, WIDE * seat), 0.0)
    step = (wide - hole) / 2 / RADII
    radii = hole / 2 + step * (np.arange(RADII) + 0.5)
    points = np.concatenate([circle(radius) for radius in radii])
    weight = np.repeat((1 - (radii - hole / 2) / ((wide - hole) / 2)) * 2 * np.pi * radii * step / RING, RING)
    plane = across(place.axis)
    covered = [np.all([_over(mesh, face, place.point, plane, points) for face in pair], axis=0) for pair in pairs]
    return np.array([float(weight @ one) for one in covered]), float(weight.sum())


def _over(mesh: NamedFaces, face: str, point: Array, plane: Array, points: Array) -> Array:
    """Whether a face lies over points (p, 2) across an axis (p,)."""
    corners = np.concatenate([mesh.points[rows[:, :3]] for rows in mesh.face(face)])
    flat = (corners - point) @ plane
    reach = np.abs(points).max()
    flat = flat[np.all((flat.min(axis=1) <= reach) & (flat.max(axis=1) >= -reach), axis=1)]
    return np.asarray(np.any(hits(flat, np.zeros(flat.shape[:2]), points)[0], axis=0))


Line = tuple[Literal["ok", "note", "fault"], str, str, str]


def law_findings(sketch: Sketch, surfaces: Sequence[Surface]) -> Iterator[Line]:
    """Level, code, text and key of what there is to say of the law of each joint; nothing without surfaces."""
    study = sketch.study
    if not surfaces:
        return
    through = {joint.name: _through(sketch, joint) for joint in study.joints}
    areas = {joint.name: sum(c.area for c in sketch.contacts(joint.faces)) for joint in study.joints}
    pairs = {joint.name: joint.faces for joint in study.joints}
    shares = load_shares(sketch.mesh, pairs, through, areas)
    for joint, surface in zip(study.joints, surfaces, strict=True):
        at = f"joint[{joint.number}].law" if joint.law is not None else "law"
        parts = [sketch.mesh.face_part[face] for face in joint.faces]
        rough, other = (sketch.materials[part] for part in parts)
        try:
            reach, name, law = law_reach(sketch, joint, surface, rough, other)
        except FayingError as fault:
            yield "fault", "law", f"joint {joint.name!r}: {fault}", at
            continue
        if surface.faces is not None:
            pair = study.law_of(joint).pair(rough, other)
            yield "ok", "mates", f"joint {joint.name!r}: {line_of(surface.faces, pair)}", at
        yield from _beside(sketch, shares[joint.name], joint, reach, name, law)
        yield from _form(sketch, joint.number, joint, surface)


def _form(sketch: Sketch, k: int, joint: JointChoice, surface: Surface) -> Iterator[Line]:
    """A form that does not fit the face, which a run refuses in the same words."""
    if joint.form is None:
        return
    try:
        pieces = sketch.mesh.pieces(joint.faces[0])
        axes = FaceAxes.of(sketch.mesh, joint.faces, pieces, joint.form.along)
        joint.form.with_scan(surface.waves).laid(axes)
    except InputError as fault:
        yield "fault", "form", f"joint {joint.name!r}: {fault}", f"joint[{k}].form"


def law_reach(
    sketch: Sketch, joint: JointChoice, surface: Surface, rough: Material, other: Material
) -> tuple[float | None, str, ContactLaw | None]:
    """Pressure [Pa] at which the law of a joint ends, None where only the solved contact tells; its name; the law.

    A contact that is solved on the scan is not solved here, so that there is no law yet; a pair that yields ends it at
    a share of the hardness. Raises InputError where the law cannot be made, or has no stiffness.
    """
    choice = sketch.study.law_of(joint)
    pair = choice.pair(rough, other)
    scan = None if surface.rough is None else surface.rough.scan
    solved = choice.kind.label == AUTO
    if scan is not None and (solved or choice.kind.law is HalfSpace):
        if not np.isfinite(pair.hardness):
            return None, "half-space", None
        given: dict[str, Any] = {} if solved else dict(choice.given)
        return HalfSpace(scan=scan, pair=pair, **given).pressure_ends[1], "half-space", None
    made = choice.make(surface, rough, other)
    law = JointLaw(model=made.law, tangential=joint.tangential, nu=rough.nu)
    law.check()
    return made.law.greatest_pressure, made.law.name, made.law


def _beside(
    sketch: Sketch, bolts: Sequence[Share], joint: JointChoice, reach: float | None, name: str, law: ContactLaw | None
) -> Iterator[Line]:
    """The mean and the rim pressure of a joint at the greatest preload beside the reach of its law."""
    key = f"joint[{joint.number}].faces"
    area = sum(contact.area for contact in sketch.contacts(joint.faces))
    if not area:
        return
    seated = sum(
        _greatest(sketch, place)
        for place in sketch.fitted_bolts
        if isinstance(place, SolidPlace) and {*place.bolt.faces} & {*joint.faces}
    )
    force = seated + sum(one.share * _greatest(sketch, one.place) for one in bolts)
    if not force:
        text = f"joint {joint.name!r}: no bolt runs through it; only the parts' bending can press it together"
        yield "note", "unclamped", text, key
        return
    mean = force / area
    if law is not None and law.least_pressure <= mean <= law.greatest_pressure:
        for reason, mask in law.at_pressure(mean).reasons.items():
            if np.any(mask):
                text = f"joint {joint.name!r}: {name} is outside its validity range at the mean pressure: {reason}"
                yield "note", "validity", text, key
    rims = [
        tuple(one.rise * pressure for pressure in pressures)
        for one in bolts
        if (pressures := _rim(sketch, one, area / len(bolts))) is not None
    ]
    text = f"joint {joint.name!r}: {show(force, 'N')} on {show_area(area)} press {show(mean, 'Pa', digits=3)} on it"
    highest = mean
    if rims:
        cone, highest = (max(column) for column in zip(*rims, strict=True))
        text += f" on average, about {show(cone, 'Pa', digits=3)} under a bolt and {show(highest, 'Pa', digits=3)} "
        text += "at its hole (cone of VDI 2230)"
    if reach is None:
        yield "ok", "pressure", f"{text}; how far {name} reaches is known once it is solved", key
        return
    end = show(reach, "Pa", digits=3)
    if mean > reach:
        remedy = "lower the preload, widen the joint, or take a law that reaches further (`faying models`)"
        yield "note", "law-reach", f"{text}; {name} ends at {end}, below the mean: {remedy}", key
    elif highest > reach:
        bounds = "the result gives bounds where the pressure is higher"
        yield "note", "law-reach", f"{text}; {name} ends at {end}: {bounds}", key
    else:
        yield "ok", "pressure", f"{text}; {name} reaches {end}", key


def _greatest(sketch: Sketch, place: BoltPlace | SolidPlace) -> float:
    """The greatest force [N] of a bolt."""
    return max(sketch.study.bolt_forces[place.bolt.name])


def _through(sketch: Sketch, joint: JointChoice) -> list[tuple[BoltPlace | SolidPlace, float]]:
    """The bolts that pass a joint, with the depth [m] of the joint below the head."""
    parts = [sketch.mesh.face_part[face] for face in joint.faces]
    corners = [np.concatenate([sketch.mesh.points[rows[:, :3]] for rows in sketch.mesh.face(f)]) for f in joint.faces]
    out: list[tuple[BoltPlace | SolidPlace, float]] = []
    for place in sketch.fitted_bolts:
        if place.bolt.part in parts:
            continue  # its own seats carry all of its force
        line = BoltLine.of(sketch.mesh, place)
        depths = [_passed_at(line, one) for one in corners]
        if all(len(some) for some in depths):
            out.append((place, float(np.concatenate(depths).mean())))
    return out


def _passed_at(line: BoltLine, corners: Array) -> Array:
    """Depths [m] below the head at which a bolt passes triangles (t, 3, 3): where each is nearest to the axis."""
    plane = across(line.axis)
    flat = (corners - line.seats[0]) @ plane
    weights, _ = nearest_places(np.zeros(3), np.pad(flat, ((0, 0), (0, 0), (0, 1))))
    nearest = np.einsum("tc,tcx->tx", weights, corners)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 1])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), np.finfo(float).tiny)[:, None]
    return line.depth(nearest[line.passes(nearest, normals)])


def _rim(sketch: Sketch, one: Share, mine: float) -> tuple[float, float] | None:
    """Mean pressure [Pa] in the cone of a bolt, and that at its hole; None where head and nut press no ring.

    mine: its share of the area of a joint that alone takes its force [m2]; of several the cone is as wide as it will.
    """
    place = one.place
    if isinstance(place, SolidPlace) or not place.pressed[0].is_ring:
        return None
    hole, seat = place.pressed[0].diameters
    near = min(one.depth, place.length - one.depth)
    outer = max(2 * float(np.sqrt(mine / pi + (hole / 2) ** 2)), seat) if one.share == 1 else WIDE * seat
    try:
        force = _greatest(sketch, place)
        return cone_pressure(force, depth=near, length=place.length, seat=seat, hole=hole, outer=outer)
    except FayingError:
        return None
