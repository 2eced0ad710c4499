"""Triangles with three and six nodes: faces of tetrahedra and wedges."""

import numpy as np

from faying.fe.elements.element import Element, Shape, powers, simplex_rule
from faying.typing import Array, Mask

CORNERS = ((0, 0), (1, 0), (0, 1))


def _inside(local: Array, margin: float) -> Mask:
    return np.asarray((local >= -margin).all(axis=1) & (local.sum(axis=1) <= 1 + margin))


TRI = Shape(
    name="tri",
    corners=CORNERS,
    edges=((0, 1), (1, 2), (2, 0)),
    rule=simplex_rule("RefTri"),
    inside=_inside,
    box=(-1.0, 2.0),
)
PIECES = (((0, 1, 2, 2),), ((0, 3, 5, 5), (3, 1, 4, 4), (5, 4, 2, 2), (3, 4, 5, 5)))
ELEMENTS = tuple(
    Element(
        shape=TRI,
        order=order,
        exponents=tuple(e for e in powers(2, order) if sum(e) <= order),
        face_degree=2 * order,
        pieces=PIECES[order - 1],
    )
    for order in (1, 2)
)
