"""Surface displacement of a half-space under surface traction, as a product in Fourier space.

All lengths in units of the column spacing and all stresses in units of E*: the solvers work on numbers near 1, so
that single precision serves where only a search direction is wanted.
"""

from dataclasses import dataclass
from math import pi
from typing import final

import numpy as np
from numpy.typing import NDArray

from faying.typing import Array

Single = NDArray[np.float32]


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Kernel:
    """A symmetric operator traction -> displacement with c components, diagonal or full in the components.

    shape (ny, nx) of the map; padded (my, mx), the size of its transforms: equal to shape for a periodic surface, at
    least twice it less one for a free one. symbol[i, j] of shape (c, c, my, mx // 2 + 1), real; inverse likewise, a
    positive operator near the inverse of `symbol`, for preconditioning.
    """

    shape: tuple[int, int]
    padded: tuple[int, int]
    symbol: Array
    symbol_single: Single
    inverse: Single
    workers: int | None = None

    @property
    def components(self) -> int:
        """Number of traction components, 1 or 2."""
        return int(self.symbol.shape[0])

    @property
    def own(self) -> float:
        """Displacement of a cell under unit traction on itself: the operator's diagonal (first component)."""
        last = self.padded[1] // 2 + 1 if self.padded[1] % 2 else self.padded[1] // 2
        s = self.symbol[0, 0]
        return float((s.sum() + s[:, 1:last].sum()) / (self.padded[0] * self.padded[1]))

    def apply(self, traction: Array) -> Array:
        """Displacement under traction, shape (c, ny, nx), double precision."""
        return np.asarray(self._filter(traction, self.symbol))

    def apply_single(self, traction: Single) -> Single:
        """The same in single precision."""
        return np.asarray(self._filter(traction, self.symbol_single))

    def precondition(self, residual: Single) -> Single:
        """Near-inverse of `apply`, single precision."""
        return np.asarray(self._filter(residual, self.inverse))

    def _filter(self, x: NDArray[np.floating], symbol: NDArray[np.floating]) -> NDArray[np.floating]:
        from scipy.fft import irfft2, rfft2

        spectrum = rfft2(x, s=self.padded, workers=self.workers)
        if self.components == 1:
            spectrum *= symbol[0]
        else:
            first = spectrum[0] * symbol[0, 0] + spectrum[1] * symbol[0, 1]
            spectrum[1] *= symbol[1, 1]
            spectrum[1] += spectrum[0] * symbol[1, 0]
            spectrum[0] = first
        out = irfft2(spectrum, s=self.padded, workers=self.workers, overwrite_x=True)
        cut: NDArray[np.floating] = out[:, : self.shape[0], : self.shape[1]]
        return cut


def transform_shape(shape: tuple[int, int], *, periodic: bool) -> tuple[int, int]:
    """Size of the transforms: that of the map if periodic, else the next quick size that keeps images apart."""
    if periodic:
        return shape
    from scipy.fft import next_fast_len

    return next_fast_len(2 * shape[0] - 1), next_fast_len(2 * shape[1] - 1, real=True)


def wave_numbers(padded: tuple[int, int], aspect: float) -> tuple[Array, Array, Array]:
    """q_x (row), q_y (column) and |q| for spacings 1 along x and `aspect` along y; |q| = 1 stands at q = 0."""
    qy: Array = 2 * pi * np.fft.fftfreq(padded[0], aspect)[:, None].astype(np.float64)
    qx: Array = 2 * pi * np.fft.rfftfreq(padded[1])[None, :].astype(np.float64)
    q: Array = np.hypot(qy, qx)
    q[0, 0] = 1.0
    return qx, qy, q


def normal_kernel(shape: tuple[int, int], aspect: float, *, periodic: bool, workers: int | None = None) -> Kernel:
    """Normal displacement under pressure, units of E* and of the column spacing.

    Periodic: u = 2 p/(E* |q|), the mean displacement left out (Johnson 1985, 13.2; Stanley and Kato 1997,
    doi:10.1115/1.2833523, eq. 5). Free: Love's displacement of a uniformly loaded rectangle (Johnson 1985, eq. 3.25).
    """
    padded = transform_shape(shape, periodic=periodic)
    q = wave_numbers(padded, aspect)[2]
    symbol = 2 / q if periodic else _love(padded, aspect)
    if periodic:
        symbol[0, 0] = 0.0
    return _assembled(shape, padded, symbol[None, None], _inverse(q)[None, None], workers)


