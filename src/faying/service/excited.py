"""A preloaded structure under one excitation, linear about its preload: what each mode gets, moves and bears.

Every quantity y follows from the coordinates q of the modes and from what the modes that were left out do at rest:
y = s + sum_k y_k (q_k - f_k/omega_k^2) under a unit input, s the static answer, f_k the modal force.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from faying.case.acting import nodal_force
from faying.errors import InputError
from faying.fe.sides import nodes_of
from faying.fe.stress import SQUARE, PartStress, part_stresses
from faying.joint.attachments import nearest_node
from faying.joint.bolted import BoltedStructure
from faying.joint.carried import PressedPatch
from faying.joint.load_path import LoadPaths
from faying.joint.modal import Vibration
from faying.joint.shank_forces import shank_forces
from faying.joint.springs import Springs
from faying.numerics.follow import same_group
from faying.numerics.shifted import Shifted
from faying.numerics.solve import conjugate_gradients
from faying.study.vibration import Excitation, held_still, not_along, not_held
from faying.typing import Array, Complex

ACCURACY = 1e-8  # of the static answer, in energy
RESISTED = 1e-6  # of the mass that a motion of the supports moves: less is rounding, and nothing is shaken


@dataclass(frozen=True, kw_only=True)
class Patch:
    """Points of a joint whose slip is asked for: index of the joint, of the bolt round which they lie, -1: all."""

    joint: int
    bolt: int
    pressed: PressedPatch


@dataclass(frozen=True, kw_only=True)
class Excited:
    """What an excitation does to a structure.

    Args:
        excitation: What shakes it.
        speeds: Circular frequencies of its modes [rad/s] (m,), rigid motions first, at 0.
        rigid: How many those are.
        force: Modal forces [kg^1/2] of a unit acceleration of the supports, or [kg^-1/2] of a unit force (m,).
        reads: By the name of a quantity, what the modes have of it (..., m).
        static: By the same names, what the modes lack of it under a unit input at rest (...).
        nodes: At which the motion is given (p,).
        greatest: Displacement of the node that moves most in each mode (m,) [kg^-1/2].
        mass: That moves with the supports [kg]; 1 where a force acts.
        patches: Points of the joints whose slip is asked for.
        stress: Of each part, with a column for each mode and the last for what they lack.
    """

    excitation: Excitation
    speeds: Array
    rigid: int
    force: Array
    reads: Mapping[str, Array]
    static: Mapping[str, Array]
    nodes: Array
    greatest: Array
    mass: float
    patches: tuple[Patch, ...]
    stress: Mapping[str, PartStress]

    @classmethod
    def of(
        cls, structure: BoltedStructure, springs: Sequence[Springs[Any]], found: Vibration, excitation: Excitation
    ) -> "Excited":
        """Prepare a structure under the springs of its preload, with their modes.

        Raises:
            InputError: Nothing holds the structure against the motion of its supports, a face or a point is not there.
        """
        rigid, count = structure.rigid_count, structure.rigid_count + len(found.damped.frequencies)
        shapes = found.modes.shapes[:, :count]
        speeds = 2 * np.pi * found.modes.frequencies[:count]
        speeds[:rigid] = 0.0
        input_force = _input_force(structure, excitation)
        force = shapes.T @ input_force
        moved = _static(structure, found, input_force)
        lacking = moved - shapes @ (force / (speeds**2 + (found.modes.shift if rigid else 0.0)))
        nodes = _nodes(structure, excitation, shapes[:, rigid:], speeds[rigid:], force[rigid:])
        patches = _patches(structure, springs)
        columns = np.concatenate([shapes, lacking[:, None]], axis=1)
        along = np.tile(np.array(excitation.direction), len(structure.mesh.points))
        every = _quantities(structure, springs, nodes, patches, columns)
        return cls(
            excitation=excitation,
            speeds=speeds,
            rigid=rigid,
            force=force,
            reads={name: one[..., :-1] for name, one in every.items()},
            static={name: one[..., -1] for name, one in every.items()},
            nodes=nodes,
            greatest=np.linalg.norm(shapes.reshape(-1, 3, count), axis=1).max(axis=0),
            mass=float(-input_force @ along) if excitation.base else 1.0,
            patches=patches,
            stress=part_stresses(structure.mesh, structure.materials, columns),
        )

    def part_stress(self, products: Array) -> list[Array]:
        """Von Mises' stress [Pa] at the nodes of each part, from products (m + 1, m + 1) of coordinates and input."""
        return [
            np.sqrt(np.maximum(np.einsum("nik,ij,njl,kl->n", s, SQUARE, s, products, optimize=True), 0.0))
            for s in (one.stress for one in self.stress.values())
        ]

    def transfer(self, name: str, coordinates: Complex, amplitude: Array | float = 1.0) -> Complex:
        """A quantity (..., n) from the coordinates (m, n) of all modes under an input of amplitudes (n,)."""
        return self.static[name][..., None] * amplitude + self.reads[name] @ coordinates


