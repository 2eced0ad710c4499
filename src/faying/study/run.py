"""From a study to its result."""

import hashlib
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

from faying.fe.constraint import constrain
from faying.fe.modes import Modes, lowest_modes
from faying.fe.solve import chosen
from faying.joint.structure import bond
from faying.joint.support_check import RIGID_BELOW
from faying.notes import Note
from faying.result import Comparison, Provenance, Receptance, Result
from faying.study.case import Case, Progress, Report
from faying.study.solve import State, solve
from faying.study.study import Study
from faying.typing import Array, Complex

VERSIONS = ("faying", "numpy", "scipy", "netgen-mesher", "pypardiso", "mkl")
NOT_ZERO = 1e-2  # Hz: a rigid motion above it is noted


def run(study: Study | str | Path, *, report: Report | None = None) -> Result:
    """Run a study from the surface to the modes.

    Args:
        study: a Study or the path of its TOML file.
        report: called with (stage, stages done, stages in all) as each stage begins.

    Returns:
        The result; nothing is written.

    Raises:
        InputError, ReadError: what the study gives cannot be used.
        NotConverged: an iteration stops short.
    """
    study = Study.read(study)
    progress = Progress(stage_count(study), report)
    case = Case.of(study, progress)
    problem = case.structure.assembly(solver=study.modes.solver)
    states = [solve(case, number, problem, progress) for number in range(len(study.loads))]
    progress.begin("modes free and bonded")
    free, bonded, notes = bounds(case)
    return collect(case, states, free, bonded, notes)


def stage_count(study: Study) -> int:
    """How many stages `run` reports for a study."""
    tested = 0 if study.hammer is None else 2
    return 3 + tested + len(study.loads) * (2 + (study.response is not None))


def bounds(case: Case) -> tuple[Array, Array, list[Note]]:
    """Frequencies [Hz] of the elastic modes with the faces of every joint apart, and with them bonded; notes."""
    structure, shift, solver = case.structure, case.shift_frequency, case.study.modes.solver
    K, M = structure.vibrating
    free = lowest_modes(K, M, case.mode_count, shift_frequency=shift, solver=solver)
    bonded, notes = _bonded(case)
    elastic = slice(case.rigid_count, case.rigid_count + case.study.modes.count)
    still = np.where(free.frequencies < RIGID_BELOW * shift, 0.0, free.frequencies)
    return still[elastic], bonded.frequencies[elastic], notes


def _bonded(case: Case) -> tuple[Modes, list[Note]]:
    structure, shift, solver = case.structure, case.shift_frequency, case.study.modes.solver
    K, M = structure.vibrating
    merge = structure.bonded()
    if merge is not None and not len(structure.fixed):
        K, M = ((merge.T @ matrix @ merge).tocsr() for matrix in (K, M))
        return lowest_modes(K, M, case.mode_count, shift_frequency=shift, solver=solver), []
    apart = [joint.name for joint in structure.joints if bond(structure.mesh, [joint.faces]) is None]
    why = f"the faces of {', '.join(apart)} do not match node for node" if apart else "supports hold some of the nodes"
    text = f"{why}: the bonded modes use springs a thousand times as stiff as the parts in place of bonded faces"
    stiff = 1e3 * max(m.E for m in structure.materials.values()) / structure.mesh.size
    for joint in structure.joints:
        springs = joint.interface.springs(*2 * (np.full(len(joint.interface.weights), stiff),))
        K = K + constrain(springs, structure.fixed, 0.0)
    modes = lowest_modes(K, M, case.mode_count, shift_frequency=shift, solver=solver)
    return modes, [Note(code="bonded-by-springs", text=text)]


