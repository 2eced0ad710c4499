"""What pressing one asperity gives: the history of the plane, and the asperity at its last step."""

from dataclasses import dataclass

import numpy as np

from faying.typing import Array, Index


@dataclass(frozen=True, kw_only=True)
class History:
    """What the plane felt, step by step: displacement [m], force [N], area and its bounds [m2], pressure [Pa] (steps,);
    area_bounds is (steps, 2); yielding [m3] the volume that flowed in the step; iterations those of each step."""

    displacement: Array
    force: Array
    area: Array
    area_bounds: Array
    yielding: Array
    iterations: Index

    @property
    def pressure(self) -> Array:
        """Mean pressure [Pa]; 0 without contact."""
        return np.where(self.area > 0, self.force / np.where(self.area > 0, self.area, 1.0), 0.0)


@dataclass(frozen=True, kw_only=True)
class CapField:
    """The asperity at the last step: nodes (n, 2) before the load and their displacement (n, 2) [m], radius and height;
    quads (m, 4); body (m,): 0 cap, 1 layer, 2 substrate; stress (m, 4) [Pa]: rr, zz, hoop, rz; equivalent plastic
    strain (m,)."""

    nodes: Array
    displacement: Array
    quads: Index
    body: Index
    stress: Array
    plastic_strain: Array


@dataclass(frozen=True, kw_only=True)
class AsperityResult:
    """Result of `solve_asperity`; force, area, pressure and area_bounds are those of the last step.

    residual [m]: the displacement at which the plane lost contact, where the history ends unloaded; elsewhere None.
    """

    history: History
    field: CapField
    residual: float | None
    unknowns: int
    factorisations: int

    @property
    def force(self) -> float:
        """Normal force [N]."""
        return float(self.history.force[-1])

    @property
    def area(self) -> float:
        """Contact area [m2] on the deformed surface, its edge placed between nodes."""
        return float(self.history.area[-1])

    @property
    def pressure(self) -> float:
        """Mean contact pressure [Pa]."""
        return float(self.history.pressure[-1])

    @property
    def area_bounds(self) -> tuple[float, float]:
        """Areas [m2] of the circles between which the mesh places the edge of the contact."""
        low, high = self.history.area_bounds[-1]
        return float(low), float(high)
