"""From a STEP file with named solids and faces to a mesh, through netgen (LGPL) and its OpenCASCADE kernel.

Names are those that the CAD program gave to solids and faces. A face without a name can be named by a point: the face
nearest to it takes the name.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import InputError, ReadError
from faying.fe.elements import KINDS
from faying.fe.mesh import Mesh, split_at_joints
from faying.typing import Array, Index

# netgen numbers the middle nodes by these edges; VTK, and so we, by those of its element
_NETGEN_EDGES = {"tet10": ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)), "tri6": ((1, 2), (0, 2), (0, 1))}


def _to_vtk(kind: str) -> list[int]:
    edges = [_NETGEN_EDGES[kind].index((min(edge), max(edge))) for edge in KINDS[kind].edges]
    return [*range(KINDS[kind].corners), *(KINDS[kind].corners + i for i in edges)]


def read_step(path: Path) -> Any:
    """Return the OpenCASCADE shape of a STEP file, in the file's millimetres."""
    if not path.is_file():
        raise ReadError(f"no file {path}; geometry.step names a STEP file relative to the study")
    head = path.read_bytes()[:64]
    if b"ISO-10303-21" not in head:
        raise ReadError(f"{path} is not a STEP file (it does not begin with ISO-10303-21); export STEP AP214 or AP242")
    from netgen.occ import OCCGeometry

    try:
        shape = OCCGeometry(str(path)).shape
    except Exception as fault:
        raise ReadError(f"{path} cannot be read as STEP ({fault}); export it again from the CAD program") from None
    if not list(shape.solids):
        raise ReadError(f"{path} holds no solid; export solids, not surfaces")
    return shape


def mesh_step(
    path: Path,
    *,
    size: float,
    local_size: Mapping[str, float] | None = None,
    face_points: Mapping[str, tuple[str, Sequence[float]]] | None = None,
) -> Mesh:
    """Mesh the solids of a STEP file with second-order tetrahedra.

    path: STEP file; size: largest edge [m]; local_size: face name -> largest edge there [m]; face_points: name to
    give -> (part, point [m]) for faces that the file does not name. Faces that two parts share come out matched node
    for node, one copy per part. Raises ReadError for unreadable files and InputError for names that do not exist.
    """
    from netgen.occ import Glue, OCCGeometry, Pnt, Vertex

    shape = read_step(path)
    solids = list(shape.solids)
    for number, solid in enumerate(solids):
        if not solid.name:
            solid.name = f"part{number + 1}"
    names = [solid.name for solid in solids]
    if len(set(names)) != len(names):
        raise InputError(f"{path}: two solids have the same name ({', '.join(names)}); name each of them once")
    for label, (part, point) in (face_points or {}).items():
        if part not in names:
            raise InputError(f"face {label!r}: no part is called {part!r}; the parts are {', '.join(names)}")
        here = Vertex(Pnt(*(1e3 * x for x in point)))
        nearest = min(solids[names.index(part)].faces, key=lambda face: face.Distance(here))
        nearest.name = label

    # gluing merges touching faces and keeps one of their names: remember the geometry of every named face
    marks = [Mark(face.name, names[i], face) for i, solid in enumerate(solids) for face in solid.faces if face.name]
    glued = Glue(solids) if len(solids) > 1 else shape
    parts = list(glued.solids)
    if len(parts) != len(solids):
        raise InputError(
            f"{path.name}: the parts {', '.join(names)} run into each other: gluing makes {len(parts)} solids of them; "
            "parts may touch, not overlap"
        )
    for face in glued.faces:
        face.name = ""
    listed = list(glued.faces)
    labels, cut = _labels(listed, marks)
    for number, face in enumerate(listed):
        face.name = f"{number}"
    if cut:
        sides = {solid.name: {int(face.name) for face in solid.faces} for solid in parts}
        _label_pieces(glued, listed, sides, size, cut, labels)
    found = {label for pairs in labels for label, _ in pairs}
    for label, size_here in (local_size or {}).items():
        if label not in found:
            raise InputError(f"size of face {label!r}: the faces are {', '.join(sorted(found))}")
        for face, pairs in zip(listed, labels, strict=True):
            if any(label == have for have, _ in pairs):
                face.maxh = size_here * 1e3

    mesh = OCCGeometry(glued).GenerateMesh(maxh=size * 1e3, grading=0.4, quad_dominated=False)
    mesh.SecondOrder()
    return _collect(mesh, [solid.name for solid in parts], labels, source=path.name)


def _signature(face: Any) -> Array:
    """Return the centre and the root of the area of a face [mm]: what tells faces apart before and after gluing."""
    centre = face.center
    return np.array([centre.x, centre.y, centre.z, face.mass**0.5])


@dataclass(frozen=True)
class Mark:
    """A named face of the file: name, part, shape."""

    name: str
    part: str
    face: Any


Labels = list[list[tuple[str, str]]]


def _labels(faces: Sequence[Any], marks: Sequence[Mark]) -> tuple[Labels, list[Mark]]:
    """The (name, part) of every original face that lies where a glued one lies, and the originals that none does."""
    places = np.array([_signature(face) for face in faces])
    close = 1e-6 * float(np.ptp(places, axis=0).max())
    labels: Labels = [[] for _ in faces]
    cut = []
    for mark in marks:
        # a face that two solids share is listed once for each of them
        found = np.flatnonzero(np.linalg.norm(places - _signature(mark.face), axis=1) < close)
        for number in found:
            labels[number].append((mark.name, mark.part))
        if not len(found):
            cut.append(mark)
    return labels, cut


