"""The CAD kernel, OpenCASCADE in netgen: how it is loaded, and what it leaves out of a STEP file.

Names of products in a STEP file: the kernel hands on the tree of an assembly, with the names of occurrences alone.

The product behind each occurrence is read from the text of the file: PRODUCT, its definitions, and the occurrences
(NEXT_ASSEMBLY_USAGE_OCCURRENCE) that place one definition in another (ISO 10303-21, -41 and -44).
"""

import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeVar

from faying.apart import Died, apart
from faying.errors import InputError, ReadError
from faying.file_kinds import STEP, kind_held
from faying.files import named_by, named_files
from faying.notes import Note
from faying.text import listed

_ENTITY = re.compile(
    r"#(\d+)\s*=\s*(PRODUCT|PRODUCT_DEFINITION|PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS|"
    r"PRODUCT_DEFINITION_FORMATION|PRODUCT_DEFINITION_FORMATION_WITH_SPECIFIED_SOURCE|"
    r"NEXT_ASSEMBLY_USAGE_OCCURRENCE)\s*\("
)
_ARGUMENT = re.compile(r"'((?:[^']|'')*)'|#(\d+)|/\*.*?\*/|([(),])|[^'#(),/]+|/", re.DOTALL)
_ESCAPE = re.compile(
    r"\\X2\\((?:[0-9A-Fa-f]{4})+)\\X0\\|\\X4\\((?:[0-9A-Fa-f]{8})+)\\X0\\|\\X\\([0-9A-Fa-f]{2})|\\S\\(.)"
)
PLACEHOLDER = "Open CASCADE STEP translator"  # what the kernel writes for want of a name
COUNTED = re.compile(r"(?:NAUO|=>\[[^\]]*\])?\s*\d*")  # names of occurrences that only count them


@dataclass(frozen=True, kw_only=True)
class Occurrence:
    """A definition that is placed in another: its words (name, id, description) and the definitions' numbers."""

    words: tuple[str, ...]
    inside: int
    of: int


@dataclass(frozen=True, kw_only=True)
class Products:
    """Products of a file: name by number of definition, and the occurrences of definitions in each other."""

    names: Mapping[int, str]
    occurrences: tuple[Occurrence, ...]

    @property
    def roots(self) -> set[int]:
        """Definitions that are placed in no other."""
        return set(self.names) - {one.of for one in self.occurrences}

    def below(self, definitions: set[int], label: str) -> list[Occurrence]:
        """Occurrences of this label in any of the definitions."""
        return [one for one in self.occurrences if one.inside in definitions and label in one.words]


@dataclass(frozen=True, kw_only=True)
class Leaf:
    """A shape of an assembly in its place; product and occurrence are "" where the file does not tell them apart."""

    shape: Any
    product: str
    occurrence: str


def read_products(text: str) -> Products:
    """Read products and occurrences from the text of a STEP file."""
    entities: dict[str, dict[int, list[str | int]]] = {}
    for found in _ENTITY.finditer(text):
        kind = found[2].replace("_WITH_SPECIFIED_SOURCE", "").replace("_WITH_ASSOCIATED_DOCUMENTS", "")
        entities.setdefault(kind, {})[int(found[1])] = list(_arguments(text, found.end()))
    names = {number: _name(words) for number, words in entities.get("PRODUCT", {}).items()}
    for kind in ("PRODUCT_DEFINITION_FORMATION", "PRODUCT_DEFINITION"):  # each refers to one of the kind before
        made = entities.get(kind, {}).items()
        names = {number: names[at] for number, words in made for at in words if isinstance(at, int) and at in names}
    occurrences = []
    for words in entities.get("NEXT_ASSEMBLY_USAGE_OCCURRENCE", {}).values():
        texts = [word for word in words if isinstance(word, str)]
        at = [word for word in words if isinstance(word, int)]
        if len(at) >= 2 and at[0] in names and at[1] in names:
            order = (*texts[1:2], *texts[:1], *texts[2:3])  # the name first, then the id
            occurrences.append(Occurrence(words=tuple(order), inside=at[0], of=at[1]))
    return Products(names=names, occurrences=tuple(occurrences))


