"""From a study to its case: mesh, joints with their laws, bolts, supports, all ready to be solved."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from faying.case.hammer import Hammer
from faying.case.places import named_points, on_structure
from faying.contact.build import AUTO
from faying.contact.mates import takes_fit
from faying.contact.models.half_space import HalfSpace
from faying.errors import InputError
from faying.fe.bonded import bonded_mesh
from faying.fe.interface import Interface, join
from faying.fe.mesh import Mesh
from faying.fe.solids import bodies_of
from faying.files import end_of
from faying.joint.bolted import loose_parts
from faying.joint.equilibrium import PreloadState
from faying.joint.joint import FittedJoint, with_form
from faying.joint.joint_law import JointLaw
from faying.joint.modal import Engine, ModalProblem
from faying.joint.state import engine_for
from faying.joint.strength import bolt_notes, material_notes
from faying.joint.structure import Structure
from faying.materials import Material
from faying.measured.mapping import PointMap
from faying.notes import Note
from faying.progress import Report
from faying.study.keys.geometry import mesh_of
from faying.study.keys.joint import JointChoice
from faying.study.keys.law import LawChoice
from faying.study.keys.surface import NO_SURFACE, Surface, SurfaceChoice
from faying.study.load import Displacement, Force, Pressure, no_expansion, not_held, not_there
from faying.study.study import Study
from faying.study.vibration import held_still, not_along
from faying.study.vibration import not_held as not_shaken
from faying.typing import Array
from faying.units import show

SIZES = 3e-3, 30.0  # m: a structure smaller or larger than these is noted, for its unit may be wrong
SNAP_ROUNDING = 1e-6  # of snap: less is rounding
Read = Mapping[SurfaceChoice, Surface]  # surfaces by what they were read from


@dataclass
class Progress:
    """Counts the stages of long work and reports each as it begins: (stage, stages done, stages in all)."""

    total: int
    report: Report | None = None
    done: int = field(default=0, init=False)

    def begin(self, stage: str) -> None:
        """Report the next stage."""
        if self.report is not None:
            self.report(stage, self.done, self.total)
        self.done += 1


@dataclass(frozen=True, kw_only=True)
class Case:
    """A study that is ready to be solved.

    Args:
        study, structure: what was asked, and what it is made into.
        surfaces: the surface of each joint.
        hammer, test_points: the hammer test where the study names a file, and where its points lie on the outline.
        notes: what there is to say before anything is solved.
    """

    study: Study
    structure: Structure
    surfaces: tuple[Surface, ...]
    hammer: Hammer | None = None
    test_points: PointMap | None = None
    notes: tuple[Note, ...] = ()

    @classmethod
    def of(cls, study: Study, progress: Progress | None = None, read: Read | None = None) -> "Case":
        """Read the surfaces, mesh the parts, lay the laws on the joints. Raises InputError and ReadError.

        read: surfaces that have been read already.
        """
        progress = progress or Progress(0)
        hammer = None
        study = replace(study, part_tests={name: test.read() for name, test in study.part_tests.items()})
        if study.hammer is not None:
            progress.begin("hammer test")
            hammer = Hammer.read(study.hammer)
        progress.begin("surface")
        surfaces = surfaces_of(study, read)
        laws = checked_laws(study, surfaces)
        progress.begin("mesh")
        structure = structure_of(study, checked_mesh(study), surfaces, laws)
        for _, what, point in named_points(study):
            on_structure(what, point, structure.mesh)
        notes = [Note(code="surface", text=text) for text in fit_warnings(study, surfaces)]
        known = {note.text for note in notes}
        tables = [file for file in study.files if file != study.geometry.file]  # readers of meshes look for themselves
        ends = [text for file in tables for text in end_of(file)]
        notes += [Note(code="file-end", text=text) for text in ends if text not in known]
        size = structure.mesh.size
        if not SIZES[0] <= size <= SIZES[1]:
            text = (
                f"the structure measures {size:.4g} m from corner to corner; if it should not, the unit of its "
                "geometry is wrong"
            )
            notes.append(Note(code="size", severity="limit", text=text))
        notes += (*law_reasons(structure, surfaces), *structure.notes)
        notes += (*material_notes(structure), *bolt_notes(structure, study.bolt_forces))
        return cls(
            study=study,
            structure=structure,
            surfaces=surfaces,
            hammer=hammer,
            test_points=None if hammer is None else hammer.points(structure),
            notes=tuple(notes),
        )

    @property
    def read(self) -> Read:
        """Surfaces that have been read for this case, which need not be read again for another law."""
        return read_for(self.study, self.surfaces)

    def under(self, preload: PreloadState) -> Self:
        """The case with the laws that its joints have under a preload."""
        return replace(self, structure=self.structure.under(preload))

    @property
    def loads(self) -> Array:
        """Preloads of the first bolt [N]."""
        return np.array(self.study.loads)

    @property
    def shift_frequency(self) -> float:
        """Where the modes are looked for [Hz]."""
        return self.modal.shift_frequency

    @property
    def rigid_count(self) -> int:
        """Rigid motions that nothing resists."""
        return self.modal.rigid_count

    @property
    def modal(self) -> ModalProblem:
        """What is asked about the modes."""
        return ModalProblem(structure=self.structure, choice=self.study.modes)

    def engine(self, name: str) -> Engine:
        """The engine of a name. Raises InputError for another name than `ENGINES` has."""
        return engine_for(name, self.modal, self.study.preloads)


def law_reasons(structure: Structure, surfaces: tuple[Surface, ...]) -> list[Note]:
    """Why each law was taken where none was named, and what it assumes; joints that share all of it have one note."""
    out = []
    for joint, surface in zip(structure.joints, surfaces, strict=True):
        law = joint.law
        if law.reason:
            out.append(Note(code="law-choice", text=f"contact law: {law.reason}"))
        out += mates_notes([law], alike=surface.scans is not None and surface.scans[1] == "same")
        out += joint.assumptions
    return list(dict.fromkeys(out))


def mates_notes(laws: Sequence[JointLaw], *, alike: bool = False) -> list[Note]:
    """Both faces of each joint and their materials, each once; alike: whether the other face was assumed so."""
    lines = dict.fromkeys(law.mates for law in laws if law.mates)
    hint = "; the other face is assumed alike: surface.counter gives its own scan" if alike else ""
    return [Note(code="mates", text=line + hint) for line in lines]


def read_for(study: Study, surfaces: Sequence[Surface]) -> Read:
    """The surfaces of a study's joints by what they were read from."""
    choices = (joint.surface or study.surface for joint in study.joints)
    return {choice: one for choice, one in zip(choices, surfaces, strict=True) if choice is not None}


