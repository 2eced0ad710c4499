"""How far the mesh may be off in each frequency: of the parts by functions one degree higher, of the joints by points.

A finer mesh has lower frequencies of the parts. What it does to the zone of contact has either sign: half of the points
of the joints, with twice their area, say how much hangs on single points.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.case.case import Case
from faying.case.scatter import MESH_NOTED, SCORE
from faying.case.solve import LoadedCase
from faying.fe.surplus import Surplus
from faying.joint.springs import Springs
from faying.joint.structure import Structure
from faying.notes import Note
from faying.study.study import Study
from faying.typing import Array, Index, Mask
from faying.units import show

# a finer mesh moved frequencies by 0.3 to 0.7 of what half of the points do where half of the flange is open, by less
# where it is closed
OF_HALVES = 0.5
RATE = 1.5  # the error falls with this power of the size: between 1.3 of plates and 2.5 of solid parts
MIN_SIZE_RATIO = 0.3  # of the size: a smaller one is not proposed in one step


@dataclass(frozen=True, kw_only=True)
class MeshError:
    """Relative errors of the frequencies [-] (loads, m), 0 or more.

    parts: by which a finer mesh has each frequency lower; contact: by which it has it higher or lower.
    """

    parts: Array
    contact: Array

    @classmethod
    def of(
        cls,
        structure: Structure,
        modes: Sequence[tuple[Array, Array]],
        springs: Sequence[Sequence[Springs[Any]]],
        halves: Sequence[Sequence[Array] | None],
    ) -> "MeshError | None":
        """From what is known under each load; None where the estimate does not know the elements.

        Args:
            structure: with its mesh.
            modes: elastic modes, their frequencies [Hz] (m,) and mass-normalised shapes (n, m).
            springs: of each joint.
            halves: frequencies [Hz] (m,) with each half of the points of the joints; None where they are not known.
        """
        surplus = Surplus.of(structure.mesh, structure.materials, loaded_nodes(structure))
        if surplus is None:
            return None
        parts, contact = [], []
        for (f, shapes), of_load, both in zip(modes, springs, halves, strict=True):
            pairs = zip(structure.joints, of_load, strict=True)
            joints = [(joint.interface, one.k_n, one.k_t) for joint, one in pairs if not joint.per_node]
            parts.append(surplus.error(shapes, (2 * np.pi * f) ** 2, joints) / 2)
            mean = np.zeros(len(f)) if both is None else np.log(np.stack(both) / f).mean(axis=0)
            contact.append(OF_HALVES * np.abs(mean))
        return cls(parts=np.stack(parts), contact=np.stack(contact))

    def of_modes(self, places: Index) -> "MeshError":
        """Those of modes in another order: places (loads, m) of each in the present one."""
        parts, contact = (np.take_along_axis(one, places, axis=1) for one in (self.parts, self.contact))
        return MeshError(parts=parts, contact=contact)

    @property
    def total(self) -> Array:
        """Estimated error of each frequency [-] (loads, m)."""
        return self.parts + self.contact

    @property
    def sd(self) -> tuple[Array, Array]:
        """Standard deviations of ln f: of what a mode has at all loads (m,), and of each load by itself (m,).

        The parts have one mesh at all loads; at each load other points of the joints touch.
        """
        return self.parts.mean(axis=0) / SCORE, np.sqrt((self.contact**2).mean(axis=0)) / SCORE

    @property
    def middle(self) -> Array:
        """Where a finer mesh has ln f in the middle (loads, m)."""
        return -self.parts

    @property
    def offsets(self) -> Array:
        """Both ends about the middle (2, loads, m): from twice the error of the parts to none of it."""
        return np.stack([-self.total, self.total])


def mesh_error(case: Case, states: Sequence[LoadedCase]) -> MeshError | None:
    """The error of the mesh in every frequency of every state; None where the estimate does not know its elements."""
    halves = [(state.ends or {}).get("contact") for state in states]
    modes = [elastic_modes(case, state) for state in states]
    return MeshError.of(case.structure, modes, [state.springs for state in states], halves)


def elastic_modes(case: Case, state: LoadedCase) -> tuple[Array, Array]:
    """Frequencies [Hz] (m,) and shapes (n, m) of the modes of a state that have an interval."""
    elastic = slice(case.rigid_count, case.rigid_count + len(state.damped.frequencies))
    return state.modes.frequencies[elastic], state.modes.shapes[:, elastic]


def loaded_nodes(structure: Structure) -> Mask:
    """Nodes (n,) on which bolts, dowels, supports and masses act, and joints node by node."""
    mesh = structure.mesh
    faces = [face for joint in structure.joints if joint.per_node for face in joint.faces]
    faces += [face for bolt in structure.bolts for face in bolt.faces]
    faces += [wall for dowel in structure.dowels for wall in dowel.walls]
    faces += [mass.face for mass in structure.masses if mass.face is not None]
    out = np.zeros(len(mesh.points), dtype=bool)
    for face in faces:
        out[mesh.face_nodes(face)] = True
    for support in structure.supports:
        out[support.nodes(mesh)] = True
    out[np.unique(structure.fixed // 3)] = True
    return out


def mesh_notes(study: Study, found: MeshError | None) -> list[Note]:
    """A note on an error of the mesh that is large, with the size of elements to take; on one that is not known."""
    if found is None:
        text = "the error of the mesh is not in the intervals: it is estimated for tetrahedra of one order alone"
        return [Note(code="mesh-unknown", text=text)]
    worst = found.total.max(axis=0)
    over = [str(k + 1) for k in np.flatnonzero(worst > MESH_NOTED)]
    if not over:
        return []
    which = f"mode{'s' * (len(over) > 1)} {', '.join(over)}"
    if 1 < len(over) == len(worst):
        which = f"all {len(over)} modes"
    text = f"the mesh is coarse: {which} may be off by up to {100 * worst.max():.2g} %; "
    geometry = study.geometry
    if geometry.step is None:
        text += "mesh finer in the program that the mesh comes from"
    else:
        smaller = size_for(geometry.size, float(worst.max()), MESH_NOTED)
        text += (
            f'geometry.size = "{show(smaller, "m", digits=2)}" and face sizes {smaller / geometry.size:.2g} times '
            f"theirs, or faying run --refine {100 * MESH_NOTED:g}%, bring it below {100 * MESH_NOTED:g} %"
        )
    return [Note(code="mesh-error", severity="limit", text=text)]


def size_for(size: float, error: float, tolerance: float) -> float:
    """Size of elements [m] at which an error falls to a tolerance, in one step."""
    return size * float(np.clip((tolerance / error) ** (1 / RATE), MIN_SIZE_RATIO, 1.0))
