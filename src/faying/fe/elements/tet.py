"""Tetrahedra with four and ten nodes; rules of the stiffness are those of CalculiX."""

from faying.fe.elements.element import Element, Shape, powers, simplex_rule

TET = Shape(
    name="tet",
    corners=((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)),
    edges=((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    sides=((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
    rule=simplex_rule("RefTet"),
)
ELEMENTS = tuple(
    Element(
        shape=TET,
        order=order,
        exponents=tuple(e for e in powers(3, order) if sum(e) <= order),
        stiffness_degree=(order, None),
        mass_degree=(2 * order, None),
    )
    for order in (1, 2)
)
