"""A mode whose frequency and damping depend on its amplitude, under random and under sinusoidal forces.

q is the coordinate of a mass-normalised shape: q'' + 2 zeta(a) omega(a) q' + omega(a)^2 q = f, a the amplitude of q.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from faying.study.vibration import InputTable
from faying.typing import Array, Complex, Mask

# amplitudes over which a density is integrated, from a share of the first known one to a multiple of the last: to 1e-4
GRID = 3000
FIRST_RATIO, LAST_RATIO = 1e-6, 1e6
# power over that with the frequency and damping at rest, between which the balance is sought: under white noise it is
# 1; less where a mode that softens leaves the band of the input, more where it moves to a peak of it
LEAST_POWER, MOST_POWER = 1e-6, 1e6
SCANNED = 49  # steps between them, four in a decade
LEAST_SLIP = 1e-6  # ratio: slip below it is as none, and has no logarithm to draw a curve through
STEPS = 400  # of amplitude, among which a sine's answers are sought: a step is 3 % of it
FARTHEST = 4.0  # decades of amplitude below the resonance at rest in which they are sought
GAUSS = 10  # nodes of a stretch: its end is as far from the nearest pole as it is long, or farther, which leaves 1e-12
PLACES, WEIGHTS = np.polynomial.legendre.leggauss(GAUSS)


class RandomLevel(NamedTuple):
    """What a mode does under noise.

    Args:
        sigma: The rms of its coordinate [m kg^1/2].
        speed, damping: Circular frequency [rad/s] and damping ratio [-] of the linear mode that loses as much.
    """

    sigma: float
    speed: float
    damping: float


@dataclass(frozen=True, kw_only=True)
class ModeCurve:
    """Frequency and damping of a mode against the amplitude of its coordinate.

    Args:
        speed, rest: Circular frequency [rad/s] and damping ratio [-] at rest.
        amplitudes: Rising [m kg^1/2] (k,); none where nothing slips.
        speeds, slips: Circular frequency [rad/s] and damping ratio of slip [-] there (k,).
    """

    speed: float
    rest: float
    amplitudes: Array = field(default_factory=lambda: np.zeros(0))
    speeds: Array = field(default_factory=lambda: np.zeros(0))
    slips: Array = field(default_factory=lambda: np.zeros(0))

    def at(self, amplitude: Array) -> tuple[Array, Array]:
        """Circular frequency [rad/s] and damping ratio [-] at amplitudes [m kg^1/2].

        Between the points the frequency is smooth in the logarithm of the amplitude, and slip a power of it. Below the
        first point the change of the frequency and slip fall in proportion to the amplitude; beyond the last they stay.
        """
        a = np.asarray(amplitude, dtype=float)
        if not len(self.amplitudes):
            return np.full_like(a, self.speed), np.full_like(a, self.rest)
        share = np.minimum(a / self.amplitudes[0], 1.0)
        logs = np.log(np.clip(a, self.amplitudes[0], self.amplitudes[-1]))
        softer, slip = (between(logs) for between in self._between)
        return self.speed + share * (softer - self.speed), self.rest + share * slip

    @cached_property
    def _between(self) -> tuple[Callable[[Array], Array], Callable[[Array], Array]]:
        from scipy.interpolate import PchipInterpolator

        known = np.log(self.amplitudes)
        if len(known) == 1:
            return lambda x: np.full_like(x, self.speeds[0]), lambda x: np.full_like(x, self.slips[0])
        powers = PchipInterpolator(known, np.log(np.maximum(self.slips, LEAST_SLIP)))
        return PchipInterpolator(known, self.speeds), lambda x: np.exp(powers(x))

    @cached_property
    def _spent(self) -> tuple[Array, ...]:
        """Amplitudes a (n,), even in logs; integral of 2 zeta omega^3 a to them; a^2; a^2 omega^3; a^2 omega^3 zeta."""
        a = np.geomspace(FIRST_RATIO * self.amplitudes[0], LAST_RATIO * self.amplitudes[-1], GRID)
        speed, damping = self.at(a)
        rate = 2 * damping * speed**3 * a**2  # over log(a)
        parts = (rate[1:] + rate[:-1]) / 2 * np.diff(np.log(a))
        spent = rate[0] / 2 + np.concatenate([[0.0], np.cumsum(parts)])
        return a, spent, a**2, speed**3 * a**2, rate / 2

    def under(self, power: float) -> RandomLevel:
        """The vibration in which noise gives the mode a mean power [m2 kg/s3] = E[zeta omega^3 a^2].

        The amplitude wanders slowly, driven by the noise and damped by zeta(a). Its density is a exp(-y), where power
        times y is the integral of 2 zeta omega^3 a over a; for a linear mode that is Rayleigh's. The linear mode that
        loses as much has zeta_eq = E[zeta omega^3 a^2]/E[omega^3 a^2] and omega_eq^3 = E[omega^3 a^2]/E[a^2].

        Source:
            Stochastic averaging: Stratonovich 1963; Roberts and Spanos 1986, doi:10.1016/0020-7462(86)90025-9.
        """
        if not len(self.amplitudes):
            sigma = float(np.sqrt(power / (2 * self.rest * self.speed**3)))
            return RandomLevel(sigma=sigma, speed=self.speed, damping=self.rest)
        sigma, speed, damping = (float(one) for one in self._under(np.array(power)))
        return RandomLevel(sigma=sigma, speed=speed, damping=damping)

    def _under(self, power: Array) -> tuple[Array, Array, Array]:
        """The same of a curve with amplitudes, under powers of any shape."""
        a, spent, square, cube, lost = self._spent
        density = np.exp(-spent / power[..., None]) * a**2  # over log(a)
        squares, cubes = density @ square, density @ cube
        return np.sqrt(squares / density.sum(axis=-1) / 2), np.cbrt(cubes / squares), (density @ lost) / cubes

    def balance(self, variance: Callable[[float, float], float]) -> RandomLevel:
        """The vibration at which the equivalent linear mode has its own rms.

        variance: of q [m2 kg], by circular frequency [rad/s] and damping ratio [-]. Under white noise the power is
        pi S_0, whatever the mode does with it.
        """
        from scipy.optimize import brentq

        at_rest = variance(self.speed, self.rest)
        if at_rest == 0 or not len(self.amplitudes):
            return RandomLevel(sigma=float(np.sqrt(at_rest)), speed=self.speed, damping=self.rest)

        def more(level: Sequence[float]) -> float:
            return float(np.log(variance(level[1], level[2]) / level[0] ** 2))

        def short(log_power: float) -> float:
            return more(self.under(float(np.exp(log_power))))

        steps = np.log(2 * self.rest * self.speed**3 * at_rest * np.geomspace(LEAST_POWER, MOST_POWER, SCANNED))
        above = np.flatnonzero([more(one) > 0 for one in np.transpose(self._under(np.exp(steps))).tolist()])
        # of several answers the greatest, which the vibration may reach
        k = min(int(above[-1]), SCANNED - 2)
        return self.under(float(np.exp(brentq(short, steps[k], steps[k + 1], xtol=1e-10))))

    def forced(self, force: Array, speeds: Array) -> tuple[Complex, Mask]:
        """The coordinate under harmonic forces [N kg^-1/2] of circular frequencies [rad/s] (n,), and whether it jumps.

        |f| = a |omega(a)^2 - Omega^2 + 2 i zeta(a) omega(a) Omega| may have several amplitudes: the greatest is taken,
        which a slow sweep reaches from one side; there the second answer is True.
        """
        at_rest = force / resistance(self.speed, self.rest, speeds)
        most = float(np.abs(at_rest).max(initial=0.0))
        if not len(self.amplitudes) or most == 0:
            return at_rest, np.zeros(len(speeds), dtype=bool)
        a = most * np.logspace(-FARTHEST, 1, STEPS)[:, None]
        over = a * np.abs(resistance(*self.at(a), speeds)) > force  # the amplitude asks for more force
        crossed = over[1:] & ~over[:-1]
        last = STEPS - 2 - np.argmax(crossed[::-1], axis=0)
        any_crossed = crossed.any(axis=0)  # else it lies below all steps, at rest
        low, high = a[last, 0], a[last + 1, 0]
        for _ in range(40):  # bisection to rounding
            middle = np.sqrt(low * high)
            more = middle * np.abs(resistance(*self.at(middle), speeds)) > force
            low, high = np.where(more, low, middle), np.where(more, middle, high)
        found = force / resistance(*self.at(np.where(any_crossed, high, 0.0)), speeds)
        return found, np.asarray(crossed.sum(axis=0) > 1)


def resistance(speed: Any, damping: Any, drive: Array) -> Complex:
    """Force over coordinate of a mode [1/s2] at circular frequencies [rad/s]: w^2 - W^2 + 2 i zeta w W."""
    return np.asarray(speed**2 - drive**2 + 2j * damping * speed * drive)


def rule(table: InputTable, speeds: Array, dampings: Array) -> tuple[Array, Array]:
    """Frequencies [Hz] (n,) and weights [Hz] (n,) for integrals over the band of a table.

    Stretches end at the rows of the table and at distances of 1, 2, 4 ... half widths from each resonance.

    Args:
        table: Of the input.
        speeds, dampings: Circular frequencies [rad/s] and damping ratios [-] of the modes (m,).
    """
    first, last = table.frequencies[[0, -1]]
    ends = [table.frequencies]
    for f, zeta in zip(speeds / (2 * np.pi), dampings, strict=True):
        if f > 0 and zeta > 0:
            most = np.log2(max(last, f) / (zeta * f)) + 1
            away = zeta * f * np.concatenate([[0.0], 2.0 ** np.arange(np.ceil(most))])
            ends += [f - away, f + away]
    every = np.unique(np.clip(np.concatenate(ends), first, last))
    middle, half = (every[1:] + every[:-1]) / 2, np.diff(every) / 2
    return (middle[:, None] + half[:, None] * PLACES).ravel(), (half[:, None] * WEIGHTS).ravel()


def resonance(speed: Array | float, damping: Array | float, frequencies: Array) -> Complex:
    """The coordinate of modes (m, n) [s2] under a unit force of frequencies [Hz] (n,)."""
    return 1 / resistance(np.atleast_1d(speed)[:, None], np.atleast_1d(damping)[:, None], 2 * np.pi * frequencies)


def variance(table: InputTable, force: float, speed: float, damping: float) -> float:
    """Mean square of the coordinate of one mode under a density of the input, by its modal force per unit of it."""
    f, weights = rule(table, np.array([speed]), np.array([damping]))
    return float(force**2 * (weights * table.at(f)) @ np.abs(resonance(speed, damping, f)[0]) ** 2)


def greatest(products: Array) -> Array:
    """Root of the greatest eigenvalue of matrices (..., k, k): rms, or amplitude, along the worst direction."""
    return np.asarray(np.sqrt(np.maximum(np.linalg.eigvalsh(products)[..., -1], 0.0)))
