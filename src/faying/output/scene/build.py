"""Scenes of results, studies, meshes, STEP files, and of any file by what it holds."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from faying.errors import InputError, ReadError
from faying.fe.mesh import Mesh
from faying.fe.outline import edges_of, normals, outline, regions
from faying.file_kinds import RESULT, STUDY, taken
from faying.geometry.face_facts import read_facts
from faying.joint.attachments import PointMass, Support, nearest_node
from faying.output.scene.text import Face, Mass, Scene, SceneBolt, SceneJoint, SceneModes, SceneSupport
from faying.result import Result
from faying.result.maps import joint_map_of
from faying.typing import Array, Index

if TYPE_CHECKING:
    from faying.study import Study


SHARP = 0.7  # rad: neighbours whose normals differ by more have a feature edge between them


def of_result(result: Result) -> Scene:
    """Return the scene of a result: parts, joints with maps, bolts, supports, masses, complex modes at every load."""
    faces, of_triangle = faces_of(
        result.outline, result.triangles, result.part_of_triangle, result.face_of_triangle, result.faces
    )
    by_name = {face.name: k for k, face in enumerate(faces) if face.name}
    joints = [
        SceneJoint(
            name=name, faces=tuple(by_name[face] for face in pair if face in by_name), map=joint_map_of(result, k)
        )
        for k, (name, pair) in enumerate(zip(result.joints, result.joint_faces, strict=True))
    ]
    return Scene(
        title=result.title,
        points=result.outline,
        triangles=result.triangles,
        parts=result.parts,
        faces=faces,
        face_of_triangle=of_triangle,
        edges=feature_edges(result.outline, result.triangles, of_triangle),
        joints=tuple(joints),
        bolts=(*_bolts(result), *_dowels(result)),
        supports=_supports(result.supports, by_name),
        masses=_masses(result.masses, faces, by_name),
        loads=result.loads,
        modes=SceneModes(
            frequencies=result.frequencies,
            loss_factors=result.loss_factors,
            real=result.shapes,
            imaginary=result.shapes_imaginary,
        ),
    )


def of_mesh(mesh: Mesh, study: "Study | None" = None, *, title: str = "") -> Scene:
    """Return the scene of a mesh: parts and faces; with the study that it belongs to, also joints, bolts and the like.

    Raises:
        InputError: A bolt of the study does not fit the mesh.
    """
    joined = () if study is None else tuple(face for joint in study.joints for face in joint.faces)
    seats = () if study is None else tuple(face for bolt in study.bolts for face in bolt.faces)
    walls = () if study is None else tuple(wall for dowel in study.dowels for wall in dowel.walls)
    outer = outline(mesh, (*joined, *seats, *walls))
    points = mesh.points[outer.nodes]
    faces, of_triangle = faces_of(points, outer.triangles, outer.part_of_triangle, outer.face_of_triangle, outer.faces)
    by_name = {face.name: k for k, face in enumerate(faces) if face.name}
    more: dict[str, Any] = {}
    if study is not None:
        more = {
            "joints": tuple(
                SceneJoint(name=joint.name, faces=tuple(by_name[face] for face in joint.faces if face in by_name))
                for joint in study.joints
            ),
            "bolts": (*_planned_bolts(study, mesh), *_planned_dowels(study, mesh)),
            "supports": _supports(study.supports, by_name),
            "masses": _masses(study.masses, faces, by_name, mesh),
        }
    return Scene(
        title=title or (study.title if study is not None else mesh.source),
        points=points,
        triangles=outer.triangles,
        parts=tuple(mesh.parts),
        faces=faces,
        face_of_triangle=of_triangle,
        edges=feature_edges(points, outer.triangles, of_triangle),
        **more,
    )


def faces_of(
    points: Array, triangles: Index, part: Index, named: Index, names: Sequence[str]
) -> tuple[tuple[Face, ...], Index]:
    """Faces of a surface, part by part, and the face of each triangle (t,).

    part, named (t,): part and named face of each triangle, -1 without a name. Named faces come first, in their order;
    what has no name is divided into smooth regions.
    """
    region = regions(points, triangles, part * (len(names) + 2) + named, angle=SHARP)
    key = np.where(named >= 0, named, len(names) + region)
    pairs = np.stack([part, key], axis=1)
    unique, of_triangle = np.unique(pairs, axis=0, return_inverse=True)
    faces: list[Face] = []
    count: dict[int, int] = {}
    measured = measures(points, triangles, of_triangle.ravel(), len(unique))
    for k, (owner, label) in enumerate(unique.tolist()):
        count[owner] = count.get(owner, 0) + 1
        name = names[label] if label < len(names) else ""
        faces.append(face(owner, count[owner], name, *(values[k] for values in measured)))
    return tuple(faces), of_triangle.ravel().astype(np.int64)


def face(part: int, number: int, name: str, area: float, centre: Array, normal: Array) -> Face:
    """Return a face with its numbers as plain ones."""
    return Face(part=part, number=number, name=name, area=float(area), centre=centre, normal=normal)


def measures(points: Array, triangles: Index, of_triangle: Index, count: int) -> tuple[Array, Array, Array]:
    """Area [m2] (f,), centre [m] (f, 3) and mean unit normal (f, 3) of groups of triangles."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    total: Array = np.asarray(np.bincount(of_triangle, area, count), dtype=float)
    weighted = [area[:, None] * rows for rows in ((a + b + c) / 3, normals(points, triangles))]
    centre, normal = (
        np.stack([np.bincount(of_triangle, rows[:, k], count) for k in range(3)], axis=1)
        / np.where(total > 0, total, 1.0)[:, None]
        for rows in weighted
    )
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    return total, centre, np.where(size > 1e-6, normal / np.where(size > 0, size, 1.0), 0.0)


