"""Meshes of bricks picked from a grid for the tests, each part with nodes of its own."""

import numpy as np

from faying.fe.mesh import Mesh
from tests.helpers.boxes import with_middles
from tests.helpers.sides import sides_on

CUBE = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))


def voxels(edges, parts, faces, kind="hex20"):
    """edges: three arrays of planes; parts: name -> test of centres (e, 3); faces: name -> part and test of nodes."""
    shape = [len(e) for e in edges]
    corner = np.stack(np.meshgrid(*edges, indexing="ij"), -1).reshape(-1, 3)
    index = np.arange(len(corner)).reshape(shape)
    nx, ny, nz = (n - 1 for n in shape)
    cube = np.stack([index[i : i + nx, j : j + ny, k : k + nz] for i, j, k in CUBE], -1).reshape(-1, 8)
    centre = corner[cube].mean(axis=1)
    points, cells_of, offset = [], {}, 0
    for name, inside in parts.items():
        kept, cells = np.unique(cube[inside(centre)], return_inverse=True)
        where, cells = with_middles(corner[kept], cells.reshape(-1, 8), kind)
        points.append(where)
        cells_of[name] = cells + offset
        offset += len(where)
    points = np.concatenate(points)
    named = {}
    for name, (part, on) in faces.items():
        nodes = np.unique(cells_of[part])
        named[name] = sides_on(nodes[on(points[nodes])], (cells_of[part],), len(points))
    return Mesh(points=points, parts=cells_of, faces=named, face_part={name: part for name, (part, _) in faces.items()})


def bolted(places=((20e-3, 20e-3),), length=40e-3, kind="hex20", gap=0.0):
    """Two plates, 40 mm wide and 10 mm thick, with square holes, and in each hole a bolt with square head and nut.

    places: of the bolts [m]. Faces: lower.joint, upper.joint, upper.seat0, lower.seat0, bolt0.head, bolt0.nut,
    bolt0.shank (one side of it), ...
    """
    mm = 1e-3
    lines = [
        np.unique(np.round(np.concatenate([[0, end / mm], *([x / mm + o for o in OFFSETS] for x in xs)]), 6)) * mm
        for xs, end in (({p[0] for p in places}, length), ({p[1] for p in places}, 40e-3))
    ]
    z = np.array([-6, -3, 0, 5, 10, 15, 20, 23, 26]) * mm

    def off(p, place):
        return np.maximum(np.abs(p[:, 0] - place[0]), np.abs(p[:, 1] - place[1])) / mm

    def plate(low, high):
        def inside(p):
            clear = np.all([off(p, place) > HOLE for place in places], axis=0)
            return (p[:, 2] > low) & (p[:, 2] < high) & clear

        return inside

    def bolt(place):
        def inside(p):
            away = off(p, place)
            return (away < SHANK) | ((away < HEAD) & ((p[:, 2] < 0) | (p[:, 2] > 20 * mm)))

        return inside

    def level(height):
        return lambda p: np.abs(p[:, 2] - height) < 1e-9

    def ring(height, place):
        return lambda p: level(height)(p) & (off(p, place) > HOLE - 1e-6) & (off(p, place) < HEAD + 1e-6)

    parts = {"lower": plate(0, 10 * mm), "upper": plate(10 * mm, 20 * mm)}
    faces = {"lower.joint": ("lower", level(10 * mm)), "upper.joint": ("upper", level(10 * mm))}
    for i, place in enumerate(places):
        parts[f"bolt{i}"] = bolt(place)
        faces[f"bolt{i}.shank"] = (f"bolt{i}", lambda p, at=place[0]: np.abs(p[:, 0] - at - SHANK * mm) < 1e-9)
        for part, side, height in (
            ("upper", "seat", 20),
            ("lower", "seat", 0),
            (f"bolt{i}", "head", 20),
            (f"bolt{i}", "nut", 0),
        ):
            name = f"{part}.{side}{i}" if side == "seat" else f"{part}.{side}"
            faces[name] = (part, ring(height * mm, place))
    return voxels([*lines, z], parts, faces, kind)


SHANK, HOLE, HEAD = 2.0, 4.0, 8.0  # half-widths [mm]
OFFSETS = (-14, -8, -4, -2, 0, 2, 4, 8, 14)
