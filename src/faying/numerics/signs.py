"""A definite sign of mode shapes."""

from typing import TypeVar

import numpy as np

from faying.typing import Array, Complex

Shapes = TypeVar("Shapes", Array, Complex)
TIE = 1e-3  # of the greatest component: those that differ by less are equal, since shapes are known to 1e-4


def definite(shapes: Shapes) -> Shapes:
    """Return shapes (n, m) with the greatest component of each real part positive; of equal ones that of lowest index.

    A mode and its negative are one motion, and which of them an eigensolver finds is chance.
    """
    signs = np.ones(shapes.shape[1])
    for k in range(shapes.shape[1]):  # one at a time: a copy of all may be as large as the shapes themselves
        column = shapes[:, k].real
        size = np.abs(column)
        first = int(np.argmax(size >= (1 - TIE) * size.max(initial=0.0))) if len(size) else 0
        signs[k] = -1.0 if len(size) and column[first] < 0 else 1.0
    return np.asarray(shapes * signs)