def feature_edges(points: Array, triangles: Index, of_triangle: Index) -> Index:
    """Edges (e, 2) between two faces, at a sharp bend, or at a rim."""
    edges, first, last = edges_of(triangles)
    normal = normals(points, triangles)
    sharp = np.einsum("ij,ij->i", normal[first], normal[last]) < np.cos(SHARP)
    return np.asarray(edges[sharp | (of_triangle[first] != of_triangle[last]) | (first == last)])


def _bolts(result: Result) -> tuple[SceneBolt, ...]:
    size = float(np.linalg.norm(np.ptp(result.outline, axis=0)))
    out = []
    rows = zip(result.bolts, result.bolt_seats, result.bolt_diameters, result.bolt_extents, strict=True)
    for name, seats, given, extent in rows:
        diameter, head = drawn(given, extent, size)
        out.append(SceneBolt(name=name, seats=seats, diameter=diameter, head=head, meshed=bool(np.isnan(extent[0]))))
    return tuple(out)


def drawn(diameter: float, extent: Sequence[float], size: float) -> tuple[float, float]:
    """Diameters [m] of shank and head as they are drawn.

    diameter [m]: of the shank, NaN where none is given: then it nearly fills its hole, or is thin where there is none;
    extent [m]: least and greatest diameter of the seat; size [m]: of the structure.
    """
    inner, outer = np.nan_to_num(extent)
    thin = 0.02 * size
    shank = diameter if np.isfinite(diameter) else 0.9 * inner if inner > 0.1 * thin else min(thin, 0.5 * outer)
    return float(shank), float(max(min(outer, 2.2 * shank), 1.1 * shank))


def _planned_bolts(study: "Study", mesh: Mesh) -> tuple[SceneBolt, ...]:
    from faying.bolt.bolt import Bolt
    from faying.fe.sides import face_centre

    out = []
    for bolt in study.bolts:
        if isinstance(bolt, Bolt):
            fitted = bolt.fitted(mesh)
            diameter, head = drawn(bolt.diameter or np.nan, fitted.pressed[0].diameters, mesh.size)
            out.append(SceneBolt(name=bolt.name, seats=fitted.seats, diameter=diameter, head=head))
        else:
            seats = np.stack([face_centre(mesh.points, mesh.face(face))[0] for face in bolt.faces])
            out.append(SceneBolt(name=bolt.name, seats=seats, diameter=0.0, head=0.0, meshed=True))
    return tuple(out)


def _dowels(result: Result) -> tuple[SceneBolt, ...]:
    """The dowels of a result, drawn without a head."""
    if result.dowel_ends is None or result.dowel_diameters is None:
        return ()
    rows = zip(result.dowels, result.dowel_ends, result.dowel_diameters, strict=True)
    return tuple(SceneBolt(name=name, seats=ends, diameter=float(d), head=0.0) for name, ends, d in rows)


