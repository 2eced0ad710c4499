"""Structured meshes of boxes for the tests: six tetrahedra in each cell, second order, stacked along x."""

import numpy as np

from faying.fe.geometry import _outward
from faying.fe.mesh import EDGES, Mesh


def box(counts, size, origin=(0.0, 0.0, 0.0)):
    """Points (n, 3) and tet10 cells of one box."""
    nx, ny, nz = counts
    grid = np.stack(
        np.meshgrid(*(np.linspace(0, s, c + 1) for s, c in zip(size, counts, strict=True)), indexing="ij"), -1
    )
    corner = grid.reshape(-1, 3) + np.array(origin)
    index = np.arange(len(corner)).reshape(nx + 1, ny + 1, nz + 1)
    cells = []
    for path in ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)):
        step = np.zeros((4, 3), dtype=int)
        for k, axis in enumerate(path):
            step[k + 1] = step[k]
            step[k + 1, axis] += 1
        cells.append(
            np.stack([index[s[0] : s[0] + nx, s[1] : s[1] + ny, s[2] : s[2] + nz] for s in step], -1).reshape(-1, 4)
        )
    tet = np.concatenate(cells)
    volume = np.linalg.det(corner[tet[:, 1:]] - corner[tet[:, :1]])
    tet[volume < 0] = tet[volume < 0][:, [1, 0, 2, 3]]
    edges = np.sort(tet[:, EDGES["tet10"]].reshape(-1, 2), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    points = np.concatenate([corner, corner[unique].mean(axis=1)])
    return points, np.concatenate([tet, len(corner) + inverse.reshape(-1, 6)], axis=1)


def surface(points, cells, where):
    """Six-node triangles on the plane where `where(points)` is true."""
    faces = []
    for corners, middles in (
        ((0, 1, 2), (4, 5, 6)),
        ((0, 1, 3), (4, 8, 7)),
        ((0, 2, 3), (6, 9, 7)),
        ((1, 2, 3), (5, 9, 8)),
    ):
        faces.append(cells[:, corners + middles])
    tri = np.concatenate(faces)
    on = where(points)
    return tri[on[tri].all(axis=1)]


def stack(lengths, counts, width=1.0, height=1.0, sections=None, gap=0.0):
    """Boxes along x with a joint between neighbours: parts p0, p1, ...; faces p0.left, p0.right, ...

    sections: (ny, nz) of each box, so that faces need not match; gap [m] between neighbours.
    """
    all_points, parts, faces, owner = [], {}, {}, {}
    start, offset = 0.0, 0
    for i, (length, count) in enumerate(zip(lengths, counts, strict=True)):
        ny, nz = sections[i] if sections else (2, 2)
        points, cells = box((count, ny, nz), (length, width, height), (start, 0.0, 0.0))
        for side, x in (("left", start), ("right", start + length)):
            tri = surface(points, cells, lambda p, x=x, tiny=1e-9 * length: np.abs(p[:, 0] - x) < tiny)
            faces[f"p{i}.{side}"] = _outward(points, tri, cells) + offset
            owner[f"p{i}.{side}"] = f"p{i}"
        all_points.append(points)
        parts[f"p{i}"] = cells + offset
        offset += len(points)
        start += length + gap
    return Mesh(points=np.concatenate(all_points), parts=parts, faces=faces, face_part=owner)
