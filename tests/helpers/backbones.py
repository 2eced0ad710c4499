"""Backbones of given frequency and damping, for what follows from them."""

import numpy as np

from faying.result.backbone import Backbone


def made(*, frequency, damping, rest=None, linear=None, points=60):
    """A curve from .1 to 20 m/s2 of frequency [Hz] and damping [-], numbers or functions of the acceleration."""
    a = np.geomspace(0.1, 20.0, points)
    f = frequency(a) if callable(frequency) else np.full(points, frequency)
    z = damping(a) if callable(damping) else np.full(points, damping)
    shape_at = 0.8
    displacement = a / (2 * np.pi * f) ** 2
    one, none = np.zeros((points, 1)), np.zeros(points)
    return Backbone(
        title="given",
        mode=1,
        preload=1e3,
        friction=(0.2,),
        harmonics=3,
        linear_frequency=float(f[0]) if linear is None else linear,
        rest_damping=float(z[0]) if rest is None else rest,
        shape_at=shape_at,
        code="amplitude",
        reason="the amplitude that was asked for is reached",
        joints=("joint",),
        bolts=("bolt",),
        basis_size=10,
        unknowns=300,
        at=np.zeros(3),
        direction=np.array([0.0, 0.0, 1.0]),
        acceleration=a,
        frequency=f,
        damping=z,
        modal_amplitude=displacement / shape_at,
        displacement=displacement,
        slipping=none,
        open=none,
        other_modes=none,
        residual=none,
        joint_slipping=one,
        joint_open=one,
        energy=one,
        bolt_force=one,
        slip_map=one,
        open_map=one,
        points=np.zeros((1, 3)),
        weights=np.ones(1),
        joint_of_point=np.zeros(1, dtype=int),
    )
