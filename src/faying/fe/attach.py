"""Mean motion of a face: how a bolt's head, a mass or a bearing hangs on an elastic body without stiffening it."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.errors import InputError
from faying.fe.elasticity import unit_motions
from faying.fe.line import across
from faying.fe.overlap import pieces
from faying.fe.sides import Blocks, sampled
from faying.typing import Array


@dataclass(frozen=True, kw_only=True)
class Ring:
    """The part of a face between two radii [m] around an axis: point (3,) [m] on it and direction (3,)."""

    point: Array
    axis: Array
    inner: float
    outer: float

    def covers(self, place: Array) -> Array:
        """1 for places (..., 3) [m] inside the ring, 0 outside."""
        unit = self.axis / np.linalg.norm(self.axis)
        arm = place - self.point
        radius = np.linalg.norm(arm - (arm @ unit)[..., None] * unit, axis=-1)
        return np.asarray((radius >= self.inner) & (radius <= self.outer), dtype=float)

    def area_on(self, points: Array, blocks: Blocks) -> float:
        """Area [m2] of a face inside the ring, seen along the axis; curved edges of elements count as two chords."""
        corners = (pieces(points, blocks).corners - self.point) @ across(self.axis / np.linalg.norm(self.axis))
        ends = np.roll(corners, -1, axis=1)
        return abs(_inside(corners, ends, self.outer) - _inside(corners, ends, self.inner))


def _inside(start: Array, end: Array, radius: float) -> float:
    """Area [m2] inside a circle about the origin of triangles between it and edges (..., 2), against the clock > 0.

    Of each edge the part within the circle makes a triangle, and what is outside on either side of it a sector.
    """

    def cross(one: Array, other: Array) -> Array:
        return np.asarray(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0])

    def sector(one: Array, other: Array) -> Array:
        return np.asarray(radius**2 * np.arctan2(cross(one, other), (one * other).sum(axis=-1)))

    along = end - start
    square = np.maximum((along**2).sum(axis=-1), np.finfo(float).tiny)
    nearest = -(start * along).sum(axis=-1) / square
    half = np.sqrt(np.maximum(nearest**2 - ((start**2).sum(axis=-1) - radius**2) / square, 0.0))
    enters, leaves = (start + np.clip(nearest + sign * half, 0, 1)[..., None] * along for sign in (-1, 1))
    return float((sector(start, enters) + cross(enters, leaves) + sector(leaves, end)).sum() / 2)


@dataclass(frozen=True, kw_only=True)
class DepthBand:
    """The part of a face between two depths [m] along an axis: point (3,) [m] on it and unit direction (3,)."""

    point: Array
    axis: Array
    low: float
    high: float

    def covers(self, place: Array) -> Array:
        """1 for places (..., 3) [m] between the depths, 0 outside."""
        depth = (place - self.point) @ self.axis
        return np.asarray((depth >= self.low) & (depth <= self.high), dtype=float)


def mean_motion(points: Array, blocks: Blocks, at: Array, region: Ring | DepthBand | None = None) -> Any:
    """Sparse operator (6, 3n) from displacements to the mean translation [m] and rotation [rad] of a face about `at`.

    The rigid motion nearest to the face's own in the mean square over its area (or that of a region of it). Its
    transpose spreads a force and a moment at `at` over the face as tractions linear in position. Raises InputError
    where the region meets no point of the face, or all points lie on one line.
    """
    from scipy.sparse import csr_array

    n = len(points)
    gram = np.zeros((6, 6))
    columns, entries = [], []
    for faces, values, place, _, share in sampled(points, blocks):
        weight = share if region is None else share * region.covers(place)
        rigid = unit_motions(place - at)
        gram += np.einsum("fq,fqki,fqkj->ij", weight, rigid, rigid)
        spread = np.einsum("fq,qa,fqki->ifak", weight, values, rigid)
        columns.append((3 * faces[:, :, None] + np.arange(3)).reshape(-1))
        entries.append(spread.reshape(6, -1))
    area = gram[0, 0]
    if area <= 0:
        if not isinstance(region, Ring):
            raise InputError("the length of thread meets nothing of its hole; check it, or refine the mesh there")
        raise InputError(
            f"a ring of {region.outer * 2e3:.4g} mm outer diameter meets nothing of its face; check the point on "
            "the axis, the diameters and the unit, or refine the mesh there"
        )
    size = np.sqrt(max(np.trace(gram[3:, 3:]) / area, 1e-300))
    scale = np.diag([1, 1, 1, 1 / size, 1 / size, 1 / size])
    if np.linalg.cond(scale @ gram @ scale) > 1e10:
        raise InputError(
            "the points of a face are on one line, so that it has no rotation; widen the ring or refine the mesh"
        )
    column, entry = np.concatenate(columns), np.concatenate(entries, axis=1)
    solved = np.linalg.solve(gram, entry)
    rows = np.repeat(np.arange(6), len(column))
    operator = csr_array((solved.ravel(), (rows, np.tile(column, 6))), shape=(6, 3 * n))
    operator.sum_duplicates()
    return operator
