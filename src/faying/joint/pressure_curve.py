"""Pressure as a function of approach, from a stiffness known at many pressures."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np

from faying.typing import Array

# powers of k in p below the least pressure: the greatest, with which k falls as the square of the approach and faces
# still meet (in proportion to p they never would); and that of one Hertzian spot, p as approach^(3/2)
GREATEST_FADE, HERTZ = 2 / 3, 1 / 3
ROUNDED = 1e-3  # of a power over a decade
DECADE = 10.0


@dataclass(frozen=True)
class PressureCurve:
    """p(w) with w the integral of dp/k from 0 to p, as a cubic of ln p over ln w with the slopes that k gives.

    Below the first pressure k goes on as a power of p (`fade`), so that it falls to 0 with p and w is finite; beyond
    the last, p goes on as a power of w.

    Args:
        log_w, log_p: ln of approach [m] and of pressure [Pa], rising.
        slope: d ln p/d ln w [-].
    """

    log_w: Array
    log_p: Array
    slope: Array

    @classmethod
    def of(cls, p: Array, k: Array) -> Self:
        """Return the curve of a stiffness k [Pa/m], positive, at rising pressures p [Pa]."""
        from scipy.special import exprel

        # between two points k is a power of p, so that the integral of dp/k is exact there
        steps = np.diff(np.log(p))
        pieces = p[:-1] / k[:-1] * steps * exprel(steps - np.diff(np.log(k)))
        first = p[0] / k[0] / (1 - fade(p, k))
        w = first + np.concatenate([[0.0], np.cumsum(pieces)])
        return cls(np.log(w), np.log(p), k * w / p)

    @property
    def end(self) -> float:
        """Approach [m] at the last pressure."""
        return float(np.exp(self.log_w[-1]))

    @cached_property
    def _pressure(self) -> tuple[Any, Any]:
        """ln p over ln w, and its derivative."""
        from scipy.interpolate import CubicHermiteSpline

        curve = CubicHermiteSpline(self.log_w, self.log_p, self.slope)
        return curve, curve.derivative()

    @cached_property
    def _approach(self) -> Any:
        """ln w over ln p."""
        from scipy.interpolate import CubicHermiteSpline

        return CubicHermiteSpline(self.log_p, self.log_w, 1 / self.slope)

    def pressure(self, approach: Array) -> tuple[Array, Array]:
        """Pressure [Pa] and its slope [Pa/m] at approaches [m] of any shape; both 0 where the faces are apart."""
        shut = approach > 0
        closing = np.where(shut, approach, self.end)
        x = np.log(closing)
        inside = np.clip(x, self.log_w[0], self.log_w[-1])
        end = np.where(x > inside, self.slope[-1], self.slope[0])
        curve, steepness = self._pressure
        p = np.where(shut, np.exp(curve(inside) + end * (x - inside)), 0.0)
        return p, p / closing * np.where(x == inside, steepness(inside), end)

    def approach(self, pressure: Array) -> Array:
        """Approach [m] at pressures [Pa] of any shape; 0 where there is none."""
        x = np.log(np.where(pressure > 0, pressure, 1.0))
        inside = np.clip(x, self.log_p[0], self.log_p[-1])
        end = np.where(x > inside, self.slope[-1], self.slope[0])
        return np.where(pressure > 0, np.exp(self._approach(inside) + (x - inside) / end), 0.0)


def fade(p: Array, k: Array) -> float:
    """Power of the pressure with which k goes on below the first of the pressures p [-].

    It is that of the law itself over its first decade. A law whose stiffness falls slower than that of one Hertzian
    spot does not resolve the last touch: its first points scatter, and k could rise while they open. Its k falls with
    `GREATEST_FADE`, smoothly in the approach.
    """
    first = min(int(np.searchsorted(p, DECADE * p[0])), len(p) - 1)
    power = float(np.log(k[first] / k[0]) / np.log(p[first] / p[0]))
    return min(power, GREATEST_FADE) if power >= HERTZ - ROUNDED else GREATEST_FADE
