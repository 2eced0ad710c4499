"""Scenes of files, by what they hold."""

from pathlib import Path

from faying.errors import InputError, ReadError
from faying.file_kinds import RESULT, STUDY, taken
from faying.output.scene.build import of_mesh, of_result
from faying.output.scene.model import Scene
from faying.output.scene.step import of_step


def of_file(path: str | Path, unit: str | None = None) -> Scene:
    """Return the scene of a study (.toml), a result (.nc), a STEP file or a mesh.

    Args:
        path: The file; what it holds says what it is.
        unit: Of a mesh file, such as "mm", since no mesh file says its own.

    Raises:
        ReadError: The file is missing or cannot be read.
        InputError: A mesh file without unit, a unit for another file, or a study that does not fit its geometry.
    """
    file = Path(path)
    if not file.is_file():
        raise ReadError(f"no file {file}")
    kind = taken(file, "geometry", "mesh", "study", "result")
    meshed = "mesh" in kind.serves
    if unit is not None and not meshed:
        raise InputError(f"--unit is for mesh files; {file.name} states its units, so leave --unit out")
    if kind is STUDY:
        from faying.case.case import checked_mesh
        from faying.study import Study

        study = Study.read(file)
        return of_mesh(checked_mesh(study), study)
    if kind is RESULT:
        from faying.result import Result

        return of_result(Result.load(file))
    if not meshed:
        return of_step(file)
    if unit is None:
        raise InputError(f'a mesh file does not state its unit; give that of {file.name}, for example --unit "mm"')
    from faying.decks.meshfile import read_mesh

    return of_mesh(read_mesh(file, unit=unit), title=file.name)
