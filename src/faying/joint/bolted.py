"""A bolted structure: meshed parts, the joints between them, the bolts that pull them together, what supports them."""

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from math import inf
from typing import TYPE_CHECKING, Any, Self, cast

import numpy as np

from faying.bolt.bolt import Bolt, FittedBolt, solid_of
from faying.bolt.dowel import Dowel, FittedDowel
from faying.bolt.solid_bolt import FittedSolidBolt, SolidBolt
from faying.errors import FayingError, InputError
from faying.fe.bonded import CLOSE, matched
from faying.fe.elasticity import Solid
from faying.fe.interface import Interface, join
from faying.fe.mesh import Mesh
from faying.fe.outline import Outline, outline
from faying.fe.quality import quality
from faying.joint.assembled_parts import AssembledParts, added
from faying.joint.attachments import PointMass, Support
from faying.joint.equilibrium import PreloadState
from faying.joint.figure import Fastening, structure_axes
from faying.joint.joint import FittedJoint, Joint, each_pair_once, known_face
from faying.joint.joint_law import JointLaw, all_predict_loss
from faying.joint.loaded_before import in_service, loaded_before
from faying.joint.preload import PreloadProblem
from faying.joint.preload_case import NO_MEMORY
from faying.joint.springs import Springs
from faying.materials import STIFFEST, Material, material_of
from faying.misuse import checked_call, shortened
from faying.notes import Note
from faying.numerics.constraint import constrain
from faying.numerics.solve import BY_PARTS, Factoriser, chosen
from faying.style import Summary
from faying.text import listed, notes_row, titled
from faying.typing import Array, Index
from faying.units import show

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MAX_JOINTS = 4  # that a summary has a line for


