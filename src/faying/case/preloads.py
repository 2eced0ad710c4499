"""The preload of a case at its loads."""

from faying.case.case import Case
from faying.joint.equilibrium import PreloadState
from faying.joint.preload import PreloadProblem
from faying.joint.support_check import check_contact, checked_preload
from faying.joint.tighten import tighten_together

AT_ONCE = 8_000_000  # unknowns of all loads whose preload is found at once


def solved_preload(case: Case, number: int, problem: PreloadProblem) -> PreloadState:
    """The preload of a case at one of its loads, counted from 0."""
    return checked_preload(case.structure, problem, case.study.preloads[number])


class Preloads:
    """The preload of a case at its loads: at all of them at once, where they can go together.

    problem: of the case, or a like one with a factorisation; made here where None.
    """

    def __init__(self, case: Case, problem: PreloadProblem | None = None) -> None:
        self.case = case
        self.problem = problem or case.structure.assembly(solver=case.study.modes.solver)
        self._found: list[PreloadState | None] | None = None

    def at(self, number: int) -> PreloadState:
        """The preload at one of the loads, counted from 0. Raises what `checked_preload` raises."""
        if self._found is None:
            self._found = self._together()
        found = self._found[number]
        if found is None:
            return solved_preload(self.case, number, self.problem)
        check_contact(self.case.structure, found.pressures, found.openings)
        return found

    def _together(self) -> list[PreloadState | None]:
        """The states at all loads; None for those that are to be found one by one, each from the one before."""
        study, structure = self.case.study, self.case.structure
        count = len(study.preloads)
        fits = 1 < count <= AT_ONCE // structure.mesh.unknowns
        if not fits or study.in_order or not self.problem.can_go_together:
            return [None] * count
        return tighten_together(structure, self.problem, [one.forces for one in study.preloads])
