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
        begins: ln approach [m] from which each cell counts (c,).
        cubic: ln p is ((c3 dx + c2) dx + c1) dx + c0 in a cell, one row for each coefficient (4, c).
        tangential: ln k_t is a + b ln p in a cell: a and b (2, c).
        index, first, per_step: the cell at equal steps of ln approach from `first`, and steps in one unit of it.
        ends: ln approach at which each cell but the last ends (c - 1,).
    """

    begins: Array
    cubic: Array
    tangential: Array
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
        return cls(
            begins=np.concatenate([log_w[:1], log_w]),
            cubic=np.ascontiguousarray(np.concatenate([low, curve.cubic, high], axis=1)[::-1]),
            tangential=np.stack([offset, flat]),
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
        np.minimum(cell, len(self.begins) - 1, out=cell)
        dx = log_w - self.begins.take(cell, mode="clip")
        c0, c1, c2, c3 = (row.take(cell, mode="clip") for row in self.cubic)
        c3 *= dx
        log_p = ((c3 + c2) * dx + c1) * dx + c0
        steep = (3 * c3 + 2 * c2) * dx + c1
        offset, power = (row.take(cell, mode="clip") for row in self.tangential)
        return log_p, steep, offset + power * log_p
