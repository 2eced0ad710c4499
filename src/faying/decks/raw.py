"""What a file holds before it becomes a mesh or matrices: the file's own numbers, its own unit, its sets."""

from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from faying.errors import InputError, ReadError
from faying.fe.elements import SOLIDS
from faying.memory import available
from faying.text import few
from faying.typing import Array, Index

GREATEST = 10**12  # number of a node or an element
MAX_RANGE = 20_000_000  # numbers of a range
DIGITS = 30  # of a number of a node or a direction, zeros in front included
DEEPEST, MAX_FILES = 20, 500  # of included files
# Nastran and Code_Aster put the middle nodes of the upright edges before those of the top; by number of nodes
UPRIGHT_FIRST = {20: [*range(12), *range(16, 20), *range(12, 16)], 15: [*range(9), *range(12, 15), *range(9, 12)]}

Matrices: TypeAlias = tuple[Any, Any, Index]
"""Stiffness and mass (n, n), sparse, and dofs (n, 2): number of the node, direction 1, 2, 3."""


@dataclass(frozen=True, kw_only=True)
class Pretension:
    """A section at which another program tightens a bolt.

    Args:
        text: the words of the file that say so.
        nodes: numbers of the nodes of the section.
        twins: numbers of the nodes on its other side, where the file cuts the bolt in two there; else empty.
        axis: direction of the bolt as the file gives it; None where it does not.
        force: what the file pulls with, in its own unit; None where it gives no force.
    """

    text: str
    nodes: Index
    twins: Index = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    axis: tuple[float, float, float] | None = None
    force: float | None = None


@dataclass(frozen=True, kw_only=True)
class RawMesh:
    """Nodes and solid elements by number, and every named set.

    numbers (n,), points (n, 3); elements: kind -> (numbers (e,), node numbers (e, a)) in VTK's order; bodies: name ->
    element numbers, the parts that the file itself makes of its elements; element_sets, node_sets: name -> numbers;
    side_sets: name -> rows of (element number, side); face_elements: name -> arrays of node numbers (f, a); extra:
    numbers of nodes that only elements other than solids hold; lines: nodes of lines that no note counts; references:
    nodes that constraints alone name; turned: nodes displaced in directions of their own; notes: what was left out;
    pretensions: sections at which bolts are tightened; counted: whether the file says how many nodes and elements it
    has, and has them, or where it ends. Raises ReadError for numbers below 1 or without end, and places not finite.
    """

    numbers: Index
    points: Array
    elements: Mapping[str, tuple[Index, Index]]
    bodies: Mapping[str, Index] = field(default_factory=dict)
    element_sets: Mapping[str, Index] = field(default_factory=dict)
    node_sets: Mapping[str, Index] = field(default_factory=dict)
    side_sets: Mapping[str, Index] = field(default_factory=dict)
    face_elements: Mapping[str, tuple[Index, ...]] = field(default_factory=dict)
    extra: Index = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    lines: Index = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    references: Index = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    turned: Index = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    notes: tuple[str, ...] = ()
    pretensions: tuple[Pretension, ...] = ()
    counted: bool = False

    def __post_init__(self) -> None:
        elements = [("element", numbers) for numbers, _ in self.elements.values()]
        for what, some in [("node", self.numbers), *elements]:
            wrong = some[(some < 1) | (some > GREATEST)]
            if len(wrong):
                raise ReadError(
                    f"{what} {wrong[0]}: numbers of {what}s are between 1 and {GREATEST:,}; is the file complete?"
                )
        if self.points.shape != (len(self.numbers), 3) or not np.all(np.isfinite(self.points)):
            bad = self.numbers[~np.isfinite(self.points).all(axis=-1)] if self.points.ndim == 2 else self.numbers
            raise ReadError(f"node {bad[0] if len(bad) else 1} has no three finite coordinates; is the file complete?")


