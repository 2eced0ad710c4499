"""What each program's file reads and writes: the one table of mesh formats, matrix formats and exporters."""

from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from faying.errors import ReadError


@dataclass(frozen=True, kw_only=True)
class Program:
    """What the module `faying.decks.<name>` does: suffixes of meshes and matrices it reads, which joints it writes.

    Such a module has `read(path) -> RawMesh`, `read_matrices(path, names) -> Matrices`, `decks(deck) -> {file: text}`,
    and `condensed(deck) -> {file: text}`.
    """

    meshes: tuple[str, ...] = ()
    matrices: tuple[str, ...] = ()
    joints: bool = False
    condensed: bool = False


PROGRAMS: dict[str, Program] = {
    "mapdl": Program(meshes=(".cdb",), joints=True, condensed=True),
    "abaqus": Program(meshes=(".inp",), joints=True, condensed=True),
    "nastran": Program(
        meshes=(".bdf", ".nas", ".dat"), matrices=(".bdf", ".nas", ".dat", ".pch"), joints=True, condensed=True
    ),
    "calculix": Program(matrices=(".sti",), joints=True),
    "aster": Program(joints=True),
    "gmsh": Program(meshes=(".msh",)),
    "unv": Program(meshes=(".unv",)),
    "vtk": Program(meshes=(".vtk", ".vtu", ".med")),
}
SOLVERS = tuple(name for name, program in PROGRAMS.items() if program.joints)
CONDENSED = tuple(name for name, program in PROGRAMS.items() if program.condensed)
MESHES = {suffix: name for name, program in PROGRAMS.items() for suffix in program.meshes}
MATRICES = {suffix: name for name, program in PROGRAMS.items() for suffix in program.matrices}


def module_of(program: str) -> Any:
    """Import the module of a program."""
    return import_module(f"faying.decks.{program}")


def reader_of(path: Path, formats: dict[str, str], more: tuple[str, ...] = ()) -> Any:
    """Import the module that reads a file by its suffix. Raises ReadError that lists the suffixes known."""
    suffix = path.suffix.lower()
    if suffix not in formats:
        raise ReadError(
            f"{path}: files of the kind {suffix or '(none)'} are not known; the known ones are "
            f"{', '.join([*formats, *more])}"
        )
    return module_of(formats[suffix])