def collect(case: Case, states: Sequence[State], free: Array, bonded: Array, notes: Sequence[Note]) -> Result:
    """Stack the states of a case into its result."""
    study, structure = case.study, case.structure
    nodes, triangles = structure.outline()
    # those of the complex modes, whose frequencies stand beside them: real modes that lie close mix otherwise
    mass = structure.vibrating[1]
    shapes = [s.damped.real_shapes(mass).T.reshape(len(s.damped.frequencies), -1, 3) for s in states]
    comparison, more = _compare(case, states, shapes)
    rigid = np.max([s.modes.frequencies[: case.rigid_count] for s in states], axis=0)
    every = [*case.notes, *(note for s in states for note in s.notes), *notes, *more, *_closing_notes(study, rigid)]
    totals = np.array([[spring.total() for spring in s.springs] for s in states])
    interfaces = [spring.interface for spring in states[0].springs]
    result = Result(
        title=study.title,
        loads=case.loads,
        frequencies=np.stack([s.damped.frequencies for s in states]),
        loss_factors=np.stack([s.damped.loss_factors for s in states]),
        loss_error=np.stack([s.damped.error for s in states]),
        free=free,
        bonded=bonded,
        rigid=rigid,
        mac=np.stack([_mac(states[0].damped.shapes, s.damped.shapes) for s in states]),
        points=np.concatenate([i.positions for i in interfaces]),
        weights=np.concatenate([i.weights for i in interfaces]),
        joint_of_point=np.concatenate([np.full(len(i.weights), k) for k, i in enumerate(interfaces)]),
        pressure=np.stack([np.concatenate([spring.pressure for spring in s.springs]) for s in states]),
        k_n=np.stack([np.concatenate([spring.k_n for spring in s.springs]) for s in states]),
        k_t=np.stack([np.concatenate([spring.k_t for spring in s.springs]) for s in states]),
        slipping=np.array([s.preload.slipping for s in states]),
        total_k_n=totals[:, :, 0],
        total_k_t=totals[:, :, 1],
        bolt_forces=np.array([s.preload.bolt_forces for s in states]),
        imbalance=np.array([s.preload.imbalance for s in states]),
        newton_steps=np.array([s.preload.newton_steps for s in states]),
        outline=structure.mesh.points[nodes],
        triangles=triangles,
        shapes=np.stack([shape[:, nodes] for shape in shapes]),
        joints=tuple(j.name for j in structure.joints),
        bolts=tuple(bolt.name for bolt in study.bolts),
        unknowns=structure.mesh.unknowns,
        solver=chosen(study.modes.solver),
        factor_memory=max(s.modes.factorisation.memory for s in states),
        damping=study.modes.damping,
        tightening=() if study.order is None else tuple(study.bolts[i].name for i in study.order),
        surfaces=tuple(surface.facts() for surface in case.surfaces),
        laws=tuple(joint.law.model.facts() for joint in structure.joints),
        sources=_sources(case),
        notes=tuple(dict.fromkeys(every)),
        response=_response(study, states),
        comparison=comparison,
        provenance=provenance(study),
    )
    if case.hammer is None:
        return result
    full = next((s.test_response for s in states if s.test_response is not None), None)
    return replace(result, hammer=case.hammer.beside(result, full))


def _response(study: Study, states: Sequence[State]) -> Receptance | None:
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
        **sides,
    )


def _mac(first: Complex, other: Complex) -> Array:
    """Modal assurance criterion [-] (m, m) of two sets of modes (unknowns, m) (Allemang 2003, eq. 4)."""
    sizes = [np.einsum("im,im->m", a.conj(), a).real for a in (first, other)]
    return np.asarray(np.abs(first.conj().T @ other) ** 2 / np.outer(*sizes))


def _closing_notes(study: Study, rigid: Array) -> list[Note]:
    out = []
    if len(rigid) and rigid.max() > NOT_ZERO:
        text = f"a rigid-body motion comes out at {rigid.max():.2g} Hz instead of 0: the solution has lost digits"
        out.append(Note(code="rigid", text=text))
    if study.modes.damping == "viscous":
        text = (
            "the dampers are those of the JK paper, c = eta sqrt(M k) point by point: their sum grows with the square "
            "root of the number of points, so loss factors depend on the mesh"
        )
        out.append(Note(code="viscous", text=text))
    return out


def _compare(case: Case, states: Sequence[State], shapes: Sequence[Array]) -> tuple[Comparison | None, list[Note]]:
    """Pair the test's frequencies, in order, with the modes that the test can see."""
    test = case.study.test
    if test is None:
        return None, []
    measured = np.array(test.frequencies)
    axis = np.array(test.direction) / np.linalg.norm(test.direction)
    points = case.structure.mesh.points
    here = [int(np.argmin(np.linalg.norm(points - np.array(p), axis=1))) for p in test.points]
    predicted, paired = np.empty_like(measured), np.empty(measured.shape, dtype=np.int64)
    for row, (state, found) in enumerate(zip(states, shapes, strict=True)):
        motion = np.abs(found[:, here] @ axis).max(axis=1)
        seen = np.flatnonzero(motion >= test.threshold * motion.max())
        if len(seen) < measured.shape[1]:
            text = (
                f"the test lists {measured.shape[1]} modes but only {len(seen)} of those computed move at its points; "
                "raise modes.count"
            )
            return None, [Note(code="test-modes", text=text)]
        paired[row] = seen[: measured.shape[1]]
        predicted[row] = state.damped.frequencies[paired[row]]
    comparison = Comparison(
        source=test.source,
        frequencies=measured,
        predicted=predicted,
        modes=paired,
        published=None if test.published is None else np.array(test.published),
        published_name=test.published_name,
        kind=test.kind,
    )
    return comparison, []


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


def provenance(study: Study) -> Provenance:
    """The study's text, a hash of every file that it names, versions and the date."""
    return Provenance(
        study=study.text,
        files={str(_below(file, study.folder)): hashlib.sha256(file.read_bytes()).hexdigest() for file in study.files},
        versions={name: found for name in VERSIONS if (found := _version(name))},
        date=datetime.now(UTC).isoformat(timespec="seconds"),
    )


def _below(file: Path, folder: Path) -> Path:
    return file.relative_to(folder) if file.is_relative_to(folder) else file


def _version(name: str) -> Any:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""
