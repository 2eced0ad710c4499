"""Pressure as a function of approach, from a stiffness known at many pressures."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from faying.typing import Array, Mask

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
    def of(cls, p: Array, k: Array, power: float | None = None) -> Self:
        """Return the curve of a stiffness k [Pa/m], positive, at rising pressures p [Pa].

        Several curves stand in rows, to be read by `UnloadingCurve`. power: of p with which k goes on below the first
        pressure [-]; that of `fade` where None.
        """
        from scipy.special import exprel

        # between two points k is a power of p, so that the integral of dp/k is exact there
        steps = np.diff(np.log(p))
        pieces = p[..., :-1] / k[..., :-1] * steps * exprel(steps - np.diff(np.log(k)))
        first = p[..., :1] / k[..., :1] / (1 - (fade(p, k) if power is None else power))
        w = first + np.concatenate([np.zeros_like(first), np.cumsum(pieces, axis=-1)], axis=-1)
        return cls(np.log(w), np.log(p), k * w / p)

    @property
    def end(self) -> float:
        """Approach [m] at the last pressure."""
        return float(np.exp(self.log_w[-1]))

    @property
    def parted(self) -> Array:
        """Approach [m] (1,) at which the faces part: 0, for all points."""
        return np.zeros(1)

    def at(self, points: Mask) -> Self:
        """The curve of some of the points of a joint: the same for all."""
        return self

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


@dataclass(frozen=True, kw_only=True, eq=False)
class UnloadingCurve:
    """p(w) of points that have carried `greatest` pressures: first loading from there on, a curve of their own below.

    Each of these is a cubic of ln p over ln v, with v the approach from where the faces part.

    Args:
        first: pressure over approach on first loading.
        log_v, log_p, slope: ln of approach [m] and of pressure [Pa], rising, and d ln p/d ln v [-] (q, cells).
        parted: approach [m] (q,) at which the faces part; what lasts of the flattening.
        turn: approach [m] (q,) at the greatest pressure; 0 where nothing has been carried.
    """

    first: PressureCurve
    log_v: Array
    log_p: Array
    slope: Array
    parted: Array
    turn: Array

    @property
    def end(self) -> float:
        """Approach [m] at the last pressure of the law."""
        return self.first.end

    def at(self, points: Mask) -> Self:
        """The curves of some of the points."""
        own = ("log_v", "log_p", "slope", "parted", "turn")
        return replace(self, **{name: getattr(self, name)[points] for name in own})

    def pressure(self, approach: Array) -> tuple[Array, Array]:
        """Pressure [Pa] and its slope [Pa/m] at approaches [m] (q,) or (q, n); both 0 where the faces are apart."""
        parted, turn = self._columns(approach)
        v = approach - parted
        below = (v > 0) & (approach < turn)
        x = np.log(np.where(below, v, 1.0))
        y, dy = self._cubic(x, below, self.log_v, self.log_p, self.slope)
        first, k = self.first.pressure(np.where(approach < turn, 0.0, approach))
        p = np.exp(y)
        return np.where(below, p, first), np.where(below, dy * p / np.where(below, v, 1.0), k)

    def approach(self, pressure: Array) -> Array:
        """Approach [m] at pressures [Pa] (q,) or (q, n); where they part at no pressure."""
        parted, turn = self._columns(pressure)
        most = np.exp(self.log_p[:, -1]).reshape(parted.shape)
        below = (pressure > 0) & (turn > 0) & (pressure < most)
        x = np.log(np.where(below, pressure, 1.0))
        y, _ = self._cubic(x, below, self.log_p, self.log_v, 1 / self.slope)
        return np.where(below, parted + np.exp(y), np.where(pressure > 0, self.first.approach(pressure), parted))

    def _columns(self, values: Array) -> tuple[Array, Array]:
        """`parted` and `turn` beside values of shape (q,) or (q, n)."""
        more = (slice(None),) + (None,) * (np.ndim(values) - 1)
        return self.parted[more], self.turn[more]

    def _cubic(self, x: Array, used: Mask, knots: Array, values: Array, slopes: Array) -> tuple[Array, Array]:
        """Cubic Hermite interpolation (q,) or (q, n) on the knots of each point, and its derivative.

        A straight line goes on before the first knot; what is not used is not looked for.
        """
        flat = x if x.ndim == 2 else x[:, None]
        cell = np.zeros(flat.shape, dtype=np.int64)
        for k in range(1, knots.shape[1] - 1):
            cell += flat >= knots[:, k, None]
        row = np.arange(len(flat))[:, None]
        a, b = knots[row, cell], knots[row, cell + 1]
        h = b - a
        t = np.clip((flat - a) / h, 0.0, 1.0)
        low, high = values[row, cell], values[row, cell + 1]
        m, n = h * slopes[row, cell], h * slopes[row, cell + 1]
        rise = high - low
        y = low + t * (m + t * (3 * rise - 2 * m - n + t * (m + n - 2 * rise)))
        dy = (m + t * (2 * (3 * rise - 2 * m - n) + t * 3 * (m + n - 2 * rise))) / h
        before = np.minimum(flat - knots[:, :1], 0.0)
        y = y + before * slopes[:, :1]
        shape = x.shape
        return np.where(used, y.reshape(shape), 0.0), np.where(used, dy.reshape(shape), 0.0)


def fade(p: Array, k: Array) -> float:
    """Power of the pressure with which k goes on below the first of the pressures p [-].

    It is that of the law itself over its first decade. A law whose stiffness falls slower than that of one Hertzian
    spot does not resolve the last touch: its first points scatter, and k could rise while they open. Its k falls with
    `GREATEST_FADE`, smoothly in the approach.
    """
    first = min(int(np.searchsorted(p, DECADE * p[0])), len(p) - 1)
    power = float(np.log(k[first] / k[0]) / np.log(p[first] / p[0]))
    return min(power, GREATEST_FADE) if power >= HERTZ - ROUNDED else GREATEST_FADE
