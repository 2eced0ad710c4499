"""Load cases on a preloaded structure: bolts, opening, slip, modes about the loaded state."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from faying.case.acting import Acting, acting, nothing
from faying.case.case import Case, Progress, bare
from faying.case.provenance import provenance
from faying.case.service_bolts import ServiceBolt, head_frictions, service_bolts
from faying.errors import InputError
from faying.fe.stress import at_outline, greatest_stresses, part_stresses
from faying.joint.bolted import BoltedStructure
from faying.joint.equilibrium import PreloadState
from faying.joint.load_path import LoadPaths
from faying.joint.modal import Engine, ModalProblem, ModesChoice
from faying.joint.preload_case import PreloadCase
from faying.joint.shared_modes import SharedModes
from faying.joint.springs import Springs
from faying.joint.state import State
from faying.joint.support_check import check_motions, checked_preload
from faying.loads.answers import NOTHING, bolt_answers, joint_answers
from faying.loads.contact import LoadedContact
from faying.loads.record import LoadCases
from faying.loads.statics import LoadedState, LoadStatics
from faying.measured.mac import Weighted
from faying.notes import Note, percent
from faying.numerics.follow import partners
from faying.numerics.shifted import Shifted
from faying.numerics.single import factorise_roughly
from faying.result.groups import OuterStress
from faying.result.provenance import Provenance
from faying.study.load import Load, in_order
from faying.study.study import Study
from faying.typing import Array
from faying.units import show

ROUNDING = 1e-9  # of the displacement under the preload


@dataclass(frozen=True, kw_only=True)
class Preloaded:
    """A structure under its preload, ready for load cases.

    Args:
        title: What results call it.
        structure, preload, springs: The structure, its equilibrium, the springs of its joints.
        factor: What solves near the stiffness with these springs.
        rest: Frequencies [Hz] and shapes (unknowns, m) of its modes; None where none are asked for.
        modes: Frequencies and shapes under other springs.
        notes: What there was to say so far.
        provenance: What it was made from.
        bolts: What is known of each bolt.
    """

    title: str
    structure: BoltedStructure
    preload: PreloadState
    springs: Sequence[Springs[Any]]
    factor: Any
    rest: tuple[Array, Any] | None
    modes: Callable[[Sequence[Springs[Any]]], tuple[Array, Any]]
    notes: tuple[Note, ...] = ()
    provenance: Provenance = field(default_factory=Provenance)
    bolts: tuple[ServiceBolt, ...]


def preloaded(study: Study, number: int, progress: Progress, *, modes: bool) -> Preloaded:
    """Solve a study at one of its preloads, counted from 0."""
    case = Case.of(bare(study), progress)
    engine = case.engine("reanalysis")
    progress.begin(f"preload {study.preloads[number].name}")
    state = engine.preload(number)
    case = case.under(state)
    springs = case.structure.springs(state.pressures)
    return preloaded_case(case, state, springs, engine, modes=modes)


def preloaded_case(
    case: Case, state: PreloadState, springs: Sequence[Springs[Any]], engine: Engine, *, modes: bool
) -> Preloaded:
    """A case under a preload that is known, ready for load cases."""
    study, structure = case.study, case.structure

    def found(under: Sequence[Springs[Any]]) -> tuple[Array, Any]:
        vibration = engine.vibrate(under)
        return vibration.damped.frequencies, vibration.damped.shapes

    rest, factor = None, None
    if modes:
        vibration = engine.vibrate(springs)
        rest, factor = (vibration.damped.frequencies, vibration.damped.shapes), vibration.modes.factorisation
    return Preloaded(
        title=study.title,
        structure=structure,
        preload=state,
        springs=springs,
        factor=factor or near_factor(structure, springs, study.modes.solver),
        rest=rest,
        modes=found,
        notes=case.notes,
        provenance=provenance(study),
        bolts=service_bolts(structure, study),
    )


def at_preload(
    base: Preloaded, study: Study, wanted: PreloadCase, structure: BoltedStructure | None = None
) -> Preloaded:
    """The same under another preload; structure: with other friction, say."""
    made = (base.structure if structure is None else structure).loaded_before(())
    problem = made.assembly(solver=study.modes.solver)
    problem.adopt_factor(base.factor, 0.0)
    preload = checked_preload(made, problem, wanted)
    made = made.under(preload)
    springs = made.springs(preload.pressures)
    return replace(base, structure=made, preload=preload, springs=springs, rest=None, notes=())


def of_state(state: State, modes: bool) -> Preloaded:
    """A state of a structure, ready for load cases; modes: whether those about loaded states are asked for."""
    structure = state.structure
    problem = ModalProblem(structure=structure, choice=ModesChoice(count=len(state.modes)))
    shared = SharedModes()

    def found(under: Sequence[Springs[Any]]) -> tuple[Array, Array]:
        result, _ = shared.of(problem, under)
        check_motions(structure, result)
        some = slice(structure.rigid_count, structure.rigid_count + problem.choice.count)
        return result.frequencies[some], result.shapes[:, some]

    return Preloaded(
        title="structure",
        structure=structure,
        preload=state.preload,
        springs=state.springs,
        factor=state.vibration.modes.factorisation,
        rest=found(state.springs) if modes else None,
        modes=found,
        notes=state.notes,
        bolts=service_bolts(structure),
    )


def near_factor(structure: BoltedStructure, springs: Sequence[Springs[Any]], solver: str | None) -> Any:
    """A factorisation near the stiffness under the springs of the joints."""
    stiffness = (structure.dynamic_matrices[0] + structure.joint_stiffness(springs)).tocsr()
    shift = (2 * np.pi * structure.shift_frequency) ** 2
    matrix = Shifted(stiffness=stiffness, mass=structure.dynamic_matrices[1], shift=shift)
    return factorise_roughly(matrix, rigid=structure.rigid, solver=structure.solver(solver))


def statics_of(base: Preloaded) -> LoadStatics:
    """Return the statics of a preloaded structure. Raises InputError for joints with springs per node."""
    structure = base.structure
    by_node = [joint.name for joint in structure.joints if joint.per_node]
    if by_node:
        raise InputError(
            f"joint {by_node[0]!r} has springs per node, which are fitted to one preload and neither open nor slip; "
            "leave springs out of the joint for load cases"
        )
    pairs = [
        (joint.interface, LoadedContact.of(joint.interface, joint.law, s, base.preload.displacement, joint.friction))
        for joint, s in zip(structure.in_service(base.preload).joints, base.springs, strict=True)
    ]
    return LoadStatics(
        stiffness=structure.coupled(base.springs)[0],
        factor=base.factor,
        elastic_forces=structure.elastic_forces,
        joints=pairs,
        displacement=base.preload.displacement,
        rigid=structure.rigid,
        fixed=structure.fixed,
    )


def solved(
    statics: LoadStatics, rest: LoadedState, loads: Sequence[Load], acts: dict[str, Acting]
) -> dict[str, list[LoadedState]]:
    """The states on the way to each case: those that start from the same place go together."""
    friction = any(contact.friction is not None for _, contact in statics.joints)
    found: dict[str, list[LoadedState]] = {}
    left = list(loads)
    while left:
        ready = [load for load in left if load.after is None or load.after in found]
        cases = []
        for load in ready:
            start = rest if load.after is None else found[load.after][-1]
            cases.append((load.name, start, acts[load.name], load.increments if friction else 1))
        for load, states in zip(ready, statics.solve(cases), strict=True):
            found[load.name] = states
        left = [load for load in left if load not in ready]
    return found


def answers(base: Preloaded, loads: tuple[Load, ...], progress: Progress) -> LoadCases:
    """Solve all cases on a preloaded structure."""
    structure = base.structure
    progress.begin("loads")
    acts = acting(structure, in_order(loads))
    statics = statics_of(base)
    contacts = [contact for _, contact in statics.joints]
    linear = dict(zip(acts, statics.linear(list(acts.values())), strict=True))
    found = solved(statics, statics.rest_state(nothing(structure)), loads, acts)
    states = [found[load.name][-1] for load in loads]
    motions = [statics.motion(state) for state in states]
    straight = [linear[load.name] for load in loads]
    dissipated = [np.sum([one.dissipated for one in found[load.name]], axis=0) for load in loads]
    paths = LoadPaths.of(structure)
    forces = np.array(base.preload.bolt_forces)
    names = [load.name for load in loads]
    starts = [None if load.after is None else names.index(load.after) for load in loads]
    arrays = bolt_answers(structure, contacts, forces, list(zip(states, motions, straight, strict=True)), starts, paths)
    arrays |= _in_service(base.bolts, forces, arrays, starts, [load.cycles for load in loads])
    arrays |= joint_answers(structure, contacts, states, dissipated, paths)
    with_linear = arrays["bolt_force"], arrays["bolt_force_linear"]
    pressures = [[-traction[:, 0] for traction in state.tractions] for state in states]
    interfaces = [joint.interface for joint in structure.joints]
    shears = [np.concatenate([np.linalg.norm(one[:, 1:], axis=1) for one in state.tractions]) for state in states]
    modes = _modes(base, loads, pressures, progress)
    return LoadCases(
        title=base.title,
        preload=float(forces[0]),
        cases=tuple(load.name for load in loads),
        after=tuple(load.after or "" for load in loads),
        bolts=tuple(bolt.name for bolt in structure.bolts),
        joints=tuple(joint.name for joint in structure.joints),
        superposition=_departure(motions, straight, with_linear, forces, base.preload.displacement),
        displacement=np.array([_greatest(one) for one in motions]),
        error=np.array([state.error for state in states]),
        bolt_preload=forces,
        friction=np.array([np.nan if one.friction is None else one.friction for one in contacts]),
        normal_preload=np.array([float(one.weights @ one.pressure) for one in contacts]),
        positions=np.concatenate([one.positions for one in interfaces]),
        areas=np.concatenate([one.weights for one in interfaces]),
        joint_of_point=np.concatenate([np.full(len(one.weights), k) for k, one in enumerate(interfaces)]),
        rest_pressure=np.concatenate([one.pressure for one in contacts]),
        pressure=np.array([np.concatenate(one) for one in pressures]),
        shear=np.array(shears),
        **_dowels(structure, motions),
        **_stress(
            structure, structure.strained(base.preload), motions, {load.name: acts[load.name].strains for load in loads}
        ),
        notes=(*base.notes, *load_notes(structure, contacts, [load.name for load in loads], pressures, arrays)),
        provenance=base.provenance,
        cycles=np.array([load.cycles for load in loads]),
        **arrays,
        **modes,
    )


def _in_service(
    bolts: Sequence[ServiceBolt],
    forces: Array,
    arrays: Mapping[str, Array],
    starts: Sequence[int | None],
    cycles: Sequence[float],
) -> dict[str, Array]:
    """Friction under heads, where they slide, and damage by cycles of the stress amplitudes (case, bolt).

    forces: Of the preload [N] (bolt,); arrays, starts: what bolts bear in each case, and which case each starts from.
    """
    pairs = list(zip(bolts, forces.tolist(), strict=True))
    stress, to = arrays["stress_amplitude"], arrays["bolt_force"]
    means = [(one + (forces if k is None else to[k])) / 2 for one, k in zip(to, starts, strict=True)]
    damage = [
        [b.damage(a, n, mean) for b, a, mean in zip(bolts, row, mean_row, strict=True)]
        for row, mean_row, n in zip(stress, means, cycles, strict=True)
    ]
    return {
        "head_friction": head_frictions(bolts),
        "slide_motion": np.array([bolt.slide_motion(force) for bolt, force in pairs]),
        "damage": np.array(damage).reshape(stress.shape),
    }


def _departure(
    motions: Sequence[Array], straight: Sequence[Array], forces: tuple[Array, Array], preload: Array, rest: Array
) -> Array:
    """How far the answers are from the linear ones, over these: of displacement or bolt forces, the greater (case,).

    forces: of the bolts [N] (case, bolt), as they are and by the linear answer.
    A change of force counts as NOTHING times the preload at least: where a load changes none, rounding is all there is.
    So it is with a displacement of ROUNDING of that under the preload. Where a load that is taken off leaves slip, the
    linear answer is none, and the departure is all of the answer: 1.
    """
    out, floor, round_off = [], NOTHING * float(preload.max(initial=0.0)), ROUNDING * _greatest(rest)
    for moved, line, here, there in zip(motions, straight, *forces, strict=True):
        size, way = _greatest(line), _greatest(moved)
        force = max(float(np.abs(there - preload).max(initial=0.0)), floor)
        apart = _greatest(moved - line) / size if size > NOTHING * way else 1.0
        by_force = float(np.abs(here - there).max(initial=0.0)) / force if force > 0 else 0.0
        out.append(max(apart if max(size, way) > round_off else 0.0, by_force))
    return np.array(out)


def _dowels(structure: BoltedStructure, motions: Sequence[Array]) -> dict[str, Any]:
    """What the dowels carry under the displacement [m] of each case; nothing where there are none."""
    fitted = structure.fitted_dowels
    if not fitted:
        return {}
    return {
        "dowels": tuple(one.dowel.name for one in fitted),
        "dowel_shear": np.array([[one.shear(motion) for one in fitted] for motion in motions]),
        "dowel_bearing": np.array([[one.bearing(motion) for one in fitted] for motion in motions]),
    }


def _stress(
    structure: BoltedStructure, rest: Array, motions: Sequence[Array], strains: Mapping[str, Mapping[str, float]]
) -> dict[str, Any]:
    """The stress under preload and the motion [m] of each case, with its heat: greatest of each part, and outside."""
    mesh, outer = structure.mesh, structure.surface()
    greatest, fields = [], []
    for one, free in zip(motions, strains.values(), strict=True):
        found = part_stresses(mesh, structure.materials, (rest + one)[:, None], free)
        greatest.append(greatest_stresses(found, mesh.points))
        fields.append(at_outline(found, len(mesh.points), outer.nodes))
    size, place, spread = (np.stack([one[k][..., 0] for one in greatest]) for k in range(3))
    surface = OuterStress.on(
        outer,
        mesh.points,
        states=tuple(strains),
        motion=np.stack([one.reshape(-1, 3)[outer.nodes] for one in motions]),
        **{name: np.concatenate([one[name] for one in fields]) for name in fields[0]},
    )
    of_parts = {"stress": size, "stress_place": place, "stress_spread": spread}
    return {"parts": tuple(mesh.parts), "surface": surface, **of_parts}


def _greatest(motion: Array) -> float:
    """The greatest displacement of a node [m]."""
    return float(np.linalg.norm(motion.reshape(-1, 3), axis=1).max())


def _modes(
    base: Preloaded, loads: Sequence[Load], pressures: Sequence[Sequence[Array]], progress: Progress
) -> dict[str, Any]:
    """Frequencies about each loaded state, each paired with the mode at rest that it is most like."""
    if base.rest is None:
        return {}
    rest, shapes = base.rest
    mass, serving = base.structure.dynamic_matrices[1], base.structure.in_service(base.preload)
    before = Weighted.of(shapes, mass)
    frequencies, alike = [], []
    for load, pressure in zip(loads, pressures, strict=True):
        progress.begin(f"modes under {load.name}")
        here, moved = base.modes(serving.springs(list(pressure)))
        table = before.mac(Weighted.of(moved, mass)).T  # columns: modes under the load
        order = partners(table)
        frequencies.append(here[order])
        alike.append(table[np.arange(len(order)), order])
    return {"rest_frequency": rest, "frequency": np.array(frequencies), "likeness": np.array(alike)}


WHOLLY = 0.999  # share of the area that touches, from which all of it slides
LITTLE = 0.01  # of a joint's normal force beyond which it is said that the load presses harder than the preload did


def load_notes(
    structure: BoltedStructure,
    contacts: Sequence[LoadedContact],
    cases: Sequence[str],
    pressures: Sequence[Sequence[Array]],
    found: Mapping[str, Array],
) -> list[Note]:
    """Return the notes on all cases; found: arrays of `LoadCases` by their names."""
    out = []
    for k, case in enumerate(cases):
        for j, (joint, contact) in enumerate(zip(structure.joints, contacts, strict=True)):
            out += _joint(case, joint.name, contact, pressures[k][j], float(found["opened"][k, j]))
            if found["sliding"][k, j] > WHOLLY:
                shear, torque = float(found["shear_force"][k, j]), float(found["torque"][k, j])
                borne = f"{show(shear, 'N')} and {show(torque, 'N*m')}"
                text = (
                    f"load {case!r}: {joint.name} slides on all of its area; friction carries {borne}, the bolts the "
                    "rest, by shear of their shanks (V)"
                )
                out.append(Note(code="load-slides", joint=joint.name, text=text))
        for b, fitted in enumerate(structure.fitted_bolts):
            out += _bolt(case, fitted.bolt, float(found["bolt_force"][k, b]))
    sticking = [joint.name for joint in structure.joints if joint.friction is None]
    if sticking:
        text = (
            f"{', '.join(sticking)} sticks everywhere under the loads, since no friction is given; the table has the "
            'friction that it needs ("mu >"). Give joint.friction to let it slip'
        )
        out.append(Note(code="loads-stick", severity="limit", text=text))
    return out


def _joint(case: str, name: str, contact: LoadedContact, pressure: Array, opened: float) -> list[Note]:
    out, weights, law = [], contact.weights, contact.law
    if not np.any(pressure > 0):
        text = f"load {case!r}: {name} opens fully; the bolts alone hold its parts together"
        out.append(Note(code="load-opens", severity="wrong", joint=name, share=1.0, text=text))
    share = float(weights @ (pressure > law.model.greatest_pressure) / weights.sum())
    if share > 0:
        text = (
            f"load {case!r}: on {percent(share)} of {name} the pressure exceeds the "
            f"{show(law.model.greatest_pressure, 'Pa')} at which {law.model.name} ends"
        )
        out.append(Note(code="beyond-law", severity="limit", joint=name, share=share, text=text))
    more = float(weights @ np.maximum(pressure - contact.pressure, 0.0))
    if law.yields and more > LITTLE * float(weights @ contact.pressure):
        text = (
            f"load {case!r}: {name} is pressed harder in places than by the preload, with {show(more, 'N')} more in "
            f"all; asperities of {law.model.name} would yield further there and close more, which the model leaves out"
        )
        out.append(Note(code="load-yields", severity="limit", joint=name, text=text))
    return out


def _bolt(case: str, bolt: object, force: float) -> list[Note]:
    fastener, name = getattr(bolt, "fastener", None), getattr(bolt, "name", "")
    if force <= 0:
        text = f"load {case!r}: bolt {name!r} has no tension left ({show(force, 'N')}); its head comes off its seat"
        return [Note(code="bolt-loose", severity="wrong", text=text)]
    if fastener is not None and force > fastener.proof_load:
        text = (
            f"load {case!r}: bolt {name!r} carries {show(force, 'N')}, more than its proof load of "
            f"{show(fastener.proof_load, 'N')}; it stretches permanently, which the model leaves out"
        )
        return [Note(code="beyond-proof", severity="wrong", load=force, text=text)]
    return []