@dataclass(frozen=True, init=False, repr=False)
class BoltedStructure(Summary):
    """Parts, joints, bolts, dowels and supports, as `faying.Structure` says, and what is assembled of them."""

    mesh: Mesh
    materials: Mapping[str, Solid]
    joints: tuple[FittedJoint, ...]
    bolts: tuple[Bolt | SolidBolt, ...]
    supports: tuple[Support, ...]
    masses: tuple[PointMass, ...]
    dowels: tuple[Dowel, ...]
    assembled: AssembledParts | None = field(repr=False, compare=False)

    def __init__(
        self,
        mesh: Mesh,
        materials: str | Material | Mapping[str, str | Solid],
        joints: Sequence[Joint | FittedJoint],
        bolts: Sequence[Bolt | SolidBolt] = (),
        *,
        supports: Sequence[Support] = (),
        masses: Sequence[PointMass] = (),
        dowels: Sequence[Dowel] = (),
        assembled: AssembledParts | None = None,
    ) -> None:
        of_parts = materials_of_parts(mesh, materials)
        for bolt in bolts:
            for face in bolt.faces:
                known_face(mesh, face, f"bolt {bolt.name!r}")
        for dowel in dowels:
            for wall in dowel.walls:
                known_face(mesh, wall, f"dowel {dowel.name!r}")
        for support in supports:
            for face in filter(None, (support.face, support.edge)):
                known_face(mesh, face, "support")
        placed = tuple(
            joint.fitted(mesh, of_parts, number) if isinstance(joint, Joint) else joint
            for number, joint in enumerate(joints, start=1)
        )
        vars(self).update(
            mesh=mesh,
            materials=of_parts,
            joints=placed,
            bolts=tuple(bolts),
            supports=tuple(supports),
            masses=tuple(masses),
            dowels=tuple(dowels),
            assembled=assembled,
        )
        self._check()

    def _check(self) -> None:
        faces = [face for joint in self.joints for face in joint.faces] + [support.face for support in self.supports]
        met = {self.mesh.face_part[face] for face in faces if face in self.mesh.face_part}
        solid = [bolt for bolt in self.bolts if isinstance(bolt, SolidBolt)]
        meshed = [bolt.part for bolt in solid]
        twice = sorted({part for part in meshed if meshed.count(part) > 1})
        if twice:
            raise InputError(f"part {', '.join(twice)} is two solid bolts; a part is drawn in once, with one preload")
        for joint in self.joints:
            if fault := nothing_moves(joint.name, [face for face in joint.faces if self.mesh.is_shared(face)]):
                raise InputError(fault)
        faces += [face for bolt in solid for face in bolt.faces if self.mesh.is_shared(face, wholly=False)]
        faces += [face for tie in self.mesh.ties for face in tie]
        for bolt in solid:
            if fault := seat_apart(bolt, faces):
                raise InputError(fault)
        if fault := loose_parts(self.mesh.bodies, met):
            raise InputError(fault)
        for what, things in (("joints", self.joints), ("bolts", self.bolts), ("dowels", self.dowels)):
            names = [thing.name for thing in things]
            again = sorted({name for name in names if names.count(name) > 1})
            if again:
                raise InputError(f"two {what} are called {again[0]!r}; give each a name of its own")
        each_pair_once({joint.name: joint.faces for joint in self.joints})
        assembled = AssembledParts(
            mesh=self.mesh,
            materials=self.materials,
            joint_faces=tuple(face for joint in self.joints for face in joint.faces),
            bolts=self.bolts,
            supports=self.supports,
            masses=self.masses,
            dowels=self.dowels,
        )
        if self.assembled is None or not self.assembled.same(assembled):
            if fault := overlapping(self.mesh, {joint.name: joint.faces for joint in self.joints}):
                raise InputError(fault)
            object.__setattr__(self, "assembled", assembled)

    @property
    def _assembled(self) -> AssembledParts:
        assert self.assembled is not None
        return self.assembled

    @property
    def matrices(self) -> tuple[Any, Any]:
        """Stiffness [N/m] and mass [kg] of the parts alone."""
        return self._assembled.matrices

    @property
    def mass(self) -> float:
        """Mass of the parts [kg]."""
        return float(self.matrices[1].sum()) / 3

    @property
    def fixed(self) -> Index:
        """Unknowns that supports keep at rest."""
        return self._assembled.fixed

    @property
    def fitted_bolts(self) -> tuple[FittedBolt | FittedSolidBolt, ...]:
        """The bolts in their places."""
        return self._assembled.fitted_bolts

    @property
    def fitted_dowels(self) -> tuple[FittedDowel, ...]:
        """The dowels in their places."""
        return self._assembled.fitted_dowels

    @property
    def bolt_force_operator(self) -> Array:
        """What a displacement adds to the force of each bolt (bolts, unknowns) [N/m]; 0 for a bolt without a shank."""
        return np.array([bolt.pull for bolt in self.fitted_bolts]).reshape(-1, self.mesh.unknowns)

    def strained(self, preload: PreloadState) -> Array:
        """What strains the parts under a preload [m] (unknowns,): its motion, and how far meshed bolts are drawn in."""
        u = preload.displacement
        pairs = zip(self.fitted_bolts, preload.bolt_forces, strict=True)
        drawn = [bolt.drawn_in(u, force) for bolt, force in pairs if isinstance(bolt, FittedSolidBolt)]
        return np.asarray(u + sum(drawn))

    @property
    def predicts_loss(self) -> bool:
        """Whether the laws of all joints give a loss factor."""
        return all_predict_loss([joint.law for joint in self.joints])

    @property
    def loads(self) -> Array:
        """Nodal forces [N] (unknowns, bolts) of 1 N in each bolt."""
        return self._assembled.loads

    @property
    def supported_stiffness(self) -> Any:
        """Stiffness [N/m] of the parts, of dowels and of elastic supports, before any bolt is tight."""
        return self._assembled.supported_stiffness

    @property
    def dynamic_matrices(self) -> tuple[Any, Any]:
        """Stiffness [N/m] and mass [kg] of all but the joints, dowels and masses included; fixed ones cleared."""
        return self._assembled.dynamic_matrices

    def elastic_forces(self, displacement: Array) -> Array:
        """Forces [N] (unknowns,) with which parts, dowels, springs and tight bolts resist a displacement [m]."""
        return self._assembled.elastic_forces(displacement)

    def inertia(self, acceleration: Array) -> Array:
        """Mass of all that moves times an acceleration [m/s2] (unknowns,), that of fixed unknowns included [N]."""
        return self._assembled.inertia(acceleration)

    @property
    def is_parts_only(self) -> bool:
        """Whether the parts under preload are all that vibrates: no bolt or dowel adds a stiffness or a mass."""
        return self._assembled.is_parts_only

    @property
    def rigid(self) -> Array:
        """Rigid motions of the whole that no support resists (unknowns, up to 6)."""
        return self._assembled.rigid

    @property
    def rigid_count(self) -> int:
        """Number of rigid motions that no support resists, 0 to 6."""
        return int(self.rigid.shape[1])

    def unjoined_motions(self) -> Array:
        """Motions (unknowns, r) of the parts, each rigid by itself, that nothing resists with all joints apart."""
        return self._assembled.unjoined_motions()

    @property
    def shift_frequency(self) -> float:
        """A frequency below the first elastic mode of any compact body of this size [Hz]: 0.02 c/size."""
        return self._assembled.shift_frequency

    def solver(self, name: str | None = None) -> str | Factoriser:
        """What factorises the matrices of this structure, by the name that a study gives; part by part if need be.

        Where no name is given, that is where one factor of the whole would take more than half of the free memory.

        Raises:
            InputError: there is no such solver here.
        """
        way = chosen(name)
        if len(self.mesh.bodies) < 2 or way not in ("pardiso", BY_PARTS):
            return way
        if way == "pardiso" and (name or not self._assembled.is_large):
            return way
        return self._assembled.by_parts

    @property
    def notes(self) -> tuple[Note, ...]:
        """What the mesh left out, how good its elements are, and what was chosen for bolts and dowels."""
        bolts = [note for bolt in self.fitted_bolts if isinstance(bolt, FittedBolt) for note in bolt.notes]
        joints = [note for joint in self.joints for note in joint.notes]
        dowels = [note for dowel in self.fitted_dowels for note in dowel.notes]
        return (*self.mesh.notes, *joints, *quality(self.mesh).notes, *bolts, *dowels)

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading and what the structure consists of."""
        return structure_rows(self)

    @checked_call
    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the parts, with the faces of joints and bolts in colours of their own.

        Args:
            ax: Matplotlib axes with three dimensions to draw into; new ones where None.

        Returns:
            The axes.
        """
        shown: list[Fastening] = [("joint", joint.name, joint.faces, None) for joint in self.joints]
        fitted = zip(self.bolts, self.fitted_bolts, strict=True)
        shown += [("bolt", bolt.name, bolt.faces, place.seats) for bolt, place in fitted]
        pins = zip(self.dowels, self.fitted_dowels, strict=True)
        shown += [("dowel", dowel.name, dowel.walls, place.seats) for dowel, place in pins]
        shown += [("support", support.face, (support.face,), None) for support in self.supports]
        return structure_axes(self.surface(), self.mesh.points, shown, ax)

    def with_joints(
        self,
        *,
        laws: Sequence[JointLaw] | None = None,
        friction: Sequence[float | None] | None = None,
        gaps: Sequence[Array] | None = None,
    ) -> Self:
        """Return the structure with other numbers of its joints; what is assembled of the parts serves it, too.

        Args:
            laws: Law of each joint; as they are where None.
            friction: Coefficient of each joint [-].
            gaps: Gap of each joint [m] (q,) before any load.
        """
        joints = tuple(
            replace(
                joint,
                law=joint.law if laws is None else laws[k],
                friction=joint.friction if friction is None else friction[k],
                interface=joint.interface if gaps is None else replace(joint.interface, gap=gaps[k]),
            )
            for k, joint in enumerate(self.joints)
        )
        return replace(self, joints=joints)

    def under(self, preload: PreloadState) -> Self:
        """Return the structure with the laws that its joints have under a preload: those of what was carried before."""
        return self.loaded_before(preload.carried)

    def in_service(self, preload: PreloadState) -> Self:
        """Return the structure with the laws that its joints have under loads about a preload, which they remember."""
        pairs = zip(self.joints, preload.pressures, strict=True)
        return self.with_joints(laws=[in_service(joint.law, pressure) for joint, pressure in pairs])

    def loaded_before(self, carried: Sequence[Array]) -> Self:
        """Return the structure whose joints have carried greatest pressures [Pa] (q,) before; () for first loading."""
        laws = [joint.law.first_loading for joint in self.joints]
        if carried:
            per_node = [joint.name for joint in self.joints if joint.per_node]
            if per_node:
                raise InputError(NO_MEMORY.format(per_node[0]))
            laws = [loaded_before(law, most) for law, most in zip(laws, carried, strict=True)]
        elif all(law is joint.law for law, joint in zip(laws, self.joints, strict=True)):
            return self
        return self.with_joints(laws=laws)

    @checked_call
    def alone(self, part: str) -> Self:
        """Return one part by itself, free: no joint, bolt, support or mass.

        Args:
            part: Name of the part.

        Raises:
            InputError: There is no such part.
        """
        mesh, nodes = self.mesh, self.mesh.part_nodes(part)
        blocks = tuple(np.searchsorted(nodes, cells) for cells in mesh.parts[part])
        own = Mesh(points=mesh.points[nodes], parts={part: blocks}, faces={}, face_part={}, source=mesh.source)
        return type(self)(own, {part: self.materials[part]}, [])

    def assembly(self, *, solver: str | None = None) -> PreloadProblem:
        """Return the preload problem of this structure."""
        problem = PreloadProblem(
            self.supported_stiffness,
            self.matrices[1],
            self.rigid,
            [(joint.interface, joint.law) for joint in self.joints],
            shift_frequency=self.shift_frequency,
            solver=self.solver(solver),
            friction=[joint.friction for joint in self.joints],
            fixed=self.fixed,
        )
        problem.vertices = self._assembled.vertices
        return problem

    def coupled(self, springs: Sequence[Springs[Interface]], *, viscous: bool = False) -> tuple[Any, Any]:
        """Stiffness [N/m] with the springs of all joints, and their loss; fixed unknowns cleared.

        The loss is the imaginary part of the stiffness [N/m], or where viscous the damping [N s/m] of the JK paper.
        """
        stiffness = self.dynamic_matrices[0] + self.joint_stiffness(springs)
        return stiffness, self.joint_loss(springs, viscous=viscous)

    def joint_stiffness(self, springs: Sequence[Springs[Interface]]) -> Any:
        """Stiffness [N/m] of the springs of all joints alone; fixed unknowns cleared."""
        return added(self._nothing, [constrain(s.stiffness(), self.fixed, 0.0) for s in springs])

    def joint_loss(self, springs: Sequence[Springs[Interface]], *, viscous: bool = False) -> Any:
        """The loss of the springs of all joints, as `coupled` gives it."""
        losses = [s.viscous(self.mass) if viscous else s.loss() for s in springs if s.lossy]
        return added(self._nothing, [constrain(loss, self.fixed, 0.0) for loss in losses])

    @property
    def _nothing(self) -> Any:
        """A stiffness [N/m] without entries."""
        from scipy.sparse import csr_array

        return csr_array(self.matrices[0].shape)

    def springs(self, pressures: Sequence[Array]) -> tuple[Springs[Interface], ...]:
        """Return the springs of every joint, as they are assembled.

        Args:
            pressures: Pressure [Pa] at the points of each joint's interface, one array per joint.

        Returns:
            For each joint: the points of its springs with their share of the area, the pressure there, k_n, k_t and
            both loss factors. With springs per node the points are nodes.
        """
        return tuple(joint.springs(pressure) for joint, pressure in zip(self.joints, pressures, strict=True))

    def tie_of(self, faces: tuple[str, str]) -> Any:
        """Stiffness [N/m] that ties two faces which meet; see `tie_stiffness`."""
        return self._assembled.tie(faces)

    def bonded(self) -> Any | None:
        """Return the map that bonds the faces of every joint; see `bond`."""
        return bond(self.mesh, [joint.faces for joint in self.joints], [joint.interface.area for joint in self.joints])

    def tied(self) -> Any:
        """Stiffness [N/m] that bonds the faces of every joint where their nodes do not match; fixed ones cleared."""
        ties = added(None, [self._assembled.tie(joint.faces) for joint in self.joints])
        return constrain(ties, self.fixed, 0.0)

    def outline(self) -> tuple[Index, Index]:
        """Nodes of the outer surface and triangles between them (t, 3), for pictures."""
        surface = self.surface()
        return surface.nodes, surface.triangles

    def surface(self) -> Outline:
        """The outer surface with parts and faces; a triangle on several faces belongs to that of a joint."""
        used = [face for joint in self.joints for face in joint.faces]
        used += [face for bolt in self.bolts for face in bolt.faces]
        used += [wall for dowel in self.dowels for wall in dowel.walls] + [support.face for support in self.supports]
        return outline(self.mesh, used)

    @property
    def part_masses(self) -> Array:
        """Mass of each part [kg] (p,), without bolts and point masses."""
        volumes = self.mesh.volumes
        return np.array([(self.materials[part].density or 0.0) * volumes[part] for part in self.mesh.parts])


