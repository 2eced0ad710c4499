"""VTK files (.vtk, .vtu) and MED files (.med), read by meshio.

Parts and faces come from a whole-number cell array, under the names that MED gives its groups. A cell array of zeros
and ones beside it is a set of its own, under the array's name. Which middle node belongs to which edge, and which way
round a cell runs, is seen from where the nodes lie: MED turns its cells the other way, VTK's wedges come both ways.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from faying.decks.raw import RawMesh, joined
from faying.errors import InputError, ReadError
from faying.fe.elements import KINDS
from faying.file_kinds import MED, VTU, taken
from faying.typing import Array, Index, Mask

_KINDS = {
    "tetra": "tet4",
    "tetra10": "tet10",
    "hexahedron": "hex8",
    "hexahedron20": "hex20",
    "wedge": "wedge6",
    "wedge15": "wedge15",
}
_FACES = {"triangle": 3, "triangle6": 6, "quad": 4, "quad8": 8, "triangle7": 6, "quad9": 8}  # nodes on their edges
_PASSED = {"vertex", "line", "line3", "polyline"}
_ARRAYS = ("part", "body", "region", "domain", "material", "gmsh:physical", "CellEntityIds", "PartId", "MaterialId")


def read(path: Path) -> RawMesh:
    """Read a VTK or MED file. Raises InputError where meshio is not installed, ReadError for what it cannot read."""
    given = taken(path, "mesh")
    kind = "MED" if given is MED else "VTK"
    try:
        import meshio
    except ImportError:
        raise InputError(
            f"{path.name}: {kind} files are read by meshio; add --extra vtk to uv run, or pip install meshio"
        ) from None
    # meshio 5.3.5 knows the names of these kinds, but not their dimension, and not these names of MED
    meshio._mesh.topological_dimension.update(wedge15=3, pyramid13=3, triangle7=2)
    meshio.med._med.med_to_meshio_type.update(QU9="quad9", TR7="triangle7", H27="hexahedron27", P18="wedge18")
    try:
        found = meshio.read(path, file_format="vtu" if given is VTU else kind.lower())
    except (Exception, SystemExit) as fault:  # meshio raises many kinds
        raise ReadError(f"{path} cannot be read as {kind} ({type(fault).__name__}: {fault}); save it again") from None
    points = np.asarray(found.points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ReadError(f"{path} has points in {points.shape[-1]} dimensions; three are needed")
    sets = _Sets(found.cell_data, getattr(found, "cell_tags", {}))
    elements: dict[str, tuple[Index, Index]] = {}
    bodies: dict[str, list[Index]] = {}
    faces: dict[str, list[Index]] = {}
    extra: list[Index] = []
    first = 1
    for number, block in enumerate(found.cells):
        cells = np.asarray(block.data, dtype=np.int64) + 1
        if block.type in _KINDS:
            kind = _KINDS[block.type]
            count = first + np.arange(len(cells))
            first += len(cells)
            have = elements.get(kind, (count[:0], cells[:0]))
            elements[kind] = (np.concatenate([have[0], count]), np.concatenate([have[1], cells]))
            for name, some in sets.of(number, "part", len(cells)):
                bodies.setdefault(name, []).append(count[some])
        elif block.type in _FACES or block.type in _PASSED:
            extra.append(cells.ravel())
            for name, some in sets.of(number, "face", len(cells)) if block.type in _FACES else ():
                faces.setdefault(name, []).append(cells[some, : _FACES[block.type]])
        else:
            raise ReadError(f"{path}: cells of type {block.type} are not known; the known ones are {', '.join(_KINDS)}")
    if not elements:
        raise ReadError(f"{path} has no solid cells")
    return RawMesh(
        numbers=np.arange(1, len(points) + 1),
        points=points,
        elements={kind: (n, _in_order(points, cells, kind)) for kind, (n, cells) in elements.items()},
        bodies={name: np.concatenate(some) for name, some in bodies.items()},
        face_elements={name: tuple(some) for name, some in faces.items()},
        extra=joined(extra),
        lines=joined(np.ravel(block.data) + 1 for block in found.cells if "line" in block.type),
    )


class _Sets:
    """Which cells of a block belong to which part or face."""

    def __init__(self, cell_data: dict[str, list[Any]], tags: dict[int, list[str]]) -> None:
        whole = {
            name: [np.asarray(d).astype(np.int64).ravel() for d in data]
            for name, data in cell_data.items()
            if all(np.issubdtype(np.asarray(d).dtype, np.integer) for d in data)
        }
        self.tags = tags
        self.main = whole.get("cell_tags") if tags else next((whole[name] for name in _ARRAYS if name in whole), None)
        flags = {name: data for name, data in whole.items() if name not in _ARRAYS and _is_flag(data)}
        if self.main is None and len(whole) == 1 and not flags:
            self.main = next(iter(whole.values()))
        self.flags = {} if tags else flags

    def of(self, block: int, what: str, count: int) -> Iterator[tuple[str, Mask]]:
        """Name and cells of each set in a block; faces without any array are one face."""
        for name, data in self.flags.items():
            if data[block].any():
                yield name, data[block] == 1
        if self.main is None:
            if what == "face" and not self.flags:
                yield "face0", np.ones(count, dtype=bool)
            return
        labels = self.main[block]
        for label in np.unique(labels):
            names = self.tags.get(int(label), []) if self.tags else [f"{what}{label}"]
            for name in names:
                yield name, labels == label


def _is_flag(data: list[Index]) -> bool:
    every = np.concatenate(data)
    return bool(np.isin(every, (0, 1)).all() and every.any() and not every.all())


def _in_order(points: Array, cells: Index, kind: str) -> Index:
    """Cells with their corners running as ours do, and each middle node at the edge on which it lies."""
    element = KINDS[kind]
    corners = cells[:, : element.corners]
    where = points[corners - 1]
    mirrored = list(element.mirrored[: element.corners])
    three = (1, 3, 4) if element.shape.name == "hex" else (1, 2, 3)
    volume = np.linalg.det(np.stack([where[:, i] - where[:, 0] for i in three], axis=1))
    if np.median(volume) < 0:
        corners, where = corners[:, mirrored], where[:, mirrored]
    if element.order == 1:
        return corners
    middles = points[cells[:, element.corners :] - 1]
    ends = np.array(element.edges)
    expected = (where[:, ends[:, 0]] + where[:, ends[:, 1]]) / 2
    apart = np.linalg.norm(middles[:, None] - expected[:, :, None], axis=3)  # element, edge, middle node
    order = np.median(apart / apart.mean(axis=(1, 2), keepdims=True), axis=0).argmin(axis=1)
    if len(set(order.tolist())) < len(order):
        raise ReadError(f"the middle nodes of {kind} do not lie on its edges; save the mesh again")
    return np.concatenate([corners, cells[:, element.corners :][:, order]], axis=1)
