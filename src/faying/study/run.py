"""From a study to its result: surface, law, mesh, preload, modes, response."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from faying.contact.law import ContactLaw
from faying.fe.constraint import constrain
from faying.fe.damped import DampedModes, damped_modes
from faying.fe.interface import Interface
from faying.fe.modes import Modes, lowest_modes
from faying.fe.solve import chosen
from faying.joint.equilibrium import PreloadState
from faying.joint.springs import Springs
from faying.joint.structure import Structure, bond
from faying.joint.support_check import RIGID_BELOW, check_motions, checked_preload, open_joints
from faying.measured.model import FullResponse
from faying.result import Comparison, Receptance, Result
from faying.study.build import build_all, checked_mesh, surfaces_of
from faying.study.hammer import Hammer
from faying.study.response import Solved
from faying.study.schema import Study
from faying.study.surface import Surface, law_facts
from faying.typing import Array, Complex

Report = Callable[[str], None]
SPARE_MODES = 6  # beyond those asked for, so that the basis of the complex modes does not end at the last of them
SIZES = 3e-3, 30.0  # m: a structure smaller or larger than these is told, for its unit may be wrong


def run(study: Study | str | Path, *, report: Report | None = None) -> Result:
    """Run a study (a Study or the path of its TOML file) from the surface to the modes.

    report: called with a sentence at each stage. Raises InputError and ReadError for what the study gives wrong and
    NotConverged where an iteration stops short; nothing is written.
    """
    study = study if isinstance(study, Study) else Study.read(study)
    tell = report or (lambda _: None)
    hammer = None
    if study.hammer is not None:
        tell("hammer test")
        hammer = Hammer.read(study.hammer)
    tell("surface")
    surfaces = surfaces_of(study)
    tell("mesh")
    built = build_all(study, mesh=checked_mesh(study), surfaces=surfaces)
    structure = built.structure
    where = None if hammer is None else hammer.points(structure)
    notes: list[str] = list(dict.fromkeys(text for surface in surfaces for text in surface.warnings))
    size = structure.mesh.size
    if not SIZES[0] <= size <= SIZES[1]:
        notes.append(
            f"the structure measures {size:.4g} m from corner to corner; if it should not, the unit of its geometry is wrong"
        )
    loads = np.array(study.bolts[0].preload)
    K, M = structure.vibrating
    assembly = structure.assembly(solver=study.solver)
    shift = study.shift_frequency or structure.shift_frequency
    still = structure.rigid.shape[1]
    count = still + study.mode_count + SPARE_MODES
    preloads: list[PreloadState] = []
    per_load: list[tuple[Springs[Interface], ...]] = []
    modes: list[Modes] = []
    damped: list[DampedModes] = []
    responses: list[Receptance] = []
    full: FullResponse | None = None
    for number, load in enumerate(loads):
        tell(f"preload {load / 1e3:g} kN")
        preload = checked_preload(
            structure, assembly, [bolt.preload[number] for bolt in study.bolts], order=study.order
        )
        springs = structure.springs(preload.pressures)
        tell(f"modes at {load / 1e3:g} kN")
        stiffness, loss = structure.joined(springs, viscous=study.damping == "viscous")
        found = lowest_modes(stiffness, M, count, shift_frequency=shift, solver=study.solver)
        check_motions(structure, found)
        complex_modes = damped_modes(found, stiffness, M, loss, rigid=still, count=study.mode_count, kind=study.damping)
        solved = Solved(
            study=study, structure=structure, modes=found, damped=complex_modes, stiffness=stiffness, mass=M, loss=loss
        )
        if study.response is not None:
            tell(f"frequency response at {load / 1e3:g} kN")
            answer, said = solved.response()
            responses.append(answer)
            notes += said
        if hammer is not None and where is not None and number == hammer.spec.load and hammer.tested.frf is not None:
            tell("frequency response at the points of the test")
            full, said = hammer.response(solved, where)
            notes += said
        preloads.append(preload)
        per_load.append(springs)
        modes.append(found)
        damped.append(complex_modes)
        notes += _flags(structure, preload, load)
    tell("modes free and tied")
    free = lowest_modes(K, M, count, shift_frequency=shift, solver=study.solver)
    tied = _tied(structure, count, shift, study.solver, notes)

    nodes, triangles = structure.outline()
    elastic = slice(still, still + study.mode_count)
    # those of the complex modes, whose frequencies stand beside them: real modes that lie close mix otherwise
    shapes = [d.real_shapes(M).T.reshape(len(d.frequencies), -1, 3) for d in damped]
    comparison = _compare(study, loads, structure, shapes, np.stack([d.frequencies for d in damped]), notes)
    rigid = np.max([m.frequencies[:still] for m in modes], axis=0)
    if still and rigid.max() > 1e-2:
        notes.append(
            f"a rigid-body motion comes out at {rigid.max():.2g} Hz instead of 0: the solution has lost digits"
        )
    if study.damping == "viscous":
        notes.append(
            "the dampers are those of the JK paper, c = eta sqrt(M k) point by point: their sum grows with the square "
            "root of the number of points, so loss factors depend on the mesh"
        )
    k_n, k_t = _maps(structure, preloads)
    result = Result(
        title=study.title,
        loads=loads,
        frequencies=np.stack([d.frequencies for d in damped]),
        loss_factors=np.stack([d.loss_factors for d in damped]),
        loss_error=np.stack([d.error for d in damped]),
        tied=tied.frequencies[elastic],
        free=np.where(free.frequencies < RIGID_BELOW * shift, 0.0, free.frequencies)[elastic],
        rigid=rigid,
        pressure=np.stack([np.concatenate(p.pressures) for p in preloads]),
        k_n=k_n,
        k_t=k_t,
        points=np.concatenate([j.interface.positions for j in structure.joints]),
        weights=np.concatenate([j.interface.weights for j in structure.joints]),
        joint_of_point=np.concatenate([np.full(len(j.interface.weights), i) for i, j in enumerate(structure.joints)]),
        joints=tuple(j.name for j in structure.joints),
        unknowns=structure.mesh.unknowns,
        solver=chosen(study.solver),
        factor_memory=max(m.factorisation.memory for m in modes),
        outline=structure.mesh.points[nodes],
        triangles=triangles,
        shapes=np.stack([shape[:, nodes] for shape in shapes]),
        bolts=tuple(bolt.name for bolt in study.bolts),
        bolt_forces=np.array([p.bolt_forces for p in preloads]),
        slipping=np.array([p.slipping for p in preloads]),
        mac=np.stack([_mac(damped[0].shapes, d.shapes) for d in damped]),
        response=tuple(responses),
        surface=surfaces[0].facts,
        law=law_facts(built.laws[0]),
        convergence=tuple(_convergence(p, s) for p, s in zip(preloads, per_load, strict=True)),
        comparison=comparison,
        sources=_sources(study, surfaces, built.laws),
        warnings=tuple(dict.fromkeys(notes)),
        damping=study.damping,
        tightening=() if study.order is None else tuple(study.bolts[i].name for i in study.order),
    )
    if hammer is None:
        return result
    return replace(result, hammer=hammer.beside(result, full))


def _mac(first: Complex, other: Complex) -> Array:
    """Modal assurance criterion [-] (m, m) of two sets of modes (unknowns, m) (Allemang 2003, eq. 4)."""
    sizes = [np.einsum("im,im->m", a.conj(), a).real for a in (first, other)]
    return np.asarray(np.abs(first.conj().T @ other) ** 2 / np.outer(*sizes))


def _tied(structure: Structure, count: int, shift: float, solver: str | None, notes: list[str]) -> Modes:
    """Modes with the faces of every joint grown together."""
    K, M = structure.vibrating
    merge = structure.bonded()
    if merge is not None and not len(structure.fixed):
        return lowest_modes(
            (merge.T @ K @ merge).tocsr(), (merge.T @ M @ merge).tocsr(), count, shift_frequency=shift, solver=solver
        )
    apart = [joint.name for joint in structure.joints if bond(structure.mesh, [joint.faces]) is None]
    why = f"the faces of {', '.join(apart)} do not match node for node" if apart else "supports hold some of the nodes"
    notes.append(
        f"{why}: the tied modes use springs a thousand times as stiff as the parts in place of grown-together faces"
    )
    stiff = 1e3 * max(m.E for m in structure.materials.values()) / structure.mesh.size
    for joint in structure.joints:
        springs = joint.interface.springs(*2 * (np.full(len(joint.interface.weights), stiff),))
        K = K + constrain(springs, structure.fixed, 0.0)
    return lowest_modes(K, M, count, shift_frequency=shift, solver=solver)


def _flags(structure: Structure, preload: PreloadState, load: float) -> list[str]:
    """Say where the law has left its ground, with the share of the joint's area."""
    out = [
        f"{name}, {load / 1e3:g} kN: no contact is left; the joint carries nothing"
        for name in open_joints(structure, preload.pressures)
    ]
    for joint, pressure in zip(structure.joints, preload.pressures, strict=True):
        end = joint.law.model.greatest_pressure
        if np.any(pressure > end):
            share = float(joint.interface.weights @ (pressure > end) / joint.interface.area)
            out.append(
                f"{joint.name}, {load / 1e3:g} kN: on {share:.2%} of the joint the pressure exceeds the {end / 1e6:.3g} MPa at "
                f"which {joint.law.model.name} ends with this surface; stiffness is held there"
            )
        answer = joint.law.answer(pressure)
        reasons = getattr(answer, "reasons", {})
        if answer.loss_n is None and answer.loss_t is None:
            out.append(f"{joint.name}: {joint.law.model.name} defines no loss; the joint damps nothing")
        for text, mask in reasons.items():
            share = float(joint.interface.weights @ mask / joint.interface.area)
            if share > 0:
                out.append(
                    f"{joint.name}, {load / 1e3:g} kN: {joint.law.model.name} is outside its ground on {share:.0%} of "
                    f"the joint: {text}"
                )
    return out


