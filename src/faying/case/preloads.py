"""The preload of a case at its loads."""

from faying.case.case import Case
from faying.joint.equilibrium import PreloadState
from faying.joint.preload import PreloadProblem
from faying.joint.support_check import checked_preload


def solved_preload(case: Case, number: int, problem: PreloadProblem) -> PreloadState:
    """The preload of a case at one of its loads, counted from 0."""
    return checked_preload(case.structure, problem, case.study.preloads[number])
