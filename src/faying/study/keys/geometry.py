"""The [geometry] table of a study: a STEP file to mesh, or a mesh file of another program."""

from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from faying import cache
from faying.decks.included import included
from faying.errors import InputError, ReadError
from faying.fe.mesh import Mesh
from faying.geometry.cad import files_of
from faying.geometry.mesh_facts import mesh_facts
from faying.geometry.selectors import Selector, chosen, points_of
from faying.study.declaration.declared import NAME, REQUIRED, WORDS, Declared, Inner, Key, listed
from faying.study.declaration.reader import Faults, Table
from faying.study.keys.face import SELECTOR, read_selector


@dataclass(frozen=True, kw_only=True)
class GeometryChoice:
    """A STEP file and how finely to mesh it, lengths [m]; or a mesh file, its unit, and the element sets of the parts.

    snap: faces of a joint nowhere farther apart than this [m] count as touching; leave_out: parts of the STEP file that
    are not meshed, such as dowels and the bolts that beams stand for; unite: bodies that are one part each.
    """

    step: Path | None = None
    size: float = 0.0
    face_size: dict[str, float] = field(default_factory=dict)
    face: dict[str, Selector] = field(default_factory=dict)
    mesh: Path | None = None
    unit: str | None = None
    sets: dict[str, str] = field(default_factory=dict)
    snap: float = 0.0
    leave_out: tuple[str, ...] = ()
    unite: tuple[tuple[str, ...], ...] = ()

    @property
    def file(self) -> Path:
        """The file that the geometry comes from."""
        found = self.step or self.mesh
        if found is None:
            raise InputError("the geometry names no file; give step or mesh")
        return found


def read_geometry(top: Table) -> GeometryChoice:
    """Take the table [geometry] of a study; its faults are noted."""
    table = top.table("geometry") or Table({}, "geometry", Faults(), GEOMETRY)
    if "mesh" in table.data:
        return _meshed(table)
    step = table.get("step")
    if step is not None:
        with suppress(ReadError):  # the mesher says which one is missing
            table.faults.files += files_of(step)[1:]
    size, sizes, faces = table.get("size"), _by_name(table, "face_size"), _faces(table)
    given = {key: table.get(key) for key in ("snap", "leave_out", "unite")}
    return GeometryChoice(step=step, size=size, face_size=sizes, face=faces, **given)


def _by_name(table: Table, key: str) -> dict[str, Any]:
    """Take a table of values by names that the user gives."""
    inner = table.table(key)
    return {name: inner.get(name) for name in inner.data} if inner else {}


def _parts(value: Any, name: str) -> tuple[str, ...]:
    """Names of parts. Raises InputError for any other value."""
    if not isinstance(value, list) or not all(isinstance(one, str) for one in value):
        raise InputError(f'{name} = {value!r} should be a list of parts, for example ["dowel 1", "dowel 2"]')
    return tuple(value)


def _groups(value: Any, name: str) -> tuple[tuple[str, ...], ...]:
    """Groups of names of parts. Raises InputError for any other value."""
    if not isinstance(value, list) or not all(isinstance(one, list) and len(one) > 1 for one in value):
        raise InputError(f'{name} = {value!r} should be a list of groups, for example [["bolt 1", "nut 1"]]')
    return tuple(_parts(one, name) for one in value)


def _faces(table: Table) -> dict[str, Selector]:
    found = {name: read_selector(one) for name, one in table.named("face").items()}
    return {name: selector for name, selector in found.items() if selector is not None}


def _meshed(table: Table) -> GeometryChoice:
    mesh = table.get("mesh")
    if mesh is not None:
        table.faults.files += included(mesh)
    if "unit" not in table.data:
        table.faults.add('geometry.unit is missing: a mesh file does not state its unit; write for example unit = "mm"')
    unit = table.get("unit")
    for key in ("step", "size", "face_size", "leave_out", "unite"):
        if key in table.data:
            table.faults.add(f"geometry.{key} is for a STEP file, and geometry.mesh is a finished mesh; leave it out")
            table.data.pop(key)
    sets, faces = _by_name(table, "sets"), _faces(table)
    return GeometryChoice(mesh=mesh, unit=unit, sets=sets, face=faces, snap=table.get("snap"))


def mesh_of(spec: GeometryChoice) -> Mesh:
    """Mesh the STEP file, or read the mesh file. Raises ReadError and InputError as those do."""
    if spec.mesh is not None:
        from faying.decks.meshfile import read_mesh

        return with_faces(read_mesh(spec.mesh, unit=spec.unit, parts=spec.sets or None), spec)
    from faying.geometry.geometry import mesh_step

    return mesh_step(
        spec.file,
        size=spec.size,
        local_size=spec.face_size,
        faces=spec.face,
        snap=spec.snap,
        leave_out=spec.leave_out,
        unite=spec.unite,
        cache=spec.file.parent / cache.FOLDER,
    )


def with_faces(mesh: Mesh, spec: GeometryChoice) -> Mesh:
    """Give the names of selectors to faces of a mesh file that have names of their own there."""
    if not spec.face:
        return mesh
    facts = mesh_facts(mesh, points_of(spec.face))
    faces, owner = dict(mesh.faces), dict(mesh.face_part)
    for label, selector in spec.face.items():
        if label in mesh.faces:
            raise InputError(f"face {label!r}: the file has a face of this name already; choose another name")
        found = chosen(label, selector, facts, snap=spec.snap)
        faces[label] = tuple(block for face in found for block in mesh.face(face.name))
        owner[label] = selector.part
    return replace(mesh, faces=faces, face_part=owner)


GEOMETRY: Declared = {
    "step": Key.file("STEP file; its solids and faces carry names.", REQUIRED),
    "size": Key.quantity("m", "Largest element.", REQUIRED),
    "face_size": Inner(
        says="Smaller elements on some faces.",
        keys={NAME: Key.quantity("m", "Largest element on the face NAME.", REQUIRED)},
    ),
    "face": Inner(
        says=(
            "Names for faces that have none in the file. A selector may also stand where a joint, a bolt, a support or "
            "a mass names a face."
        ),
        keys={
            NAME: Inner(
                says="The face for which all that is given holds gets NAME; it is an error where none or several fit.",
                keys=SELECTOR,
            )
        },
    ),
    "snap": Key.quantity("m", "Faces of a joint whose largest distance is this or less count as touching.", 0.0),
    "leave_out": Key(
        'a list of parts, for example ["dowel 1", "dowel 2"]',
        listed(WORDS, 0),
        "Parts of the STEP file that are not meshed, such as dowels, or the bolts and nuts that a [[bolt]] stands for.",
        (),
        read=_parts,
    ),
    "unite": Key(
        'a list of groups, for example [["bolt 1", "nut 1"]]',
        listed(listed(WORDS, 2), 0),
        "Bodies of the STEP file that touch and are one part, by the name of the first, such as a bolt with its nut.",
        (),
        read=_groups,
    ),
    "mesh": Key.file("Mesh file, in place of step and size.", REQUIRED),
    "unit": Key.length_unit('Unit of the coordinates of the mesh file, for example "mm"; needed with mesh.'),
    "sets": Inner(
        says="Element sets of the mesh file that are the parts, where its bodies are not.",
        keys={NAME: Key.text("Element set of the part NAME, or several joined by a plus sign.", REQUIRED)},
    ),
}
