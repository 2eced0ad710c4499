"""A mode whose frequency and damping depend on its amplitude, under random and under sinusoidal forces.

q is the coordinate of a mass-normalised shape: q'' + 2 zeta(a) omega(a) q' + omega(a)^2 q = f, a the amplitude of q.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import Any

import numpy as np

from faying.typing import Array, Complex, Mask

# Gauss-Laguerre nodes x = a^2/(2 sigma^2): over Rayleigh's distribution of the amplitude x is exponential. 24 hold the
# means below to 1e-6 of a damping that goes from one plateau to another over a decade
NODES = 24
# rms over that with the damping at rest, between which the balance is sought: less where slip damps, more where a mode
# that softens moves into the band of the input
LOWEST, HIGHEST = 1e-4, 1e4
SCANNED = 33  # steps between them, four in a decade
STEPS = 400  # of amplitude, among which a sine's answers are sought: a step is 3 % of it
FARTHEST = 4.0  # decades of amplitude below the resonance at rest in which they are sought


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

        Both are smooth between the points, in the logarithm of the amplitude. Below the first point the change of the
        frequency and the damping of slip fall in proportion to the amplitude; beyond the last they stay.
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
        return PchipInterpolator(known, self.speeds), PchipInterpolator(known, self.slips)

    def equivalent(self, sigma: float) -> tuple[float, float]:
        """Circular frequency [rad/s] and damping ratio [-] of the linear mode that loses as much at an rms of q.

        E[zeta omega^3 a^2] is the mean power lost, over the distribution of the amplitude of a narrow band (Rayleigh):
        zeta_eq = E[zeta omega^3 a^2] / E[omega^3 a^2], omega_eq^3 = E[omega^3 a^2] / E[a^2].
        """
        x, weights = _laguerre()
        speed, damping = self.at(sigma * np.sqrt(2 * x))
        cubes = float(weights @ (x * speed**3))  # E[a^2] = 2 sigma^2, so that weights @ x = 1
        return float(np.cbrt(cubes)), float(weights @ (x * damping * speed**3)) / cubes

    def balance(self, variance: Callable[[float, float], float]) -> float:
        """The rms of q [m kg^1/2] at which the equivalent linear mode has that rms itself.

        variance: of q [m2 kg], by circular frequency [rad/s] and damping ratio [-]. Under white noise this is
        E[zeta omega^3 a^2] = pi S_0, the balance of power in and power lost.
        """
        from scipy.optimize import brentq

        rest = float(np.sqrt(variance(self.speed, self.rest)))
        if rest == 0 or not len(self.amplitudes):
            return rest

        def short(log_sigma: float) -> float:
            sigma = float(np.exp(log_sigma))
            return 0.5 * float(np.log(variance(*self.equivalent(sigma)))) - log_sigma

        steps = np.log(rest * np.geomspace(LOWEST, HIGHEST, SCANNED))
        above = np.flatnonzero(np.array([short(one) for one in steps]) > 0)
        # of several answers the greatest, which the vibration may reach
        k = min(int(above[-1]), SCANNED - 2)
        return float(np.exp(brentq(short, steps[k], steps[k + 1], xtol=1e-10)))

    def forced(self, force: Array, speeds: Array) -> tuple[Complex, Mask]:
        """The coordinate under harmonic forces [N kg^-1/2] of circular frequencies [rad/s] (n,), and whether it jumps.

        |f| = a |omega(a)^2 - Omega^2 + 2 i zeta(a) omega(a) Omega| may have several amplitudes: the greatest is taken,
        which a slow sweep reaches from one side; there the second answer is True.
        """

        def resisted(w: Any, z: Any) -> Complex:
            return np.asarray(w**2 - speeds**2 + 2j * z * w * speeds)

        at_rest = force / resisted(self.speed, self.rest)
        most = float(np.abs(at_rest).max(initial=0.0))
        if not len(self.amplitudes) or most == 0:
            return at_rest, np.zeros(len(speeds), dtype=bool)
        a = most * np.logspace(-FARTHEST, 1, STEPS)[:, None]
        over = a * np.abs(resisted(*self.at(a))) > force  # the amplitude asks for more force
        crossed = over[1:] & ~over[:-1]
        last = STEPS - 2 - np.argmax(crossed[::-1], axis=0)
        any_crossed = crossed.any(axis=0)  # else it lies below all steps, at rest
        low, high = a[last, 0], a[last + 1, 0]
        for _ in range(40):  # bisection to rounding
            middle = np.sqrt(low * high)
            more = middle * np.abs(resisted(*self.at(middle))) > force
            low, high = np.where(more, low, middle), np.where(more, middle, high)
        found = force / resisted(*self.at(np.where(any_crossed, high, 0.0)))
        return found, np.asarray(crossed.sum(axis=0) > 1)


@cache
def _laguerre() -> tuple[Array, Array]:
    return np.polynomial.laguerre.laggauss(NODES)
