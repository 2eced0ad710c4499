"""A measured form in numbers: flatness, crowns and twist."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.form.flatness import MinimumZone, minimum_zone
from faying.misuse import checked_call, numbers
from faying.typing import Array


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
        numbers = {
            "length_along": self.lengths[0],
            "length_across": self.lengths[1],
            "flatness": self.zone.flatness,
            "crown_along": self.crown_along,
            "crown_across": self.crown_across,
            "twist": self.twist,
            "rest": self.rest,
        }
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
