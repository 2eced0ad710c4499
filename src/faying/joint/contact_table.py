"""Pressure, its slope and the tangential stiffness of a law at many approaches, from one look at a table."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from faying.joint.pressure_curve import PressureCurve
from faying.typing import Array, Index


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