def leaves(tree: Any, products: Products) -> list[Leaf]:
    """The placed shapes of the kernel's tree, each with its product and the name of its occurrence."""
    out: list[Leaf] = []

    def walk(node: Any, definitions: set[int], occurrence: str) -> None:
        children = list(node.children)
        if not children:
            names = {products.names[number] for number in definitions}
            if not node.is_assembly and node.shape is not None:
                product = names.pop() if len(names) == 1 else ""
                out.append(Leaf(shape=node.shape, product=product, occurrence=occurrence))
            return
        for child in children:
            found = products.below(definitions, child.name)
            given = {one.words[0] for one in found}
            walk(child, {one.of for one in found}, given.pop() if len(given) == 1 else "")

    for top in tree.children:
        named = {number for number in products.roots if products.names[number] == top.name}
        walk(top, named or products.roots, "")
    return out


def named_by_product(solids: Sequence[Any], found: Sequence[Leaf]) -> list[str]:
    """The name of each solid after its product, "" where there is none that tells it from the others.

    Solids that one product holds together have its name where the file holds several products. Where a product occurs
    several times, the names of its occurrences stand for it, if they are names and differ.
    """
    out = [""] * len(solids)
    several = len(found) > 1
    owned: dict[str, list[tuple[int, str]]] = {}
    for leaf in found:
        own_solids = [k for k, solid in enumerate(solids) if any(solid == one for one in leaf.shape.solids)]
        if leaf.product.startswith(PLACEHOLDER) or not leaf.product.strip() or (len(own_solids) > 1 and not several):
            continue
        for k in own_solids:
            owned.setdefault(leaf.product, []).append((k, leaf.occurrence if len(own_solids) == 1 else ""))
    for product, places in owned.items():
        called = [occurrence for _, occurrence in places]
        apart = len(set(called)) == len(called) > 1 and not any(COUNTED.fullmatch(word) for word in called)
        for k, occurrence in places:
            out[k] = occurrence if apart else product
    return out


def _name(words: Sequence[str | int]) -> str:
    """The name of a product, its id where that is empty."""
    texts = [word for word in words if isinstance(word, str)]
    return next((word for word in (*texts[1:2], *texts[:1]) if word.strip()), "")


def _arguments(text: str, start: int) -> Iterator[str | int]:
    """Texts and references among the arguments of an entity, from behind its bracket on; not those of lists within."""
    depth = 1
    for found in _ARGUMENT.finditer(text, start):
        if found[3] == "(":
            depth += 1
        elif found[3] == ")":
            depth -= 1
            if not depth:
                return
        elif depth == 1 and found[1] is not None:
            yield decoded(found[1])
        elif depth == 1 and found[2]:
            yield int(found[2])


def decoded(text: str) -> str:
    r"""Text as a STEP file writes it, with '' for ' and \X2\...\X0\ for letters outside of ASCII."""

    def letter(found: re.Match[str]) -> str:
        if found[1]:
            return bytes.fromhex(found[1]).decode("utf-16-be", errors="replace")
        if found[2]:
            return bytes.fromhex(found[2]).decode("utf-32-be", errors="replace")
        return chr(int(found[3], 16)) if found[3] else chr(ord(found[4]) + 128)

    return _ESCAPE.sub(letter, text.replace("''", "'")).replace("\\\\", "\\")


T = TypeVar("T")
_SOLID = re.compile(r"=\s*(?:MANIFOLD_SOLID_BREP|BREP_WITH_VOIDS)\s*\(")
# entities that name the file of a part, and the name in them
KERNEL_SUFFIXES = (".step", ".stp")  # that the kernel takes for STEP
_REFERRING = ("DOCUMENT_FILE", "APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT", "EXTERNAL_SOURCE")
_OUTSIDE = re.compile(rf"\b(?:{'|'.join(_REFERRING)})\s*\([^;]*;")
_FILE = re.compile(r"'((?:[^']|'')+\.(?:stp|step|p21))'", re.IGNORECASE)

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


