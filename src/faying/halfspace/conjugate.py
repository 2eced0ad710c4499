"""Linear problems on a set of cells: preconditioned conjugate gradients in single precision with given totals.

The preconditioner has two levels. On the cells the product M with |q|, cut to them, is near the inverse for what is
shorter than the distance between contact spots. Longer waves it takes for far too soft: to move a spot as a whole
costs much at its rim, to move a smooth field costs little. The operator is taken for the sum of both compliances,

    A = M^-1 + Z E^-1 Z',       E^-1 = 2/q - 2/q_c    (waves longer than a coarse block, periodic)

with Z the fields that are constant on coarse blocks. By Woodbury's identity, and with M Z = C Z where C = diag(M 1),

    A^-1 = (1 - Q') M (1 - Q) + C Z K E K Z' C,       Q = Z K Z' C,   K = (E + Z'C Z)^-1,

which is symmetric and positive whatever C is, takes one product with M, and gives tractions of total 0 since E leaves
out the mean. K is solved on the coarse blocks by conjugate gradients.
"""

from typing import final

import numpy as np

from faying.halfspace.arrays import dot, total
from faying.halfspace.cells import Blocks, Cells
from faying.halfspace.kernels import Kernel
from faying.typing import AnyArray, Array

CUTOFF = 1.5  # wave number at which E^-1 ends, over the highest one of the coarse blocks
FLOOR = 1e-3  # what is left of E^-1 there, over what was taken off
COARSE = 1e-3  # reduction of the residual of K
TURNS = 40
DENSE = 200  # blocks up to which K is made as a matrix
GROWTH = 1e4  # of the residual squared, beyond which only rounding is left of it


@final
class _Coarse:
    """The smooth part of one component: K, E and Z for given stiffnesses c of the cells."""

    def __init__(self, kernel: Kernel, blocks: Blocks, c: AnyArray) -> None:
        self.blocks, self.c = blocks, c
        shape = blocks.shape
        self.stiffness = np.maximum(blocks.sums(c), 0.0)
        self.whole = float(np.sum(self.stiffness))
        self.mean = self.whole / (shape[0] * shape[1])
        self.E = _symbol(kernel, shape)
        self.near_inverse = 1 / (self.E + self.mean)
        self.inverse: AnyArray | None = None
        if shape[0] * shape[1] <= DENSE:
            self.inverse = np.linalg.inv(_circulant(self.E, shape) + np.diag(self.stiffness.ravel()))

    def solve(self, right: AnyArray) -> AnyArray:
        """K times a field of the blocks, its mean exact."""
        if self.inverse is not None:
            y = (self.inverse @ right.ravel()).reshape(right.shape)
        else:
            y = self._iterated(right)
        return y + float(np.sum(right) - np.sum(self.stiffness * y)) / self.whole

    def _iterated(self, right: AnyArray) -> AnyArray:
        y, r = 0.0 * right, right
        z = _convolve(r, self.near_inverse)
        t, Et = z, r - self.mean * z  # z = (E + mean)^-1 r, so that E z needs no transform
        rz = first = float(np.sum(r * z))
        for _ in range(TURNS):
            if rz <= COARSE**2 * first or rz <= 0:
                break
            q = Et + self.stiffness * t
            along = rz / float(np.sum(t * q))
            y = y + along * t
            r = r - along * q
            z = _convolve(r, self.near_inverse)
            new = float(np.sum(r * z))
            t, Et = z + (new / rz) * t, r - self.mean * z + (new / rz) * Et
            rz = new
        return y


def _symbol(kernel: Kernel, shape: tuple[int, int]) -> Array:
    """Symbol of E, from displacements of blocks to their sums of traction; lengths in columns of the map."""
    side = [n / m for n, m in zip(kernel.shape, shape, strict=True)]
    qy = 2 * np.pi * np.fft.fftfreq(shape[0], side[0] * kernel.aspect)[:, None]
    qx = 2 * np.pi * np.fft.rfftfreq(shape[1], side[1])[None, :]
    q = np.hypot(qy, qx)
    q[0, 0] = 1.0
    cut = CUTOFF * np.pi / min(side[0] * kernel.aspect, side[1])
    E: Array = side[0] * side[1] / (kernel.strength * np.maximum(1 / q - 1 / cut, FLOOR / cut))
    E[0, 0] = 0.0
    return E


