"""Linear problems on a set of cells: preconditioned conjugate gradients in single precision with given totals."""

import numpy as np
from numpy.typing import NDArray

from faying.halfspace.kernels import Kernel, Single
from faying.typing import Array


def constrained_gradients(
    kernel: Kernel, index: NDArray[np.intp], residual: Single, totals: Array, *, reduction: float, limit: int
) -> tuple[Single, int]:
    """Solve A s = residual on the cells `index`, up to one constant per component, where s has given totals.

    residual and s of shape (c, cells), totals (c,). Stops when the preconditioned residual has fallen by `reduction`
    or after `limit` iterations. Returns s and the number of operator applications. A bad solve does no harm: callers
    measure what they get.
    """
    c, cells = residual.shape
    plane = np.zeros((c, kernel.shape[0] * kernel.shape[1]), np.float32)
    used = 0

    def on_cells(v: Single, *, inverse: bool) -> Single:
        nonlocal used
        used += 1
        plane[:, index] = v
        field = plane.reshape(c, *kernel.shape)
        out = kernel.precondition(field) if inverse else kernel.apply_single(field)
        return np.asarray(out.reshape(c, -1)[:, index])

    # the constraint's share of the preconditioned space: columns M e_k and their Gram matrix
    columns = []
    for k in range(c):
        unit = np.zeros((c, cells), np.float32)
        unit[k] = 1.0
        columns.append(on_cells(unit, inverse=True))
    gram = np.array([[column[k].sum(dtype=float) for column in columns] for k in range(c)])

    def preconditioned(r: Single) -> Single:
        z = on_cells(r, inverse=True)
        for weight, column in zip(np.linalg.solve(gram, z.sum(axis=1, dtype=float)), columns, strict=True):
            z -= np.float32(weight) * column
        return z

    s = np.zeros((c, cells), np.float32)
    r = residual.copy()
    if np.any(totals != 0):
        for weight, column in zip(np.linalg.solve(gram, totals), columns, strict=True):
            s += np.float32(weight) * column
        r -= on_cells(s, inverse=False)
    z = preconditioned(r)
    rz = first = float(np.vdot(r, z))
    t = z
    for _ in range(limit):
        if rz <= 0:
            break
        q = on_cells(t, inverse=False)
        curvature = float(np.vdot(t, q))
        if curvature <= 0:
            break
        along = np.float32(rz / curvature)
        s += along * t
        r -= along * q
        z = preconditioned(r)
        new = float(np.vdot(r, z))
        if new < reduction**2 * first:
            break
        t = z + np.float32(new / rz) * t
        rz = new
    return s, used
