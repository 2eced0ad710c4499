"""The same structure under other laws and forms: what [[alternative]] asks for."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from faying.case.case import Case, Progress, interface_of, joint_law, law_reasons, materials_at, surfaces_of
from faying.case.solve import LoadedCase, released, solve
from faying.errors import FayingError
from faying.notes import OF_ALTERNATIVE, Note
from faying.result.groups import Alternatives
from faying.study.keys.alternative import AlternativeChoice
from faying.study.study import Study

KEPT_NOTES = ("open", "beyond-law", "outside-validity", "law-choice", "assumed")  # notes of the other law that are told


@dataclass(frozen=True, kw_only=True)
class Alternative:
    """A case under another law.

    Args:
        name: what tables call it.
        case: the case with that law; None where it could not be made.
        states: one for each load; empty where there was no answer.
        notes: what there is to say of it.
    """

    name: str
    case: Case | None
    states: tuple[LoadedCase, ...]
    notes: tuple[Note, ...]


def solve_alternative(case: Case, choice: AlternativeChoice, engine: str, progress: Progress) -> Alternative:
    """Solve a case under another law on all joints, at all loads, without meshing anew.

    engine: name of the one that solves it.
    """
    done = progress.done
    try:
        other = changed(case, choice)
        solver, loads = other.engine(engine), range(len(case.study.loads))
        states = tuple(released(solve(other, k, solver, progress, ranges=False)) for k in loads)
    except FayingError as fault:
        progress.done = done + 2 * len(case.study.loads)
        text = f"{OF_ALTERNATIVE}{choice.name}: no answer: {fault}"
        return Alternative(name=choice.name, case=None, states=(), notes=(Note(code="alternative", text=text),))
    notes = [*law_reasons(other.structure, other.surfaces), *(note for state in states for note in state.notes)]
    other_notes = tuple(
        replace(note, text=f"{OF_ALTERNATIVE}{choice.name}: {note.text}")
        for note in notes
        if note.code in KEPT_NOTES and note not in case.notes
    )
    return Alternative(name=choice.name, case=other, states=states, notes=tuple(dict.fromkeys(other_notes)))


def study_with(study: Study, choice: AlternativeChoice) -> Study:
    """The study with another law, surface or form on all joints."""
    given = {name: getattr(choice, name) for name in ("law", "surface", "form")}
    own = {name: value for name, value in given.items() if value is not None}
    joints = tuple(replace(joint, **own) for joint in study.joints)
    return replace(study, joints=joints, response=None, hammer=None)


def changed(case: Case, choice: AlternativeChoice) -> Case:
    """The case under another law or form, with the same mesh and what is assembled on it."""
    study = study_with(case.study, choice)
    surfaces = surfaces_of(study, case.read)
    mesh = case.structure.mesh
    placed = []
    for joint, old, surface in zip(study.joints, case.structure.joints, surfaces, strict=True):
        law = joint_law(joint, study.law_of(joint), surface, *materials_at(study, mesh, joint))
        interface = old.interface if choice.form is None else interface_of(study, mesh, joint, surface)[0]
        placed.append(replace(old, law=law, scan_area=surface.scan_area, interface=interface))
    structure = replace(case.structure, joints=tuple(placed))
    return replace(case, study=study, structure=structure, surfaces=surfaces, hammer=None, test_points=None, notes=())


def of_alternatives(alternatives: Sequence[Alternative], loads: int, modes: int) -> Alternatives | None:
    """What the result has of the other laws, NaN where one has no answer; None without any."""
    if not alternatives:
        return None
    nothing, alone = np.full((loads, modes), np.nan), np.full(loads, np.nan)
    rows: dict[str, list[Any]] = {}
    for other in alternatives:
        joints, states = () if other.case is None else other.case.structure.joints, other.states
        lossless = other.case is None or not other.case.structure.predicts_loss
        found = {
            "frequencies": np.stack([s.damped.frequencies for s in states]) if states else nothing,
            "loss_factors": nothing if lossless else np.stack([s.damped.loss_factors for s in states]),
            "above_range_frequencies": np.stack([s.bonded_frequencies for s in states]) if states else nothing,
            "outside_share": np.array([s.outside_share for s in states]) if states else alone,
            "above_range_share": np.array([s.above_range_share for s in states]) if states else alone,
            "reach": min((joint.law.model.greatest_pressure for joint in joints), default=np.nan),
        }
        for name, value in found.items():
            rows.setdefault(name, []).append(value)
    stacked = {name: np.stack(values) for name, values in rows.items()}
    return Alternatives(names=tuple(other.name for other in alternatives), **stacked)
