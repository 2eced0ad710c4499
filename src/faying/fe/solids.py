"""Nodes, solid elements of any kind, named parts and named faces: what is computed of a mesh."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from faying.errors import InputError
from faying.fe.elements import FACES, SOLIDS
from faying.fe.sides import Blocks as Blocks
from faying.fe.sides import nodes_of
from faying.notes import Note
from faying.style import Summary
from faying.text import listed, notes_row
from faying.typing import Array, Index, Mask
from faying.units import show


@dataclass(frozen=True, kw_only=True, repr=False)
class SolidMesh(Summary):
    """The fields of `faying.fe.mesh.Mesh`, which says what they are; it draws and bonds them."""

    points: Array
    parts: Mapping[str, Blocks]
    faces: Mapping[str, Blocks]
    face_part: Mapping[str, str]
    source: str = field(default="")
    node_numbers: Index | None = None
    turned: Mask | None = None
    bonded: tuple[tuple[str, str], ...] = ()
    ties: tuple[tuple[str, str], ...] = ()
    notes: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        if not self.parts:
            raise InputError("the mesh has no parts; a structure needs at least one solid")
        for name, kinds in (("parts", SOLIDS), ("faces", FACES)):
            wrapped = {
                label: _blocks(blocks, f"{name[:-1]} {label!r}", kinds) for label, blocks in getattr(self, name).items()
            }
            object.__setattr__(self, name, wrapped)
        if not np.all(np.isfinite(self.points)):
            raise InputError(f"the mesh has {np.count_nonzero(~np.isfinite(self.points))} coordinates that are NaN")
        if self.node_numbers is not None and len(np.unique(self.node_numbers)) != len(self.points):
            raise InputError(
                f"{len(self.points)} nodes have {len(np.unique(self.node_numbers))} different numbers; each "
                "node needs one of its own"
            )
        used = np.zeros(len(self.points), dtype=int)
        body_of = {part: number for number, body in enumerate(self.bodies, 1) for part in body}
        for name, blocks in self.parts.items():
            here = nodes_of(blocks)
            if np.any((used[here] > 0) & (used[here] != body_of[name])):
                raise InputError(f"part {name!r} shares nodes with another part; parts meet only through joints")
            used[here] = body_of[name]
            wrong = sum(int(np.count_nonzero(least_jacobian(self.points, cells) <= 0)) for cells in blocks)
            if wrong:
                raise InputError(
                    f"part {name!r}: {wrong} elements have no or negative volume; repair the mesh or its node order"
                )
        if not np.all(used):
            raise InputError(f"{np.count_nonzero(used == 0)} nodes belong to no element")

    @property
    def unknowns(self) -> int:
        """Number of displacement unknowns [-]: three per node."""
        return 3 * len(self.points)

    @cached_property
    def bodies(self) -> tuple[tuple[str, ...], ...]:
        """The parts that are one body, in their order: those that are bonded together, and each other one alone."""
        return bodies_of(tuple(self.parts), self.bonded)

    def is_shared(self, face: str, *, wholly: bool = True) -> bool:
        """Whether all sides of a named face, or some, have the nodes of another part; False where it is not there."""
        if not self.bonded or face not in self.faces:
            return False
        others = [self.part_nodes(part) for part in self.parts if part != self.face_part[face]]
        shared = [np.isin(sides, np.concatenate(others)).all(axis=1) for sides in self.face(face)]
        return bool((np.all if wholly else np.any)(np.concatenate(shared)))

    def body_nodes(self, body: Sequence[str]) -> Index:
        """Nodes of the parts of a body, each once."""
        return np.unique(np.concatenate([self.part_nodes(part) for part in body]))

    @cached_property
    def size(self) -> float:
        """Diagonal of the box around all nodes [m]."""
        return float(np.linalg.norm(np.ptp(self.points, axis=0)))

    @cached_property
    def numbers(self) -> Index:
        """Number of each node (n,): node_numbers, or 1, 2, ..."""
        return np.arange(1, len(self.points) + 1) if self.node_numbers is None else self.node_numbers

    @cached_property
    def blocks(self) -> Blocks:
        """The blocks of all parts, part by part."""
        return tuple(block for blocks in self.parts.values() for block in blocks)

    @cached_property
    def volumes(self) -> dict[str, float]:
        """Volume of each part [m3]."""
        return {
            name: sum(float(volumes_of(self.points, cells).sum()) for cells in blocks)
            for name, blocks in self.parts.items()
        }

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and what the mesh consists of."""
        volume = sum(self.volumes.values())
        head = f"Mesh{f' of {self.source}' if self.source else ''}: {show(self.size, 'm')} from corner to corner"
        kinds: dict[str, int] = {}
        for block in self.blocks:
            kinds[kind_of(block)] = kinds.get(kind_of(block), 0) + len(block)
        rows = {
            "parts": f"{len(self.parts)}: {listed(self.parts)}",
            "faces": f"{len(self.faces)}: {listed(sorted(self.faces), 8)}",
            "elements": ", ".join(f"{count:,} {kind}" for kind, count in kinds.items()),
            "nodes": f"{len(self.points):,}",
            "unknowns": f"{self.unknowns:,}",
            "volume": f"{volume * 1e9:.6g} mm^3",
            "mass": f"{volume * 1e3:.4g} kg for each 1000 kg/m^3 of density",
        }
        return head, rows | notes_row(self.notes)

    def face(self, name: str) -> Blocks:
        """Blocks of a named face, each (f, a). Raises InputError that lists the faces there are."""
        if name not in self.faces:
            raise InputError(f"no face is called {name!r}; the faces are {', '.join(map(repr, sorted(self.faces)))}")
        return self.faces[name]

    def face_nodes(self, name: str) -> Index:
        """Nodes of a named face, each once. Raises InputError as `face` does."""
        return nodes_of(self.face(name))

    def part_nodes(self, name: str) -> Index:
        """Nodes of a part, each once. Raises InputError that lists the parts there are."""
        if name not in self.parts:
            raise InputError(f"no part is called {name!r}; the parts are {', '.join(map(repr, self.parts))}")
        return nodes_of(self.parts[name])


