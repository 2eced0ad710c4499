"""The frequencies of a structure with the faces of its joints apart, and with them bonded: its joints lie between."""

from typing import Any

import numpy as np

from faying.case.above_range import stiff_as_bonded
from faying.case.case import Case
from faying.joint.bolted import bond, merged
from faying.joint.shared_modes import modes_with
from faying.joint.support_check import RIGID_BELOW
from faying.notes import Note
from faying.numerics.by_parts import PartByPart
from faying.numerics.constraint import constrain
from faying.typing import Array

Bounds = tuple[Array, Array] | tuple[None, None]
STIFFER = 40.0  # springs in place of bonded faces, over those beyond the end of a law


def bounds(case: Case) -> tuple[Bounds, list[Note]]:
    """Frequencies [Hz] of the elastic modes with the faces of every joint apart, and with them bonded; notes.

    None twice where there are no joints.
    Faces that match node for node have one answer, to 1e-8, under every solver: their unknowns become one, or, where
    that is not possible, springs between them are extrapolated to rigid ones. Other faces are tied, with a note.
    """
    structure = case.structure
    if not structure.joints:
        return (None, None), []
    free = modes_with(case.modal, *structure.dynamic_matrices, rigid=structure.unjoined_motions())
    frequencies = np.where(free.frequencies < RIGID_BELOW * case.shift_frequency, 0.0, free.frequencies)
    bonded, notes = _bonded(case)
    return (frequencies[_elastic(case)], bonded), notes


def _elastic(case: Case) -> slice:
    return slice(case.rigid_count, case.rigid_count + case.study.modes.count)


def _bonded(case: Case) -> tuple[Array, list[Note]]:
    structure = case.structure
    merge = structure.bonded()
    if merge is None:
        pairs = {joint.name: bond(structure.mesh, [joint.faces], [joint.interface.area]) for joint in structure.joints}
        apart = ", ".join(name for name, found in pairs.items() if found is None)
        text = (
            f"the faces of {apart} do not match node for node: in the bonded modes they are tied on average "
            "over each element, which may lower a frequency by some 0.3 %"
        )
        K, M = structure.dynamic_matrices
        tied = modes_with(case.modal, K + structure.tied(), M, rigid=structure.rigid)
        return tied.frequencies[_elastic(case)], [Note(code="bonded-by-ties", severity="limit", text=text)]
    if len(structure.fixed) or isinstance(structure.solver(case.study.modes.solver), PartByPart):
        return _extrapolated(case), []
    return _merged(case, merge), []


def _merged(case: Case, merge: Any) -> Array:
    """The unknowns of both faces of every joint are one; merge: as `Structure.bonded` gives it."""
    structure = case.structure
    K, M = (merged(matrix, merge) for matrix in structure.dynamic_matrices)
    share = np.asarray(merge.sum(axis=0)).ravel()
    rigid = (merge.T @ structure.rigid) / share[:, None]
    return modes_with(case.modal, K, M, rigid=rigid).frequencies[_elastic(case)]


def _extrapolated(case: Case) -> Array:
    """Springs of stiffness k and 2 k, without the error of squared frequencies that goes with 1/k."""
    soft, stiff = (_by_springs(case, times) for times in (STIFFER, 2 * STIFFER))
    return np.asarray(np.sqrt(2 * stiff**2 - soft**2))


def _by_springs(case: Case, times: float) -> Array:
    """Springs between the faces, so many times as stiff as those that stand for bonded faces."""
    structure = case.structure
    K, M = structure.dynamic_matrices
    stiff = times * stiff_as_bonded(structure)
    for joint in structure.joints:
        springs = joint.interface.springs(*2 * (np.full(len(joint.interface.weights), stiff),))
        K = K + constrain(springs, structure.fixed, 0.0)
    return modes_with(case.modal, K, M, rigid=structure.rigid).frequencies[_elastic(case)]
