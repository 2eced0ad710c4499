"""What a motion of a structure makes of its bolts: bending, force across and torque at the ends of each shank."""

from dataclasses import dataclass

import numpy as np

from faying.bolt.bolt import FittedBolt, frame_about
from faying.bolt.solid_bolt import FittedSolidBolt
from faying.joint.bolted import BoltedStructure
from faying.numerics.product import product
from faying.typing import Array


@dataclass(frozen=True, kw_only=True)
class ShankForces:
    """Forces and moments in a shank under one motion, or under several (k).

    Args:
        moments: Bending moments [N m] about two axes across it (end, 2, ...): at both ends, or in the middle of a
            meshed bolt.
        shear: Force across it [N] on the part under its head, along two axes (2, ...).
        torsion: Torque [N m] about it on that part (...).
        across: The two axes (2, 3).
    """

    moments: Array
    shear: Array
    torsion: Array
    across: Array


def shank_forces(
    structure: BoltedStructure, index: int, motion: Array, heat: Array | None = None
) -> ShankForces | None:
    """Forces in the shank of a bolt under motions [m] (unknowns, ...) from the preload; None without a shank.

    heat: nodal forces [N] (unknowns,) of the heat of a meshed bolt.
    """
    fitted = structure.fitted_bolts[index]
    if isinstance(fitted, FittedBolt):
        ends = fitted.end_forces(motion)
        if ends is None:
            return None
        # the ends bear on the shank, so that the shank bears on the part the other way
        return ShankForces(
            moments=np.stack([ends[4:6], ends[10:12]]),
            shear=-ends[1:3],
            torsion=-ends[3],
            across=frame_about(fitted.axis)[1:],
        )
    line = fitted.seats[1] - fitted.seats[0]
    across = frame_about(line / np.linalg.norm(line))[1:]
    moves = _section_moves(structure, fitted, across)
    layer = np.repeat(np.any(fitted.pull.reshape(-1, 3) != 0, axis=1), 3)
    # in the plane across the shank: nodes that the bolt shares with another part bear forces of that part, too
    resisted = np.where(layer[:, None], product(structure.matrices[0], moves), 0.0)
    work = resisted.T @ motion
    if heat is not None:
        work = work - moves.T @ heat
    return ShankForces(moments=work[None, 2:4], shear=work[:2], torsion=work[4], across=across)


def _section_moves(structure: BoltedStructure, fitted: FittedSolidBolt, across: Array) -> Array:
    """Motions (unknowns, 5) of the far half of a meshed bolt: along two axes across it, about them, about its own."""
    first, second = across
    far = np.any(fitted.drawn.reshape(-1, 3) != 0, axis=1)[:, None]
    arm = structure.mesh.points - fitted.bolt.place(structure.mesh)
    moves = [np.where(far, one, 0.0) for one in across]
    moves += [np.where(far, np.cross(one, arm), 0.0) for one in (first, second, np.cross(first, second))]
    return np.stack([one.ravel() for one in moves], axis=1)
