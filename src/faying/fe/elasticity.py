"""Stiffness and mass of isotropic solids of any elements, assembled without a loop over elements."""

from collections.abc import Iterator, Mapping
from math import isqrt
from typing import Any, Protocol

import numpy as np

from faying.errors import InputError
from faying.fe.elements import SOLIDS
from faying.fe.sides import Blocks
from faying.fe.solids import SolidMesh
from faying.typing import Array, Index

CHUNK = 100_000  # pairs of nodes at a time: keeps the blocks in cache and bounds the memory


class Solid(Protocol):
    """What the assembly needs to know of a material."""

    @property
    def E(self) -> float:
        """Young's modulus [Pa]."""

    @property
    def nu(self) -> float:
        """Poisson's ratio [-]."""

    @property
    def density(self) -> float | None:
        """Density [kg/m3]."""


def _lame(E: float, nu: float) -> tuple[float, float]:
    """Lame's constants lambda and mu [Pa]."""
    return E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))


def stress_of(slope: Array, solid: Solid) -> Array:
    """Stress (e, q, 3, 3, m) [Pa] of displacement gradients."""
    lam, mu = _lame(solid.E, solid.nu)
    out = mu * (slope + slope.transpose(0, 1, 3, 2, 4))
    trace = lam * (slope[:, :, 0, 0] + slope[:, :, 1, 1] + slope[:, :, 2, 2])
    for k in range(3):
        out[:, :, k, k] += trace
    return np.asarray(out)


def stiffness_of(g: Array, weights: Array, E: float, nu: float) -> Array:
    """Stiffness (e, a, 3, a, 3) of gradients in space g (e, q, a, 3) at points of weight (e, q) [m3]."""
    lam, mu = _lame(E, nu)
    # directions before nodes, so that what is swapped below are whole rows of nodes
    scaled = (g * np.sqrt(weights)[..., None, None]).transpose(0, 1, 3, 2)
    e, q, _, a = scaled.shape
    flat = scaled.reshape(e, q, 3 * a)
    products = (flat.transpose(0, 2, 1) @ flat).reshape(e, 3, a, 3, a)
    block = lam * products
    block += mu * products.transpose(0, 3, 2, 1, 4)
    trace = mu * (products[:, 0, :, 0] + products[:, 1, :, 1] + products[:, 2, :, 2])
    for direction in range(3):
        block[:, direction, :, direction] += trace
    return np.asarray(block.transpose(0, 2, 1, 4, 3))


def element_stiffness(points: Array, cells: Index, E: float, nu: float) -> Array:
    """Element stiffness [N/m], shape (e, a, 3, a, 3), by the rule of each kind; hex8 bends by incompatible modes."""
    return SOLIDS[cells.shape[1]].stiffness(points, cells, lambda g, w: stiffness_of(g, w, E, nu))


def element_mass(points: Array, cells: Index, density: float, rule: str = "exact") -> Array:
    """Consistent element mass between nodes [kg], shape (e, a, a)."""
    element = SOLIDS[cells.shape[1]]
    _, weights, values, gradients = element.mass_rule if rule == "exact" else element.stiffness_rule
    jacobian = np.einsum("eai,qaj->eqij", points[cells], gradients, optimize=True)
    share = density * np.linalg.det(jacobian) * weights
    pairs = (values[:, :, None] * values[:, None, :]).reshape(len(weights), -1)
    return np.asarray((share @ pairs).reshape(len(cells), values.shape[1], values.shape[1]))


def pair_keys(blocks: Blocks, nodes: int) -> Index:
    """Row times nodes plus column of every pair of nodes of every element, row <= column."""
    out = []
    for cells in blocks:
        first, second = (cells[:, local] for local in np.triu_indices(cells.shape[1]))
        out.append((np.minimum(first, second) * nodes + np.maximum(first, second)).ravel())
    return np.concatenate(out)


def pair_blocks(cells: Index, stiffness: Array) -> Array:
    """Blocks (pairs, 9) of element stiffnesses (e, a, 3, a, 3), pair by pair as in `pair_keys`."""
    a, b = np.triu_indices(cells.shape[1])
    blocks = stiffness.transpose(0, 1, 3, 2, 4)[:, a, b]
    swapped = cells[:, a] > cells[:, b]
    blocks[swapped] = blocks[swapped].transpose(0, 2, 1)
    return blocks.reshape(-1, 9)


