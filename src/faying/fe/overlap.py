"""Where the element faces of two surfaces overlap: convex polygons, cut into triangles with points of quadrature.

Between faces whose meshes do not match, shape functions have kinks along the edges of both. Each overlap of one element
face with another holds none, so that points inside it integrate exactly. Each element face of the first surface is cut
in its own plane, on which those of the second are projected along its normal (segment-to-segment integration, M.A. Puso
and T.A. Laursen, Comput. Methods Appl. Mech. Eng. 193 (2004) 601-629, doi:10.1016/j.cma.2003.10.010).
"""

from dataclasses import dataclass

import numpy as np

from faying.fe.elements import FACES, KINDS
from faying.fe.sides import Blocks
from faying.typing import Array, Index


@dataclass(frozen=True, kw_only=True)
class Pieces:
    """Convex pieces of element faces.

    Corners (p, 4, 3), a triangle's last one twice, and block and number of the face.
    """

    corners: Array
    block: Index
    face: Index

    @property
    def centres(self) -> Array:
        """Middle of the corners (p, 3)."""
        return np.asarray(self.corners.mean(axis=1))

    @property
    def radii(self) -> Array:
        """Largest distance of a corner from the centre (p,)."""
        return np.asarray(np.linalg.norm(self.corners - self.centres[:, None], axis=2).max(axis=1))


def pieces(points: Array, blocks: Blocks) -> Pieces:
    """Element faces with straight edges whole, others in pieces between corners and middle nodes."""
    corners, block, face = [], [], []
    for number, faces in enumerate(blocks):
        kind = FACES[faces.shape[1]]
        where = points[faces]
        bent = np.zeros(len(faces), dtype=bool)
        if kind.count > kind.corners:
            ends = where[:, np.array(kind.edges)]
            sag = np.linalg.norm(where[:, kind.corners :] - ends.mean(axis=2), axis=2)
            bent = (sag > 1e-6 * np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2)).any(axis=1)
        straight = FACES[kind.corners].pieces
        for some, cuts in ((~bent, straight), (bent, kind.pieces)):
            for cut in cuts:
                corners.append(where[some][:, cut])
                face.append(np.flatnonzero(some))
                block.append(np.full(np.count_nonzero(some), number))
    return Pieces(corners=np.concatenate(corners), block=np.concatenate(block), face=np.concatenate(face))


def _near(first: Pieces, second: Pieces, search_distance: float) -> tuple[Index, Index]:
    """Pairs of pieces that lie near enough to overlap; the second ones are searched size by size."""
    from scipy.spatial import cKDTree

    radii = second.radii
    octave = np.floor(np.log2(radii / radii.min())).astype(int)
    left, right = [], []
    for size in np.unique(octave):
        some = np.flatnonzero(octave == size)
        lists = cKDTree(second.centres[some]).query_ball_point(
            first.centres, first.radii + radii[some].max() + search_distance, return_sorted=True
        )
        counts = np.array([len(one) for one in lists])
        left.append(np.repeat(np.arange(len(lists)), counts))
        right.append(some[np.concatenate([np.asarray(one, dtype=np.int64) for one in lists])])
    return np.concatenate(left), np.concatenate(right)


def _clip(polygon: Array, count: Index, start: Array, end: Array) -> tuple[Array, Index]:
    """Keep what lies left of the line from start to end (p, 2): polygons (p, v, 2) with count corners each."""
    p, v, _ = polygon.shape
    places = np.arange(v)
    valid = places < count[:, None]
    along = end - start
    distance = along[:, None, 0] * (polygon[..., 1] - start[:, None, 1])
    distance -= along[:, None, 1] * (polygon[..., 0] - start[:, None, 0])
    following = np.where(places + 1 < count[:, None], places + 1, 0)
    later = np.take_along_axis(polygon, following[..., None], axis=1)
    following_distance = np.take_along_axis(distance, following, axis=1)
    keep = valid & (distance >= 0)
    crosses = valid & ((distance >= 0) != (following_distance >= 0))
    share = np.divide(distance, distance - following_distance, out=np.zeros_like(distance), where=crosses)
    both = np.stack([polygon, polygon + share[..., None] * (later - polygon)], axis=2).reshape(p, 2 * v, 2)
    wanted = np.stack([keep, crosses], axis=2).reshape(p, 2 * v)
    order = np.argsort(~wanted, axis=1, kind="stable")[:, : v + 1]
    return np.take_along_axis(both, order[..., None], axis=1), wanted.sum(axis=1)


@dataclass(frozen=True, kw_only=True)
class Overlap:
    """Points on the planes of the first surface's pieces.

    positions [m] (q, 3); normals of those planes (q, 3); weights [m2] (q,), areas in the plane; block and number of the
    element face on both sides (q,).
    """

    positions: Array
    normals: Array
    weights: Array
    first: tuple[Index, Index]
    second: tuple[Index, Index]


def overlap(points: Array, first: Blocks, second: Blocks, *, search_distance: float, degree: int) -> Overlap:
    """Cut two surfaces that face each other into their common pieces.

    search_distance: the farthest that the second may lie away [m]; degree: of the polynomials that the points integrate
    exactly on each triangle of an overlap. May come out empty.
    """
    one, two = pieces(points, first), pieces(points, second)
    a, b = _near(one, two, search_distance)
    frames = _frames(one.corners)
    origin = one.centres
    polygon = np.einsum("pij,pvj->pvi", frames[:, :2], one.corners - origin[:, None])[a]
    # the second side faces the first, so its corners run the other way round
    other = np.einsum("pij,pvj->pvi", frames[a, :2], two.corners[b][:, ::-1] - origin[a][:, None])
    facing = np.einsum("pi,pi->p", frames[a, 2], _frames(two.corners)[b, 2]) < 0
    a, b, polygon, other = a[facing], b[facing], polygon[facing], other[facing]
    count = np.full(len(a), 4)
    for edge in range(4):
        polygon, count = _clip(polygon, count, other[:, edge], other[:, (edge + 1) % 4])
        alive = count > 2
        a, b, polygon, count, other = a[alive], b[alive], polygon[alive], count[alive], other[alive]
    local, share, _, _ = KINDS["tri3"].rule(degree)
    limit = 1e-12 * one.radii**2
    places, weights, which = [], [], []
    for corner in range(1, polygon.shape[1] - 1):
        u, w = polygon[:, corner] - polygon[:, 0], polygon[:, corner + 1] - polygon[:, 0]
        twice = u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]
        good = np.flatnonzero((corner + 1 < count) & (twice > limit[a]))
        at = polygon[good, 0][:, None] + local[0][:, None] * u[good][:, None] + local[1][:, None] * w[good][:, None]
        places.append(at.reshape(-1, 2))
        weights.append((twice[good][:, None] * share).ravel())
        which.append(np.repeat(good, len(share)))
    pair = np.concatenate(which)
    here, there = a[pair], b[pair]
    positions = origin[here] + np.einsum("qij,qi->qj", frames[here, :2], np.concatenate(places))
    return Overlap(
        positions=positions,
        normals=frames[here, 2],
        weights=np.concatenate(weights),
        first=(one.block[here], one.face[here]),
        second=(two.block[there], two.face[there]),
    )


def _frames(corners: Array) -> Array:
    """Rows: two axes in the plane of each piece and its normal (p, 3, 3)."""
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    along = corners[:, 1] - corners[:, 0]
    along -= np.einsum("pi,pi->p", along, normal)[:, None] * normal
    along /= np.linalg.norm(along, axis=1)[:, None]
    return np.stack([along, np.cross(normal, along), normal], axis=1)