def _maps(structure: Structure, preloads: list[PreloadState]) -> tuple[Array, Array]:
    """k_n and k_t per area at the points of all joints (load, point)."""
    pairs = [
        [joint.law.stiffness(p) for joint, p in zip(structure.joints, preload.pressures, strict=True)]
        for preload in preloads
    ]
    k_n, k_t = (np.stack([np.concatenate([pair[k] for pair in row]) for row in pairs]) for k in (0, 1))
    return k_n, k_t


def _convergence(preload: PreloadState, springs: tuple[Springs[Interface], ...]) -> dict[str, float]:
    totals = [s.total() for s in springs]
    return {
        "imbalance": preload.imbalance,
        "newton_steps": preload.newton_steps,
        "inner_steps": preload.inner_steps,
        "factorisations": preload.factorisations,
        "total_k_n [N/m]": sum(t[0] for t in totals),
        "total_k_t [N/m]": sum(t[1] for t in totals),
    }


def _compare(
    study: Study, loads: Array, structure: Structure, shapes: list[Array], frequencies: Array, notes: list[str]
) -> Comparison | None:
    """Pair the test's frequencies, in order, with the modes that the test can see."""
    test = study.test
    if test is None:
        return None
    measured = np.array(test.frequencies)
    axis = np.array(test.direction) / np.linalg.norm(test.direction)
    here = [int(np.argmin(np.linalg.norm(structure.mesh.points - np.array(p), axis=1))) for p in test.points]
    predicted, paired = np.empty_like(measured), np.empty(measured.shape, dtype=np.int64)
    for row, found in enumerate(shapes):
        motion = np.abs(found[:, here] @ axis).max(axis=1)
        seen = np.flatnonzero(motion >= test.threshold * motion.max())
        if len(seen) < measured.shape[1]:
            notes.append(
                f"the test lists {measured.shape[1]} modes but only {len(seen)} of those computed move at its points; "
                "raise modes.count"
            )
            return None
        paired[row] = seen[: measured.shape[1]]
        predicted[row] = frequencies[row, paired[row]]
    return Comparison(
        source=test.source,
        frequencies=measured,
        predicted=predicted,
        modes=paired,
        published=None if test.published is None else np.array(test.published),
        published_name=test.published_name,
    )


def _sources(study: Study, surfaces: tuple[Surface, ...], laws: tuple[ContactLaw, ...]) -> tuple[str, ...]:
    used = {study.parts[name] for name in study.parts}
    lines = [f"material {name}: {study.materials[name].source or 'given in the study'}" for name in sorted(used)]
    lines += [f"contact law {law.name}: {law.source}" for law in laws]
    lines += [f"geometry: {study.geometry.file.name}"]
    lines += [surface.source for surface in surfaces if surface.source]
    if study.test is not None:
        lines.append(f"test: {study.test.source}")
    if study.hammer is not None:
        lines.append(f"test: {study.hammer.source or study.hammer.file.name}")
    return tuple(dict.fromkeys(lines))
