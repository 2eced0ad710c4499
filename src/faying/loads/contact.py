"""A joint about its preload: pressure along the way back of its law, friction by sliders, opening.

From the preload the faces part and close by k_n, the curve of asperities that were loaded before. The preload's own
shear stays in balance and is not counted against friction: loads of service and vibration have worked it off.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np

from faying.joint.joint_law import JointLaw
from faying.joint.springs import InterfaceMotion, Springs
from faying.microslip.microslip import Microslip
from faying.microslip.sliders import SliderState
from faying.typing import Array, Mask

SPRINGS = 24  # with sliders, into which a law is cut below the preload
STEP = 1e-4  # of an approach, over which the change of k_n is taken
SLIDES = 1 - 1e-6  # of friction times pressure: shear from which a point slides


@dataclass(frozen=True, kw_only=True)
class StickState:
    """State of a joint that sticks: the slip (q, 2) [m] at which each point has no shear."""

    slip: Array


ContactState = StickState | SliderState


@dataclass(frozen=True, kw_only=True)
class LoadedContact:
    """One joint about its preload.

    Args:
        law: Its law.
        weights: Areas [m2] (q,) of its points.
        gap: Distance [m] (q,) of the faces before any load.
        rest: Relative motion [m] (q, 3) under the preload.
        pressure, k_n, k_t: [Pa], [Pa/m] (q,) under the preload.
        friction: Coefficient [-]; None where it sticks.
        sliders: The law cut into springs with sliders; None where it sticks.
    """

    law: JointLaw
    weights: Array
    gap: Array
    rest: Array
    pressure: Array
    k_n: Array
    k_t: Array
    friction: float | None
    sliders: Microslip | None

    @classmethod
    def of(
        cls,
        interface: InterfaceMotion,
        law: JointLaw,
        springs: Springs[Any],
        displacement: Array,
        friction: float | None,
    ) -> Self:
        """Return the joint about a displacement [m] (unknowns,) under the preload, with its springs there.

        Raises InputError where the whole joint is open and has friction.
        """
        rest = np.asarray(interface.relative @ displacement).reshape(-1, 3)
        cut = None
        if friction is not None:
            approach = -(rest[:, 0] + interface.gap)
            cut = Microslip.cut(law, approach, friction=friction, springs=SPRINGS, gap=interface.gap)
        return cls(
            law=law,
            weights=interface.weights,
            gap=interface.gap,
            rest=rest,
            pressure=springs.pressure,
            k_n=springs.k_n,
            k_t=springs.k_t,
            friction=friction,
            sliders=cut,
        )

    @cached_property
    def _way(self) -> tuple[Array, Array, Array]:
        """For each point: approach at the preload, the same on the way back of the law, and the scale between them.

        The scale is 1 but for the interpolation of the curve, so that k_n at the preload is that of the springs.
        """
        here = -(self.rest[:, 0] + self.gap)
        back = self.law.elastic.approach(self.pressure)
        slope = self.law.elastic.pressure(back)[1]
        shut = (self.pressure > 0) & (slope > 0)
        scale = np.where(shut, self.k_n / np.where(shut, slope, 1.0), 1.0)
        return np.where(shut, here, 0.0), np.where(shut, back, 0.0), np.where(scale > 0, scale, 1.0)

    @cached_property
    def ratio(self) -> Array:
        """k_t/k_n [-] (q,): at the preload, or at the least pressure of the law where the faces are apart then."""
        shut = self.k_n > 0
        least = self.law.stiffness(np.array([self.law.least_pressure]))
        return np.where(shut, self.k_t / np.where(shut, self.k_n, 1.0), float(least[1][0] / least[0][0]))

    def closing(self, motion: Array) -> Array:
        """Approach [m] (q,) on the way back of the law under a relative motion (q, 3) [m]; 0 or less: open."""
        start, back, scale = self._way
        return np.asarray(back + scale * (-(motion[:, 0] + self.gap) - start))

    def normal(self, motion: Array) -> tuple[Array, Array]:
        """Pressure [Pa] and its slope over the approach [Pa/m] (q,) under a relative motion (q, 3) [m]."""
        pressure, slope = self.law.elastic.pressure(self.closing(motion))
        return pressure, slope * self._way[2]

    @cached_property
    def start(self) -> ContactState:
        """The state of the preload: no shear at the slip that it has."""
        if self.sliders is None:
            return StickState(slip=self.rest[:, 1:].copy())
        return self.sliders.start(self.rest)

    def advance(self, state: ContactState, motion: Array) -> tuple[ContactState, Array, Array]:
        """Take one quasi-static step to a relative motion (q, 3) [m].

        Returns:
            The new state, the traction (q, 3) [Pa] = (minus pressure, shear), and its derivative (q, 3, 3) [Pa/m].
        """
        pressure, slope = self.normal(motion)
        if self.sliders is not None:
            assert isinstance(state, SliderState)
            new, traction, tangent = self.sliders.advance(state, motion)
            traction[:, 0], tangent[:, 0, 0] = -pressure, slope
            return new, traction, tangent
        assert isinstance(state, StickState)
        slip = motion[:, 1:] - state.slip
        k_t = self.ratio * slope
        traction = np.concatenate([-pressure[:, None], k_t[:, None] * slip], axis=1)
        tangent = np.zeros((len(slip), 3, 3))
        tangent[:, 0, 0], tangent[:, 1, 1], tangent[:, 2, 2] = slope, k_t, k_t
        tangent[:, 1:, 0] = -(self.ratio * self._steepening(motion, slope))[:, None] * slip
        # what moves while it is open starts without shear when it closes
        return StickState(slip=np.where((pressure > 0)[:, None], state.slip, motion[:, 1:])), traction, tangent

    def _steepening(self, motion: Array, slope: Array) -> Array:
        """Derivative of k_n by the approach [Pa/m2] (q,)."""
        closing, scale = self.closing(motion), self._way[2]
        step = STEP * np.abs(closing)
        step = np.where(step > 0, step, 1.0)
        ahead = self.law.elastic.pressure(closing + step)[1] * scale
        return np.asarray(np.where(closing > 0, (ahead - slope) * scale / step, 0.0))

    def opened(self, motion: Array) -> Mask:
        """Points (q,) that are closed under the preload and open now."""
        return np.asarray((self.pressure > 0) & (self.normal(motion)[0] <= 0))

    def sliding(self, motion: Array, traction: Array) -> Mask:
        """Points (q,) that touch and all of whose sliders have reached their limits."""
        if self.sliders is None:
            return np.zeros(len(traction), dtype=bool)
        depth = np.maximum(self.sliders.approach(motion)[:, None] - self.sliders.onset, 0.0)
        limit = self.sliders.friction * np.sum(self.sliders.k_n * depth, axis=1)
        shear = np.linalg.norm(traction[:, 1:], axis=1)
        return np.asarray((traction[:, 0] < 0) & (shear >= SLIDES * limit))

    def dissipated(self, before: ContactState, after: ContactState) -> Array:
        """Work [J/m2] (q,) that the sliders took in one step: the mean of their forces at its ends times their way."""
        if self.sliders is None:
            return np.zeros(len(self.weights))
        assert isinstance(before, SliderState)
        assert isinstance(after, SliderState)
        way = (after.slip - before.slip)[:, None, :] - (after.stretch - before.stretch)
        force = self.sliders.k_t[:, :, None] * (after.stretch + before.stretch) / 2
        return np.asarray(np.sum(force * way, axis=(1, 2)))
