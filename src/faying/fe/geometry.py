"""From a STEP file with named solids and faces to a mesh, through netgen (LGPL) and its OpenCASCADE kernel.

Names are those that the CAD program gave to solids and faces. A face without a name can be named by a point: the face
nearest to it takes the name.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import InputError
from faying.fe.cad import check_head, kernel, products, read_step
from faying.fe.cad_process import Answer, ask
from faying.fe.elements import KINDS
from faying.fe.memory import guessed
from faying.fe.mesh import Mesh, split_at_joints
from faying.memory import available
from faying.notes import Note
from faying.typing import Array, Index

# netgen numbers the middle nodes by these edges; VTK, and so we, by those of its element
NEAR = 1.0  # mm: a point farther from every face than this names none
AMBIGUOUS = 1e-3  # mm: faces whose distances differ by less are not told apart
# tetrahedra per volume over edge^3, and unknowns per tetrahedron of second order: counted on blocks and on bolted
# joints
ELEMENTS, UNKNOWNS = 5.0, 4.5
_NETGEN_EDGES = {"tet10": ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)), "tri6": ((1, 2), (0, 2), (0, 1))}


def _to_vtk(kind: str) -> list[int]:
    edges = [_NETGEN_EDGES[kind].index((min(edge), max(edge))) for edge in KINDS[kind].edges]
    return [*range(KINDS[kind].corners), *(KINDS[kind].corners + i for i in edges)]


@dataclass(frozen=True, kw_only=True)
class _Request:
    """What is asked of the CAD kernel; lengths [m]."""

    path: str
    size: float
    local_size: Mapping[str, float]
    face_points: Mapping[str, tuple[str, Sequence[float]]]


def mesh_step(
    path: Path,
    *,
    size: float,
    local_size: Mapping[str, float] | None = None,
    face_points: Mapping[str, tuple[str, Sequence[float]]] | None = None,
) -> Mesh:
    """Mesh the solids of a STEP file with second-order tetrahedra, in a process of its own.

    path: STEP file; size: largest edge [m]; local_size: face name -> largest edge there [m]; face_points: name to
    give -> (part, point [m] at most 1 mm away) for faces that the file does not name. Faces that two parts share come
    out matched node for node, one copy per part. Raises ReadError for unreadable files, among them those on which the
    CAD kernel dies, and InputError for names that do not exist, points on no face or several, and meshes beyond the
    memory.
    """
    check_head(path)
    request = _Request(path=str(path.resolve()), size=size, local_size=local_size or {}, face_points=face_points or {})
    answer = ask(mesh_answer, asdict(request), path=path)
    parts, faces, data = answer.facts["parts"], answer.facts["faces"], answer.arrays
    return Mesh(
        points=data["points"],
        parts={name: (data[f"part{k}"],) for k, name in enumerate(parts)},
        faces={name: (data[f"face{k}"],) for k, name in enumerate(faces)},
        face_part=faces,
        source=path.name,
        notes=tuple(Note(**note) for note in answer.facts["notes"]),
    )


def mesh_answer(request: dict[str, Any]) -> Answer:
    """Mesh what `mesh_step` asks for; this runs in the process of its own."""
    mesh = _mesh_here(_Request(**request))
    arrays: dict[str, Any] = {f"part{k}": blocks[0] for k, blocks in enumerate(mesh.parts.values())}
    arrays |= {f"face{k}": blocks[0] for k, blocks in enumerate(mesh.faces.values())}
    facts = {
        "parts": list(mesh.parts),
        "faces": {name: mesh.face_part[name] for name in mesh.faces},
        "notes": [asdict(note) for note in mesh.notes],
    }
    return Answer(facts=facts, arrays={"points": mesh.points} | arrays)


def _mesh_here(request: _Request) -> Mesh:
    path, size = Path(request.path), request.size
    local_size, face_points = request.local_size, request.face_points
    occ = kernel()
    Glue, OCCGeometry = occ.Glue, occ.OCCGeometry
    shape = read_step(path)
    solids = list(shape.solids)
    names, notes = _names([solid.name or "" for solid in solids], path.name)
    notes += _nameless(path, solids)
    for solid, name in zip(solids, names, strict=True):
        solid.name = name
    for label, (part, point) in face_points.items():
        if part not in names:
            raise InputError(f"face {label!r}: no part is called {part!r}; the parts are {', '.join(names)}")
        _face_at(label, part, point, list(solids[names.index(part)].faces)).name = label
    _check_size(sum(solid.mass for solid in solids), size, path.name)

    # gluing merges touching faces and keeps one of their names: remember the geometry of every named face
    marks = [Mark(face.name, names[i], face) for i, solid in enumerate(solids) for face in solid.faces if face.name]
    glued = Glue(solids) if len(solids) > 1 else shape
    parts = list(glued.solids)
    if len(parts) != len(solids):
        raise InputError(
            f"{path.name}: parts run into each other, so that gluing makes {len(parts)} solids of {len(names)}: "
            f"{_overlaps(solids, names)}; parts may touch, not overlap"
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
    for label, size_here in local_size.items():
        if label not in found:
            raise InputError(f"size of face {label!r}: the faces are {', '.join(sorted(found))}")
        for face, pairs in zip(listed, labels, strict=True):
            if any(label == have for have, _ in pairs):
                face.maxh = size_here * 1e3

    try:
        mesh = OCCGeometry(glued).GenerateMesh(maxh=size * 1e3, grading=0.4, quad_dominated=False)
        mesh.SecondOrder()
    except Exception as fault:  # NgException, which netgen's Python does not name
        raise InputError(
            f"{path.name} cannot be meshed with size {size * 1e3:g} mm ({fault}); choose another size, or repair the "
            f"geometry"
        ) from None
    collected = _collect(mesh, [solid.name for solid in parts], labels, source=path.name)
    return replace(collected, notes=notes)


def _names(given: Sequence[str], file: str) -> tuple[list[str], tuple[Note, ...]]:
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


def _nameless(path: Path, solids: Sequence[Any]) -> tuple[Note, ...]:
    """Where solids without a name lie: the kernel hands on no names of an assembly's parts, nor of their faces."""
    where = [
        f"part{number} about ({', '.join(f'{getattr(solid.center, axis):.4g}' for axis in 'xyz')}) mm"
        for number, solid in enumerate(solids, 1)
        if not solid.name
    ]
    if not where:
        return ()
    text = (
        f"{path.name}: the CAD kernel gives no names for {', '.join(where)} (products: {', '.join(products(path))}); "
        "in an assembly those of faces are lost, too: give them as face_at, or export the parts as bodies of one part"
    )
    return (Note(code="nameless-parts", text=text),)


