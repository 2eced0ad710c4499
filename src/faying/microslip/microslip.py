"""A joint's law as parallel one-sided springs with sliders: microslip with the friction coefficient as the only number.

For elastically similar bodies the traction after a slip u at constant approach w is
t(u) = mu [p(w) - p(w - u k_t/(mu k_n))], with k_t/k_n the law's own ratio at w. So the curve p(w) is the microslip
curve. Cut into springs that close one after the other, each with a slider of limit mu times its own force, it holds for
a moving normal load too.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from faying.errors import InputError
from faying.joint.joint_law import JointLaw
from faying.joint.pressure_curve import PressureCurve, UnloadingCurve
from faying.microslip.hysteresis import Cycle, advance, steady
from faying.microslip.sliders import Sliders, SliderState
from faying.typing import Array

FINEST = 3e-3  # of p/k_n at the preload: the least motion either way that has a spring of its own
SHALLOW = 0.05  # of the greatest approach in the joint: a depth below it counts as so much
ABOVE = 2  # one spring in so many is added above the present approach


@dataclass(frozen=True, kw_only=True)
class Microslip:
    """One-sided springs with sliders, s at each of the q points of a joint.

    onset (q, s): approach at which each spring closes [m]; k_n, k_t (q, s) [Pa/m]; friction [-], one for all; gap (q,):
    distance of the faces before any load [m], so that the approach is minus (opening + gap).
    Tractions are per area and have the signs of the joint's equilibrium: (minus pressure, shear along both slips).
    """

    onset: Array
    k_n: Array
    k_t: Array
    friction: float
    gap: Array

    def __post_init__(self) -> None:
        if not (np.isfinite(self.friction) and self.friction >= 0):
            raise InputError(
                f"friction: {self.friction} is not a friction coefficient; give a finite number of 0 or more, e.g. 0.2 "
                "(a joint that never slips needs no microslip law)"
            )

    @classmethod
    def cut(
        cls, law: JointLaw, approach: Array, *, friction: float, springs: int = 32, gap: Array | None = None
    ) -> Self:
        """Cut the law's p(w) at each point into springs, finest next to the present approach.

        What springs back is the curve by k_n: a law with a k_load of its own (asperities that yielded) comes to the
        present approach by k_load, and moves about it by k_n, with its curve shifted so that it meets the pressure
        there. A cell of the curve becomes one spring with the rise of k_n over the cell, at the centroid of that rise.
        So the springs' sum equals p, k_n and k_t of the law at the preload to rounding, and their curve is that of the
        tangents at the cells' ends. Where k_n falls with approach, the springs take the greatest curve that does not.

        Args:
            law: of the joint.
            approach: (q,) [m] at each point under the preload; 0 or less: open.
            friction: coefficient [-], 0 or more.
            springs: below the present approach; half as many are put above it for what closes in motion.
            gap: (q,) [m] of the faces before any load; 0 where left out.

        Raises:
            InputError: friction or springs out of range, a law without stiffness, or a joint that is wholly open.

        Source:
            Jäger 1998, doi:10.1115/1.2833765: the traction of slip as the difference of two pressures.
        """
        if springs < 2:
            raise InputError(f"springs: {springs} cannot follow a law; give 2 or more, e.g. 32")
        approach = np.asarray(approach, dtype=float)
        p, k_n, k_t = _present(law, approach)
        curve = law.elastic
        parted = np.broadcast_to(curve.parted, p.shape)
        here = curve.approach(p) - parted
        top = float(here.max())
        above = max(1, springs // ABOVE)
        shut = p > 0
        offset = np.empty((len(p), springs + above))  # onset less present approach
        rise = np.empty_like(offset)
        end = max(curve.end, top)  # beyond the law's end no spring is added
        nodes = parted[shut, None] + np.minimum(_nodes(here[shut], p[shut] / k_n[shut], top, springs, above), end)
        offset[shut], rise[shut] = _springs(curve.at(shut), nodes, springs, p[shut], k_n[shut])
        loose = np.concatenate([[0.0], np.geomspace(1e-3 * top, min(2 * top, end), springs + above)])
        opened = curve.at(~shut)
        offset[~shut], rise[~shut] = _springs(opened, opened.parted[:, None] + loose, 0, np.zeros(1), np.zeros(1))
        onset = offset + np.where(shut, approach, parted)[:, None]
        return cls(onset=onset, k_n=rise, k_t=rise * (k_t / k_n)[:, None], friction=friction, gap=_gap(gap, p))

    @classmethod
    def coulomb(cls, law: JointLaw, approach: Array, *, friction: float, gap: Array | None = None) -> Self:
        """One slider a point: k_n, k_t and the limit friction times pressure of the preload state.

        A point that is open has the spring of the mean pressure of the closed points.

        Args:
            law: of the joint.
            approach: (q,) [m] at each point under the preload; 0 or less: open.
            friction: coefficient [-], 0 or more.
            gap: (q,) [m] of the faces before any load; 0 where left out.
        """
        approach = np.asarray(approach, dtype=float)
        p, k_n, k_t = _present(law, approach)
        shut = p > 0
        mean = p[shut].mean()
        stiffness, shear = (float(k[0]) for k in law.stiffness(np.array([mean])))
        onset = np.where(shut, approach - p / np.where(shut, k_n, 1.0), law.approach(mean) - mean / stiffness)
        return cls(
            onset=onset[:, None],
            k_n=np.where(shut, k_n, stiffness)[:, None],
            k_t=np.where(shut, k_t, shear)[:, None],
            friction=friction,
            gap=_gap(gap, p),
        )

    @cached_property
    def _sliders(self) -> Sliders:
        has = self.k_t > 0
        reach = np.where(has, self.friction * self.k_n / np.where(has, self.k_t, 1.0), 0.0)
        return Sliders(onset=self.onset, k_n=self.k_n, k_t=self.k_t, reach=reach)

    def approach(self, motion: Array) -> Array:
        """Approach (q,) [m] under a relative motion (q, 3) [m]."""
        return np.asarray(-(motion[:, 0] + self.gap))

    def start(self, motion: Array) -> SliderState:
        """Return the state without shear under a relative motion (q, 3) [m]."""
        return SliderState(slip=motion[:, 1:].copy(), stretch=np.zeros((*self.onset.shape, 2)))

    def advance(self, state: SliderState, motion: Array) -> tuple[SliderState, Array, Array]:
        """Take one quasi-static step to a relative motion (q, 3) [m].

        Returns:
            The new state, the traction (q, 3) [Pa] and the consistent tangent (q, 3, 3) [Pa/m].
        """
        return advance(self._sliders, state, motion[:, 1:].copy(), self.approach(motion))

    def cycle(
        self, coefficients: Array, *, derivative: bool = True, samples: int = 64, start: SliderState | None = None
    ) -> Cycle:
        """Steady cycle of a periodic relative motion.

        Args:
            coefficients: of the motion (1 + 2H, q, 3) [m]: mean (with the static motion), cos 1, sin 1, cos 2, ...
            derivative: whether the derivative of the traction is asked for.
            samples: instants in the cycle; the error falls with their square.
            start: state from which the sliders set out; where left out, no shear at no slip.

        Raises:
            InputError: fewer instants than the harmonics need.
        """
        if start is None:
            start = self.start(np.zeros((len(self.gap), 3)))
        return steady(self._sliders, start, coefficients, gap=self.gap, samples=samples, derivative=derivative)


def _gap(gap: Array | None, p: Array) -> Array:
    return np.zeros(len(p)) if gap is None else np.asarray(gap, dtype=float)


def _present(law: JointLaw, approach: Array) -> tuple[Array, Array, Array]:
    """Pressure, k_n and k_t (q,) at the preload; at open points the stiffnesses of the law's least pressure."""
    p, _ = law.pressure(approach)
    if not np.any(p > 0):
        raise InputError("microslip: no point of the joint is closed under the preload; pull the bolts harder")
    k_n, k_t = law.stiffness(np.where(p > 0, p, law.least_pressure))
    if np.any(k_n <= 0):
        raise InputError(f"{law.model.name}: no normal stiffness at {p[k_n <= 0][0]:.4g} Pa")
    return p, k_n, k_t


