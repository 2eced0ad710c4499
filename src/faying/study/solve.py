"""One load of a case: the preload of its joints, their springs, the modes and the response."""

from dataclasses import dataclass

import numpy as np

from faying.fe.damped import DampedModes, damped_modes
from faying.fe.interface import Interface
from faying.fe.modes import Modes, lowest_modes
from faying.joint.equilibrium import PreloadState
from faying.joint.preload import PreloadProblem
from faying.joint.springs import Springs
from faying.joint.structure import Structure
from faying.joint.support_check import check_motions, checked_preload, open_joints
from faying.measured.model import FullResponse
from faying.notes import Note
from faying.study.case import Case, Progress
from faying.study.response import LoadedStructure, ResponseAtLoad
from faying.study.strength import pressure_notes


@dataclass(frozen=True, kw_only=True)
class State:
    """A case under one preload.

    Args:
        load: preload of the first bolt [N].
        preload: the equilibrium of the joints.
        springs: stiffness and loss of each joint at its points.
        modes, damped: real modes with the springs, and complex modes with their loss.
        response: what [response] asks for; test_response: that at the points of a hammer test.
        notes: where a law leaves its validity range, and the like.
    """

    load: float
    preload: PreloadState
    springs: tuple[Springs[Interface], ...]
    modes: Modes
    damped: DampedModes
    response: ResponseAtLoad | None
    test_response: FullResponse | None
    notes: tuple[Note, ...]


def solve(case: Case, number: int, problem: PreloadProblem, progress: Progress) -> State:
    """Solve a case at one of its loads, counted from 0; the preload problem starts from the load before.

    Raises InputError where a part is held by nothing, NotConverged where the preload stops short.
    """
    study, structure = case.study, case.structure
    load = study.loads[number]
    progress.begin(f"preload {load / 1e3:g} kN")
    preload = checked_preload(structure, problem, study.forces(number), order=study.order)
    springs = structure.springs(preload.pressures)
    progress.begin(f"modes at {load / 1e3:g} kN")
    stiffness, loss = structure.joined(springs, viscous=study.modes.damping == "viscous")
    mass = structure.vibrating[1]
    modes = lowest_modes(
        stiffness, mass, case.mode_count, shift_frequency=case.shift_frequency, solver=study.modes.solver
    )
    check_motions(structure, modes)
    damped = damped_modes(
        modes,
        stiffness,
        mass,
        loss,
        rigid=case.rigid_count,
        count=study.modes.count,
        kind=study.modes.damping,
    )
    loaded = LoadedStructure(
        study=study, structure=structure, modes=modes, damped=damped, stiffness=stiffness, mass=mass, loss=loss
    )
    response = test_response = None
    notes: list[Note] = []
    if study.response is not None:
        progress.begin(f"frequency response at {load / 1e3:g} kN")
        response, more = loaded.response(study.response)
        notes += more
    hammer = case.hammer
    if hammer is not None and case.test_points is not None and number == hammer.choice.load and hammer.has_frf:
        progress.begin("frequency response at the points of the test")
        test_response, more = hammer.response(loaded, case.test_points)
        notes += more
    return State(
        load=load,
        preload=preload,
        springs=springs,
        modes=modes,
        damped=damped,
        response=response,
        test_response=test_response,
        notes=(
            *notes,
            *law_notes(structure, preload, load),
            *pressure_notes(structure, preload.pressures, load),
        ),
    )


def law_notes(structure: Structure, preload: PreloadState, load: float) -> list[Note]:
    """Say where contact is lost and where a law leaves its validity range, with the share of the joint's area."""
    kilo = f"{load / 1e3:g} kN"
    out = [
        Note(code="open", joint=name, load=load, text=f"{name}, {kilo}: no contact is left; the joint carries nothing")
        for name in open_joints(structure, preload.pressures)
    ]
    for joint, pressure in zip(structure.joints, preload.pressures, strict=True):
        model, weights, area = joint.law.model, joint.interface.weights, joint.interface.area
        end = model.greatest_pressure
        if np.any(pressure > end):
            share = float(weights @ (pressure > end) / area)
            text = (
                f"{joint.name}, {kilo}: on {share:.2%} of the joint the pressure exceeds the {end / 1e6:.3g} MPa at "
                f"which "
                f"{model.name} ends with this surface; stiffness is held there"
            )
            out.append(Note(code="beyond-law", joint=joint.name, load=load, share=share, text=text))
        answer = joint.law.answer(pressure)
        if answer.loss_n is None and answer.loss_t is None:
            text = f"{joint.name}: {model.name} defines no loss; the joint damps nothing"
            out.append(Note(code="no-loss", joint=joint.name, text=text))
        for reason, mask in answer.reasons.items():
            share = float(weights @ mask / area)
            if share > 0:
                where = f"{model.name} is outside its validity range on {share:.0%} of the joint"
                text = f"{joint.name}, {kilo}: {where}: {reason}"
                out.append(Note(code="outside-validity", joint=joint.name, load=load, share=share, text=text))
    return out