def _face_at(label: str, part: str, point: Sequence[float], faces: Sequence[Any]) -> Any:
    """The one face of a part at a point. Raises InputError where none is near, or several are."""
    from netgen.occ import Pnt, Vertex

    here = Vertex(Pnt(*(1e3 * x for x in point)))
    distance = np.array([face.Distance(here) for face in faces])
    order = np.argsort(distance)
    where = f"face {label!r} at ({', '.join(f'{1e3 * x:g}' for x in point)}) mm"
    if distance[order[0]] > NEAR:
        raise InputError(
            f"{where}: the nearest face of {part!r} is {distance[order[0]]:.4g} mm away, more than {NEAR:g} mm; check "
            f"the point "
            "and its unit"
        )
    near = [faces[k] for k in order if distance[k] < distance[order[0]] + AMBIGUOUS]
    if len(near) > 1:
        centres = "; ".join(f"({f.center.x:.4g}, {f.center.y:.4g}, {f.center.z:.4g}) mm" for f in near)
        raise InputError(
            f"{where} lies on {len(near)} faces of {part!r}, with their centres at {centres}; give a point inside one "
            f"of them"
        )
    return near[0]


def _check_size(volume: float, size: float, name: str) -> None:
    """Raise InputError where a mesh of edges `size` [m] in a volume [mm3] is more than the memory takes."""
    elements = ELEMENTS * volume * 1e-9 / size**3
    unknowns = int(UNKNOWNS * elements)
    needed, free = guessed(unknowns), available()
    if free is not None and needed > free:
        least = size * (needed / free) ** 0.25  # memory grows as unknowns^(4/3), so as size^-4
        raise InputError(
            f"{name}: edges of {size * 1e3:g} mm make about {elements:,.0f} elements and {unknowns:,} unknowns, whose "
            f"factorisation takes {needed / 1e9:.3g} GB; {free / 1e9:.3g} GB are free: take {least * 1e3:.2g} mm or "
            f"more"
        )


def _overlaps(solids: Sequence[Any], names: Sequence[str]) -> str:
    """Which parts have a volume in common, and where."""
    found = []
    for k, one in enumerate(solids):
        for j in range(k):
            both = one * solids[j]
            if both.mass > 1e-9 * one.mass:
                low, high = both.bounding_box
                size = " x ".join(f"{b - a:.3g}" for a, b in zip(low, high, strict=True))
                centre = f"({both.center.x:.4g}, {both.center.y:.4g}, {both.center.z:.4g}) mm"
                found.append(f"{names[j]!r} and {names[k]!r} share {size} mm about {centre}")
    return "; ".join(found) or ", ".join(names)


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

    sides: numbers of the glued faces that bound each part. A piece bounds the part and lies on the face, which points
    on it tell, those of a mesh of the surfaces. Raises InputError where the pieces do not make up the face.
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
                f"face {mark.name!r} of part {mark.part!r} ({mark.face.mass:.6g} mm2) comes out as {area:.6g} mm2 "
                "where the parts touch; do they overlap? Else split it in the CAD program where they meet"
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