def shear_kernel(
    shape: tuple[int, int],
    aspect: float,
    nu: float,
    *,
    periodic: bool,
    vector: bool = True,
    workers: int | None = None,
) -> Kernel:
    """Tangential displacement (u_x, u_y) under traction (t_x, t_y), units of E* and of the column spacing.

    Symbol (1/(G |q|)) (delta_ij - nu q_i q_j/q^2) with G = E* (1 - nu)/2, or for a free surface Cerruti's
    displacement of a uniformly loaded rectangle (Johnson 1985, eqs. 3.75). With vector=False, only u_x under t_x.
    """
    padded = transform_shape(shape, periodic=periodic)
    qx, qy, q = wave_numbers(padded, aspect)
    G = (1 - nu) / 2
    along = {"xx": qx * qx, "xy": qx * qy, "yy": qy * qy}
    if periodic:
        parts = {k: ((k != "xy") - nu * v / q**2) / (G * q) for k, v in along.items()}
        for part in parts.values():
            part[0, 0] = 0.0
    else:
        parts = _cerruti(padded, aspect, nu, G)
    for axis, length in ((0, padded[0]), (1, padded[1])):
        # at the highest wave number q and -q are one point: an odd product has no real-valued counterpart there
        if periodic and length % 2 == 0:
            parts["xy"][(length // 2, slice(None)) if axis == 0 else (slice(None), length // 2)] = 0.0
    base = 2 * G * _inverse(q)
    inverse = {k: base * ((k != "xy") + nu / (1 - nu) * v / q**2) for k, v in along.items()}
    if not vector:
        return _assembled(shape, padded, parts["xx"][None, None], base[None, None], workers)
    full = [np.array([[d["xx"], d["xy"]], [d["xy"], d["yy"]]]) for d in (parts, inverse)]
    return _assembled(shape, padded, full[0], full[1], workers)


def _assembled(
    shape: tuple[int, int], padded: tuple[int, int], symbol: Array, inverse: Array, workers: int | None
) -> Kernel:
    return Kernel(
        shape=shape,
        padded=padded,
        symbol=symbol,
        symbol_single=symbol.astype(np.float32),
        inverse=inverse.astype(np.float32),
        workers=workers,
    )


def _inverse(q: Array) -> Array:
    """E* |q|/2, with half the least wave number in place of 0 so that the mean is not lost."""
    out = q / 2
    out[0, 0] = min(q[0, 1] if q.shape[1] > 1 else 1.0, q[1, 0] if q.shape[0] > 1 else 1.0) / 4
    return out


def _lags(padded: tuple[int, int], aspect: float) -> tuple[Array, Array]:
    """Signed distances of the cells of a padded map from its first cell, x as a row and y as a column."""
    x: Array = np.fft.fftfreq(padded[1], 1 / padded[1])[None, :].astype(np.float64)
    y: Array = np.fft.fftfreq(padded[0], 1 / padded[0])[:, None].astype(np.float64) * aspect
    return x, y


def _rectangle(padded: tuple[int, int], aspect: float) -> dict[str, Array]:
    """Integrals over a cell of x^2/r^3, y^2/r^3 and x y/r^3 seen from every other cell."""
    names = ("xx", "yy", "xy")
    total = {name: np.zeros(padded) for name in names}
    x, y = _lags(padded, aspect)
    for sx, sy in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        X, Y, sign = x + sx / 2, y + sy * aspect / 2, sx * sy
        r = np.hypot(X, Y)
        # d2/dxdy of y ln(x + r), x ln(y + r) and -r; asinh keeps ln(x + r) exact where x is near -r
        total["xx"] += sign * Y * np.arcsinh(X / np.abs(Y))
        total["yy"] += sign * X * np.arcsinh(Y / np.abs(X))
        total["xy"] -= sign * r
    return total


def _love(padded: tuple[int, int], aspect: float) -> Array:
    from scipy.fft import rfft2

    cell = _rectangle(padded, aspect)
    return np.asarray(rfft2((cell["xx"] + cell["yy"]) / pi).real)


def _cerruti(padded: tuple[int, int], aspect: float, nu: float, G: float) -> dict[str, Array]:
    from scipy.fft import rfft2

    cell = _rectangle(padded, aspect)
    both = cell["xx"] + cell["yy"]
    cross = cell["xy"]
    # the lag of exactly half an even padded size is never used: keep the odd kernel odd there
    if padded[0] % 2 == 0:
        cross[padded[0] // 2, :] = 0.0
    if padded[1] % 2 == 0:
        cross[:, padded[1] // 2] = 0.0
    tables = {"xx": (1 - nu) * both + nu * cell["xx"], "yy": (1 - nu) * both + nu * cell["yy"], "xy": nu * cross}
    return {k: np.asarray(rfft2(v / (2 * pi * G)).real) for k, v in tables.items()}
