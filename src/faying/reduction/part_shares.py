"""What each part has in the matrices of a structure, so that its stiffness and mass may be scaled."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from faying.bolt.solid_bolt import FittedSolidBolt
from faying.fe.elasticity import assemble
from faying.joint.structure import Structure
from faying.numerics.constraint import constrain
from faying.typing import Array


@dataclass(frozen=True)
class Nothing:
    """A material without stiffness and mass: what the other parts are made of while one is assembled alone."""

    E: float = 0.0
    nu: float = 0.0
    density: float = 0.0


Scales = Sequence[tuple[float, float]]  # of the stiffness and of the mass of each part


@dataclass(frozen=True, kw_only=True)
class PartShares:
    """Matrices of the parts that may be scaled, at the size of the structure.

    Args:
        parts: Names (p,).
        supported_stiffness: Of each part, its share in `Structure.supported_stiffness` [N/m]: a bolt that is drawn in
            lacks what its tension takes.
        stiffness, mass: Of each part, its shares in `Structure.dynamic_matrices` [N/m], [kg].
    """

    parts: tuple[str, ...] = ()
    supported_stiffness: tuple[Any, ...] = ()
    stiffness: tuple[Any, ...] = ()
    mass: tuple[Any, ...] = ()

    @classmethod
    def of(cls, structure: Structure, parts: Sequence[str]) -> Self:
        """The shares of some parts in the matrices of a structure."""
        from scipy.sparse import diags_array

        K, M = structure.matrices
        bonded = {part for pair in structure.mesh.bonded for part in pair}
        supported_stiffness, stiffness, mass = [], [], []
        for part in parts:
            if part in bonded:  # it shares nodes with another
                nothing = {other: Nothing() for other in structure.mesh.parts}
                mine = assemble(structure.mesh, nothing | {part: structure.materials[part]})
                own = [constrain(matrix, structure.fixed, 0.0) for matrix in mine]
            else:
                here = np.zeros(structure.mesh.unknowns)
                here[(3 * structure.mesh.part_nodes(part)[:, None] + np.arange(3)).ravel()] = 1.0
                sieve = diags_array(here)
                own = [constrain(sieve @ matrix, structure.fixed, 0.0) for matrix in (K, M)]
            stiffness.append(own[0])
            mass.append(own[1])
            supported_stiffness.append(own[0])
            for bolt in structure.fitted_bolts:
                if isinstance(bolt, FittedSolidBolt) and bolt.bolt.part == part:
                    supported_stiffness[-1] = own[0] - constrain(bolt.released, structure.fixed, 0.0)
        return cls(
            parts=tuple(parts),
            supported_stiffness=tuple(supported_stiffness),
            stiffness=tuple(stiffness),
            mass=tuple(mass),
        )


@dataclass(frozen=True, kw_only=True)
class ReducedShares:
    """The shares of p parts in the bases of a structure with r rigid motions.

    A mass that changes moves the rigid motions against the elastic ones. No stiffness resists them, so that they follow
    by the balance of momentum alone, and leave the problem: `motion`.

    Args:
        supported_stiffness: (p, s, s) [N/m] in the basis for equilibrium.
        stiffness, mass: (p, d, d) in the basis for vibration.
        cross: (p, r, d), mass between rigid motions and the basis.
        corner: (p, r, r), mass of rigid motions; those of the whole structure are orthonormal.
    """

    supported_stiffness: Array
    stiffness: Array
    mass: Array
    cross: Array
    corner: Array

    def add(
        self, scales: Scales, supported_stiffness: Array, stiffness: Array, mass: Array
    ) -> tuple[Array, Array, Array]:
        """The three matrices of the structure with its parts scaled."""
        k, m = (np.array([pair[i] for pair in scales]) - 1 for i in (0, 1))
        mass = mass + np.tensordot(m, self.mass, 1)
        if self.corner.shape[1] and np.any(m):
            mass = mass + np.tensordot(m, self.cross, 1).T @ self.motion(scales)
        return (
            supported_stiffness + np.tensordot(k, self.supported_stiffness, 1),
            stiffness + np.tensordot(k, self.stiffness, 1),
            mass,
        )

    def motion(self, scales: Scales) -> Array:
        """Rigid motion (r, d) that goes with each vector of the basis for vibration, so that no momentum is left."""
        m = np.array([pair[1] for pair in scales]) - 1
        corner = np.eye(self.corner.shape[1]) + np.tensordot(m, self.corner, 1)
        return np.asarray(-np.linalg.solve(corner, np.tensordot(m, self.cross, 1)))
