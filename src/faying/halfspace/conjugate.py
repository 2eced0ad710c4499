"""Linear problems on a set of cells: preconditioned conjugate gradients in single precision with given totals."""

import numpy as np
from numpy.typing import NDArray

from faying.halfspace.kernels import Kernel, Single
from faying.typing import Array


class _System:
    """The operator on some cells, and its preconditioner kept clear of the constrained totals."""

    def __init__(self, kernel: Kernel, index: NDArray[np.intp], components: int) -> None:
        self.kernel, self.index = kernel, index
        self.plane = np.zeros((components, kernel.shape[0] * kernel.shape[1]), np.float32)
        self.used = 0
        # the constraint's share of the preconditioned space: columns M e_k and their Gram matrix
        self.columns = []
        for k in range(components):
            unit = np.zeros((components, index.size), np.float32)
            unit[k] = 1.0
            self.columns.append(self.on_cells(unit, inverse=True))
        self.gram = np.array([[c[k].sum(dtype=float) for c in self.columns] for k in range(components)])

    def on_cells(self, v: Single, *, inverse: bool) -> Single:
        """Apply the operator, or its preconditioner, to values on the cells."""
        self.used += 1
        self.plane[:, self.index] = v
        field = self.plane.reshape(len(v), *self.kernel.shape)
        out = self.kernel.precondition(field) if inverse else self.kernel.apply_single(field)
        return np.asarray(out.reshape(len(v), -1)[:, self.index])

    def with_totals(self, totals: Array) -> Single:
        """Combination of the columns that has these totals."""
        out = np.zeros((len(totals), self.index.size), np.float32)
        for weight, column in zip(np.linalg.solve(self.gram, totals), self.columns, strict=True):
            out += np.float32(weight) * column
        return out

    def preconditioned(self, r: Single) -> Single:
        """M r less its totals."""
        z = self.on_cells(r, inverse=True)
        for weight, column in zip(np.linalg.solve(self.gram, z.sum(axis=1, dtype=float)), self.columns, strict=True):
            z -= np.float32(weight) * column
        return z


def constrained_gradients(
    kernel: Kernel, index: NDArray[np.intp], residual: Single, totals: Array, *, reduction: float, limit: int
) -> tuple[Single, int]:
    """Solve A s = residual on the cells `index`, up to one constant per component, where s has given totals.

    residual and s of shape (c, cells), totals (c,). Stops when the preconditioned residual has fallen by `reduction`
    or after `limit` iterations. Returns s and the number of operator applications. A bad solve does no harm: callers
    measure what they get.
    """
    system = _System(kernel, index, len(residual))
    s = np.zeros(residual.shape, np.float32)
    r = residual.copy()
    if np.any(totals != 0):
        s = system.with_totals(totals)
        r -= system.on_cells(s, inverse=False)
    z = system.preconditioned(r)
    rz = first = float(np.vdot(r, z))
    t = z
    for _ in range(limit):
        if rz <= 0:
            break
        q = system.on_cells(t, inverse=False)
        curvature = float(np.vdot(t, q))
        if curvature <= 0:
            break
        along = np.float32(rz / curvature)
        s += along * t
        r -= along * q
        z = system.preconditioned(r)
        new = float(np.vdot(r, z))
        if new < reduction**2 * first:
            break
        t = z + np.float32(new / rz) * t
        rz = new
    return s, system.used
