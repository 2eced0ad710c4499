"""Where the arrays of a half-space solution live: one code for NumPy, CuPy and any library of the array API standard.

The standard (data-apis.org/array-api, 2024.12) has no work in place on parts that fit into the cache and no number of
threads. Both matter for NumPy and for nothing else, so `ArrayLibrary` alone knows of them.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, final

import numpy as np

from faying.errors import InputError, shown
from faying.typing import AnyArray, Array

PART = 1 << 17  # values of a part: 1 MB in double precision, within the second cache
STRIP = 64  # columns that are stored together, at least
Precision = Literal["double", "single"]
Device = Literal["cpu", "gpu"]


def namespace(a: AnyArray) -> Any:
    """Module with the functions for an array."""
    if isinstance(a, np.ndarray):
        return np
    if type(a).__module__.partition(".")[0] == "cupy":  # CuPy 14 has the functions, but its arrays do not say so
        import cupy

        return cupy
    return a.__array_namespace__()


def parts(a: AnyArray) -> list[slice]:
    """Slices that cover a flat array: small ones for NumPy, one for others."""
    step = PART if isinstance(a, np.ndarray) else max(int(a.shape[0]), 1)
    return [slice(k, min(k + step, a.shape[0])) for k in range(0, a.shape[0], step)]


def total(a: AnyArray) -> float:
    """Sum of an array, added up in double precision."""
    xp = namespace(a)
    return float(xp.sum(a, dtype=xp.float64))


def dot(a: AnyArray, b: AnyArray) -> float:
    """Scalar product of two flat arrays, added up in double precision."""
    return sum(total(a[s] * b[s]) for s in parts(a))


def add_times(out: AnyArray, factor: float, rows: AnyArray) -> None:
    """Add factor times some rows (c, n) to others of the same shape."""
    for k in range(out.shape[0]):
        for s in parts(out[k, :]):
            out[k, s] += factor * rows[k, s]


def at_places(a: AnyArray, places: list[int]) -> list[float]:
    """The values that stand at some places of a flat array in order."""
    if isinstance(a, np.ndarray):
        return [float(value) for value in np.partition(a, places)[places]]  # a fifth of the time of sorting
    ordered = namespace(a).sort(a)
    return [float(ordered[place]) for place in places]


def deviation(a: AnyArray) -> float:
    """Standard deviation of a flat array, in double precision."""
    mean, size = total(a) / a.shape[0], a.shape[0]
    xp = namespace(a)
    off = (xp.astype(a[s], xp.float64) - mean for s in parts(a))
    return float(np.sqrt(sum(total(d * d) for d in off) / size))


@final
@dataclass(frozen=True, eq=False)
class ArrayLibrary:
    """A library of arrays, and the precision in which a solution is kept there.

    xp: its module. precision: of pressures and gaps; search directions are in single precision in any case. workers:
    threads of SciPy's transforms.
    """

    xp: Any = np
    precision: Precision = "double"
    workers: int | None = None

    @property
    def host(self) -> bool:
        """Whether the arrays are NumPy's."""
        return self.xp is np

    @cached_property
    def real(self) -> Any:
        """Type of pressures and gaps."""
        return self.xp.float64 if self.precision == "double" else self.xp.float32

    def send(self, a: Any, dtype: Any = None) -> AnyArray:
        """Bring an array here, without a copy where it is here already."""
        return self.xp.asarray(a, dtype=dtype)

    def fetch(self, a: AnyArray) -> Array:
        """Bring an array to NumPy."""
        return np.asarray(self.xp.asnumpy(a) if hasattr(self.xp, "asnumpy") else a)

    def rows(self, shape: tuple[int, int]) -> list[slice]:
        """Blocks of rows of a map."""
        step = max(1, PART * (self.workers or 1) // shape[1]) if self.host else shape[0]
        return [slice(k, min(k + step, shape[0])) for k in range(0, shape[0], step)]

    def strips(self, columns: int) -> tuple[int, int]:
        """In how many strips of how many columns a spectrum is stored."""
        width = -(-columns // max(1, columns // STRIP)) if self.host else columns
        return -(-columns // width), width

    def batches(self, shape: tuple[int, ...]) -> list[slice]:
        """Strips that are transformed together, of a spectrum (strips, rows, width)."""
        count, rows, width = shape
        step = max(1, PART // 2 // (rows * width)) * (self.workers or 1) if self.host else count
        return [slice(k, min(k + step, count)) for k in range(0, count, step)]

    def along_rows(self, x: AnyArray, length: int) -> AnyArray:
        """Transform real rows, filled up with zeros to `length`."""
        if self.host:
            from scipy.fft import rfft

            return rfft(x, n=length, axis=1, workers=self.workers)
        return self.xp.fft.rfft(x, n=length, axis=1)

    def back_along_rows(self, spectrum: AnyArray, length: int) -> AnyArray:
        """Take a transform along rows back."""
        if self.host:
            from scipy.fft import irfft

            return irfft(spectrum, n=length, axis=1, workers=self.workers)
        return self.xp.fft.irfft(spectrum, n=length, axis=1)

    def along_columns(self, spectrum: AnyArray, *, back: bool = False) -> None:
        """Transform the columns of strips (strips, rows, width) in place, or take that back."""
        if self.host:
            from scipy.fft import fft, ifft

            done = (ifft if back else fft)(spectrum, axis=1, overwrite_x=True, workers=self.workers)
            if not np.may_share_memory(done, spectrum):
                spectrum[...] = done
        else:
            spectrum[...] = (self.xp.fft.ifft if back else self.xp.fft.fft)(spectrum, axis=1)

    def sums_between(self, values: AnyArray, offsets: AnyArray) -> AnyArray:
        """Sums of flat values from each offset to the next."""
        if self.host:
            out = np.zeros(len(offsets) - 1)
            some = offsets[:-1] < offsets[1:]
            if some.any():
                out[some] = np.add.reduceat(values, offsets[:-1][some], dtype=np.float64)
            return out
        running = self.xp.cumulative_sum(values, dtype=self.xp.float64, include_initial=True)
        ends = self.xp.take(running, offsets)
        return ends[1:] - ends[:-1]

    def rows_between(self, rows: AnyArray, edges: AnyArray) -> AnyArray:
        """Sums of rows from each edge to the next; none are the same."""
        if self.host:
            return np.add.reduceat(rows, edges[:-1], axis=0)
        ends = self.xp.take(self.xp.cumulative_sum(rows, axis=0, include_initial=True), edges, axis=0)
        return ends[1:, :] - ends[:-1, :]

    def convolve(self, field: AnyArray, symbol: AnyArray) -> AnyArray:
        """Product of a small field with a symbol in Fourier space."""
        if self.host:
            from scipy.fft import irfft2, rfft2

            return irfft2(rfft2(field) * symbol, s=field.shape)
        return self.xp.fft.irfftn(self.xp.fft.rfftn(field) * symbol, s=field.shape, axes=(0, 1))


def place_for(heights: Any, device: Device | None, precision: Precision, workers: int | None) -> ArrayLibrary:
    """Place of a solution: the device asked for, else where the heights are. Raises InputError where it is missing."""
    if not isinstance(precision, str) or precision not in ("double", "single"):
        raise InputError(f'precision = {shown(precision)}; it must be "double" or "single"')
    if not isinstance(device, str | None) or device not in (None, "cpu", "gpu"):
        raise InputError(f'device = {shown(device)}; it must be "cpu", "gpu" or None (where the heights are)')
    if device == "gpu":
        return ArrayLibrary(_cupy(), precision, workers)
    if device == "cpu" or not hasattr(heights, "__array_namespace__"):
        return ArrayLibrary(np, precision, workers)
    return ArrayLibrary(namespace(heights), precision, workers)


def _cupy() -> Any:
    remedy = "pip install 'faying[gpu]' for CUDA 12, or solve on the CPU (device=\"cpu\")"
    try:
        import cupy
    except ImportError as error:
        raise InputError(f'device = "gpu" needs CuPy, which is not installed: {remedy}') from error
    if not cupy.cuda.is_available():
        raise InputError('device = "gpu": CuPy finds no graphics card or no driver for it; solve on the CPU instead')
    return cupy
