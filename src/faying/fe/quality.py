"""How good the elements of a mesh are: their kinds, and how far their corners are from those of an ideal element."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from faying.fe.elements import SOLIDS, Element
from faying.fe.solids import SolidMesh
from faying.notes import Note
from faying.typing import Array, Index

STIFF = 0.01  # share of 4-node tetrahedra from which they are noted
POOR = 0.05  # scaled Jacobian below which an element is noted


@dataclass(frozen=True, kw_only=True)
class MeshQuality:
    """What the elements of a mesh are.

    counts: kind -> number of elements; least: least scaled Jacobian [-], 1 for an ideal element and 0 for a flat one;
    poor: number of elements below `POOR`.
    """

    counts: Mapping[str, int]
    least: float
    poor: int

    @property
    def notes(self) -> tuple[Note, ...]:
        """What a user should know of it."""
        out = []
        share = self.counts.get("tet4", 0) / sum(self.counts.values())
        if share > STIFF:
            out.append(
                Note(
                    code="stiff-elements",
                    severity="limit",
                    text=f"{share:.0%} of the elements are tetrahedra with four nodes, which are far too stiff in "
                    "bending (frequencies too high by half or more); mesh with ten nodes",
                )
            )
        if self.poor:
            out.append(
                Note(
                    code="distorted-elements",
                    severity="wrong",
                    text=f"{self.poor} elements are nearly flat (scaled Jacobian {self.least:.2g}, {POOR:g} at least); "
                    "stresses and stiffness there are poor: mesh anew",
                )
            )
        return tuple(out)


def scaled_jacobian(points: Array, cells: Index) -> Array:
    """Least over the corners (e,) of the volume of the three edges over the product of their lengths, 1 where ideal."""
    element = SOLIDS[cells.shape[1]]
    ideal = {"tet": np.sqrt(2.0), "wedge": 2 / np.sqrt(3.0), "hex": 1.0}[element.shape.name]
    out = np.full(len(cells), np.inf)
    for corner, ends in _edges_at(element).items():
        arms = points[cells[:, ends]] - points[cells[:, corner]][:, None]
        arms /= np.linalg.norm(arms, axis=2, keepdims=True)
        out = np.minimum(out, ideal * np.linalg.det(arms))
    return out


def _edges_at(element: Element) -> dict[int, list[int]]:
    """The three neighbours of each corner, in the order in which their volume is positive."""
    out = {}
    for corner in range(element.corners):
        ends = [a + b - corner for a, b in element.edges if corner in (a, b)]
        arms = element.nodes[ends] - element.nodes[corner]
        out[corner] = ends if np.linalg.det(arms) > 0 else ends[::-1]
    return out


def quality(mesh: SolidMesh) -> MeshQuality:
    """Return what the elements of a mesh are."""
    counts: dict[str, int] = {}
    values = []
    for cells in mesh.blocks:
        name = SOLIDS[cells.shape[1]].name
        counts[name] = counts.get(name, 0) + len(cells)
        values.append(scaled_jacobian(mesh.points, cells))
    least = np.concatenate(values)
    return MeshQuality(counts=counts, least=float(least.min()), poor=int(np.count_nonzero(least < POOR)))
