"""Von Mises plasticity with linear isotropic hardening: the closest-point return and its energy.

Over one step the stress is the derivative of a convex energy of the strain, which the search for equilibrium uses.
Source: J. C. Simo and T. J. R. Hughes, Computational Inelasticity (1998), doi:10.1007/b98904, boxes 3.1 and 3.2.
"""

from dataclasses import dataclass

import numpy as np

from faying.typing import Array, Mask

# the double contraction of two symmetric tensors stored as rr, zz, tt, rz (tensor shear) counts rz twice
_TWICE = np.array([1.0, 1.0, 1.0, 2.0])
_NORMAL = np.array([1.0, 1.0, 1.0, 0.0])


@dataclass(frozen=True, kw_only=True)
class Flow:
    """Material constants at points (p,): bulk and shear modulus, yield strength, plastic modulus dY/d(strain) [Pa]."""

    bulk: Array
    shear: Array
    strength: Array
    modulus: Array


@dataclass(frozen=True, kw_only=True)
class Returned:
    """Outcome at points (p,): stress (p, 4) [Pa]; energy (p,) [J/m3]; plastic strain after the step (p, 4), with the
    tensor shear; equivalent plastic strain (p,); theta, theta_bar (p,) and direction (p, 4) of the consistent tangent
    K 1x1 + 2G theta I_dev - 2G theta_bar n x n (Simo and Hughes, box 3.2)."""

    stress: Array
    energy: Array
    plastic: Array
    hardened: Array
    theta: Array
    theta_bar: Array
    direction: Array
    yielding: Mask


def return_map(flow: Flow, strain: Array, plastic: Array, hardened: Array) -> Returned:
    """Return the stress of `strain` (p, 4; engineering shear) after a step that began at `plastic` and `hardened`."""
    dilatation = strain[:, 0] + strain[:, 1] + strain[:, 2]
    elastic = strain - plastic
    elastic[:, 3] -= 0.5 * strain[:, 3]
    elastic[:, :3] -= (dilatation / 3)[:, None]
    norm = np.sqrt((elastic * elastic) @ _TWICE)
    trial = np.sqrt(6.0) * flow.shear * norm  # equivalent stress sqrt(3/2) |s|
    excess = trial - (flow.strength + flow.modulus * hardened)
    yielding = excess > 0
    excess = np.where(yielding, excess, 0.0)
    stiff = 3 * flow.shear + flow.modulus
    slip = excess / stiff
    safe = np.where(norm > 0, norm, 1.0)
    direction = elastic / safe[:, None]
    lost = np.where(yielding, 3 * flow.shear * slip / np.where(yielding, trial, 1.0), 0.0)
    pressure = flow.bulk * dilatation
    stress = (2 * flow.shear * (1 - lost))[:, None] * elastic + pressure[:, None] * _NORMAL
    energy = 0.5 * pressure * dilatation + flow.shear * norm**2 - 0.5 * excess * slip
    return Returned(
        stress=stress,
        energy=energy,
        plastic=plastic + (np.sqrt(1.5) * slip)[:, None] * direction,
        hardened=hardened + slip,
        theta=1 - lost,
        theta_bar=np.where(yielding, 3 * flow.shear / stiff - lost, 0.0),
        direction=direction,
        yielding=yielding,
    )


def equivalent(stress: Array) -> Array:
    """Von Mises stress of stresses (..., 4)."""
    mean = stress[..., :3].mean(axis=-1)
    deviator = stress - mean[..., None] * _NORMAL
    return np.asarray(np.sqrt(1.5 * ((deviator * deviator) @ _TWICE)))
