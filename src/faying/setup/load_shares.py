"""How the force of each bolt is shared by the joints that it clamps, before anything is solved.

Each of several joints one behind the other carries all of the force. Joints at one depth lie side by side, as on both
sides of a T-slot: pressure falls linearly from the hole to zero at the edge of the cone of VDI 2230, and each
joint has the part of it that lies on its faces.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faying.bolt.bolt import BoltPlace
from faying.bolt.solid_bolt import SolidPlace
from faying.bolt.vdi2230 import cone_angle
from faying.fe.faces import NamedFaces
from faying.fe.line import across
from faying.geometry.seen_along import RING, circle, hits
from faying.joint.load_path import seat_ring
from faying.typing import Array

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
    ring = seat_ring(mesh, place) if isinstance(place, BoltPlace) else None
    if ring is None:
        return np.zeros(len(pairs)), 0.0
    hole, seat = ring
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
