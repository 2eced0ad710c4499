"""What a study's structure, or a state, does in service."""

from collections.abc import Sequence

from faying.case.case import Case
from faying.case.provenance import provenance
from faying.case.scatter import stated
from faying.case.service_bolts import service_bolts
from faying.case.solve import LoadedCase
from faying.errors import InputError
from faying.joint.modal import Vibration
from faying.joint.state import State
from faying.misuse import checked_call
from faying.result.provenance import Provenance
from faying.result.vibration import VibrationResponse
from faying.service.vibrate import Shaken, vibrate
from faying.study.vibration import Excitation


def vibrations_of(case: Case, state: LoadedCase) -> tuple[VibrationResponse, ...]:
    """The answers of a case under one preload to all that its study shakes it with."""
    structure, study = case.structure.under(state.preload), case.study
    stiffness, loss = structure.coupled(state.springs)
    base = Shaken(
        title=study.title,
        structure=structure,
        preload=state.preload,
        springs=state.springs,
        found=Vibration(modes=state.modes, damped=state.damped, stiffness=stiffness, loss=loss),
        bolts=service_bolts(structure, study),
        provenance=provenance(study),
        parts_loss=study.parts_loss,
        known=stated(study.uncertain),
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
        Stochastic averaging: the density of the amplitude of a mode whose damping depends on it, and the linear mode
        that loses as much. Roberts and Spanos 1986, doi:10.1016/0020-7462(86)90025-9.
    """
    if not excitations:
        raise InputError("excitations is empty; give excitations=[Excitation(...)]")
    base = Shaken(
        title="structure",
        structure=state.structure,
        preload=state.preload,
        springs=state.springs,
        found=state.vibration,
        bolts=service_bolts(state.structure),
        provenance=Provenance(),
    )
    return tuple(vibrate(base, one) for one in excitations)
