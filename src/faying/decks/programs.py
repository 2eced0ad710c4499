"""The modules of other programs' formats, and which of them write joints."""

from importlib import import_module
from pathlib import Path
from typing import Any

from faying.file_kinds import Use, taken

CONDENSED = ("mapdl", "abaqus", "nastran")  # write a condensed joint: `condensed(deck) -> {file: text}`
REDUCED = ("abaqus", "nastran", "market")  # write a superelement, by the same function
IN_SI = ("npz", "fmu")  # write a superelement, too, without units of one's own
SOLVERS = (*CONDENSED, "calculix", "aster")  # write a joint: `decks(deck) -> {file: text}`


def module_of(program: str) -> Any:
    """Import the module of a program."""
    return import_module(f"faying.decks.{program}")


def reader_of(path: Path, use: Use) -> Any:
    """Import the module that reads the meshes, or the matrices, of a file. Raises ReadError as `taken`."""
    return module_of(taken(path, use).reader)
