"""From a study to its result."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from faying.answer.bolt_numbers import bolt_numbers, conductances
from faying.answer.findings import against_exact_contact, falling
from faying.answer.interval import intervals
from faying.answer.refine import refined, tolerance_of
from faying.answer.tracks import compared, encounters, macs, shapes_of
from faying.backbones.backbone import backbones_of, friction_of
from faying.bolt.bolt import FittedBolt
from faying.case.alternative import Alternative, of_alternatives, solve_alternative
from faying.case.bounds import Bounds, bounds
from faying.case.case import Case, Progress
from faying.case.level_damping import level_notes
from faying.case.mesh_error import mesh_error, mesh_notes
from faying.case.provenance import provenance
from faying.case.scatter import in_intervals
from faying.case.solve import LoadedCase, released, solve
from faying.errors import NotConverged
from faying.fe.stress import at_outline, greatest_stresses, part_stresses
from faying.joint.structure import Structure
from faying.misuse import checked_call
from faying.notes import Note
from faying.numerics.follow import between_by_rank
from faying.progress import Report
from faying.result import BoltNumbers, MeasuredComparison, Receptance, Result
from faying.result.fields import declared
from faying.result.groups import BondedAboveRange, Levels
from faying.result.vibration import VibrationResponse
from faying.service.vibration import vibrations_of
from faying.study.study import Study
from faying.text import listed
from faying.typing import Array, Index

NOT_ZERO = 1e-3  # of the first frequency: a rigid motion above it has cost 1e-6 of that mode's eigenvalue, and is noted


@checked_call
def run(
    study: Study | str | Path,
    *,
    report: Report | None = None,
    engine: str = "reanalysis",
    refine: float | str | None = None,
) -> Result:
    """Run a study from the surface to the modes.

    Args:
        study: a Study or the path of its TOML file.
        report: called with (stage, stages done, stages in all) as each stage begins.
        engine: "reanalysis", one factorisation for many states; or "direct", one for each Newton step and each set of
            modes, to check the other by.
        refine: estimated error of every frequency by the mesh, such as 0.002 or "0.2 %", to which the parts are meshed
            finer and run again; None for the size that the study gives.

    Returns:
        The result; nothing is written.

    Raises:
        InputError, ReadError: what the study gives cannot be used.
        NotConverged: an iteration stops short.
    """
    study = Study.read(study)
    if refine is not None:
        return refined(study, tolerance_of(refine), lambda finer: run(finer, report=report, engine=engine))
    if study.backbone is not None:
        friction_of(study, study.backbone)  # raises, before the work, where nothing can slip
    progress = Progress(len(stages(study)), report)
    case = Case.of(study, progress)
    solver = case.engine(engine)
    states = [solve(case, number, solver, progress) for number in range(len(study.loads))]
    vibrations: list[VibrationResponse] = []
    for state, load in zip(states, study.preloads, strict=True) if study.vibrations else ():
        progress.begin(f"vibration at {load.name}")
        vibrations += vibrations_of(case, state)
    del solver  # its basis and, below, the factorisation of the states: memory is short
    progress.begin("intervals and bolts")
    mesh = mesh_error(case, states) if study.modes.intervals else None
    waves, interval, more = intervals(case, states, mesh)
    more += mesh_notes(study, mesh) if study.modes.intervals else []
    shapes = shapes_of(case, states)
    bolts, bolt_notes = _bolts(case, states, shapes)
    states = [released(state) for state in states]
    alternatives = [solve_alternative(case, choice, engine, progress) for choice in study.alternatives]
    if study.joints:
        progress.begin("modes free and bonded")
    ends, notes = bounds(case)
    notes = [*notes, *falling(case, states), *against_exact_contact(case, states[0]), *more, *bolt_notes]
    notes += [note for one in vibrations for note in one.notes]
    result = replace(
        collect(case, states, shapes, ends, notes, alternatives),
        waves=waves,
        interval=None if interval is None else interval.between(*ends),
        mesh_error=None if mesh is None else mesh.total,
        bolt_numbers=bolts,
        vibrations=tuple(vibrations),
    )
    if study.backbone is None:
        return result
    progress.begin(f"mode {study.backbone.mode} over amplitude")
    curves = backbones_of(case, study.backbone)
    every = (*result.notes, *(note for curve in curves for note in curve.notes))
    return replace(result, backbones=curves, notes=tuple(dict.fromkeys(every)))


def stages(study: Study) -> list[str]:
    """The stages that `run` reports for a study, in their order."""
    loads = [one.name for one in study.preloads]
    out = [] if study.hammer is None else ["hammer test"]
    out += ["surface", "mesh"]
    for number, load in enumerate(loads):
        out += [f"preload {load}"] * bool(study.bolts) + [f"modes at {load}"]
        out += [f"frequency response at {load}"] if study.response is not None else []
        if study.hammer is not None and number == study.hammer.load:
            out.append("frequency response at the points of the test")
    out += [f"vibration at {load}" for load in loads] if study.vibrations else []
    out.append("intervals and bolts")
    out += [stage for _ in study.alternatives for load in loads for stage in (f"preload {load}", f"modes at {load}")]
    out += ["modes free and bonded"] * bool(study.joints)
    return out if study.backbone is None else [*out, f"mode {study.backbone.mode} over amplitude"]


def collect(
    case: Case,
    states: Sequence[LoadedCase],
    shapes: Sequence[Array],
    bounds: Bounds,
    notes: Sequence[Note],
    alternatives: Sequence[Alternative] = (),
) -> Result:
    """Stack the states of a case into its result.

    Args:
        case, states: the case and its state under each load.
        shapes: of the modes (m, nodes, 3) under each load.
        bounds: frequencies [Hz] with the faces apart and with them bonded; None twice without joints.
        notes: what is to be said beyond the notes of case and states.
        alternatives: the same under other laws.
    """
    study, structure = case.study, case.structure
    steps, with_first = macs(case, states)
    comparison, more = compared(case, states, shapes, steps)
    if comparison is not None and alternatives:
        comparison = replace(comparison, alternatives=np.stack([_predicted(b, comparison) for b in alternatives]))
    lossless = not structure.predicts_loss
    carried = np.array([one.carried for one in study.preloads])
    rigid = np.max([s.modes.frequencies[: case.rigid_count] for s in states], axis=0)
    first = states[0].modes.frequencies[case.rigid_count]
    every = [*case.notes, *(note for s in states for note in s.notes), *notes, *more]
    every += encounters(states, steps)
    every += level_notes(case, [state.levels for state in states])
    every += [*(note for b in alternatives for note in b.notes), *_closing_notes(study, rigid, first)]
    way = structure.solver(study.modes.solver)
    result = Result(
        title=study.title,
        loads=case.loads,
        carried=carried if np.any(carried) else None,
        settled=study.is_settled,
        free=bounds[0],
        bonded=bounds[1],
        rigid=rigid,
        mac=with_first,
        **_at_loads(states, lossless, bounds),
        levels=_at_levels(states),
        above_range=_bonded_above_range(states, lossless),
        **_at_points(states),
        **_on_faces(structure, states),
        **_outline(structure, shapes, states),
        **_made_of(structure),
        **_dowels(structure, states),
        alternatives=of_alternatives(alternatives, len(states), study.modes.count),
        joints=tuple(j.name for j in structure.joints),
        bolts=tuple(bolt.name for bolt in study.bolts),
        unknowns=structure.mesh.unknowns,
        solver=way if isinstance(way, str) else way.key,
        factor_memory=max(s.modes.factorisation.memory for s in states),
        damping=study.modes.damping,
        tightening=tuple(study.bolts[i].name for i in study.preloads[0].order or ()),
        surfaces=tuple(surface.facts() for surface in case.surfaces),
        laws=tuple(joint.law.model.facts() for joint in structure.joints),
        sources=_sources(case),
        notes=tuple(dict.fromkeys(every)),
        response=_response(study, states),
        comparison=comparison,
        **conductances(case, states),
        provenance=provenance(study),
    )
    if case.hammer is None:
        return result
    full = next((s.test_response for s in states if s.test_response is not None), None)
    return replace(result, hammer=case.hammer.compared(result, full))


def _bolts(case: Case, states: Sequence[LoadedCase], shapes: Sequence[Array]) -> tuple[BoltNumbers | None, list[Note]]:
    try:
        return bolt_numbers(case, states, shapes), []
    except NotConverged as fault:
        return None, [Note(code="bolt-numbers", text=f"no compliance and load factor of the bolts: {fault}")]


def _predicted(other: Alternative, comparison: MeasuredComparison) -> Array:
    """Frequencies [Hz] that another law predicts of the test's modes; NaN where it has no answer."""
    if other.case is not None:
        case, states = other.case, other.states
        found, _ = compared(case, states, shapes_of(case, states), macs(case, states)[0])
        if found is not None:
            return found.predicted
    return np.full(comparison.frequencies.shape, np.nan)


