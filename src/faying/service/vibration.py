"""What a study's structure, or a state, does in service."""

from collections.abc import Sequence

from faying.bolt.bolt import Bolt
from faying.bolt.fatigue import FatigueCurve
from faying.bolt.vdi2230 import DEFAULT_FRICTION
from faying.case.case import Case
from faying.case.provenance import provenance
from faying.case.solve import LoadedCase
from faying.errors import InputError
from faying.joint.bolted import BoltedStructure
from faying.joint.modal import Vibration
from faying.joint.state import State
from faying.misuse import checked_call
from faying.result.provenance import Provenance
from faying.result.vibration import VibrationResponse
from faying.service.vibrate import Shaken, ShakenBolt, vibrate
from faying.study.keys.bolt_sheet import BoltSheetChoice, choice_of
from faying.study.vibration import Excitation


def vibrations_of(case: Case, state: LoadedCase) -> tuple[VibrationResponse, ...]:
    """The answers of a case under one preload to all that its study shakes it with."""
    structure, study = case.structure, case.study
    stiffness = (structure.dynamic_matrices[0] + structure.joint_stiffness(state.springs)).tocsr()
    base = Shaken(
        title=study.title,
        structure=structure,
        preload=state.preload,
        springs=state.springs,
        found=Vibration(modes=state.modes, damped=state.damped, stiffness=stiffness, loss=None),
        bolts=_bolts(structure, [choice_of(study.bolt_sheets, bolt.name) for bolt in study.bolts]),
        provenance=provenance(study),
    )
    return tuple(vibrate(base, one) for one in study.vibrations)


@checked_call
def vibration(state: State, excitations: Sequence[Excitation]) -> tuple[VibrationResponse, ...]:
    """What a preloaded structure does under random vibration or sine sweeps; `run` does the same for a study.

    Args:
        state: The structure under its preload, of `Structure.solve`.
        excitations: What shakes it.

    Returns:
        One answer for each.

    Raises:
        InputError: Nothing holds the structure against an excitation, or a face or a point is not there.

    Source:
        Equivalent linearisation by the balance of power over Rayleigh's distribution of the amplitude: Roberts and
        Spanos 2003, Random Vibration and Statistical Linearization, chapter 8.
    """
    if not excitations:
        raise InputError("excitations is empty; give excitations=[Excitation(...)]")
    base = Shaken(
        title="structure",
        structure=state.structure,
        preload=state.preload,
        springs=state.springs,
        found=state.vibration,
        bolts=_bolts(state.structure, [BoltSheetChoice()] * len(state.structure.bolts)),
        provenance=Provenance(),
    )
    return tuple(vibrate(base, one) for one in excitations)


def _bolts(structure: BoltedStructure, choices: Sequence[BoltSheetChoice]) -> tuple[ShakenBolt, ...]:
    """What friction and fatigue need of each bolt; what its sheet says comes before its own."""
    out = []
    for fitted, choice in zip(structure.fitted_bolts, choices, strict=True):
        bolt, friction, size = fitted.bolt, DEFAULT_FRICTION, None
        if isinstance(bolt, Bolt):
            friction = DEFAULT_FRICTION if bolt.friction is None else bolt.friction[1]
            size = bolt.diameter if bolt.metric is None else bolt.metric.diameter
        friction = friction if choice.head_friction is None else choice.head_friction
        curve = None if size is None else FatigueCurve.iec(size) if choice.fatigue == "iec" else FatigueCurve.vdi(size)
        out.append(ShakenBolt(head_friction=friction, fatigue=curve))
    return tuple(out)
