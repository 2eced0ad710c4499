"""Small structures that slip: masses, springs and sliders under a constant normal force."""

import numpy as np

from faying.microslip.microslip import Microslip
from faying.microslip.slip_model import SlipJoint, SlipModel


def slider(stiffness, limits, *, normal=1.0):
    """Parallel sliders at one point: shear stiffness (s,), limits (s,) of the shear; the approach at rest is 1."""
    stiffness, limits = np.atleast_1d(stiffness)[None, :], np.atleast_1d(limits)[None, :]
    k_n = np.full_like(limits, normal / limits.shape[1])
    # friction 1 and an onset that gives each the normal force that is its limit
    return Microslip(onset=1 - limits / k_n, k_n=k_n, k_t=stiffness, friction=1.0, gap=np.array([-1.0]))


def oscillator(law, *, spring=3.0, mass=1.0):
    """One mass on a spring and the sliders of `law`."""
    return chain([mass], [spring], law)


def chain(masses, springs, law):
    """Masses in a row, each on a spring to the one before (the first to the ground), sliders from the first to it."""
    n = len(masses)
    K = np.zeros((n, n))
    for i, k in enumerate(springs):
        K[i, i] += k
        if i:
            K[i - 1, i - 1] += k
            K[i - 1, i] = K[i, i - 1] = -k
    relative = np.zeros((3, n))
    relative[1, 0] = 1.0
    joint = SlipJoint(weights=np.ones(1), relative=relative, rest=np.zeros((1, 3)), law=law)
    return SlipModel(stiffness=K, mass=np.diag(np.asarray(masses, dtype=float)), joints=(joint,))


def describing(stiffness, limits, x):
    """Stiffness in phase and loss per cycle of sliders under a motion x cos: exact integrals of the hysteresis."""
    in_phase, loss = 0.0, 0.0
    for k, limit in zip(np.atleast_1d(stiffness), np.atleast_1d(limits), strict=True):
        if k * x <= limit:
            in_phase += k
            continue
        angle = np.arccos(1 - 2 * limit / (k * x))
        in_phase += k / np.pi * (angle - np.sin(2 * angle) / 2)
        loss += 4 * limit * (x - limit / k)
    return in_phase, loss
