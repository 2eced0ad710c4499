"""A structure factorised part by part: the memory is that of the largest part, and of the faces where parts meet.

What lies inside each part is eliminated by itself. What is left is a matrix on the touched unknowns alone, those that
joints, bolts or supports may couple: the Schur complements of the parts and, exactly, whatever couples them. A change
of the joints changes that matrix alone (Przemieniecki 1963, AIAA Journal 1, 138).
"""

import ctypes
import shutil
import tempfile
import weakref
from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import NotConverged
from faying.memory import available
from faying.numerics.block_cholesky import BlockCholesky
from faying.numerics.memory import in_single
from faying.numerics.pardiso import FORGET, Pardiso, handle
from faying.numerics.shifted import block
from faying.numerics.solve import BY_PARTS
from faying.typing import Array, Index

FORWARD, BACKWARD = 331, 333


class CondensedPart(Pardiso):
    """A factor of the inside of a part by PARDISO, with the Schur complement on its touched unknowns.

    Args:
        matrix: makes that of the part, symmetric positive definite CSR (n, n).
        size: n.
        touched: unknowns (t,) that are not eliminated.
        single: whether in single precision.

    Raises:
        NotConverged: the matrix is singular.
        InputError: memory is short.
    """

    def __init__(self, matrix: Callable[[], Any], size: int, touched: Index, *, single: bool) -> None:
        self._touched = touched
        self._stored: Path | None = None
        self._none, self._all = len(touched) == 0, len(touched) == size
        if self._all:  # nothing lies inside
            self.schur = matrix().toarray()
            self.memory = float(self.schur.nbytes)
            return
        super().__init__(matrix, single=single, not_eliminated=None if self._none else touched)
        if not self._none:
            self._values = np.zeros(0, dtype=self._type)  # the factor has taken what it needs

    def forward(self, right: Array) -> Array:
        """Half of a solution (n, k) of right-hand sides (n, k): the touched rows hold what is left there."""
        if self._none or self._all:
            return np.array(right)
        return self._half(FORWARD, right)

    def backward(self, half: Array, touched: Array) -> Array:
        """The solution (n, k) from what `forward` gave and the solution (t, k) on the touched unknowns."""
        half[self._touched] = touched
        if self._all:
            return half
        if self._none:
            return self.solve(half)
        return self._half(BACKWARD, half)

    def _half(self, phase: int, right: Array) -> Array:
        b = np.asfortranarray(right, dtype=self._type)
        x = np.zeros_like(b, order="F")
        self._call(phase, b, x)
        return x

    def store(self, folder: Path) -> None:
        """Move the factor from memory to a folder of its own, until `restore`."""
        if self._all:
            return
        if self._stored is None:
            folder.mkdir(parents=True)
            self._moved("store", folder)
            self._stored = folder
        self._call(FORGET)

    def restore(self) -> None:
        """Fetch the factor back; its copy on the disk stays, so that it need not be written again."""
        if self._all:
            return
        self._state[:] = 0
        assert self._stored is not None
        self._moved("restore", self._stored)

    def _moved(self, way: str, folder: Path) -> None:
        fault = ctypes.c_int32(0)
        handle(way)(self._state.ctypes.data_as(ctypes.c_void_p), str(folder).encode(), ctypes.byref(fault))
        if fault.value:
            raise NotConverged(
                f"PARDISO could not {way} the factor of a part in {folder} (its error {fault.value}); "
                "is the disk full? TMPDIR names another place"
            )


NAME = "PARDISO, part by part"
ALIKE = 1e-9  # relative difference of two parts' forces under the same motion that still counts as none
CHANGED = 1e-11  # relative change of the forces inside the parts beyond which they are factorised anew
ROOM = 0.3  # of the free memory that the factors of all parts may take before they go to the disk
ROUNDING = 1e-8  # of the greatest: rigid motions that touched unknowns cannot tell apart
COLUMNS_TOGETHER = 8  # right-hand sides solved together: each takes some times its room
SEED = 20261123


