"""The CAD kernel, OpenCASCADE in netgen: how it is loaded, and what it leaves out of a STEP file."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from faying.apart import Died, apart
from faying.errors import InputError, ReadError
from faying.file_kinds import STEP, kind_held
from faying.geometry.products import Products, leaves, named_by_product, read_products
from faying.notes import Note

T = TypeVar("T")
_SOLID = re.compile(r"=\s*(?:MANIFOLD_SOLID_BREP|BREP_WITH_VOIDS)\s*\(")

NO_NAMES = ("", "NONE")  # what exporters write for want of a name
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


def ask_kernel(path: Path, task: Callable[..., T], *rest: Any) -> T:
    """What a task finds of a CAD file in a process of its own, since the kernel dies on some files.

    Args:
        path: the file, which the task takes first.
        task: a function of a module.
        rest: what else it takes.

    Raises:
        ReadError: the process died on the file, or what the task raised.
        InputError: what the task raised.
    """
    try:
        return apart(None, task, path.resolve(), *rest)
    except Died as fault:
        raise ReadError(
            f"{path}: the CAD kernel died on it ({fault}); repair the geometry in the CAD program and export it again"
        ) from None


def check_head(path: Path) -> None:
    """Raise ReadError where there is no such file, or it is not a STEP file."""
    if not path.is_file():
        raise ReadError(f"no file {path}; geometry.step names a STEP file relative to the study")
    kind = kind_held(path)
    if kind is not STEP:
        why = "it does not begin with ISO-10303-21" if kind is None else f"it is {kind.says}"
        raise ReadError(f"{path} is not a STEP file ({why}); export STEP AP214 or AP242")


def read_step(path: Path) -> Any:
    """Return the OpenCASCADE shape of a STEP file, in the file's millimetres.

    Raises ReadError for files that cannot be read, hold no solid, or solids that the kernel leaves out.
    """
    return _geometry(path).shape


def write_step(path: Path, solids: Sequence[Any]) -> None:
    """Write solids [mm] as a STEP file, which is the same file whenever it is written.

    The kernel would put the time into it, and how many files it has written.
    """
    kernel().Compound(list(solids)).WriteStep(str(path))
    path.write_text(without_time(path.read_text(encoding="latin-1")), encoding="latin-1")


def without_time(text: str) -> str:
    """The text of a STEP file of the kernel without the time and the number of files written before."""
    text = re.sub(r"'\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d'", "'2000-01-01T00:00:00'", text, count=1)
    return re.sub(r"(STEP translator \S+) \d+", r"\1 1", text)


def _geometry(path: Path) -> Any:
    check_head(path)
    occ = kernel()
    try:
        geometry = occ.OCCGeometry(str(path))
        shape = geometry.shape
    except Exception as fault:
        raise ReadError(f"{path} cannot be read as STEP ({fault}); export it again from the CAD program") from None
    found, written = len(list(shape.solids)), len(_SOLID.findall(path.read_text(encoding="latin-1")))
    if not found:
        raise ReadError(f"{path} has no solids; export solids, not surfaces")
    if found < written:
        raise ReadError(
            f"{path} has {written} solids, but the CAD kernel reads {found}: they are not in one assembly; "
            "export them as one"
        )
    return geometry


@dataclass(frozen=True, kw_only=True)
class CadParts:
    """The solids of a STEP file.

    Args:
        shape: all of the file, as the kernel read it [mm].
        solids: one by one, in the kernel's order; their faces count from 1 in the order of `solid.faces`.
        names: a name of its own for each.
        notes: where names are missing or given several times.
    """

    shape: Any
    solids: list[Any]
    names: list[str]
    notes: tuple[Note, ...]

    def without(self, parts: Sequence[str]) -> "CadParts":
        """The same with some parts left out. Raises InputError where there is no such part, or none is left."""
        missing = [part for part in parts if part not in self.names]
        if missing:
            raise InputError(
                f"geometry.leave_out names the part {missing[0]!r}, which is not there; the parts are "
                f"{', '.join(map(repr, self.names))}"
            )
        left = [k for k, name in enumerate(self.names) if name not in parts]
        if not left:
            raise InputError("geometry.leave_out leaves no part; take at least two out of it")
        return replace(self, solids=[self.solids[k] for k in left], names=[self.names[k] for k in left])


def read_parts(path: Path) -> CadParts:
    """Read the solids of a STEP file with their names: of the solid, else of its product, else part1, part2.

    Raises ReadError as `read_step`.
    """
    geometry = _geometry(path)
    solids = list(geometry.shape.solids)
    for thing in (*solids, *(face for solid in solids for face in solid.faces)):
        if (thing.name or "").strip().upper() in NO_NAMES:
            thing.name = ""
    found = products(path)
    tree = geometry.GetAssemblyTree() if hasattr(geometry, "GetAssemblyTree") else None  # netgen 6.2.2608 and later
    given = [""] * len(solids) if tree is None else named_by_product(solids, leaves(tree, found))
    given = [solid.name or product for solid, product in zip(solids, given, strict=True)]
    names, notes = own_names(given, path.name)
    listed = [name for name in dict.fromkeys(found.names.values()) if name.strip()]
    notes += (*_nameless(path, solids, given, listed), *_drop_shared(path, solids, names))
    return CadParts(shape=geometry.shape, solids=solids, names=names, notes=notes)


def _drop_shared(path: Path, solids: Sequence[Any], names: Sequence[str]) -> tuple[Note, ...]:
    """Take names away that faces of several parts have: they tell no face. A note says which."""
    owners: dict[str, set[str]] = {}
    for solid, part in zip(solids, names, strict=True):
        for face in solid.faces:
            owners.setdefault(face.name or "", set()).add(part)
    shared = [name for name, parts in owners.items() if name and len(parts) > 1]
    for solid in solids:
        for face in solid.faces:
            if face.name in shared:
                face.name = ""
    if not shared:
        return ()
    listed = ", ".join(f"{name!r} ({', '.join(sorted(owners[name]))})" for name in shared)
    text = f"{path.name}: faces of several parts have one name, which names none of them then: {listed}"
    return (Note(code="shared-names", text=f"{text}; name them apart, or choose them by what they are"),)


def products(path: Path) -> Products:
    """The products of a STEP file, which the kernel does not hand on."""
    return read_products(path.read_text(encoding="latin-1"))


def own_names(given: Sequence[str], file: str) -> tuple[list[str], tuple[Note, ...]]:
    """A name of its own for every solid, and a note where the file gives one several times."""
    names = [name or f"part{number + 1}" for number, name in enumerate(given)]
    out: list[str] = []
    for number, name in enumerate(names):
        own = name if names.count(name) == 1 else f"{name}_{names[: number + 1].count(name)}"
        while own in out or (own != name and own in names):
            own += "_"
        out.append(own)
    numbered = [
        f"{name!r} is {', '.join(o for n, o in zip(names, out, strict=True) if n == name)}"
        for name in dict.fromkeys(names)
        if names.count(name) > 1
    ]
    if not numbered:
        return out, ()
    text = f"{file} names several solids alike; they are numbered in the order of the file: {'; '.join(numbered)}"
    return out, (Note(code="numbered-parts", text=text),)


def _nameless(path: Path, solids: Sequence[Any], names: Sequence[str], listed: Sequence[str]) -> tuple[Note, ...]:
    """Where solids without a name lie."""
    where = [
        f"part{number} about ({', '.join(f'{getattr(solid.center, axis):.4g}' for axis in 'xyz')}) mm"
        for number, (solid, name) in enumerate(zip(solids, names, strict=True), 1)
        if not name
    ]
    if not where:
        return ()
    text = (
        f"{path.name} gives no names that tell its solids apart: {', '.join(where)} (products: "
        f"{', '.join(listed) or 'none'}); name the bodies in the CAD program, or take these names"
    )
    return (Note(code="nameless-parts", text=text),)
