"""The files that a mesh file of Abaqus, CalculiX or Nastran names: a model depends on them as on the file itself."""

import re
from pathlib import Path

from faying.decks.raw import named_by
from faying.file_kinds import ABAQUS, NASTRAN, kind_of

# *INCLUDE and data lines from INPUT=, a keyword that goes on over lines included; INCLUDE 'file' of bulk data
_ABAQUS = re.compile(
    rb"^[ \t]*\*(?!\*)(?:[^\n]*,[ \t\r]*\n)*[^\n]*?\binput\s*=\s*\"?((?<=\")[^\"\r\n]+|[^,\"\r\n]+)", re.I | re.M
)
_NASTRAN = re.compile(rb"^[ \t]*+INCLUDE[ \t]+['\"]?([^'\"\r\n$]+)", re.I | re.M)


def included(path: Path) -> tuple[Path, ...]:
    """Every file that a mesh file includes, at any depth, that is there; the reader tells what is not."""
    files = [path] if kind_of(path) in (ABAQUS, NASTRAN) else []
    for file in files:  # those that it includes come to the end
        text = file.read_bytes()
        for match in (*_ABAQUS.finditer(text), *_NASTRAN.finditer(text)):
            one = named_by(file, match.group(1).decode(errors="replace").strip())
            if "\0" not in str(one) and one.is_file() and one not in files and one.resolve() != path.resolve():
                files.append(one)
    return tuple(files[1:])
