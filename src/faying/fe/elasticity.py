"""Stiffness and mass of isotropic solids, assembled without a loop over elements."""

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from faying.fe.elements import reference
from faying.fe.mesh import Array, Index, Mesh

CHUNK = 4000  # elements at a time: keeps the blocks in cache and bounds the memory


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


def _jacobians(points: Array, cells: Index, gradients: Array) -> tuple[Array, Array]:
    """Gradients in space (e, q, a, 3) and determinants (e, q)."""
    jacobian = np.einsum("eai,qaj->eqij", points[cells], gradients, optimize=True)
    inverse = np.linalg.inv(jacobian)
    return np.einsum("qaj,eqji->eqai", gradients, inverse, optimize=True), np.linalg.det(jacobian)


def element_stiffness(points: Array, cells: Index, E: float, nu: float) -> Array:
    """Element stiffness [N/m], shape (e, a, 3, a, 3): four Gauss points, exact for straight elements."""
    _, weights, _, gradients = reference("tet10", 2)
    lam, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    g, det = _jacobians(points, cells, gradients)
    scaled = g * np.sqrt(det * weights)[..., None, None]
    e, q, a, _ = scaled.shape
    flat = scaled.reshape(e, q, 3 * a)
    products = (flat.transpose(0, 2, 1) @ flat).reshape(e, a, 3, a, 3)
    trace = np.einsum("eaibi->eab", products)
    block = lam * products + mu * products.transpose(0, 1, 4, 3, 2)
    block += mu * trace[:, :, None, :, None] * np.eye(3)[None, None, :, None, :]
    return block


def element_mass(points: Array, cells: Index, density: float) -> Array:
    """Consistent element mass between nodes [kg], shape (e, a, a)."""
    _, weights, values, gradients = reference("tet10", 4)
    jacobian = np.einsum("eai,qaj->eqij", points[cells], gradients, optimize=True)
    det = np.linalg.det(jacobian)
    return np.asarray(density * np.einsum("eq,qa,qb->eab", det * weights, values, values, optimize=True))


def _pattern(cells: Index, nodes: int) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], Index]:
    """Order of all (row, column) node pairs, where each distinct pair starts, its column, and the row pointer."""
    a = cells.shape[1]
    key = np.repeat(cells, a, axis=1) * nodes + np.tile(cells, (1, a))
    order = np.argsort(key, axis=None, kind="stable")
    ranked = key.ravel()[order]
    starts = np.flatnonzero(np.concatenate([[True], ranked[1:] != ranked[:-1]]))
    pairs = ranked[starts]
    pointer = np.searchsorted(pairs, np.arange(nodes + 1, dtype=np.int64) * nodes)
    return order, starts, pairs % nodes, pointer


def assemble(mesh: Mesh, materials: Mapping[str, Solid]) -> tuple[Any, Any]:
    """Return stiffness [N/m] and mass [kg] of all parts as sparse CSR matrices (3n, 3n), node by node x, y, z.

    materials: part -> its material. The parts are not connected; joints add to these matrices.
    """
    from scipy.sparse import bsr_array

    cells = np.concatenate(list(mesh.parts.values()))
    n, count = len(mesh.points), len(cells)
    stiff, mass = np.empty((count, 10, 10, 3, 3)), np.empty((count, 10, 10))
    first = 0
    for name, block in mesh.parts.items():
        solid = materials[name]
        for begin in range(0, len(block), CHUNK):
            some = block[begin : begin + CHUNK]
            here = slice(first + begin, first + begin + len(some))
            stiff[here] = element_stiffness(mesh.points, some, solid.E, solid.nu).transpose(0, 1, 3, 2, 4)
            mass[here] = element_mass(mesh.points, some, solid.density or 0.0)
        first += len(block)
    order, starts, columns, pointer = _pattern(cells, n)
    blocks = np.add.reduceat(stiff.reshape(-1, 3, 3)[order], starts)
    weights = np.add.reduceat(mass.reshape(-1)[order], starts)
    shape = (3 * n, 3 * n)
    K = bsr_array((blocks, columns, pointer), shape=shape).tocsr()
    M = bsr_array((weights[:, None, None] * np.eye(3), columns, pointer), shape=shape).tocsr()
    M.eliminate_zeros()
    return (K + K.T) * 0.5, (M + M.T) * 0.5


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


def face_load(points: Array, triangles: Index, axis_point: Array, direction: Array) -> Array:
    """Nodal forces [N] (3n,) of a total force 1 N along `direction` whose line of action passes through `axis_point`.

    The traction is uniform up to a linear part across the face, just enough to bring the resultant on the line: two such
    loads on one line with opposite directions balance exactly, whatever the meshes of their faces.
    """
    _, weights, values, gradients = reference("tri6", 4)
    _, area = surface_frame(points, triangles, gradients)
    unit = direction / np.linalg.norm(direction)
    helper = np.eye(3)[np.argmin(np.abs(unit))]
    across = np.stack([np.cross(unit, helper), np.cross(unit, np.cross(unit, helper))])
    across /= np.linalg.norm(across, axis=1)[:, None]
    place = np.einsum("fai,qa->fqi", points[triangles], values) - axis_point
    radius = float(np.sqrt((area * weights).sum()))
    basis = np.concatenate([np.ones((*area.shape, 1)), place @ across.T / radius], axis=2)
    share = area * weights
    gram = np.einsum("fq,fqi,fqj->ij", share, basis, basis)
    traction = basis @ np.linalg.solve(gram, [1.0, 0.0, 0.0])
    total = np.zeros(len(points))
    np.add.at(total, triangles.ravel(), np.einsum("fq,qa->fa", share * traction, values).ravel())
    return np.asarray(total[:, None] * unit).reshape(-1)


def face_centre(points: Array, triangles: Index) -> tuple[Array, Array, float]:
    """Centre [m] (3,), mean unit normal (3,), and area [m2] of a face."""
    _, weights, values, gradients = reference("tri6", 4)
    normals, area = surface_frame(points, triangles, gradients)
    share = area * weights
    place = np.einsum("fai,qa->fqi", points[triangles], values)
    normal = np.einsum("fq,fqi->i", share, normals)
    return np.einsum("fq,fqi->i", share, place) / share.sum(), normal / np.linalg.norm(normal), float(share.sum())


def surface_frame(points: Array, triangles: Index, gradients: Array) -> tuple[Array, Array]:
    """Unit normals (f, q, 3) and area per reference area (f, q) on curved triangles."""
    tangent = np.einsum("fai,qaj->fqij", points[triangles], gradients, optimize=True)
    normal = np.cross(tangent[..., 0], tangent[..., 1])
    area = np.linalg.norm(normal, axis=-1)
    return normal / area[..., None], area
