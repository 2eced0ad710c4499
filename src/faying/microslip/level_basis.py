"""The basis in which damping at levels is found: the modes at rest, and what their slipping cycles ask for.

A cycle of a mode that slips leaves forces in the full equations. The motion under them, of a joint that sticks, is the
flexibility that the modes at rest lack. One round of it leaves 0.3 % of the damping, where the modes at rest alone miss
43 % (two blocks, friction 0.03, 100 m/s2). Rounds end where what is left is small. It depends on
the state alone.
"""

from collections.abc import Sequence

import numpy as np

from faying.joint.bolted import BoltedStructure
from faying.joint.equilibrium import PreloadState
from faying.joint.modal import Vibration
from faying.microslip.levels import LevelCycle, LevelModel, level_model
from faying.microslip.microslip import Microslip
from faying.microslip.slip_basis import GOOD, unbalanced_forces
from faying.numerics.shifted import Shifted
from faying.numerics.solve import conjugate_gradients
from faying.numerics.span import Span
from faying.typing import Array

ROUNDS = 6  # of enrichment with one set of laws: a column on one bolt of which a third slides takes five
ROWS = 3  # of a cycle: its mean and its first harmonic, which damping depends on to first order
ACCURACY = 1e-3  # of the motion under what is left: below the share of it that is left out
SMALL = 1e-3  # of the motion, in energy: motions below it change a damping by less than a thousandth
MIN_NEW_SHARE = 1e-6  # of the square of a motion that must be new: what is less is left of the solution


def level_basis(
    structure: BoltedStructure,
    preload: PreloadState,
    found: Vibration,
    laws: Sequence[Sequence[Microslip]],
    levels: Sequence[Sequence[float]],
) -> Span:
    """Make the basis of the lowest elastic modes.

    Args:
        structure: without springs per node on its joints.
        preload: its equilibrium under the bolts.
        found: its modes at rest, at least `count` elastic ones to full accuracy.
        laws: of the joints, one set after another that the basis is made for, the least friction first. It slips most:
            the next set is for modes that have no answer at the greatest level under it.
        levels: accelerations [m/s2] of each elastic mode from the lowest on, of which it takes the greatest at which it
            has an answer; none for a mode that is not looked at.

    Returns:
        Vectors orthonormal with the mass, rigid motions first, and the stiffness of the parts projected on them.
    """
    stiffness, mass = structure.dynamic_matrices
    basis = Span(mass, stiffness, found.modes.shapes[:, : structure.rigid_count + len(levels)])
    at_rest = Shifted(stiffness=found.stiffness, mass=mass, shift=found.modes.shift)
    left = [k for k, own in enumerate(levels) if len(own)]
    for own in laws:
        wanted = left
        for number in range(ROUNDS):
            model = level_model(structure, preload, basis, own)
            every = {k: _greatest(model, levels[k], k) for k in wanted}
            if number == 0:
                left = [k for k, one in every.items() if one is None or one[0] < max(levels[k])]
            # the basis has the modes at rest
            cycles = {k: one[1] for k, one in every.items() if one is not None and not one[1].at_rest}
            if not cycles:
                break
            forces = np.concatenate([_left(structure, model, cycle) for cycle in cycles.values()], axis=1)
            moved = conjugate_gradients(
                at_rest.__matmul__, found.modes.factorisation, forces, accuracy=ACCURACY, least=(SMALL / 2) ** 2
            )
            size = np.sqrt(np.maximum(np.einsum("ij,ij->j", forces, moved), 0.0))
            worst = size.reshape(-1, ROWS).max(axis=1)
            wanted = [k for k, one in zip(cycles, worst, strict=True) if one > GOOD]
            if not wanted or not basis.add(moved[:, size > SMALL], least=MIN_NEW_SHARE):
                break
    return basis


def _greatest(model: LevelModel, levels: Sequence[float], number: int) -> tuple[float, LevelCycle] | None:
    """The greatest level at which a mode has an answer, and its cycle there."""
    cycles = ((level, model.cycle(level, number)) for level in sorted(levels, reverse=True))
    return next((one for one in cycles if np.isfinite(one[1].frequency)), None)


def _left(structure: BoltedStructure, model: LevelModel, cycle: LevelCycle) -> Array:
    """What a cycle leaves in the full equations, (unknowns, ROWS), over the root of twice the energy of its motion."""
    motion = cycle.motion[:ROWS]
    left = unbalanced_forces(
        structure,
        model.vectors,
        model.slip.joints,
        motion=motion,
        traction=[traction[:ROWS] for traction in cycle.traction],
        speed=2 * np.pi * cycle.frequency,
        damping=cycle.damping,
    )
    return np.asarray(left / np.sqrt(motion[1] @ model.slip.linear @ motion[1]))