def fit_warnings(study: Study, surfaces: Sequence[Surface]) -> tuple[str, ...]:
    """What the fits of D and G warn of, where a law takes them or waves go on with their spectrum."""
    others = [one.law for one in study.alternatives if one.law is not None]
    out: list[str] = []
    for joint, surface in zip(study.joints, surfaces, strict=True):
        faces, laws = surface.faces, (study.law_of(joint), *others)
        fitted = faces is not None and any(takes_fit(law.kind, law.given, faces) for law in laws)
        waves = None if joint.form is None else joint.form.waviness
        if fitted or (waves is not None and waves.Wq is None):
            out += surface.warnings
    return tuple(dict.fromkeys(out))


def surfaces_of(study: Study, read: Read | None = None) -> tuple[Surface, ...]:
    """Return the surface of each joint; a scan that several joints share, or that is in `read`, is not read again."""
    read = dict(read or {})
    out = []
    for joint in study.joints:
        choice = joint.surface or study.surface
        if choice is None and study.law_of(joint).needs_surface:
            raise InputError(f"joint {joint.name!r} has no surface; add [surface] to the study or to the joint")
        if choice is not None and choice not in read:
            read[choice] = choice.read()
        out.append(NO_SURFACE if choice is None else read[choice])
    return tuple(out)


