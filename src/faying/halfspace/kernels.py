"""Surface displacement of a half-space under surface traction, as a product in Fourier space.

All lengths in units of the column spacing and all stresses in units of E*: the solvers work on numbers near 1, so
that single precision serves where only a search direction is wanted.

A product goes through its map three times: rows forward, columns forward, times the symbol and back, rows back. Blocks
of rows stay in the cache meanwhile, and nothing but the spectrum is ever stored whole.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import Any, final

import numpy as np
from scipy.fft import dctn, dstn, fft, ifft, irfft, next_fast_len, rfft

from faying.halfspace.arrays import Arithmetic
from faying.typing import AnyArray, Array

DOUBLE = Arithmetic()
Read = Callable[[int, int], AnyArray | None]
Write = Callable[[int, int, AnyArray], None]


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Kernel:
    """A symmetric operator traction -> displacement with c components, diagonal or full in the components.

    shape (ny, nx) of the map; padded (my, mx), the size of its transforms: equal to shape for a periodic surface, at
    least twice it less one for a free one. Tables of shape (c, c, my // 2 + 1, mx // 2 + 1), real, hold a quarter of
    the wave numbers: the diagonal ones are even in q_y, the others odd. symbol, in double precision; inverse, in
    single, a positive operator near the inverse, for preconditioning. aspect: dy/dx. strength: symbol times |q|, of
    long waves.
    """

    shape: tuple[int, int]
    padded: tuple[int, int]
    aspect: float
    symbol: AnyArray
    inverse: AnyArray
    strength: float
    arithmetic: Arithmetic

    @cached_property
    def symbol_single(self) -> AnyArray:
        """The symbol in single precision."""
        return self.symbol.astype(np.float32)

    @property
    def components(self) -> int:
        """Number of traction components, 1 or 2."""
        return int(self.symbol.shape[0])

    @property
    def moves_mean(self) -> bool:
        """Whether a uniform traction displaces anything."""
        return float(self.symbol[0, 0, 0, 0]) != 0

    @property
    def own(self) -> float:
        """Displacement of a cell under unit traction on itself: the operator's diagonal (first component)."""
        # a table holds each wave number once that stands four times among all, twice on its borders
        weight = [np.where(np.isin(np.arange(n // 2 + 1), (0, n / 2)), 1.0, 2.0) for n in self.padded]
        return float(weight[0] @ self.symbol[0, 0] @ weight[1] / (self.padded[0] * self.padded[1]))

    @cached_property
    def rows(self) -> list[slice]:
        """The blocks of rows that `stream` takes and gives."""
        return self.arithmetic.rows((self.shape[0], self.padded[1]))

    def _spectra(self, kind: type) -> list[AnyArray]:
        """One spectrum a component, with any content."""
        my, mx = self.padded
        return [np.empty((my, mx // 2 + 1), dtype=kind) for _ in range(self.components)]

    @cached_property
    def _work(self) -> list[AnyArray]:
        """Spectra of products in single precision, from one to the next: new ones cost 2 to 8 % more time."""
        return self._spectra(np.complex64)

    def apply(self, traction: AnyArray) -> AnyArray:
        """Displacement under traction, shape (c, ny, nx), double precision."""
        out = np.empty(tuple(traction.shape), dtype=np.float64)

        def write(k: int, i: int, block: AnyArray) -> None:
            out[k, self.rows[i], :] = block

        self.stream(self.symbol, lambda k, i: traction[k, self.rows[i], :], write)
        return out

    def stream(self, table: AnyArray, read: Read, write: Write, *, needed: Sequence[bool] | None = None) -> None:
        """Apply a table to a map that comes and goes by blocks of rows, in the table's precision.

        read(component, i) gives the rows `self.rows[i]`, or None where all of them are 0; write(component, i, block)
        takes those of the outcome. needed[i]: whether anybody wants them.
        """
        workers, (my, mx), nx = self.arithmetic.workers, self.padded, self.shape[1]
        spectra = self._spectra(np.complex128) if table.dtype == np.float64 else self._work
        for k, spectrum in enumerate(spectra):
            for i, rows in enumerate(self.rows):
                block = read(k, i)
                spectrum[rows] = 0.0 if block is None else rfft(block, n=mx, axis=1, workers=workers)
            spectrum[self.shape[0] :] = 0.0
            _along_columns(fft, spectrum, workers)
        upper = my // 2 + 1
        mirrored = table[:, :, 1 : my - upper + 1][:, :, ::-1]
        for here, factors, sign in ((slice(0, upper), table, 1.0), (slice(upper, my), mirrored, -1.0)):
            halves = [spectrum[here] for spectrum in spectra]
            for rows in self.arithmetic.rows(halves[0].shape):
                _multiply([half[rows] for half in halves], factors[:, :, rows], sign)
        for k, spectrum in enumerate(spectra):
            _along_columns(ifft, spectrum, workers)
            for i, rows in enumerate(self.rows):
                if needed is None or needed[i]:
                    write(k, i, irfft(spectrum[rows], n=mx, axis=1, workers=workers)[:, :nx])


def _along_columns(transform: Any, spectrum: AnyArray, workers: int | None) -> None:
    """Transform columns in place."""
    done = transform(spectrum, axis=0, overwrite_x=True, workers=workers)
    if not np.may_share_memory(done, spectrum):
        spectrum[...] = done


def _multiply(spectra: list[AnyArray], table: AnyArray, sign: float) -> None:
    """Multiply in place; `sign` goes with what couples two components."""
    if len(spectra) == 1:
        spectra[0][...] *= table[0, 0, ...]
        return
    one, two = spectra
    first = one * table[0, 0, ...] + two * (sign * table[0, 1, ...])
    two[...] = two * table[1, 1, ...] + one * (sign * table[1, 0, ...])
    one[...] = first


def transform_shape(shape: tuple[int, int], *, periodic: bool) -> tuple[int, int]:
    """Size of the transforms: that of the map if periodic, else the next quick even size that keeps images apart."""
    if periodic:
        return shape
    return 2 * next_fast_len(shape[0]), 2 * next_fast_len(shape[1], real=True)


def wave_numbers(padded: tuple[int, int], aspect: float) -> tuple[Array, Array, Array]:
    """q_x (row), q_y (column) and |q|, none negative; spacings 1 along x, `aspect` along y; |q| = 1 stands at q = 0."""
    qy: Array = 2 * pi * np.fft.rfftfreq(padded[0], aspect)[:, None].astype(np.float64)
    qx: Array = 2 * pi * np.fft.rfftfreq(padded[1])[None, :].astype(np.float64)
    q: Array = np.hypot(qy, qx)
    q[0, 0] = 1.0
    return qx, qy, q


def normal_kernel(shape: tuple[int, int], aspect: float, *, periodic: bool, arithmetic: Arithmetic = DOUBLE) -> Kernel:
    """Normal displacement under pressure, units of E* and of the column spacing.

    Periodic: u = 2 p/(E* |q|), the mean displacement left out (Johnson 1985, 13.2; Stanley and Kato 1997,
    doi:10.1115/1.2833523, eq. 5). Free: Love's displacement of a uniformly loaded rectangle (Johnson 1985, eq. 3.25).
    """
    padded = transform_shape(shape, periodic=periodic)
    q = wave_numbers(padded, aspect)[2]
    if periodic:
        symbol = 2 / q
        symbol[0, 0] = 0.0
    else:
        cell = _rectangle(padded, aspect)
        symbol = _even((cell["xx"] + cell["yy"]) / pi)
    return Kernel(
        shape=shape,
        padded=padded,
        aspect=aspect,
        symbol=symbol[None, None],
        inverse=_inverse(q)[None, None].astype(np.float32),
        strength=2.0,
        arithmetic=arithmetic,
    )


def shear_kernel(
    shape: tuple[int, int],
    aspect: float,
    nu: float,
    *,
    periodic: bool,
    vector: bool = True,
    arithmetic: Arithmetic = DOUBLE,
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
        # at the highest wave number q and -q are one point: an odd product has no real-valued counterpart there
        for product, length in zip((parts["xy"], parts["xy"].T), padded, strict=True):
            if length % 2 == 0:
                product[length // 2] = 0.0
    else:
        parts = _cerruti(padded, aspect, nu, G)
    base = 2 * G * _inverse(q)
    symbol, inverse = parts["xx"][None, None], base[None, None]
    if vector:
        near = {k: base * ((k != "xy") + nu / (1 - nu) * v / q**2) for k, v in along.items()}
        symbol, inverse = (np.array([[d["xx"], d["xy"]], [d["xy"], d["yy"]]]) for d in (parts, near))
    return Kernel(
        shape=shape,
        padded=padded,
        aspect=aspect,
        symbol=symbol,
        inverse=inverse.astype(np.float32),
        strength=1 / G,
        arithmetic=arithmetic,
    )


def _inverse(q: Array) -> Array:
    """E* |q|/2, with half the least wave number in place of 0 so that the mean is not lost."""
    out = q / 2
    out[0, 0] = min(q[0, 1] if q.shape[1] > 1 else 1.0, q[1, 0] if q.shape[0] > 1 else 1.0) / 4
    return out


def _rectangle(padded: tuple[int, int], aspect: float) -> dict[str, Array]:
    """Integrals over a cell of x^2/r^3, y^2/r^3 and x y/r^3 seen from the cells up to half a padded map away."""
    x = np.arange(padded[1] // 2 + 1.0)[None, :]
    y = np.arange(padded[0] // 2 + 1.0)[:, None] * aspect
    total = {name: np.zeros((y.size, x.size)) for name in ("xx", "yy", "xy")}
    for sx, sy in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        X, Y, sign = x + sx / 2, y + sy * aspect / 2, sx * sy
        r = np.hypot(X, Y)
        # d2/dxdy of y ln(x + r), x ln(y + r) and -r; asinh keeps ln(x + r) exact where x is near -r
        total["xx"] += sign * Y * np.arcsinh(X / np.abs(Y))
        total["yy"] += sign * X * np.arcsinh(Y / np.abs(X))
        total["xy"] -= sign * r
    return total


def _even(lags: Array) -> Array:
    """Transform of a real map that is even both ways, from a quarter of it to a quarter."""
    return np.asarray(dctn(lags, type=1))


def _odd(lags: Array) -> Array:
    """The same of a map that is odd both ways, 0 at half of its length."""
    out = np.zeros(lags.shape)
    out[1:-1, 1:-1] = -dstn(lags[1:-1, 1:-1], type=1)
    return out


def _cerruti(padded: tuple[int, int], aspect: float, nu: float, G: float) -> dict[str, Array]:
    cell = _rectangle(padded, aspect)
    both = cell["xx"] + cell["yy"]
    scale = 2 * pi * G
    return {
        "xx": _even(((1 - nu) * both + nu * cell["xx"]) / scale),
        "yy": _even(((1 - nu) * both + nu * cell["yy"]) / scale),
        "xy": _odd(nu * cell["xy"] / scale),
    }
