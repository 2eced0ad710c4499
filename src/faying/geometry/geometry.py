"""From a STEP file with named solids and faces to a mesh, through netgen (LGPL) and its OpenCASCADE kernel.

Names are those that the CAD program gave to solids, products and faces. A face without a name gets one by a selector.
"""

import json
from collections.abc import Container, Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from faying.cache import kept
from faying.errors import InputError
from faying.fe.elements import from_edges
from faying.fe.mesh import Mesh
from faying.fe.solids import split_at_joints
from faying.fe.straighten import straightened
from faying.geometry.cad import CadParts, ask_kernel, check_head, files_of, kernel, read_parts
from faying.geometry.face_facts import facts_of, shared_volumes
from faying.geometry.selectors import Selector, chosen, points_of
from faying.memory import available
from faying.notes import Note
from faying.numerics.memory import guessed
from faying.typing import Array, Index

# tetrahedra per volume over edge^3, and unknowns per tetrahedron of second order: counted on blocks and on bolted
# joints
ELEMENTS, UNKNOWNS = 5.0, 4.5
GRADING = 0.4  # growth of elements away from where they are fine
TRIES = ((1.0, GRADING), (0.8, 0.3), (0.6, 0.2))  # size over that asked for, and grading, until the mesher has a mesh
STORED = 4  # version of what the cache holds; it rises with any change of what this module makes of a file
# netgen numbers the middle nodes by these edges
TET10 = from_edges("tet10", ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)))
TRI6 = from_edges("tri6", ((1, 2), (0, 2), (0, 1)))


@dataclass(frozen=True, kw_only=True)
class _Request:
    """What is asked of the CAD kernel; lengths [m]."""

    file: str
    size: float
    local_size: Mapping[str, float]
    selectors: Mapping[str, Selector]
    snap: float
    leave_out: Sequence[str] = ()
    unite: Sequence[Sequence[str]] = ()


def mesh_step(
    path: Path,
    *,
    size: float,
    local_size: Mapping[str, float] | None = None,
    faces: Mapping[str, Selector] | None = None,
    snap: float = 0.0,
    leave_out: Sequence[str] = (),
    unite: Sequence[Sequence[str]] = (),
    cache: Path | None = None,
) -> Mesh:
    """Mesh the solids of a STEP file with second-order tetrahedra, in a process of its own.

    Args:
        path: STEP file.
        size: largest edge [m].
        local_size: face name -> largest edge there [m].
        faces: name to give -> which faces get it, beside the names of the file.
        snap: faces of two parts that lie no farther apart than this count as touching [m].
        leave_out: names of parts that are not meshed.
        unite: names of bodies that are one part each.
        cache: folder that keeps the mesh for the next call; see `faying.cache.kept`.

    Faces that two parts share come out matched node for node, one copy per part.

    Raises:
        ReadError: unreadable files, among them those on which the CAD kernel dies.
        InputError: names that do not exist, selectors that fit no face or several, meshes beyond the memory.
    """
    check_head(path)
    request = _Request(
        file=path.name,
        size=size,
        local_size=local_size or {},
        selectors=faces or {},
        snap=snap,
        leave_out=list(leave_out),
        unite=list(map(list, unite)),
    )

    def made() -> dict[str, Any]:
        return ask_kernel(path, _mesh_arrays, request)

    plain = asdict(request) | {"netgen": version("netgen-mesher"), "stored": STORED}
    content = b"".join(file.read_bytes() for file in files_of(path))
    data = kept(made, cache, kind="mesh", key=json.dumps(plain, sort_keys=True), data=content)
    facts = json.loads(data["facts"].item())
    parts, owners = facts["parts"], facts["faces"]
    return Mesh(
        points=data["points"],
        parts={name: (data[f"part{k}"],) for k, name in enumerate(parts)},
        faces={name: (data[f"face{k}"],) for k, name in enumerate(owners)},
        face_part=owners,
        source=path.name,
        notes=tuple(Note(**note) for note in facts["notes"]),
    )


