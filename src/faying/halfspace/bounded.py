"""Least energy of a half-space under tractions between two bounds with a given mean: the one solver underneath.

    minimise  x.A x/2 - b.x   over   lower <= x <= upper,  mean(x) = mean

A projected Newton method. Each step solves the linear problem on the cells that are between their bounds, or at a
bound and pressed off it, by conjugate gradients in single precision, preconditioned by |q|, and projects the outcome
on the bounds and the mean. What the projection cuts off in one place it must not put back everywhere, since long waves
cost the most energy: so up to twice more the problem is solved on the cells that are left between their bounds. The
point of least energy is kept; where none is below the start, the first step is halved. Where many cells sit at the
upper bound, a projected-gradient step goes before it (More and Toraldo 1991, doi:10.1137/0801008; Bertsekas 1982,
doi:10.1137/0320018). Gradient, energy and error bound are in double precision.

The error bound is the duality gap. With g = A x - b and any level d, and G = g + d,

    sum (x - lower) max(G, 0) + (upper - x) max(-G, 0)  >=  energy(x) - least energy  >=  |x - x*|_A^2 / 2,

so it bounds the distance to the solution whatever the iteration did.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from typing import final

import numpy as np
from numpy.typing import NDArray

from faying.errors import NotConverged
from faying.halfspace.conjugate import constrained_gradients
from faying.halfspace.kernels import Kernel
from faying.typing import Array, Mask

Bound = float | Array
Progress = Callable[[int, float], object]
STEPS = 200
HALVES = (0.5, 0.25, 0.125)
ROUNDS = ((0.3, 20), (0.1, 10), (0.1, 10))  # reduction of the residual and most iterations, round after round
FEW = 1e-3  # share of the cells cut off by the projection below which another round is not worth its price


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Minimum:
    """x and its gradient g = A x - b, both flat; level d, residual (gap over total times scale), counts."""

    x: Array
    gradient: Array
    level: float
    residual: float
    steps: int
    applications: int


def _at(bound: Bound, where: NDArray[np.intp]) -> Bound:
    return bound[where] if isinstance(bound, np.ndarray) else bound


def project(v: Array, lower: Bound, upper: Bound, total: float) -> tuple[Array, float]:
    """Nearest point to v between the bounds whose sum is `total`, and the shift that gives it: clip(v + shift)."""
    scale = max(abs(total), float(np.abs(upper).sum()) if isinstance(upper, np.ndarray) else 0.0, 1e-300)
    clipped = np.clip(v, lower, upper)
    if abs(total - float(clipped.sum())) <= 1e-13 * scale:
        return clipped, 0.0  # a shift of rounding size would lift every cell off its bound
    low = float((lower - v).min())
    high = (
        float((upper - v).max())
        if isinstance(upper, np.ndarray) or isfinite(upper)
        else total / v.size - float(v.min())
    )
    shift = min(max((total - float(clipped.sum())) / v.size, low), high)
    for turn in range(200):
        moved = v + shift
        clipped = np.clip(moved, lower, upper)
        miss = total - float(clipped.sum())
        if abs(miss) <= 1e-13 * scale:
            break
        low, high = (shift, high) if miss > 0 else (low, shift)
        free = int(np.count_nonzero((moved > lower) & (moved < upper)))
        trial = shift + miss / free if free else high
        # Newton crawls where points leave their bounds: halve the bracket every third turn
        if not low < trial < high or turn % 3 == 2:
            trial = (low + high) / 2
        if trial in (shift, low, high):
            break
        shift = trial
    return clipped, shift


def duality_gap(x: Array, gradient: Array, lower: Bound, upper: Bound, level: float) -> float:
    """The bound on the energy's excess at level d (module text)."""
    G = gradient + level
    gap = float(((x - lower) * np.maximum(G, 0.0)).sum())
    if isinstance(upper, np.ndarray) or isfinite(upper):
        gap += float(((upper - x) * np.maximum(-G, 0.0)).sum())
    elif G.min() < 0:
        return np.inf
    return gap


def best_level(x: Array, gradient: Array, lower: Bound, upper: Bound) -> float:
    """The level of the least duality gap; for bounds that vary from cell to cell, the mean over the free cells."""
    if not isinstance(upper, np.ndarray) and not isinstance(lower, np.ndarray):
        if not isfinite(upper):
            return -float(gradient.min())
        filled = min(int((x.sum() - x.size * lower) / (upper - lower)), x.size - 1)
        return -float(np.partition(gradient, filled)[filled])
    free = (x > lower) & (x < upper)
    return -float(gradient[free].mean()) if free.any() else -float(np.median(gradient))


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """The problem of the module's text for one component: load b, bounds (flat arrays or numbers) and mean.

    `scale` is the displacement by which the error bound is measured: residual = gap/(sum |x| scale).
    """

    kernel: Kernel
    load: Array
    lower: Bound
    upper: Bound
    mean: float
    scale: float


def minimise(problem: Problem, *, tol: float, start: Array | None = None, progress: Progress | None = None) -> Minimum:
    """Solve the problem, from `start` (flat) where given.

    Raises NotConverged where the residual stays above tol after STEPS steps, or single precision can do no more.
    """
    return _Search(problem).run(tol, start, progress)


