"""The thread that a bolt is screwed into: a round hole, over the length that the bolt engages."""

from dataclasses import dataclass

import numpy as np

from faying.errors import InputError
from faying.fe.sides import Blocks, sampled
from faying.typing import Array
from faying.units import show

ENGAGED = 1.5  # nominal diameters that a bolt engages where the study does not say, or the depth of the hole if less
INSIDE = 0.5  # nominal diameters of the bolt inside its thread that stretch with the shank (VDI 2230, l_G)
ACROSS = 0.2  # of a normal along the axis, up to which a place counts as on the wall of a hole
ASTRAY = 0.02  # share of the area that may not, as on an element that was straightened, for the face to be one
TURNED = 0.2  # share of the normals across their main direction, above which a face is bent round an axis


@dataclass(frozen=True, kw_only=True)
class RoundHole:
    """The wall of a round hole.

    Args:
        point: on the axis (3,) [m].
        axis: unit direction (3,), either way.
        radius: [m].
        low, high: where it begins and ends along the axis, from the point [m].
    """

    point: Array
    axis: Array
    radius: float
    low: float
    high: float

    def seen_from(self, place: Array) -> "RoundHole":
        """The same with its axis away from a place (3,) [m] in front of its mouth, and the point at the mouth."""
        ahead = self.axis if (self.point - place) @ self.axis + (self.low + self.high) / 2 > 0 else -self.axis
        mouth, end = (self.low, self.high) if ahead is self.axis else (-self.high, -self.low)
        return RoundHole(point=self.point + mouth * ahead, axis=ahead, radius=self.radius, low=0.0, high=end - mouth)


def round_hole(points: Array, blocks: Blocks) -> RoundHole | None:
    """The hole whose wall a face is; None for any other face.

    Its normals lie in one plane, across the axis, in more than one direction, and look at the axis.
    """
    places, normals, shares = [], [], []
    for _, _, place, normal, share in sampled(points, blocks):
        places.append(place.reshape(-1, 3))
        normals.append(normal.reshape(-1, 3))
        shares.append(share.ravel())
    place, normal, share = np.concatenate(places), np.concatenate(normals), np.concatenate(shares)
    spread, directions = np.linalg.eigh(np.einsum("q,qi,qj->ij", share, normal, normal) / share.sum())
    axis = directions[:, 0]
    if spread[1] < TURNED or share @ (np.abs(normal @ axis) > ACROSS) > ASTRAY * share.sum():
        return None
    # the axis is nearest to the lines through all places along their normals
    flat = np.eye(3)[None] - normal[:, :, None] * normal[:, None, :]
    along = np.outer(axis, axis)
    left = np.einsum("q,qij->ij", share, flat) + share.sum() * along
    point = np.linalg.solve(left, np.einsum("q,qij,qj->i", share, flat, place) + along @ (share @ place))
    arm = place - point
    arm = arm - np.outer(arm @ axis, axis)
    radius = np.linalg.norm(arm, axis=1)
    if np.ptp(radius) > 0.2 * radius.mean() or np.average(np.einsum("qi,qi->q", arm, normal), weights=share) > 0:
        return None
    corners = points[np.unique(np.concatenate([block.ravel() for block in blocks]))]
    depth = (corners - point) @ axis
    return RoundHole(
        point=point, axis=axis, radius=float(radius.mean()), low=float(depth.min()), high=float(depth.max())
    )


def engaged_length(given: float | None, hole: RoundHole, diameter: float, name: str) -> float:
    """The length [m] that a bolt of a diameter [m] engages in a hole: as given, or 1.5 diameters, at most the depth.

    Raises InputError where more is given than the hole is deep.
    """
    depth = hole.high - hole.low
    if given is None:
        return min(ENGAGED * diameter, depth)
    if given > depth * (1 + 1e-6):
        raise InputError(
            f"bolt {name!r}: engaged = {show(given, 'm')}, but its hole is {show(depth, 'm')} deep; give less"
        )
    return given