def joint_law(joint: JointChoice, law: LawChoice, surface: Surface, rough: Material, other: Material) -> JointLaw:
    """Lay the law on a joint between the rough face's material and the other one, for run, sweep and attach alike."""
    return joint.laid(law.make(surface, rough, other), rough.nu)


def part_of(study: Study, face: str) -> str | None:
    """The part that a face belongs to by its name (part.face) or its selector; None where neither says it."""
    part = study.geometry.face[face].part if face in study.geometry.face else face.partition(".")[0]
    return part if part in study.parts else None


def checked_laws(study: Study, surfaces: Sequence[Surface]) -> dict[tuple[str, str, str], JointLaw]:
    """Lay the laws on those joints whose materials are known before there is a mesh; by joint and both parts.

    Raises InputError for laws that a joint cannot use: in seconds, where meshing may take minutes. A contact that has
    to be solved takes longer than most meshes, which tell of names that do not fit: it waits.
    """
    out: dict[tuple[str, str, str], JointLaw] = {}
    for joint, surface in zip(study.joints, surfaces, strict=True):
        parts = [part_of(study, face) for face in joint.faces]
        if None not in parts and study.law_of(joint).model not in (AUTO, HalfSpace.name):
            rough, other = (study.materials[study.parts[str(part)]] for part in parts)
            law = joint_law(joint, study.law_of(joint), surface, rough, other)
            law.check()
            out[joint.name, str(parts[0]), str(parts[1])] = law
    return out


def materials_at(study: Study, mesh: Mesh, joint: JointChoice) -> tuple[Material, Material]:
    """Material of the part with the rough face of a joint, and that of the other part."""
    rough, other = (study.materials[study.parts[mesh.face_part[face]]] for face in joint.faces)
    return rough, other


def materials_of(study: Study, mesh: Mesh) -> dict[str, Material]:
    """Material of every part of the mesh."""
    return {name: study.materials[study.parts[name]] for name in mesh.parts}


def checked_mesh(study: Study) -> Mesh:
    """Return the mesh of a study; every name that does not fit the geometry is reported at once."""
    mesh = mesh_of(study.geometry)
    faults = [fault for _, fault in name_faults(study, list(mesh.parts), mesh.face_part, mesh.bonded)]
    if faults:
        raise InputError("the study does not fit its geometry:\n" + "\n".join(f"  - {line}" for line in faults))
    return bonded_mesh(mesh, [(bond.name, bond.faces) for bond in study.bonds], snap=study.geometry.snap)


def name_faults(
    study: Study, parts: Sequence[str], faces: Mapping[str, str], one_body: Sequence[tuple[str, str]] = ()
) -> list[tuple[str, str]]:
    """Names of a study that its geometry does not hold, and parts that nothing holds: key of each, and what is wrong.

    faces: the part of each; one_body: pairs of parts that share nodes in the file.
    """
    file = study.geometry.file.name
    names = ", ".join(parts)
    unsaid = [name for name in parts if name not in study.parts]
    faults = [("part", f"[part] has no entry for {name!r}, which is in {file}") for name in unsaid]
    absent = [name for name in study.parts if name not in parts]
    faults += [(f"part.{name}", f"part {name!r} is not in {file}; it has {names}") for name in absent]
    faults += [
        (f"bolt[{k}].part", f"bolt {bolt.name!r} is the part {bolt.part!r}, which is not in {file}; it has {names}")
        for k, bolt in enumerate(study.bolts, 1)
        if bolt.part is not None and bolt.part not in parts
    ]
    known = ", ".join(sorted(faces))
    faults += [
        (key, f"{what} {name!r} names the face {face!r}, which does not exist; the faces are {known}")
        for key, what, name, face in named_faces(study)
        if face not in faces
    ]
    faults += [*_heated(study), *_moved(study), *_unshaken(study)]
    return faults or [*_loose_parts(study, parts, faces, one_body), *_idle_bolts(study)]


