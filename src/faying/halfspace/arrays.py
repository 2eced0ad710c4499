"""Sums of large maps by parts that fit into the cache, and the precision of a solution."""

from dataclasses import dataclass
from typing import Any, Literal, final

import numpy as np

from faying.typing import AnyArray, Array

PART = 1 << 17  # values of a part: 1 MB in double precision, within the second cache
Precision = Literal["double", "single"]


def parts(a: AnyArray) -> list[slice]:
    """Slices that cover a flat array."""
    return [slice(k, min(k + PART, a.shape[0])) for k in range(0, a.shape[0], PART)]


def total(a: AnyArray) -> float:
    """Sum of an array, added up in double precision."""
    return float(np.sum(a, dtype=np.float64))


def dot(a: AnyArray, b: AnyArray) -> float:
    """Scalar product of two flat arrays, added up in double precision."""
    return sum(total(a[s] * b[s]) for s in parts(a))


def deviation(a: AnyArray) -> float:
    """Standard deviation of a flat array, in double precision."""
    mean, size = total(a) / a.shape[0], a.shape[0]
    off = (a[s].astype(np.float64) - mean for s in parts(a))
    return float(np.sqrt(sum(total(d * d) for d in off) / size))


@final
@dataclass(frozen=True)
class Arithmetic:
    """The precision of a solution.

    precision: of pressures and gaps; search directions are in single precision in any case. workers: threads of the
    transforms.
    """

    precision: Precision = "double"
    workers: int | None = None

    @property
    def real(self) -> Any:
        """Type of pressures and gaps."""
        return np.float64 if self.precision == "double" else np.float32

    def rows(self, shape: tuple[int, int]) -> list[slice]:
        """Blocks of rows of a map."""
        step = max(1, PART * (self.workers or 1) // shape[1])
        return [slice(k, min(k + step, shape[0])) for k in range(0, shape[0], step)]


def sums_between(values: AnyArray, offsets: AnyArray) -> Array:
    """Sums of flat values from each offset to the next."""
    out = np.zeros(len(offsets) - 1)
    some = offsets[:-1] < offsets[1:]
    if some.any():
        out[some] = np.add.reduceat(values, offsets[:-1][some], dtype=np.float64)
    return out