def files_of(path: Path) -> tuple[Path, ...]:
    """A STEP file and those that it refers to for the shapes of its parts, and so on.

    Raises ReadError, with the name, where one of them is not there.
    """
    files = named_files(path, lambda data: map(decoded, _references(data)))
    missing = [os.path.relpath(file, path.parent) for file in files[1:] if not file.is_file()]
    if missing:
        solids = "" if _SOLID.search(path.read_text(encoding="latin-1")) else " and holds no solid of its own"
        raise ReadError(
            f"{path} refers to {listed(missing)} for parts{solids}; put the missing files where they are named, or "
            "export the assembly as one file"
        )
    return tuple(files)


def _references(data: bytes) -> list[str]:
    """Names of files of parts in a STEP file, as it writes them; those of its other documents are not."""
    if not any(word.encode() in data for word in _REFERRING):  # most have none, which this tells ten times sooner
        return []
    entities = _OUTSIDE.findall(data.decode("latin-1"))
    return sorted({name for entity in entities for name in _FILE.findall(entity)})


def _gathered(files: Sequence[Path], texts: Sequence[str], folder: Path) -> Path:
    """Copies of a STEP file and of those that it refers to, side by side, with the suffix that the kernel goes by.

    Args:
        files: it and all that it refers to; texts: of each.
        folder: where the copies go; a file alone that has this suffix needs none.
    """
    if len(files) == 1 and files[0].suffix in KERNEL_SUFFIXES:
        return files[0]
    places = {file.resolve(): f"{number}.step" for number, file in enumerate(files)}
    for file, text in zip(files, texts, strict=True):

        def place(found: re.Match[str], file: Path = file) -> str:
            return f"'{places[named_by(file, decoded(found[1])).resolve()]}'"

        here = text if len(files) == 1 else _OUTSIDE.sub(lambda entity: _FILE.sub(place, entity[0]), text)
        (folder / places[file.resolve()]).write_text(here, encoding="latin-1")
    return folder / places[files[0].resolve()]


def _leaves(path: Path) -> list[Leaf]:
    """The placed shapes of a STEP file and of those that it refers to."""
    check_head(path)
    files = files_of(path)
    texts = [file.read_text(encoding="latin-1") for file in files]
    geometry, written = kernel().OCCGeometry, sum(len(_SOLID.findall(text)) for text in texts)
    try:
        with TemporaryDirectory() as folder:
            shapes = geometry(str(_gathered(files, texts, Path(folder))))
        found = leaves(shapes.GetAssemblyTree(), read_products(texts[0]))
    except Exception as fault:
        if written:  # the kernel has many words for a file without any shape
            raise ReadError(f"{path} cannot be read as STEP ({fault}); export it again from the CAD program") from None
        found = []
    read = sum(len(list(leaf.shape.solids)) for leaf in found)
    if not read:
        raise ReadError(f"{path} has no solids; export solids, not surfaces or a mesh")
    if read < written:
        raise ReadError(
            f"{path} has {written} solids, of which the CAD kernel reads {read}; export it again, as one assembly"
        )
    return found


@dataclass(frozen=True, kw_only=True)
class CadParts:
    """The solids of a STEP file.

    Args:
        solids: one by one [mm], in the kernel's order; their faces count from 1 in the order of `solid.faces`.
        names: a name of its own for each.
        notes: where names are missing or given several times.
    """

    solids: list[Any]
    names: list[str]
    notes: tuple[Note, ...]

    def without(self, parts: Sequence[str]) -> "CadParts":
        """The same with some parts left out. Raises InputError where there is no such part, or none is left."""
        self._check(parts, "leave_out")
        left = [k for k, name in enumerate(self.names) if name not in parts]
        if not left:
            raise InputError("geometry.leave_out leaves no part; take at least two out of it")
        return replace(self, solids=[self.solids[k] for k in left], names=[self.names[k] for k in left])

    def _check(self, parts: Sequence[str], key: str) -> None:
        """Raise InputError where a key of the study names a part that is not there."""
        missing = [part for part in parts if part not in self.names]
        if missing:
            raise InputError(
                f"geometry.{key} names the part {missing[0]!r}, which is not there; the parts are "
                f"{', '.join(map(repr, self.names))}"
            )

    def united(self, groups: Sequence[Sequence[str]]) -> "CadParts":
        """The same with the bodies of each group as one part, by the name of its first.

        Raises InputError where there is no such part, or a group does not touch.
        """
        solids, gone = list(self.solids), set()
        for group in groups:
            self._check(group or [""], "unite")
            first, *others = (self.names.index(part) for part in group)
            one = list(sum((solids[k] for k in others), solids[first]).solids)
            if len(one) != 1:
                raise InputError(f"geometry.unite: {listed(map(repr, group))} do not touch; they make no single part")
            solids[first] = one[0]
            gone |= {*others}
        left = [k for k in range(len(solids)) if k not in gone]
        return replace(self, solids=[solids[k] for k in left], names=[self.names[k] for k in left])


