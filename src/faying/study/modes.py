"""The preload of a case and its real modes, as the study asks for them."""

from collections.abc import Sequence
from typing import Any

from faying.fe.interface import Interface
from faying.fe.memory import check_modes
from faying.fe.modes import Modes, lowest_modes
from faying.joint.equilibrium import PreloadState
from faying.joint.preload import PreloadProblem
from faying.joint.springs import Springs
from faying.joint.support_check import checked_preload
from faying.study.case import Case


def settled(case: Case, number: int, problem: PreloadProblem) -> PreloadState:
    """The preload of a case at one of its loads, counted from 0."""
    return checked_preload(case.structure, problem, case.study.forces(number), order=case.study.order)


def modes_of(case: Case, springs: Sequence[Springs[Interface]], count: int | None = None) -> tuple[Modes, Any, Any]:
    """Real modes of a case with springs on its joints, and the stiffness and loss that they belong to.

    count: rigid motions included; those of the case where None.
    """
    stiffness, loss = case.structure.joined(springs, viscous=case.study.modes.damping == "viscous")
    return modes_with(case, stiffness, case.structure.vibrating[1], count), stiffness, loss


def modes_with(case: Case, stiffness: Any, mass: Any, count: int | None = None) -> Modes:
    """Real modes of any stiffness [N/m] and mass [kg], by the solver and the shift of a case."""
    count = count or case.mode_count
    check_modes(count, stiffness.shape[0])
    return lowest_modes(
        stiffness,
        mass,
        count,
        shift_frequency=case.shift_frequency,
        solver=case.study.modes.solver,
    )
