"""The elastic part of an asperity and its substrate, condensed once to the border of the part that yields."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from faying.asperity_fe.body import Body, Spring
from faying.asperity_fe.plasticity import equivalent
from faying.numerics.solve import factorise
from faying.typing import Array, Index


@dataclass(frozen=True, kw_only=True)
class FarField:
    """Elements that stay elastic, `body`, seen from the degrees of freedom `border` that they share with the others."""

    body: Body
    border: Index
    solver: str | None = None

    @cached_property
    def _split(self) -> tuple[Index, Index]:
        edge = self.body.unknown_of_dof[self.border]
        inside = np.setdiff1d(np.arange(self.body.size), edge)
        return edge, inside

    @cached_property
    def _followers(self) -> Array:
        """Displacements inside (i, d) for a unit displacement of each degree of freedom of the border."""
        edge, inside = self._split
        stiffness = self.body.elastic
        rows: Any = stiffness[inside]
        return -factorise(rows[:, inside], self.solver).solve(rows[:, edge].toarray())

    @cached_property
    def spring(self) -> Spring:
        """The stiffness at the border: static condensation, exact while these elements are elastic."""
        edge, inside = self._split
        rows = self.body.elastic[edge]
        stiffness = rows[:, edge].toarray() + rows[:, inside] @ self._followers
        return Spring(dofs=self.border, stiffness=(stiffness + stiffness.T) / 2)

    def unknowns(self, at_border: Array) -> Array:
        """Displacement of this body (its unknowns) when its border is moved."""
        edge, inside = self._split
        full = np.zeros(self.body.size)
        full[edge] = at_border
        full[inside] = self._followers @ at_border
        return full

    def utilisation(self, at_border: Array) -> float:
        """Largest von Mises stress over yield strength in these elements."""
        flow = self.body.flow
        strain = self.body.strain(self.unknowns(at_border))
        return float(np.max(equivalent(elastic_stress(flow.bulk, flow.shear, strain)) / flow.strength))


def elastic_stress(bulk: Array, shear: Array, strain: Array) -> Array:
    """Hooke's law at points: stress (p, 4) of strain (p, 4), the last one the engineering shear."""
    dilatation = strain[:, :3].sum(axis=1)
    stress = 2 * shear[:, None] * strain
    stress[:, 3] *= 0.5
    stress[:, :3] += ((bulk - 2 * shear / 3) * dilatation)[:, None]
    return stress


def shared(first: Body, second: Body) -> Index:
    """Degrees of freedom that two bodies of one mesh have in common."""
    return np.flatnonzero((first.unknown_of_dof >= 0) & (second.unknown_of_dof >= 0))
