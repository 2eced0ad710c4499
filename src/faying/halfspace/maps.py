"""Maps of a solved half-space contact, and the numbers that follow from them alone."""

from dataclasses import dataclass
from functools import cached_property
from math import log, pi

import numpy as np
from numpy.typing import NDArray

from faying.halfspace.arrays import Arithmetic
from faying.halfspace.spots import Spots
from faying.style import Summary
from faying.typing import Array, Mask
from faying.units import show

OPEN, AT_HARDNESS = 0, 2  # and 1 between


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class ContactMaps(Summary):
    """The fields of `HalfSpaceContact`, which says what they are, and the numbers that follow from them alone."""

    heights: Array
    spacing: tuple[float, float]
    E_star: float
    nu: float
    hardness: float | Array | None
    periodic: bool
    traction: Array
    displacement: Array
    plane: float
    residual: float
    iterations: int
    applications: int
    workers: int | None = None

    def summary(self) -> tuple[str, dict[str, str]]:
        """The map, the pressure, what touches, the error bound."""
        rows, columns = self.heights.shape
        (dx, dy), hard = self.spacing, self.hardness
        limit = "none" if hard is None else show(hard, "Pa") if isinstance(hard, float) else "one for each point"
        return f"Half-space contact at {show(self.pressure, 'Pa')}", {
            "map": f"{columns} x {rows} points on {show(columns * dx, 'm')} x {show(rows * dy, 'm')}",
            "E*": show(self.E_star, "Pa"),
            "hardness": limit,
            "area": f"{100 * self.area:.4g} % of the points, {100 * self.saturated:.4g} % at hardness",
            "spots": str(self.spots.count),
            "residual": f"{self.residual:.2g}",
        }

    @property
    def arithmetic(self) -> Arithmetic:
        """The arithmetic of tangent and slip."""
        return Arithmetic(workers=self.workers)

    @property
    def pressure(self) -> float:
        """Mean pressure over the map [Pa]."""
        return float(self.traction.mean(dtype=float))

    @property
    def state(self) -> NDArray[np.int8]:
        """Per point 0 open, 1 elastic contact, 2 contact at hardness."""
        out = (self.traction > 0).astype(np.int8)
        if self.hardness is not None:
            out[self.at_hardness] = AT_HARDNESS
        return out

    @property
    def at_hardness(self) -> Mask:
        """Where the pressure is the hardness (to rounding)."""
        if self.hardness is None:
            return np.zeros(self.traction.shape, dtype=bool)
        return self.traction >= self.hardness * (1 - max(1e-12, 4 * float(np.finfo(self.traction.dtype).eps)))

    @cached_property
    def spots(self) -> Spots:
        """The connected groups of points that touch."""
        return Spots.of(self.traction > 0, self.spacing, periodic=self.periodic)

    @property
    def area(self) -> float:
        """Share of the map's points that carry pressure [-]."""
        return float(np.count_nonzero(self.traction) / self.traction.size)

    @property
    def saturated(self) -> float:
        """Share of the map's points at hardness [-]."""
        return float(np.count_nonzero(self.at_hardness) / self.traction.size)

    def _border(self, touching: Mask, other: Mask) -> float:
        """Length of the cell sides between `touching` and `other` points, per map area [1/m]."""
        (ny, nx), (dx, dy) = touching.shape, self.spacing
        if not self.periodic:  # a frame that does not touch
            touching, other = np.pad(touching, 1), np.pad(other, 1, constant_values=True)
        down, across = (
            np.count_nonzero((touching & np.roll(other, -1, axis)) | (other & np.roll(touching, -1, axis)))
            for axis in (0, 1)
        )
        return float((across * dy + down * dx) / (nx * ny * dx * dy))

    @property
    def area_corrected(self) -> float:
        """Real area freed of the excess of cells that touch in part [-].

        A - (pi - 1 + ln 2)/24 S dx, with S the perimeter: Yastrebov, Anciaux and Molinari 2017,
        doi:10.1016/j.jmps.2017.07.016; for square cells (dx is the geometric mean of the spacings). A cell at hardness
        touches in full: only the border of elastic cells counts in S, and the area is at least pressure over hardness.
        """
        touching = self.traction > 0
        dx = float((self.spacing[0] * self.spacing[1]) ** 0.5)
        least = 0.0 if self.hardness is None else float((self.traction / self.hardness).mean(dtype=float))
        return max(
            least, self.area - (pi - 1 + log(2)) / 24 * self._border(touching & ~self.at_hardness, ~touching) * dx
        )

    @property
    def gap(self) -> Array:
        """Distance between surface and plane at each point [m]; negative by the plastic indentation at hardness."""
        return np.asarray(self.plane + self.displacement - self.heights)

    @property
    def flattened(self) -> Array:
        """Heights [m] that are left when the load is taken off: less what points at hardness were pressed in."""
        return self.heights - np.where(self.at_hardness, np.maximum(-self.gap, 0.0), 0.0)

    @property
    def approach(self) -> float:
        """How far the plane has come down from first touch [m]."""
        return float(self.heights.max()) - self.plane

    @property
    def closing(self) -> float:
        """How far the plane lies below the mean height of the map [m]; grows with the load, and may be negative.

        Unlike the approach it does not depend on the one highest point, so that maps of one surface at several
        resolutions agree on it.
        """
        return float(self.heights.mean()) - self.plane

    @property
    def elastic_energy(self) -> float:
        """Strain energy per nominal area [J/m2]: mean of traction times displacement, halved."""
        return float((self.traction * self.displacement).mean()) / 2

    @property
    def plastic_work(self) -> float:
        """Work spent at hardness on first loading, per nominal area [J/m2]: hardness times mean indentation."""
        if self.hardness is None:
            return 0.0
        return float((self.traction * np.maximum(-self.gap, 0) * self.at_hardness).mean())
