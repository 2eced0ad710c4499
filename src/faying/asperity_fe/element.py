"""The four-node axisymmetric quadrilateral with a mean dilatation (B-bar), so that plastic flow does not lock.

Strains and stresses are ordered rr, zz, tt (hoop), rz; the shear strain is the engineering one.
Source: T. J. R. Hughes, Int. J. Numer. Meth. Eng. 15 (1980) 1413-1418, doi:10.1002/nme.1620150914.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from faying.errors import InputError
from faying.typing import Array

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
