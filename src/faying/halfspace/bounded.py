"""Least energy of a half-space under tractions between two bounds with a given mean: the one solver underneath.

    minimise  x.A x/2 - b.x   over   lower <= x <= upper,  mean(x) = mean

A projected Newton method. Each step solves the linear problem on the cells that are between their bounds, or at a
bound and pressed off it, by conjugate gradients in single precision, preconditioned on two levels (`conjugate`), and
projects the outcome on the bounds and the mean.
What the projection cuts off in one place it must not put back everywhere, since long waves
cost the most energy: so up to twice more the problem is solved on the cells that are left between their bounds. The
point of least energy is kept; where none is below the start, the first step is halved. Where many cells sit at the
upper bound, a projected-gradient step goes before it (More and Toraldo 1991, doi:10.1137/0801008; Bertsekas 1982,
doi:10.1137/0320018). Products on the way are in single precision; the error that this leaves in the gradient is kept
count of, and the gradient is made afresh in double precision before it matters and before the end.

The error bound is the duality gap. With g = A x - b and any level d, and G = g + d,

    sum (x - lower) max(G, 0) + (upper - x) max(-G, 0)  >=  energy(x) - least energy  >=  |x - x*|_A^2 / 2,

so it bounds the distance to the solution whatever the iteration did.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from typing import Any, final

import numpy as np

from faying.errors import NotConverged
from faying.halfspace.arrays import dot, parts, total
from faying.halfspace.cells import Cells
from faying.halfspace.conjugate import CellSystem, constrained_gradients
from faying.halfspace.kernels import Kernel
from faying.typing import AnyArray

Bound = float | AnyArray
Progress = Callable[[int, float], object]
Start = Callable[[], AnyArray]
STEPS = 200
HALVES = (0.5, 0.25, 0.125)
ROUNDS = ((0.3, 20), (0.3, 10), (0.3, 10))  # root of what the last turn may gain over all; most turns
MIN_PROJECTED = 1e-3  # share of the cells cut off by the projection below which another round is not worth its price
ROUNDING = 3e-7  # error of a product in single precision, over the largest displacement that it gives


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Minimum:
    """x and G = A x - b + d, both flat; level d, residual (gap over total times scale), counts."""

    x: AnyArray
    G: AnyArray
    level: float
    residual: float
    steps: int
    applications: int


def _at(bound: Bound, where: Any) -> Bound:
    return bound if isinstance(bound, (int, float)) else bound[where]


def _is_finite(bound: Bound) -> bool:
    return not isinstance(bound, (int, float)) or isfinite(bound)


def project(v: AnyArray, lower: Bound, upper: Bound, total: float) -> tuple[AnyArray, float]:
    """Nearest point to v between the bounds whose sum is `total`, and the shift that gives it: clip(v + shift).

    The point takes the place of v.
    """
    size = int(v.shape[0])
    scale = max(abs(total), 0.0 if isinstance(upper, (int, float)) else float(np.sum(np.abs(upper))), 1e-300)
    near = (1e-13 if v.dtype == np.float64 else 1e-8) * scale

    def look(shift: float) -> tuple[float, int]:
        """Sum of the clipped values, and how many stay off their bounds."""
        found, free = 0.0, 0
        for s in parts(v):
            moved, low, high = v[s] + shift, _at(lower, s), _at(upper, s)
            found += float(np.sum(np.clip(moved, low, high), dtype=np.float64))
            free += int(np.count_nonzero((moved > low) & (moved < high)))
        return found, free

    shift, (found, free) = 0.0, look(0.0)
    if abs(total - found) <= near:
        np.clip(v, lower, upper, out=v)
        return v, 0.0  # a shift of rounding size would lift every cell off its bound
    low = min(float(np.min(_at(lower, s) - v[s])) for s in parts(v))
    high = total / size - float(np.min(v))
    if _is_finite(upper):
        high = max(float(np.max(_at(upper, s) - v[s])) for s in parts(v))
    shift = min(max((total - found) / size, low), high)
    for turn in range(200):
        found, free = look(shift)
        miss = total - found
        if abs(miss) <= near:
            break
        low, high = (shift, high) if miss > 0 else (low, shift)
        trial = shift + miss / free if free else high
        # Newton crawls where points leave their bounds: halve the bracket every third turn
        if not low < trial < high or turn % 3 == 2:
            trial = (low + high) / 2
        if trial in (shift, low, high):
            break
        shift = trial
    v += shift
    np.clip(v, lower, upper, out=v)
    return v, shift


def duality_gap(x: AnyArray, gradient: AnyArray, lower: Bound, upper: Bound, level: float) -> float:
    """The bound on the energy's excess at level d (module text)."""
    bounded, gap, least = _is_finite(upper), 0.0, 0.0
    for s in parts(x):
        G = gradient[s] + level
        gap += total((x[s] - _at(lower, s)) * np.maximum(G, 0.0))
        if bounded:
            gap += total((_at(upper, s) - x[s]) * np.maximum(-G, 0.0))
        else:
            least = min(least, float(np.min(G)))
    return np.inf if least < 0 else gap


