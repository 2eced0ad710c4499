"""Tangent stiffness of a solved contact: one linear problem on a frozen set of points per number."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying.errors import NotConverged
from faying.halfspace.conjugate import constrained_gradients
from faying.halfspace.kernels import Kernel, normal_kernel, shear_kernel
from faying.halfspace.solution import HalfSpaceContact
from faying.typing import Array, Mask

PASSES = 12
AGREEMENT = 1e-5  # between passes; each squares the error that is left


@final
@dataclass(frozen=True, kw_only=True)
class Tangent:
    """Stiffness per nominal area [Pa/m] of a contact at its load; infinite where the surfaces touch everywhere.

    k_n_loading: the load grows; points at hardness stay there and add nothing. k_n_unloading: the load falls by
    little; every touching point is elastic. Without a hardness the two are one. k_t: shear without slip, mean of the
    two directions; k_tensor, shape (2, 2), the directions x and y and their coupling. k_n is k_n_loading.
    """

    k_n_loading: float
    k_n_unloading: float
    k_t: float
    k_tensor: Array

    @property
    def k_n(self) -> float:
        """The stiffness against further load [Pa/m]."""
        return self.k_n_loading


def stiffness_on(kernel: Kernel, cells: Mask) -> Array:
    """Stiffness matrix (c, c), per nominal area, of the set of cells moved as one rigid punch; scaled units.

    The traction of least energy that carries a unit mean load; its energy is the compliance, so that an error e in
    the traction leaves e^2 in the stiffness. Raises NotConverged where the passes do not settle.
    """
    c, n = kernel.components, cells.size
    index = np.flatnonzero(cells)
    if index.size == 0:
        return np.zeros((c, c))
    if index.size == n and not kernel.symbol[0, 0, 0, 0]:
        return np.diag(np.full(c, np.inf))
    s = np.zeros((c, c, n))  # load direction, component, cell
    moved = np.zeros_like(s)
    compliance = np.zeros((c, c))
    for turn in range(PASSES):
        for k in range(c):
            r = -moved[k][:, index]
            r -= r.mean(axis=1, keepdims=True)
            size = float(np.abs(r).max()) or 1.0
            totals = np.zeros(c)
            totals[k] = n if turn == 0 else 0.0
            step = constrained_gradients(
                kernel, index, (r / size).astype(np.float32), totals / size, reduction=3e-3, limit=60
            )[0]
            s[k][:, index] += size * step.astype(np.float64)
            # single precision leaves the totals off by 1e-7: restore them
            s[k][:, index] += ((n * np.eye(c)[k] - s[k].sum(axis=1)) / index.size)[:, None]
            moved[k] = kernel.apply(s[k].reshape(c, *kernel.shape)).reshape(c, -1)
        before, compliance = compliance, np.einsum("kcn,lcn->kl", s, moved) / n
        if np.abs(compliance - before).max() <= AGREEMENT * np.abs(compliance).max():
            return np.asarray(np.linalg.inv((compliance + compliance.T) / 2))
    raise NotConverged(
        f"tangent stiffness: compliance still moves by "
        f"{np.abs(compliance - before).max() / np.abs(compliance).max():.1e} after {PASSES} passes"
    )


def normal_stiffness_of(contact: HalfSpaceContact, *, loading: bool) -> float:
    """Return one of the two normal stiffnesses [Pa/m]; see `HalfSpaceContact.normal_stiffness`."""
    kernel = normal_kernel(
        contact.heights.shape,
        contact.spacing[1] / contact.spacing[0],
        periodic=contact.periodic,
        workers=contact.workers,
    )
    cells = contact.traction > 0
    if loading:
        cells &= ~contact.at_hardness
    return float(stiffness_on(kernel, cells)[0, 0]) * contact.E_star / contact.spacing[0]


def tangent_of(contact: HalfSpaceContact) -> Tangent:
    """Return the tangent stiffness of a contact; see `HalfSpaceContact.tangent`."""
    shape, aspect = contact.heights.shape, contact.spacing[1] / contact.spacing[0]
    shear = shear_kernel(shape, aspect, contact.nu, periodic=contact.periodic, workers=contact.workers)
    k_unload = k_load = normal_stiffness_of(contact, loading=False)
    if contact.hardness is not None and contact.at_hardness.any():
        k_load = normal_stiffness_of(contact, loading=True)
    tensor = stiffness_on(shear, contact.traction > 0) * contact.E_star / contact.spacing[0]
    return Tangent(
        k_n_loading=k_load,
        k_n_unloading=k_unload,
        k_t=float(np.trace(tensor)) / 2,
        k_tensor=tensor,
    )
