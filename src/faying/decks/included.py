"""The files that a mesh file of Abaqus, CalculiX or Nastran names: a model depends on them as on the file itself."""

import re
from pathlib import Path

from faying.file_kinds import ABAQUS, NASTRAN, kind_of
from faying.files import named_files

# *INCLUDE and data lines from INPUT=, a keyword that goes on over lines included; INCLUDE 'file' of bulk data
_ABAQUS = re.compile(
    rb"^[ \t]*\*(?!\*)(?:[^\n]*,[ \t\r]*\n)*[^\n]*?\binput\s*=\s*\"?((?<=\")[^\"\r\n]+|[^,\"\r\n]+)", re.I | re.M
)
_NASTRAN = re.compile(rb"^[ \t]*+INCLUDE[ \t]+['\"]?([^'\"\r\n$]+)", re.I | re.M)


def included(path: Path) -> tuple[Path, ...]:
    """Every file that a mesh file includes, at any depth, that is there; the reader tells what is not."""
    if kind_of(path) not in (ABAQUS, NASTRAN):
        return ()
    return tuple(file for file in named_files(path, _names)[1:] if file.is_file())


def _names(text: bytes) -> list[str]:
    found = (*_ABAQUS.finditer(text), *_NASTRAN.finditer(text))
    return [one.group(1).decode(errors="replace").strip() for one in found]
