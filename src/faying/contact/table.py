"""A checked table of a law over ln(pressure), for millions of pressures at once.

Each cell holds a parabola per quantity, through both ends and the middle. When the table is made, every cell is
compared with exact inversion at two more points; where it is off by more than TOLERANCE, or where a validity flag
changes, the cell is marked and its pressures are inverted one by one. So kinks cost time, not accuracy.
"""

from collections.abc import Callable
from math import ceil, log
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faying.contact.response import Response
from faying.typing import Array

STEP = 0.01  # width of a cell in ln(pressure)
DECADES = 12  # below the greatest pressure; lighter loads are inverted one by one
TOLERANCE = 3e-7  # relative, at the points of the check
EXACT = "exact"  # which pressures are inverted one by one
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
        parts = [self._at(part) for part in np.array_split(pressure, ceil(pressure.size / CHUNK) or 1)]
        rows = {name: np.concatenate([part[name] for part in parts]) for name in (*self.columns, *self.reasons, EXACT)}
        by_hand = np.flatnonzero(rows.pop(EXACT))
        if by_hand.size:
            exact = self.exact(pressure[by_hand])
            for name, value in (*exact.quantities().items(), *exact.reasons.items()):
                if name in rows:
                    rows[name][by_hand] = value
        reasons = {name: rows.pop(name) for name in self.reasons}
        return Response(pressure=pressure.copy(), reasons=reasons, **rows)

    def _at(self, pressure: Array) -> dict[str, NDArray[Any]]:
        """Quantities and reasons of some pressures, and which pressures are inverted one by one."""
        x = (np.log(pressure) - self.first) / self.step
        cell = np.clip(x.astype(np.intp), 0, self.cells - 1)
        t = x - cell
        out = {name: c0[cell] + t * (c1[cell] + t * c2[cell]) for name, (c0, c1, c2) in self.columns.items()}
        out |= {name: mask[cell] for name, mask in self.reasons.items()}
        return out | {EXACT: (x < 0) | ~self.good[cell]}