def bodies_of(parts: Sequence[str], bonded: Sequence[tuple[str, str]]) -> tuple[tuple[str, ...], ...]:
    """Groups of parts that pairs bond together, in the order of the parts."""
    groups = {part: [part] for part in parts}
    for first, second in bonded:
        if groups[first] is not groups[second]:
            merged = groups[first] + groups[second]
            groups |= dict.fromkeys(merged, merged)
    found = {id(group): tuple(part for part in parts if part in group) for group in groups.values()}
    return tuple(found.values())


def _blocks(given: Index | Blocks, what: str, kinds: Mapping[int, object]) -> Blocks:
    blocks = (given,) if isinstance(given, np.ndarray) else tuple(given)
    for block in blocks:
        if block.ndim != 2 or (len(block) and block.shape[1] not in kinds):
            raise InputError(
                f"{what} has an array of shape {block.shape}; rows of {', '.join(map(str, sorted(kinds)))} "
                "nodes are known"
            )
    if not sum(len(block) for block in blocks):
        raise InputError(f"{what} has no elements")
    return tuple(np.asarray(block, dtype=np.int64) for block in blocks if len(block))


def least_jacobian(points: Array, cells: Index, *, of_mass: bool = False) -> Array:
    """Least determinant of the map from the reference element [m3 per unit] at the points of integration (e,).

    of_mass: at the points of the mass as well as at those of the stiffness.
    """
    element = SOLIDS[cells.shape[1]]
    gradients = element.stiffness_rule[3]
    if of_mass:
        gradients = np.concatenate([gradients, element.mass_rule[3]])
    out = np.empty(len(cells))
    for here, jacobian in _jacobians(points, cells, gradients):
        x, y, z = (jacobian[..., i, :] for i in range(3))
        out[here] = np.einsum("eqi,eqi->eq", np.cross(x, y), z).min(axis=1)
    return out


def volumes_of(points: Array, cells: Index) -> Array:
    """Volumes [m3] of elements of one kind (e,)."""
    _, weights, _, gradients = SOLIDS[cells.shape[1]].mass_rule
    out = np.empty(len(cells))
    for here, jacobian in _jacobians(points, cells, gradients):
        out[here] = np.linalg.det(jacobian) @ weights
    return out


def _jacobians(points: Array, cells: Index, gradients: Array) -> Iterator[tuple[slice, Array]]:
    """Jacobians (e, q, 3, 3) at the points of a rule, of as many elements at a time as take little room."""
    for begin in range(0, len(cells), 20000):
        here = slice(begin, begin + 20000)
        yield here, np.einsum("eai,qaj->eqij", points[cells[here]], gradients, optimize=True)


def kind_of(cells: Index) -> str:
    """Name of the kind of a block of solid elements."""
    return SOLIDS[cells.shape[1]].name


def split_at_joints(
    points: Array,
    cells: Index,
    part_of_cell: Index,
    triangles: Mapping[str, Index],
    triangle_part: Mapping[str, int],
) -> tuple[Array, Index, dict[str, Index]]:
    """Give each part nodes of its own where parts share them; returns new points, cells and triangles."""
    n = len(points)
    key, own = np.unique(part_of_cell[:, None] * n + cells, return_inverse=True)  # one node per (part, old node)
    faces = {name: np.searchsorted(key, triangle_part[name] * n + tri) for name, tri in triangles.items()}
    return points[key % n], own.reshape(cells.shape), faces