def _planned_dowels(study: "Study", mesh: Mesh) -> tuple[SceneBolt, ...]:
    places = [dowel.placed(mesh) for dowel in study.dowels]
    return tuple(SceneBolt(name=p.dowel.name, seats=p.seats, diameter=p.diameter, head=0.0) for p in places)


def _supports(supports: Sequence[Support], by_name: dict[str, int]) -> tuple[SceneSupport, ...]:
    return tuple(
        SceneSupport(face=by_name[one.face], directions=one.directions, elastic=one.stiffness is not None)
        for one in supports
        if one.face in by_name and one.whole
    )


def _masses(
    masses: Sequence[PointMass], faces: Sequence[Face], by_name: dict[str, int], mesh: Mesh | None = None
) -> tuple[Mass, ...]:
    out = []
    for one in masses:
        if one.point is not None:
            if mesh is not None:
                nearest_node(mesh, one.point, f"point mass of {one.mass:g} kg")
            out.append(Mass(mass=one.mass, point=np.array(one.point)))
        elif one.face in by_name:
            out.append(Mass(mass=one.mass, point=faces[by_name[one.face]].centre + np.array(one.offset)))
    return tuple(out)


CLOSE = 1e-7  # of the size: corners of triangles nearer than this are one


def of_step(path: str | Path) -> Scene:
    """Return the scene of a STEP file, tessellated by the CAD kernel in a process of its own.

    Corners that lie in one place on one part are joined, and triangles without area left out. The number of a face is
    its position, from 1, in `list(solid.faces)` of its solid, before any gluing.

    Raises:
        ReadError: The file cannot be read, also where the CAD kernel dies on it.
    """
    facts = read_facts(Path(path), touching=False)
    corners, owner = facts.corners, facts.face_of
    parts = [part.name for part in facts.parts]
    part_of_triangle = np.array([parts.index(one.part) for one in facts.faces])[owner]
    size = float(np.linalg.norm(np.ptp(corners.reshape(-1, 3), axis=0)))
    grid = np.rint(corners.reshape(-1, 3) / (CLOSE * size)).astype(np.int64)
    _, first, inverse = np.unique(
        np.column_stack([np.repeat(part_of_triangle, 3), grid]), axis=0, return_index=True, return_inverse=True
    )
    points, triangles = corners.reshape(-1, 3)[first], inverse.reshape(-1, 3).astype(np.int64)
    a, b, c = triangles.T
    whole = (a != b) & (b != c) & (c != a)
    triangles, owner = triangles[whole], owner[whole].astype(np.int64)
    _, _, normal = measures(points, triangles, owner, len(facts.faces))
    faces = [
        face(parts.index(one.part), one.number, one.name, one.area, np.array(one.centre), normal[k])
        for k, one in enumerate(facts.faces)
    ]
    return Scene(
        title=facts.file,
        points=points,
        triangles=triangles,
        parts=tuple(parts),
        faces=tuple(faces),
        face_of_triangle=owner,
        edges=feature_edges(points, triangles, owner),
    )


def of_file(path: str | Path, unit: str | None = None) -> Scene:
    """Return the scene of a study (.toml), a result (.nc), a STEP file or a mesh.

    Args:
        path: The file; what it holds says what it is.
        unit: Of a mesh file, such as "mm", since no mesh file says its own.

    Raises:
        ReadError: The file is missing or cannot be read.
        InputError: A mesh file without unit, a unit for another file, or a study that does not fit its geometry.
    """
    file = Path(path)
    if not file.is_file():
        raise ReadError(f"no file {file}")
    kind = taken(file, "geometry", "mesh", "study", "result")
    meshed = "mesh" in kind.serves
    if unit is not None and not meshed:
        raise InputError(f"--unit is for mesh files; {file.name} states its units, so leave --unit out")
    if kind is STUDY:
        from faying.case.case import checked_mesh
        from faying.study import Study

        study = Study.read(file)
        return of_mesh(checked_mesh(study), study)
    if kind is RESULT:
        return of_result(Result.load(file))
    if not meshed:
        return of_step(file)
    if unit is None:
        raise InputError(f'a mesh file does not state its unit; give that of {file.name}, for example --unit "mm"')
    from faying.decks.meshfile import read_mesh

    return of_mesh(read_mesh(file, unit=unit), title=file.name)