def _nodes(here: Array, depth: Array, top: float, below: int, above: int) -> Array:
    """Ends (q, 1 + below + above) of the cells of the curve, the present approach at column `below`.

    Geometric on both sides, measured from the present approach: from FINEST of depth = p/k_n to first touch below it,
    above it to the greatest approach in the joint and twice the depth beyond. Both sides begin alike: were they not, a
    small motion to and fro would soften the joint, where the rise of k on one side makes up for its fall on the other.
    """
    steps = np.linspace(0.0, 1.0, below)
    down = here[:, None] * (FINEST * depth / here)[:, None] ** steps
    down[:, 0] = here
    first = FINEST * np.maximum(depth, SHALLOW * top)
    last = np.maximum(top - here, 0.0) + 2 * depth.max()
    up = first[:, None] * (last / first)[:, None] ** np.linspace(0.0, 1.0, above)
    return np.concatenate([here[:, None] - down, here[:, None], here[:, None] + up], axis=1)


def _springs(
    curve: PressureCurve | UnloadingCurve, nodes: Array, here: int, p: Array, k_n: Array
) -> tuple[Array, Array]:
    """Onset less present approach [m] and stiffness [Pa/m] (q, cells) of one spring a cell.

    Both are scaled, by 1 but for the interpolation of the curve and where its k falls, so that the springs shut at
    column `here` carry p with stiffness k_n.
    """
    pressure, k = curve.pressure(nodes)
    below = np.minimum.accumulate(k[:, here::-1], axis=1)[:, ::-1]
    above = np.maximum.accumulate(k[:, here:], axis=1)[:, 1:]
    k = np.concatenate([below, above], axis=1)
    rise = np.diff(k, axis=1)
    ahead = nodes - nodes[:, [here]]
    # the centroid of the rise of k in a cell, from the integral of ahead dk by parts
    moment = np.diff(ahead * k, axis=1) - np.diff(pressure, axis=1)
    onset = np.where(rise > 0, moment / np.where(rise > 0, rise, 1.0), ahead[:, :-1])
    onset = np.clip(onset, ahead[:, :-1], ahead[:, 1:])
    if here:
        rise *= (k_n / rise[:, :here].sum(axis=1))[:, None]
        onset *= (p / -np.sum(rise[:, :here] * onset[:, :here], axis=1))[:, None]
    return onset, rise
