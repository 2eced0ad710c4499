"""Tangent stiffness of a solved contact: one linear problem on a frozen set of points per number."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying.errors import NotConverged
from faying.halfspace.cells import Cells
from faying.halfspace.conjugate import CellSystem, constrained_gradients
from faying.halfspace.kernels import Kernel
from faying.typing import AnyArray, Array, Mask

PASSES = 12
ENOUGH = 1e-6  # of the compliance: error at which no further pass is made; a pass nearly squares it
MARGIN = 3.0  # error over what the preconditioner says of it; seen: 0.5 to 1.33


@final
@dataclass(frozen=True, kw_only=True)
class Tangent:
    """Stiffness per nominal area [Pa/m] of a contact at its load; infinite where the surfaces touch everywhere.

    k_n_unloading: the load changes by little; every touching point is elastic. k_n_loading: the load grows on the
    points that touch now; those at hardness stay there and add nothing. Without a hardness the two are one. With it
    k_n_loading leaves out that the contact grows by points which soon are at hardness themselves: the slope of a
    loading curve is the difference quotient of the `approach` of two contacts. k_t: shear without slip, mean of the two
    directions; k_tensor, shape (2, 2), the directions x and y and their coupling. k_n is k_n_loading.
    """

    k_n_loading: float
    k_n_unloading: float
    k_t: float
    k_tensor: Array

    @property
    def k_n(self) -> float:
        """The stiffness against further load [Pa/m]."""
        return self.k_n_loading


def stiffness_on(kernel: Kernel, touching: Mask) -> Array:
    """Stiffness matrix (c, c), per nominal area, of the points of a map moved as one rigid punch; scaled units.

    The traction of least energy that carries a unit mean load; its energy is the compliance, so that an error e in
    the traction leaves e^2 in the stiffness, which the preconditioner tells from the residual. Raises NotConverged
    where the passes do not settle.
    """
    c, n = kernel.components, touching.size
    cells = Cells(kernel, touching.ravel())
    if cells.size == 0:
        return np.zeros((c, c))
    if cells.size == n and not kernel.moves_mean:
        return np.diag(np.full(c, np.inf))
    system = CellSystem(kernel, cells)
    s = [np.zeros((c, cells.size), dtype=np.float64) for _ in range(c)]  # one a load direction
    moved = list(s)
    worst = np.inf
    for turn in range(PASSES):
        for k in range(c):
            right, size = _uneven(moved[k])
            totals = np.zeros(c)
            totals[k] = n if turn == 0 else 0.0
            step = constrained_gradients(system, right, totals / size, reduction=3e-3, limit=60)
            s[k] = s[k] + size * np.astype(step, np.float64)
            # single precision leaves the totals off by 1e-7: restore them
            missing = (n * np.eye(c)[k]) - np.sum(s[k], axis=1)
            s[k] += missing[:, None] / cells.size
            moved[k] = cells.product(s[k], kernel.symbol)
        compliance = np.array([[float(np.sum(s[k] * moved[l])) for l in range(c)] for k in range(c)])
        worst = max(system.energy(*_uneven(moved[k])) / compliance[k, k] for k in range(c))
        if MARGIN * worst <= ENOUGH:
            return np.asarray(np.linalg.inv((compliance + compliance.T) / (2 * n)))
    raise NotConverged(
        f"tangent stiffness: the compliance may still be wrong by {MARGIN * worst:.1e} of itself after {PASSES} passes"
    )


def _uneven(moved: AnyArray) -> tuple[AnyArray, float]:
    """What keeps the points from moving as one, over its largest entry, in single precision; and that entry."""
    r = np.mean(moved, axis=1, keepdims=True) - moved
    size = float(np.max(np.abs(r))) or 1.0
    return np.astype(r / size, np.float32), size