def nothing_moves(joint: str, shared: Sequence[str]) -> str:
    """What there is to say of a joint with faces all of whose nodes are of another part, too; "" without such faces."""
    if not shared:
        return ""
    return (
        f"joint {joint!r}: every node of its face {shared[0]!r} is one with another part, so that nothing moves there; "
        "leave the joint out, or name the face on both sides in the mesh file"
    )


def overlapping(mesh: Mesh, joints: Mapping[str, tuple[str, str]]) -> str:
    """What there is to say of two joints, name -> faces, with the same sides on both of their faces; "" without any."""

    def shared(one: str, other: str) -> bool:
        if one == other or mesh.face_part[one] != mesh.face_part[other]:
            return one == other
        if not len(np.intersect1d(mesh.face_nodes(one), mesh.face_nodes(other))):
            return False  # at once, where pads lie side by side
        first, second = (
            {tuple(sorted(side)) for block in mesh.face(face) for side in block.tolist()} for face in (one, other)
        )
        return bool(first & second)

    for (first, faces), (second, others) in combinations(joints.items(), 2):
        if all(any(shared(face, other) for other in others) for face in faces):
            listed = ", ".join(map(repr, (*faces, *others)))
            return (
                f"joints {first!r} and {second!r} join some of the same sides of their faces {listed}, which would "
                "count twice; leave one out, or give faces that do not overlap"
            )
    return ""


