"""Shape functions and quadrature of all elements, in VTK's node order: corners first, then the middles of the edges.

Every kind is the table of its nodes and of the monomials that its shape functions span; the coefficients follow from
the nodes. Reference elements: triangles and tetrahedra have corners at 0 and 1, squares and cubes span [-1, 1], a wedge
is the triangle times [-1, 1].
"""

from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Any

import numpy as np

from faying.typing import Array

_SQUARE = ((-1, -1), (1, -1), (1, 1), (-1, 1))
_TRIANGLE = ((0, 0), (1, 0), (0, 1))
_CORNERS: dict[str, tuple[tuple[int, ...], ...]] = {
    "tri": _TRIANGLE,
    "quad": _SQUARE,
    "tet": ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "hex": tuple((*p, z) for z in (-1, 1) for p in _SQUARE),
    "wedge": tuple((*p, z) for z in (-1, 1) for p in _TRIANGLE),
}
_EDGES: dict[str, tuple[tuple[int, int], ...]] = {
    "tri": ((0, 1), (1, 2), (2, 0)),
    "quad": ((0, 1), (1, 2), (2, 3), (3, 0)),
    "tet": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    "hex": ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    "wedge": ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
}
# corners of the sides, seen from outside against the clock; in the order of Abaqus's and CalculiX's S1, S2, ...
_SIDES: dict[str, tuple[tuple[int, ...], ...]] = {
    "tri": (),
    "quad": (),
    "tet": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
    "hex": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    "wedge": ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
}


@dataclass(frozen=True, kw_only=True)
class Kind:
    """One kind of element: corners and nodes [count], edges with a node in the middle, sides as nodes, and reference."""

    name: str
    shape: str
    dimension: int
    corners: int
    nodes: Array
    exponents: tuple[tuple[int, ...], ...]
    sides: tuple[tuple[int, ...], ...]

    @property
    def count(self) -> int:
        """Number of nodes."""
        return len(self.nodes)

    @property
    def edges(self) -> tuple[tuple[int, int], ...]:
        """Corners at the ends of each edge; the middle nodes, where there are any, follow in this order."""
        return _EDGES[self.shape]


def _exponents(shape: str, order: int) -> tuple[tuple[int, ...], ...]:
    """Monomials of P1, P2, Q1 and the serendipity families of second order."""
    dimension = len(_CORNERS[shape][0])
    every = product(range(order + 1), repeat=dimension)
    if shape in ("tri", "tet"):
        return tuple(e for e in every if sum(e) <= order)
    if shape in ("quad", "hex"):
        return tuple(e for e in every if order == 1 or e.count(2) <= 1)
    return tuple(e for e in every if e[0] + e[1] <= order and (order == 1 or e[2] < 2 or e[0] + e[1] <= 1))


def _kind(shape: str, order: int) -> Kind:
    corners = np.array(_CORNERS[shape], dtype=float)
    edges = _EDGES[shape]
    nodes = corners if order == 1 else np.concatenate([corners, [(corners[a] + corners[b]) / 2 for a, b in edges]])
    middle = {frozenset(edge): len(corners) + i for i, edge in enumerate(edges)} if order == 2 else {}
    sides = tuple(
        (*side, *(middle[frozenset((a, b))] for a, b in zip(side, side[1:] + side[:1], strict=True) if middle))
        for side in _SIDES[shape]
    )
    return Kind(
        name=f"{shape}{len(nodes)}",
        shape=shape,
        dimension=corners.shape[1],
        corners=len(corners),
        nodes=nodes,
        exponents=_exponents(shape, order),
        sides=sides,
    )


KINDS = {kind.name: kind for kind in (_kind(shape, order) for shape in _CORNERS for order in (1, 2))}
SOLIDS = {kind.count: kind for kind in KINDS.values() if kind.dimension == 3}
FACES = {kind.count: kind for kind in KINDS.values() if kind.dimension == 2}


@cache
def _coefficients(kind: str) -> Array:
    which = KINDS[kind]
    return np.asarray(np.linalg.inv(_monomials(which.nodes, which.exponents)), dtype=np.float64)


def _monomials(places: Array, exponents: tuple[tuple[int, ...], ...]) -> Array:
    """Every monomial at every place (q, d): shape (q, m)."""
    powers = places[:, None, :] ** np.array(exponents)[None]
    return np.asarray(powers.prod(axis=2))


def shape_at(kind: str, local: Array) -> tuple[Array, Array]:
    """Shape functions (q, a) and gradients (q, a, d) at given local coordinates (d, q)."""
    which, places = KINDS[kind], local.T
    exponents, coefficients = np.array(which.exponents), _coefficients(kind)
    slopes = []
    for axis in range(which.dimension):
        lower = exponents.copy()
        lower[:, axis] = np.maximum(lower[:, axis] - 1, 0)
        grown = _monomials(places, tuple(map(tuple, lower))) * exponents[:, axis]
        slopes.append(grown @ coefficients)
    return _monomials(places, which.exponents) @ coefficients, np.stack(slopes, axis=2)


def _rule(shape: str, degree: int, along: int | None = None) -> tuple[Array, Array]:
    """Points (q, d) and weights (q,); `along` is the degree along the axis of a wedge."""
    if shape in ("tri", "tet"):
        from skfem.quadrature import get_quadrature
        from skfem.refdom import RefTet, RefTri

        domain: Any = RefTri if shape == "tri" else RefTet
        points, weights = get_quadrature(domain, degree)
        return points.T, weights
    line, share = np.polynomial.legendre.leggauss((degree if along is None else along) // 2 + 1)
    if shape == "wedge":
        flat, weights = _rule("tri", degree)
        points = np.column_stack([np.tile(flat, (len(line), 1)), np.repeat(line, len(flat))])
        return points, np.outer(share, weights).ravel()
    axes = [line] * (2 if shape == "quad" else 3)
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, len(axes))
    shares = np.stack(np.meshgrid(*[share] * len(axes), indexing="ij"), -1).reshape(-1, len(axes))
    return grid, shares.prod(axis=1)


@cache
def reference(kind: str, degree: int, along: int | None = None) -> tuple[Array, Array, Array, Array]:
    """Return points (d, q), weights (q,), shape functions (q, a) and their gradients (q, a, d) on the reference element.

    kind: a key of KINDS; degree: polynomials up to it are integrated exactly (up to 4 in tetrahedra), on squares and
    cubes up to it in each direction; along: the degree along the axis of a wedge where it differs.
    """
    points, weights = _rule(KINDS[kind].shape, degree, along)
    values, gradients = shape_at(kind, points.T)
    return points.T, weights, values, gradients
