"""Meshes of other programs: from what a file holds to parts and faces, with the faults that such files have."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from faying import units
from faying.checks import number
from faying.decks.conforming import among, bodies, check_apart, keys_of
from faying.decks.programs import reader_of
from faying.decks.raw import Pretension, RawMesh, joined, understood
from faying.errors import InputError, ReadError
from faying.fe.elements import FACES, SOLIDS
from faying.fe.mesh import Mesh
from faying.fe.sides import Blocks, nodes_of, side_key, skin
from faying.fe.solids import least_jacobian
from faying.file_kinds import STEP, taken
from faying.misuse import checked_call
from faying.notes import Note, Severity
from faying.text import few
from faying.typing import Array, Index

SMALLEST, LARGEST = 1e-3, 100.0  # sizes of a bolted structure [m] beyond which the unit is doubted
FEW_NODES, MAX_LOST = 10, 0.1  # nodes of no element, and their share, beyond which a file may be cut short
CLOSE = 1e-7  # of the part's size: nodes nearer than this coincide


@checked_call
def read_mesh(
    path: str | Path,
    *,
    size: float | str | None = None,
    face_size: Mapping[str, float | str] | None = None,
    unit: str | None = None,
    parts: Mapping[str, str] | Sequence[str] | None = None,
    cache: str | Path | None = None,
) -> Mesh:
    """Mesh a STEP file, or read a mesh file.

    A STEP file is meshed as a study meshes it, with second-order tetrahedra; `size` is needed then. Its parts and faces
    have the names that the CAD program gave them. Mesh files are those of Abaqus or CalculiX, Nastran, Gmsh and MAPDL,
    universal files, VTK and MED; `unit` is needed then. What the file holds tells its kind, whatever its name ends in.

    Faces are the file's node sets, surfaces and face elements, turned outwards; a set that lies on several parts gives
    PART.SET for each. Parts that share nodes on named faces get nodes of their own there; parts that share nodes where
    no face is named are one body, which a note says.

    Args:
        path: The file.
        size: Largest edge of an element of a STEP file [m], or text with a unit such as "10 mm".
        face_size: Name of a face of a STEP file -> largest edge there.
        unit: Length unit of the coordinates, such as "mm"; no format says it.
        parts: Names of the element sets that are the parts, or part -> element set, or several as "one + other".
            Where None: the bodies that the
            file names, else its element sets if they divide the elements, else the pieces that share no node.
        cache: Folder that keeps the mesh of a STEP file for the next call; None keeps nothing.

    Returns:
        The mesh in metres, with the file's node numbers.

    Raises:
        ReadError: The file is missing, damaged, cut short or of an unknown kind.
        InputError: The unit is missing or wrong, or parts, faces or elements cannot be used.
    """
    file = Path(path)
    if not file.is_file():
        raise ReadError(f"no file {file}")
    if taken(file, "geometry", "mesh") is STEP:
        wrong = [name for name, value in (("unit", unit), ("parts", parts)) if value is not None]
        return _meshed(file, size, face_size, cache, wrong)
    wrong = [name for name, value in (("size", size), ("face_size", face_size)) if value is not None]
    if wrong:
        raise InputError(f"{file.name} is a mesh already, and {wrong[0]} is for STEP files; leave it out")
    if unit is None:
        raise InputError(f'{file.name} does not state the unit of its coordinates; give it, for example unit = "mm"')
    scale = units.scale(unit, "m", name="unit of the mesh")
    raw = _read(file)
    return _Builder(raw, file.name, unit, scale).mesh(parts)


def _meshed(
    file: Path,
    size: float | str | None,
    face_size: Mapping[str, float | str] | None,
    cache: str | Path | None,
    wrong: Sequence[str],
) -> Mesh:
    """The mesh of a STEP file."""
    from faying.geometry.geometry import mesh_step

    if wrong:
        raise InputError(f"{file.name} is a STEP file, which states its unit and its parts; leave {wrong[0]} out")
    if size is None:
        raise InputError(
            f'{file.name} is a STEP file and is meshed here; give the largest edge, such as size = "10 mm"'
        )
    local = face_size or {}
    return mesh_step(
        file,
        size=number(size, "size", "m", least=0),
        local_size={name: number(one, f"face_size of {name!r}", "m", least=0) for name, one in local.items()},
        cache=None if cache is None else Path(cache),
    )


def _read(file: Path) -> RawMesh:
    """What a format's reader finds; a word where it expects a number is the file's fault, not a crash."""
    module = reader_of(file, "mesh")
    with understood(f"{file} has something that Faying does not understand"):
        raw: RawMesh = module.read(file)
    if not len(raw.numbers):
        raise ReadError(f"{file} has no nodes; is the file complete?")
    if not any(len(numbers) for numbers, _ in raw.elements.values()):
        raise ReadError(f"{file} has no solid elements; is the file complete?")
    return raw


def read_pretensions(path: str | Path, mesh: Mesh) -> list[tuple[Pretension, tuple[str, ...]]]:
    """The sections at which a mesh file tightens bolts, each with the parts of a mesh of it that hold its nodes.

    Args:
        path: the mesh file.
        mesh: as `read_mesh` gives it.
    """
    file = Path(path)
    raw = _read(file)
    numbers = {part: mesh.numbers[mesh.part_nodes(part)] for part in mesh.parts}
    return [
        (
            bolt,
            tuple(
                part
                for part, mine in numbers.items()
                if any(len(some) and np.isin(some, mine).all() for some in (bolt.nodes, bolt.twins))
            ),
        )
        for bolt in raw.pretensions
    ]


def last_element(path: str | Path) -> int:
    """Greatest number of a solid element in a mesh file, for whoever adds elements to it."""
    file = Path(path)
    raw = _read(file)
    return max((int(numbers.max()) for numbers, _ in raw.elements.values() if len(numbers)), default=0)


@dataclass(frozen=True)
class _Builder:
    raw: RawMesh
    name: str
    unit: str
    scale: float
    notes: list[Note] = field(default_factory=list)

    def mesh(self, wanted: Mapping[str, str] | Sequence[str] | None) -> Mesh:
        """Put it all together."""
        points = self.raw.points * self.scale
        size = float(np.linalg.norm(np.ptp(points, axis=0)))
        if not SMALLEST <= size <= LARGEST:
            raise InputError(
                f"{self.name}: in {self.unit} the structure is {size:.3g} m long; is that its unit? Sizes from "
                f"{SMALLEST * 1e3:g} mm to {LARGEST:g} m are taken"
            )
        cells = self._cells()
        numbers = np.concatenate([n for n, _ in self.raw.elements.values()])
        self._check(points, cells)
        names, owner = self._parts(numbers, cells, wanted)
        cells = self._welded(points, cells, owner) if wanted is not None else cells
        blocks: dict[str, Blocks] = {}
        for i, part in enumerate(names):
            mine = [block[of == i] for block, of in zip(cells, _by_block(owner, cells), strict=True)]
            blocks[part] = tuple(block for block in mine if len(block))
        faces, face_part = self._faces(numbers, cells, blocks)
        return self._split(points, blocks, faces, face_part)

    def _note(self, code: str, text: str, severity: Severity = "remark") -> None:
        self.notes.append(Note(code=code, severity=severity, text=text))

    def _index(self, numbers: Index, what: str) -> Index:
        """Places of nodes by number."""
        order = np.argsort(self.raw.numbers)
        ranked = self.raw.numbers[order]
        place = np.minimum(np.searchsorted(ranked, numbers), len(ranked) - 1)
        lost = ranked[place] != numbers
        if np.any(lost):
            raise ReadError(
                f"{self.name}: {what} names node {np.asarray(numbers)[lost][0]}, which is not in the file; "
                "is the file complete?"
            )
        return order[place]

    def _cells(self) -> list[Index]:
        elements = np.concatenate([numbers for numbers, _ in self.raw.elements.values()])
        for what, numbers in (("node", self.raw.numbers), ("element", elements)):
            once, count = np.unique(numbers, return_counts=True)
            if np.any(count > 1):
                raise ReadError(f"{self.name}: {what} {once[count > 1][0]} is given twice")
        out = []
        for kind, (numbers, nodes) in self.raw.elements.items():
            flat = self._index(nodes.ravel(), f"an element ({kind}, {numbers[0]} to {numbers[-1]})")
            out.append(flat.reshape(nodes.shape))
        return out

    def _check(self, points: Array, cells: list[Index]) -> None:
        marks = np.random.default_rng(0).integers(0, 2**62, len(points))  # of nodes; their sum tells elements apart
        for (numbers, _), block in zip(self.raw.elements.values(), cells, strict=True):
            again = np.delete(numbers, np.unique(marks[block].sum(axis=1), return_index=True)[1])
            if len(again):
                raise InputError(
                    f"{self.name}: {len(again)} elements have the nodes of another one and would count twice: "
                    f"{few(again)}; delete them"
                )
            wrong = numbers[least_jacobian(points, block) <= 0]
            if len(wrong):
                raise InputError(
                    f"{self.name}: {len(wrong)} elements have no or negative volume: {few(wrong)}; repair the "
                    "mesh or its node order"
                )
        used = np.zeros(len(points), dtype=bool)
        for block in cells:
            used[block] = True
        loose = self.raw.numbers[~used & ~np.isin(self.raw.numbers, self.raw.extra)]
        points_of_reference = joined([self.raw.references, *(s for s in self.raw.node_sets.values() if len(s) == 1)])
        lost = loose[~np.isin(loose, points_of_reference)]
        if len(lost) > max(FEW_NODES, MAX_LOST * len(points)) and not self.raw.counted:
            raise InputError(
                f"{self.name}: {len(lost)} of {len(points)} nodes belong to no element: {few(lost)}; delete them, or "
                "is the file cut short?"
            )
        if len(loose) > len(lost):
            text = f"{len(loose) - len(lost)} reference points are left out, with the couplings that name them: "
            text += few(loose[np.isin(loose, points_of_reference)])
            self._note("reference-points", text, "wrong")
        if len(lost):
            self._note("left-out", f"{len(lost)} nodes belong to no element and are left out: {few(lost)}", "limit")
        apart = np.setdiff1d(self.raw.lines, self.raw.numbers[used])
        if len(apart):
            self._note(
                "left-out", f"lines off all solids (beams) are left out with {len(apart)} nodes: {few(apart)}", "limit"
            )

    def _parts(
        self, numbers: Index, cells: list[Index], wanted: Mapping[str, str] | Sequence[str] | None
    ) -> tuple[list[str], Index]:
        """Names of the parts and the part of every element."""
        sets = {**self.raw.element_sets, **self.raw.bodies}
        if wanted is not None:
            plain, piece = self._parts(numbers, cells, None)
            sets = {part: numbers[piece == k] for k, part in enumerate(plain)} | sets
            wished = dict(wanted) if isinstance(wanted, Mapping) else {name: name for name in wanted}
            chosen = {part: [name] if name in sets else _several(name) for part, name in wished.items()}
            for part, together in chosen.items():
                for name in together:
                    if name not in sets:
                        raise InputError(
                            f"{self.name}: part {part!r} names the element set {name!r}; the file holds "
                            f"{', '.join(map(repr, sets)) or 'none'}"
                        )
            divided = _dividing(numbers, {part: joined(sets[name] for name in some) for part, some in chosen.items()})
            if divided is None:
                raise InputError(
                    f"{self.name}: the element sets {', '.join(wished.values())} do not divide the elements; each "
                    "must belong to one of them"
                )
            return list(chosen), divided
        piece = _pieces(cells, len(self.raw.numbers))
        bodies: Mapping[str, Index] = self.raw.bodies
        owner = _dividing(numbers, bodies)
        if owner is None or len(bodies) == 1:
            subsets = {
                name: some
                for name, some in self.raw.element_sets.items()
                if 0 < np.isin(numbers, some).sum() < len(numbers)
            }
            divided = _dividing(numbers, subsets)
            if divided is not None:
                bodies, owner = subsets, divided
        if owner is None:
            self._say_undivided(numbers, bodies)
            bodies, owner = {}, np.full(len(numbers), -1, dtype=np.int64)
        # a body of several pieces that do not hang together is as many parts
        pairs, place = np.unique(np.column_stack([owner, piece]), axis=0, return_inverse=True)
        given = list(bodies)
        names: list[str] = []
        for body, one in pairs.tolist():
            alike = [int(p) for b, p in pairs if b == body]
            called = self._called(numbers[(owner == body) & (piece == one)])
            if body >= 0 and len(alike) == 1:
                called = given[body]
            elif body >= 0 and called is None:
                called = f"{given[body]}_{alike.index(one) + 1}"
            names.append(called or f"part{len(names) + 1}")
        return names, np.asarray(place, dtype=np.int64).ravel()

    def _say_undivided(self, numbers: Index, bodies: Mapping[str, Index]) -> None:
        """A note where the parts that the file makes leave out some of its solids, and so name none."""
        lacking = ~np.isin(numbers, joined(bodies.values()))
        if bodies and lacking.any():
            text = (
                f"{np.count_nonzero(lacking)} of {len(numbers)} solids, {numbers[lacking][0]} for one, are in none of "
                f"{', '.join(map(repr, bodies))}; the parts are named by what hangs together"
            )
            self._note("undivided", text)

    def _welded(self, points: Array, cells: list[Index], owner: Index) -> list[Index]:
        """The elements with one node for each pair that a section of a bolt cuts in two within one part."""
        of = np.full(len(points), -1, dtype=np.int64)
        for block, mine in zip(cells, _by_block(owner, cells), strict=True):
            of[block] = mine[:, None]
        one = np.arange(len(points))
        close = CLOSE * float(np.linalg.norm(np.ptp(points, axis=0)))
        for bolt in self.raw.pretensions:
            if not len(bolt.twins):
                continue
            a, b = self._index(bolt.nodes, bolt.text), self._index(bolt.twins, bolt.text)
            same = (of[a] == of[b]) & (np.linalg.norm(points[a] - points[b], axis=1) <= close)
            one[b[same]] = a[same]
            if same.any():
                text = f"{bolt.text}: the two halves of the bolt are one part, and {same.sum()} pairs of its nodes one"
                self._note("bolt", text)
        return [one[block] for block in cells]

    def _called(self, numbers: Index) -> str | None:
        """Name of the element set that holds just these elements."""
        for name, some in self.raw.element_sets.items():
            if len(some) == len(numbers) and np.array_equal(np.sort(some), np.sort(numbers)):
                return name
        return None

    def _faces(
        self, numbers: Index, cells: list[Index], blocks: Mapping[str, Blocks]
    ) -> tuple[dict[str, Blocks], dict[str, str]]:
        """Faces by name, and the part of each; PART.SET where a set lies on several parts."""
        n = len(self.raw.numbers)
        skins = {part: skin(some, n) for part, some in blocks.items()}
        found: dict[str, dict[str, Blocks]] = {}
        self._of_nodes(blocks, skins, found)
        for label, rows in self.raw.face_elements.items():
            given = [self._index(block.ravel(), f"the face {label!r}").reshape(block.shape) for block in rows]
            key = keys_of(given, n)
            on = np.isin(key, joined(keys_of(outer, n) for outer in skins.values()))
            if on.any():
                self._by_key(label, key[on], skins, found)
            if not on.all():
                text = f"{np.count_nonzero(~on)} shells {label!r} are not on a solid and are left out, with their "
                self._note("left-out", text + "stiffness and mass", "limit")
        self._of_sides(numbers, cells, skins, found)
        faces: dict[str, Blocks] = {}
        face_part: dict[str, str] = {}
        for label, by_part in found.items():
            for part, block in by_part.items():
                name = label if len(by_part) == 1 else f"{part}.{label}"
                faces[name], face_part[name] = block, part
        return faces, face_part

    def _of_nodes(
        self, blocks: Mapping[str, Blocks], skins: Mapping[str, Blocks], found: dict[str, dict[str, Blocks]]
    ) -> None:
        """The faces whose nodes are in a set; the set of all nodes of the file is none."""
        n = len(self.raw.numbers)
        used = np.unique(np.concatenate([nodes_of(some) for some in blocks.values()]))
        for label, some in self.raw.node_sets.items():
            inside = np.zeros(n, dtype=bool)
            inside[self._index(some, f"the set {label!r}")] = True
            if inside[used].all():
                continue
            covered = [part for part, mine in blocks.items() if inside[nodes_of(mine)].all()]
            for part, outer in skins.items():
                # the set of all nodes of one part names no side of another that shares nodes with it
                theirs = joined(keys_of(skins[other], n) for other in covered if other != part)
                here = _on(among(outer, theirs, n, others=True), inside)
                if here:
                    found.setdefault(label, {})[part] = here

    def _of_sides(
        self, numbers: Index, cells: list[Index], skins: Mapping[str, Blocks], found: dict[str, dict[str, Blocks]]
    ) -> None:
        """The faces that surfaces name, side by side or by the elements whose free sides they are."""
        n, order = len(self.raw.numbers), np.argsort(numbers)
        every, count = np.unique(joined(keys_of(outer, n) for outer in skins.values()), return_counts=True)
        between = every[count > 1]  # sides that two parts share are not free ones
        for label, pairs in self.raw.side_sets.items():
            place = np.minimum(np.searchsorted(numbers[order], pairs[:, 0]), len(numbers) - 1)
            at = order[place]
            if np.any(numbers[at] != pairs[:, 0]):
                raise ReadError(
                    f"{self.name}: the surface {label!r} has element {pairs[numbers[at] != pairs[:, 0], 0][0]}, "
                    "which is not a solid of the file"
                )
            key, whole = self._side_keys(label, at, pairs[:, 1], cells)
            if len(key):
                self._by_key(label, key, skins, found)
            if len(whole):
                for part, outer in skins.items():
                    free = among(outer, np.setdiff1d(whole, between), n)
                    if free:
                        found.setdefault(label, {})[part] = free

    def _side_keys(self, label: str, at: Index, sides: Index, cells: list[Index]) -> tuple[Index, Index]:
        """Keys of the sides named one by one, and of all sides of elements named as a whole."""
        n, start = len(self.raw.numbers), 0
        named: list[Index] = []
        whole: list[Index] = []
        for block in cells:
            mine = (at >= start) & (at < start + len(block))
            for side, places in enumerate(SOLIDS[block.shape[1]].sides):
                for some, kept in ((sides == side, named), (sides < 0, whole)):
                    rows = at[mine & some] - start
                    if len(rows):
                        kept.append(side_key(block[rows][:, places], n))
            count = len(SOLIDS[block.shape[1]].sides)
            if np.any(sides[mine] >= count):
                raise ReadError(
                    f"{self.name}: the surface {label!r} names side S{sides[mine].max() + 1} of an element that has "
                    f"{count}"
                )
            start += len(block)
        return joined(named), joined(whole)

    def _by_key(self, label: str, key: Index, skins: Mapping[str, Blocks], found: dict[str, dict[str, Blocks]]) -> None:
        n = len(self.raw.numbers)
        hit = np.zeros(len(key), dtype=bool)
        for part, outer in skins.items():
            here = among(outer, key, n)
            if here:
                found.setdefault(label, {})[part] = here
                hit |= np.isin(key, keys_of(here, n))
        if hit.all():
            return
        if hit.any():
            found.pop(label)
            text = (
                f"{np.count_nonzero(~hit)} of the {len(key)} element faces of {label!r} are not on the outside of a "
                "solid, and it is left out; where elements of one part share the nodes there, put those"
            )
        else:
            text = (
                f"the surface {label!r} lies inside its part, on {len(key)} element faces that are not on the outside "
                "of a solid, and is left out; where it is a joint, put the elements"
            )
        text += " on each side into an element set of their own, which is then a part with its own face"
        self._note("left-out", text, "limit")

    def _split(
        self, points: Array, blocks: dict[str, Blocks], faces: dict[str, Blocks], face_part: dict[str, str]
    ) -> Mesh:
        """Give each body nodes of its own where bodies share them on named faces."""
        n = len(points)
        found = bodies(blocks, faces, face_part, n)
        check_apart(self.name, blocks, faces, (face_part, found), self.raw.numbers)
        if found.text:
            self._note("one-body", found.text)
        place, key = found.place, found.keys(blocks, n)
        faces = {**faces, **{name: some for name, (_, some) in found.sides.items()}}
        face_part = {**face_part, **{name: part for name, (part, _) in found.sides.items()}}
        old = key % n
        old_numbers = self.raw.numbers[old]
        numbers = old_numbers.copy()
        again = np.ones(len(key), dtype=bool)
        again[np.unique(old, return_index=True)[1]] = False
        numbers[again] = self.raw.numbers.max() + 1 + np.arange(np.count_nonzero(again))
        made = {
            part: tuple(np.searchsorted(key, place[part] * n + block) for block in some)
            for part, some in blocks.items()
        }
        new_points = points[old]
        for part, some in made.items():
            self._unmerged(new_points, nodes_of(some), numbers, part)
        return Mesh(
            points=new_points,
            parts=made,
            faces={
                name: tuple(np.searchsorted(key, place[face_part[name]] * n + f) for f in some)
                for name, some in faces.items()
            },
            face_part=face_part,
            source=self.name,
            node_numbers=numbers,
            turned=np.isin(old_numbers, self.raw.turned),
            bonded=found.pairs,
            notes=(*self.notes, *(Note(code="file", text=text) for text in self.raw.notes)),
        )

    def _unmerged(self, points: Array, nodes: Index, numbers: Index, part: str) -> None:
        from scipy.spatial import cKDTree

        where = points[nodes]
        radius = CLOSE * float(np.linalg.norm(np.ptp(where, axis=0)))
        pairs = cKDTree(where).query_pairs(radius, output_type="ndarray")
        if len(pairs):
            a, b = numbers[nodes[pairs[0]]]
            raise InputError(
                f"{self.name}: {len(pairs)} pairs of nodes of part {part!r} coincide ({a} and {b}, for one), so that "
                "its elements are not connected there; merge the nodes, or make two parts and a joint"
            )


def _several(name: str) -> list[str]:
    """The sets that a name such as "steel + alu" joins; the name where there is no plus sign."""
    some = [one.strip() for one in name.split("+")]
    return some if len(some) > 1 and all(some) else [name]


def _by_block(values: Index, cells: list[Index]) -> list[Index]:
    """Values of all elements as those of each block."""
    return np.split(values, np.cumsum([len(block) for block in cells])[:-1])


def _dividing(numbers: Index, sets: Mapping[str, Index]) -> Index | None:
    """Which set each element is in; None where some is in none or in two."""
    owner, count = np.zeros(len(numbers), dtype=np.int64), np.zeros(len(numbers), dtype=np.int64)
    for i, some in enumerate(sets.values()):
        inside = np.isin(numbers, some)
        owner[inside] = i
        count += inside
    return owner if len(sets) and np.all(count == 1) else None


def _pieces(cells: list[Index], nodes: int) -> Index:
    """Number of the connected piece that each element belongs to."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = sum(len(block) for block in cells)
    rows = np.repeat(np.arange(count), np.concatenate([np.full(len(block), block.shape[1]) for block in cells]))
    columns = np.concatenate([block.ravel() for block in cells]) + count
    graph = coo_array((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(count + nodes, count + nodes))
    label = connected_components(graph, directed=False)[1][:count]
    return np.unique(label, return_inverse=True)[1]


def _on(outer: Blocks, inside: Index) -> Blocks:
    """Element faces all of whose nodes are inside; all of whose corners, where no middle node is."""
    here = tuple(faces[inside[faces].all(axis=1)] for faces in outer)
    if not any(len(faces) for faces in here):
        middles = [faces[:, FACES[faces.shape[1]].corners :] for faces in outer]
        if not any(inside[some].any() for some in middles if some.size):
            here = tuple(faces[inside[faces[:, : FACES[faces.shape[1]].corners]].all(axis=1)] for faces in outer)
    return tuple(faces for faces in here if len(faces))
