"""The files that a mesh file of Abaqus, CalculiX or Nastran names: a model depends on them as on the file itself."""

import re
from pathlib import Path

_ENDS = {".inp", ".bdf", ".nas", ".dat"}
# *INCLUDE and data lines from INPUT=, a keyword that goes on over lines included; INCLUDE 'file' of bulk data
_ABAQUS = re.compile(rb"^\*(?!\*)(?:[^\n]*,[ \t\r]*\n)*[^\n]*?\binput\s*=\s*\"?([^,\"\r\n]+)", re.I | re.M)
_NASTRAN = re.compile(rb"^\s*INCLUDE[ \t]+['\"]?([^'\"\r\n$]+)", re.I | re.M)


def included(path: Path) -> tuple[Path, ...]:
    """Every file that a mesh file includes, at any depth, that is there; the reader tells what is not."""
    found: dict[Path, None] = {}
    waiting = [path]
    while waiting:
        file = waiting.pop()
        if file.suffix.lower() not in _ENDS and file == path:
            break
        text = file.read_bytes()
        for match in (*_ABAQUS.finditer(text), *_NASTRAN.finditer(text)):
            name = match.group(1).decode(errors="replace").strip()
            one = file.parent / name
            if "\0" not in name and one.is_file() and one not in found and one.resolve() != path.resolve():
                found[one] = None
                waiting.append(one)
    return tuple(found)