def index(values: Iterable[Any]) -> Index:
    """Whole numbers, or their texts, as an array. Raises ValueError for others and ReadError for huge ones."""
    numbers = [int(value) for value in values]
    try:
        return np.array(numbers, dtype=np.int64)
    except OverflowError:
        raise ReadError(
            f"the number {max(numbers, key=abs):.3g} is none of a node or an element; is the file complete?"
        ) from None


def joined(blocks: Iterable[Index]) -> Index:
    """Several arrays of numbers as one, which is empty where there are none."""
    return np.concatenate([np.zeros(0, dtype=np.int64), *blocks])


def ranged(first: int, last: int, step: int, where: str) -> Index:
    """Numbers from first to last. Raises ReadError where they do not rise or are more than any file holds."""
    if step < 1 or last < first or first < 1 or (last - first) // step > MAX_RANGE:
        raise ReadError(
            f"{where}: a range from {first} to {last} by {step}; ranges rise from 1 or more and have at most "
            f"{MAX_RANGE:,} numbers"
        )
    return np.arange(first, last + 1, step)


def not_in_file(who: str, what: str, numbers: Iterable[int], there: Collection[int] = ()) -> list[str]:
    """A note on things that something names by their numbers and the file does not hold; none where all are there."""
    absent = sorted({*numbers}.difference(there))
    return [f"{who} names {what} that are not in the file: {few(absent)}"] if absent else []


def gathered(rows: Mapping[str, list[tuple[int, list[int]]]]) -> dict[str, tuple[Index, Index]]:
    """Turn kind -> [(number, nodes)] into the arrays of RawMesh.elements."""
    return {
        kind: (index(number for number, _ in some), np.array([nodes for _, nodes in some], dtype=np.int64))
        for kind, some in rows.items()
        if some
    }


def face_blocks(rows: Iterable[list[int]]) -> tuple[Index, ...]:
    """Faces of mixed kinds as one array per kind."""
    some = list(rows)
    return tuple(
        np.array([row for row in some if len(row) == count], dtype=np.int64)
        for count in sorted({len(row) for row in some})
    )


def undoubled(nodes: list[int], what: str) -> tuple[str, list[int]]:
    """Kind and nodes of a solid given as a brick with corners that coincide, as ANSYS writes wedges and tetrahedra.

    Raises ReadError for other shapes, pyramids among them, and where a middle node is 0.
    """
    if 0 in nodes:
        raise ReadError(f"{what} lacks a node in the middle of an edge; mesh with all of them, or with none")
    corners = nodes[:8]
    different = len(set(corners))
    quadratic = len(nodes) > 8
    if len(nodes) in (4, 10) or different == 8:
        return SOLIDS[len(nodes)].name, nodes
    if different == 6 and corners[2] == corners[3] and corners[6] == corners[7]:
        pick = [0, 1, 2, 4, 5, 6] + ([8, 9, 11, 12, 13, 15, 16, 17, 18] if quadratic else [])
        return ("wedge15" if quadratic else "wedge6"), [nodes[i] for i in pick]
    if different == 4 and corners[2] == corners[3] and len(set(corners[4:])) == 1:
        pick = [0, 1, 2, 4] + ([8, 9, 11, 16, 17, 18] if quadratic else [])
        return ("tet10" if quadratic else "tet4"), [nodes[i] for i in pick]
    shape = "a pyramid" if different == 5 else f"a solid of {different} corners"
    raise ReadError(f"{what} is {shape}; mesh with tetrahedra, wedges or bricks")


def read_text(path: Path, what: str) -> str:
    """Text of a file; ReadError where it cannot be read."""
    if path.exists() and not path.is_file():
        raise ReadError(f"cannot read the {what} {path}: it is not a regular file")
    try:
        return path.read_text(encoding="utf-8-sig", errors="replace")
    except OSError as fault:
        raise ReadError(f"cannot read the {what} {path}: {fault.strerror or fault}") from None


