"""Peaks of a spectrum that belong to tool marks, not to the random part of the surface."""

import numpy as np

from faying.surface.heights import AreaHeights
from faying.typing import Array, Mask

THRESHOLD = 40.0  # a coefficient this many times its surroundings' mean; chance reaches 20 now and then
REACH = 5  # surroundings: coefficients up to this many steps away each way
MAX_CANDIDATES = 20000  # more candidates than this are an uneven spectrum, not lines
LARGEST = 0.25  # share of the rings of frequency that tool marks may rule


def find_lines(scan: AreaHeights, power: Array, frequency: Array) -> Mask:
    """Mark the coefficients of a periodogram (half-plane, as from `spectrum.periodogram`) that lie on sharp peaks.

    The periodogram is divided by the median over each ring of frequency; a coefficient is on a peak where it is 40
    times the mean of its 11 x 11 surroundings (their median over ln 2), so that an uneven spectrum over directions,
    such as a random lay, is left alone. Neighbours within the window's main lobe are marked too.
    Where peaks hold most of the power in more than a quarter of the rings (six an octave) of the usable band, nothing
    is marked: there the lines are the surface (a Weierstrass-Mandelbrot series, a regular texture).
    """
    from scipy.ndimage import median

    lowest = 1 / min(scan.size)
    ring = np.log2(np.maximum(frequency / lowest, 0.5)) * 6
    index = (ring - ring.min()).astype(np.int32).ravel()
    rings, here = np.unique(index, return_inverse=True)
    level = np.maximum(median(power.ravel(), index, rings) / np.log(2), 1e-300)
    white = power / level[here].reshape(power.shape)
    rows, columns = np.nonzero((white > THRESHOLD) & (frequency > 2 * lowest) & (frequency < 0.45 / max(scan.spacing)))
    marked = np.zeros(power.shape, bool)
    if not 0 < len(rows) <= MAX_CANDIDATES:
        return marked
    offset = np.arange(-REACH, REACH + 1)
    near_rows = (rows[:, None] + offset) % power.shape[0]
    near_columns = np.abs(columns[:, None] + offset)
    near_columns = np.minimum(near_columns, 2 * (power.shape[1] - 1) - near_columns)
    around = np.median(white[near_rows[:, :, None], near_columns[:, None, :]].reshape(len(rows), -1), axis=1)
    peak = white[rows, columns] > THRESHOLD * around / np.log(2)
    for dy in range(-2, 3):
        for dx in range(-2, 3):
            column = np.abs(columns[peak] + dx)
            marked[(rows[peak] + dy) % power.shape[0], np.minimum(column, power.shape[1] - 1)] = True
    inner = (frequency > 6 * lowest) & (frequency < 0.25 / max(scan.spacing))
    rings = index.reshape(power.shape)[inner]
    total = np.bincount(rings, power[inner])
    in_peaks = np.bincount(rings, np.where(marked, power, 0.0)[inner], len(total))
    filled = total > 0
    if filled.any() and np.mean(in_peaks[filled] > 0.5 * total[filled]) > LARGEST:
        marked[:] = False
    return marked
