"""The factor of one part: what lies inside is eliminated, what others touch is left as a dense matrix."""

import ctypes
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import NotConverged
from faying.numerics.pardiso import FORGET, Pardiso, handle
from faying.typing import Array, Index

FORWARD, BACKWARD = 331, 333


class CondensedPart(Pardiso):
    """A factor of the inside of a part by PARDISO, with the Schur complement on its touched unknowns.

    Args:
        matrix: makes that of the part, symmetric positive definite CSR (n, n).
        size: n.
        touched: unknowns (t,) that are not eliminated.
        single: whether in single precision.

    Raises:
        NotConverged: the matrix is singular.
        InputError: memory is short.
    """

    def __init__(self, matrix: Callable[[], Any], size: int, touched: Index, *, single: bool) -> None:
        self._touched = touched
        self._stored: Path | None = None
        self._none, self._all = len(touched) == 0, len(touched) == size
        if self._all:  # nothing lies inside
            self.schur = matrix().toarray()
            self.memory = float(self.schur.nbytes)
            return
        if self._none:
            super().__init__(matrix, single=single)
            return
        super().__init__(matrix, single=single, not_eliminated=touched)
        self._values = np.zeros(0, dtype=self._type)  # the factor has taken what it needs

    def forward(self, right: Array) -> Array:
        """Half of a solution (n, k) of right-hand sides (n, k): the touched rows hold what is left there."""
        if self._none or self._all:
            return np.array(right)
        return self._half(FORWARD, right)

    def backward(self, half: Array, touched: Array) -> Array:
        """The solution (n, k) from what `forward` gave and the solution (t, k) on the touched unknowns."""
        half[self._touched] = touched
        if self._all:
            return half
        if self._none:
            return self.solve(half)
        return self._half(BACKWARD, half)

    def _half(self, phase: int, right: Array) -> Array:
        b = np.asfortranarray(right, dtype=self._type)
        x = np.zeros_like(b, order="F")
        self._call(phase, b, x)
        return x

    def store(self, folder: Path) -> None:
        """Move the factor from memory to a folder of its own, until `restore`."""
        if self._all:
            return
        if self._stored is None:
            folder.mkdir(parents=True)
            self._moved("store", folder)
            self._stored = folder
        self._call(FORGET)

    def restore(self) -> None:
        """Fetch the factor back; its copy on the disk stays, so that it need not be written again."""
        if self._all:
            return
        self._state[:] = 0
        assert self._stored is not None
        self._moved("restore", self._stored)

    def _moved(self, way: str, folder: Path) -> None:
        fault = ctypes.c_int32(0)
        handle(way)(self._state.ctypes.data_as(ctypes.c_void_p), str(folder).encode(), ctypes.byref(fault))
        if fault.value:
            raise NotConverged(
                f"PARDISO could not {way} the factor of a part in {folder} (its error {fault.value}); "
                "is the disk full? TMPDIR names another place"
            )
