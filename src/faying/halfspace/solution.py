"""A solved half-space contact: maps, numbers, tangent stiffness."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np

from faying.halfspace.figure import contact_map, pressure_map
from faying.halfspace.kernels import normal_kernel, shear_kernel
from faying.halfspace.maps import ContactMaps
from faying.halfspace.slip import Slip, slip_of
from faying.halfspace.tangent import Tangent, stiffness_on
from faying.style import axes_of
from faying.typing import Array

if TYPE_CHECKING:
    import matplotlib.axes


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class HalfSpaceContact(ContactMaps):
    """A height map pressed against a rigid plane.

    Args:
        heights: as given [m], shape (ny, nx).
        spacing: (dx, dy) [m].
        E_star: contact modulus [Pa].
        nu: Poisson's ratio for tangential loads [-].
        hardness: [Pa], one number or one for each point (ny, nx), or None.
        periodic: whether the map repeats.
        traction: pressure at each point [Pa] (ny, nx).
        displacement: how far the surface has gone down at each point [m] (ny, nx), of mean 0 for a periodic map.
        plane: height of the rigid plane [m].
        residual: the error bound, duality gap over load times rms height [-].
        iterations: Newton steps on the finest map.
        applications: products with the half-space's operator or its inverse on it.
        workers: threads of the transforms.
    """

    def plot(self, axes: Any = None) -> "list[matplotlib.axes.Axes]":
        """Draw which points touch, and the pressure at each point.

        Args:
            axes: two matplotlib axes to draw into; a new figure where None.

        Returns:
            Both axes.

        Raises:
            InputError: for anything but two axes.
        """
        states, pressure = axes_of(axes, 2, height=3.6)
        contact_map(states, self)
        pressure_map(pressure, self)
        return [states, pressure]

    def tangent(self) -> Tangent:
        """Stiffness of this contact against further loading, unloading and shear without slip (see `Tangent`)."""
        unloading = self.normal_stiffness(loading=False)
        saturated = bool(self.at_hardness.any())
        tensor = self.tangential_stiffness()
        return Tangent(
            k_n_loading=self.normal_stiffness(loading=True) if saturated else unloading,
            k_n_unloading=unloading,
            k_t=float(np.trace(tensor)) / 2,
            k_tensor=tensor,
        )

    def normal_stiffness(self, *, loading: bool) -> float:
        """k_n_loading or k_n_unloading of `Tangent` alone [Pa/m]."""
        shape, (dx, dy) = self.heights.shape, self.spacing
        kernel = normal_kernel(shape, dy / dx, periodic=self.periodic, arithmetic=self.arithmetic)
        cells = (self.traction > 0) & ~self.at_hardness if loading else self.traction > 0
        return float(stiffness_on(kernel, cells)[0, 0]) * self.E_star / dx

    def tangential_stiffness(self) -> Array:
        """k_tensor of `Tangent` alone [Pa/m], shape (2, 2): shear without slip along x and y, and their coupling."""
        shape, (dx, dy) = self.heights.shape, self.spacing
        kernel = shear_kernel(shape, dy / dx, self.nu, periodic=self.periodic, arithmetic=self.arithmetic)
        return stiffness_on(kernel, self.traction > 0) * self.E_star / dx

    def slip(self, shear_ratio: float, friction: float, *, tol: float = 1e-6) -> Slip:
        """Partial slip under a tangential load of shear_ratio times friction times the normal load (see `Slip`)."""
        return slip_of(self, shear_ratio, friction, tol=tol)