def _at_loads(states: Sequence[LoadedCase], lossless: bool, bounds: Bounds) -> dict[str, Any]:
    """Fields of the result that have a value or a row for each load.

    The ends of the range of a law lie between the frequencies of free and of bonded faces, as stiffness raises each of
    them: where the basis of the ends misses that, the bound is the end.
    """
    ranges = [(low, high) for low, high in (s.law_range for s in states) if low is not None and high is not None]
    ends: list[Array | None] = [None, None]
    if len(ranges) == len(states) and bounds[0] is not None:
        ends = [between_by_rank(np.stack(rows), *bounds) for rows in zip(*ranges, strict=True)]
    return {
        "frequencies": np.stack([s.damped.frequencies for s in states]),
        "loss_factors": np.stack([np.where(lossless, np.nan, s.damped.loss_factors) for s in states]),
        "loss_error": np.stack([s.damped.error for s in states]),
        "low": ends[0],
        "high": ends[1],
        "outside_share": np.array([s.outside_share for s in states]),
        "above_range_share": np.array([s.above_range_share for s in states]),
        "bolt_forces": np.array([s.preload.bolt_forces for s in states]),
        "imbalance": np.array([s.preload.imbalance for s in states]),
        "newton_steps": np.array([s.preload.newton_steps for s in states]),
    }


