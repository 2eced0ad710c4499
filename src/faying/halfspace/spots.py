"""The spots of a contact: connected groups of points that touch, and the hardness that each has by its size."""

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np

from faying.hardness import VickersHardness
from faying.typing import Array, Index, Mask


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Spots:
    """The spots of one contact; points that share a side belong to one spot.

    Args:
        label: of each point (ny, nx), 0 where it is open, then 1 to n.
        points: how many points each spot has (n,).
        point_area: of one point [m2].
    """

    label: Index
    points: Index
    point_area: float

    @classmethod
    def of(cls, touching: Mask, spacing: tuple[float, float], *, periodic: bool) -> "Spots":
        """Find the spots of a map of touching points (ny, nx), with the distances (dx, dy) [m] between points."""
        from scipy.ndimage import label

        found, count = label(touching)
        if periodic and count:
            found, count = _joined_across_borders(found, count)
        points = np.bincount(found.ravel(), minlength=count + 1)[1:]
        return cls(label=found, points=points, point_area=spacing[0] * spacing[1])

    @property
    def count(self) -> int:
        """How many spots there are."""
        return len(self.points)

    @cached_property
    def diagonals(self) -> Array:
        """Diagonal of the Vickers indentation that has the area of each spot [m] (n,): sqrt(2 A)."""
        return np.asarray(np.sqrt(2 * self.points * self.point_area))

    def share_below(self, points: int) -> float:
        """Share of the stiffness that rests on spots of fewer points than this [-].

        The stiffness of a spot goes with its radius, the root of its area; 0 where nothing touches.
        """
        radius = np.sqrt(self.points)
        return float(radius[self.points < points].sum() / radius.sum()) if self.count else 0.0

    def hardness(self, law: VickersHardness) -> Array:
        """Hardness at each point [Pa] (ny, nx): of its spot, and of a spot of one point where it is open.

        An open point next to a spot takes the least hardness of its eight neighbours, so that the spot may grow.
        """
        from scipy.ndimage import minimum_filter

        single = np.sqrt(2 * self.point_area)
        by_label = law.at(np.concatenate([[single], self.diagonals]))
        map_ = by_label[self.label]
        return np.where(self.label > 0, map_, minimum_filter(map_, size=3, mode="wrap"))


def _joined_across_borders(label: Index, count: int) -> tuple[Index, int]:
    """Give spots that meet across the borders of a map that repeats one label."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    pairs = np.concatenate([np.stack([label[0], label[-1]]), np.stack([label[:, 0], label[:, -1]])], axis=1)
    first, second = pairs[:, np.all(pairs > 0, axis=0)] - 1
    graph = coo_array((np.ones(len(first)), (first, second)), shape=(count, count))
    joined, component = connected_components(graph, directed=False)
    return np.concatenate([[0], component + 1])[label], int(joined)
