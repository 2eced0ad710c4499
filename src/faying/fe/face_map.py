"""Maps on the faces of joints: from values at quadrature points to values that can be shaded over elements.

Of the two faces of a joint the smaller one is covered, as far as the faces touch, by the triangles of its element
faces. Each is cut into four at the middles of its edges, as a second-order element has nodes there. A value at a corner
of these triangles is the mean of the values at the points around it, weighted by their area and by the linear hat
function of the corner: the lumped projection on continuous, piecewise linear functions. It makes no value greater than
the greatest at any point, none less than the least, and the integral over the face is that of the points. Peaks
narrower than a triangle are flattened; tables give the greatest value at any point. A corner without a point around it
takes the mean of its neighbours.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.fe.outline import edges_of
from faying.typing import Array, Index

TRIED = 12  # triangles, nearest by their centres, in which a point is looked for


@dataclass(frozen=True, kw_only=True, eq=False)
class FaceValues:
    """Triangles where the faces of a joint touch, each of the outline cut into four, with values at their corners.

    Args:
        parents: Two nodes of the outline (k, 2) between which each corner lies half-way; the same twice at a node.
        triangles: Triangles (m, 3) between these corners.
        fields: Name -> values (loads, k), or (1, k) for what does not depend on the load; SI.
    """

    parents: Index
    triangles: Index
    fields: dict[str, Array]


def quartered(triangles: Index) -> tuple[Index, Index]:
    """Cut triangles (t, 3) at the middles of their edges: two parents of each corner (k, 2), and triangles (4t, 3)."""
    nodes, local = np.unique(triangles, return_inverse=True)
    local = local.reshape(-1, 3)
    edges, _, _ = edges_of(local)
    count = len(nodes)
    key = edges[:, 0] * count + edges[:, 1]
    sides = np.sort(np.stack([local, np.roll(local, -1, axis=1)], axis=2), axis=2)
    middle = count + np.searchsorted(key, sides[..., 0] * count + sides[..., 1])
    a, b, c = local.T
    ab, bc, ca = middle.T
    quarters = np.concatenate([np.stack(q, axis=1) for q in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return np.concatenate([np.stack([nodes, nodes], axis=1), nodes[edges]]), quarters


def barycentric(corners: Array, places: Array) -> Array:
    """Linear hat functions (..., 3) of triangles (..., 3, 3) at places (..., 3), projected on their planes."""
    a, b, c = corners[..., 0, :], corners[..., 1, :], corners[..., 2, :]
    u, v, w = b - a, c - a, places - a
    uu, uv, vv = (u * u).sum(-1), (u * v).sum(-1), (v * v).sum(-1)
    wu, wv = (w * u).sum(-1), (w * v).sum(-1)
    area = np.maximum(uu * vv - uv * uv, 1e-300)
    second, third = (vv * wu - uv * wv) / area, (uu * wv - uv * wu) / area
    return np.stack([1 - second - third, second, third], axis=-1)


def nearest(points: Array, triangles: Index, places: Array) -> tuple[Index, Array]:
    """Triangle (q,) in or next to which each place (q, 3) lies, and its linear hat functions there (q, 3)."""
    from scipy.spatial import cKDTree

    corners = points[triangles]
    count = min(TRIED, len(triangles))
    near = np.asarray(cKDTree(corners.mean(axis=1)).query(places, k=count)[1]).reshape(len(places), count)
    hats = barycentric(corners[near], places[:, None, :])
    best = hats.min(axis=2).argmax(axis=1)
    row = np.arange(len(places))
    found = np.clip(hats[row, best], 0.0, None)
    return near[row, best], found / found.sum(axis=1, keepdims=True)


def projection(points: Array, triangles: Index, places: Array, weights: Array) -> Any:
    """Sparse matrix (corners, places) that takes values at places with areas `weights` to the corners of triangles."""
    from scipy.sparse import coo_array, csr_array, diags_array

    which, found = nearest(points, triangles, places)
    row, where = np.arange(len(places)), triangles[which]
    shares = (found * weights[:, None]).ravel(), (where.ravel(), np.repeat(row, 3))
    spread = coo_array(shares, shape=(len(points), len(places))).tocsr()
    sums = np.asarray(spread.sum(axis=1)).ravel()
    mean = diags_array(1 / np.where(sums > 0, sums, 1.0)) @ spread
    # corners that no point lies near: the mean of their neighbours, from the rim inwards
    edges, _, _ = edges_of(triangles)
    both = np.concatenate([edges, edges[:, ::-1]])
    neighbours = csr_array((np.ones(len(both)), (both[:, 0], both[:, 1])), shape=(len(points), len(points)))
    known = sums > 0
    while not np.all(known):
        reached = np.asarray(neighbours @ known.astype(float)).ravel()
        new = ~known & (reached > 0)
        if not np.any(new):
            break
        fill = diags_array(new / np.where(reached > 0, reached, 1.0)) @ neighbours @ diags_array(known.astype(float))
        mean, known = mean + fill @ mean, known | new
    return mean


def touching(points: Array, faces: Sequence[Index], places: Array) -> Index:
    """Triangles (t, 3), of the smaller of two faces, in which places (q, 3) [m] of their joint lie."""

    def area(triangles: Index) -> float:
        a, b, c = np.moveaxis(points[triangles], 1, 0)
        return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())

    face = min(faces, key=area)
    return np.asarray(face[np.unique(nearest(points, face, places)[0])])


def joint_map(
    points: Array, faces: Sequence[Index], places: Array, weights: Array, fields: dict[str, Array]
) -> FaceValues:
    """Return the map of a joint.

    Args:
        points: Nodes of the outline (n, 3) [m].
        faces: Triangles (t, 3) of both faces of the joint, the first one first.
        places: Points of the joint (q, 3) [m].
        weights: Area of each [m2] (q,).
        fields: Name -> values (loads, q) at these points, or (1, q).
    """
    parents, quarters = quartered(touching(points, faces, places))
    matrix = projection(points[parents].mean(axis=1), quarters, places, weights)
    at_corners = {name: np.asarray((matrix @ values.T).T) for name, values in fields.items()}
    return FaceValues(parents=parents, triangles=quarters, fields=at_corners)
