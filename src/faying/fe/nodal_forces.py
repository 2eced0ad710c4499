"""Nodal forces of what acts on solids: pressure on a face, heat."""

import numpy as np

from faying.fe.elasticity import Solid, chunks
from faying.fe.elements import SOLIDS
from faying.fe.elements.element import gradients_in_space
from faying.fe.sides import sampled
from faying.fe.solids import SolidMesh
from faying.typing import Array


def pressure_forces(mesh: SolidMesh, face: str) -> Array:
    """Nodal forces [N] (unknowns,) of a pressure of 1 Pa that presses on a face, against its outward normal."""
    total = np.zeros((len(mesh.points), 3))
    for faces, values, _, normals, share in sampled(mesh.points, mesh.face(face)):
        np.add.at(total, faces, -np.einsum("fq,qa,fqi->fai", share, values, normals))
    return total.ravel()


def thermal_forces(mesh: SolidMesh, part: str, material: Solid, strain: float) -> Array:
    """Nodal forces [N] (unknowns,) of a free expansion of a part by `strain` [-] in all directions.

    Under them alone the part takes that strain and has no stress, since they are integrated by the rule of its
    stiffness; incompatible modes do no work on an even stress.
    """
    stress = material.E / (1 - 2 * material.nu) * strain
    total = np.zeros((len(mesh.points), 3))
    for name, cells, _ in chunks(mesh):
        if name == part:
            _, weights, _, gradients = SOLIDS[cells.shape[1]].stiffness_rule
            g, det = gradients_in_space(mesh.points, cells, gradients)
            np.add.at(total, cells, stress * np.einsum("eq,eqai->eai", det * weights, g))
    return total.ravel()
