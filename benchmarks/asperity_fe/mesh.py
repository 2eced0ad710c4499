"""Mesh of a spherical cap on a block, axisymmetric, of four-node quadrilaterals, fine where contact happens.

The cap is one block of columns that lean from its arc to its base and meet in its rim; the substrate is a grid of
columns and rows that takes the cap's columns over. The size of the elements is a given function of the distance from
the contact, so a mesh of half the size has about four times the elements and the same grading.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import asin, sqrt

import numpy as np

from faying.typing import Array, Index

CAP, LAYER, SUBSTRATE = 0, 1, 2


@dataclass(frozen=True, kw_only=True)
class CapMesh:
    """Nodes and quadrilaterals of one asperity.

    nodes (n, 2): radius and height [m], the height counted from the base of the cap; quads (m, 4): counter-clockwise;
    body (m,): CAP, LAYER or SUBSTRATE; surface (s,): the nodes that may touch the plane, from the axis outwards;
    axis: nodes at radius 0; base: nodes at the foot of the model; wall: nodes at its outer radius.
    """

    nodes: Array
    quads: Index
    body: Index
    surface: Index
    axis: Index
    base: Index
    wall: Index


GROWTH = 1.08  # of elements of the cap, from one to the next


@dataclass(frozen=True, kw_only=True)
class _Grading:
    """Element size along a line: `fine` up to `flat`, then growing by `growth` from one element to the next."""

    fine: float
    flat: float
    growth: float

    def count(self, x: float) -> float:
        """Elements (not rounded) between 0 and x: the integral of dx/size."""
        rate = self.growth - 1
        far = max(x - self.flat, 0.0)
        return float(min(x, self.flat) / self.fine + np.log1p(rate * far / self.fine) / rate)

    def place(self, counts: Array) -> Array:
        """Inverse of `count`."""
        rate = self.growth - 1
        edge = self.flat / self.fine
        return np.where(
            counts < edge,
            counts * self.fine,
            self.flat + self.fine / rate * np.expm1(rate * np.maximum(counts - edge, 0.0)),
        )

    def split(self, start: float, stop: float) -> Array:
        """Return the grid points from start to stop, both included."""
        first, last = self.count(start), self.count(stop)
        cells = max(1, round(last - first))
        points = self.place(np.linspace(first, last, cells + 1))
        points[0], points[-1] = start, stop
        return points


def rim_radius(R: float, h_a: float) -> float:
    """Radius of the cap's base [m]: r_a = sqrt(2 R h_a - h_a^2)."""
    return sqrt(2 * R * h_a - h_a**2)


def cap_mesh(
    *,
    R: float,
    h_a: float,
    contact_radius: float,
    elements: float,
    domain: float | None,
    layer_thickness: float = 0.0,
) -> CapMesh:
    """Mesh the cap and, unless `domain` is None, the block under it.

    R, h_a: radius and height of the cap [m]; contact_radius: the largest expected [m]; elements: their number over
    that radius; domain: radius and depth of the block [m]; layer_thickness [m]: a row of nodes lies there.
    """
    fine = contact_radius / elements
    cap = _cap(
        R,
        h_a,
        across=_Grading(fine=fine, flat=1.2 * contact_radius, growth=GROWTH),
        down=_Grading(fine=fine, flat=0.7 * contact_radius, growth=GROWTH),
    )
    if domain is None:
        return cap
    return _on_block(
        cap,
        across=_Grading(fine=fine, flat=1.2 * contact_radius, growth=1.5 * GROWTH - 0.5),
        down=_Grading(fine=fine, flat=0.7 * contact_radius, growth=1.5 * GROWTH - 0.5),
        stops=[h_a, *([h_a + layer_thickness] if layer_thickness else []), h_a + domain],
    )


def _cap(R: float, h_a: float, *, across: _Grading, down: _Grading) -> CapMesh:
    """The cap alone, on its base; its nodes go row by row from the top, the node of the rim last."""
    r_a = rim_radius(R, h_a)
    arc = across.split(0.0, R * (np.pi / 2 if h_a == R else asin(r_a / R)))
    phi = arc / R
    depth = down.split(0.0, h_a)
    columns, rows = len(arc) - 1, len(depth) - 1
    top = np.stack([R * np.sin(phi), R * np.cos(phi) - (R - h_a)], axis=-1)
    foot = np.stack([r_a * arc / arc[-1], np.zeros_like(arc)], axis=-1)
    share = (depth / h_a)[:, None, None]
    points = (1 - share) * top + share * foot  # (rows + 1, columns + 1, 2)
    number = np.zeros((rows + 1, columns + 1), np.int64)
    number[:, :columns] = np.arange((rows + 1) * columns).reshape(rows + 1, columns)
    number[:, columns] = (rows + 1) * columns  # the rim: one node for all rows
    return CapMesh(
        nodes=np.concatenate([points[:, :columns].reshape(-1, 2), np.array([[r_a, 0.0]])]),
        quads=_grid(number),
        body=np.full(rows * columns, CAP),
        surface=number[0],
        axis=number[:, 0],
        base=number[-1],
        wall=np.zeros(0, np.int64),
    )


def _on_block(cap: CapMesh, *, across: _Grading, down: _Grading, stops: list[float]) -> CapMesh:
    """The cap on a block of depth and radius stops[-1] - stops[0].

    `stops` [m], from the top of the cap down, begin with its height; a layer's lower face is the second of three.
    """
    foot = cap.nodes[cap.base, 0]
    flat = across.split(float(foot[-1]), stops[-1] - stops[0])[1:]
    radii = np.concatenate([foot, flat])
    pieces = [down.split(a, b)[1:] for a, b in pairwise(stops)]
    z = stops[0] - np.concatenate(pieces)
    below = np.zeros((len(z) + 1, len(radii)), np.int64)
    below[0, : len(foot)] = cap.base
    start = len(cap.nodes)
    below[0, len(foot) :] = start + np.arange(len(flat))
    start += len(flat)
    below[1:] = start + np.arange(below[1:].size).reshape(below[1:].shape)
    grid_r, grid_z = np.meshgrid(radii, z)
    in_layer = np.arange(len(z)) < (len(pieces[0]) if len(pieces) > 1 else 0)
    return CapMesh(
        nodes=np.concatenate(
            [
                cap.nodes,
                np.stack([flat, np.zeros_like(flat)], axis=-1),
                np.stack([grid_r.ravel(), grid_z.ravel()], axis=-1),
            ]
        ),
        quads=np.concatenate([cap.quads, _grid(below)]),
        body=np.concatenate([cap.body, np.repeat(np.where(in_layer, LAYER, SUBSTRATE), len(radii) - 1)]),
        surface=np.concatenate([cap.surface, below[0, len(foot) :]]),
        axis=np.concatenate([cap.axis, below[1:, 0]]),
        base=below[-1],
        wall=below[:, -1],
    )


def _grid(number: Index) -> Index:
    """Quadrilaterals, counter-clockwise, of a grid of nodes whose rows go down and columns outwards."""
    return np.stack([number[1:, :-1], number[1:, 1:], number[:-1, 1:], number[:-1, :-1]], axis=-1).reshape(-1, 4)
