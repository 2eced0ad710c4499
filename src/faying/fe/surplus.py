"""The error of a mesh of tetrahedra in its modes, from what functions one degree higher would take up.

The functions are cubic on each edge and each face of quadratic tetrahedra, quadratic on each edge of linear ones. What
a mode leaves of its equations, tested with them, is solved for them alone. The energy of this correction, over that of
the mode, is the relative error of the square of its frequency: it falls by so much where the functions are added.
Functions on the faces of a joint feel its springs. Those on faces where bolts, supports or masses act are left out, as
the forces there are not of the parts.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.fe.elasticity import Solid, add_rows, chunks, of_pairs, pair_blocks, pair_keys, stiffness_of, stress_of
from faying.fe.elements import FACES, SOLIDS, Element
from faying.fe.interface import Interface
from faying.fe.sides import edge_ends
from faying.fe.solids import SolidMesh
from faying.numerics.product import product
from faying.typing import Array, Index, Mask

CHUNK = 200_000  # pairs of nodes at a time, which bounds the memory
DEGREE = 4  # of the rule: exact for products of two gradients of the cubic functions
STEPS = 6  # of conjugate gradients: further ones change the energy by less than a hundredth on ordinary elements
TINY = 1e-300  # in place of 0 in a divisor


@dataclass(frozen=True, kw_only=True)
class Surplus:
    """Functions one degree above those of a mesh of tetrahedra.

    Args:
        mesh, materials: of the parts; E [Pa], nu and density [kg/m3] count.
        functions, signs: of each element (e, s): numbers, and 1 or -1 by the direction of its edge.
        keys: of the functions on edges and of those on faces, in the order of their numbers: what `_keys` makes of the
            corners.
        stiffness: of the functions in three directions [N/m] (3 f, 3 f), on elements with straight edges, so that it is
            positive definite where an element is nearly folded, too.
        left_out: unknowns that are 0 (3 f,).

    Source:
        R.E. Bank, R.K. Smith, "A posteriori error estimates based on hierarchical bases", SIAM J. Numer. Anal. 30
        (1993) 921-935, doi:10.1137/0730048: the defect of the equations, solved in the complement of the basis.
    """

    mesh: SolidMesh
    materials: Mapping[str, Solid]
    functions: Index
    signs: Array
    keys: Sequence[Index]
    stiffness: Any
    left_out: Mask

    @classmethod
    def of(cls, mesh: SolidMesh, materials: Mapping[str, Solid], loaded: Mask) -> "Surplus | None":
        """The functions of a mesh; None where it has other elements than tetrahedra of one order.

        Args:
            mesh: the parts.
            materials: of each part.
            loaded: nodes (n,) on which something else than the parts and the joints acts.
        """
        kinds = {cells.shape[1] for cells in mesh.blocks}
        element = SOLIDS[kinds.pop()]
        if kinds or element.shape.name != "tet":
            return None
        functions, signs, keys, left_out = _numbered(np.concatenate(mesh.blocks), element, loaded)
        return cls(
            mesh=mesh,
            materials=materials,
            functions=functions,
            signs=signs,
            keys=keys,
            stiffness=_assembled(mesh, materials, functions, signs, len(left_out)),
            left_out=np.repeat(left_out, 3),
        )

    def motion(self, interface: Interface) -> Any:
        """Operator (3q, 3f) from the functions to opening and slips [m per m] at the points where two faces meet."""
        first = self._on_face(interface.first_nodes, interface.first_values)
        second = self._on_face(interface.second_nodes, interface.second_values)
        total = interface.motion_of(first, second, len(self.left_out))
        total.sum_duplicates()
        return total

    def _on_face(self, nodes: Index, shapes: Array) -> tuple[Index, Array]:
        """Numbers and values (q, s) of functions of element faces, at points where nodes have these shapes (q, a)."""
        face = FACES[nodes.shape[1]]
        corners = nodes[:, : face.corners]
        places = shapes @ face.nodes
        share = np.column_stack([1 - places.sum(axis=1), places])  # of each corner: barycentric
        edges = corners[:, [[0, 1], [1, 2], [2, 0]]]
        here, there = share, np.roll(share, -1, axis=1)
        values, keys = here * there, [_keys(edges, len(self.mesh.points))]
        if face.order == 2:
            ordered = np.where(edges[..., 0] < edges[..., 1], 1.0, -1.0)
            values = np.column_stack([values * (here - there) * ordered, share.prod(axis=1)])
            keys.append(_keys(corners[:, None], len(self.mesh.points)))
        first = np.cumsum([0, *map(len, self.keys)])
        numbers = [
            start + np.searchsorted(known, key) for start, known, key in zip(first, self.keys, keys, strict=False)
        ]
        return np.concatenate(numbers, axis=1), values

    def error(self, shapes: Array, squares: Array, joints: Sequence[tuple[Interface, Array, Array]] = ()) -> Array:
        """Relative error of the square of each circular frequency [-] (m,), 0 or more: a finer mesh has it lower.

        Args:
            shapes: modes of unit mass (unknowns, m) [kg^-1/2].
            squares: of their circular frequencies (m,) [1/s2], above 0.
            joints: where two faces meet, and the springs k_n, k_t [Pa/m] (q,) there.
        """
        residual, springs = self._residual(shapes, squares), []
        for interface, k_n, k_t in joints:
            motion = self.motion(interface)
            share = (interface.weights[:, None] * np.stack([k_n, k_t, k_t], axis=1)).reshape(-1, 1)
            residual -= motion.T @ (share * (interface.relative @ shapes))
            springs.append((motion, share))
        residual[self.left_out] = 0.0
        return self._energy(springs, residual) / squares

    def _residual(self, shapes: Array, squares: Array) -> Array:
        """What modes leave of the equations, tested with the functions (3 f, m)."""
        fields = shapes.reshape(len(self.mesh.points), 3, -1)
        m = fields.shape[2]
        out = np.zeros((len(self.left_out) // 3, 3 * m))
        for name, cells, here in chunks(self.mesh, CHUNK):
            solid, at = self.materials[name], _AtPoints.of(self.mesh.points[cells], self.signs[here])
            u = fields[cells]
            slope = np.einsum("eqaj,eaim->eqjim", at.own_slopes, u, optimize=True)
            stress = at.weights[:, :, None, None, None] * stress_of(slope, solid)
            force = -np.einsum("eqsj,eqjim->esim", at.slopes, stress, optimize=True)
            heavy = (solid.density or 0.0) * at.weights
            momentum = np.einsum("eqs,qa,eq->esa", at.values, at.own_values, heavy, optimize=True)
            force += np.einsum("esa,eaim->esim", momentum, u * squares, optimize=True)
            add_rows(out, self.functions[here].ravel(), force.reshape(-1, 3 * m))
        return out.reshape(-1, m)

    def _energy(self, springs: Sequence[tuple[Any, Array]], force: Array) -> Array:
        """f K^-1 f of each column (m,), by conjugate gradients from below; functions that are left out stay 0.

        K: the stiffness of the parts and of the joints, each by its motion (3q, 3f) and its springs [N/m] (3q, 1).
        """
        diagonal = self.stiffness.diagonal()[:, None] + sum(motion.power(2).T @ share for motion, share in springs)
        rest, solved = force.copy(), np.zeros(force.shape[1])
        along = rest / diagonal
        size = np.einsum("im,im->m", rest, along)
        for _ in range(STEPS):
            pushed = product(self.stiffness, along)
            for motion, share in springs:
                pushed += motion.T @ (share * (motion @ along))
            pushed[self.left_out] = 0.0
            step = size / np.maximum(np.einsum("im,im->m", along, pushed), TINY)
            solved += step * size  # each step adds so much to f x, as its direction is conjugate to those before
            rest -= step * pushed
            scaled = rest / diagonal
            size, before = np.einsum("im,im->m", rest, scaled), size
            along = scaled + along * (size / np.maximum(before, TINY))
        return solved


@dataclass(frozen=True, kw_only=True)
class _AtPoints:
    """Values and gradients in space of an element's own functions (a) and of those one degree higher (s).

    own_values (q, a), own_slopes (e, q, a, 3) [1/m], values (e, q, s), slopes (e, q, s, 3) [1/m], weights (e, q) [m3].
    """

    own_values: Array
    own_slopes: Array
    values: Array
    slopes: Array
    weights: Array

    @classmethod
    def of(cls, nodes: Array, signs: Array) -> "_AtPoints":
        """At the points of elements whose nodes (e, a, 3) [m] are given."""
        element = SOLIDS[nodes.shape[1]]
        local, weights, own, gradients = element.rule(DEGREE)
        values, slopes = _higher(element, local.T)
        jacobian = np.einsum("eai,qaj->eqij", nodes, gradients, optimize=True)
        inverse = np.linalg.inv(jacobian)
        return cls(
            own_values=own,
            own_slopes=np.einsum("qaj,eqji->eqai", gradients, inverse, optimize=True),
            values=values * signs[:, None],
            slopes=np.einsum("qsj,eqji->eqsi", slopes, inverse, optimize=True) * signs[:, None, :, None],
            weights=np.linalg.det(jacobian) * weights,
        )


def _keys(corners: Index, n: int) -> Index:
    """One number for each set of two or three corners (..., c), whatever their order; n: of nodes."""
    ordered = np.sort(corners, axis=-1).astype(np.int64)
    out = ordered[..., 0]
    for k in range(1, ordered.shape[-1]):
        out = out * n + ordered[..., k]
    return out


def _numbered(cells: Index, element: Element, loaded: Mask) -> tuple[Index, Array, list[Index], Mask]:
    """Functions of each element (e, s), their signs (e, s), the keys of all, and which functions (f,) are left out."""
    edges = np.stack([cells[:, list(pair)] for pair in element.edges], axis=1)
    keys, flags = [_keys(edges, len(loaded))], [loaded[edges].all(axis=2)]
    signs = np.ones(edges.shape[:2])
    if element.order == 2:
        signs = np.where(edges[..., 0] < edges[..., 1], 1.0, -1.0)
        sides = np.stack([cells[:, list(side)] for side in element.shape.sides], axis=1)
        keys.append(_keys(sides, len(loaded)))
        flags.append(loaded[sides].all(axis=2))
        signs = np.concatenate([signs, np.ones(sides.shape[:2])], axis=1)
    known, functions, first = [], [], 0
    for key in keys:
        some, number = np.unique(key, return_inverse=True)
        functions.append(number.reshape(key.shape) + first)
        known.append(some)
        first += len(some)
    every = np.concatenate(functions, axis=1)
    left_out = np.zeros(first, dtype=bool)
    left_out[every[np.concatenate(flags, axis=1)]] = True
    return every, signs, known, left_out


def _higher(element: Element, places: Array) -> tuple[Array, Array]:
    """Functions one degree higher (q, s) and their local gradients (q, s, 3) at places (q, 3): edges, then faces."""
    corner = np.column_stack([1 - places.sum(axis=1), places])
    slope = np.vstack([-np.ones(3), np.eye(3)])
    values, slopes = [], []
    for a, b in element.edges:
        value = corner[:, a] * corner[:, b]
        change = corner[:, a, None] * slope[b] + corner[:, b, None] * slope[a]
        if element.order == 2:
            odd = corner[:, a] - corner[:, b]
            change = change * odd[:, None] + value[:, None] * (slope[a] - slope[b])
            value = value * odd
        values.append(value)
        slopes.append(change)
    for side in element.shape.sides if element.order == 2 else ():
        a, b, c = side
        x, y, z = corner[:, a, None], corner[:, b, None], corner[:, c, None]
        values.append((x * y * z)[:, 0])
        slopes.append(y * z * slope[a] + x * z * slope[b] + x * y * slope[c])
    return np.stack(values, axis=1), np.stack(slopes, axis=1)


def _assembled(mesh: SolidMesh, materials: Mapping[str, Solid], functions: Index, signs: Array, count: int) -> Any:
    """Stiffness of the functions (3 f, 3 f) [N/m]."""
    pairs, slot = np.unique(pair_keys((functions,), count), return_inverse=True)
    slot, total = slot.reshape(len(functions), -1), np.zeros((len(pairs), 9))
    straight = mesh.points[edge_ends(mesh.blocks, SOLIDS, len(mesh.points))].mean(axis=1)
    for name, cells, here in chunks(mesh, CHUNK):
        at, solid = _AtPoints.of(straight[cells], signs[here]), materials[name]
        # the rule has a point of negative weight, whose root stiffness_of cannot take
        block = stiffness_of(at.slopes, np.maximum(at.weights, 0.0), solid.E, solid.nu)
        block -= stiffness_of(at.slopes, np.maximum(-at.weights, 0.0), solid.E, solid.nu)
        add_rows(total, slot[here].ravel(), pair_blocks(functions[here], block))
    return of_pairs(pairs, total, count)
