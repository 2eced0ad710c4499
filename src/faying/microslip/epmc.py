"""Frequency and damping of a mode against its amplitude, by the extended periodic motion concept.

The joint takes energy out of a free vibration; a negative damping -xi M puts it back, so that the motion is periodic
at its amplitude q. Its frequency w and xi are found with it, by harmonic balance with harmonics 0 to H:

    h = 0:  F_0(X) = 0
    h > 0:  F_h(X) - (h w)^2 M X_h - xi h w M (i X_h) = 0,    zeta = xi/(2 w)
    phi-normalised:  X_c1' M X_c1 + X_s1' M X_s1 = q^2,  phi' M X_s1 = 0

The contact forces come from the histories of the sliders (alternating frequency and time), with their derivatives.
The amplitude grows in steps of its logarithm from the linear limit.

Source:
    Krack 2015, doi:10.1016/j.compstruc.2015.03.008.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from faying.errors import InputError, NotConverged
from faying.microslip.slip_model import SlipForces, SlipModel, share
from faying.typing import Array

PER_DECADE = 6.0  # points of the curve
LEAD_IN = 4  # decades below the first level that a curve may start
SHORTEST = 1 / 16  # of a step
TOLERANCE = 1e-7  # of the residual over the elastic forces of the mode
MAX_NEWTON_STEPS = 25  # Newton steps of a point
STALLED = 4  # Newton steps that do not halve the residual, after which a point is given up
FAST = 0.3  # fall of the residual from one step to the next with which an old derivative is kept
LEADING = 32  # instants for the derivative: with 16 steps stall where edges open and close
END_TOLERANCE = 2e-3  # of the last level: nearer than that a curve has reached its end
OTHER_MODES = 0.2  # share of other modes in the motion above which it is no longer the mode's
ALL_SLIDING = 0.98  # share of the limit of friction that slides, above which the joint holds no more


@dataclass(frozen=True, kw_only=True)
class EpmcPoint:
    """One point of the curve.

    amplitude: modal [m sqrt(kg)]; frequency: angular [rad/s]; damping: ratio to critical [-] of the joints alone;
    coordinates (1 + 2H, m): Fourier coefficients from the preload, mean, cos 1, sin 1, ...; level: what the observer
    sees [m/s2], or the amplitude where there is none; other_modes: share of them in the motion; slipping, open: shares
    of the joints' area [-]; for each joint, by point: sliding [-] (q,), opening (q,), dissipated [J/m2] (q,), and
    the coefficients of the traction (1 + 2H, q, 3) [Pa].
    """

    amplitude: float
    frequency: float
    damping: float
    coordinates: Array
    level: float
    other_modes: float = 0.0
    slipping: float = 0.0
    open: float = 0.0
    sliding: tuple[Array, ...] = ()
    opening: tuple[Array, ...] = ()
    dissipated: tuple[Array, ...] = ()
    traction: tuple[Array, ...] = ()


@dataclass(frozen=True, kw_only=True)
class EpmcCurve:
    """The points of a curve in rising amplitude, and why it ends: a code and a sentence."""

    points: tuple[EpmcPoint, ...]
    code: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class Epmc:
    """The curve of one mode of a reduced structure.

    Args:
        model: The reduced structure.
        mode: Index of the mode at rest among those of the model, from 0.
        harmonics: Highest harmonic, 1 or more; harmonic 0 is always there.
        samples: Instants of a cycle at which the sliders are looked at.
        observer: Row (m,) that takes the coordinates to the displacement whose acceleration is the level [m], or rows
            (n, 3, m) of points, of which the one that moves most gives the level; None where the level is the modal
            amplitude.
        tolerance: Residual over the elastic forces of the mode at which a point counts as solved.
        most_sliding: Share of the limit of friction that slides at which a curve ends, above 1 for never.
        newton_steps: After so many without an answer the step of the curve is halved.
        shortest: Share of the first step of the curve, in its logarithm, below which the continuation gives up.

    Raises:
        InputError: The model has no such mode.
    """

    model: SlipModel
    mode: int = 0
    harmonics: int = 3
    samples: int = 64
    observer: Array | None = None
    tolerance: float = TOLERANCE
    most_sliding: float = ALL_SLIDING
    newton_steps: int = MAX_NEWTON_STEPS
    shortest: float = SHORTEST

    def __post_init__(self) -> None:
        if not 0 <= self.mode < len(self.model.mass):
            raise InputError(f"mode {self.mode + 1} of a model with {len(self.model.mass)} modes")
        if self.harmonics < 1:
            raise InputError(f"harmonics {self.harmonics}: give 1 or more")

    @cached_property
    def _modal(self) -> SlipModel:
        return self.model.turned(self._shapes)

    @property
    def _shapes(self) -> Array:
        return self.model.modes[1]

    @property
    def linear_frequency(self) -> float:
        """Angular frequency [rad/s] at vanishing amplitude."""
        return float(self.model.modes[0][self.mode])

    @cached_property
    def _rows(self) -> Array | None:
        """Of the observer (n, d, m) from the shapes."""
        if self.observer is None:
            return None
        rows = self.observer @ self._shapes
        return rows if rows.ndim == 3 else rows[None, None]

    def _level(self, amplitude: float, frequency: float, motion: Array) -> float:
        """What the observer sees of a motion over its amplitude, cosine and sine in rows (2, m)."""
        if self._rows is None:
            return amplitude
        seen = np.linalg.norm(self._rows @ motion.T, axis=(1, 2))
        return amplitude * frequency**2 * float(seen.max())

    def level_of(self, amplitude: float) -> float:
        """Level that a modal amplitude has in the linear limit."""
        return self._level(amplitude, self.linear_frequency, np.eye(len(self.model.mass))[[self.mode]])

    def first(self) -> EpmcPoint:
        """The linear limit as a point to start from: it has no amplitude yet."""
        X = np.zeros((1 + 2 * self.harmonics, len(self.model.mass)))
        X[1] = self._shapes[:, self.mode]
        return EpmcPoint(
            amplitude=1.0,
            frequency=self.linear_frequency,
            damping=0.0,
            coordinates=X,
            level=self.level_of(1.0),
        )

    def solve(self, amplitude: float, known: Sequence[EpmcPoint] = ()) -> EpmcPoint:
        """Solve for one modal amplitude [m sqrt(kg)], from points of the curve that are known.

        Raises NotConverged where Newton stops short.
        """
        z = self._predicted(amplitude, known or [self.first()])
        old, size = np.inf, np.inf
        sizes: list[float] = []
        step: _Accelerated | None = None
        for _ in range(self.newton_steps):
            left, forces = self._residual(z, amplitude)
            size = float(np.abs(left / self._scales).max())
            sizes.append(size)
            if size < self.tolerance:
                return self._point(z, amplitude, forces)
            if not np.isfinite(size) or size > 1e6 or (len(sizes) > STALLED and size > sizes[-1 - STALLED] / 2):
                break
            if step is None or size > FAST * old:
                step = _Accelerated(self._factored(z, amplitude))
            old = size
            z = step(z, left)
        raise NotConverged(f"backbone: at the modal amplitude {amplitude:.3g} a residual of {size:.1e} is left")

    def follow(
        self,
        low: float,
        high: float,
        *,
        known: Sequence[EpmcPoint] = (),
        per_decade: float = PER_DECADE,
        keep: Callable[[EpmcPoint], str | None] | None = None,
    ) -> EpmcCurve:
        """Follow the curve from one level to another.

        Args:
            low, high: Levels, 0 < low < high.
            known: Points of the same curve found before, in rising amplitude.
            per_decade: Points in a decade of amplitude.
            keep: Called with each new point; a sentence that it returns ends the curve.

        Returns:
            The points, those known included, and why the curve ends.

        Raises:
            NotConverged: Not even the first point is found.
        """
        points, end_reason = list(known), None
        if not points:
            points = [self._led_in(low)]
            end_reason = None if keep is None else keep(points[0])
        step = longest = float(10 ** (1 / per_decade))
        while True:
            last = points[-1]
            ended = ("basis", end_reason) if end_reason else self._ended(last, high)
            if ended is not None:
                return EpmcCurve(points=tuple(points), code=ended[0], reason=ended[1])
            try:
                point = self.solve(last.amplitude * min(step, self._to_end(points, high)), points[-3:])
            except NotConverged as fault:
                step = step**0.5
                if np.log(step) < self.shortest * np.log(longest):
                    reason = f"no periodic motion is found above {points[-1].level:.3g}: {fault}"
                    return EpmcCurve(points=tuple(points), code="not-converged", reason=reason)
                continue
            points.append(point)
            step = min(longest, step**1.5)
            end_reason = None if keep is None else keep(point)

    def _led_in(self, low: float) -> EpmcPoint:
        """The first point, or one decades below where the linear limit is too far from it."""
        amplitude = low / self.level_of(1.0)
        for decades in range(LEAD_IN):
            with suppress(NotConverged):
                return self.solve(amplitude / 10**decades)
        return self.solve(amplitude / 10**LEAD_IN)

    def _ended(self, last: EpmcPoint, high: float) -> tuple[str, str] | None:
        if last.level >= high * (1 - END_TOLERANCE):
            return "amplitude", "the amplitude that was asked for is reached"
        if last.other_modes > OTHER_MODES:
            text = f"other modes make {last.other_modes:.0%} of the motion, so the curve has left this mode"
            return "other-modes", text
        if last.open >= 1:
            return "open", "the joint opens fully in every cycle"
        if last.slipping > self.most_sliding:
            return "all-slipping", f"{last.slipping:.0%} of the joint slides in every cycle; its friction is used up"
        return None

    def _to_end(self, points: Sequence[EpmcPoint], high: float) -> float:
        """Factor of the amplitude that leads to the last level, as the last two points go."""
        slope = 1.0
        if len(points) > 1:
            before, last = points[-2:]
            slope = np.log(last.level / before.level) / np.log(last.amplitude / before.amplitude)
        return float((high / points[-1].level) ** (1 / np.clip(slope, 0.3, 2.0)))

    @cached_property
    def _scales(self) -> Array:
        """What a residual of 1 means for each row: the stiffness of its mode over that of the one followed."""
        per_mode = 1 + (self.model.modes[0] / self.linear_frequency) ** 2
        return np.concatenate([np.tile(per_mode, 1 + 2 * self.harmonics), [1.0, 1.0]])

    def _packed(self, point: EpmcPoint) -> Array:
        """Coordinates of the modes over the amplitude, relative frequency, damping ratio."""
        wanted = np.zeros((1 + 2 * self.harmonics, len(self.model.mass)))
        have = point.coordinates[: len(wanted)] @ self.model.mass @ self._shapes / point.amplitude
        wanted[: len(have)] = have
        return np.concatenate([wanted.ravel(), [point.frequency / self.linear_frequency, point.damping]])

    def _predicted(self, amplitude: float, known: Sequence[EpmcPoint]) -> Array:
        """Extrapolate the last points, at most three, in the logarithm of the amplitude."""
        if len(known) == 1:
            z = self._packed(known[0])
            if not known[0].sliding:
                return z
            means = slice(0, len(self.model.mass))
            z[means] *= min(amplitude / known[0].amplitude, 1.0)
            return z
        x = np.log([point.amplitude for point in known])
        here = np.log(amplitude)
        total = np.zeros(len(self._scales))
        for k, point in enumerate(known):
            others = np.delete(x, k)
            total += np.prod((here - others) / (x[k] - others)) * self._packed(point)
        return total

    def _residual(self, z: Array, amplitude: float) -> tuple[Array, SlipForces]:
        w0, size = self.linear_frequency, len(self.model.mass)
        Y, (rate, zeta) = z[:-2].reshape(-1, size), z[-2:]
        forces = self._modal.forces(amplitude * Y, derivative=False, samples=self.samples)
        left = forces.force / (amplitude * w0**2)
        for h in range(1, self.harmonics + 1):
            c, s = 2 * h - 1, 2 * h
            left[c] -= (h * rate) ** 2 * Y[c] + 2 * zeta * h * rate**2 * Y[s]
            left[s] -= (h * rate) ** 2 * Y[s] - 2 * zeta * h * rate**2 * Y[c]
        norm = float(Y[1] @ Y[1] + Y[2] @ Y[2]) - 1
        return np.concatenate([left.ravel(), [norm, Y[2, self.mode]]]), forces

    def _factored(self, z: Array, amplitude: float) -> Callable[[Array], Array]:
        """Solver of the equations linearised at z, with the derivative from fewer instants: it only has to lead on."""
        from scipy.linalg import lu_factor, lu_solve

        w0, size = self.linear_frequency, len(self.model.mass)
        Y, (rate, zeta) = z[:-2].reshape(-1, size), z[-2:]
        samples = min(max(LEADING, 4 * self.harmonics + 4), self.samples)
        forces = self._modal.forces(amplitude * Y, derivative=True, samples=samples)
        assert forces.stiffness is not None
        n = len(z)
        J = np.zeros((n, n))
        J[:-2, :-2] = forces.stiffness / w0**2
        unit = np.arange(size)
        for h in range(1, self.harmonics + 1):
            c, s = (2 * h - 1) * size + unit, 2 * h * size + unit
            J[c, c] -= (h * rate) ** 2
            J[s, s] -= (h * rate) ** 2
            J[c, s] -= 2 * zeta * h * rate**2
            J[s, c] += 2 * zeta * h * rate**2
            at, turn = Y[2 * h - 1], Y[2 * h]
            J[c, -2] -= 2 * h**2 * rate * at + 4 * zeta * h * rate * turn
            J[s, -2] -= 2 * h**2 * rate * turn - 4 * zeta * h * rate * at
            J[c, -1] -= 2 * h * rate**2 * turn
            J[s, -1] += 2 * h * rate**2 * at
        J[-2, size : 3 * size] = 2 * Y[1:3].ravel()
        J[-1, 2 * size + self.mode] = 1.0
        rows = 1 / self._scales
        lu: Any = lu_factor(rows[:, None] * J, check_finite=False)
        return lambda left: np.asarray(lu_solve(lu, rows * left, check_finite=False))

    def _point(self, z: Array, amplitude: float, forces: SlipForces) -> EpmcPoint:
        size = len(self.model.mass)
        Y, (rate, zeta) = z[:-2].reshape(-1, size), z[-2:]
        frequency = float(rate) * self.linear_frequency
        others = np.delete(Y[1:], self.mode, axis=1)
        joints, cycles = self.model.joints, forces.cycles
        return EpmcPoint(
            amplitude=float(amplitude),
            frequency=frequency,
            damping=float(zeta),
            coordinates=amplitude * Y @ self._shapes.T,
            level=self._level(float(amplitude), frequency, Y[1:3]),
            other_modes=float(np.sqrt((others**2).sum() + (Y[3:, self.mode] ** 2).sum())),
            slipping=share([cycle.slipping for cycle in cycles], joints),
            open=share([cycle.open for cycle in cycles], joints),
            sliding=tuple(cycle.slipping for cycle in cycles),
            opening=tuple(cycle.open.astype(float) for cycle in cycles),
            dissipated=tuple(cycle.dissipated for cycle in cycles),
            traction=tuple(cycle.traction for cycle in cycles),
        )


class _Accelerated:
    """Newton's iteration with the derivative kept, accelerated by the steps before (Anderson)."""

    def __init__(self, solver: Callable[[Array], Array]) -> None:
        self.solver = solver
        self.places: list[Array] = []
        self.steps: list[Array] = []

    def __call__(self, z: Array, left: Array) -> Array:
        """The next iterate, from the residual at z."""
        self.places.append(z)
        self.steps.append(-self.solver(left))
        step = self.steps[-1]
        if len(self.steps) == 1:
            return z + step
        moved, changed = (np.diff(np.array(rows), axis=0).T for rows in (self.places, self.steps))
        weights, *_ = np.linalg.lstsq(changed, step, rcond=None)
        return np.asarray(z + step - (moved + changed) @ weights)
