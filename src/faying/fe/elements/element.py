"""What an element is: its nodes, shape functions, quadrature rules, faces and stiffness, in VTK's node order.

The shape functions follow from the nodes and from the monomials that they span. Reference elements: triangles and
tetrahedra have corners at 0 and 1, squares and cubes span [-1, 1], a wedge is the triangle times [-1, 1].
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeAlias

import numpy as np

from faying.typing import Array, Index, Mask

Degree: TypeAlias = tuple[int, int | None]
"""Degree of a quadrature rule, and its degree along the axis of a wedge where that differs."""


@dataclass(frozen=True, kw_only=True)
class Shape:
    """A reference shape.

    corners; edges between corners; sides as corners, seen from outside against the clock, in the order of Abaqus's and
    CalculiX's S1, S2, ...; rule: points (q, d) and weights (q,) that integrate polynomials up to a degree exactly;
    inside: of a face, whether local places (n, 2) lie in it, with a margin; box: least and greatest coordinate to which
    Newton's method may stray outside it.
    """

    name: str
    corners: tuple[tuple[int, ...], ...]
    edges: tuple[tuple[int, int], ...]
    sides: tuple[tuple[int, ...], ...] = ()
    rule: Callable[[Degree], tuple[Array, Array]]
    inside: Callable[[Array, float], Mask] | None = None
    box: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Element:
    """One kind of element: corners first, then the middles of the edges where order is 2.

    exponents: the monomials that the shape functions span; stiffness_degree, mass_degree: of the quadrature rules of a
    solid; face_degree: of a face, exact for products of two shape functions on straight elements; pieces: convex pieces
    of a curved face as four nodes each, a triangle's last one twice; bubbles: local gradients (q, b, d) at the places
    (q, d) of incompatible modes, None where there are none.
    """

    shape: Shape
    order: int
    exponents: tuple[tuple[int, ...], ...]
    stiffness_degree: Degree = (0, None)
    mass_degree: Degree = (0, None)
    face_degree: int = 0
    pieces: tuple[tuple[int, int, int, int], ...] = ()
    bubbles: Callable[[Array], Array] | None = None

    @property
    def name(self) -> str:
        """Shape and number of nodes, such as tet10."""
        return f"{self.shape.name}{self.count}"

    @property
    def dimension(self) -> int:
        """2 for a face, 3 for a solid."""
        return len(self.shape.corners[0])

    @property
    def corners(self) -> int:
        """Number of corners."""
        return len(self.shape.corners)

    @property
    def edges(self) -> tuple[tuple[int, int], ...]:
        """Corners at the ends of each edge; the middle nodes, where there are any, follow in this order."""
        return self.shape.edges

    @property
    def count(self) -> int:
        """Number of nodes."""
        return self.corners if self.order == 1 else self.corners + len(self.edges)

    @property
    def nodes(self) -> Array:
        """Local coordinates of the nodes (a, d)."""
        corners = np.array(self.shape.corners, dtype=float)
        if self.order == 1:
            return corners
        return np.concatenate([corners, [(corners[a] + corners[b]) / 2 for a, b in self.edges]])

    @property
    def sides(self) -> tuple[tuple[int, ...], ...]:
        """Nodes of each side: corners, then the middles of its edges."""
        if self.order == 1:
            return self.shape.sides
        middle = {frozenset(edge): self.corners + i for i, edge in enumerate(self.edges)}
        return tuple(
            (*side, *(middle[frozenset(pair)] for pair in zip(side, side[1:] + side[:1], strict=True)))
            for side in self.shape.sides
        )

    @property
    def mirrored(self) -> tuple[int, ...]:
        """Nodes in the order that has the first two local axes exchanged: of the same body, numbered inside out."""
        nodes = self.nodes.tolist()
        return tuple(nodes.index([y, x, *rest]) for x, y, *rest in nodes)

    def at(self, local: Array) -> tuple[Array, Array]:
        """Shape functions (q, a) and gradients (q, a, d) at local coordinates (d, q)."""
        places, exponents, coefficients = local.T, np.array(self.exponents), _coefficients(self)
        slopes = []
        for axis in range(self.dimension):
            lower = exponents.copy()
            lower[:, axis] = np.maximum(lower[:, axis] - 1, 0)
            slopes.append((_monomials(places, lower) * exponents[:, axis]) @ coefficients)
        return _monomials(places, exponents) @ coefficients, np.stack(slopes, axis=2)

    def rule(self, degree: int) -> tuple[Array, Array, Array, Array]:
        """Points (d, q), weights (q,), shape functions (q, a) and gradients (q, a, d) on the reference element.

        Polynomials up to the degree are integrated exactly (up to 4 in tetrahedra), on squares and cubes up to it in
        each direction.
        """
        return _rule(self, (degree, None))

    @property
    def stiffness_rule(self) -> tuple[Array, Array, Array, Array]:
        """Rule for the stiffness, as `rule` returns it."""
        return _rule(self, self.stiffness_degree)

    @property
    def mass_rule(self) -> tuple[Array, Array, Array, Array]:
        """Rule for the mass, exact on straight elements, as `rule` returns it."""
        return _rule(self, self.mass_degree)

    @property
    def face_rule(self) -> tuple[Array, Array, Array, Array]:
        """Rule for a face, as `rule` returns it."""
        return _rule(self, (self.face_degree, None))

    def stiffness(self, points: Array, cells: Index, density: Callable[[Array, Array], Array]) -> Array:
        """Stiffness (e, a, 3, a, 3) of elements; density: of gradients in space (e, q, a, 3) and volumes (e, q).

        Incompatible modes are condensed out. Taylor's correction takes the map of the middle everywhere, so that
        uniform stress does no work on them.
        """
        local, weights, _, gradients = self.stiffness_rule
        g, det = gradients_in_space(points, cells, gradients)
        if self.bubbles is None:
            return density(g, det * weights)
        _, _, _, middle = self.rule(1)
        jacobian = np.einsum("eai,aj->eij", points[cells], middle[0])
        bubbles = np.einsum("qjb,ebk->eqjk", self.bubbles(local.T), np.linalg.inv(jacobian))
        bubbles /= det[..., None, None]  # their own size cancels: they are condensed out
        split = 3 * self.count
        size = split + 3 * bubbles.shape[2]
        whole = density(np.concatenate([g, bubbles], axis=2), det * weights).reshape(len(cells), size, size)
        kept, free, mixed = whole[:, :split, :split], whole[:, split:, split:], whole[:, split:, :split]
        condensed = kept - mixed.transpose(0, 2, 1) @ np.linalg.solve(free, mixed)
        return np.asarray(condensed).reshape(-1, self.count, 3, self.count, 3)


def gradients_in_space(points: Array, cells: Index, gradients: Array) -> tuple[Array, Array]:
    """Gradients in space (e, q, a, 3) and determinants (e, q)."""
    jacobian = np.einsum("eai,qaj->eqij", points[cells], gradients, optimize=True)
    inverse = np.linalg.inv(jacobian)
    return np.einsum("qaj,eqji->eqai", gradients, inverse, optimize=True), np.linalg.det(jacobian)


@cache
def _coefficients(element: Element) -> Array:
    return np.asarray(np.linalg.inv(_monomials(element.nodes, np.array(element.exponents))), dtype=np.float64)


def _monomials(places: Array, exponents: Any) -> Array:
    """Every monomial at every place (q, d): shape (q, m)."""
    powers = places[:, None, :] ** exponents[None]
    return np.asarray(powers.prod(axis=2))


@cache
def _rule(element: Element, degree: Degree) -> tuple[Array, Array, Array, Array]:
    points, weights = element.shape.rule(degree)
    values, gradients = element.at(points.T)
    return points.T, weights, values, gradients


def simplex_rule(domain: str) -> Callable[[Degree], tuple[Array, Array]]:
    """Rules of a triangle or a tetrahedron, scikit-fem's `domain`."""

    def rule(degree: Degree) -> tuple[Array, Array]:
        from skfem import quadrature, refdom

        points, weights = quadrature.get_quadrature(getattr(refdom, domain), degree[0])
        return points.T, weights

    return rule


def gauss(degree: int) -> tuple[Array, Array]:
    """Gauss's points and weights on [-1, 1]."""
    points, weights = np.polynomial.legendre.leggauss(degree // 2 + 1)
    return points, weights


def gauss_rule(dimension: int) -> Callable[[Degree], tuple[Array, Array]]:
    """Product rules of a square or a cube."""

    def rule(degree: Degree) -> tuple[Array, Array]:
        line, share = gauss(degree[0])
        grid = np.stack(np.meshgrid(*[line] * dimension, indexing="ij"), -1).reshape(-1, dimension)
        shares = np.stack(np.meshgrid(*[share] * dimension, indexing="ij"), -1).reshape(-1, dimension)
        return grid, shares.prod(axis=1)

    return rule


def powers(dimension: int, order: int) -> list[tuple[int, ...]]:
    """All exponents up to `order` in each direction, the last running fastest."""
    return list(np.ndindex(*[order + 1] * dimension))
