"""One load of a case: the preload of its joints, their springs, the modes and the response."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from faying.case.above_range import AboveRange, bonded_above_range
from faying.case.case import Case, Progress
from faying.case.level_damping import level_damping
from faying.case.response import LoadedStructure, ResponseAtLoad
from faying.fe.interface import Interface
from faying.joint.equilibrium import PreloadState
from faying.joint.modal import Engine
from faying.joint.springs import Springs
from faying.joint.state import law_notes
from faying.joint.strength import pressure_notes
from faying.joint.structure import Structure
from faying.measured.model import FullResponse
from faying.notes import Note
from faying.numerics.damped import DampedModes
from faying.numerics.modes import Modes
from faying.numerics.solve import Released
from faying.result.groups import Levels
from faying.typing import Array, Mask

Pair = tuple[Array, Array]  # frequencies [Hz] at both ends of one number


@dataclass(frozen=True, kw_only=True)
class LoadedCase:
    """A case under one preload.

    Args:
        load: preload of the first bolt [N].
        preload: the equilibrium of the joints.
        springs: stiffness and loss of each joint at its points.
        modes, damped: real modes with the springs, and complex modes with their loss.
        response: what [response] asks for; test_response: that at the points of a hammer test.
        above_range: what bonding the points beyond the end of their law makes of the modes; None where there are none.
        notes: where a law leaves its validity range, and the like.
        ends: frequencies [Hz] at 5 and 95 % of each doubt of the joints, by its name; None where none are asked for.
        levels: damping at levels of acceleration; None where none is asked for, or no joint can slip.
        outside_share: of the normal stiffness of all joints [-], where their law is outside its validity range.
        above_range_share: of their area [-], where the pressure exceeds the end of their law.
    """

    load: float
    preload: PreloadState
    springs: tuple[Springs[Interface], ...]
    modes: Modes
    damped: DampedModes
    response: ResponseAtLoad | None
    test_response: FullResponse | None
    above_range: AboveRange | None
    notes: tuple[Note, ...]
    outside_share: float
    above_range_share: float
    levels: Levels | None = None
    ends: Mapping[str, Pair] | None = None

    @property
    def law_range(self) -> Pair | tuple[None, None]:
        """Frequencies [Hz] (m,) at the ends of the range that the laws state; None twice where none states one."""
        return (self.ends or {}).get("scan", (None, None))

    @property
    def bonded_frequencies(self) -> Array:
        """Frequencies [Hz] (m,) with what is beyond the end of its law bonded."""
        return self.damped.frequencies if self.above_range is None else self.above_range.frequencies


def solve(case: Case, number: int, engine: Engine, progress: Progress, *, ranges: bool = True) -> LoadedCase:
    """Solve a case at one of its loads, counted from 0.

    ranges: whether to find the frequencies at the ends of the laws' ranges. Raises InputError where a part is held by
    nothing, NotConverged where the preload stops short.
    """
    study, structure = case.study, case.structure
    preload_case = study.preloads[number]
    load = preload_case.preload
    ranges = ranges and bool(structure.joints)
    if structure.bolts:
        progress.begin(f"preload {preload_case.name}")
    preload = engine.preload(number)
    case = case.under(preload)
    structure = case.structure
    springs = structure.springs(preload.pressures)
    progress.begin(f"modes at {preload_case.name}")
    found = engine.vibrate(springs)
    loaded = LoadedStructure(study=study, structure=structure, found=found)
    response, test_response, notes = _responses(case, number, loaded, progress)
    above_range = bonded_above_range(case, load, springs, found.damped)
    return LoadedCase(
        load=load,
        ends=_ends_of(case, preload, engine, found.modes) if ranges else None,
        levels=level_damping(case, preload, found) if ranges else None,
        preload=preload,
        springs=springs,
        modes=found.modes,
        damped=found.damped,
        response=response,
        test_response=test_response,
        above_range=above_range,
        notes=(
            *notes,
            *(() if above_range is None else above_range.notes),
            *law_notes(structure, preload, load),
            *pressure_notes(structure, preload.pressures, load),
        ),
        outside_share=_outside(structure, springs),
        above_range_share=_share(springs, [j.above_range(s) for j, s in zip(structure.joints, springs, strict=True)]),
    )


def released(state: LoadedCase) -> LoadedCase:
    """The state without its factorisation, which takes most of its memory."""
    factor = state.modes.factorisation
    gone = Released(name=factor.name, memory=factor.memory)
    return replace(state, modes=replace(state.modes, factorisation=gone, factorised=None))


def _responses(
    case: Case, number: int, loaded: LoadedStructure, progress: Progress
) -> tuple[ResponseAtLoad | None, FullResponse | None, list[Note]]:
    """What [response] asks for and what the points of a hammer test need, at one of the loads, with notes."""
    study, hammer = case.study, case.hammer
    response = test_response = None
    notes: list[Note] = []
    if study.response is not None:
        progress.begin(f"frequency response at {study.preloads[number].name}")
        response, more = loaded.response(study.response)
        notes += more
    asked = hammer is not None and number == hammer.choice.load and hammer.tested.frf is not None
    if hammer is not None and case.test_points is not None and asked:
        progress.begin("frequency response at the points of the test")
        test_response, more = hammer.response(loaded, case.test_points)
        notes += more
    return response, test_response, notes


def _share(springs: Sequence[Springs[Interface]], masks: Sequence[Mask]) -> float:
    """Share of the area of all joints where a mask of its points holds [-]; 0 without joints."""
    area = sum(float(s.interface.weights @ mask) for s, mask in zip(springs, masks, strict=True))
    return area / sum(s.interface.area for s in springs) if springs else 0.0


def _outside(structure: Structure, springs: Sequence[Springs[Interface]]) -> float:
    """Share of the normal stiffness of all joints where their law is outside its validity range [-]."""
    outside = total = 0.0
    for joint, s in zip(structure.joints, springs, strict=True):
        stiffness = s.interface.weights * s.k_n
        outside += float(stiffness @ ~joint.law.answer(s.pressure).valid)
        total += float(stiffness.sum())
    return outside / total if total > 0 else 0.0


def _ends_of(case: Case, preload: PreloadState, engine: Engine, modes: Modes) -> dict[str, Pair]:
    """Frequencies of one load at 5 and at 95 % of the range of the law that the scan makes.

    modes: at this load, whose order the frequencies have. "contact": with each half of the points of the joints, for
    the error of the mesh.
    """
    joints, out = case.structure.joints, {}

    def at(end: Literal["low", "high"]) -> Array:
        laws = [replace(joint.law, end=end) if joint.law.has_range else joint.law for joint in joints]
        springs = case.structure.with_joints(laws=laws).springs(preload.pressures)
        return engine.frequencies(springs, modes, one_way=True)

    if any(joint.law.has_range for joint in joints):
        out["scan"] = at("low"), at("high")
    if case.study.modes.intervals and not any(joint.per_node for joint in joints):
        springs = case.structure.springs(preload.pressures)
        halves = ([one.half(which) for one in springs] for which in (0, 1))
        first, second = (engine.frequencies(half, modes, one_way=False) for half in halves)
        out["contact"] = first, second
    return out
