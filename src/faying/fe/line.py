"""An axis in space: how far points lie from it, and whether another axis is the same one."""

from dataclasses import dataclass

import numpy as np

from faying.typing import Array

FACING = float(np.cos(np.deg2rad(1.0)))  # directions that differ by less than a degree are parallel


@dataclass(frozen=True, kw_only=True)
class Line:
    """An axis: a point (3,) [m] on it, its unit direction (3,)."""

    point: Array
    axis: Array

    def about(self, points: Array) -> tuple[Array, Array]:
        """How far points (..., 3) [m] lie from the axis, and how far along it from its point [m]; both (n,)."""
        arm = np.reshape(points, (-1, 3)) - self.point
        depth = arm @ self.axis
        return np.linalg.norm(arm - np.outer(depth, self.axis), axis=1), depth

    def aside(self, point: Array) -> float:
        """How far a point (3,) [m] lies from the axis [m]."""
        return float(self.about(point)[0][0])

    def at(self, depth: float) -> Array:
        """The point (3,) [m] of the axis at a depth [m]."""
        return np.asarray(self.point + depth * self.axis)

    def span(self, line: "Line", low: float, high: float) -> tuple[float, float]:
        """Where a part of another line begins and ends along this one [m]."""
        ends = self.about(np.stack([line.at(low), line.at(high)]))[1]
        return float(ends.min()), float(ends.max())

    def holds(self, line: "Line", aside: float) -> bool:
        """Whether another line is this one, no farther away than `aside` [m]."""
        return bool(abs(self.axis @ line.axis) >= FACING and self.aside(line.point) <= aside)


def across(axis: Array) -> Array:
    """Two unit directions (3, 2) across an axis."""
    one = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    one /= np.linalg.norm(one)
    return np.stack([one, np.cross(axis, one)], axis=1)
