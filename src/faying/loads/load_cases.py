"""Load cases on a study or on a structure that is solved."""

from collections.abc import Sequence
from pathlib import Path

from faying.case.case import Progress
from faying.errors import InputError
from faying.joint.preload_case import preload_index
from faying.joint.state import State
from faying.loads.intervals import intervals_of
from faying.loads.record import LoadCases
from faying.loads.solve import answers, of_state, preloaded
from faying.misuse import checked_call
from faying.progress import Report
from faying.study.load import Load, in_order
from faying.study.study import Study

STAGES = 5  # that are reported, beside the modes of each case


@checked_call
def load_cases(
    what: Study | str | Path | State,
    loads: Sequence[Load] | None = None,
    *,
    preload: float | str | None = None,
    modes: bool = True,
    intervals: bool = False,
    report: Report | None = None,
) -> LoadCases:
    """Find what a preloaded structure does under load cases: statics with the law of its joints, friction and opening.

    Args:
        what: A study or its file, or a state that `Structure.solve` gave.
        loads: The cases; those of the study where None.
        preload: Which preload of the study, force of the first bolt [N] or text such as "8 kN"; the greatest where
            None. A state has its own.
        modes: Whether to find the modes about each loaded state.
        intervals: Whether to find 90 % intervals of bolt forces, use of friction and opening, where the preload
            scatters as [[bolt_sheet]] or [uncertain] say, and friction as [uncertain] does. For a study alone.
        report: Is called with what is being done.

    Returns:
        Forces and moments of the bolts, opening, pressure, slip, and how far superposition is from it.

    Raises:
        InputError: There is no case, a case names what is not there, a joint has springs per node, or nothing holds
            the structure against a load.
        NotConverged: The preload or a case has no equilibrium.
    """
    if isinstance(what, State):
        if preload is not None:
            raise InputError("preload: a state has its own preload; leave it out, or solve the structure under another")
        if intervals:
            raise InputError("intervals: a state has no scatter; give a study in place of it")
        if loads is None:
            raise InputError("loads: a state has no load cases of its own; give loads=[Load(...)]")
        progress = Progress(STAGES + len(loads) * modes, report)
        return answers(of_state(what, modes), tuple(loads), progress)
    plan = Study.read_bolted(what)
    found = plan.load_cases if loads is None else tuple(loads)
    number = preload_index(plan.loads, preload, names=plan.load_names)
    if not found:
        raise InputError("the study has no load case; add [[load]], or give loads=[Load(...)]")
    in_order(found)  # names its faults before anything is solved
    more = len(plan.bolts) + len(plan.joints) + 1 if intervals else 0
    progress = Progress(STAGES + len(found) * modes + more, report)
    base = preloaded(plan, number, progress, modes=modes)
    out = answers(base, found, progress)
    return intervals_of(plan, number, base, found, out, progress) if intervals else out
