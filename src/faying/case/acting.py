"""From a load case to nodal forces, displacements of supports and free lengthening of bolts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faying.bolt.bolt import FittedBolt
from faying.errors import InputError
from faying.fe.attach import mean_motion
from faying.fe.elasticity import rigid_motions
from faying.fe.nodal_forces import pressure_forces, thermal_forces
from faying.fe.sides import face_centre
from faying.joint.attachments import nearest_node
from faying.joint.bolted import BoltedStructure
from faying.joint.joint import known_face
from faying.study.load import Displacement, Force, Load, no_expansion, not_held, not_there
from faying.typing import Array
from faying.units import show

BALANCED = 1e-6  # of the forces: what a load may leave over where nothing holds the structure


@dataclass(frozen=True, kw_only=True)
class Acting:
    """What a case does to a structure.

    Args:
        force: Nodal forces [N] (unknowns,), those of heated parts and bolts included.
        moved: Displacements [m] (unknowns,) that supports prescribe; elsewhere a rigid motion that is near to them.
        longer: Free lengthening [m] (bolts,) of bolts that are beams, by heat.
        strains: Part -> free expansion [-] by heat; stresses are those of the strain less this.
    """

    force: Array
    moved: Array
    longer: Array
    strains: Mapping[str, float]

    def __add__(self, other: "Acting") -> "Acting":
        """Return both together."""
        return Acting(
            force=self.force + other.force,
            moved=self.moved + other.moved,
            longer=self.longer + other.longer,
            strains=dict(self.strains) | {part: self.strains.get(part, 0.0) + e for part, e in other.strains.items()},
        )

    def times(self, factor: float) -> "Acting":
        """Return it with a factor [-] on all."""
        return Acting(
            force=factor * self.force,
            moved=factor * self.moved,
            longer=factor * self.longer,
            strains={part: factor * strain for part, strain in self.strains.items()},
        )


def nothing(structure: BoltedStructure) -> Acting:
    """Return what a case without any load does."""
    none = np.zeros(structure.mesh.unknowns)
    return Acting(force=none, moved=none, longer=np.zeros(len(structure.bolts)), strains={})


def acting(structure: BoltedStructure, loads: Sequence[Load]) -> dict[str, Acting]:
    """Return what each case does, by its name; cases come after those that they name.

    Raises:
        InputError: A face, a part, a bolt or a support is not there, a material has no expansion, or nothing holds the
            structure against what is left over of a load.
    """
    out: dict[str, Acting] = {}
    sizes: dict[str, float] = {}  # of all forces that go into a case [N], which may cancel out
    for load in loads:
        total = _own(structure, load)
        size = float(np.linalg.norm(total.force))
        for name, factor in load.combine.items():
            total, size = total + out[name].times(factor), size + abs(factor) * sizes[name]
        out[load.name], sizes[load.name] = total, size
    for name, found in out.items():
        check_supported(structure, name, found.force, sizes[name])
    return out


def _own(structure: BoltedStructure, load: Load) -> Acting:
    mesh, what = structure.mesh, f"load {load.name!r}"
    force = np.zeros(mesh.unknowns)
    for one in load.forces:
        force += nodal_force(structure, one, what)
    for pressure in load.pressures:
        known_face(mesh, pressure.face, what)
        force += pressure.pressure * pressure_forces(mesh, pressure.face)
    if any(load.acceleration):
        force -= structure.inertia(np.tile(np.array(load.acceleration), len(mesh.points)))
    heat, longer, strains = _heat(structure, load.temperature, what)
    moved = np.zeros((len(mesh.points), 3))
    for displacement in load.displacements:
        _move(structure, displacement, moved, load.name)
    return Acting(force=force + heat, moved=_with_all_moved(structure, moved.ravel()), longer=longer, strains=strains)


def _with_all_moved(structure: BoltedStructure, moved: Array) -> Array:
    """What supports prescribe [m] (unknowns,), with the rest moved along rigidly as is nearest to it.

    The answer does not depend on how the rest is moved, but rounding does: a rigid motion of all costs no energy.
    """
    fixed = structure.fixed
    if not np.any(moved):
        return moved
    rigid = rigid_motions(structure.mesh.points)
    along = rigid @ np.linalg.lstsq(rigid[fixed], moved[fixed], rcond=None)[0]
    along[fixed] = moved[fixed]
    return np.asarray(along)


def nodal_force(structure: BoltedStructure, one: Force, what: str) -> Array:
    """Nodal forces [N] (unknowns,) of a force and a moment on a face, or of a force at a point."""
    mesh = structure.mesh
    if one.face is None:
        assert one.point is not None
        force = np.zeros((len(mesh.points), 3))
        force[nearest_node(mesh, one.point, f"{what}: force")] = one.force
        return force.ravel()
    known_face(mesh, one.face, what)
    centre, _, _ = face_centre(mesh.points, mesh.face(one.face))
    motion = mean_motion(mesh.points, mesh.face(one.face), centre if one.point is None else np.array(one.point))
    return np.asarray(motion.T @ np.array([*one.force, *one.moment]))


def _heat(structure: BoltedStructure, changes: Mapping[str, float], what: str) -> tuple[Array, Array, dict[str, float]]:
    """Nodal forces [N] of heated parts and bolts, free lengthening [m] of the bolts and strain [-] of the parts."""
    mesh, bolts = structure.mesh, structure.fitted_bolts
    force, longer, strains = np.zeros(mesh.unknowns), np.zeros(len(bolts)), {}
    names = [bolt.bolt.name for bolt in bolts]
    for name, change in changes.items():
        beam = name in names and isinstance(bolts[names.index(name)], FittedBolt)
        if name in mesh.parts and beam:
            raise InputError(
                f"{what}: temperature of {name!r} may mean the part or the bolt of that name; rename the bolt"
            )
        if name in mesh.parts:
            material = structure.materials[name]
            strains[name] = _expansion(material, f"{what}: part {name!r}") * change
            force += thermal_forces(mesh, name, material, strains[name])
        elif beam:
            fitted = bolts[names.index(name)]
            assert isinstance(fitted, FittedBolt)
            if fitted.bolt.material is None:
                raise InputError(
                    f"{what}: bolt {name!r} is a force without a shank, which no temperature changes; give it diameter "
                    "and material, or leave out its temperature"
                )
            strain = _expansion(fitted.bolt.material, f"{what}: bolt {name!r}") * change
            # between its ends in the parts, where an even expansion of all leaves its force; washers grow with it
            longer[names.index(name)] = -strain * float(fitted.load @ mesh.points.ravel())
            force -= fitted.axial_stiffness * longer[names.index(name)] * fitted.load
        else:
            if name in names:
                part = getattr(bolts[names.index(name)].bolt, "part", "")
                raise InputError(f"{what}: bolt {name!r} is meshed; give the temperature of its part, {part!r}")
            raise InputError(not_there(what, name, (*mesh.parts, *names)))
    return force, longer, strains


def _expansion(material: object, what: str) -> float:
    found = getattr(material, "expansion", None)
    if found is None:
        raise InputError(no_expansion(what, getattr(material, "name", "")))
    return float(found)


def _move(structure: BoltedStructure, one: Displacement, moved: Array, load: str) -> None:
    """Put the displacement of a supported face in its place."""
    what = f"load {load!r}"
    known_face(structure.mesh, one.face, what)
    nodes = structure.mesh.face_nodes(one.face)
    supported = np.zeros(structure.mesh.unknowns, dtype=bool)
    supported[structure.fixed] = True
    for axis, size in enumerate(one.displacement):
        if not size:
            continue
        if not supported[3 * nodes + axis].all():
            raise InputError(not_held(load, one.face, "xyz"[axis]))
        taken = (moved[nodes, axis] != 0) & (moved[nodes, axis] != size)
        if np.any(taken):
            raise InputError(
                f"{what}: the face {one.face!r} is moved along {'xyz'[axis]} by {show(size, 'm')}, and some of its "
                f"nodes by {show(float(moved[nodes, axis][taken][0]), 'm')} in another displacement; give one of them"
            )
        moved[nodes, axis] = size


def check_supported(structure: BoltedStructure, name: str, force: Array, scale: float) -> None:
    """Raise InputError where nothing holds a structure against what is left over of a load [N] (unknowns,).

    scale: size of the forces that went into it [N], to which rounding is.
    """
    if not structure.rigid.size:
        return
    rigid = np.linalg.qr(structure.rigid)[0]
    net = float(np.linalg.norm(rigid.T @ force))
    if net > BALANCED * scale:
        forces, arms = force.reshape(-1, 3), structure.mesh.points - structure.mesh.points.mean(axis=0)
        total, moment = forces.sum(axis=0), np.cross(arms, forces).sum(axis=0)
        left = [
            ", ".join(f"{one if abs(one) > BALANCED * least else 0.0:.4g}" for one in sums)
            for sums, least in ((total, scale), (moment, scale * np.ptp(arms, axis=0).max()))
        ]
        raise InputError(
            f"load {name!r} does not balance: forces of ({left[0]}) N and moments of ({left[1]}) N m about the "
            "middle are left over, and nothing holds the structure against them; add a [[support]], or loads in balance"
        )
