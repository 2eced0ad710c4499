"""Which mode is which after a change: the one whose shape it keeps.

Shapes are compared by their products in the mass, of which those of one set with each other are 0. Modes whose
frequencies are twins span a plane in which any two directions serve: each counts with all that lies in the plane.
"""

from typing import Any

import numpy as np

from faying.numerics.product import product
from faying.typing import Array, Index, Mask

TWINS = 1e-3  # relative distance of frequencies below which shapes mix by errors that no frequency shows
LIKE = 0.5  # squared product from which two shapes are one mode: no other mode can have as much of it


def partners(alike: Array, least: float = 0.0) -> Index:
    """For each row of a table of MAC (m, k) its column, each once, so that the sum is greatest: (m,).

    -1 where there is none, or where the MAC is below the least.
    """
    from scipy.optimize import linear_sum_assignment

    rows, columns = linear_sum_assignment(alike, maximize=True)
    out = np.full(len(alike), -1, dtype=np.int64)
    out[rows] = np.where(alike[rows, columns] >= least, columns, -1)
    return out


def same_group(frequencies: Array) -> Mask:
    """Whether two modes are one of them or twins (..., m, m), by their frequencies (..., m) in any order."""
    order = np.argsort(frequencies, axis=-1, kind="stable")
    rising = np.take_along_axis(frequencies, order, axis=-1)
    apart = np.diff(rising, prepend=rising[..., :1]) > TWINS * rising
    group = np.take_along_axis(np.cumsum(apart, axis=-1), np.argsort(order, axis=-1), axis=-1)
    return np.asarray(group[..., :, None] == group[..., None, :])


def between_by_rank(values: Array, least: Array, most: Array) -> Array:
    """Frequencies (..., m) of modes in any order between the least and the most (..., m), which are sorted as well.

    A stiffer joint raises the lowest frequency, the second lowest, and so on: not that of a mode that others pass.
    """
    order = np.argsort(values, axis=-1)
    ranked = np.clip(np.take_along_axis(values, order, axis=-1), np.sort(least), np.sort(most))
    return np.take_along_axis(ranked, np.argsort(order, axis=-1), axis=-1)


def may_cross(before: Array, after: Array) -> bool:
    """Whether modes may have changed places while frequencies (m,) went to others (m,), both in rising order.

    Where the stiffness only grows or only falls on the way, so does each frequency of the order, and no two meet whose
    ranges are apart. Of other changes nothing can be said.
    """
    low, high = np.minimum(before, after), np.maximum(before, after)
    return bool(np.any(low[1:] <= high[:-1] * (1 + TWINS)))


def follow(before: Any, after: Any, mass: Any, frequencies: Array) -> Index:
    """Return the index (m,) after a change of each mode before it.

    Args:
        before, after: Shapes (d, m) and (d, m), complex or real.
        mass: Of the structure (d, d), or in the basis of the shapes.
        frequencies: Before, in any order (m,) [Hz], by which twins are told.

    Returns:
        Of a mode whose shape none has any more, as where it left the range that was looked at: the next one left, in
        the order of frequencies. Twins are in the order of their frequencies.
    """
    moved = product(mass, after)
    sizes = np.sqrt(np.outer(_squares(before, product(mass, before)), _squares(after, moved)))
    alike = np.abs(before.conj().T @ moved / sizes) ** 2
    groups = same_group(frequencies)
    alike = groups @ alike
    out = partners(alike, LIKE)
    out[out < 0] = np.setdiff1d(np.arange(alike.shape[1]), out)[: np.count_nonzero(out < 0)]
    # twins keep their order: any directions in their plane serve, so that shapes do not tell which is which
    for group in np.unique(groups, axis=0):
        out[group] = np.sort(out[group])
    return out


def _squares(shapes: Any, momenta: Any) -> Array:
    return np.asarray(np.einsum("dm,dm->m", shapes.conj(), momenta).real)
