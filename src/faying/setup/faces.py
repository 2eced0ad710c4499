"""The faces of a STEP or mesh file: what `faying faces` lists."""

from pathlib import Path

from faying.decks.meshfile import read_mesh
from faying.errors import InputError
from faying.file_kinds import STEP, kind_of
from faying.geometry.face_facts import GeometryFacts, read_facts
from faying.geometry.mesh_facts import mesh_facts
from faying.misuse import checked_call


@checked_call
def faces(geometry: str | Path, *, unit: str | None = None) -> GeometryFacts:
    """Return the parts of a STEP or mesh file, their faces, and where faces of two parts look at each other.

    Args:
        geometry: STEP file, or mesh file of another program, of which the named faces count.
        unit: Unit of a mesh file's coordinates, such as "mm"; a STEP file states its own.

    Returns:
        The facts: `parts`, `faces` (number, kind, area, normal, centre, radius), `contacts`.

    Raises:
        InputError: A unit for a STEP file, none for a mesh file that needs one, or a file of another kind.
        ReadError: The file cannot be read.
    """
    path = Path(geometry)
    if kind_of(path) is not STEP:
        return mesh_facts(read_mesh(path, unit=unit))
    if unit is not None:
        raise InputError("a unit is for mesh files; a STEP file states its unit, so leave it out")
    return read_facts(path)
