"""The same structure under other laws: what [[beside]] asks for."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying.errors import FayingError
from faying.notes import Note
from faying.study.case import Case, Progress, joint_law, law_reasons, materials_at, surfaces_of
from faying.study.keys.beside import BesideChoice
from faying.study.solve import State, solve
from faying.typing import Array

TOLD = ("open", "beyond-law", "outside-validity", "law-choice", "assumed")  # notes of the other law that are told


@dataclass(frozen=True, kw_only=True)
class Beside:
    """A case under another law.

    Args:
        name: what tables call it.
        case: the case with that law; None where it could not be made.
        states: one for each load; empty where there was no answer.
        notes: what there is to say of it.
    """

    name: str
    case: Case | None
    states: tuple[State, ...]
    notes: tuple[Note, ...]


def solve_beside(case: Case, choice: BesideChoice, progress: Progress) -> Beside:
    """Solve a case under another law on all joints, at all loads, without meshing anew."""
    done = progress.done
    try:
        other = _changed(case, choice)
        problem = other.structure.assembly(solver=case.study.modes.solver)
        states = tuple(solve(other, number, problem, progress) for number in range(len(case.study.loads)))
    except FayingError as fault:
        progress.done = done + 2 * len(case.study.loads)
        text = f"{choice.name} beside: no answer: {fault}"
        return Beside(name=choice.name, case=None, states=(), notes=(Note(code="beside", text=text),))
    notes = [*law_reasons(other.structure, other.surfaces), *(note for state in states for note in state.notes)]
    told = tuple(replace(note, text=f"{choice.name} beside: {note.text}") for note in notes if note.code in TOLD)
    return Beside(name=choice.name, case=other, states=states, notes=tuple(dict.fromkeys(told)))


def _changed(case: Case, choice: BesideChoice) -> Case:
    """The case under another law, with the same mesh and what is assembled on it."""
    study = case.study
    joints = tuple(
        replace(
            joint,
            law=choice.law or joint.law,
            surface=choice.surface or joint.surface,
        )
        for joint in study.joints
    )
    study = replace(study, joints=joints, response=None, hammer=None)
    surfaces = surfaces_of(study)
    mesh = case.structure.mesh
    placed = []
    for joint, old, surface in zip(joints, case.structure.joints, surfaces, strict=True):
        law = joint_law(joint, study.law_of(joint), surface, *materials_at(study, mesh, joint))
        placed.append(replace(old, law=law, scan_area=surface.scan_area))
    structure = replace(case.structure, joints=tuple(placed))
    return replace(case, study=study, structure=structure, surfaces=surfaces, hammer=None, test_points=None, notes=())


def stacked(besides: Sequence[Beside], what: str, loads: int, modes: int) -> Array | None:
    """Frequencies [Hz] or loss factors [-] of all (b, loads, modes), NaN where there was none; None without any."""
    if not besides:
        return None
    out = np.full((len(besides), loads, modes), np.nan)
    for row, beside in zip(out, besides, strict=True):
        joints = () if beside.case is None else beside.case.structure.joints
        if what == "frequencies" or any(joint.law.predicts_loss for joint in joints):
            for k, state in enumerate(beside.states):
                row[k] = getattr(state.damped, what)
    return out
