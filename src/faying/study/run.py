"""From a study to its result: surface, law, mesh, preload, modes."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faying.contact.law import ContactLaw
from faying.errors import InputError
from faying.fe.interface import join
from faying.fe.modes import Modes, damped_modes, lowest_modes
from faying.fe.solve import chosen
from faying.joint.balance import Preload
from faying.joint.seat import Seat
from faying.joint.structure import Joint, Springs, Structure
from faying.materials import RIGID, ContactPair
from faying.result import Comparison, Result
from faying.study.geometry import mesh_of
from faying.study.schema import Study
from faying.study.surface import Surface, law_facts, law_of, surface_of

Array = NDArray[np.float64]
Report = Callable[[str], None]
SPARE_MODES = 6  # beyond those asked for, so that the basis of the complex modes does not end at the last of them


def run(study: Study | str | Path, *, report: Report | None = None) -> Result:
    """Run a study (a Study or the path of its TOML file) from the surface to the modes.

    report: called with a sentence at each stage. Raises InputError and ReadError for what the study gives wrong and
    NotConverged where an iteration stops short; nothing is written.
    """
    study = study if isinstance(study, Study) else Study.read(study)
    tell = report or (lambda _: None)
    tell("surface")
    surface = surface_of(study.surface)
    tell("mesh")
    structure, laws = _structure(study, surface)
    K, M = structure.matrices
    loads = np.array(study.bolts[0].preload)
    notes: list[str] = list(surface.warnings)

    assembly = structure.assembly(solver=study.solver)
    units = [structure.bolt_load(*bolt.faces) for bolt in study.bolts]
    shift = study.shift_frequency or structure.shift_frequency
    count = 6 + study.mode_count + SPARE_MODES
    preloads: list[Preload] = []
    per_load: list[tuple[Springs, ...]] = []
    modes: list[Modes] = []
    damped = []
    for number, load in enumerate(loads):
        tell(f"preload {load / 1e3:g} kN")
        force = sum(
            (bolt.preload[number] * unit for bolt, unit in zip(study.bolts, units, strict=True)),
            np.zeros(structure.mesh.unknowns),
        )
        preload = assembly.solve(np.asarray(force))
        springs = structure.springs(preload.pressures)
        tell(f"modes at {load / 1e3:g} kN")
        stiffness = K + _sum(s.stiffness() for s in springs)
        found = lowest_modes(stiffness, M, count, shift_frequency=shift, solver=study.solver)
        damped.append(damped_modes(found, stiffness, M, _sum(s.loss() for s in springs), rigid=6))
        preloads.append(preload)
        per_load.append(springs)
        modes.append(found)
        notes += _flags(structure, preload, load)
    tell("modes free and tied")
    free = lowest_modes(K, M, count, shift_frequency=shift, solver=study.solver)
    tied = _tied(structure, count, shift, study.solver, notes)

    nodes, triangles = structure.outline()
    keep = slice(0, study.mode_count)
    elastic = slice(6, 6 + study.mode_count)
    shapes = np.stack([m.shapes[:, elastic].T.reshape(study.mode_count, -1, 3)[:, nodes] for m in modes])
    comparison = _compare(study, loads, structure, modes, np.stack([d.frequencies for d in damped]), notes)
    rigid = np.max([m.frequencies[:6] for m in modes], axis=0)
    if rigid.max() > 1e-2:
        notes.append(
            f"a rigid-body motion comes out at {rigid.max():.2g} Hz instead of 0: the solution has lost digits"
        )
    return Result(
        title=study.title,
        loads=loads,
        frequencies=np.stack([d.frequencies[keep] for d in damped]),
        loss_factors=np.stack([d.loss_factors[keep] for d in damped]),
        loss_error=np.stack([d.residual[keep] ** 2 for d in damped]),
        tied=tied.frequencies[elastic],
        free=np.where(np.arange(6, count) < 6 * len(structure.mesh.parts), 0.0, free.frequencies[6:])[keep],
        rigid=rigid,
        pressure=np.stack([np.concatenate(p.pressures) for p in preloads]),
        **_maps(structure, preloads),
        points=np.concatenate([j.interface.positions for j in structure.joints]),
        weights=np.concatenate([j.interface.weights for j in structure.joints]),
        joint_of_point=np.concatenate([np.full(len(j.interface.weights), i) for i, j in enumerate(structure.joints)]),
        joints=tuple(j.name for j in structure.joints),
        unknowns=structure.mesh.unknowns,
        solver=chosen(study.solver),
        outline=structure.mesh.points[nodes],
        triangles=triangles,
        shapes=shapes,
        surface=surface.facts,
        law=law_facts(laws[0]),
        convergence=tuple(_convergence(p, s) for p, s in zip(preloads, per_load, strict=True)),
        comparison=comparison,
        sources=_sources(study, surface, laws[0]),
        warnings=tuple(dict.fromkeys(notes)),
    )


def build(study: Study) -> Structure:
    """Return the structure of a study, meshed and with its law on the joints, for work that goes on by hand."""
    return _structure(study, surface_of(study.surface))[0]


def _sum(matrices: Any) -> Any:
    total = None
    for matrix in matrices:
        total = matrix if total is None else total + matrix
    return total


def _structure(study: Study, surface: Surface) -> tuple[Structure, list[ContactLaw]]:
    """Mesh, joints and the law of each joint; every name that does not fit the geometry is reported at once."""
    spec = study.geometry
    mesh = mesh_of(spec)
    faults = [
        f"[part] says nothing of {name!r}, which {spec.file.name} holds"
        for name in mesh.parts
        if name not in study.parts
    ]
    faults += [f"part {name!r} is not in {spec.file.name}; it holds {', '.join(mesh.parts)}" for name in study.parts
               if name not in mesh.parts]  # fmt: skip
    known = ", ".join(sorted(mesh.faces))
    for what, items in (("joint", study.joints), ("bolt", study.bolts)):
        faults += [f"{what} {item.name!r} names the face {face!r}, which does not exist; the faces are {known}"
                   for item in items for face in item.faces if face not in mesh.faces]  # fmt: skip
    if faults:
        raise InputError("the study does not fit its geometry:\n" + "\n".join(f"  - {line}" for line in faults))
    materials = {name: study.materials[study.parts[name]] for name in mesh.parts}
    joints, laws = [], []
    for joint in study.joints:
        rough, other = (materials[mesh.face_part[face]] for face in joint.faces)
        pair = ContactPair(rough, RIGID if study.law.counterbody == "rigid" else other)
        law = law_of(study.law, surface, pair)
        laws.append(law)
        joints.append(
            Joint(
                name=joint.name,
                faces=joint.faces,
                interface=join(mesh, *joint.faces),
                seat=Seat(law=law, tangential=joint.tangential, nu=rough.nu),
                per_node=joint.springs == "per-node",
                scan_area=surface.scan_area,
            )
        )
    return Structure(mesh=mesh, materials=materials, joints=tuple(joints)), laws


def _tied(structure: Structure, count: int, shift: float, solver: str | None, notes: list[str]) -> Modes:
    """Modes with the faces of every joint grown together."""
    K, M = structure.matrices
    merge = structure.tie()
    if merge is not None:
        return lowest_modes(
            (merge.T @ K @ merge).tocsr(), (merge.T @ M @ merge).tocsr(), count, shift_frequency=shift, solver=solver
        )
    notes.append("the faces of a joint do not match node for node: the tied modes use springs a thousand times as stiff as "
                 "the parts in place of grown-together faces")  # fmt: skip
    stiff = 1e3 * max(m.E for m in structure.materials.values()) / structure.mesh.size
    springs = _sum(j.interface.springs(*2 * (np.full(len(j.interface.weights), stiff),)) for j in structure.joints)
    return lowest_modes(K + springs, M, count, shift_frequency=shift, solver=solver)


def _flags(structure: Structure, preload: Preload, load: float) -> list[str]:
    """Say where the law has left its ground, with the share of the joint's area."""
    out = []
    for joint, pressure in zip(structure.joints, preload.pressures, strict=True):
        end = joint.seat.law.greatest_pressure
        if np.any(pressure > end):
            share = float(joint.interface.weights @ (pressure > end) / joint.interface.area)
            out.append(
                f"{joint.name}, {load / 1e3:g} kN: on {share:.2%} of the joint the pressure exceeds the {end / 1e6:.3g} MPa at "
                f"which {joint.seat.law.name} ends with this surface; stiffness is held there"
            )
        reasons = getattr(joint.seat.answer(pressure), "reasons", {})
        for text, mask in reasons.items():
            share = float(joint.interface.weights @ mask / joint.interface.area)
            if share > 0:
                out.append(f"{joint.name}, {load / 1e3:g} kN: {joint.seat.law.name} is outside its ground on {share:.0%} of "
                           f"the joint: {text}")  # fmt: skip
    return out


