"""Flatness of measured heights: the least distance of two parallel planes between which they lie."""

from dataclasses import dataclass

import numpy as np

from faying.errors import InputError
from faying.misuse import checked_call, numbers
from faying.typing import Array

FIRST_POINTS = 30  # points that the first linear program takes; those that stick out most join it
ROUNDS = 200
INSIDE = 1e-9  # of the flatness, by which a point may stick out


@dataclass(frozen=True, kw_only=True)
class MinimumZone:
    """Two parallel planes that hold all heights between them at the least distance.

    flatness: that distance [m]; plane: offset [m] and slopes [m/m] along x and y of the plane in the middle.
    """

    flatness: float
    plane: tuple[float, float, float]

    def middle(self, places: Array) -> Array:
        """Height [m] (n,) of the middle plane at places (n, 2) [m]."""
        return np.asarray(self.plane[0] + places @ np.array(self.plane[1:]))

    def depth(self, places: Array, heights: Array) -> Array:
        """How far heights [m] (n,) at places (n, 2) [m] lie below the upper plane [m]."""
        return np.asarray(self.flatness / 2 + self.middle(places) - heights)


@checked_call
def minimum_zone(places: Array, heights: Array) -> MinimumZone:
    """Find the flatness of heights as the minimum zone, by linear programming.

    Distances are taken along the height, which differs from that across the planes by the square of their slope.

    Args:
        places: (n, 2) [m], not all on one line.
        heights: (n,) [m], all finite.

    Returns:
        The planes and their distance.

    Raises:
        InputError: fewer than four points, or all on one line.

    Source:
        ISO 1101 and ISO 12781-1 (minimum zone); the linear program is min t, |h - a - b x - c y| <= t/2.
    """
    from scipy.optimize import linprog

    places = numbers(places, "places", "points", 2)
    heights = numbers(heights, "heights", len(places))
    if not (np.all(np.isfinite(places)) and np.all(np.isfinite(heights))):
        raise InputError("places and heights have numbers that are not finite; leave these points out")
    if len(heights) < 4:
        raise InputError(f"flatness of {len(heights)} points: four or more are needed")
    centre, size = places.mean(axis=0), float(np.ptp(places, axis=0).max())
    x = (places - centre) / (size or 1.0)
    if np.linalg.matrix_rank(x, tol=1e-9) < 2:
        raise InputError("flatness of points on one line: they must cover an area, with x and y both varying")
    base = np.column_stack([np.ones(len(x)), x])
    fit = np.linalg.lstsq(base, heights, rcond=None)[0]
    rest = heights - base @ fit
    scale = float(np.abs(rest).max())
    if scale <= 1e-13 * max(float(np.abs(heights).max()), 1e-300):
        return MinimumZone(flatness=0.0, plane=_plane(fit, centre, size))
    rest = rest / scale
    order = np.argsort(rest)
    chosen = set(order[:FIRST_POINTS].tolist()) | set(order[-FIRST_POINTS:].tolist())
    for _ in range(ROUNDS):
        index = np.array(sorted(chosen))
        rows = base[index]
        half = np.full((len(index), 1), -1.0)
        limits = np.block([[rows, half], [-rows, half]])
        found = linprog(
            [0, 0, 0, 1], A_ub=limits, b_ub=np.concatenate([rest[index], -rest[index]]), bounds=(None, None)
        )
        out = np.abs(rest - base @ found.x[:3])
        worst = np.argsort(-out)[:FIRST_POINTS]
        more = {int(i) for i in worst if out[i] > found.x[3] * (1 + INSIDE)} - chosen
        if not more:
            break
        chosen |= more
    # the plane of the last program holds all points, maybe by a hair's breadth more than its own distance
    return MinimumZone(flatness=2 * scale * float(out.max()), plane=_plane(fit + scale * found.x[:3], centre, size))


def _plane(fit: Array, centre: Array, size: float) -> tuple[float, float, float]:
    """Coefficients over scaled places as offset and slopes over places."""
    slopes = fit[1:] / (size or 1.0)
    return float(fit[0] - slopes @ centre), float(slopes[0]), float(slopes[1])