def _loose_parts(
    study: Study, parts: Sequence[str], faces: Mapping[str, str], one_body: Sequence[tuple[str, str]]
) -> list[tuple[str, str]]:
    """Parts that no joint, no bond and no support holds, which a structure refuses."""
    met = {faces[face] for joint in study.joints for face in joint.faces}
    met |= {faces[support.face] for support in study.supports}
    pairs = [*one_body, *((faces[bond.faces[0]], faces[bond.faces[1]]) for bond in study.bonds)]
    fault = loose_parts(bodies_of(tuple(parts), pairs), met)
    return [("joint", fault)] if fault else []


def _idle_bolts(study: Study) -> list[tuple[str, str]]:
    """Bolts that pull on two faces that do not move, so that no joint gets anything of their preload."""
    firm = [one for one in study.supports if one.stiffness is None and set(one.directions) == {"x", "y", "z"}]
    fixed = {one.face for one in firm if one.whole}
    return [
        (
            f"bolt[{k}].faces",
            f"bolt {bolt.name!r} pulls the faces {' and '.join(map(repr, bolt.faces))}, and a [[support]] holds each "
            "of them: its preload goes into the supports and presses no joint; support other faces",
        )
        for k, bolt in enumerate(study.bolts, 1)
        if bolt.part is None and fixed.issuperset(bolt.faces)
    ]


def named_faces(study: Study) -> list[tuple[str, str, str, str]]:
    """Every face that a study names: the key, what names it, that thing's name, the face."""
    named = [
        (f"joint[{joint.number}].faces", "joint", joint.name, face)
        for joint in sorted((*study.joints, *study.bonds), key=lambda joint: joint.number)
        for face in joint.faces
    ]
    named += [
        (f"bolt[{k}].faces", "bolt", bolt.name, face) for k, bolt in enumerate(study.bolts, 1) for face in bolt.faces
    ]
    named += [
        (f"dowel[{k}].walls", "dowel", dowel.name, wall)
        for k, dowel in enumerate(study.dowels, 1)
        for wall in dowel.walls
    ]
    for k, one in enumerate(study.supports, 1):
        held = (("face", one.face), ("edge", one.edge))
        named += [(f"support[{k}].{key}", "support", face, face) for key, face in held if face is not None]
    masses = [(k, one.face) for k, one in enumerate(study.masses, 1) if one.face is not None]
    named += [(f"mass[{k}].face", "mass", face, face) for k, face in masses]
    named += [
        (f"vibration[{k}].face", "vibration", one.name, one.force.face)
        for k, one in enumerate(study.vibrations, 1)
        if one.force is not None and one.force.face is not None
    ]
    for k, load in enumerate(study.load_cases, 1):
        acting: dict[str, Sequence[Force | Pressure | Displacement]] = {
            "force": load.forces,
            "pressure": load.pressures,
            "displacement": load.displacements,
        }
        named += [
            (f"load[{k}].{key}[{n}].face", "load", load.name, one.face)
            for key, many in acting.items()
            for n, one in enumerate(many, 1)
            if one.face is not None
        ]
    return named


def _firm(study: Study) -> set[tuple[str, str]]:
    """Faces and directions in which supports without stiffness hold them."""
    firm = [one for one in study.supports if one.stiffness is None and one.whole]
    return {(one.face, axis) for one in firm for axis in one.directions}


def _unshaken(study: Study) -> Iterator[tuple[str, str]]:
    """Vibrations that move no support, move them where they hold nothing, or push where they hold all."""
    firm, some = _firm(study), {axis for one in study.supports for axis in one.directions}
    for k, one in enumerate(study.vibrations, 1):
        along = {axis for axis, size in zip("xyz", one.direction, strict=True) if size}
        if one.base and not along <= some:
            yield f"vibration[{k}]", not_along(one) if some else not_shaken(one.name)
        if one.force is not None and firm.issuperset((one.force.face, axis) for axis in along):
            yield f"vibration[{k}].face", held_still(one)


