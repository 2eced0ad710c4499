"""The CAD kernel, OpenCASCADE in netgen: how it is loaded, and what it leaves out of a STEP file."""

import re
from pathlib import Path
from typing import Any

from faying.errors import InputError, ReadError

_SOLID = re.compile(r"=\s*(?:MANIFOLD_SOLID_BREP|BREP_WITH_VOIDS)\s*\(")
_PRODUCT = re.compile(r"=\s*PRODUCT\s*\(\s*'(?:(?:[^']|'')*)'\s*,\s*'((?:[^']|'')*)'")

# what OpenCASCADE links against; wheels do not bring them
LIBRARIES = {
    "Debian, Ubuntu": "apt-get install libgl1 libglu1-mesa libxrender1 libxext6 libsm6",
    "Fedora": "dnf install mesa-libGL mesa-libGLU libXrender libXext libSM",
    "conda": "conda install -c conda-forge libgl libglu xorg-libxrender xorg-libxext xorg-libsm",
}


def kernel() -> Any:
    """Import netgen.occ. Raises InputError that names the system's packages where a library is missing."""
    try:
        import netgen.occ as occ
    except ImportError as fault:
        if ".so" not in str(fault) and "DLL" not in str(fault):
            raise InputError(f"the CAD kernel cannot be imported ({fault}); install netgen-mesher again") from None
        ways = "; ".join(f"{system}: {command}" for system, command in LIBRARIES.items())
        raise InputError(f"the CAD kernel lacks a library of the system ({fault}). Install it. {ways}") from None
    return occ


def check_head(path: Path) -> None:
    """Raise ReadError where there is no such file, or it is no STEP file."""
    if not path.is_file():
        raise ReadError(f"no file {path}; geometry.step names a STEP file relative to the study")
    with path.open("rb") as file:
        head = file.read(64)
    if b"ISO-10303-21" not in head:
        raise ReadError(f"{path} is not a STEP file (it does not begin with ISO-10303-21); export STEP AP214 or AP242")


def read_step(path: Path) -> Any:
    """Return the OpenCASCADE shape of a STEP file, in the file's millimetres.

    Raises ReadError for files that cannot be read, hold no solid, or solids that the kernel leaves out.
    """
    check_head(path)
    occ = kernel()
    try:
        shape = occ.OCCGeometry(str(path)).shape
    except Exception as fault:
        raise ReadError(f"{path} cannot be read as STEP ({fault}); export it again from the CAD program") from None
    found, written = len(list(shape.solids)), len(_SOLID.findall(path.read_text(encoding="latin-1")))
    if not found:
        raise ReadError(f"{path} holds no solid; export solids, not surfaces")
    if found < written:
        raise ReadError(
            f"{path} holds {written} solids, of which the CAD kernel reads {found}: they are not in one assembly; "
            "export them as one"
        )
    return shape


def products(path: Path) -> list[str]:
    """The names of the products of a STEP file, which the kernel does not hand on."""
    return [name for name in dict.fromkeys(_PRODUCT.findall(path.read_text(encoding="latin-1"))) if name.strip()]