def _maps(structure: Structure, preloads: list[Preload]) -> dict[str, Array]:
    """k_n and k_t per area at the points of all joints (load, point)."""
    pairs = [
        [joint.seat.stiffness(p) for joint, p in zip(structure.joints, preload.pressures, strict=True)]
        for preload in preloads
    ]
    return {
        "k_n": np.stack([np.concatenate([k for k, _ in row]) for row in pairs]),
        "k_t": np.stack([np.concatenate([k for _, k in row]) for row in pairs]),
    }


def _convergence(preload: Preload, springs: tuple[Springs, ...]) -> dict[str, float]:
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
    study: Study, loads: Array, structure: Structure, modes: list[Modes], frequencies: Array, notes: list[str]
) -> Comparison | None:
    """Pair the test's frequencies, in order, with the modes that the test can see."""
    test = study.test
    if test is None:
        return None
    measured = np.array(test.frequencies)
    axis = np.array(test.direction) / np.linalg.norm(test.direction)
    here = [int(np.argmin(np.linalg.norm(structure.mesh.points - np.array(p), axis=1))) for p in test.points]
    predicted, paired = np.empty_like(measured), np.empty(measured.shape, dtype=np.int64)
    for row, found in enumerate(modes):
        shape = found.shapes[:, 6:].T.reshape(found.shapes.shape[1] - 6, -1, 3)[:, here] @ axis
        motion = np.abs(shape).max(axis=1)
        seen = np.flatnonzero(motion >= test.threshold * motion.max())
        if len(seen) < measured.shape[1]:
            notes.append(f"the test lists {measured.shape[1]} modes but only {len(seen)} of those computed move at its points; "
                         "raise modes.count")  # fmt: skip
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


def _sources(study: Study, surface: Surface, law: ContactLaw) -> tuple[str, ...]:
    used = {study.parts[name] for name in study.parts}
    lines = [f"material {name}: {study.materials[name].source or 'given in the study'}" for name in sorted(used)]
    lines += [f"contact law {law.name}: {law.source}", f"geometry: {study.geometry.file.name}"]
    if surface.source:
        lines.append(surface.source)
    if study.test is not None:
        lines.append(f"test: {study.test.source}")
    return tuple(lines)