def _at_levels(states: Sequence[LoadedCase]) -> Levels | None:
    """What the states have at levels of acceleration; None where one of them has nothing."""
    found = [one for state in states if (one := state.levels) is not None]
    if len(found) < len(states):
        return None
    of_loads = [name for name, meta in declared(Levels).items() if "load" in meta.dims]
    return replace(found[0], **{name: np.concatenate([getattr(one, name) for one in found]) for name in of_loads})


def _outline(structure: Structure, shapes: Sequence[Array], states: Sequence[LoadedCase]) -> dict[str, Any]:
    """Fields of the result on the outer surface, and the stress of the parts."""
    outer, mass = structure.surface(), structure.dynamic_matrices[1]
    lagging = [s.damped.scaled_shapes(mass)[1].T.reshape(len(s.damped.frequencies), -1, 3) for s in states]
    return {
        "outline": structure.mesh.points[outer.nodes],
        "triangles": outer.triangles,
        "part_of_triangle": outer.part_of_triangle,
        "face_of_triangle": outer.face_of_triangle,
        "faces": outer.faces,
        "shapes": np.stack([shape[:, outer.nodes] for shape in shapes]),
        "shapes_imaginary": np.stack([shape[:, outer.nodes] for shape in lagging]),
        **_stress(structure, states, outer.nodes),
    }


def _made_of(structure: Structure) -> dict[str, Any]:
    """Fields of the result that say what the structure is made of."""
    bolts = structure.fitted_bolts
    extents = [bolt.pressed[0].diameters if isinstance(bolt, FittedBolt) else (np.nan, np.nan) for bolt in bolts]
    return {
        "parts": tuple(structure.mesh.parts),
        "part_masses": structure.part_masses,
        "joint_faces": tuple(joint.faces for joint in structure.joints),
        "supports": structure.supports,
        "masses": structure.masses,
        "bolt_seats": np.array([bolt.seats for bolt in bolts]).reshape(-1, 2, 3),
        "bolt_diameters": np.array([bolt.bolt.diameter or np.nan for bolt in bolts]),
        "bolt_extents": np.array(extents).reshape(-1, 2),
    }


def _dowels(structure: Structure, states: Sequence[LoadedCase]) -> dict[str, Any]:
    """Fields of the result that say of the dowels where they are and what they carry; nothing where there are none."""
    fitted = structure.fitted_dowels
    if not fitted:
        return {}
    return {
        "dowels": tuple(one.dowel.name for one in fitted),
        "dowel_ends": np.array([one.seats for one in fitted]),
        "dowel_diameters": np.array([one.place.diameter for one in fitted]),
        "dowel_shear": np.array([[one.shear(s.preload.displacement) for one in fitted] for s in states]),
    }


def _stress(structure: Structure, states: Sequence[LoadedCase], nodes: Index) -> dict[str, Any]:
    """Fields of the result that say what the preload does to the parts, and to these nodes of the outer surface."""
    moved = np.stack([structure.strained(s.preload) for s in states], axis=1)
    found = part_stresses(structure.mesh, structure.materials, moved)
    size, place, spread = greatest_stresses(found, structure.mesh.points)
    return {
        **at_outline(found, len(structure.mesh.points), nodes),
        "stress": size.T,
        "stress_place": np.moveaxis(place, 2, 0),
        "stress_spread": spread.T,
    }


def _on_faces(structure: Structure, states: Sequence[LoadedCase]) -> dict[str, Any]:
    def at_springs(k: int, values: Array) -> Array:
        joint, springs = structure.joints[k], states[0].springs[k]
        return joint.interface.to_nodes(springs.interface, values) if joint.per_node else values

    interfaces = [joint.interface for joint in structure.joints]
    slips = [[np.linalg.norm(i.slip(s.preload.displacement), axis=1) for i in interfaces] for s in states]
    return {
        "gap": _joined(at_springs(k, i.gap) for k, i in enumerate(interfaces)),
        "slip": np.stack([_joined(at_springs(k, one) for k, one in enumerate(row)) for row in slips]),
    }