def _moved(study: Study) -> list[tuple[str, str]]:
    """Displacements of loads along directions in which no support without stiffness holds the face."""
    held = _firm(study)
    return [
        (f"load[{k}].displacement[{n}].displacement", not_held(load.name, one.face, axis))
        for k, load in enumerate(study.load_cases, 1)
        for n, one in enumerate(load.displacements, 1)
        for axis, size in zip("xyz", one.displacement, strict=True)
        if size and (one.face, axis) not in held
    ]


def _heated(study: Study) -> Iterator[tuple[str, str]]:
    """Temperatures of what is neither part nor bolt, and of materials of which no expansion is known."""
    known = [*study.parts, *(bolt.name for bolt in study.bolts)]
    for k, load in enumerate(study.load_cases, 1):
        for name in load.temperature:
            what, key = f"load {load.name!r}", f"load[{k}].temperature"
            if name not in known:
                yield key, not_there(what, name, known)
            elif name in study.parts and (material := study.materials[study.parts[name]]).expansion is None:
                yield key, no_expansion(f"{what}: part {name!r}", material.name)


def structure_of(
    study: Study, mesh: Mesh, surfaces: tuple[Surface, ...], laws: Mapping[tuple[str, str, str], JointLaw] | None = None
) -> Structure:
    """Return the structure of a study on a mesh, with the surface of each joint; laws: those of `checked_laws`."""
    joints: list[FittedJoint] = []
    notes: list[Note] = []
    for joint, surface in zip(study.joints, surfaces, strict=True):
        parts = (mesh.face_part[joint.faces[0]], mesh.face_part[joint.faces[1]])
        law = (laws or {}).get((joint.name, *parts)) or joint_law(
            joint, study.law_of(joint), surface, *materials_at(study, mesh, joint)
        )
        interface, closed = interface_of(study, mesh, joint, surface)
        notes += closed
        joints.append(
            FittedJoint(
                name=joint.name,
                faces=joint.faces,
                interface=interface,
                law=law,
                per_node=joint.springs == "per-node",
                scan_area=surface.scan_area,
                friction=joint.friction,
            )
        )
    return Structure(
        mesh=replace(mesh, notes=(*mesh.notes, *notes)) if notes else mesh,
        materials=materials_of(study, mesh),
        joints=tuple(joints),
        bolts=study.bolts,
        supports=study.supports,
        masses=study.masses,
        dowels=study.dowels,
    )


def interface_of(study: Study, mesh: Mesh, joint: JointChoice, surface: Surface) -> tuple[Interface, list[Note]]:
    """How the faces of a joint meet, with their form; and notes on a gap that was closed and on waves."""
    met = join(mesh, *joint.faces, search_distance=joint.search_distance)
    met, notes = snapped(met, study.geometry.snap, joint.name)
    if joint.form is None:
        return met, notes
    formed, more = with_form(met, mesh, joint.faces, joint.form.with_scan(surface.waves), joint.name)
    return formed, [*notes, *more]


def snapped(interface: Interface, snap: float, name: str) -> tuple[Interface, list[Note]]:
    """Close a gap of the CAD model that is nowhere wider than snap [m]; a note says how wide it was."""
    widest = float(np.abs(interface.gap).max())
    if not SNAP_ROUNDING * snap < widest <= snap:
        return interface, []
    text = f"{name}: the faces are up to {show(widest, 'm')} apart; geometry.snap = {show(snap, 'm')} closes that"
    return replace(interface, gap=np.zeros_like(interface.gap)), [Note(code="snapped", joint=name, text=text)]


def build(study: Study) -> Structure:
    """Return the structure of a study, meshed and with its law on the joints, for work that goes on by hand."""
    surfaces = surfaces_of(study)
    laws = checked_laws(study, surfaces)
    return structure_of(study, checked_mesh(study), surfaces, laws)


def bare(study: Study) -> Study:
    """The study with its preloads and modes alone."""
    modes = replace(study.modes, levels=(), intervals=False)
    return replace(study, response=None, hammer=None, backbone=None, alternatives=(), modes=modes, vibrations=())
