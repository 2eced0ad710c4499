"""Triangles as they are seen along an axis: which of them lie over a point, and at what depth."""

import numpy as np

from faying.typing import Array, Mask

RING = 48  # points round a circle


def circle(radius: float) -> Array:
    """Points (p, 2) [m] round a circle about the axis."""
    angle = 2 * np.pi * (np.arange(RING) + 0.25) / RING
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def hits(flat: Array, depth: Array, points: Array) -> tuple[Mask, Array]:
    """Which triangles lie over which points, and at what depth [m]; both (t, p).

    Args:
        flat: corners (t, 3, 2) of the triangles across the axis [m].
        depth: of the corners (t, 3) along the axis [m].
        points: (p, 2) across the axis [m].
    """
    one, two = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    upright = np.abs(area) <= 1e-9 * np.maximum((one**2).sum(axis=1), (two**2).sum(axis=1))
    area = np.where(upright, 1.0, area)
    arm = points[None] - flat[:, :1]
    u = (arm[..., 0] * two[:, None, 1] - arm[..., 1] * two[:, None, 0]) / area[:, None]
    v = (one[:, None, 0] * arm[..., 1] - one[:, None, 1] * arm[..., 0]) / area[:, None]
    inside = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & ~upright[:, None]
    return inside, depth[:, :1] + u * (depth[:, 1:2] - depth[:, :1]) + v * (depth[:, 2:3] - depth[:, :1])
