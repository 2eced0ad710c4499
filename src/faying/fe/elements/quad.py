"""Quadrangles with four and eight nodes: faces of bricks and wedges."""

import numpy as np

from faying.fe.elements.element import Element, Shape, gauss_rule, powers
from faying.typing import Array, Mask

CORNERS = ((-1, -1), (1, -1), (1, 1), (-1, 1))


def _inside(local: Array, margin: float) -> Mask:
    return np.asarray((np.abs(local) <= 1 + 2 * margin).all(axis=1))


QUAD = Shape(
    name="quad",
    corners=CORNERS,
    edges=((0, 1), (1, 2), (2, 3), (3, 0)),
    rule=gauss_rule(2),
    inside=_inside,
    box=(-2.0, 2.0),
)
ELEMENTS = (
    Element(shape=QUAD, order=1, exponents=tuple(powers(2, 1)), face_degree=3, pieces=((0, 1, 2, 3),)),
    # the serendipity family: at most one exponent is 2
    Element(
        shape=QUAD,
        order=2,
        exponents=tuple(e for e in powers(2, 2) if e.count(2) <= 1),
        face_degree=5,
        pieces=((0, 4, 7, 7), (4, 1, 5, 5), (5, 2, 6, 6), (6, 3, 7, 7), (4, 5, 6, 7)),
    ),
)
