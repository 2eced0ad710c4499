"""Two discs with a hole through both, one on the other, of hexahedra in polar rows: what a bolt clamps."""

import numpy as np

from faying.fe.mesh import Mesh
from tests.helpers.boxes import block
from tests.helpers.sides import sides_on


def disc(radii, turns, heights):
    """Points and hex20 of a disc: radii and heights of the rows of nodes [m], elements round the axis."""
    counts = (len(radii) - 1, turns, len(heights) - 1)
    where, cells = block("hex20", counts, (float(counts[0]), 1.0, float(counts[2])))
    r = np.interp(where[:, 0], np.arange(len(radii)), radii)
    z = np.interp(where[:, 2], np.arange(len(heights)), heights)
    angle = 2 * np.pi * where[:, 1]
    placed = np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1)
    _, first, same = np.unique(np.round(placed, 9), axis=0, return_index=True, return_inverse=True)
    return placed[first], same.ravel()[cells]


def discs(radii, turns, heights, lower=None):
    """Discs `low` (heights as given, turned down) and `high`; faces low.bottom, low.top, high.bottom, high.top."""
    points, parts, faces, owner, offset = [], {}, {}, {}, 0
    heights = np.asarray(heights, dtype=float)
    below = -np.asarray(heights if lower is None else lower, dtype=float)[::-1]
    for name, z in (("low", below), ("high", heights)):
        where, cells = disc(radii, turns, z)
        parts[name] = (cells + offset,)
        for side, place in (("bottom", z[0]), ("top", z[-1])):
            on = np.flatnonzero(np.abs(where[:, 2] - place) < 1e-9)
            faces[f"{name}.{side}"] = tuple(s + offset for s in sides_on(on, (cells,), len(where)))
            owner[f"{name}.{side}"] = name
        points.append(where)
        offset += len(where)
    return Mesh(points=np.concatenate(points), parts=parts, faces=faces, face_part=owner)
