"""A law laid on two faces of a user's own model: from mesh, study and pressure to the springs of the joint."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any, Literal

import numpy as np

from faying import units
from faying.case.case import Case, Progress, checked_mesh, joint_law, structure_of, surfaces_of
from faying.checks import number
from faying.columns import read_columns
from faying.decks.deck import ContactProperty, JointDeck, UnitSystem, write
from faying.decks.meshfile import last_element
from faying.errors import InputError, ReadError
from faying.export.condense import under_preload
from faying.export.law_tables import friction_of
from faying.fe.interface import Interface, join
from faying.fe.mesh import Mesh
from faying.fe.sides import face_centre
from faying.form.form import Form
from faying.joint.joint_law import JointLaw
from faying.joint.pairs import NodePairs, consistent, lumped
from faying.joint.preload_case import preload_index
from faying.materials import Material
from faying.misuse import checked_call
from faying.notes import percent
from faying.study.keys.geometry import GeometryChoice, mesh_of
from faying.study.keys.joint import JointChoice
from faying.study.study import Study
from faying.style import Summary
from faying.text import cut, few
from faying.typing import Array, Index
from faying.units import show_area

HEAD = "node,pressure [MPa]"


def read_pressure(given: str | Path, mesh: Mesh, faces: tuple[str, str], interface: Interface) -> tuple[Array, str]:
    """Pressure [Pa] at the points of the interface (q,), and in words where it comes from.

    given: a value such as "5 MPa", or a CSV file with the heading "node,pressure [MPa]" that covers one of the faces.
    Raises ReadError and InputError.
    """
    file = Path(given)
    if not file.is_file():
        if file.suffix.lower() in (".csv", ".txt"):
            raise ReadError(f'no file {file}; --pressure takes a CSV file, a value such as "5 MPa", or solve')
        value = units.parse(str(given), "Pa", name="--pressure")
        if value <= 0:
            raise InputError(f'--pressure "{given}" must be above 0; pressure presses the faces together')
        return np.full(len(interface.weights), value), f"{given} everywhere"
    numbers, values = _table(file)
    at = dict(zip(numbers.tolist(), values.tolist(), strict=True))
    missing = []
    for name, nodes, shapes in (
        (faces[0], interface.first_nodes, interface.first_values),
        (faces[1], interface.second_nodes, interface.second_values),
    ):
        needed = np.unique(nodes[shapes != 0])
        lost = [int(mesh.numbers[i]) for i in needed if int(mesh.numbers[i]) not in at]
        if not lost:
            by_node = np.zeros(len(mesh.points))
            by_node[needed] = [at[int(mesh.numbers[i])] for i in needed]
            # between nodes of a quadratic face the shape functions may dip below zero
            return np.maximum(np.einsum("qa,qa->q", shapes, by_node[nodes]), 0.0), f"{file.name}, on {name}"
        missing.append(f"{len(lost)} of {len(needed)} nodes of {name!r}, {lost[0]} for one")
    raise InputError(f"{file} must give the pressure at every node of one face; it lacks {' and '.join(missing)}")


def _table(file: Path) -> tuple[Index, Array]:
    known = {"node": "", "pressure": "Pa"}
    form = f'it should begin with the heading "{HEAD}", the unit of your pressures in the brackets'
    table = read_columns(file, known, needed=("node", "pressure"), form=form, examples={"Pa": "MPa"})
    numbers, values = table.values["node"], table.values["pressure"]
    if not table.lines:
        raise ReadError(f"{file} has no pressures; {form}")
    odd = np.flatnonzero((numbers != np.rint(numbers)) | (np.abs(numbers) > 2**53))
    if len(odd):
        raise ReadError(
            f"{file}, line {table.lines[odd[0]]}: {numbers[odd[0]]:g} is not a node number; give an integer"
        )
    if min(values) < -1e-9 * max(map(abs, values)):
        raise InputError(
            f"{file}: {sum(v < 0 for v in values)} pressures are negative; pressure presses the faces together and "
            "counts as positive: change the sign of the column, and write 0 where the joint is open"
        )
    if len(np.unique(numbers)) < len(numbers):
        raise InputError(f"{file} gives some nodes twice; give each once")
    return numbers.astype(np.int64), np.maximum(values, 0.0)


SMALLEST, LARGEST = 1e-7, 10.0  # areas of a joint [m2] beyond which the unit is doubted
TOUCHING = 1e-6  # of the structure's size: a gap above it is noted
UNKNOWN_FRICTION = 0.2  # where neither the joint nor its materials say it
STIFFER = 0.05  # of the joint's resistance to a turn: springs at nodes that exceed it by more are noted
VALID = "validity: the law is within its validity range everywhere"


@dataclass(frozen=True, kw_only=True, repr=False)
class Attachment(Summary):
    """A joint on a model: its deck, the springs, their interface, area [m2], and what the user should know."""

    deck: JointDeck
    interface: Interface
    materials: Mapping[str, Material]
    notes: tuple[str, ...]

    @property
    def pairs(self) -> NodePairs:
        """The springs between nodes."""
        return self.deck.pairs

    def write(self, program: str, folder: str | Path) -> list[Path]:
        """Write the decks of the joint, and joint_pairs.csv.

        Args:
            program: "calculix", "abaqus", "nastran", "mapdl" or "aster".
            folder: Where the files go; it is made where it does not exist.

        Returns:
            The files.

        Raises:
            InputError: Another program, nodes with directions of their own, or a folder that cannot be used.
        """
        return write(self.deck, program, Path(folder))

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return the faces, how many pairs of nodes, the sums of their stiffness, and notes."""
        k_n, k_t = self.pairs.totals()
        rows = {
            "pairs": f"{len(self.pairs):,} of nodes",
            "area": show_area(self.interface.area),
            "stiffness": f"normal {k_n:.4g} N/m, tangential {k_t:.4g} N/m in all",
        }
        rows |= {f"note {k}": cut(note) for k, note in enumerate(self.notes[:6], 1)}
        return f"Joint between {' and '.join(self.deck.faces)}", rows

    def to_dict(self) -> dict[str, Any]:
        """Everything but the pairs themselves, in SI units."""
        k_n, k_t = self.pairs.totals()
        return {
            "faces": list(self.deck.faces),
            "pairs": len(self.pairs),
            "lumped": self.pairs.lumped,
            "area [m^2]": self.interface.area,
            "total_k_n [N/m]": k_n,
            "total_k_t [N/m]": k_t,
            "facts": list(self.deck.facts),
            "notes": list(self.notes),
        }