def best_level(x: AnyArray, gradient: AnyArray, lower: Bound, upper: Bound) -> float:
    """The level of the least duality gap; for bounds that vary from cell to cell, the mean over the free cells.

    Without a free cell the gap is least where the cells with G < 0 could carry, at their upper bounds, what x carries.
    """
    size = int(x.shape[0])
    if isinstance(upper, (int, float)) and isinstance(lower, (int, float)):
        if not isfinite(upper):
            return -float(np.min(gradient))
        place = min(int((total(x) - size * lower) / (upper - lower)), size - 1)
        return -float(np.partition(gradient, place)[place])
    free = (x > lower) & (x < upper)
    if bool(np.any(free)):
        return -float(np.mean(gradient[free]))
    order = np.argsort(gradient)
    room = np.cumulative_sum(np.asarray(upper - lower)[order])
    at = int(np.searchsorted(room, np.asarray(total(x - lower), dtype=room.dtype)))
    return -float(gradient[order[min(at, size - 1)]])


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """The problem of the module's text for one component: load, bounds (flat arrays or numbers) and mean.

    b = (load - datum)/unit; the load may be of any precision. `scale` is the displacement by which the error bound is
    measured: residual = gap/(sum |x| scale).
    """

    kernel: Kernel
    load: AnyArray
    lower: Bound
    upper: Bound
    mean: float
    scale: float
    datum: float = 0.0
    unit: float = 1.0

    def gradient_at(
        self, x: AnyArray, level: float, *, precise: bool, out: AnyArray | None = None
    ) -> tuple[AnyArray, float]:
        """A x - b + level (in `out`), and the largest displacement; without `precise` a product in single precision."""
        kernel = self.kernel
        width = kernel.shape[1]
        pieces = [slice(rows.start * width, rows.stop * width) for rows in kernel.rows]
        out = np.empty(x.shape[0], dtype=x.dtype) if out is None else out
        largest = 0.0
        work = np.float64 if precise else np.float32

        def read(_: int, i: int) -> AnyArray:
            return np.reshape(np.astype(x[pieces[i]], work, copy=False), (-1, width))

        def write(_: int, i: int, block: AnyArray) -> None:
            nonlocal largest
            here = np.reshape(block, (-1,))
            largest = max(largest, float(np.max(np.abs(here))))
            load = np.astype(self.load[pieces[i]], np.float64, copy=False)
            here = here + (self.datum / self.unit + level - load / self.unit)
            out[pieces[i]] = np.astype(here, x.dtype, copy=False)

        kernel.stream(kernel.symbol if precise else kernel.symbol_single, read, write)
        return out, largest


def minimise(
    problem: Problem, *, tol: float, start: Start | None = None, least: int = 0, progress: Progress | None = None
) -> Minimum:
    """Solve the problem in at least `least` steps, from what `start` makes (flat), so that nobody else keeps the array.

    Raises NotConverged where the residual stays above tol after STEPS steps, or single precision can do no more.
    """
    return _Search(problem, start).run(tol, least, progress)


