"""The discrete body: forces, energy and tangent of a displacement, and the sparse matrix they are put into.

The four-node axisymmetric quadrilateral with a mean dilatation (B-bar), so that plastic flow does not lock.

Strains and stresses are ordered rr, zz, tt (hoop), rz; the shear strain is the engineering one.
Source: T. J. R. Hughes, Int. J. Numer. Meth. Eng. 15 (1980) 1413-1418, doi:10.1002/nme.1620150914.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from asperity_fe.mesh import CapMesh
from asperity_fe.plasticity import Flow, Returned, return_map
from faying.errors import InputError
from faying.materials import Material
from faying.typing import Array, Index

_G = 1 / np.sqrt(3)
_CORNER = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], float)
_POINT = _CORNER * _G


@dataclass(frozen=True)
class Quads:
    """Strain operators at the 2 x 2 Gauss points of quadrilaterals with corners (m, 4, 2) [m].

    weight (m, 4): volume of each point over the full turn [m3]; B (m, 4, 4, 8): strain = B u with the mean dilatation,
    u ordered r, z per node; place (m, 4, 2): the points [m]. Raises InputError where an element is turned inside out.
    """

    corners: Array

    @cached_property
    def _shape(self) -> Array:
        xi, eta = _POINT[:, :1], _POINT[:, 1:]
        return np.asarray(0.25 * (1 + xi * _CORNER[:, 0]) * (1 + eta * _CORNER[:, 1]))  # (4 points, 4 nodes)

    @cached_property
    def _slopes(self) -> tuple[Array, Array]:
        xi, eta = _POINT[:, :1], _POINT[:, 1:]
        local = 0.25 * np.stack(
            [_CORNER[:, 0] * (1 + eta * _CORNER[:, 1]), _CORNER[:, 1] * (1 + xi * _CORNER[:, 0])], axis=1
        )  # (points, 2, nodes)
        jacobian = np.einsum("gan,enb->egab", local, self.corners)
        det = np.linalg.det(jacobian)
        if np.any(det <= 0):
            raise InputError(f"{np.sum(np.any(det <= 0, axis=1))} elements of the mesh are turned inside out")
        return np.linalg.solve(jacobian, np.broadcast_to(local, (len(self.corners), *local.shape))), det

    @cached_property
    def place(self) -> Array:
        """The Gauss points (m, 4, 2) [m]."""
        return np.asarray(np.einsum("gn,enb->egb", self._shape, self.corners))

    @cached_property
    def weight(self) -> Array:
        """Volume of each Gauss point (m, 4) [m3]."""
        return np.asarray(2 * np.pi * self.place[..., 0] * self._slopes[1])

    @cached_property
    def plain(self) -> Array:
        """Strain operators (m, 4, 4, 8) before the dilatation is averaged: fully integrated elements, which lock."""
        slopes, _ = self._slopes
        radius = self.place[..., 0]
        m = len(self.corners)
        B = np.zeros((m, 4, 4, 8))
        B[..., 0, 0::2] = slopes[:, :, 0]
        B[..., 1, 1::2] = slopes[:, :, 1]
        B[..., 2, 0::2] = self._shape / radius[..., None]
        B[..., 3, 0::2] = slopes[:, :, 1]
        B[..., 3, 1::2] = slopes[:, :, 0]
        return B

    @cached_property
    def B(self) -> Array:
        """Strain operators (m, 4, 4, 8)."""
        B = self.plain.copy()
        dilatation = B[..., :3, :].sum(axis=-2)
        mean = np.einsum("eg,egi->ei", self.weight, dilatation) / self.weight.sum(axis=1)[:, None]
        B[..., :3, :] += ((mean[:, None] - dilatation) / 3)[..., None, :]
        return B


SOFT = 1e-7  # share of the elastic stiffness kept along the direction of flow, so that the tangent stays definite


@dataclass(frozen=True, kw_only=True)
class CapState:
    """Plastic strain (p, 4), tensor shear, and equivalent plastic strain (p,) at the Gauss points."""

    plastic: Array
    hardened: Array


@dataclass(frozen=True, kw_only=True)
class Balance:
    """What a displacement asks for: internal forces (unknowns,) [N], energy [J] and the stress return behind them."""

    force: Array
    energy: float
    returned: Returned


@dataclass(frozen=True, kw_only=True)
class Spring:
    """An elastic body condensed to some degrees of freedom of the mesh: stiffness (d, d) [N/m]."""

    dofs: Index
    stiffness: Array


@dataclass(frozen=True, kw_only=True)
class Body:
    """Elements of a mesh with their materials and supports.

    materials, hardening (tangent modulus over E): by the number in mesh.body; constrained: degrees of freedom (2 node +
    component) kept at zero; elements: those of the mesh that belong to this body; far: what they rest on, if anything.
    """

    mesh: CapMesh
    materials: Sequence[Material]
    hardening: Sequence[float]
    constrained: Index
    elements: Index
    far: Spring | None = None

    @cached_property
    def _quads(self) -> Index:
        return self.mesh.quads[self.elements]

    @cached_property
    def quads(self) -> Quads:
        """Geometry of the elements."""
        return Quads(self.mesh.nodes[self._quads])

    @cached_property
    def flow(self) -> Flow:
        """Constants at the Gauss points; a material without a yield strength stays elastic."""
        E = np.array([m.E for m in self.materials])
        nu = np.array([m.nu for m in self.materials])
        strength = np.array([np.inf if m.yield_strength is None else m.yield_strength for m in self.materials])
        ratio = np.array(self.hardening)
        each = np.repeat(self.mesh.body[self.elements], 4)
        return Flow(
            bulk=(E / (3 * (1 - 2 * nu)))[each],
            shear=(E / (2 * (1 + nu)))[each],
            strength=strength[each],
            modulus=(E * ratio / (1 - ratio))[each],  # from the tangent modulus Et = ratio E of a tension test
        )

    @cached_property
    def virgin(self) -> CapState:
        """The state before any load."""
        points = 4 * len(self.elements)
        return CapState(plastic=np.zeros((points, 4)), hardened=np.zeros(points))

    # degrees of freedom

    @cached_property
    def unknown_of_dof(self) -> Index:
        """Number of each degree of freedom of the mesh among the unknowns; -1 where constrained or not of this body."""
        number = np.full(2 * len(self.mesh.nodes), -1)
        number[2 * self._quads] = number[2 * self._quads + 1] = 0
        number[self.constrained] = -1
        number[number == 0] = np.arange(np.sum(number == 0))
        return number

    @cached_property
    def size(self) -> int:
        """Number of unknowns."""
        return int(self.unknown_of_dof.max()) + 1

    @cached_property
    def touching(self) -> Index:
        """The unknowns that are the heights of the surface nodes, from the axis outwards."""
        return self.unknown_of_dof[2 * self.surface + 1]

    @cached_property
    def surface(self) -> Index:
        """The surface nodes of this body, from the axis outwards."""
        return self.mesh.surface[self.unknown_of_dof[2 * self.mesh.surface + 1] >= 0]

    @cached_property
    def _dofs(self) -> Index:
        """Unknowns of each element (m, 8); constrained ones point one past the end."""
        q = self._quads
        number = self.unknown_of_dof[np.stack([2 * q, 2 * q + 1], axis=-1).reshape(len(q), 8)]
        return np.where(number < 0, self.size, number)

    def spread(self, unknowns: Array) -> Array:
        """Return the displacements (nodes, 2) of a vector of unknowns."""
        full = np.append(unknowns, 0.0)
        return full[np.where(self.unknown_of_dof < 0, self.size, self.unknown_of_dof)].reshape(-1, 2)

    # forces

    @cached_property
    def _weight(self) -> Array:
        return self.quads.weight.reshape(-1)

    @cached_property
    def _B(self) -> Array:
        """(m, 16, 8): the strain operators of an element's four points, one under another."""
        return np.ascontiguousarray(self.quads.B.reshape(-1, 16, 8))

    def strain(self, unknowns: Array) -> Array:
        """Strain at the Gauss points (p, 4)."""
        local = np.append(unknowns, 0.0)[self._dofs]
        return np.asarray((self._B @ local[..., None]).reshape(-1, 4))

    def balance(self, unknowns: Array, state: CapState) -> Balance:
        """Forces and energy of a displacement reached in one step from `state`."""
        returned = return_map(self.flow, self.strain(unknowns), state.plastic, state.hardened)
        pull = (returned.stress * self._weight[:, None]).reshape(-1, 1, 16)
        local = (pull @ self._B).reshape(-1)
        force = np.asarray(
            np.bincount(self._dofs.reshape(-1), weights=local, minlength=self.size + 1)[: self.size], float
        )
        energy = float(self._weight @ returned.energy)
        if self.far is not None:
            places = self.unknown_of_dof[self.far.dofs]
            pull_back = self.far.stiffness @ unknowns[places]
            force[places] += pull_back
            energy += 0.5 * float(unknowns[places] @ pull_back)
        return Balance(force=force, energy=energy, returned=returned)

    # tangent

    @cached_property
    def _pattern(self) -> tuple[Index, Index, Index]:
        """Columns and row pointers of the matrix; where each element's 64 entries, then the springs', go in it."""
        rows = np.repeat(self._dofs, 8, axis=1).reshape(-1)
        columns = np.tile(self._dofs, (1, 8)).reshape(-1)
        if self.far is not None:
            places = self.unknown_of_dof[self.far.dofs]
            rows = np.concatenate([rows, np.repeat(places, len(places))])
            columns = np.concatenate([columns, np.tile(places, len(places))])
        inside = (rows < self.size) & (columns < self.size)
        key = np.where(inside, rows * self.size + columns, self.size * self.size)
        unique, where = np.unique(key, return_inverse=True)
        if unique[-1] == self.size * self.size:
            unique = unique[:-1]
        pointers = np.searchsorted(unique, np.arange(self.size + 1) * self.size)
        return unique % self.size, pointers, where

    @cached_property
    def _rows(self) -> Index:
        _, pointers, _ = self._pattern
        return np.repeat(np.arange(self.size), np.diff(pointers))

    @cached_property
    def _diagonal(self) -> Index:
        return np.flatnonzero(self._rows == self._pattern[0])

    @cached_property
    def _deviator(self) -> Array:
        """(m, 4, 64): 2 G w B^T I_dev B of each Gauss point."""
        B = self.quads.B.copy()
        B[..., :3, :] -= B[..., :3, :].mean(axis=-2, keepdims=True)
        B[..., 3, :] *= np.sqrt(0.5)
        scale = np.sqrt(2 * self.flow.shear * self._weight).reshape(-1, 4)
        B *= scale[..., None, None]
        return np.ascontiguousarray((B.transpose(0, 1, 3, 2) @ B).reshape(-1, 4, 64))

    @cached_property
    def _elastic(self) -> Array:
        """Data of the elastic matrix."""
        dilatation = self.quads.B[..., :3, :].sum(axis=-2)
        dilatation *= np.sqrt(self.flow.bulk * self._weight).reshape(-1, 4, 1)
        local = dilatation.transpose(0, 2, 1) @ dilatation
        entries = (local.reshape(-1, 64) + self._deviator.sum(axis=1)).reshape(-1)
        if self.far is not None:
            entries = np.concatenate([entries, self.far.stiffness.reshape(-1)])
        return self._gather(entries, self._pattern[2])

    def _gather(self, entries: Array, where: Index) -> Array:
        size = len(self._pattern[0])
        return np.asarray(np.bincount(where, weights=entries, minlength=size + 1)[:size], float)

    @cached_property
    def _where(self) -> Index:
        return self._pattern[2][: 64 * len(self.elements)].reshape(-1, 64)

    @cached_property
    def elastic(self) -> Any:
        """The elastic stiffness as a sparse matrix (CSR)."""
        from scipy.sparse import csr_matrix

        columns, pointers, _ = self._pattern
        return csr_matrix((self._elastic, columns, pointers), shape=(self.size, self.size))

    def tangent(self, returned: Returned) -> Any:
        """Consistent tangent [N/m], symmetric positive definite, as a sparse matrix (CSR)."""
        from scipy.sparse import csr_matrix

        columns, pointers, _ = self._pattern
        yielding = returned.yielding.reshape(-1, 4)
        elements = np.flatnonzero(yielding.any(axis=1))
        data = self._elastic
        if len(elements):
            theta = returned.theta.reshape(-1, 4)[elements]
            bar = np.minimum(returned.theta_bar, returned.theta - SOFT).reshape(-1, 4)[elements]
            bar = np.where(yielding[elements], bar, 0.0)
            drop = ((theta - 1)[:, None, :] @ self._deviator[elements])[:, 0]
            n = returned.direction.reshape(-1, 4, 1, 4)[elements]
            along = (n @ self.quads.B[elements])[:, :, 0, :]  # (e, 4, 8)
            scale = np.sqrt(2 * self.flow.shear * self._weight).reshape(-1, 4)[elements] * np.sqrt(np.maximum(bar, 0))
            along = along * scale[..., None]
            drop -= (along.transpose(0, 2, 1) @ along).reshape(-1, 64)
            data = data + self._gather(drop.reshape(-1), self._where[elements].reshape(-1))
        return csr_matrix((data, columns, pointers), shape=(self.size, self.size))

    def fixed(self, matrix: Any, pinned: Index) -> Any:
        """Return `matrix` with the rows and columns of `pinned` unknowns emptied, the diagonal kept: same pattern."""
        from scipy.sparse import csr_matrix

        mask = np.zeros(self.size, bool)
        mask[pinned] = True
        data = matrix.data.copy()
        columns, pointers, _ = self._pattern
        data[mask[self._rows] | mask[columns]] = 0.0
        spots = self._diagonal[pinned]
        data[spots] = self._elastic[spots]
        return csr_matrix((data, columns, pointers), shape=matrix.shape)
