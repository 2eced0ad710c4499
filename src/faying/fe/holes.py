"""Round holes in a face: where the edges of its elements close a circle around nothing."""

from dataclasses import dataclass

import numpy as np

from faying.fe.elements import FACES
from faying.fe.sides import Blocks, face_centre
from faying.typing import Array

ROUND = 0.05  # spread of the distances from the centre over their mean, up to which a loop of edges is a circle


@dataclass(frozen=True, kw_only=True)
class Hole:
    """A round hole: centre (3,) and radius [m]."""

    centre: Array
    radius: float


def holes(points: Array, blocks: Blocks) -> list[Hole]:
    """Round holes of a nearly flat face."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    corners = [faces[:, : FACES[faces.shape[1]].corners] for faces in blocks]
    edges = np.concatenate([np.stack([c, np.roll(c, -1, axis=1)], axis=2).reshape(-1, 2) for c in corners])
    _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    rim = edges[first[count == 1]]
    _, normal, _ = face_centre(points, blocks)
    n = len(points)
    _, label = connected_components(
        csr_array((np.ones(len(rim)), (rim[:, 0], rim[:, 1])), shape=(n, n)), directed=False
    )
    out = []
    for loop in np.unique(label[rim[:, 0]]):
        some = rim[label[rim[:, 0]] == loop]
        centre = points[some[:, 0]].mean(axis=0)
        arm, end = points[some[:, 0]] - centre, points[some[:, 1]] - centre
        around = float(np.cross(arm, end).sum(axis=0) @ normal)  # against the clock outside, with it around a hole
        flat = arm - np.outer(arm @ normal, normal)
        radius = np.linalg.norm(flat, axis=1)
        if around < 0 and len(some) >= 6 and np.std(radius) < ROUND * radius.mean():
            out.append(Hole(centre=centre, radius=float(radius.mean())))
    return out
