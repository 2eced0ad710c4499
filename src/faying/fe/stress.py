"""Stress of solids at their nodes, recovered from the points of integration and averaged over elements of a part."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from faying.fe.elasticity import Solid, stress_of
from faying.fe.elements import SOLIDS
from faying.fe.elements.element import Element, gradients_in_space
from faying.fe.sides import nodes_of
from faying.fe.solids import SolidMesh
from faying.typing import Array, Index

CHUNK = 20_000  # elements at a time
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))  # of the axes, in the order of the six components
PLACES = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])  # of the components in the tensor
# von Mises' stress squared is s' SQUARE s
SQUARE = np.zeros((6, 6))
SQUARE[:3, :3] = 1.5 * np.eye(3) - 0.5
SQUARE[3:, 3:] = 3.0 * np.eye(3)


@dataclass(frozen=True, kw_only=True)
class PartStress:
    """Stress of one part at its nodes.

    Args:
        nodes: Nodes of the part (n,).
        stress: xx, yy, zz, xy, yz, zx at each node, under each motion (n, 6, k) [Pa].
        spread: Deviation of the elements at a node from their mean, as a stress of von Mises (n, k) [Pa]: what the mesh
            leaves open there.
    """

    nodes: Index
    stress: Array
    spread: Array

    @property
    def von_mises(self) -> Array:
        """Von Mises' stress (n, k) [Pa]."""
        return von_mises(self.stress)

    @property
    def principal(self) -> tuple[Array, Array]:
        """Greatest and least principal stress (n, k) [Pa], tension above 0."""
        least, _, greatest = np.moveaxis(np.linalg.eigvalsh(np.moveaxis(self.stress[:, PLACES], -1, 1)), -1, 0)
        return greatest, least


def von_mises(stress: Array) -> Array:
    """Von Mises' stress (n, k) of stresses (n, 6, k) [Pa]."""
    return np.asarray(np.sqrt(np.maximum(np.einsum("nik,ij,njk->nk", stress, SQUARE, stress, optimize=True), 0.0)))


def part_stresses(
    mesh: SolidMesh, materials: Mapping[str, Solid], motion: Array, strains: Mapping[str, float] | None = None
) -> dict[str, PartStress]:
    """The stress of every part under motions.

    Args:
        mesh: The parts.
        materials: Of each.
        motion: Displacements [m] (unknowns, k).
        strains: Part -> free expansion [-] by heat, of which there is no stress.
    """
    moved = motion.reshape(len(mesh.points), 3, -1)
    out = {}
    for name, blocks in mesh.parts.items():
        nodes = nodes_of(blocks)
        place = np.full(len(mesh.points), -1)
        place[nodes] = np.arange(len(nodes))
        weight, total = np.zeros(len(nodes)), np.zeros((len(nodes), 6, moved.shape[2]))
        squares = np.zeros((len(nodes), moved.shape[2]))
        solid, free = materials[name], (strains or {}).get(name, 0.0)
        for cells in blocks:
            for begin in range(0, len(cells), CHUNK):
                some = cells[begin : begin + CHUNK]
                stress, volume = _at_nodes(mesh.points, some, solid, moved, free)
                here = place[some]
                np.add.at(weight, here, volume[:, None])
                np.add.at(total, here, volume[:, None, None, None] * stress)
                square = np.einsum("eaik,ij,eajk->eak", stress, SQUARE, stress, optimize=True)
                np.add.at(squares, here, volume[:, None, None] * square)
        mean = total / weight[:, None, None]
        spread = squares / weight[:, None] - von_mises(mean) ** 2
        out[name] = PartStress(nodes=nodes, stress=mean, spread=np.sqrt(np.maximum(spread, 0.0)))
    return out


def greatest_stresses(found: Mapping[str, PartStress], points: Array) -> tuple[Array, Array, Array]:
    """The greatest stress of von Mises of each part under each motion.

    Returns:
        Its size (part, k) [Pa], its place (part, 3, k) [m], and the spread over it (part, k) [-] of the elements there.
    """
    sizes, places, spreads = [], [], []
    for one in found.values():
        size = one.von_mises
        worst, every = np.argmax(size, axis=0), np.arange(size.shape[1])
        sizes.append(size[worst, every])
        places.append(points[one.nodes[worst]].T)
        spreads.append(one.spread[worst, every] / np.where(sizes[-1] > 0, sizes[-1], 1.0))
    return np.array(sizes), np.array(places), np.array(spreads)


def at_outline(found: Mapping[str, PartStress], count: int, nodes: Index) -> dict[str, Array]:
    """Stress [Pa] (k, nodes) at some of the `count` nodes of a mesh; the farther from 0 where parts share one.

    Returns:
        That of von Mises, and the greatest and the least principal stress, as `OuterStress` has them.
    """
    every = np.zeros((3, count, next(iter(found.values())).stress.shape[2]))
    for one in found.values():
        fields, known = np.array([one.von_mises, *one.principal]), every[:, one.nodes]
        every[:, one.nodes] = np.where(np.abs(fields) > np.abs(known), fields, known)
    return dict(zip(("von_mises", "tension", "compression"), np.swapaxes(every[:, nodes], 1, 2), strict=True))


def _at_nodes(points: Array, cells: Index, solid: Solid, moved: Array, free: float) -> tuple[Array, Array]:
    """Stress of elements of one kind at their nodes (e, a, 6, k) [Pa], and their volumes (e,)."""
    element = SOLIDS[cells.shape[1]]
    _, weights, _, gradients = element.stiffness_rule
    g, det = gradients_in_space(points, cells, gradients)
    slope = np.einsum("eqai,eajk->eqijk", g, moved[cells], optimize=True)
    tensor = stress_of(slope, solid)
    stress = np.stack([tensor[:, :, i, j] for i, j in PAIRS], axis=2)
    stress[:, :, :3] -= solid.E / (1 - 2 * solid.nu) * free
    return np.einsum("aq,eqik->eaik", _recovery(element), stress, optimize=True), det @ weights


def _recovery(element: Element) -> Array:
    """From the points of the rule to the nodes (a, q): the field of the corners nearest to them in the mean square."""
    linear = SOLIDS[element.corners]
    at_points, _ = linear.at(element.stiffness_rule[0])
    at_nodes, _ = linear.at(element.nodes.T)
    return np.asarray(at_nodes @ np.linalg.pinv(at_points))
