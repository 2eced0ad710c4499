"""The [geometry] table of a study: a STEP file to mesh, or a mesh file of another program."""

from dataclasses import dataclass, field
from pathlib import Path

from faying.errors import InputError
from faying.fe.mesh import Mesh
from faying.study.keys.reader import Faults, Table, point


@dataclass(frozen=True, kw_only=True)
class GeometryChoice:
    """A STEP file and how finely to mesh it, lengths [m]; or a mesh file, its unit, and the element sets of the parts.

    snap: faces of a joint nowhere farther apart than this [m] count as touching.
    """

    step: Path | None = None
    size: float = 0.0
    face_size: dict[str, float] = field(default_factory=dict)
    face_at: dict[str, tuple[str, tuple[float, float, float]]] = field(default_factory=dict)
    mesh: Path | None = None
    unit: str | None = None
    sets: dict[str, str] = field(default_factory=dict)
    snap: float = 0.0

    @property
    def file(self) -> Path:
        """The file that the geometry comes from."""
        found = self.step or self.mesh
        if found is None:
            raise InputError("the geometry names no file; give step or mesh")
        return found


def read_geometry(top: Table) -> GeometryChoice:
    """Take the table [geometry] of a study; its faults are noted."""
    table = top.table("geometry", required=True) or Table({}, "geometry", Faults())
    if "mesh" in table.data:
        return _meshed(table)
    step = table.file("step")
    size = table.quantity("size", "m")
    sizes: dict[str, float] = {}
    inner = table.table("face_size")
    for name in list(inner.data) if inner else []:
        sizes[name] = inner.quantity(name, "m") if inner else 0.0
    at: dict[str, tuple[str, tuple[float, float, float]]] = {}
    places = table.table("face_at")
    for name, one in places.each().items() if places else ():
        at[name] = (one.text("part"), one.take("point", point))
        one.close()
    snap = table.quantity("snap", "m", 0.0)
    table.close()
    return GeometryChoice(step=step, size=size, face_size=sizes, face_at=at, snap=snap)


def _meshed(table: Table) -> GeometryChoice:
    mesh = table.file("mesh")
    if "unit" not in table.data:
        table.faults.add('geometry.unit is missing: a mesh file does not say its unit; write for example unit = "mm"')
    unit = table.text("unit", None)
    for key in ("step", "size", "face_size", "face_at"):
        if key in table.data:
            table.faults.add(f"geometry.{key} goes with a STEP file; geometry.mesh names a mesh that is ready")
            table.data.pop(key)
    inner = table.table("sets")
    sets = {name: inner.text(name) for name in list(inner.data)} if inner else {}
    snap = table.quantity("snap", "m", 0.0)
    table.close()
    return GeometryChoice(mesh=mesh, unit=unit, sets=sets, snap=snap)


def mesh_of(spec: GeometryChoice) -> Mesh:
    """Mesh the STEP file, or read the mesh file. Raises ReadError and InputError as those do."""
    if spec.mesh is not None:
        from faying.decks.meshfile import read_mesh

        return read_mesh(spec.mesh, unit=spec.unit, parts=spec.sets or None)
    from faying.fe.geometry import mesh_step

    return mesh_step(spec.file, size=spec.size, local_size=spec.face_size, face_points=spec.face_at)
