"""Bricks with eight and twenty nodes; rules of the stiffness are those of CalculiX.

The eight-node brick bends by Wilson's incompatible modes 1 - x^2, 1 - y^2, 1 - z^2 with Taylor's correction: R.L.
Taylor, P.J. Beresford, E.L. Wilson, "A non-conforming element for stress analysis", Int. J. Numer. Methods Eng. 10
(1976) 1211-1219, doi:10.1002/nme.1620100602. Also CalculiX's C3D8I.
"""

import numpy as np

from faying.fe.elements import quad
from faying.fe.elements.element import Element, Shape, gauss_rule, powers
from faying.typing import Array

HEX = Shape(
    name="hex",
    corners=tuple((*p, z) for z in (-1, 1) for p in quad.CORNERS),
    edges=((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    sides=((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    rule=gauss_rule(3),
)


def _bubbles(local: Array) -> Array:
    """Gradients (q, 3, 3) of 1 - x^2, 1 - y^2, 1 - z^2."""
    return np.asarray(-2.0 * local[:, :, None] * np.eye(3))


# the serendipity family: at most one exponent is 2
ELEMENTS = tuple(
    Element(
        shape=HEX,
        order=order,
        exponents=tuple(e for e in powers(3, order) if e.count(2) <= 1),
        stiffness_degree=(2 * order + 1, None),
        mass_degree=(5, None),
        bubbles=bubbles,
    )
    for order, bubbles in ((1, _bubbles), (2, None))
)
