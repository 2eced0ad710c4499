"""A measured form in numbers: flatness, crowns and twist."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.errors import InputError
from faying.misuse import checked_call, numbers
from faying.style import COLUMN, WIDE, drawing, headline, new_figure
from faying.typeset import unit
from faying.typing import Array
from faying.units import show

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


@dataclass(frozen=True, kw_only=True, eq=False)
class FormFit:
    """What a measured form is made of.

    Args:
        places, values: the points (n, 2) [m] and their heights, or gaps, (n,) [m].
        is_gap: whether the values are gaps between two faces rather than heights of one.
        lengths: sides [m] of the map along its longer and its shorter axis.
        along: "x" or "y", the axis of the map along which it is longer.
        zone: planes of the minimum zone; its flatness [m].
        crown_along, crown_across, twist: least-squares amplitudes [m] as `Form` takes them, as gaps: a face that is
            high in the middle has positive crowns.
        rest: flatness of what these three leave [m].
    """

    places: Array
    values: Array
    is_gap: bool
    lengths: tuple[float, float]
    along: str
    zone: MinimumZone
    crown_along: float
    crown_across: float
    twist: float
    rest: float

    def levelled(self) -> Array:
        """Values less the middle plane of the minimum zone [m] (n,)."""
        return np.asarray(self.values - self.zone.middle(self.places))

    def to_dict(self) -> dict[str, Any]:
        """Everything but the points, ready for JSON, SI units."""
        sizes = {"length_along": self.lengths[0], "length_across": self.lengths[1], "flatness": self.zone.flatness}
        shapes = {"crown_along": self.crown_along, "crown_across": self.crown_across, "twist": self.twist}
        numbers = sizes | shapes | {"rest": self.rest}
        return {
            "points": len(self.values),
            "values_are": "gaps" if self.is_gap else "heights",
            "along": self.along,
            **{name: {"unit": "m", "values": value} for name, value in numbers.items()},
        }


@checked_call
def fit_form(places: Array, values: Array, *, is_gap: bool = False) -> FormFit:
    """Take the flatness of measured heights of a face, or of gaps, and fit crowns and twist.

    The shapes are those of `faying.Form` over the least box around the points along the axes of the map, fitted by
    least squares together with a plane. For a twist seen from outside the first face, x goes along the longer side.

    Args:
        places: (n, 2) [m].
        values: heights out of the face, or gaps, (n,) [m]; points that are not finite are left out.
        is_gap: whether they are gaps.

    Returns:
        The fit.

    Raises:
        InputError: fewer than four points, or all on one line.
    """
    places = numbers(places, "places", "points", 2)
    values = numbers(values, "values", len(places))
    good = np.isfinite(values) & np.isfinite(places).all(axis=1)
    places, values = places[good], values[good]
    zone = minimum_zone(places, values)
    low, high = places.min(axis=0), places.max(axis=0)
    order = (0, 1) if high[0] - low[0] >= high[1] - low[1] else (1, 0)
    x, y = ((2 * places - low - high) / (high - low))[:, order].T
    if order == (1, 0):
        y = -y  # so that x, y and the direction out of the face stay a right-handed system
    base = np.column_stack([np.ones(len(x)), x, y, x**2, y**2, x * y])
    factors = np.linalg.lstsq(base, values, rcond=None)[0]
    sign = 1.0 if is_gap else -1.0
    lengths = (high - low)[list(order)]
    return FormFit(
        places=places,
        values=values,
        is_gap=is_gap,
        lengths=(float(lengths[0]), float(lengths[1])),
        along="xy"[order[0]],
        zone=zone,
        crown_along=sign * float(factors[3]),
        crown_across=sign * float(factors[4]),
        twist=sign * float(factors[5]),
        rest=minimum_zone(places, values - base @ factors).flatness,
    )


@drawing
def figure(fit: FormFit, title: str) -> Any:
    """Draw the map, with its flatness in the heading."""
    width, height = np.ptp(fit.places, axis=0)
    tall = float(np.clip((WIDE - 1.6) * height / width, 1.0, 5.0))
    fig = new_figure(float(np.clip(tall * width / height + 1.6, COLUMN, WIDE)), tall + 0.9)
    axes = fig.add_subplot()
    values = 1e6 * fit.levelled()
    most = 5e5 * fit.zone.flatness or 1.0
    x, y = 1e3 * fit.places.T
    picture = axes.tripcolor(x, y, values, shading="gouraud", rasterized=True, cmap="RdBu_r", vmin=-most, vmax=most)
    bar = fig.colorbar(picture, ax=axes)
    bar.set_label(f"{'gap' if fit.is_gap else 'height'} above the middle plane [µm]")
    flatness = unit(show(fit.zone.flatness, "m", digits=3))
    title = f"{headline(title)}\nflatness {flatness} (minimum zone)"
    axes.set(aspect="equal", xlabel="x [mm]", ylabel="y [mm]", title=title)
    return fig
