"""Pressure as a function of approach, from a stiffness known at many pressures; and its table cell by cell."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Self

import numpy as np

from faying.typing import Array, Index

# powers of k in p below the least pressure: the greatest, with which k falls as the square of the approach and faces
# still meet (in proportion to p they never would); and that of one Hertzian spot, p as approach^(3/2)
GREATEST_FADE, HERTZ = 2 / 3, 1 / 3
ROUNDED = 1e-3  # of a power over a decade
DECADE = 10.0
BINS = 100_000  # most places of an index into a table


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
    _unscaled: "PressureCurve | None" = field(default=None, repr=False, compare=False)

    def scaled(self, factor: float) -> "PressureCurve":
        """The curve of a stiffness that is `factor` times as great at every pressure."""
        return PressureCurve(self.log_w - np.log(factor), self.log_p, self.slope, self)

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
    def cubic(self) -> Array:
        """Coefficients (4, cells) of ln p in ln w from the beginning of a cell; a shift of ln w leaves them."""
        from scipy.interpolate import CubicHermiteSpline

        if self._unscaled is not None:
            return self._unscaled.cubic
        return np.asarray(CubicHermiteSpline(self.log_w, self.log_p, self.slope).c)

    @cached_property
    def index(self) -> tuple[Index, float]:
        """Cell at equal steps of ln w from its beginning, and the step: none is longer than the shortest cell."""
        if self._unscaled is not None:
            return self._unscaled.index
        return equal_steps(self.log_w)

    @cached_property
    def _inverse(self) -> Any:
        """ln w at ln p, beyond the first of the table; a shift of ln w leaves it."""
        from scipy.interpolate import CubicHermiteSpline

        if self._unscaled is not None:
            return self._unscaled._inverse
        return CubicHermiteSpline(self.log_p, self.log_w - self.log_w[0], 1 / self.slope)

    def pressure(self, approach: Array) -> tuple[Array, Array]:
        """Pressure [Pa] and its slope [Pa/m] at approaches [m] of any shape; both 0 where the faces are apart."""
        return self.placed(approach)[:2]

    def placed(self, approach: Array) -> tuple[Array, Array, Array, Index]:
        """`pressure` and its slope, with ln p and the cell of the table that it lies in, the nearest outside the ends.

        ln p is that of the last pressure where the faces are apart.
        """
        log_w, slope = self.log_w, self.slope
        shut = approach > 0
        x = np.log(np.where(shut, approach, self.end))
        inside = np.clip(x, log_w[0], log_w[-1])
        cell = cells(log_w, inside, *self.index)
        cubic = self.cubic[:, cell]
        dx = inside - log_w[cell]
        value = ((cubic[0] * dx + cubic[1]) * dx + cubic[2]) * dx + cubic[3]
        steep = (3 * cubic[0] * dx + 2 * cubic[1]) * dx + cubic[2]
        end = np.where(x > log_w[-1], slope[-1], slope[0])
        outside = x != inside
        value = value + np.where(outside, end * (x - inside), 0.0)
        steep = np.where(outside, end, steep)
        p = np.where(shut, np.exp(value), 0.0)
        return p, np.where(shut, p * steep / np.where(shut, approach, 1.0), 0.0), value, cell

    def approach(self, pressure: Array) -> Array:
        """Approach [m] at pressures [Pa] of any shape; 0 where there is none."""
        x = np.log(np.where(pressure > 0, pressure, 1.0))
        inside = np.clip(x, self.log_p[0], self.log_p[-1])
        end = np.where(x > inside, self.slope[-1], self.slope[0])
        return np.where(pressure > 0, np.exp(self.log_w[0] + self._inverse(inside) + (x - inside) / end), 0.0)


def fade(p: Array, k: Array) -> float:
    """Power of the pressure with which k goes on below the first of the pressures p [-].

    It is that of the law itself over its first decade. A law whose stiffness falls slower than that of one Hertzian
    spot does not resolve the last touch: its first points scatter, and k could rise while they open. Its k falls with
    `GREATEST_FADE`, smoothly in the approach.
    """
    first = min(int(np.searchsorted(p, DECADE * p[0])), len(p) - 1)
    power = float(np.log(k[first] / k[0]) / np.log(p[first] / p[0]))
    return min(power, GREATEST_FADE) if power >= HERTZ - ROUNDED else GREATEST_FADE


def equal_steps(grid: Array) -> tuple[Index, float]:
    """For `cells`: the cell of a rising grid at equal steps from its beginning, and the step (0 without gain).

    No step is longer than the shortest cell, so that the next grid point settles which of two cells a value lies in.
    """
    step = float(np.diff(grid).min())
    count = float(grid[-1] - grid[0]) / step
    if not count < BINS:
        return np.zeros(1, dtype=np.int64), 0.0
    at = grid[0] + step * np.arange(int(count) + 2)
    return np.clip(np.searchsorted(grid, at, side="right") - 1, 0, len(grid) - 2).astype(np.int64), step


def cells(grid: Array, values: Array, index: Index, step: float) -> Index:
    """The cell (from 0) of a rising grid in which each of the values lies; all lie within the grid."""
    if not step:
        return np.clip(np.searchsorted(grid, values, side="right") - 1, 0, len(grid) - 2)
    cell = index[((values - grid[0]) * (1 / step)).astype(np.int64)]
    return np.asarray(np.minimum(cell + (values >= grid[cell + 1]), len(grid) - 2))


@dataclass(frozen=True, kw_only=True)
class ContactTable:
    """What `PressureCurve` and the stiffness between the points of a law's table come to, cell by cell of ln approach.

    One cell more lies at each end, in which ln p is straight. Where an index into the table takes more room than it
    saves, there is no such table.

    Args:
        cells: of each cell (c, 7) the ln approach [m] from which it counts; c0 to c3, with which ln p is
            ((c3 dx + c2) dx + c1) dx + c0 in it; a and b, with which ln k_t is a + b ln p.
        index, first, per_step: the cell at equal steps of ln approach from `first`, and steps in one unit of it.
        ends: ln approach at which each cell but the last ends (c - 1,).
    """

    cells: Array
    index: Index
    first: float
    per_step: float
    ends: Array

    @classmethod
    def of(cls, curve: PressureCurve, log_t: Array, fade: float) -> Self | None:
        """The table of a curve with ln k_t at its points; fade: power of the pressure with which it goes on below.

        None where a law has no tangential stiffness at some pressure, or too many steps would be needed.
        """
        index, step = curve.index
        if not step or not np.all(np.isfinite(log_t)):
            return None
        log_w, log_p = curve.log_w, curve.log_p
        low, high = (np.array([[0.0], [0.0], [curve.slope[i]], [log_p[i]]]) for i in (0, -1))
        slopes = np.diff(log_t) / np.diff(log_p)
        flat = np.concatenate([[fade], slopes, [0.0]])
        offset = np.concatenate([[log_t[0]], log_t[:-1], log_t[-1:]]) - flat * np.concatenate(
            [[log_p[0]], log_p[:-1], log_p[-1:]]
        )
        begins = np.concatenate([log_w[:1], log_w])
        cubic = np.concatenate([low, curve.cubic, high], axis=1)[::-1]
        return cls(
            cells=np.stack([begins, *cubic, offset, flat], axis=1),
            # one step more at each end, for all that lies beyond
            index=np.concatenate([[0], index + 1, [len(log_w)]]),
            first=float(log_w[0]) - step,
            per_step=1 / step,
            ends=log_w,
        )

    def at(self, log_w: Array) -> tuple[Array, Array, Array]:
        """ln p, d ln p/d ln w and ln k_t at logarithms of approaches (q,)."""
        place = np.minimum(np.maximum((log_w - self.first) * self.per_step, 0.0), len(self.index) - 1.0)
        cell = self.index.take(place.astype(np.intp), mode="clip")
        cell += log_w >= self.ends.take(cell, mode="clip")
        np.minimum(cell, len(self.cells) - 1, out=cell)
        begin, c0, c1, c2, c3, offset, power = self.cells.take(cell, axis=0, mode="clip").T
        dx = log_w - begin
        c3 *= dx
        log_p = ((c3 + c2) * dx + c1) * dx + c0
        steep = (3 * c3 + 2 * c2) * dx + c1
        return log_p, steep, offset + power * log_p
