"""Load cases on a study or on a structure that is solved.

Intervals of load cases where preload and friction scatter: first order in each input, and a check of that.

Each input moves alone to its 5 % end, on the factorisation at hand; what an answer changes by is its distance, and the
squares of the distances of independent inputs add. Uses of friction move by factors: their logarithms are taken.
The check moves all inputs together, each by its distance over the root of their number, which is the likeliest way to
the same probability.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from faying.case.case import Progress
from faying.case.scatter import of_number, preload_scatter, stated
from faying.errors import InputError
from faying.joint.preload_case import preload_index
from faying.joint.state import State
from faying.loads.record import LoadCases, LoadIntervals
from faying.loads.solve import Preloaded, answers, at_preload, of_state, preloaded
from faying.misuse import checked_call
from faying.notes import Note
from faying.progress import Report
from faying.study.keys.bolt_sheet import choice_of
from faying.study.load import Load, in_order
from faying.study.study import Study
from faying.typing import Array

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
        preload: Which preload of the study, force of the first bolt [N] or text such as "8 kN"; the last where
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


END = 0.05  # probability below the lower end of an input
SIGMAS = 1.6449  # standard deviations of a normal distribution to that end
ROUGH = 0.1  # departure of the check from first order, over the answer, from which there is a note
MIN_FRICTION_USE = 1e-3  # use of friction: of less, which is counted as this, the margin has no width


@dataclass(frozen=True, kw_only=True)
class LoadScatter:
    """One input that scatters: what it is, bolt or joint by its index, and its 5 % end over its median [-]."""

    words: str
    bolt: int | None
    joint: int | None
    end: float


def scatters_of(study: Study) -> list[LoadScatter]:
    """The preload of each bolt, and the friction of each joint of which [uncertain] says something."""
    known, out = stated(study.uncertain), []
    for k, bolt in enumerate(study.bolts):
        spread, origin = preload_scatter(study, bolt.name, choice_of(study.bolt_sheets, bolt.name))
        words = f"preload of {bolt.name} +-{spread:.0%} ({origin})"
        # the published range is two standard deviations each way
        out.append(LoadScatter(words=words, bolt=k, joint=None, end=1 - SIGMAS * spread / 2))
    for k, joint in enumerate(study.joints):
        found = of_number(known, joint.name, "friction")
        if found is not None and joint.friction:
            low, high = found.quantile(np.array([END, 1 - END]))
            words = f"friction of {joint.name} {low:.3g} to {high:.3g}"
            out.append(LoadScatter(words=words, bolt=None, joint=k, end=float(low) / joint.friction))
    return out


def intervals_of(
    study: Study, number: int, base: Preloaded, loads: tuple[Load, ...], found: LoadCases, progress: Progress
) -> LoadCases:
    """Return load cases with their intervals.

    Args:
        study: The study.
        number: Which of its preloads, from 0.
        base: The preloaded structure.
        loads: The cases.
        found: Their answers at the median of every input.
        progress: Is told of each evaluation.
    """
    inputs = scatters_of(study)
    rest = _answers(found)
    change = []
    for one in inputs:
        progress.begin(f"loads at the 5 % end of the {one.words.partition(' +-')[0]}")
        change.append([a - b for a, b in zip(_moved(study, number, base, loads, [one], 1.0), rest, strict=True)])
    width = [np.sqrt(np.sum([some[k] ** 2 for some in change], axis=0)) for k in range(len(rest))]
    progress.begin("check of the intervals")
    share = 1 / np.sqrt(len(inputs))
    together = _moved(study, number, base, loads, inputs, share)
    straight = [one + share * np.sum([some[k] for some in change], axis=0) for k, one in enumerate(rest)]
    apart = [np.abs(np.nan_to_num(here - line)) for here, line in zip(together, straight, strict=True)]
    apart[0] = apart[0] / np.abs(rest[0])
    off = np.max([one.max(axis=1) for one in apart], axis=0)
    force, slip, head, opened = (np.stack([one - half, one + half]) for one, half in zip(rest, width, strict=True))
    intervals = LoadIntervals(
        inputs=tuple(one.words for one in inputs),
        bolt_force=force,
        slip_use=np.exp(slip) * _use_factor(found.friction_needed_worst / found.friction),
        head_use=np.exp(head) * _use_factor(found.head_friction_needed / found.head_friction),
        opened=np.clip(opened, 0.0, 1.0),
        check=off,
    )
    notes = found.notes
    if off.max(initial=0.0) > ROUGH:
        case = found.cases[int(np.argmax(off))]
        text = (
            f"load {case!r}: where all inputs scatter together, an answer departs from first order by "
            f"{off.max():.0%}; the intervals are rough there"
        )
        notes = (*notes, Note(code="load-intervals", severity="limit", text=text))
    return replace(found, intervals=intervals, notes=notes)


def _answers(found: LoadCases) -> list[Array]:
    """What has an interval: force of bolts, log of the use of friction in joints and under heads, share that opens."""
    slip = found.friction_needed_worst / found.friction
    head = found.head_friction_needed / found.head_friction
    return [
        found.bolt_force,
        np.log(np.maximum(slip, MIN_FRICTION_USE)),
        np.log(np.maximum(head, MIN_FRICTION_USE)),
        found.opened,
    ]


def _use_factor(use: Array) -> Array:
    """1, or a use of friction over the least one of which the logarithm is taken [-]."""
    return np.asarray(np.minimum(use / MIN_FRICTION_USE, 1.0))


def _moved(
    study: Study, number: int, base: Preloaded, loads: tuple[Load, ...], inputs: Sequence[LoadScatter], share: float
) -> list[Array]:
    """The same answers with inputs moved by a share of the way to their ends."""
    forces, friction = np.array(study.preloads[number].forces), [joint.friction for joint in base.structure.joints]
    for one in inputs:
        factor = 1 + share * (one.end - 1)
        if one.bolt is not None:
            forces[one.bolt] *= factor
        else:
            assert one.joint is not None
            friction[one.joint] = (friction[one.joint] or 0.0) * factor
    wanted = replace(study.preloads[number], forces=tuple(forces.tolist()))
    moved = at_preload(base, study, wanted, base.structure.with_joints(friction=friction))
    return _answers(answers(moved, loads, Progress(0)))
