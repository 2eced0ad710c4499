"""From a study to its structure: mesh, joints with their laws, bolts, supports."""

from dataclasses import dataclass

from faying import units
from faying.contact.law import ContactLaw
from faying.errors import InputError
from faying.fe.interface import Interface, join
from faying.fe.mesh import Mesh
from faying.joint.attachments import PointMass, Support
from faying.joint.bolt import Bolt, Washer
from faying.joint.gap_map import read_gap_map
from faying.joint.joint_law import JointLaw
from faying.joint.solid_bolt import SolidBolt
from faying.joint.structure import Joint, Structure
from faying.materials import RIGID, ContactPair, Material
from faying.study.connections import BoltSpec, GapSpec
from faying.study.contact import SurfaceSpec
from faying.study.geometry import mesh_of
from faying.study.schema import Study
from faying.study.surface import NO_SURFACE, Surface, law_of, surface_of


@dataclass(frozen=True, kw_only=True)
class Built:
    """A structure with the surface and the law of each joint, in the order of the joints."""

    structure: Structure
    surfaces: tuple[Surface, ...]
    laws: tuple[ContactLaw, ...]


def build(study: Study) -> Structure:
    """Return the structure of a study, meshed and with its law on the joints, for work that goes on by hand."""
    return build_all(study).structure


def surfaces_of(study: Study) -> tuple[Surface, ...]:
    """Return the surface of each joint; a scan that several joints share is read once."""
    read: dict[SurfaceSpec, Surface] = {}
    out = []
    for joint in study.joints:
        spec = joint.surface or study.surface
        if spec is None and not (joint.law or study.law).needs_surface:
            out.append(NO_SURFACE)
            continue
        if spec is None:
            raise InputError(f"joint {joint.name!r} has no surface; add [surface] to the study or to the joint")
        if spec not in read:
            read[spec] = surface_of(spec)
        out.append(read[spec])
    return tuple(out)


def checked_mesh(study: Study) -> Mesh:
    """Return the mesh of a study; every name that does not fit the geometry is reported at once."""
    spec = study.geometry
    mesh = mesh_of(spec)
    faults = [
        f"[part] says nothing of {name!r}, which {spec.file.name} holds"
        for name in mesh.parts
        if name not in study.parts
    ]
    faults += [
        f"part {name!r} is not in {spec.file.name}; it holds {', '.join(mesh.parts)}"
        for name in study.parts
        if name not in mesh.parts
    ]
    known = ", ".join(sorted(mesh.faces))
    faults += [
        f"bolt {bolt.name!r} is the part {bolt.part!r}, which is not in {spec.file.name}; it holds {', '.join(mesh.parts)}"
        for bolt in study.bolts
        if bolt.part is not None and bolt.part not in mesh.parts
    ]
    named = [("joint", item.name, face) for item in study.joints for face in item.faces]
    named += [("bolt", item.name, face) for item in study.bolts for face in item.faces]
    named += [("support", support.face, support.face) for support in study.supports]
    named += [("mass", mass.face, mass.face) for mass in study.masses if mass.face is not None]
    faults += [
        f"{what} {name!r} names the face {face!r}, which does not exist; the faces are {known}"
        for what, name, face in named
        if face not in mesh.faces
    ]
    if faults:
        raise InputError("the study does not fit its geometry:\n" + "\n".join(f"  - {line}" for line in faults))
    return mesh


def build_all(study: Study, *, mesh: Mesh | None = None, surfaces: tuple[Surface, ...] | None = None) -> Built:
    """Return the structure of a study with what it was made of; a mesh or surfaces made before are used again."""
    mesh = checked_mesh(study) if mesh is None else mesh
    surfaces = surfaces_of(study) if surfaces is None else surfaces
    materials = {name: study.materials[study.parts[name]] for name in mesh.parts}
    joints, laws = [], []
    for joint, surface in zip(study.joints, surfaces, strict=True):
        rough, other = (materials[mesh.face_part[face]] for face in joint.faces)
        spec = joint.law or study.law
        model = law_of(spec, surface, ContactPair(rough, RIGID if spec.counterbody == "rigid" else other))
        laws.append(model)
        interface = join(mesh, *joint.faces, search_distance=joint.reach)
        if joint.gap_map is not None:
            interface = _gap(joint.gap_map, interface)
        joints.append(
            Joint(
                name=joint.name,
                faces=joint.faces,
                interface=interface,
                law=JointLaw(model=model, tangential=joint.tangential, nu=rough.nu),
                per_node=joint.springs == "per-node",
                scan_area=surface.scan_area or None,
                friction=joint.friction,
            )
        )
    structure = Structure(
        mesh=mesh,
        materials=materials,
        joints=tuple(joints),
        bolts=tuple(_bolt(spec, study.materials) for spec in study.bolts),
        supports=tuple(Support(face=s.face, directions=s.directions, stiffness=s.stiffness) for s in study.supports),
        masses=tuple(PointMass(mass=m.mass, face=m.face, point=m.point, offset=m.offset) for m in study.masses),
    )
    return Built(structure=structure, surfaces=surfaces, laws=tuple(laws))


def _gap(spec: GapSpec, interface: Interface) -> Interface:
    xy, gap = (
        units.scale(unit, "m", name=name)
        for unit, name in ((spec.xy_unit, "gap.xy_unit"), (spec.gap_unit, "gap.gap_unit"))
    )
    made = read_gap_map(spec.file, xy_unit=xy, gap_unit=gap, origin=spec.origin, x_axis=spec.x_axis, y_axis=spec.y_axis)
    return made.on(interface)


def _bolt(spec: BoltSpec, materials: dict[str, Material]) -> Bolt | SolidBolt:
    if spec.part is not None:
        return SolidBolt(name=spec.name, part=spec.part, faces=spec.faces, at=spec.at)
    shank = spec.material is not None
    return Bolt(
        name=spec.name,
        faces=spec.faces,
        at=spec.at,
        diameter=spec.diameter if shank else None,
        material=materials[spec.material] if spec.material is not None else None,
        seat=spec.seat,
        washers=tuple(
            Washer(outer=w.outer, inner=w.inner, thickness=w.thickness, material=materials[w.material])
            for w in spec.washers
        ),
        head_mass=spec.head_mass,
        nut_mass=spec.nut_mass,
    )
