"""Stiffness and mass of isotropic solids of any elements, assembled without a loop over elements."""

from collections.abc import Iterator, Mapping
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


def stiffness_of(g: Array, weights: Array, E: float, nu: float) -> Array:
    """Stiffness (e, a, 3, a, 3) of gradients in space g (e, q, a, 3) at points of weight (e, q) [m3]."""
    lam, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
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


def pairs_of(cells: Index) -> tuple[Index, Index]:
    """Local numbers of every pair of nodes of an element, each pair once."""
    a, b = np.triu_indices(cells.shape[1])
    return a, b


def pair_keys(blocks: Blocks, nodes: int) -> Index:
    """Row times nodes plus column of every pair of nodes of every element, row <= column."""
    out = []
    for cells in blocks:
        a, b = pairs_of(cells)
        first, second = cells[:, a], cells[:, b]
        out.append((np.minimum(first, second) * nodes + np.maximum(first, second)).ravel())
    return np.concatenate(out)


def distinct(key: Index) -> tuple[Index, Index]:
    """The distinct keys in order, and where each key stands among them."""
    order = np.argsort(key, kind="stable")
    ranked = key[order]
    new = np.concatenate([[True], ranked[1:] != ranked[:-1]])
    slot = np.empty(len(key), dtype=np.int64)
    slot[order] = np.cumsum(new) - 1
    return ranked[new], slot


def _chunks(mesh: SolidMesh) -> Iterator[tuple[str, Index]]:
    """Element blocks part by part, a few elements at a time."""
    for name, blocks in mesh.parts.items():
        for cells in blocks:
            some = max(1, CHUNK // cells.shape[1] ** 2)
            for begin in range(0, len(cells), some):
                yield name, cells[begin : begin + some]


def assemble(mesh: SolidMesh, materials: Mapping[str, Solid], *, mass: str = "exact") -> tuple[Any, Any]:
    """Return stiffness [N/m] and mass [kg] of all parts as sparse CSR matrices (3n, 3n), node by node x, y, z.

    materials: part -> its material; mass: "exact", or "stiffness" for the coarser rule of the stiffness, with which
    CalculiX integrates its mass too. The parts are not connected; joints add to these matrices.
    """
    if mass not in ("exact", "stiffness"):
        raise InputError(f"mass = {mass!r} should be exact or stiffness")
    from scipy.sparse import bsr_array, csr_array, get_index_dtype

    n = len(mesh.points)
    pairs, slot = distinct(pair_keys(mesh.blocks, n))
    # only pairs with row <= column are summed, those on the diagonal by half; the rest is the transpose
    stiff, weight = np.zeros((len(pairs), 9)), np.zeros(len(pairs))
    first = 0
    for name, cells in _chunks(mesh):
        solid = materials[name]
        a, b = pairs_of(cells)
        here = slot[first : first + len(cells) * len(a)]
        first += len(here)
        block = element_stiffness(mesh.points, cells, solid.E, solid.nu).transpose(0, 1, 3, 2, 4)[:, a, b]
        swapped = cells[:, a] > cells[:, b]
        block[swapped] = block[swapped].transpose(0, 2, 1)
        add_rows(stiff, here, block.reshape(-1, 9))
        heavy = element_mass(mesh.points, cells, solid.density or 0.0, mass)
        add_rows(weight[:, None], here, heavy[:, a, b].reshape(-1, 1))
    short = get_index_dtype(maxval=max(3 * n, 18 * len(pairs)))  # indices take a third of a matrix
    columns, rows = (pairs % n).astype(short), pairs // n
    half = np.where(rows == columns, 0.5, 1.0)
    pointer = np.searchsorted(rows, np.arange(n + 1)).astype(short)
    stiff *= half[:, None]
    K = bsr_array((stiff.reshape(-1, 3, 3), columns, pointer), shape=(3 * n, 3 * n)).tocsr()
    M = csr_array((weight * half, columns, pointer), shape=(n, n))
    return with_transpose(K), _threefold(with_transpose(M))


def strain_energy(mesh: SolidMesh, part: str, solid: Solid, motion: Array) -> float:
    """Twice the strain energy [J] of a part under a displacement [m] (unknowns,)."""
    moves, total = motion.reshape(-1, 3), 0.0
    for name, cells in _chunks(mesh):
        if name == part:
            stiffness = element_stiffness(mesh.points, cells, solid.E, solid.nu)
            total += float(np.einsum("eai,eaibj,ebj->", moves[cells], stiffness, moves[cells]))
    return total


def add_rows(total: Array, slot: Index, values: Array) -> None:
    """Add rows of values (p, k) to the rows `slot` of total (m, k), where a slot may occur many times."""
    width = total.shape[1]
    places = width * slot[:, None] + np.arange(width)  # of single numbers, which NumPy adds ten times as fast as rows
    np.add.at(total.reshape(-1), places.ravel(), values.ravel())


def with_transpose(upper: Any) -> Any:
    """The symmetric matrix of its upper triangle, which has half of the diagonal."""
    whole = (upper + upper.T).tocsr()
    whole.sort_indices()
    return whole


def _threefold(scalar: Any) -> Any:
    """The same number between like components of two nodes: each entry three times, along the diagonal of a block."""
    from scipy.sparse import csr_array

    n = scalar.shape[0]
    rows = scalar[np.repeat(np.arange(n), 3)]
    component = np.repeat(np.tile(np.arange(3, dtype=rows.indices.dtype), n), np.diff(rows.indptr))
    return csr_array((rows.data, 3 * rows.indices + component, rows.indptr), shape=(3 * n, 3 * n))


def rigid_motions(points: Array) -> Array:
    """Six rigid motions about the centre (3n, 6): three translations, three rotations [m per unit]."""
    x = points - points.mean(axis=0)
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    modes = np.zeros((len(points), 3, 6))
    for i in range(3):
        modes[:, i, i] = 1.0
        axis = np.zeros(3)
        axis[i] = 1 / size
        modes[:, :, 3 + i] = np.cross(axis, x)
    return modes.reshape(-1, 6)