class _Search:
    """g is the gradient plus the datum d, which brings it near 0 where x is between its bounds."""

    def __init__(self, problem: Problem, start: Start | None) -> None:
        self.problem, self.kernel = problem, problem.kernel
        self.real = problem.kernel.arithmetic.real
        self.lower, self.upper = problem.lower, problem.upper
        n = problem.load.shape[0]
        self.total, self.scale = problem.mean * n, problem.scale
        self.pace = 1 / self.kernel.own
        self.applications = 0
        self.bounded = _is_finite(self.upper)
        self.datum = 0.0
        self.doubt = 0.0  # what single precision may have left in g
        first = np.full(n, self.total / n, dtype=self.real) if start is None else start()
        self.x = project(first, self.lower, self.upper, self.total)[0]
        self.g: AnyArray = np.empty(n, dtype=self.real)
        self.refresh(0.0, precise=False)

    def refresh(self, level: float, *, precise: bool) -> None:
        """Make the gradient from x alone."""
        self.applications += 1
        self.datum += level
        largest = self.problem.gradient_at(self.x, self.datum, precise=precise, out=self.g)[1]
        self.doubt = 0.0 if precise else ROUNDING * largest

    def _imbalance(self) -> float:
        """Miss of the total, which steps leave at rounding; relative, and nothing below what that is."""
        miss = abs(total(self.x) - self.total) / max(abs(self.total), 1e-300)
        return miss if miss > (1e-10 if self.real == np.float64 else 1e-6) else 0.0

    def measured(self) -> tuple[float, float]:
        """The level and the residual of this x and g."""
        level = best_level(self.x, self.g, self.lower, self.upper)
        size = max(abs(self.total), sum(total(np.abs(self.x[s])) for s in parts(self.x))) * self.scale
        gap = duality_gap(self.x, self.g, self.lower, self.upper, level)
        return level, max(gap / size, self._imbalance())

    def run(self, tol: float, least: int, progress: Progress | None) -> Minimum:
        stuck, best, since = False, np.inf, 0
        for step in range(STEPS + 1):
            level, residual = self.measured()
            if self.doubt and step >= least and residual < max(tol, 4 * self.doubt / self.scale):
                # the gradient was updated step by step: bound the error with a fresh one
                self.refresh(level, precise=True)
                level, residual = self.measured()
            if progress is not None:
                progress(step, residual)
            if residual < tol and step >= least:
                self.g += level
                return Minimum(
                    x=self.x,
                    G=self.g,
                    level=self.datum + level,
                    residual=residual,
                    steps=step,
                    applications=self.applications,
                )
            best, since = (residual, 0) if residual < 0.9 * best else (best, since + 1)
            if since > 40:
                break
            inside, at_upper = self._counted()
            shift = None
            if inside == 0 or stuck or (self.bounded and (step == 0 or at_upper >= inside)):
                shift = self._gradient_step(once=step == 0)
            stuck = not self._newton_step(shift)
        remedy = "smooth the map" if self.kernel.arithmetic.precision == "double" else 'precision="double"'
        raise NotConverged(
            f"half-space contact: residual {best:.1e} after {step} steps, above the tolerance {tol:.1e}; "
            f"ask for a larger tol, or {remedy}"
        )

    def _counted(self) -> tuple[int, int]:
        """How many cells are between their bounds, and how many at the upper one."""
        inside = at_upper = 0
        for s in parts(self.x):
            x = self.x[s]
            inside += int(np.count_nonzero((x > _at(self.lower, s)) & (x < _at(self.upper, s))))
            at_upper += int(np.count_nonzero(x >= _at(self.upper, s))) if self.bounded else 0
        return inside, at_upper

    def _gradient_step(self, *, once: bool) -> float:
        """Step along the projected gradient, shortened until the energy falls; returns the level it used."""
        pace, level = self.pace, 0.0
        every = Cells(self.kernel, np.ones(self.x.shape[0], dtype=np.bool))
        for _ in range(1 if once else 12):
            y = -pace * self.g
            y += self.x
            y, shift = project(y, self.lower, self.upper, self.total)
            level = -shift / pace
            y -= self.x
            # y sums to 0: taking the level out of g changes nothing but the rounding
            g, curvature, doubt = self._added(every, y)
            down = sum(total((self.g[s] + level) * y[s]) for s in parts(y))
            if down + curvature / 2 < 0:
                self.doubt += doubt
                y += self.x
                np.clip(y, self.lower, self.upper, out=y)
                self.x, self.g = y, g
                break
            if curvature <= 0:
                break
            pace *= min(max(-down / curvature, 0.1), 0.7)
        return level

    def _working(self, level: float) -> AnyArray:
        """The cells between their bounds, or at one and pressed off it."""
        out = np.empty(self.x.shape[0], dtype=np.bool)
        for s in parts(self.x):
            x, g, lower, upper = self.x[s], self.g[s], _at(self.lower, s), _at(self.upper, s)
            working = ((x > lower) & (x < upper)) | ((x <= lower) & (g < -level))
            if self.bounded:
                working |= (x >= upper) & (g > -level)
            if not isinstance(upper, (int, float)):
                working &= lower < upper
            out[s] = working
        return out

    def _level(self, shift: float | None) -> float:
        """The mean over the cells between their bounds, else the one of the gradient step."""
        count, found = 0, 0.0
        for s in parts(self.x):
            x = self.x[s]
            free = (x > _at(self.lower, s)) & (x < _at(self.upper, s))
            count += int(np.count_nonzero(free))
            found += total(self.g[s][free])
        if count:
            return -found / count
        return shift if shift is not None else best_level(self.x, self.g, self.lower, self.upper)

    def _newton_step(self, shift: float | None) -> bool:
        """Solve on the working set, project, repeat on what is left of it; False where no point lowers the energy."""
        level = self._level(shift)
        cells = Cells(self.kernel, self._working(level))
        x, g, energy, least, doubt = self.x, self.g, 0.0, 0.0, 0.0
        first: tuple[Cells, AnyArray] | None = None
        for reduction, limit in ROUNDS:
            way = self._way(g, cells, level, reduction, limit)
            if way is None:
                break
            if least == 0.0:
                first = first or (cells, way)
            x, g, change, left, more = self._moved(x, g, cells, way, level)
            energy, doubt = energy + change, doubt + more
            if energy < least:
                self.x, self.g = x, g
                least, self.doubt, doubt, first = energy, self.doubt + doubt, 0.0, None
            few = cells.size - left.size < MIN_PROJECTED * cells.size
            cells = left
            if few or left.size < 2:
                break
            level = -total(g[cells.mask]) / cells.size
        if least < 0 or first is None:
            return least < 0
        for share in HALVES:
            cells, way = first
            x, g, change, _, more = self._moved(self.x, self.g, cells, share * way, level)
            if change < 0:
                self.x, self.g = x, g
                self.doubt += more
                return True
        return False

    def _way(self, g: AnyArray, cells: Cells, level: float, reduction: float, limit: int) -> AnyArray | None:
        """What to add to the tractions of the cells so that their gaps close; None where nothing is to do."""
        if cells.size < 2:
            return None
        G = g[cells.mask] + level
        largest = float(np.max(np.abs(G)))
        if largest == 0.0:
            return None
        right = np.astype(G / -largest, np.float32)[None, :]
        del G
        system = CellSystem(self.kernel, cells)
        way = constrained_gradients(system, right, np.zeros(1), reduction=reduction, limit=limit)[0, :]
        self.applications += system.used
        way *= largest
        return way

    def _added(self, cells: Cells, v: AnyArray, g: AnyArray | None = None) -> tuple[AnyArray, float, float]:
        """Gradient after adding v on the cells, v.A v, and what single precision may have left in the gradient."""
        before = self.g if g is None else g
        self.applications += 1
        out = np.empty_like(before)
        size = float(np.max(np.abs(v))) or 1.0
        scaled = np.astype(v / size, np.float32)
        curvature = largest = 0.0

        def write(_: int, i: int, block: AnyArray) -> None:
            nonlocal curvature, largest
            piece = cells.pieces[i]
            Av = np.reshape(block, (-1,))
            largest = max(largest, float(np.max(np.abs(Av))))
            curvature += total(Av[cells.mask[piece]] * scaled[cells.starts[i] : cells.starts[i + 1]])
            out[piece] = before[piece] + size * np.astype(Av, self.real, copy=False)

        self.kernel.stream(self.kernel.symbol_single, lambda _, i: cells.block(scaled, i), write)
        return out, curvature * size**2, ROUNDING * largest * size

    def _moved(
        self, x: AnyArray, g: AnyArray, cells: Cells, way: AnyArray, level: float
    ) -> tuple[AnyArray, AnyArray, float, Cells, float]:
        """Go that way and project; returns x, g, change of energy, cells between their bounds, doubt about g."""
        old, lower, upper = x[cells.mask], _at(self.lower, cells.mask), _at(self.upper, cells.mask)
        new = project(old + way, lower, upper, total(old))[0]
        out = x.copy()
        out[cells.mask] = new
        left = np.zeros(x.shape[0], dtype=np.bool)
        left[cells.mask] = (new > lower) & (new < upper)
        new -= old
        del old
        after, curvature, doubt = self._added(cells, new, g)
        change = dot(g[cells.mask] + level, new) + curvature / 2
        return out, after, change, Cells(self.kernel, left), doubt
