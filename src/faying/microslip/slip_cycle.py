"""Frequency and damping of a mode at one amplitude from statics alone: the witness of the harmonic balance.

The structure is loaded by M phi as its inertia would, to the modal displacement +q, -q and +q again, with the sliders
marched step by step. The secant of the loop gives the frequency, its area the damping. The whole cycle is marched: with
normal loads that change, the first loading says nothing of the loop (Masing's rule does not hold).

Source:
    Lacayo and Allen 2019, doi:10.1016/j.ymssp.2018.08.030 (quasi-static modal analysis); the full cycle is ours.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.errors import NotConverged
from faying.microslip.slip_model import SlipModel
from faying.typing import Array

STEPS = 24  # load steps from one end of the cycle to the other
TOLERANCE = 1e-8  # residual of a step over the elastic forces of the mode
MAX_NEWTON_STEPS = 40  # Newton steps of a load step


@dataclass(frozen=True, kw_only=True)
class StaticCycle:
    """One cycle: modal amplitude [m sqrt(kg)], angular frequency [rad/s], damping ratio [-].

    loads (steps,): over mass, along the loop.
    """

    amplitude: float
    frequency: float
    damping: float
    loads: Array


def static_cycle(model: SlipModel, mode: int, amplitude: float, *, steps: int = STEPS) -> StaticCycle:
    """March a cycle of the modal displacement between + and - amplitude.

    Args:
        model: The reduced structure.
        mode: Index of the mode at rest among those of the model, from 0.
        amplitude: Modal amplitude [m sqrt(kg)].
        steps: Load steps from one end to the other.

    Returns:
        The loop, its frequency and its damping.

    Raises:
        NotConverged: A load step finds no equilibrium.
    """
    rates, shapes = model.modes
    problem = _Statics(model.turned(shapes), mode, float(rates[mode]), rates)
    sweep = np.cos(np.pi * np.arange(1, steps + 1) / steps)
    first = np.sin(np.pi / 2 * np.arange(1, steps // 2 + 1) / (steps // 2))
    for target in first:
        problem.move(amplitude * target)
    for _ in range(2):  # cycles; the last one is measured
        path = [(problem.x[mode], problem.load)]
        for target in (*sweep, *-sweep):
            problem.move(amplitude * target)
            path.append((problem.x[mode], problem.load))
    q, loads = np.array(path).T
    area = float(np.sum((loads[1:] + loads[:-1]) / 2 * np.diff(q)))
    squared = float((loads[0] - loads[steps]) / (q[0] - q[steps]))
    return StaticCycle(
        amplitude=amplitude,
        frequency=float(np.sqrt(squared)),
        damping=area / (2 * np.pi * squared * amplitude**2),
        loads=loads,
    )


@dataclass
class _Statics:
    """Equilibrium under load * M phi with the modal displacement given, in modal coordinates."""

    model: SlipModel
    mode: int
    rate: float
    rates: Array

    def __post_init__(self) -> None:
        self.x = np.zeros(len(self.rates))
        self.load = 0.0
        self._states: list[Any] = [joint.law.start(joint.rest) for joint in self.model.joints]
        self._last: tuple[Array, float] | None = None

    def _contact(self, x: Array) -> tuple[Array, Array, list[Any]]:
        force, tangent, states = self.model.stiffness @ x, self.model.stiffness.copy(), []
        for joint, state in zip(self.model.joints, self._states, strict=True):
            motion = joint.rest + (joint.relative @ x).reshape(-1, 3)
            after, traction, slope = joint.law.advance(state, motion)
            local = (traction - joint.at_rest[0]) * joint.weights[:, None]
            force = force + joint.relative.T @ local.ravel()
            tangent += joint.projected(slope)
            states.append(after)
        return force, tangent, states

    def move(self, target: float) -> None:
        """Take one load step, to a modal displacement [m sqrt(kg)]."""
        size = abs(target) + abs(self.x[self.mode])
        x, load = self._guess(target)
        scale = (self.rate**2 + self.rates**2) * size
        left = np.inf
        for _ in range(MAX_NEWTON_STEPS):
            force, tangent, states = self._contact(x)
            miss = force.copy()
            miss[self.mode] -= load
            short = x[self.mode] - target
            left = max(float(np.abs(miss / scale).max()), abs(short) / size)
            if left < TOLERANCE:
                self._last = (x - self.x, load - self.load)
                self.x, self.load, self._states = x, load, states
                return
            matrix = np.zeros((len(x) + 1, len(x) + 1))
            matrix[:-1, :-1] = tangent
            matrix[self.mode, -1] = -(self.rate**2)
            matrix[-1, self.mode] = 1.0
            scales = np.append(scale, size)
            step = np.linalg.solve(matrix / scales[:, None], np.append(miss, short) / scales)
            x = x - step[:-1]
            load = load - float(step[-1]) * self.rate**2
        raise NotConverged(f"static cycle: at the modal displacement {target:.3g} a residual of {left:.1e} is left")

    def _guess(self, target: float) -> tuple[Array, float]:
        """Go on as in the last step; from an end of the cycle, as the mode at rest does."""
        by = target - self.x[self.mode]
        if self._last is not None and self._last[0][self.mode] * by > 0:
            ratio = by / self._last[0][self.mode]
            return self.x + ratio * self._last[0], self.load + ratio * self._last[1]
        x = self.x.copy()
        x[self.mode] += by
        return x, self.load + self.rate**2 * by


def nearest(values: Sequence[float], wanted: Sequence[float]) -> list[int]:
    """Indices of the values nearest to those wanted, on a logarithmic scale, each once and in order."""
    logs = np.log(values)
    return sorted({int(np.argmin(np.abs(logs - np.log(one)))) for one in wanted})
