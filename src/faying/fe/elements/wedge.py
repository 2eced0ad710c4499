"""Wedges with six and fifteen nodes.

Rules of the stiffness are those of CalculiX, but for six nodes, to which CalculiX gives two points and so a motion that
costs nothing.
"""

import numpy as np

from faying.fe.elements import tri
from faying.fe.elements.element import Degree, Element, Shape, gauss, powers
from faying.typing import Array


def _rule(degree: Degree) -> tuple[Array, Array]:
    flat, weights = tri.TRI.rule((degree[0], None))
    line, share = gauss(degree[0] if degree[1] is None else degree[1])
    points = np.column_stack([np.tile(flat, (len(line), 1)), np.repeat(line, len(flat))])
    return points, np.outer(share, weights).ravel()


WEDGE = Shape(
    name="wedge",
    corners=tuple((*p, z) for z in (-1, 1) for p in tri.CORNERS),
    edges=((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
    sides=((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    rule=_rule,
)
ELEMENTS = tuple(
    Element(
        shape=WEDGE,
        order=order,
        exponents=tuple(e for e in powers(3, order) if e[0] + e[1] <= order and (e[2] < 2 or e[0] + e[1] <= 1)),
        stiffness_degree=(2, 2 * order + 1),
        mass_degree=(4, 5),
    )
    for order in (1, 2)
)