def twins_along(structure: BoltedStructure, found: Vibration, excitation: Excitation) -> Vibration:
    """The modes with twins turned so that one of each pair has all of the force, as it alone moves."""
    shapes = found.modes.shapes.copy()
    force = shapes.T @ _input_force(structure, excitation)
    elastic = np.arange(shapes.shape[1]) >= structure.rigid_count
    for group in np.unique(same_group(found.modes.frequencies), axis=0):
        own = group & elastic
        count = int(np.count_nonzero(own))
        if count > 1 and np.any(force[own]):
            turn, _ = np.linalg.qr(np.column_stack([force[own], np.eye(count)]))
            shapes[:, own] = shapes[:, own] @ turn
    return replace(found, modes=replace(found.modes, shapes=shapes))


def _input_force(structure: BoltedStructure, excitation: Excitation) -> Array:
    """Nodal forces [N] (unknowns,) of a unit input, on unknowns that no support holds."""
    what, mesh = f"vibration {excitation.name!r}", structure.mesh
    if excitation.force is None:
        if not structure.supports:
            raise InputError(not_held(excitation.name))
        along = np.tile(np.array(excitation.direction), len(mesh.points))
        force = -structure.inertia(along)
        if structure.rigid.size:
            rigid = np.linalg.qr(structure.rigid)[0]
            if np.linalg.norm(rigid.T @ force) > RESISTED * np.linalg.norm(force):
                raise InputError(not_along(excitation))
    else:
        force = nodal_force(structure, excitation.force, what)
    force = np.array(force)
    force[structure.fixed] = 0.0
    if not np.any(force):
        raise InputError(held_still(excitation))
    return force


def _static(structure: BoltedStructure, found: Vibration, force: Array) -> Array:
    """Displacement [m] (unknowns,) under a constant force, of a free structure under its shifted stiffness."""
    shift = found.modes.shift if structure.rigid_count else 0.0
    stiffness = Shifted(stiffness=found.stiffness, mass=structure.dynamic_matrices[1], shift=shift)
    moved = conjugate_gradients(
        stiffness.__matmul__, found.modes.factorisation, force[:, None], accuracy=ACCURACY, least=0.0
    )
    return np.asarray(moved[:, 0])


def _nodes(structure: BoltedStructure, excitation: Excitation, shapes: Array, speeds: Array, force: Array) -> Array:
    """Nodes at the points that are asked for; else of each part the one with the greatest rms under white noise."""
    mesh = structure.mesh
    if excitation.points:
        what = f"vibration {excitation.name!r}: point"
        return np.array([nearest_node(mesh, point, what) for point in excitation.points])
    moved = ((shapes * (force / speeds**1.5)) ** 2).sum(axis=1).reshape(-1, 3).sum(axis=1)
    parts = [nodes_of(blocks) for blocks in mesh.parts.values()]
    return np.array([nodes[int(np.argmax(moved[nodes]))] for nodes in parts])


def _patches(structure: BoltedStructure, springs: Sequence[Springs[Any]]) -> tuple[Patch, ...]:
    """Of each joint that slips all points in contact, and those round each bolt."""
    out = []
    paths = LoadPaths.of(structure)
    for k, (joint, s) in enumerate(zip(structure.joints, springs, strict=True)):
        if joint.per_node:
            continue
        weights, owner = joint.interface.weights, paths.owner[k]
        for bolt in (-1, *np.unique(owner[owner >= 0]).tolist()):
            some = np.ones(len(weights), dtype=bool) if bolt < 0 else owner == bolt
            pressed = PressedPatch.of(joint.interface, s.pressure, weights, some)
            if pressed.normal > 0:
                out.append(Patch(joint=k, bolt=bolt, pressed=pressed))
    return tuple(out)


def _quantities(
    structure: BoltedStructure, springs: Sequence[Springs[Any]], nodes: Array, patches: Sequence[Patch], u: Array
) -> dict[str, Array]:
    """What displacements u (unknowns, k) make of points, bolts and joints, each (..., k)."""
    count, bolts = u.shape[1], len(structure.bolts)
    moments, shear = np.full((bolts, 2, 2, count), np.nan), np.full((bolts, 2, count), np.nan)
    for b in range(bolts):
        found = shank_forces(structure, b, u)
        if found is not None:
            moments[b], shear[b] = found.moments, found.shear
    carried = np.zeros((len(patches), 5, count))
    tractions = {
        k: np.stack([s.k_n, s.k_t, s.k_t], axis=1)[:, :, None] * (s.interface.relative @ u).reshape(-1, 3, count)
        for k, s in enumerate(springs)
        if any(patch.joint == k for patch in patches)
    }
    for row, patch in zip(carried, patches, strict=True):
        traction, pressed = tractions[patch.joint], patch.pressed
        weights = structure.joints[patch.joint].interface.weights
        row[0] = np.einsum("q,qk->k", (weights * pressed.some), traction[:, 0])
        row[1:4], torque = pressed.loads(traction[:, 1:])
        row[4] = torque / pressed.reach if pressed.reach > 0 else 0.0
    return {
        "motion": u.reshape(-1, 3, count)[nodes],
        "axial": structure.bolt_force_operator @ u,
        "moments": moments,
        "across": shear,
        "carried": carried,
    }