def seat_apart(bolt: SolidBolt, faces: Container[str]) -> str:
    """What there is to say of a meshed bolt with a face that is in no joint and no support; "" where both are."""
    apart = [face for face in bolt.faces if face not in faces]
    if not apart:
        return ""
    return (
        f"bolt {bolt.name!r}: its face {apart[0]!r} is in no joint; add a [[joint]] of it and the seat that it presses"
    )


def loose_parts(bodies: Sequence[Sequence[str]], met: Container[str]) -> str:
    """What there is to say of parts that no joint and no support holds, themselves or by a bond; "" where all are."""
    loose = [part for body in bodies for part in body if not any(one in met for one in body)]
    if not loose or len(bodies) < 2:
        return ""
    return (
        f"part {', '.join(loose)} has no joint; add a [[joint]] of one of its faces (bonded = true where it is welded "
        "or glued), or name it in geometry.leave_out"
    )


def materials_of_parts(mesh: Mesh, given: str | Material | Mapping[str, str | Solid]) -> Mapping[str, Solid]:
    """Part -> its material. Raises InputError where one is missing, unknown, or no solid that vibrates."""
    if isinstance(given, str | Material):
        one = material_of(given)
        found: Mapping[str, Solid] = dict.fromkeys(mesh.parts, one)
    else:
        lacking = [part for part in mesh.parts if part not in given]
        absent = [part for part in given if part not in mesh.parts]
        if lacking or absent:
            wrong = (
                f"say nothing about part {lacking[0]!r}" if lacking else f"name part {absent[0]!r}, which is not there"
            )
            raise InputError(f"the materials {wrong}; the parts of the mesh are {', '.join(map(repr, mesh.parts))}")
        found = {part: solid_of(value, f"part {part!r}") for part, value in given.items()}
        if all(found[part] is value for part, value in given.items()):
            found = cast(Mapping[str, Solid], given)  # the same mapping: what is assembled for it is used again
    return _checked_solids(found)