def _circulant(symbol: Array, shape: tuple[int, int]) -> Array:
    """The matrix of a symbol on a small field."""
    first = np.fft.irfft2(symbol, s=shape)
    y, x = (a.ravel() for a in np.indices(shape))
    return np.asarray(first[y[:, None] - y[None, :], x[:, None] - x[None, :]])


def _convolve(field: AnyArray, symbol: Array) -> AnyArray:
    """Product of a small field with a symbol in Fourier space."""
    return np.fft.irfft2(np.fft.rfft2(field) * symbol, s=field.shape)


@final
class CellSystem:
    """The operator on some cells, and its preconditioner, which gives tractions of total 0 in every component.

    used: how many products it has taken.
    """

    def __init__(self, kernel: Kernel, cells: Cells) -> None:
        components = kernel.components
        self.kernel, self.cells = kernel, cells
        self.used = 0
        self.coarse, blocks = [], Blocks(cells)
        for k in range(components):
            unit = np.zeros((components, cells.size), dtype=np.float32)
            unit[k, :] = 1.0
            self.coarse.append(_Coarse(kernel, blocks, self._inverse(unit)[k, :]))

    def apply(self, v: AnyArray) -> AnyArray:
        """The operator times v."""
        self.used += 1
        return self.cells.product(v, self.kernel.symbol_single)

    def _inverse(self, v: AnyArray) -> AnyArray:
        self.used += 1
        return self.cells.product(v, self.kernel.inverse)

    def with_totals(self, totals: Array) -> AnyArray:
        """Tractions that have these totals."""
        return np.stack([float(t) / total(part.c) * part.c for t, part in zip(totals, self.coarse, strict=True)])

    def energy(self, residual: AnyArray, size: float) -> float:
        """About the energy of the error that leaves size times this residual (c, cells)."""
        return size**2 * dot(residual.ravel(), self.preconditioned(residual).ravel())

    def preconditioned(self, r: AnyArray) -> AnyArray:
        """The module's A^-1 times r."""
        smooth = [part.solve(part.blocks.sums(r[k, :], part.c)) for k, part in enumerate(self.coarse)]
        z = r.copy()
        for k, (part, u) in enumerate(zip(self.coarse, smooth, strict=True)):
            part.blocks.take_off(z, k, u)
        z = self._inverse(z)
        for k, (part, u) in enumerate(zip(self.coarse, smooth, strict=True)):
            y = part.solve(part.blocks.sums(z[k, :]) - _convolve(u, part.E))
            part.blocks.take_off(z, k, y, part.c)
        return z


def constrained_gradients(
    system: CellSystem, residual: AnyArray, totals: Array, *, reduction: float, limit: int
) -> AnyArray:
    """Solve A s = residual on the cells of a system, up to one constant per component, where s has given totals.

    residual and s of shape (c, cells), totals (c,). Stops where the last turn has gained less energy than
    reduction^2 of all that was gained, or after `limit` turns. A bad solve does no harm: callers measure what they get.
    """
    s = np.zeros(residual.shape, dtype=np.float32)
    r = residual.copy()
    if np.any(totals != 0):
        s = system.with_totals(totals)
        r -= system.apply(s)
    r -= np.mean(r, axis=1, keepdims=True)
    t = system.preconditioned(r)
    rz = first = dot(r.ravel(), t.ravel())
    gained = 0.0
    for turn in range(limit):
        if rz <= 0:
            break
        q = system.apply(t)
        curvature = dot(t.ravel(), q.ravel())
        if curvature <= 0:
            break
        along = rz / curvature
        s += along * t
        gain = along * rz
        gained += gain
        if gain <= reduction**2 * gained or turn + 1 == limit:
            break  # before another product with the preconditioner
        q *= along
        r -= q
        q = system.preconditioned(r)
        new = dot(r.ravel(), q.ravel())
        if new >= GROWTH * first:
            break
        t *= new / rz
        t += q
        rz = new
    return s
