"""A structure factorised part by part: the memory is that of the largest part, and of the faces where parts meet.

What lies inside each part is eliminated by itself. What is left is a matrix on the touched unknowns alone, those that
joints, bolts or supports may couple: the Schur complements of the parts and, exactly, whatever couples them. A change
of the joints changes that matrix alone (Przemieniecki 1963, doi:10.2514/3.1777).
"""

import shutil
import tempfile
import weakref
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import NotConverged
from faying.fe.condensed_part import CondensedPart
from faying.fe.memory import in_single
from faying.fe.pardiso import Pardiso
from faying.memory import available
from faying.typing import Array, Index

NAME = "PARDISO, part by part"
ALIKE = 1e-9  # relative difference of two parts' matrices that still counts as one
CHANGED = 1e-11  # relative change of the forces inside the parts beyond which they are factorised anew
DENSE = 12_000  # touched unknowns up to which their matrix is factorised as a dense one
ROOM = 0.3  # of the free memory that the factors of all parts may take before they go to the disk
SEED = 20261123


class PartByPart:
    """Factorises matrices that differ in their touched unknowns alone; the factors of the parts are made once.

    Args:
        parts: unknowns of each part, every unknown in one of them.
        touched: unknowns that joints, bolts and supports may couple or hold; those with entries between parts are
            added.
        alike: whether parts whose matrices agree share one factor.
        stored: whether only the factor of the part at work is in memory and the others are on the disk, in the place
            that TMPDIR names; None: where all together would take more than three tenths of the free memory.
    """

    name = NAME

    def __init__(
        self, parts: Sequence[Index], touched: Index, *, alike: bool = True, stored: bool | None = None
    ) -> None:
        self.parts, self.alike, self.stored = tuple(parts), alike, stored
        self._size = sum(len(part) for part in parts)
        self._touched = np.zeros(self._size, dtype=bool)
        self._touched[touched] = True
        self._made: tuple[_Parts, ...] = ()

    def factorise(self, matrix: Any, *, single: bool) -> "ByParts":
        """Factorise a symmetric positive definite CSR matrix (n, n), in single or in double precision.

        Raises:
            NotConverged: the matrix is singular.
            InputError: memory is short.
        """
        for made in self._made:
            if made.single == single and made.fits(matrix):
                return ByParts(made, matrix)
        self._made = ()  # before others are made, these are gone
        of_unknown = np.empty(self._size, dtype=np.int32)
        for number, part in enumerate(self.parts):
            of_unknown[part] = number
        rows = np.repeat(np.arange(self._size), np.diff(matrix.indptr))
        self._touched[rows[of_unknown[rows] != of_unknown[matrix.indices]]] = True
        del rows
        kinds = _kinds(self.parts, self._touched, matrix, alike=self.alike)
        self._made = (_Parts(self.parts, kinds, matrix, single=single, stored=self.stored),)
        return ByParts(self._made[0], matrix)


class _Parts:
    """The factors of the parts at one shift, each kind of part once."""

    def __init__(
        self,
        parts: Sequence[Index],
        kinds: Sequence[tuple[int, Index]],
        matrix: Any,
        *,
        single: bool,
        stored: bool | None,
    ) -> None:
        self.parts, self.single = parts, single
        self.kind_of = [kind for kind, _ in kinds]
        # touched unknowns of each part, as numbers in the part: those of all parts of its kind
        self.local = [inside for _, inside in kinds]
        self.touched = np.concatenate([part[inside] for part, inside in zip(parts, self.local, strict=True)])
        first = {kind: self.kind_of.index(kind) for kind in self.kind_of}
        free = available()
        need = sum((1 if single else 2) * in_single(len(parts[k])) for k in first.values())
        self._on_disk = len(first) > 1 and (stored if stored is not None else free is not None and need > ROOM * free)
        self.folder = None
        if self._on_disk:
            self.folder = Path(tempfile.mkdtemp(prefix="faying-"))
            weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)
        self._factors: dict[int, CondensedPart] = {}
        self._at_hand: int | None = None
        self.complements: list[Array] = []
        for kind, number in first.items():
            own = _block(matrix, parts[number], parts[number])
            self._factors[kind] = CondensedPart(own, self.local[number], single=single)
            if self._on_disk:
                self._store(kind)
        edges = [_block(matrix, part[i], part[i]) for part, i in zip(parts, self.local, strict=True)]
        self.edges = edges  # of the matrix that was condensed, on the touched unknowns
        self.complements = [self._factors[kind].schur for kind in self.kind_of]
        self.first = first
        self._probe = np.random.default_rng(SEED).standard_normal(matrix.shape[0])
        self._probe[self.touched] = 0.0
        self._answer = matrix @ self._probe
        sizes = [factor.memory for factor in self._factors.values()]
        self.memory = max(sizes) if self._on_disk else sum(sizes)

    def fits(self, matrix: Any) -> bool:
        """Whether a matrix differs from that of these parts in touched unknowns alone."""
        if matrix.shape[0] != len(self._probe):
            return False
        change = np.linalg.norm(matrix @ self._probe - self._answer)
        return bool(change < CHANGED * np.linalg.norm(self._answer))

    def factor(self, kind: int) -> CondensedPart:
        """The factor of a kind of part, in memory."""
        factor = self._factors[kind]
        if self._on_disk and self._at_hand != kind:
            if self._at_hand is not None:
                self._store(self._at_hand)
            factor.restore()
            self._at_hand = kind
        return factor

    def _store(self, kind: int) -> None:
        assert self.folder is not None
        self._factors[kind].store(self.folder / str(kind))
        self._at_hand = None


