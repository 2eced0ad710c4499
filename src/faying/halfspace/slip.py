"""Partial slip: a tangential load on a solved contact, with Coulomb's friction at every point."""

from dataclasses import dataclass
from math import isfinite, pi
from typing import final

import numpy as np

from faying.checks import number
from faying.errors import InputError
from faying.halfspace.bounded import Problem, minimise
from faying.halfspace.kernels import shear_kernel
from faying.halfspace.maps import ContactMaps
from faying.halfspace.tangent import stiffness_on
from faying.typing import Array


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Slip:
    """A contact under a tangential load along x that has grown from zero at constant normal load.

    traction, shape (ny, nx), tangential [Pa]; tangential_pressure, its mean [Pa]; displacement, the rigid tangential
    motion [m]; sliding, share of the real area that slips [-]; k_t, stiffness against more of the same load, of the
    points that still stick [Pa/m]; loss_per_cycle, friction's work when the load swings fully between plus and minus
    this value [J/m2]; loss_factor, that work over 2 pi times the energy T delta/2 [-]; residual as of the contact.
    """

    traction: Array
    tangential_pressure: float
    displacement: float
    sliding: float
    k_t: float
    loss_per_cycle: float
    loss_factor: float
    residual: float


def slip_of(contact: ContactMaps, shear_ratio: float, friction: float, *, tol: float = 1e-6) -> Slip:
    """Solve the partial slip at T = shear_ratio times friction times the normal load.

    Tractions along x with |t| <= friction p at every point; tractions across it, needed only where nu > 0 and small
    beside the others (Johnson 1985, 7.2), are left out, and so is the coupling of normal and tangential motion
    (Goodman's approximation; exact for like materials). On first loading every slipping point slips one way, so its
    friction's work is friction p times its slip; a full swing repeats that four times (Masing), which gives the loss.

    Raises InputError for a shear_ratio outside [0, 1) or a friction coefficient that is not positive.
    """
    number(friction, "friction", least=0)
    if number(shear_ratio, "shear_ratio", least=0, ends="[)") >= 1:
        raise InputError(
            f"shear_ratio = {shear_ratio}: at T = mu F and above the joint slips everywhere; "
            "lower the shear load or raise the preload"
        )
    shape, dx = contact.heights.shape, contact.spacing[0]
    touching, arithmetic = contact.traction > 0, contact.arithmetic
    kernel = shear_kernel(
        shape, contact.spacing[1] / dx, contact.nu, periodic=contact.periodic, vector=False, arithmetic=arithmetic
    )
    stuck_stiffness = float(stiffness_on(kernel, touching)[0, 0])
    bound = friction * contact.traction.ravel().astype(float) / contact.E_star
    mean = shear_ratio * float(bound.mean())
    if mean == 0 or not isfinite(stuck_stiffness):
        return Slip(
            traction=np.full(shape, mean * contact.E_star),
            tangential_pressure=mean * contact.E_star,
            displacement=0.0,
            sliding=0.0,
            k_t=stuck_stiffness * contact.E_star / dx,
            loss_per_cycle=0.0,
            loss_factor=0.0,
            residual=0.0,
        )
    problem = Problem(
        kernel=kernel,
        load=np.zeros(bound.size),
        lower=(-bound),
        upper=bound,
        mean=mean,
        scale=mean / stuck_stiffness,
    )
    found = minimise(problem, tol=tol, start=lambda: shear_ratio * bound)
    x = found.x
    sliding = touching.ravel() & (np.abs(x) >= bound)
    slipped = np.where(sliding, np.abs(found.G), 0.0)
    moved = -found.level
    loss = 4 * float((bound * slipped).mean())
    return Slip(
        traction=x.reshape(shape) * contact.E_star,
        tangential_pressure=mean * contact.E_star,
        displacement=moved * dx,
        sliding=float(np.count_nonzero(sliding) / np.count_nonzero(touching)),
        k_t=float(stiffness_on(kernel, touching & ~sliding.reshape(shape))[0, 0]) * contact.E_star / dx,
        loss_per_cycle=loss * contact.E_star * dx,
        loss_factor=loss / (pi * mean * moved),
        residual=found.residual,
    )