def _checked_solids(found: Mapping[str, Solid]) -> Mapping[str, Solid]:
    """The materials of parts. Raises InputError for one that no solid element can have."""
    for part, material in found.items():
        name = getattr(material, "name", shortened(material))
        if material.density is None or not 0 < material.E < inf:
            lack = "no density" if material.density is None else f"E = {material.E:g} Pa"
            raise InputError(f"part {part!r}: material {name!r} has {lack}; modes need E and a density that are finite")
        if material.nu > STIFFEST:
            raise InputError(
                f"part {part!r}: material {name!r} has nu = {material.nu:g}, and solid elements lock near 0.5; give at "
                f"most {STIFFEST:g}"
            )
    return found


def merged(matrix: Any, merge: Any) -> Any:
    """A sparse matrix on fewer unknowns, those that `bond` makes: merge' @ matrix @ merge in a fifth of the time."""
    from scipy.sparse import csr_array

    columns = csr_array((matrix.data, merge.indices[matrix.indices], matrix.indptr), shape=merge.shape)
    return merge.T.tocsr() @ columns


def bond(mesh: Mesh, pairs: Sequence[tuple[str, str]], areas: Sequence[float] | None = None) -> Any | None:
    """Return the sparse map (unknowns, fewer) that bonds pairs of faces node by node.

    None where the meshes of a pair do not match where its faces meet; areas: over which they do [m2].
    """
    from scipy.sparse import csr_array, get_index_dtype
    from scipy.sparse.csgraph import connected_components

    n, found = len(mesh.points), []
    for number, faces in enumerate(pairs):
        area = join(mesh, *faces).area if areas is None else areas[number]
        met = matched(mesh, faces, area, CLOSE * mesh.size)
        if met is None:
            return None
        found.append(met)
    ends = tuple(np.concatenate(found, axis=1))
    # a node of several joints is bonded to all that it meets in any of them
    _, column = connected_components(csr_array((np.ones(len(ends[0])), ends), shape=(n, n)), directed=False)
    count = int(column.max()) + 1
    columns = (3 * column.reshape(-1, 1) + np.arange(3)).ravel()
    short = get_index_dtype(maxval=3 * n + 1)  # what is merged by long indices keeps them
    pieces = np.ones(3 * n), columns.astype(short), np.arange(3 * n + 1, dtype=short)
    return csr_array(pieces, shape=(3 * n, 3 * count))