def _at_points(states: Sequence[LoadedCase]) -> dict[str, Any]:
    """Fields of the result at the points of the joints, and their sums over each joint."""
    interfaces = [spring.interface for spring in states[0].springs]
    totals = np.array([[spring.total() for spring in s.springs] for s in states]).reshape(len(states), -1, 2)
    return {
        "points": _joined(i.positions.ravel() for i in interfaces).reshape(-1, 3),
        "weights": _joined(i.weights for i in interfaces),
        "joint_of_point": _joined(np.full(len(i.weights), k) for k, i in enumerate(interfaces)),
        "pressure": np.stack([_joined(spring.pressure for spring in s.springs) for s in states]),
        "k_n": np.stack([_joined(spring.k_n for spring in s.springs) for s in states]),
        "k_t": np.stack([_joined(spring.k_t for spring in s.springs) for s in states]),
        "slipping": np.array([s.preload.slipping for s in states]),
        "total_k_n": totals[:, :, 0],
        "total_k_t": totals[:, :, 1],
    }


def _joined(of_joints: Iterable[Array]) -> Array:
    """What all joints have, one after the other (q,)."""
    return np.concatenate([np.zeros(0), *of_joints])


def _bonded_above_range(states: Sequence[LoadedCase], lossless: bool) -> BondedAboveRange | None:
    """Frequencies and loss factors with what is beyond the end of a law bonded, where anything is at any load."""
    if all(s.above_range is None for s in states):
        return None
    losses = [(s.above_range or s.damped).loss_factors for s in states]
    return BondedAboveRange(
        frequencies=np.stack([s.bonded_frequencies for s in states]),
        loss_factors=np.stack([np.where(lossless, np.nan, loss) for loss in losses]),
    )


def _response(study: Study, states: Sequence[LoadedCase]) -> Receptance | None:
    found = [s.response for s in states if s.response is not None]
    if study.response is None or not found:
        return None
    sides = {
        f"{side}_{what}": np.array([pair[k] for pair in pairs])
        for side, pairs in (("input", study.response.inputs), ("output", study.response.outputs))
        for k, what in enumerate(("points", "directions"))
    }
    return Receptance(
        frequencies=found[0].frequencies,
        values=np.stack([one.values for one in found]),
        error=np.array([one.error for one in found]),
        bolt_forces=np.stack([one.bolt_forces for one in found]) if study.bolts else None,
        **sides,
    )


def _closing_notes(study: Study, rigid: Array, first: float) -> Iterator[Note]:
    if study.uncertain is not None:
        within = [column.key for column in study.uncertain.inputs if column.within]
        taken = f"; of {', '.join(within)} the median is taken" if within else ""
        left = [one.key for one in study.uncertain.inputs if not in_intervals(one.key)]
        but = f", but for {listed(left)}" * bool(left)
        ends = f"; the intervals have what [uncertain] says{but}" * study.modes.intervals
        text = (
            f"as modelled are the frequencies at the numbers that the study gives{taken}{ends}; faying predict draws "
            "all of them at once"
        )
        yield Note(code="uncertain", text=text)
    if study.load_cases:
        names = ", ".join(repr(load.name) for load in study.load_cases)
        text = f"load cases are left out of a run ({names}); faying loads finds forces, opening and slip under them"
        yield Note(code="load-cases", text=text)
    if len(rigid) and rigid.max() > NOT_ZERO * first:
        text = (
            f"a rigid-body motion is at {rigid.max():.2g} Hz instead of 0: rounding has cost the frequencies "
            "digits, most those near it; look for parts or springs far stiffer than the rest"
        )
        yield Note(code="rigid", severity="wrong", text=text)
    if study.modes.damping == "viscous":
        text = (
            "the dampers are those of the JK paper, c = eta sqrt(M k) point by point: their sum grows with the square "
            "root of the number of points, so loss factors depend on the mesh"
        )
        yield Note(code="viscous", severity="limit", text=text)


def _sources(case: Case) -> tuple[str, ...]:
    study = case.study
    used = sorted({study.parts[name] for name in study.parts})
    lines = [f"material {name}: {study.materials[name].source or 'given in the study'}" for name in used]
    lines += [f"contact law {j.law.model.name}: {j.law.model.source}" for j in case.structure.joints]
    lines += [f"geometry: {study.geometry.file.name}"]
    lines += [surface.source for surface in case.surfaces if surface.source]
    if study.test is not None:
        lines.append(f"{study.test.kind}: {study.test.source}")
    if study.hammer is not None:
        lines.append(f"test: {study.hammer.source or study.hammer.file.name}")
    return tuple(dict.fromkeys(lines))