class _Search:
    def __init__(self, problem: Problem) -> None:
        self.kernel, self.load, self.lower, self.upper = problem.kernel, problem.load, problem.lower, problem.upper
        self.total, self.scale = problem.mean * problem.load.size, problem.scale
        self.pace = 1 / self.kernel.own
        self.applications = 0
        self.bounded = isinstance(self.upper, np.ndarray) or isfinite(self.upper)

    def apply(self, x: Array) -> Array:
        self.applications += 1
        return self.kernel.apply(x.reshape(1, *self.kernel.shape)).reshape(-1)

    def _imbalance(self) -> float:
        """Miss of the total, which steps leave at rounding; relative, and nothing below 1e-10."""
        miss = abs(float(self.x.sum()) - self.total) / max(abs(self.total), 1e-300)
        return miss if miss > 1e-10 else 0.0

    def run(self, tol: float, start: Array | None, progress: Progress | None) -> Minimum:
        n = self.load.size
        first = np.full(n, self.total / n) if start is None else start
        self.x = project(first, self.lower, self.upper, self.total)[0]
        self.g = self.apply(self.x) - self.load
        stuck, best, since = False, np.inf, 0
        for step in range(STEPS + 1):
            level = best_level(self.x, self.g, self.lower, self.upper)
            size = max(abs(self.total), float(np.abs(self.x).sum())) * self.scale
            residual = max(duality_gap(self.x, self.g, self.lower, self.upper, level) / size, self._imbalance())
            if progress is not None:
                progress(step, residual)
            if residual < tol:
                # the gradient was updated step by step: bound the error with a fresh one
                self.g = self.apply(self.x) - self.load
                level = best_level(self.x, self.g, self.lower, self.upper)
                residual = max(duality_gap(self.x, self.g, self.lower, self.upper, level) / size, self._imbalance())
                if residual < tol:
                    return Minimum(
                        x=self.x,
                        gradient=self.g,
                        level=level,
                        residual=residual,
                        steps=step,
                        applications=self.applications,
                    )
            best, since = (residual, 0) if residual < 0.9 * best else (best, since + 1)
            if since > 40:
                break
            free = (self.x > self.lower) & (self.x < self.upper)
            inside = int(np.count_nonzero(free))
            at_upper = int(np.count_nonzero(self.x >= self.upper)) if self.bounded else 0
            shift = None
            if inside == 0 or stuck or (self.bounded and (step == 0 or at_upper >= inside)):
                shift = self._gradient_step(once=step == 0)
                free = (self.x > self.lower) & (self.x < self.upper)
            stuck = not self._newton_step(free, shift)
        raise NotConverged(
            f"half-space contact: residual {best:.1e} after {step} steps, above the tolerance {tol:.1e}; "
            "ask for a larger tol, or smooth the map"
        )

    def _gradient_step(self, *, once: bool) -> float:
        """Step along the projected gradient, shortened until the energy falls; returns the level it used."""
        pace = self.pace
        level = 0.0
        for _ in range(1 if once else 12):
            y, shift = project(self.x - pace * self.g, self.lower, self.upper, self.total)
            level = -shift / pace
            v = y - self.x
            Av = self.apply(v)
            # v sums to 0: taking the level out of g changes nothing but the rounding
            down, curvature = float((self.g + level) @ v), float(v @ Av)
            if down + curvature / 2 < 0:
                self.x = y
                self.g += Av
                break
            if curvature <= 0:
                break
            pace *= min(max(-down / curvature, 0.1), 0.7)
        return level

    def _newton_step(self, free: Mask, shift: float | None) -> bool:
        """Solve on the working set, project, repeat on what is left of it; False where no point lowers the energy."""
        if free.any():
            level = -float(self.g[free].mean())
        else:
            level = shift if shift is not None else best_level(self.x, self.g, self.lower, self.upper)
        G = self.g + level
        working = free | ((self.x <= self.lower) & (G < 0))
        if self.bounded:
            working |= (self.x >= self.upper) & (G > 0)
        if isinstance(self.upper, np.ndarray):
            working &= np.asarray(self.lower < self.upper)
        index = np.flatnonzero(working)
        x, g, energy, least, start = self.x, self.g, 0.0, 0.0, (self.x, self.g)
        first: tuple[NDArray[np.intp], Array] | None = None
        for reduction, limit in ROUNDS:
            way = self._way(g, index, level, reduction, limit)
            if way is None:
                break
            first = first or (index, way)
            x, g, change, left = self._moved(x, g, index, way, level)
            energy += change
            if energy < least:
                self.x, self.g, least = x, g, energy
            if index.size - left.size < FEW * index.size or left.size < 2:
                break
            index, level = left, -float(g[left].mean())
        if least < 0 or first is None:
            return least < 0
        for share in HALVES:
            index, way = first
            x, g, change, _ = self._moved(*start, index, share * way, level)
            if change < 0:
                self.x, self.g = x, g
                return True
        return False

    def _way(self, g: Array, index: NDArray[np.intp], level: float, reduction: float, limit: int) -> Array | None:
        """What to add to the tractions of the cells `index` so that their gaps close; None where nothing is to do."""
        G = g[index] + level
        largest = float(np.abs(G).max()) if index.size >= 2 else 0.0
        if largest == 0.0:
            return None
        right = (-G / largest).astype(np.float32)[None]
        solved, used = constrained_gradients(self.kernel, index, right, np.zeros(1), reduction=reduction, limit=limit)
        self.applications += used
        return np.asarray(largest * solved[0].astype(np.float64))

    def _moved(
        self, x: Array, g: Array, index: NDArray[np.intp], way: Array, level: float
    ) -> tuple[Array, Array, float, NDArray[np.intp]]:
        """Go that way and project; returns x, g, what the energy has changed by, and the cells between their bounds."""
        old, lower, upper = x[index], _at(self.lower, index), _at(self.upper, index)
        new = project(old + way, lower, upper, float(old.sum()))[0]
        v = np.zeros(x.size)
        v[index] = new - old
        Av = self.apply(v)
        change = float((g[index] + level) @ v[index]) + float(v[index] @ Av[index]) / 2
        v += x
        Av += g
        return v, Av, change, index[(new > lower) & (new < upper)]