def structure_rows(structure: BoltedStructure) -> tuple[str, dict[str, str]]:
    """A heading, and what stands below it in a summary of a structure."""
    mesh, rows = structure.mesh, {}
    names = [str(getattr(m, "name", "")) or f"E {show(m.E, 'Pa')}" for m in structure.materials.values()]
    head = (
        f"BoltedStructure: {listed(mesh.parts)}; {mesh.unknowns:,} unknowns, {show(structure.mass, 'kg')}, "
        f"{show(mesh.size, 'm')} from corner to corner"
    )
    rows["materials"] = listed(dict.fromkeys(names))
    shown = structure.joints[:MAX_JOINTS]
    for joint in shown:
        slip = "sticks" if joint.friction is None else f"friction {joint.friction:g}"
        rows[titled("joint", joint.name)] = (
            f"{joint.faces[0]} on {joint.faces[1]}, {joint.interface.area * 1e6:.4g} mm^2, "
            f"law {joint.law.model.name}, {slip}"
        )
    if len(structure.joints) > len(shown):
        rows["more joints"] = str(len(structure.joints) - len(shown))
    if structure.bolts:
        meshed = sum(isinstance(bolt, SolidBolt) for bolt in structure.bolts)
        stiff = sum(bolt.diameter is not None for bolt in structure.bolts)
        kinds = {"without stiffness": len(structure.bolts) - stiff - meshed, "with a shank": stiff, "meshed": meshed}
        words = ", ".join(f"{count} {kind}" for kind, count in kinds.items() if count)
        rows["bolts"] = f"{listed(bolt.name for bolt in structure.bolts)} ({words})"
    if structure.dowels:
        rows["dowels"] = listed(dowel.name for dowel in structure.dowels)
    if structure.supports:
        rows["supports"] = listed(support.face for support in structure.supports)
    if structure.masses:
        rows["point masses"] = f"{len(structure.masses)}, {show(sum(m.mass for m in structure.masses), 'kg')}"
    try:
        notes = structure.notes
    except FayingError as fault:  # a bolt that does not fit, which the solution says as well
        rows["fault"] = shortened(str(fault))
    else:
        rows |= notes_row(notes)
    return head, rows
