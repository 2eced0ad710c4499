"""Measured points of a form that stand alone, far from all their neighbours: a touch in the air, a typing error."""

import numpy as np

from faying.errors import InputError
from faying.typing import Array

NEIGHBOURS = 8
MIN_POINTS = 16  # below which neighbours say nothing of a point
SCATTERS = 20.0  # robust standard deviations of the difference from the neighbours' median
RANGES = 5.0  # times the range of the neighbours
SPANS = 3.0  # times the range of all heights but the outer 5 % on both sides
QUANTA = 20.0  # times the least difference of two heights, the last digit of the instrument


def refuse_lonely(places: Array, heights: Array, name: str) -> None:
    """Raise InputError where single points stand so far off that a flatness, or a gap, would be theirs alone.

    Args:
        places: (n, 2) [m].
        heights: or gaps, (n,) [m]; what is not finite is passed over.
        name: of the file, for the message.
    """
    from scipy.spatial import cKDTree

    good = np.isfinite(heights) & np.isfinite(places).all(axis=1)
    rows = np.flatnonzero(good)
    xy, z = places[good], heights[good]
    if len(z) < MIN_POINTS or np.ptp(z) == 0:
        return
    base = np.column_stack([np.ones(len(z)), xy - xy.mean(axis=0)])
    low, high = np.quantile(z, [0.05, 0.95])
    inner = (z >= low) & (z <= high)
    level = z - base @ np.linalg.lstsq(base[inner], z[inner], rcond=None)[0]
    unit = xy / max(float(np.abs(xy).max()), 1e-300)  # whose distances have a square
    around = level[cKDTree(unit).query(unit, k=NEIGHBOURS + 1)[1][:, 1:]]
    away = np.abs(level - np.median(around, axis=1))
    middle = np.sort(around, axis=1)[:, 1:-1]  # so that one lonely point does not hide another
    steps = np.diff(np.unique(z))
    limit = np.maximum.reduce(
        [
            np.full(len(z), SCATTERS * 1.4826 * float(np.median(away))),
            RANGES * np.ptp(middle, axis=1),
            np.full(len(z), SPANS * float(np.subtract(*np.quantile(level, [0.95, 0.05])))),
            np.full(len(z), QUANTA * float(steps[steps > 1e-9 * np.ptp(z)].min())),
        ]
    )
    nearest = np.abs(level[:, None] - around).min(axis=1)  # the end of a ridge has a neighbour like itself
    alone = np.flatnonzero((away > limit) & (nearest > away / 2))
    if len(alone):
        worst = alone[np.argmax(away[alone])]
        x, y = (1e3 * v for v in xy[worst])
        raise InputError(
            f"{name}: {len(alone)} of {len(z)} points are alone; row {rows[worst] + 1} of the numbers, at "
            f"x = {x:.4g} mm, y = {y:.4g} mm, is {1e6 * away[worst]:.4g} um off the median of its {NEIGHBOURS} "
            f"neighbours, where half of the points are within {1e6 * float(np.median(away)):.3g} um. Leave such points "
            "out, or measure more points there where the step is real"
        )