def _label_pieces(
    glued: Any, listed: Sequence[Any], sides: Mapping[str, set[int]], size: float, marks: Sequence[Mark], labels: Labels
) -> None:
    """Give (name, part) to the pieces into which gluing has cut faces: where two faces overlap only in part.

    sides: numbers of the glued faces that bound each part. A piece bounds the part and lies on the face, which points on
    it tell, those of a mesh of the surfaces. Raises InputError where the pieces do not make up the face.
    """
    from netgen.meshing import MeshingStep
    from netgen.occ import OCCGeometry, Pnt, Vertex

    mesh = OCCGeometry(glued).GenerateMesh(maxh=size * 1e3, perfstepsend=MeshingStep.MESHSURFACE)
    points = np.asarray(mesh.Coordinates(), float)
    tris = mesh.Elements2D().NumPy()
    close = 1e-6 * float(np.ptp(points, axis=0).max())
    regions = {int(name): number for number, name in enumerate(mesh.GetRegionNames(dim=2), 1)}
    for mark in marks:
        area = 0.0
        for number in sides[mark.part] & regions.keys():
            nodes = tris["nodes"][tris["index"] == regions[number]][:, :3].astype(np.int64) - 1
            here = points[np.unique(nodes)]
            if len(here) and all(mark.face.Distance(Vertex(Pnt(*p))) < close for p in here):
                labels[number].append((mark.name, mark.part))
                area += listed[number].mass
        if not np.isclose(area, mark.face.mass, rtol=1e-4):
            raise InputError(
                f"face {mark.name!r} of part {mark.part!r} ({mark.face.mass:.6g} mm2) comes out as {area:.6g} mm2 where the "
                "parts touch; do they overlap? Else split it in the CAD program where they meet"
            )


def _collect(mesh: Any, parts: list[str], labels: Labels, *, source: str) -> Mesh:
    points = np.asarray(mesh.Coordinates(), float) * 1e-3
    tets = mesh.Elements3D().NumPy()
    cells = tets["nodes"][:, :10].astype(np.int64)[:, _to_vtk("tet10")] - 1
    domain = tets["index"].astype(np.int64) - 1
    corners = points[cells[:, :4]]
    if np.mean(np.linalg.det(corners[:, 1:] - corners[:, :1])) < 0:
        cells = cells[:, [1, 0, 2, 3, 4, 6, 5, 8, 7, 9]]
    middle = points[cells[:, 4:]] - (points[cells[:, [0, 1, 0, 0, 1, 2]]] + points[cells[:, [1, 2, 2, 3, 3, 3]]]) / 2
    if np.median(np.abs(middle)) > 1e-6 * np.ptp(points):
        raise InputError("the mesher numbers the middle nodes of tetrahedra in an unknown order")

    tris = mesh.Elements2D().NumPy()
    face_of = tris["index"].astype(np.int64)
    names = mesh.GetRegionNames(dim=2)
    triangles: dict[str, Index] = {}
    owner: dict[str, int] = {}
    face_part: dict[str, str] = {}
    for number in range(1, len(names) + 1):
        for label, part in labels[int(names[number - 1])]:
            tri = tris["nodes"][face_of == number][:, :6].astype(np.int64)[:, _to_vtk("tri6")] - 1
            if face_part.setdefault(label, part) != part:
                raise InputError(f"face {label!r} is on two parts, {face_part[label]!r} and {part!r}; name them apart")
            owner[label] = parts.index(part)
            triangles[label] = np.concatenate([triangles[label], tri]) if label in triangles else tri
    new_points, new_cells, faces = split_at_joints(points, cells, domain, triangles, owner)
    blocks = {name: new_cells[domain == i] for i, name in enumerate(parts)}
    for label, tri in faces.items():
        faces[label] = _outward(new_points, tri, blocks[face_part[label]])
    return Mesh(
        points=new_points,
        parts={name: (cells,) for name, cells in blocks.items()},
        faces={name: (tri,) for name, tri in faces.items()},
        face_part=face_part,
        source=source,
    )


def _outward(points: Any, tri: Index, cells: Index) -> Index:
    """Turn triangles so that their normals leave the part: the fourth corner of the element lies behind."""
    faces = np.sort(cells[:, [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]].reshape(-1, 3), axis=1)
    opposite = cells[:, [3, 2, 1, 0]].reshape(-1)
    n = len(points)
    key = (faces[:, 0] * n + faces[:, 1]) * n + faces[:, 2]
    order = np.argsort(key)
    want = np.sort(tri[:, :3], axis=1)
    place = np.searchsorted(key[order], (want[:, 0] * n + want[:, 1]) * n + want[:, 2])
    behind = points[opposite[order[place]]] - points[tri[:, 0]]
    normal = np.cross(points[tri[:, 1]] - points[tri[:, 0]], points[tri[:, 2]] - points[tri[:, 0]])
    inward = np.einsum("ij,ij->i", normal, behind) > 0
    turned = tri.copy()
    turned[inward] = tri[inward][:, [1, 0, 2, 3, 5, 4]]
    return turned