class PartByPart:
    """Factorises matrices that differ in their touched unknowns alone; the factors of the parts are made once.

    Args:
        parts: unknowns of each part, every unknown in one of them.
        touched: unknowns that joints, bolts and supports may couple or hold; those with entries between parts are
            added.
        motions: the six rigid motions (n, 6) of the whole: what a part answers to its own is known exactly, and the
            little that single precision would leave of it is put in its place.
        alike: whether parts whose matrices agree share one factor.
        stored: whether only the factor of the part at work is in memory and the others are on the disk, in the place
            that TMPDIR names; None: where all together would take more than three tenths of the free memory.
    """

    name = NAME
    key = BY_PARTS

    def __init__(
        self,
        parts: Sequence[Index],
        touched: Index,
        motions: Array,
        *,
        alike: bool = True,
        stored: bool | None = None,
    ) -> None:
        self.parts, self.alike, self.stored = tuple(parts), alike, stored
        self._motions = motions
        self._size = sum(len(part) for part in parts)
        self._touched = np.zeros(self._size, dtype=bool)
        self._touched[touched] = True
        self._made: tuple[_Parts, ...] = ()

    def factorise(self, matrix: Any, *, single: bool) -> "ByParts":
        """Factorise a symmetric positive definite matrix (n, n), CSR or `Shifted`, in single or in double precision.

        Raises:
            NotConverged: the matrix is singular.
            InputError: memory is short.
        """
        for made in self._made:
            if made.single == single and made.fits(matrix):
                return ByParts(made, matrix)
        self._made = ()  # before others are made, these are gone
        self._touched |= _between(self.parts, matrix)
        kinds = _kinds(self.parts, self._touched, matrix, alike=self.alike)
        self._made = (_Parts(self.parts, self._motions, kinds, matrix, single=single, stored=self.stored),)
        return ByParts(self._made[0], matrix)


class _Parts:
    """The factors of the parts at one shift, each kind of part once."""

    def __init__(
        self,
        parts: Sequence[Index],
        motions: Array,
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
        self.on_disk = len(first) > 1 and (stored if stored is not None else free is not None and need > ROOM * free)
        self.folder = None
        if self.on_disk:
            self.folder = Path(tempfile.mkdtemp(prefix="faying-"))
            weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)
        self._factors: dict[int, CondensedPart] = {}
        self._at_hand: int | None = None
        self._corrections: dict[int, tuple[Array, Array]] = {}
        for kind, number in first.items():
            part, inside = parts[number], self.local[number]
            self._factors[kind] = CondensedPart(partial(block, matrix, part, part), len(part), inside, single=single)
            self._corrections[kind] = self._correction(kind, matrix, part, motions[part], inside)
            if self.on_disk:
                self._store(kind)
        # of the matrix that was condensed, on the touched unknowns
        self.edges = [block(matrix, part[i], part[i]) for part, i in zip(parts, self.local, strict=True)]
        self.first = first
        self._probe = np.random.default_rng(SEED).standard_normal(matrix.shape[0])
        self._probe[self.touched] = 0.0
        self._answer = matrix @ self._probe
        sizes = [factor.memory for factor in self._factors.values()]
        self.memory = max(sizes) if self.on_disk else sum(sizes)

    def fits(self, matrix: Any) -> bool:
        """Whether a matrix differs from that of these parts in touched unknowns alone."""
        if matrix.shape[0] != len(self._probe):
            return False
        change = np.linalg.norm(matrix @ self._probe - self._answer)
        return bool(change < CHANGED * np.linalg.norm(self._answer))

    def complement(self, number: int, change: Any, rows: Index, columns: Index) -> Array:
        """What a part leaves on some of its touched unknowns: rows and columns (r, c) of its complement.

        change: sparse (t, t), what the matrix has there beyond that of the first part of this kind.
        """
        kind = self.kind_of[number]
        unit, corrected = self._corrections[kind]
        found = self._factors[kind].schur[np.ix_(rows, columns)].astype(float)
        found += corrected[rows] @ unit[columns].T
        found += unit[rows] @ corrected[columns].T
        more = block(change, rows, columns).tocoo()
        found[more.row, more.col] += more.data
        return found

    def _correction(self, kind: int, matrix: Any, part: Index, motions: Array, inside: Index) -> tuple[Array, Array]:
        """Unit vectors Q (t, r) and X (t, r): the complement S + X Q' + Q X' answers rigid motions exactly.

        From A r = f follows S r_t = f_t - A_ti A_ii^-1 f_i, whose right-hand side is small and known to all digits.
        """
        if not len(inside):
            return np.zeros((0, 0)), np.zeros((0, 0))
        unit, sizes, turn = np.linalg.svd(motions[inside], full_matrices=False)
        keep = sizes > ROUNDING * sizes.max(initial=0.0)
        unit = unit[:, keep]
        moved = np.zeros((matrix.shape[0], int(keep.sum())))
        moved[part] = motions @ (turn[keep].T / sizes[keep])
        forces = (matrix @ moved)[part]
        factor = self._factors[kind]
        at_ends = forces[inside]  # great, where springs of a joint pull there: not to be rounded
        forces[inside] = 0.0
        miss = at_ends + factor.forward(forces)[inside] - factor.schur @ unit
        half = unit.T @ miss
        return unit, miss - unit @ (half + half.T) / 4

    def factor(self, kind: int) -> CondensedPart:
        """The factor of a kind of part, in memory."""
        factor = self._factors[kind]
        if self.on_disk and self._at_hand != kind:
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
        self._factor = self._core(matrix)
        self.memory = parts.memory + self._factor.memory

    def solve(self, right: Array) -> Array:
        """Solve for one right-hand side (n,) or several (n, m)."""
        if right.ndim == 1:
            return self._solve(right[:, None])[:, 0]
        # a factor that comes from the disk comes once for all of them
        step = max(right.shape[1], 1) if self._parts.on_disk else COLUMNS_TOGETHER
        found = np.empty(right.shape, order="F")
        for k in range(0, right.shape[1], step):
            found[:, k : k + step] = self._solve(right[:, k : k + step])
        return found

    def _solve(self, columns: Array) -> Array:
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
        solved = self._factor.solve([left[places] for places in self._places])
        moved = np.empty(left.shape)
        for places, here in zip(self._places, solved, strict=True):
            moved[places] = here
        found = np.empty(columns.shape)
        for kind in reversed(order):  # the factor that was used last is still in memory
            same = [number for number, one in enumerate(parts.kind_of) if one == kind]
            half = np.concatenate([halves[number] for number in same], axis=1)
            ends = np.concatenate([moved[self._starts[k] : self._starts[k + 1]] for k in same], axis=1)
            whole = parts.factor(kind).backward(half, ends)
            for place, number in enumerate(same):
                found[parts.parts[number]] = whole[:, place * width : (place + 1) * width]
        return found

    def _core(self, matrix: Any) -> BlockCholesky:
        """The factor of the matrix on the touched unknowns once all others are eliminated.

        Its blocks are the touched unknowns of each part, those first that no part couples: alike parts are condensed
        with the touched unknowns of all of them.
        """
        parts = self._parts
        change = block(matrix, parts.touched, parts.touched)
        diagonal: list[Array] = []
        self._places: list[Index] = []
        edges: dict[tuple[int, int], Any] = {}
        between = []
        resting: set[int] = set()
        for number, (at, end) in enumerate(pairwise(self._starts)):
            kind = parts.kind_of[number]
            own = change[at:end]
            outside = own.copy()
            outside.data = np.where((own.indices < at) | (own.indices >= end), own.data, 0.0)
            outside.eliminate_zeros()
            coupled = np.diff(outside.indptr) > 0
            here = (own[:, at:end] - parts.edges[parts.first[kind]]).tocsr()
            spare, met = np.flatnonzero(~coupled), np.flatnonzero(coupled)
            for rows in (spare, met):
                if len(rows):
                    diagonal.append(parts.complement(number, here, rows, rows))
                    self._places.append(at + rows)
            if len(met):
                between.append((len(diagonal) - 1, at + met))
            if len(spare) and len(met):
                resting.add(len(diagonal) - 2)
                edges[len(diagonal) - 2, len(diagonal) - 1] = parts.complement(number, here, spare, met)
        for k, (one, rows) in enumerate(between):
            for other, columns in between[k + 1 :]:
                edge = change[rows][:, columns]
                if edge.nnz:
                    edges[one, other] = edge
        # what lies on faces that no part couples rests on the part, as its inside does
        return BlockCholesky(diagonal, edges, resting if parts.single else ())


