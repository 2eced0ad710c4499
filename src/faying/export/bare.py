"""Modes of parts that another program has assembled, with a joint added here."""

from pathlib import Path

import numpy as np

from faying.decks.matrices import arranged, read_matrices
from faying.errors import InputError
from faying.export.attach import Attachment
from faying.fe.elasticity import rigid_motions
from faying.misuse import checked_call
from faying.numerics.damped import DampedModes, damped_modes
from faying.numerics.memory import check_modes
from faying.numerics.modes import lowest_modes

SPARE = 6  # modes beyond those asked for, for the basis of the complex ones
MIN_RESISTANCE = 1e-9  # of the greatest energy of a rigid motion under an equal diagonal: below it nothing resists


@checked_call
def modes_with_joint(
    attachment: Attachment,
    matrices: str | Path,
    *,
    stiffness_unit: str | None,
    mass_unit: str | None,
    mass: str | Path | None = None,
    dofs: str | Path | None = None,
    count: int = 10,
) -> tuple[DampedModes, int]:
    """Find the elastic modes, with loss factors, of parts that another program has assembled, and of the joint.

    Args:
        attachment: The joint, on the mesh of the matrices, node by node.
        matrices: File of stiffness and mass, or of the stiffness: .sti, .mtx, .npz, DMIG.
        stiffness_unit, mass_unit: Units of the entries, such as "N/mm" and "t".
        mass, dofs: With a .mtx: file of the mass, and of "node direction" of each row.
        count: How many elastic modes.
        solver: What factorises the matrices, by the names of a study; chosen where None.

    Returns:
        The modes, and how many rigid motions nothing resists.

    Raises:
        ReadError, InputError: Files or units that cannot be used, matrices of another mesh or with supports.
        NotConverged: The iteration stops short.
    """
    pairs, mesh = attachment.pairs, attachment.deck.mesh
    read = read_matrices(matrices, stiffness_unit=stiffness_unit, mass_unit=mass_unit, mass=mass, dofs=dofs)
    bare, M = arranged(read, mesh)
    K, C = bare + pairs.matrix(), pairs.matrix(pairs.loss)
    rigid = rigid_motions(mesh.points)
    energy = np.einsum("ij,ij->j", rigid, K @ rigid)
    still = int(np.count_nonzero(energy < MIN_RESISTANCE * np.einsum("ij,i,ij->j", rigid, K.diagonal(), rigid)))
    if still not in (0, 6):
        raise InputError(
            f"the matrices leave {still} of the six rigid motions free; take them from the model without supports, or "
            "fixed in all directions"
        )
    speeds = [(m.E / (m.density or np.inf)) ** 0.5 for m in attachment.materials.values()]
    shift = 0.02 * max(speeds) / mesh.size
    check_modes(count + still + SPARE, K.shape[0])
    found = lowest_modes(K, M, count + still + SPARE, shift_frequency=shift)
    return damped_modes(found, K, M, C, rigid=still, count=count), still
