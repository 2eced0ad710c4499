"""A checked table of a law over ln(pressure), for millions of pressures at once.

Each cell holds a parabola per quantity, through both ends and the middle. When the table is made, every cell is
compared with exact inversion at two more points; where it is off by more than TOLERANCE, or where a validity flag
changes, the cell is marked and its pressures are inverted one by one. So kinks cost time, not accuracy.
"""

from collections.abc import Callable
from math import ceil, log

import numpy as np
from numpy.typing import NDArray

from faying.contact.response import Response
from faying.typing import Array

STEP = 0.01  # width of a cell in ln(pressure)
DECADES = 12  # below the greatest pressure; lighter loads are inverted one by one
TOLERANCE = 3e-7  # relative, at the points of the check
CHUNK = 16384  # pressures at a time, so that the work stays in the cache


class PressureTable:
    """Table of `exact`, a law's exact inversion, from `least` to `greatest` pressure [Pa]."""

    def __init__(self, exact: Callable[[Array], Response], least: float, greatest: float) -> None:
        self.exact = exact
        # a hair inside both ends, which are exact only up to rounding
        last = log(greatest) - 1e-12
        first = max(log(least) + 1e-12, last - DECADES * log(10))
        self.cells = max(1, ceil((last - first) / STEP))
        self.first, self.step = first, (last - first) / self.cells
        place = (np.arange(self.cells)[:, None] + np.array([0.0, 0.25, 0.5, 0.75])).ravel()
        at = exact(np.exp(np.append(first + self.step * place, last)))

        def corners(values: NDArray[np.generic]) -> tuple[NDArray[np.generic], ...]:
            return values[:-1:4], values[1::4], values[2::4], values[3::4], values[4::4]

        self.good = np.ones(self.cells, dtype=bool)
        self.columns: dict[str, tuple[Array, Array, Array]] = {}
        for name, value in at.quantities().items():
            if name == "pressure":
                continue
            a, q1, m, q3, b = (np.asarray(v, float) for v in corners(value))
            parabola = np.ascontiguousarray(a), 4 * m - 3 * a - b, 2 * (a + b - 2 * m)
            for t, known in ((0.25, q1), (0.75, q3)):
                found = parabola[0] + t * (parabola[1] + t * parabola[2])
                self.good &= np.abs(found - known) <= TOLERANCE * np.abs(known)
            self.columns[name] = parabola
        self.reasons = {name: np.ascontiguousarray(corners(mask)[0]) for name, mask in at.reasons.items()}
        for mask in at.reasons.values():
            a, *others = corners(mask)
            for other in others:
                self.good &= a == other

    def at(self, pressure: Array) -> Response:
        """Return the response at flat positive pressures [Pa] up to the greatest."""
        n = pressure.size
        out = {name: np.empty(n) for name in self.columns}
        cell = np.empty(n, dtype=np.intp)
        by_hand: list[NDArray[np.intp]] = []
        t, work = np.empty(CHUNK), np.empty(CHUNK)
        for start in range(0, n, CHUNK):
            stop = min(start + CHUNK, n)
            x, w, i = t[: stop - start], work[: stop - start], cell[start:stop]
            np.log(pressure[start:stop], out=x)
            x -= self.first
            x *= 1 / self.step
            outside = x < 0
            np.clip(x, 0, self.cells - 0.5e-9, out=x)
            i[:] = x
            np.minimum(i, self.cells - 1, out=i)
            x -= i
            for name, (c0, c1, c2) in self.columns.items():
                y = out[name][start:stop]
                c2.take(i, out=y, mode="clip")
                y *= x
                c1.take(i, out=w, mode="clip")
                y += w
                y *= x
                c0.take(i, out=w, mode="clip")
                y += w
            rest = np.flatnonzero(outside | ~self.good.take(i, mode="clip"))
            if rest.size:
                by_hand.append(rest + start)
        reasons = {}
        for name, mask in self.reasons.items():
            reasons[name] = mask.take(cell, mode="clip") if mask.any() else np.zeros(n, dtype=bool)
        if by_hand:
            rows = np.concatenate(by_hand)
            at = self.exact(pressure[rows])
            for name, value in at.quantities().items():
                if name in out:
                    out[name][rows] = value
            for name, mask in at.reasons.items():
                reasons[name][rows] = mask
        return Response(pressure=pressure.copy(), reasons=reasons, **out)