def _between(parts: Sequence[Index], matrix: Any) -> Any:
    """Which unknowns (n,) have entries in another part: each part is moved at random, and what else answers is met."""
    moves = np.random.default_rng(SEED).standard_normal(matrix.shape[0])
    met = np.zeros(matrix.shape[0], dtype=bool)
    for part in parts:
        alone = np.zeros(matrix.shape[0])
        alone[part] = moves[part]
        answer = matrix @ alone != 0
        answer[part] = False
        met |= answer
    return met


def _kinds(parts: Sequence[Index], touched: Any, matrix: Any, *, alike: bool) -> list[tuple[int, Index]]:
    """For each part the number of its kind and its touched unknowns, as numbers in the part.

    Parts are of one kind where the same motion of what lies inside asks for the same forces, touched unknowns of any
    part of their size held.
    """
    sizes = sorted({len(part) for part in parts})
    fixed = {size: np.any([touched[part] for part in parts if len(part) == size], axis=0) for size in sizes}
    moves = np.zeros(matrix.shape[0])
    for part in parts:
        same = np.random.default_rng(SEED).standard_normal(len(part))
        moves[part] = np.where(fixed[len(part)], 0.0, same)
    forces = matrix @ moves
    firsts: list[int] = []
    kinds: list[int] = []
    for number, part in enumerate(parts):
        kind = len(firsts)
        for earlier, first in enumerate(firsts):
            if alike and len(parts[first]) == len(part):
                wanted = forces[parts[first]]
                if np.linalg.norm(forces[part] - wanted) <= ALIKE * np.linalg.norm(wanted):
                    kind = earlier
                    break
        if kind == len(firsts):
            firsts.append(number)
        kinds.append(kind)
    members = [[part for part, one in zip(parts, kinds, strict=True) if one == kind] for kind in range(len(firsts))]
    inside = [np.flatnonzero(np.any([touched[part] for part in some], axis=0)) for some in members]
    return [(kind, inside[kind]) for kind in kinds]
