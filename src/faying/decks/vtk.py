"""VTK files (.vtk, .vtu), read by meshio: parts and faces from a whole-number cell array."""

from pathlib import Path

import numpy as np

from faying.decks.raw import RawMesh, index
from faying.errors import InputError, ReadError

_KINDS = {
    "tetra": "tet4",
    "tetra10": "tet10",
    "hexahedron": "hex8",
    "hexahedron20": "hex20",
    "wedge": "wedge6",
    "wedge15": "wedge15",
}
_FACES = {"triangle", "triangle6", "quad", "quad8"}
_PASSED = {"vertex", "line", "line3", "polyline"}
_ARRAYS = ("part", "body", "region", "domain", "material", "gmsh:physical", "CellEntityIds", "PartId", "MaterialId")


def read(path: Path) -> RawMesh:
    """Read a VTK file. Raises InputError where meshio is not installed, ReadError for what it cannot read."""
    try:
        import meshio
    except ImportError:
        raise InputError(
            f"{path.name}: VTK files are read by meshio; add --extra vtk to uv run, or pip install meshio"
        ) from None
    # meshio 5.3.5 knows the name of this kind in every format, but not its dimension
    meshio._mesh.topological_dimension.setdefault("wedge15", 3)
    try:
        found = meshio.read(path)
    except (Exception, SystemExit) as fault:  # meshio raises many kinds
        raise ReadError(f"{path} cannot be read as VTK ({type(fault).__name__}: {fault}); save it again") from None
    array = _array(found.cell_data)
    elements: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    bodies: dict[str, list[np.ndarray]] = {}
    faces: dict[str, list[np.ndarray]] = {}
    extra: list[np.ndarray] = []
    first = 1
    for number, block in enumerate(found.cells):
        cells = np.asarray(block.data, dtype=np.int64) + 1
        labels = np.asarray(array[number]).astype(np.int64).ravel() if array is not None else np.zeros(len(cells), int)
        if block.type in _KINDS:
            kind = _KINDS[block.type]
            count = first + np.arange(len(cells))
            first += len(cells)
            have = elements.get(kind, (count[:0], cells[:0]))
            elements[kind] = (np.concatenate([have[0], count]), np.concatenate([have[1], cells]))
            for label in np.unique(labels) if array is not None else ():
                bodies.setdefault(f"part{label}", []).append(count[labels == label])
        elif block.type in _FACES:
            extra.append(cells.ravel())
            for label in np.unique(labels):
                faces.setdefault(f"face{label}", []).append(cells[labels == label])
        elif block.type in _PASSED:
            extra.append(cells.ravel())
        else:
            raise ReadError(f"{path}: cells of type {block.type} are not known; known are {', '.join(_KINDS)}")
    if not elements:
        raise ReadError(f"{path} holds no solid cells")
    points = np.asarray(found.points, dtype=float)
    for kind in ("wedge6", "wedge15"):
        if kind in elements:
            elements[kind] = (elements[kind][0], _upright(points, elements[kind][1]))
    return RawMesh(
        numbers=np.arange(1, len(points) + 1),
        points=points,
        elements=elements,
        bodies={name: np.concatenate(some) for name, some in bodies.items()},
        face_elements={name: tuple(some) for name, some in faces.items()},
        extra=np.concatenate(extra) if extra else index([]),
    )


def _array(cell_data: dict[str, list[np.ndarray]]) -> list[np.ndarray] | None:
    """The cell array that tells parts and faces: one with a usual name, else the only one of whole numbers."""
    whole = {
        name: data
        for name, data in cell_data.items()
        if all(np.issubdtype(np.asarray(d).dtype, np.integer) for d in data)
    }
    for name in _ARRAYS:
        if name in whole:
            return whole[name]
    return next(iter(whole.values())) if len(whole) == 1 else None


def _upright(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """VTK's picture and its coordinates disagree on which way round a wedge runs; files come with both."""
    corner = points[cells[:, :4] - 1]
    volume = np.linalg.det(np.stack([corner[:, i] - corner[:, 0] for i in (1, 2, 3)], axis=1))
    if np.median(volume) > 0:
        return cells
    order = [0, 2, 1, 3, 5, 4] + ([8, 7, 6, 11, 10, 9, 12, 14, 13] if cells.shape[1] == 15 else [])
    return np.asarray(cells[:, order])