@checked_call
def attach(
    model: str | Path,
    faces: tuple[str, str],
    *,
    unit: str,
    study: Study | str | Path,
    pressure: str | Path,
    joint: str | None = None,
    preload: str | None = None,
    tolerance: float | str | None = None,
    coupling: Literal["auto", "nodes", "faces"] = "auto",
    frequency: float | str | None = None,
    force_unit: str = "N",
    any_size: bool = False,
) -> Attachment:
    """Lay the law of a study on two faces of a mesh file.

    Args:
        model: mesh file of Abaqus, CalculiX, Nastran, MAPDL, Gmsh or VTK.
        faces: the rough face and the one that it meets.
        unit: of the model's coordinates; no mesh file says.
        study: the study or its file: gives surface, law and materials, and the bolts where they are solved.
        pressure: a value with unit, a CSV file of node and pressure, or "solve" for the study's bolts on this mesh.
        joint: which of the study's joints, by name; the one with these faces, or the only one, where None.
        preload: with "solve", which of the study's preloads, as text with a unit.
        tolerance: how far apart the faces may lie [m], or text with a unit.
        coupling: "nodes" (pair by pair), "faces" (springs per area, exact on any meshes) or what the meshes allow.
        frequency: of viscous dampers that lose as much as the loss factor does [Hz], or text with a unit.
        force_unit: unit of force of the model.
        any_size: take a joint of any area.

    Returns:
        The joint, ready to be written.

    Raises:
        ReadError, InputError: files, faces that are missing, apart, turned the same way or of doubtful size, and
            pressures that do not cover the face.
    """
    file, study = Path(model), Study.read_bolted(study)
    search = None if tolerance is None else number(tolerance, "tolerance", "m", least=0)
    at_frequency = None if frequency is None else number(frequency, "frequency", "Hz", least=0)
    spec = _joint(study, faces, joint)
    solving = str(pressure) == "solve"
    if any(case.after for case in study.preloads):
        raise InputError(
            f"{', '.join(study.load_names)}: springs at nodes are those of first loading, and this joint has carried "
            "more before; faying condense takes it"
        )
    geometry = GeometryChoice(mesh=file, unit=unit, sets=study.geometry.sets)
    if solving:
        moved = replace(
            study,
            geometry=geometry,
            joints=tuple(replace(j, faces=faces, search_distance=search) if j is spec else j for j in study.joints),
        )
        mesh = checked_mesh(moved)
    else:
        mesh = mesh_of(geometry)
    interface = _interface(mesh, faces, search, any_size, unit)
    materials = _materials(study, mesh)
    notes = [*(note.text for note in mesh.notes), *_apart(mesh, faces, interface)]
    if solving:
        law, at_points, origin = _solved(moved, mesh, faces, preload)
    else:
        (surface,) = surfaces_of(replace(study, joints=(spec,)))
        law = joint_law(spec, study.law_of(spec), surface, *(materials[mesh.face_part[face]] for face in faces))
        at_points, origin = read_pressure(pressure, mesh, faces, interface)
    pairs, used = _pairs(interface, law, at_points, coupling)
    if coupling == "auto" and not pairs.lumped:
        notes.append(
            "the meshes of the faces do not match: springs per area, exact, between all nodes that share an overlap; "
            "some of them are negative"
        )
    if pairs.lumped:
        exact = _turning(interface.positions, interface.weights * law.stiffness(at_points)[0])
        notes += _coarse(_turning(mesh.points[pairs.first], pairs.own(pairs.stiffness)[:, 0]), exact)
    bent = spec.form not in (None, Form())
    if bent:
        notes.append("between bent faces a pressure has no one closure: the deck has no contact table, only springs")
    viscous = None if at_frequency is None else np.asarray(pairs.loss / (2 * np.pi * at_frequency))
    area = pairs.area if pairs.lumped else interface.weights
    flags = _flags(law, used, area)
    system = UnitSystem(unit, force_unit)
    mean = float(area @ used / area.sum())
    p, force = system.pressure, f"{force_unit}/{unit}2"
    of_pressure = f"least {used.min() * p:.6g}, mean {mean * p:.6g}, greatest {used.max() * p:.6g} {force}"
    head = f"Joint of {faces[0]} and {faces[1]} in {file.name}, written by Faying {version('faying')}"
    deck = JointDeck(
        pairs=pairs,
        mesh=mesh,
        faces=faces,
        system=system,
        facts=(head, *_facts(law, pairs, interface, system, f"pressure: {origin}; {of_pressure}"), *(flags or [VALID])),
        viscous=viscous,
        frequency=at_frequency,
        first_element=(last_element(file) // 100_000 + 1) * 100_000 + 1,  # a round number above all of the file
        contact=None if bent else _contact(law, spec, float(used.max()), mean),
    )
    return Attachment(deck=deck, interface=interface, materials=materials, notes=tuple(dict.fromkeys([*notes, *flags])))


def _facts(law: JointLaw, pairs: NodePairs, interface: Interface, system: UnitSystem, pressure: str) -> tuple[str, ...]:
    """What the head of a deck says of its joint."""
    k_n, k_t = (total * system.stiffness for total in pairs.totals())
    unit, force = system.length, system.force
    sums = f"sum of normal springs {k_n:.8g}, of tangential springs {k_t:.8g} {force}/{unit}"
    shares = (
        "shares of the area after the diagonal of the consistent mass of the face (HRZ, doi:10.1002/eqe.4290040305)"
        if pairs.lumped
        else "springs per area, consistent with the shape functions of both faces: pairs within a face are negative"
    )
    return (
        system.describe(),
        f"law: {law.model.name}, {law.model.source}",
        *([f"mates: {law.mates}"] if law.mates else []),
        pressure,
        f"area {interface.area * system.metre**2:.8g} {unit}2; {sums}",
        shares,
    )


def _joint(study: Study, faces: tuple[str, str], name: str | None) -> JointChoice:
    for spec in study.joints:
        if spec.name == name or (name is None and set(spec.faces) == set(faces)):
            return spec
    if name is None and len(study.joints) == 1:
        return study.joints[0]
    names = ", ".join(repr(spec.name) for spec in study.joints)
    raise InputError(f"the study has the joints {names}; choose whose law to take by joint (--joint NAME)")


def _interface(mesh: Mesh, faces: tuple[str, str], tolerance: float | None, any_size: bool, unit: str) -> Interface:
    normals = [face_centre(mesh.points, mesh.face(name))[1] for name in faces]
    if mesh.face_part[faces[0]] != mesh.face_part[faces[1]] and float(normals[0] @ normals[1]) > 0.5:
        raise InputError(
            f"faces {faces[0]!r} and {faces[1]!r} are turned the same way (normals {_vector(normals[0])} and "
            f"{_vector(normals[1])}); a joint needs two that face each other: should it be the opposite side?"
        )
    interface = join(mesh, *faces, search_distance=tolerance)
    if not any_size and not SMALLEST <= interface.area <= LARGEST:
        raise InputError(
            f"in {unit} the joint has {interface.area:.3g} m2; is that the unit of the model? Areas from "
            f"{SMALLEST * 1e6:g} mm2 to {LARGEST:g} m2 are taken; if it is right, say so by any_size (--any-size)"
        )
    return interface


def _vector(v: Array) -> str:
    return "(" + ", ".join(f"{x:.3g}" for x in np.round(v, 3) + 0.0) + ")"


def _apart(mesh: Mesh, faces: tuple[str, str], interface: Interface) -> Iterator[str]:
    """What finds no partner, and how far the faces are apart."""
    for name, nodes, values in (
        (faces[0], interface.first_nodes, interface.first_values),
        (faces[1], interface.second_nodes, interface.second_values),
    ):
        every = mesh.face_nodes(name)
        lost = mesh.numbers[np.setdiff1d(every, nodes[values != 0])]
        if len(lost):
            yield f"{len(lost)} of {len(every)} nodes of {name!r} have no partner within the tolerance: {few(lost)}"
    gap = float(np.abs(interface.gap).max())
    if gap > TOUCHING * mesh.size:
        yield (
            f"the faces are up to {gap * 1e3:.3g} mm apart: springs between nodes that do not coincide resist a "
            "rotation of the model"
        )


def _materials(study: Study, mesh: Mesh) -> dict[str, Material]:
    """Material of every part: by the study's name for it, or the only one that the study uses."""
    used = set(study.parts.values())
    only = next(iter(used), "")
    lacking = [part for part in mesh.parts if part not in study.parts]
    if lacking and len(used) != 1:
        raise InputError(
            f"[part] of the study has no entry for {lacking[0]!r}, which is in the model, and uses several materials; "
            f"add [part.{lacking[0]}]"
        )
    return {part: study.materials[study.parts.get(part, only)] for part in mesh.parts}


def _solved(study: Study, mesh: Mesh, faces: tuple[str, str], preload: str | None) -> tuple[JointLaw, Array, str]:
    """JointLaw and pressure [Pa] at the points of the interface under the study's bolts."""
    loads = study.loads
    if preload is None and len(loads) > 1:
        known = ", ".join(one.name for one in study.preloads)
        raise InputError(f"the study has the preloads {known}; say which by preload (--preload)")
    number = preload_index(loads, preload, names=study.load_names)
    surfaces = surfaces_of(study)
    case = Case(study=study, structure=structure_of(study, mesh, surfaces), surfaces=surfaces)
    case, springs = under_preload(case, number, Progress(number + 1))
    joints = case.structure.joints
    place = next(i for i, joint in enumerate(joints) if joint.faces == faces)
    return joints[place].law, springs[place].pressure, f"of the study's bolts at {units.show(loads[number], 'N')}"


def _pairs(interface: Interface, law: JointLaw, pressure: Array, coupling: str) -> tuple[NodePairs, Array]:
    """Return the springs and the pressures [Pa] that they belong to."""
    if coupling != "faces":
        try:
            nodes = interface.at_nodes()
        except InputError:
            if coupling == "nodes":
                raise
        else:
            at_nodes = interface.to_nodes(nodes, pressure)
            return lumped(nodes, (*law.stiffness(at_nodes), *law.loss(at_nodes)), at_nodes), at_nodes
    return consistent(interface, (*law.stiffness(pressure), *law.loss(pressure))), pressure


def _turning(places: Array, k_n: Array) -> float:
    """Sum of normal stiffness [N/m] times squared distance from its own middle [N m], of places (n, 3) [m]."""
    return float(k_n @ ((places - k_n @ places / max(k_n.sum(), 1e-300)) ** 2).sum(axis=1))


def _coarse(at_nodes: float, exact: float) -> Iterator[str]:
    """How much more springs at nodes resist a turn than a joint does, where that is worth a note."""
    if at_nodes > (1 + STIFFER) * exact:
        yield (
            "the mesh of the faces is coarse: springs node by node resist a turn of the joint by "
            f"{percent(at_nodes / max(exact, 1e-300) - 1)} more than the joint does; --coupling faces is exact"
        )


def _flags(law: JointLaw, pressure: Array, area: Array) -> list[str]:
    """Where the law has left its validity range."""
    out = []
    model, total = law.model, float(area.sum())
    above = pressure > model.greatest_pressure
    if np.any(above):
        out.append(
            f"validity: on {float(area @ above) / total:.2%} of the joint the pressure exceeds the "
            f"{model.greatest_pressure / 1e6:.3g} MPa at which {model.name} ends; stiffness stays constant there"
        )
    for reason, share in law.outside_validity(pressure, area).items():
        where = f"{model.name} is outside its validity range for {percent(share)} of the joint's stiffness"
        out.append(f"validity: {where}: {reason}")
    if not np.any(pressure > 0):
        out.append("validity: the joint carries no pressure, so it has no stiffness")
    return out


def _contact(law: JointLaw, spec: JointChoice, greatest: float, mean: float) -> ContactProperty | None:
    """Sample the law from a ten-thousandth of the end of the table, three times the greatest pressure."""
    if mean <= law.least_pressure:
        return None
    end = min(law.model.greatest_pressure, 3 * greatest)
    pressure = np.geomspace(max(1e-4 * end, law.least_pressure), end, 199)
    approach = np.array([law.approach(float(p)) for p in pressure])
    (k_n,), (k_t,) = law.stiffness(np.array([mean]))
    (loss_n,), _ = law.loss(np.array([mean]))
    known = (spec.friction, friction_of(law.model), UNKNOWN_FRICTION)
    return ContactProperty(
        approach=approach,
        pressure=pressure,
        k_n=float(k_n),
        k_t=float(k_t),
        loss_n=float(loss_n),
        mean_pressure=mean,
        friction=next(one for one in known if one is not None),
        given=spec.friction is not None,
    )
