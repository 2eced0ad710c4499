"""Structured meshes of boxes of any kind of element, distorted at will, alone or in a row along x."""

import numpy as np

from faying.fe.elements import KINDS
from faying.fe.mesh import Mesh
from tests.helpers.sides import sides_on

SPLIT = {  # corners of a cube, as VTK numbers them, to corners of the elements that fill it
    "hex": [(0, 1, 2, 3, 4, 5, 6, 7)],
    "wedge": [(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)],
    "tet": [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)],
}
SOLID_KINDS = ("tet4", "wedge6", "hex8", "tet10", "wedge15", "hex20")


def with_middles(corner, cells, kind):
    """Nodes in the middle of the edges, each once, where the kind has them."""
    if KINDS[kind].count == KINDS[kind].corners:
        return corner, cells
    edges = np.sort(cells[:, KINDS[kind].edges].reshape(-1, 2), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    middles = inverse.reshape(len(cells), -1) + len(corner)
    return np.concatenate([corner, corner[unique].mean(axis=1)]), np.concatenate([cells, middles], axis=1)


def block(kind, counts, size, origin=(0.0, 0.0, 0.0), move=None):
    """Points (n, 3) and elements of a box; move: displacement of the corners inside, in cells, and its seed."""
    shape = KINDS[kind].shape.name
    nx, ny, nz = counts
    axes = [np.linspace(0, s, c + 1) for s, c in zip(size, counts, strict=True)]
    corner = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    index = np.arange(len(corner)).reshape(nx + 1, ny + 1, nz + 1)
    steps = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    cube = np.stack([index[i : i + nx, j : j + ny, k : k + nz] for i, j, k in steps], -1).reshape(-1, 8)
    cells = np.concatenate([cube[:, corners] for corners in SPLIT[shape]])
    if move:
        amount, seed = move
        inside = np.all((corner > 1e-9) & (corner < np.array(size) - 1e-9), axis=1)
        step = np.array(size) / counts * np.random.default_rng(seed).uniform(-amount, amount, corner.shape)
        corner = corner + step * inside[:, None]
    return with_middles(corner + np.array(origin), cells, kind)


def row(
    lengths, counts, *, kinds=("hex8", "hex8"), sections=((2, 2), (2, 2)), width=1.0, height=1.0, gap=0.0, move=None
):
    """Boxes along x: parts p0, p1, ...; faces p0.left, p0.right, ..."""
    points, parts, faces, owner = [], {}, {}, {}
    start, offset = 0.0, 0
    for i, (length, count) in enumerate(zip(lengths, counts, strict=True)):
        where, cells = block(kinds[i], (count, *sections[i]), (length, width, height), (start, 0.0, 0.0), move)
        for side, x in (("left", start), ("right", start + length)):
            on = np.flatnonzero(np.abs(where[:, 0] - x) < 1e-9 * length)
            faces[f"p{i}.{side}"] = tuple(s + offset for s in sides_on(on, (cells,), len(where)))
            owner[f"p{i}.{side}"] = f"p{i}"
        points.append(where)
        parts[f"p{i}"] = (cells + offset,)
        offset += len(where)
        start += length + gap
    return Mesh(points=np.concatenate(points), parts=parts, faces=faces, face_part=owner)


def stack(lengths, counts, width=1.0, height=1.0, sections=None, gap=0.0):
    """A `row` of tet10; sections: (ny, nz) of each box, so that faces need not match."""
    sections = sections or [(2, 2)] * len(lengths)
    kinds = ["tet10"] * len(lengths)
    return row(lengths, counts, kinds=kinds, sections=sections, width=width, height=height, gap=gap)
