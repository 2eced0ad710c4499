"""A measured form error between two faces, laid on a joint as its gap before any load."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from faying.errors import InputError
from faying.fe.interface import Interface
from faying.files import read_numbers
from faying.typing import Array


@dataclass(frozen=True, kw_only=True)
class GapMap:
    """Gaps [m] (n,) at places (n, 2) [m] of a plane through origin (3,) [m] with axes x, y (3,). NaN are left out."""

    places: Array
    gaps: Array
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    x_axis: tuple[float, float, float] = (1.0, 0.0, 0.0)
    y_axis: tuple[float, float, float] = (0.0, 1.0, 0.0)

    def __post_init__(self) -> None:
        good = np.isfinite(self.gaps) & np.isfinite(self.places).all(axis=1)
        if np.count_nonzero(good) < 4:
            raise InputError(f"the gap map has {np.count_nonzero(good)} points with numbers; a map needs four or more")
        spread = np.linalg.svd(self.places[good] - self.places[good].mean(axis=0), compute_uv=False)
        if spread[1] < 1e-9 * spread[0]:
            raise InputError(
                "the points of the gap map lie on one line; a map covers an area, with x and y both varying"
            )
        object.__setattr__(self, "places", self.places[good])
        object.__setattr__(self, "gaps", self.gaps[good])

    def at(self, positions: Array) -> Array:
        """Gap [m] at positions (q, 3) [m]: linear between the points of the map, the nearest point's outside them."""
        from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator

        axes = np.stack([np.array(axis) / np.linalg.norm(axis) for axis in (self.x_axis, self.y_axis)])
        if abs(axes[0] @ axes[1]) > 1e-6:
            raise InputError("the axes of the gap map are not at right angles; give x_axis and y_axis that are")
        local = (positions - np.array(self.origin)) @ axes.T
        low, high = self.places.min(axis=0), self.places.max(axis=0)
        outside = np.any((local < low - 0.25 * (high - low)) | (local > high + 0.25 * (high - low)), axis=1)
        if outside.mean() > 0.2:
            raise InputError(
                f"{outside.mean():.0%} of the joint lies far from the gap map, which covers {_box(low, high)} while "
                f"the joint lies at {_box(local.min(axis=0), local.max(axis=0))}; check origin, axes and units"
            )
        inside = LinearNDInterpolator(self.places, self.gaps)(local)
        return np.asarray(np.where(np.isfinite(inside), inside, NearestNDInterpolator(self.places, self.gaps)(local)))

    def on(self, interface: Interface) -> Interface:
        """Return the joint with this gap added to that of its geometry."""
        return replace(interface, gap=interface.gap + self.at(interface.positions))


def _box(low: Array, high: Array) -> str:
    return " x ".join(f"{1e3 * a:.4g} to {1e3 * b:.4g} mm" for a, b in zip(low, high, strict=True))


def read_gap_map(
    path: Path,
    *,
    xy_unit: float,
    gap_unit: float,
    origin: tuple[float, float, float],
    x_axis: tuple[float, float, float],
    y_axis: tuple[float, float, float],
) -> GapMap:
    """Read three columns x, y, gap (commas or blanks between, lines of text skipped); units: size of one in metres."""
    table = read_numbers(path, 3, "a gap map has the columns x, y, gap")
    return GapMap(
        places=table[:, :2] * xy_unit, gaps=table[:, 2] * gap_unit, origin=origin, x_axis=x_axis, y_axis=y_axis
    )