def _mesh_arrays(path: Path, request: _Request) -> dict[str, Any]:
    """Mesh what `mesh_step` asks for, in a process that has the kernel; whoever asked checks the mesh."""
    size, occ = request.size, kernel()
    cad = read_parts(path).united(request.unite).without(request.leave_out)
    solids, names, notes = cad.solids, cad.names, cad.notes
    for solid, name in zip(solids, names, strict=True):
        solid.name = name
    _check_size(sum(solid.mass for solid in solids), size, path.name)

    # gluing merges touching faces and keeps one of their names: remember the geometry of every named face
    marks = [Mark(face.name, names[i], face) for i, solid in enumerate(solids) for face in solid.faces if face.name]
    marks += _selected(cad, request, {mark.name for mark in marks})
    glued = occ.Glue(solids) if len(solids) > 1 else solids[0]
    parts = list(glued.solids)
    if len(parts) != len(solids):
        raise InputError(
            f"{path.name}: parts run into each other, so that gluing makes {len(parts)} solids of {len(names)}: "
            f"{'; '.join(shared_volumes(solids, names)) or ', '.join(names)}; parts may touch, not overlap"
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
    for label, size_here in request.local_size.items():
        if label not in found:
            raise InputError(f"size of face {label!r}: the faces are {', '.join(sorted(found))}")
        for face, pairs in zip(listed, labels, strict=True):
            if any(label == have for have, _ in pairs):
                face.maxh = size_here * 1e3

    return _collect(_meshed(glued, size, path.name), [solid.name for solid in parts], labels, notes)


def _meshed(glued: Any, size: float, name: str) -> Any:
    """The mesh of netgen, with a second try at smaller elements where the first one gets none."""
    from netgen.occ import OCCGeometry

    fault: Exception | None = None
    for times, grading in TRIES:
        try:
            mesh = OCCGeometry(glued).GenerateMesh(maxh=times * size * 1e3, grading=grading, quad_dominated=False)
            mesh.SecondOrder()
        except Exception as new:  # NgException, which netgen's Python does not name
            fault = fault or new
            continue
        return mesh
    raise InputError(
        f"{name} cannot be meshed with size {size * 1e3:g} mm ({fault}); choose another size, or repair the geometry"
    )


def _selected(cad: CadParts, request: _Request, taken: Container[str]) -> list["Mark"]:
    """Marks of the faces that the selectors mean. Raises InputError where one takes a name that the file gives."""
    selectors = request.selectors
    again = [label for label in selectors if label in taken]
    if again:
        raise InputError(f"face {again[0]!r}: the file has a face of this name already; choose another name")
    if not selectors:
        return []
    touching = any(selector.touching is not None for selector in selectors.values())
    facts = facts_of(cad.solids, cad.names, request.file, points_of(selectors), touching=touching)
    out = []
    for label, selector in selectors.items():
        faces = list(cad.solids[cad.names.index(selector.part)].faces) if selector.part in cad.names else []
        found = chosen(label, selector, facts, snap=request.snap)
        out += [Mark(label, selector.part, faces[face.number - 1]) for face in found]
    return out


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
                f"face {mark.name!r} of part {mark.part!r} ({mark.face.mass:.6g} mm2) has {area:.6g} mm2 "
                "where the parts touch; do they overlap? Else split it in the CAD program where they meet"
            )


def _collect(mesh: Any, parts: list[str], labels: Labels, notes: Sequence[Note]) -> dict[str, Any]:
    points = np.asarray(mesh.Coordinates(), float) * 1e-3
    tets = mesh.Elements3D().NumPy()
    cells = tets["nodes"][:, :10].astype(np.int64)[:, TET10] - 1
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
            tri = tris["nodes"][face_of == number][:, :6].astype(np.int64)[:, TRI6] - 1
            face_part[label] = part
            owner[label] = parts.index(part)
            triangles[label] = np.concatenate([triangles[label], tri]) if label in triangles else tri
    points, straight, flat = straightened(points, cells)
    if np.any(flat):
        middles = 1e3 * points[cells[flat][:3, :4]].mean(axis=1)
        places = ", ".join(f"({', '.join(f'{x:.4g}' for x in middle)})" for middle in middles)
        raise InputError(
            f"{np.count_nonzero(flat)} elements have no volume, at {places} mm; give the faces there a smaller size "
            "(geometry.face_size), or remove slivers there in the CAD program"
        )
    if straight:
        text = f"{straight} elements that round faces folded over have straight edges"
        notes = [*notes, Note(code="straightened", text=text)]
    new_points, new_cells, faces = split_at_joints(points, cells, domain, triangles, owner)
    blocks = {name: new_cells[domain == i] for i, name in enumerate(parts)}
    for label, tri in faces.items():
        faces[label] = _outward(new_points, tri, blocks[face_part[label]])
    facts = {"parts": parts, "faces": face_part, "notes": [asdict(note) for note in notes]}
    arrays = {f"part{k}": blocks[name] for k, name in enumerate(parts)}
    arrays |= {f"face{k}": faces[name] for k, name in enumerate(face_part)}
    return {"facts": np.asarray(json.dumps(facts)), "points": new_points} | arrays


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