def check_included(path: Path, seen: tuple[Path, ...], count: list[int]) -> None:
    """Count one more file of those that a file includes. Raises ReadError for too many, and for one in itself.

    seen: the files that led to it; count: how many were read before, which rises.
    """
    count[0] += 1
    if path.resolve() in seen:
        raise ReadError(f"{path} includes itself")
    if len(seen) > DEEPEST or count[0] > MAX_FILES:
        raise ReadError(f"{path}: more than {MAX_FILES} files are included, or {DEEPEST} deep; write them into one")


@contextmanager
def understood(what: str) -> Iterator[None]:
    """Raise ReadError where a word is not the number that it should be, or a line ends too early; what: is read."""
    try:
        yield
    except (ValueError, IndexError, KeyError, OverflowError) as fault:
        if isinstance(fault, InputError):
            raise
        raise ReadError(f"{what} ({fault}); is the file complete?") from None


def numbers_of(path: Path, text: str, count: int | None = None) -> Array:
    """All numbers of a text.

    Raises ReadError where there are others than `count`, or a word or the last line is cut.
    """
    import warnings

    if text and not text.endswith("\n"):
        raise ReadError(f"{path} ends in the middle of a line; it is cut short")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            values = np.fromstring(text.replace("D", "E").replace("d", "e"), sep=" ")
        except (DeprecationWarning, ValueError):
            raise ReadError(f"{path} has words that are not numbers; is it complete?") from None
    if count is not None and len(values) != count:
        raise ReadError(f"{path} has {len(values):,} numbers where its head says {count:,}; is it complete?")
    return values


def whole(path: Path, values: Array, size: int) -> Index:
    """Indices from 1 as whole numbers from 0. Raises ReadError for others than 1 to size."""
    if len(values) and not (np.all(values == np.round(values)) and 1 <= values.min() <= values.max() <= size):
        wrong = values[(values != np.round(values)) | (values < 1) | (values > size)][0]
        raise ReadError(f"{path} has the row or column {wrong:g}; there are {size} unknowns, numbered from 1")
    return values.astype(np.int64) - 1


def once(name: str, rows: Index, columns: Index, width: int) -> None:
    """Raise ReadError where an entry is given twice."""
    key = np.sort(rows.astype(np.int64) * width + columns)
    again = key[1:][key[1:] == key[:-1]]
    if len(again):
        raise ReadError(f"{name}: row {again[0] // width + 1}, column {again[0] % width + 1} is given twice")


def both_triangles(half: Any) -> Any:
    """The symmetric matrix of one triangle."""
    from scipy.sparse import diags_array

    return (half + half.T - diags_array(half.diagonal())).tocsr()


def room(size: float, name: str) -> None:
    """Raise InputError where what a file unpacks to [B], three times over, is more than the memory there is."""
    free = available()
    if free is not None and 3 * size > free:
        raise InputError(
            f"{name} unpacks to {size / 1e9:.3g} GB; about {3 * size / 1e9:.3g} GB of memory are needed to read it"
        )


def read_dofs(path: Path) -> Index:
    """Read a list of unknowns (n, 2): node and direction."""
    out = []
    for k, line in enumerate(read_text(path, "list of unknowns").splitlines(), 1):
        words = line.replace(".", " ").split()
        if not words:
            continue
        if len(words) != 2 or not all(word.isdecimal() and len(word) <= DIGITS for word in words):
            raise ReadError(f'{path}, line {k}: "{line.strip()[:60]}" should be a node and a direction, such as 12.1')
        node, axis = int(words[0]), int(words[1])
        if not (1 <= node <= GREATEST and 1 <= axis <= 6):
            raise ReadError(
                f"{path}, line {k}: node {node} direction {axis}; nodes are numbered from 1 to {GREATEST:,} and "
                "directions from 1 to 6"
            )
        out.append((node, axis))
    return np.array(out, dtype=np.int64).reshape(-1, 2)