class ByParts:
    """The factor of one matrix: those of its parts, which may be shared, and that of its touched unknowns."""

    name = NAME

    def __init__(self, parts: _Parts, matrix: Any) -> None:
        self._parts = parts
        self._starts = np.cumsum([0, *(len(inside) for inside in parts.local)])
        self._core = _Core(self._condensed(matrix), single=parts.single)
        self.memory = parts.memory + self._core.memory

    def solve(self, right: Array) -> Array:
        """Solve for one right-hand side (n,) or several (n, m)."""
        columns = right[:, None] if right.ndim == 1 else right
        width = columns.shape[1]
        parts = self._parts
        halves: list[Array] = [np.zeros((0, 0))] * len(parts.parts)
        order = list(parts.first)
        for kind in order:
            same = [number for number, one in enumerate(parts.kind_of) if one == kind]
            stacked = np.concatenate([columns[parts.parts[number]] for number in same], axis=1)
            half = parts.factor(kind).forward(stacked)
            for place, number in enumerate(same):
                halves[number] = half[:, place * width : (place + 1) * width]
        left = np.concatenate([half[inside] for half, inside in zip(halves, parts.local, strict=True)])
        moved = self._core.solve(left)
        found = np.empty(columns.shape)
        for kind in reversed(order):  # the factor that was used last is still in memory
            same = [number for number, one in enumerate(parts.kind_of) if one == kind]
            half = np.concatenate([halves[number] for number in same], axis=1)
            ends = np.concatenate([moved[self._starts[k] : self._starts[k + 1]] for k in same], axis=1)
            whole = parts.factor(kind).backward(half, ends)
            for place, number in enumerate(same):
                found[parts.parts[number]] = whole[:, place * width : (place + 1) * width]
        return found[:, 0] if right.ndim == 1 else found

    def again(self, matrix: Any) -> "ByParts":
        """Factorise another matrix that differs in touched unknowns alone. Raises RuntimeError where it does not."""
        if not self._parts.fits(matrix):
            raise RuntimeError("what lies inside a part has changed: it is factorised anew")
        return ByParts(self._parts, matrix)

    def _condensed(self, matrix: Any) -> Any:
        """The matrix on the touched unknowns once all others are eliminated, sparse or dense."""
        from scipy.sparse import block_diag, csr_array

        parts = self._parts
        core = csr_array(_block(matrix, parts.touched, parts.touched) - block_diag(parts.edges, format="csr"))
        # a part of a kind was condensed with the touched entries of the first of its kind
        ways = [parts.edges[number] - parts.edges[parts.first[kind]] for number, kind in enumerate(parts.kind_of)]
        core = csr_array(core + block_diag(ways, format="csr"))
        if core.shape[0] <= DENSE:
            dense = core.toarray()
            for at, complement in zip(self._starts, parts.complements, strict=False):
                dense[at : at + len(complement), at : at + len(complement)] += complement
            return dense
        kept = np.float32 if parts.single else np.float64
        return csr_array(core.astype(kept) + block_diag(parts.complements, format="csr"))


class _Core:
    """The factor of the matrix on the touched unknowns, dense or sparse."""

    def __init__(self, matrix: Any, *, single: bool) -> None:
        self.memory: float
        self.solve: Callable[[Array], Array]
        if not isinstance(matrix, np.ndarray):
            factor = Pardiso(matrix, single=single)
            self.memory, self.solve = factor.memory, factor.solve
            return
        from scipy.linalg import cho_factor, cho_solve

        if not len(matrix):  # nothing couples the parts
            self.memory, self.solve = 0.0, np.asarray
            return
        try:
            lower = cho_factor(matrix, lower=True, overwrite_a=True, check_finite=False)
        except np.linalg.LinAlgError:
            raise NotConverged("the matrix is not positive definite; is a part free to move?") from None
        self.memory = float(matrix.nbytes)
        self.solve = lambda right: np.asarray(cho_solve(lower, right, check_finite=False))


def _block(matrix: Any, rows: Index, columns: Index) -> Any:
    """Rows and columns of a CSR matrix, as CSR with sorted indices."""
    from scipy.sparse import csr_array

    found = csr_array(matrix[rows][:, columns])
    found.sort_indices()
    return found


def _kinds(parts: Sequence[Index], touched: Any, matrix: Any, *, alike: bool) -> list[tuple[int, Index]]:
    """For each part the number of its kind and its touched unknowns, as numbers in the part.

    Parts are of one kind where their matrices agree but for the touched unknowns of any of them.
    """
    found: list[tuple[int, Index]] = [(-1, np.zeros(0, dtype=np.int64))] * len(parts)
    left = list(range(len(parts)))
    kind = 0
    while left:
        first = left[0]
        like = [other for other in left if other == first or (alike and len(parts[other]) == len(parts[first]))]
        own = _block(matrix, parts[first], parts[first]) if len(like) > 1 else None
        same, inside = [first], touched[parts[first]]
        for other in like[1:]:
            either = inside | touched[parts[other]]
            if _alike(own, _block(matrix, parts[other], parts[other]), either):
                same.append(other)
                inside = either
        for number in same:
            found[number] = (kind, np.flatnonzero(inside))
            left.remove(number)
        kind += 1
    return found


def _alike(one: Any, other: Any, apart: Any) -> bool:
    """Whether two matrices agree outside the block of the unknowns that `apart` marks."""
    difference = (one - other).tocoo()
    inner = ~(apart[difference.row] & apart[difference.col])
    size = float(np.abs(one.data).max(initial=0.0))
    return bool(np.abs(difference.data[inner]).max(initial=0.0) <= ALIKE * size)
