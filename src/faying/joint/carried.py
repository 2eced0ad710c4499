"""What some points of a joint carry by friction: shear, torque about the centre of the pressure, and both as one."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.typing import Array, Mask


@dataclass(frozen=True, kw_only=True)
class PressedPatch:
    """Points of a joint that are pressed together, on which friction carries shear and torque.

    Friction alone bears a torque of mu times the integral of p r about the centre of the pressure; shear force and
    torque lie on an ellipse, so that Q and T need as much friction as the shear force hypot(Q, T/reach).

    Args:
        some: Which points (q,).
        normal: Force that presses them [N]; the rest is 0 where it is not above 0.
        axis, centre: Mean normal (3,) and centre of the pressure (3,) [m].
        reach: Mean arm of the pressure [m].

    Source:
        S. Goyal, A. Ruina, J. Papadopoulos, Planar sliding with dry friction, Wear 143 (1991), 307 to 330: the limit
        surface; R. D. Howe, M. R. Cutkosky, Int. J. Robotics Research 15 (1996), 557 to 572: as an ellipsoid.
    """

    some: Mask
    normal: float
    axis: Array
    centre: Array
    reach: float
    _places: Array
    _shears: Array

    @classmethod
    def of(cls, interface: Any, pressure: Array, weights: Array, some: Mask) -> "PressedPatch":
        """Return that of some points (q,) of an interface under pressures [Pa] (q,)."""
        frames, places = interface.frames[some], interface.positions[some]
        press = weights[some] * np.maximum(pressure[some], 0.0)
        normal, axis, centre, reach = float(press.sum()), np.zeros(3), np.zeros(3), 0.0
        if normal > 0:
            axis = np.einsum("q,qj->j", press, frames[:, 0])
            axis = axis / np.linalg.norm(axis)
            centre = press @ places / normal
            arm = places - centre
            reach = float(press @ np.linalg.norm(arm - np.outer(arm @ axis, axis), axis=1)) / normal
        return cls(
            some=some,
            normal=normal,
            axis=axis,
            centre=centre,
            reach=reach,
            _places=places - centre,
            _shears=weights[some, None, None] * frames[:, 1:],
        )

    def loads(self, shear: Array) -> tuple[Array, Array]:
        """Resultants [N] (3, k) and torques [N m] (k,) about the centre of k shear stresses [Pa] (q, 2, k)."""
        forces = np.einsum("qij,qik->qjk", self._shears, shear[self.some])
        moments = np.cross(self._places[:, :, None], forces, axis=1).sum(axis=0)
        return forces.sum(axis=0), np.asarray(self.axis @ moments)

    def equivalent(self, shear: float, torque: float) -> float:
        """Shear force [N] that needs as much friction as a shear force [N] and a torque [N m] together."""
        return float(np.hypot(shear, torque / self.reach)) if self.reach > 0 else shear