def of_pairs(pairs: Index, values: Array, nodes: int) -> Any:
    """Symmetric sparse matrix of values (p, k^2), blocks (k, k), at the distinct keys of `pair_keys`.

    Each pair is there once, with row <= column; the rest is the transpose. The values are changed in place.
    """
    from scipy.sparse import bsr_array, get_index_dtype

    k = isqrt(values.shape[1])
    short = get_index_dtype(maxval=max(k * nodes, 2 * values.size))  # indices take a third of a matrix
    rows, columns = pairs // nodes, pairs % nodes
    values *= np.where(rows == columns, 0.5, 1.0)[:, None]  # those on the diagonal are added to themselves
    pointer = np.searchsorted(rows, np.arange(nodes + 1)).astype(short)
    blocks = values.reshape(-1, k, k), columns.astype(short), pointer
    upper = bsr_array(blocks, shape=(k * nodes, k * nodes)).tocsr()
    whole = (upper + upper.T).tocsr()
    whole.sort_indices()
    return whole


def chunks(mesh: SolidMesh, most: int = CHUNK) -> Iterator[tuple[str, Index, slice]]:
    """Part, elements and their place among all of them, as many at a time as have `most` pairs of nodes."""
    first = 0
    for name, blocks in mesh.parts.items():
        for cells in blocks:
            count = max(1, most // cells.shape[1] ** 2)
            for begin in range(0, len(cells), count):
                some = cells[begin : begin + count]
                yield name, some, slice(first, first + len(some))
                first += len(some)


def assemble(mesh: SolidMesh, materials: Mapping[str, Solid], *, mass: str = "exact") -> tuple[Any, Any]:
    """Return stiffness [N/m] and mass [kg] of all parts as sparse CSR matrices (3n, 3n), node by node x, y, z.

    materials: part -> its material; mass: "exact", or "stiffness" for the coarser rule of the stiffness, with which
    CalculiX integrates its mass too. The parts are not connected; joints add to these matrices.
    """
    if mass not in ("exact", "stiffness"):
        raise InputError(f"mass = {mass!r} should be exact or stiffness")
    n = len(mesh.points)
    pairs, slot = np.unique(pair_keys(mesh.blocks, n), return_inverse=True)
    stiff, weight = np.zeros((len(pairs), 9)), np.zeros((len(pairs), 1))
    first = 0
    for name, cells, _ in chunks(mesh):
        solid = materials[name]
        blocks = pair_blocks(cells, element_stiffness(mesh.points, cells, solid.E, solid.nu))
        here = slot[first : first + len(blocks)]
        first += len(here)
        add_rows(stiff, here, blocks)
        heavy = element_mass(mesh.points, cells, solid.density or 0.0, mass)
        a, b = np.triu_indices(cells.shape[1])
        add_rows(weight, here, heavy[:, a, b].reshape(-1, 1))
    return of_pairs(pairs, stiff, n), _threefold(of_pairs(pairs, weight, n))


def strain_energy(mesh: SolidMesh, part: str, solid: Solid, motion: Array) -> float:
    """Twice the strain energy [J] of a part under a displacement [m] (unknowns,)."""
    moves, total = motion.reshape(-1, 3), 0.0
    for name, cells, _ in chunks(mesh):
        if name == part:
            stiffness = element_stiffness(mesh.points, cells, solid.E, solid.nu)
            total += float(np.einsum("eai,eaibj,ebj->", moves[cells], stiffness, moves[cells]))
    return total


def add_rows(total: Array, slot: Index, values: Array) -> None:
    """Add rows of values (p, k) to the rows `slot` of total (m, k), where a slot may occur many times."""
    width = total.shape[1]
    places = width * slot[:, None] + np.arange(width)  # of single numbers, which NumPy adds ten times as fast as rows
    np.add.at(total.reshape(-1), places.ravel(), values.ravel())


def _threefold(scalar: Any) -> Any:
    """The same number between like components of two nodes: each entry three times, along the diagonal of a block."""
    from scipy.sparse import csr_array

    n = scalar.shape[0]
    rows = scalar[np.repeat(np.arange(n), 3)]
    component = np.repeat(np.tile(np.arange(3, dtype=rows.indices.dtype), n), np.diff(rows.indptr))
    return csr_array((rows.data, 3 * rows.indices + component, rows.indptr), shape=(3 * n, 3 * n))


def rigid_motions(points: Array) -> Array:
    """Six rigid motions about the centre (3n, 6): three translations, three rotations [m per unit]."""
    modes = unit_motions(points - points.mean(axis=0))
    modes[:, :, 3:] *= 1 / np.linalg.norm(np.ptp(points, axis=0))
    return modes.reshape(-1, 6)


def unit_motions(arm: Array) -> Array:
    """Motion (..., 3, 6) of places at arms (..., 3) [m] from a point under translations along and turns about axes."""
    turned = np.swapaxes(np.cross(np.eye(3), arm[..., None, :]), -1, -2)
    return np.concatenate([np.broadcast_to(np.eye(3), turned.shape), turned], axis=-1)
