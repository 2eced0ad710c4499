"""Whether every part of a structure is fixed: by contact after the preload, and against every motion in its modes."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from faying.errors import InputError, NotConverged
from faying.fe.elasticity import rigid_motions
from faying.fe.solids import bodies_of
from faying.joint.assembled_parts import unknowns_of
from faying.joint.bolted import BoltedStructure
from faying.joint.equilibrium import Equilibrium, PreloadState
from faying.joint.preload_case import PreloadCase
from faying.joint.tighten import tighten
from faying.numerics.modes import Modes
from faying.typing import Array

RIGID_BELOW = 0.01  # of the shift: a frequency below it is that of a motion that nothing resists
BENT = 0.01  # share of the energy of a motion above which it is not one of the whole
NOTHING = 1e-6  # of the greatest pressure


def checked_preload(structure: BoltedStructure, assembly: Equilibrium, case: PreloadCase) -> PreloadState:
    """`tighten` for one preload, after those that it names, and check that no part is left free to move.

    Raises InputError where a part is not, also in place of the NotConverged that this leads to, and what `tighten`
    raises.
    """
    if case.after:
        before = [checked_preload(structure, assembly, one) for one in case.before]
        carried = tuple(np.max(several, axis=0) for several in zip(*(one.pressures for one in before), strict=True))
        assembly.with_laws([joint.law for joint in structure.loaded_before(carried).joints])
        try:
            return replace(_loaded(structure, assembly, case), carried=carried)
        finally:
            assembly.with_laws([joint.law for joint in structure.joints])
    key = case.forces, case.order
    if key not in assembly.first_loadings:
        assembly.forget_slip()
        found = _loaded(structure, assembly, case)
        assembly.first_loadings[key] = found, tuple(assembly.anchors)
    found, anchors = assembly.first_loadings[key]
    assembly.anchors = list(anchors)
    return found


def _loaded(structure: BoltedStructure, assembly: Equilibrium, case: PreloadCase) -> PreloadState:
    """One preload with the laws that the problem has at the time, from the shear that is left in it."""
    try:
        found = tighten(structure, assembly, case.forces, order=case.order)
    except NotConverged:
        if assembly.nearest is not None:
            openings, pressures = assembly.contact(assembly.nearest)
            check_contact(structure, pressures, openings)
        raise
    check_contact(structure, found.pressures, found.openings)
    return found


def open_joints(structure: BoltedStructure, pressures: Sequence[Array]) -> list[str]:
    """Names of the joints that carry nothing, or next to nothing beside the others."""
    least = NOTHING * max((float(p.max()) for p in pressures), default=0.0)
    return [joint.name for joint, p in zip(structure.joints, pressures, strict=True) if p.max() <= least]


def check_contact(structure: BoltedStructure, pressures: Sequence[Array], openings: Sequence[Array]) -> None:
    """Raise InputError where parts are left that no contact, shank or support connects with the rest."""
    mesh, owner = structure.mesh, structure.mesh.face_part
    apart = set(open_joints(structure, pressures))
    faces = [joint.faces for joint in structure.joints if joint.name not in apart]
    faces += [bolt.faces for bolt in structure.bolts if bolt.diameter is not None]
    supported = [owner[support.face] for support in structure.supports]
    met = [(owner[first], owner[second]) for first, second in faces] + [(supported[0], part) for part in supported]
    groups = bodies_of(tuple(mesh.parts), [*met, *mesh.bonded])
    if supported:
        main = next(group for group in groups if supported[0] in group)
    else:
        main = max(groups, key=lambda group: sum(len(mesh.part_nodes(part)) for part in group))
    loose = [part for part in mesh.parts if part not in main]
    if not loose:
        return
    nearest = {
        joint.name: float(gap.min())
        for joint, gap in zip(structure.joints, openings, strict=True)
        if joint.name in apart and any(owner[face] in loose for face in joint.faces)
    }
    gaps = ", ".join(f"{name!r} ({gap * 1e6:.4g} um apart at the nearest)" for name, gap in nearest.items())
    raise InputError(
        f"part {', '.join(map(repr, loose))} is free to move under this preload: no contact is left at joint {gaps}; "
        "pull the bolts harder, place them so that they press these faces, or check the gap map and its unit"
    )


def check_motions(structure: BoltedStructure, modes: Modes) -> None:
    """Raise InputError where a part moves freely though neither its supports nor the want of any explain it."""
    rigid_count = structure.rigid_count
    free = np.flatnonzero(modes.frequencies < RIGID_BELOW * np.sqrt(modes.shift) / (2 * np.pi))
    if len(free) <= rigid_count or not np.any(_bent(structure, modes.shapes[:, free]) > BENT):
        return  # the whole moves as one, free or on a soft suspension
    part = _mover(structure, modes.shapes[:, free])
    raise InputError(
        f"{len(free)} motions cost no energy and {rigid_count} of them move the structure as one: part {part!r} moves "
        f"freely against the others (at {modes.frequencies[free].max():.2g} Hz). Its joints resist only some "
        "directions; give the law a tangential stiffness, a joint more, or a support"
    )


def _bent(structure: BoltedStructure, shapes: Array) -> Array:
    """Share (m,) of the kinetic energy of shapes that is not a rigid motion of the whole."""
    mass = structure.matrices[1]
    rest = _without(rigid_motions(structure.mesh.points), shapes, mass)
    energy = [np.einsum("im,im->m", x, mass @ x) for x in (rest, shapes)]
    return np.asarray(energy[0] / energy[1])


def _mover(structure: BoltedStructure, shapes: Array) -> str:
    """The smallest part that moves otherwise than as the whole does in a space of motions without energy."""
    mesh, rest = structure.mesh, _without(structure.rigid, shapes, structure.matrices[1])
    return max(mesh.parts, key=lambda part: float((rest[unknowns_of(mesh.part_nodes(part))] ** 2).mean()))


def _without(motions: Array, shapes: Array, mass: Any) -> Array:
    """Shapes (unknowns, m) without what they have, in the mass, of motions (unknowns, r)."""
    return shapes - motions @ np.linalg.solve(motions.T @ (mass @ motions), motions.T @ (mass @ shapes))