def read_parts(path: Path) -> CadParts:
    """Read the solids of a STEP file with their names: of the solid, else of its product, else part1, part2.

    Raises ReadError for files that cannot be read, lack a file that they refer to, or hold no solid, and for solids
    that the kernel leaves out.
    """
    found = _leaves(path)
    solids = [solid for leaf in found for solid in leaf.shape.solids]
    for thing in (*solids, *(face for solid in solids for face in solid.faces)):
        if (thing.name or "").strip().upper() in NO_NAMES:
            thing.name = ""
    given = [solid.name or product for solid, product in zip(solids, named_by_product(solids, found), strict=True)]
    names, notes = own_names(given, path.name)
    products = [name for name in dict.fromkeys(leaf.product for leaf in found) if name.strip()]
    notes += (*_nameless(path, solids, given, products), *_drop_shared(path, solids, names))
    return CadParts(solids=solids, names=names, notes=notes)


def _drop_shared(path: Path, solids: Sequence[Any], names: Sequence[str]) -> tuple[Note, ...]:
    """Take names away that faces of several parts have: they tell no face. A note says which."""
    faces = [(face, part) for solid, part in zip(solids, names, strict=True) for face in solid.faces if face.name]
    owners: dict[str, set[str]] = {}
    for face, part in faces:
        owners.setdefault(face.name, set()).add(part)
    shared = {name: f"{name!r} ({', '.join(sorted(parts))})" for name, parts in owners.items() if len(parts) > 1}
    for face, _ in faces:
        if face.name in shared:
            face.name = ""
    text = f"{path.name}: faces of several parts have one name, which names none of them then: "
    text += f"{', '.join(shared.values())}; name them apart, or choose them by what they are"
    return (Note(code="shared-names", text=text),) if shared else ()


def own_names(given: Sequence[str], file: str) -> tuple[list[str], tuple[Note, ...]]:
    """A name of its own for every solid, and a note where the file gives one several times."""
    names = [name or f"part{number + 1}" for number, name in enumerate(given)]
    out: list[str] = []
    for number, name in enumerate(names):
        own = name if names.count(name) == 1 else f"{name}_{names[: number + 1].count(name)}"
        while own in out or (own != name and own in names):
            own += "_"
        out.append(own)
    alike = {name: [o for n, o in zip(names, out, strict=True) if n == name] for name in names}
    numbered = "; ".join(f"{name!r} is {', '.join(some)}" for name, some in alike.items() if len(some) > 1)
    text = f"{file} names several solids alike; they are numbered in the order of the file: {numbered}"
    return out, (Note(code="numbered-parts", text=text),) if numbered else ()


def _nameless(path: Path, solids: Sequence[Any], names: Sequence[str], products: Sequence[str]) -> tuple[Note, ...]:
    """Where solids without a name lie."""
    where = [
        f"part{number} about ({', '.join(f'{getattr(solid.center, axis):.4g}' for axis in 'xyz')}) mm"
        for number, (solid, name) in enumerate(zip(solids, names, strict=True), 1)
        if not name
    ]
    text = (
        f"{path.name} gives no names that tell its solids apart: {', '.join(where)} (products: "
        f"{', '.join(products) or 'none'}); name the bodies in the CAD program, or take these names"
    )
    return (Note(code="nameless-parts", text=text),) if where else ()
