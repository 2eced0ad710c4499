"""What the faces of a geometry are: planes and cylinders, holes and shafts, neighbours, and where parts touch."""

from collections.abc import Container, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import Any, Literal

import numpy as np

from faying.errors import InputError
from faying.fe.line import FACING, Line
from faying.fe.overlap import overlap
from faying.geometry.cad import ask_kernel, check_head, read_parts
from faying.notes import Note
from faying.style import Summary
from faying.text import listed
from faying.typing import Array, Index

Point = tuple[float, float, float]
FLAT = 1e-5  # of a face's size: how far its points lie from a plane that it counts as
ROUND = 1e-4  # of the radius: how far they lie from a cylinder
MAX_DISTANCE = 0.01  # of the size of the structure: faces farther apart do not belong together


@dataclass(frozen=True, kw_only=True)
class FaceFacts:
    """One face of a part.

    Args:
        part: the part that it bounds.
        number: its place among the faces of its part, from 1.
        name: what the file calls it; "" where it does not.
        kind: plane, cylinder or other.
        area: [m2].
        centre: centre of its area [m].
        normal: outward unit normal of a plane; None of other kinds.
        radius: of a cylinder [m].
        axis: unit direction of a cylinder's axis.
        start, length: the point on the axis at which the cylinder begins [m], and its length along the axis [m].
        turn: the share of a whole turn that a cylinder goes round [-].
        hole: whether the material is outside of a cylinder; None of other kinds.
        neighbours: numbers of the faces of the same part with a common edge.
    """

    part: str
    number: int
    name: str
    kind: Literal["plane", "cylinder", "other"]
    area: float
    centre: Point
    normal: Point | None = None
    radius: float | None = None
    axis: Point | None = None
    start: Point | None = None
    length: float | None = None
    turn: float | None = None
    hole: bool | None = None
    neighbours: tuple[int, ...] = ()

    @property
    def label(self) -> str:
        """The part and the number, for messages."""
        return f"{self.part} {self.number}"

    @property
    def side(self) -> tuple[str, int]:
        """The part and the number."""
        return self.part, self.number

    @property
    def line(self) -> Line:
        """The axis of a cylinder, from where it begins."""
        return Line(point=np.array(self.start), axis=np.array(self.axis))

    def facing(self, direction: Array) -> float:
        """Component of a direction (3,) along the outward normal of a plane; 0 for other kinds."""
        return 0.0 if self.normal is None else float(np.array(self.normal) @ direction)


@dataclass(frozen=True, kw_only=True)
class PartFacts:
    """A part: name, volume [m3], area of all faces [m2], and the corners of the box around it [m]."""

    name: str
    volume: float
    area: float
    low: Point
    high: Point

    @property
    def thickness(self) -> float:
        """Twice the volume over the area [m]: the thickness of a wide plate."""
        return 2 * self.volume / self.area


@dataclass(frozen=True, kw_only=True)
class TouchingFaces:
    """Two faces of different parts that look at each other.

    Args:
        first, second: part and number of each face.
        area: over which they face each other [m2].
        gap: between them [m]; negative where they run into each other.
    """

    first: tuple[str, int]
    second: tuple[str, int]
    area: float
    gap: float

    @property
    def sides(self) -> tuple[tuple[str, int], tuple[str, int]]:
        """Part and number of both faces."""
        return self.first, self.second

    @property
    def parts(self) -> tuple[str, str]:
        """Parts of both faces."""
        return self.first[0], self.second[0]


# SI units of the numbers of a geometry
UNITS = {
    "area": "m^2",
    "centre": "m",
    "normal": "1",
    "radius": "m",
    "axis": "1",
    "start": "m",
    "length": "m",
    "turn": "1",
    "gap": "m",
    "volume": "m^3",
    "low": "m",
    "high": "m",
}
MAX_ROWS = 8  # parts in a summary


@dataclass(frozen=True, kw_only=True, repr=False)
class GeometryFacts(Summary):
    """Parts, faces and contacts of a geometry.

    Args:
        file: its name.
        parts, faces, contacts: the facts.
        distances: label of a point that was asked for -> distance [m] to each face of its part, by number.
        overlaps: parts that have a volume in common, and where, in words.
        notes: what the reader says of the file.
        corners: triangles (t, 3, 3) [m] of all faces, normals outwards; curved faces by chords.
        face_of: index (t,) in `faces` of each triangle.
    """

    file: str
    parts: tuple[PartFacts, ...]
    faces: tuple[FaceFacts, ...]
    contacts: tuple[TouchingFaces, ...]
    distances: dict[str, list[float]]
    overlaps: tuple[str, ...] = ()
    notes: tuple[Note, ...] = ()
    corners: Array
    face_of: Index

    @classmethod
    def of(
        cls,
        parts: Sequence[PartFacts],
        faces: Sequence[FaceFacts],
        triangles: Sequence[Array],
        *,
        touching: bool = True,
        **rest: Any,
    ) -> "GeometryFacts":
        """The facts of parts and of faces with their triangles (t, 3, 3) [m]; touching: whether contacts are sought."""
        corners = np.concatenate([np.zeros((0, 3, 3)), *triangles])
        face_of = np.repeat(np.arange(len(faces)), np.array([len(one) for one in triangles], dtype=np.int64))
        met = tuple(contacts(faces, corners, face_of)) if touching and len(corners) else ()
        return cls(parts=tuple(parts), faces=tuple(faces), contacts=met, corners=corners, face_of=face_of, **rest)

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return what the geometry consists of, and the size of each part."""
        rows = {}
        for part in self.parts[:MAX_ROWS]:
            sides = " x ".join(f"{1e3 * (b - a):.4g}" for a, b in zip(part.low, part.high, strict=True))
            rows[part.name] = f"{len(self.by_part[part.name])} faces, {1e6 * part.volume:.4g} cm^3, within {sides} mm"
        rows |= {"more parts": str(len(self.parts) - MAX_ROWS)} if len(self.parts) > MAX_ROWS else {}
        touching = f"{len(self.contacts)} pair{'s' * (len(self.contacts) != 1)} that touch"
        return f"Geometry {self.file}: {len(self.parts)} parts, {len(self.faces)} faces, {touching}", rows

    def of_part(self, name: str) -> "GeometryFacts":
        """Return one part, its faces and their contacts. Raises InputError where there is no such part."""
        if name not in self.by_part:
            raise InputError(f"no part is called {name!r}; the parts are {', '.join(map(repr, self.by_part))}")
        contacts = tuple(contact for contact in self.contacts if name in contact.parts)
        return replace(self.without([part.name for part in self.parts if part.name != name]), contacts=contacts)

    def to_dict(self) -> dict[str, Any]:
        """Parts, faces and contacts in SI units, with the units of their numbers."""
        return {
            "file": self.file,
            "units": UNITS,
            "parts": [asdict(part) for part in self.parts],
            "faces": [asdict(face) for face in self.faces],
            "contacts": [asdict(contact) for contact in self.contacts],
            "notes": [note.text for note in self.notes],
        }

    @cached_property
    def by_part(self) -> dict[str, tuple[FaceFacts, ...]]:
        """The faces of each part, in the order of their numbers."""
        return {part.name: tuple(face for face in self.faces if face.part == part.name) for part in self.parts}

    @property
    def size(self) -> float:
        """Diagonal of the box around all parts [m]."""
        low, high = (np.array([getattr(part, side) for part in self.parts]) for side in ("low", "high"))
        return float(np.linalg.norm(high.max(axis=0) - low.min(axis=0)))

    def face(self, part: str, number: int) -> FaceFacts:
        """The face of a part by its number."""
        return self.by_part[part][number - 1]

    def triangles(self, face: FaceFacts) -> Array:
        """Triangles (t, 3, 3) [m] of a face."""
        return self._triangles[face.side]

    def corners_of(self, part: str) -> Array:
        """Triangles (t, 3, 3) [m] of all faces of a part."""
        return np.concatenate([self.triangles(face) for face in self.by_part[part]])

    @cached_property
    def _triangles(self) -> dict[tuple[str, int], Array]:
        rows = _rows(self.face_of, len(self.faces))
        return {face.side: self.corners[row] for face, row in zip(self.faces, rows, strict=True)}

    def without(self, parts: Container[str]) -> "GeometryFacts":
        """The same geometry with some parts left out."""
        left = np.array([face.part not in parts for face in self.faces])
        rows = left[self.face_of]
        return replace(
            self,
            parts=tuple(part for part in self.parts if part.name not in parts),
            faces=tuple(face for face in self.faces if face.part not in parts),
            contacts=tuple(c for c in self.contacts if c.first[0] not in parts and c.second[0] not in parts),
            corners=self.corners[rows],
            face_of=(np.cumsum(left) - 1)[self.face_of[rows]],
        )


def read_facts(
    path: Path,
    *,
    points: dict[str, tuple[str, Sequence[float]]] | None = None,
    overlaps: bool = False,
    touching: bool = True,
    leave_out: Sequence[str] = (),
    unite: Sequence[Sequence[str]] = (),
) -> GeometryFacts:
    """Read what the faces of a STEP file are, in a process of its own.

    Args:
        path: the STEP file.
        points: label -> (part, point [m]): the distance of each to the faces of its part is measured.
        overlaps: whether parts are searched for common volumes, which takes the kernel a while.
        touching: whether contacts are sought.
        leave_out: names of parts that are not read.
        unite: names of bodies that are one part each.

    Raises:
        ReadError: the file cannot be read, or the kernel died on it.
        InputError: there is no part to leave out or to unite, or none is left.
    """
    check_head(path)
    return ask_kernel(path, _read_facts, points or {}, overlaps, touching, leave_out, unite)


def _read_facts(
    path: Path,
    points: dict[str, tuple[str, Sequence[float]]],
    overlaps: bool,
    touching: bool,
    leave_out: Sequence[str],
    unite: Sequence[Sequence[str]],
) -> GeometryFacts:
    """The facts, in a process that has the kernel."""
    cad = read_parts(path).united(unite).without(leave_out)
    found = facts_of(cad.solids, cad.names, path.name, points, touching=touching)
    shared = tuple(shared_volumes(cad.solids, cad.names)) if overlaps else ()
    bare = [f"{face.number} of {face.part!r}" for face in found.faces if not len(found.triangles(face))]
    text = f"{path.name}: the CAD kernel does not follow the bounds of the faces {listed(bare, 4)}, so that nothing is "
    text += "found there; repair them in the CAD program"
    notes = (*cad.notes, *[Note(code="faces-without-triangles", text=text)] * bool(bare))
    return replace(found, overlaps=shared, notes=notes)


def facts_of(
    solids: Sequence[Any],
    names: Sequence[str],
    file: str,
    points: dict[str, tuple[str, Sequence[float]]],
    *,
    touching: bool = True,
) -> GeometryFacts:
    """The facts of solids [mm] in this process, which has the kernel; touching: whether contacts are sought."""
    faces: list[FaceFacts] = []
    parts, triangles = [], []
    for solid, name in zip(solids, names, strict=True):
        solid_faces = list(solid.faces)
        low, high = (1e-3 * np.array([*end]) for end in solid.bounding_box)  # before there are triangles, it is exact
        tris, normals, of = _triangles(solid)
        edges = [{hash(edge) for edge in face.edges} for face in solid_faces]
        for k, face in enumerate(solid_faces):
            mine = of == k
            near = tuple(j + 1 for j in range(len(solid_faces)) if j != k and edges[j] & edges[k])
            centre = 1e-3 * np.array([face.center.x, face.center.y, face.center.z])
            shape = shape_of(tris[mine], normals[mine], 1e-6 * face.mass)
            faces.append(
                FaceFacts(
                    part=name,
                    number=k + 1,
                    name=face.name or "",
                    area=1e-6 * face.mass,
                    centre=point_of(centre),
                    neighbours=near,
                    **shape,
                )
            )
            triangles.append(tris[mine])
        box = {"low": point_of(np.round(low, 9)), "high": point_of(np.round(high, 9))}  # the kernel's has a margin
        parts.append(
            PartFacts(name=name, volume=1e-9 * solid.mass, area=1e-6 * sum(f.mass for f in solid_faces), **box)
        )
    distances = {label: _distances(label, part, at, solids, names) for label, (part, at) in points.items()}
    return GeometryFacts.of(parts, faces, triangles, touching=touching, file=file, distances=distances)


def point_of(values: Any, digits: int = 12) -> Point:
    """A point or a direction (3,) to so many digits: what is less is rounding."""
    x, y, z = (round(float(v), digits) + 0.0 for v in values)
    return x, y, z


def _triangles(solid: Any) -> tuple[Array, Array, Index]:
    """Triangles (t, 3, 3) [m] of a solid's faces, unit normals at their corners, both outwards, and face (t,)."""
    data = solid._webgui_data()["Bezier_trig_points"]  # the one way by which the kernel hands triangles on
    places = np.array([np.reshape(block, (-1, 4)) for block in data[:3]])
    normals = np.array([np.reshape(block, (-1, 3)) for block in data[3:]])
    return 1e-3 * places[:, :, :3].transpose(1, 0, 2), normals.transpose(1, 0, 2), places[0, :, 3].astype(np.int64)


def _distances(label: str, part: str, at: Sequence[float], solids: Sequence[Any], names: Sequence[str]) -> list[float]:
    """Distance [m] of a point to each face of a part; none where there is no such part, which the selector says."""
    from netgen.occ import Pnt, Vertex

    if part not in names:
        return []
    here = Vertex(Pnt(*(1e3 * x for x in at)))
    return [1e-3 * face.Distance(here) for face in solids[names.index(part)].faces]


def shape_of(corners: Array, normals: Array, area: float) -> dict[str, Any]:
    """Kind of a face from its triangles (t, 3, 3) [m] and the unit normals at their corners, with its numbers."""
    if not len(corners):  # the kernel gave up on the face
        return {"kind": "other"}
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    total = cross.sum(axis=0)
    points = corners.reshape(-1, 3)
    length = np.linalg.norm(total)
    if length > 0:
        normal = total / length
        if np.ptp(points @ normal) < FLAT * np.sqrt(area):
            return {"kind": "plane", "normal": point_of(normal)}
    weight = np.repeat(np.linalg.norm(cross, axis=1), 3)
    across = normals.reshape(-1, 3)
    spread, turn = np.linalg.eigh(np.einsum("p,pi,pj->ij", weight, across, across) / weight.sum())
    if spread[0] > 1e-8 or spread[1] < 1e-6:
        return {"kind": "other"}
    axis = turn[:, 0] * (1 if turn[np.argmax(np.abs(turn[:, 0])), 0] > 0 else -1)
    axis = np.where(np.abs(axis) < 1e-9, 0.0, axis)
    flat = points @ turn[:, 1:]
    system = np.column_stack([2 * flat, np.ones(len(flat))])
    (x, y, rest), *_ = np.linalg.lstsq(system, (flat**2).sum(axis=1), rcond=None)
    arm = flat - [x, y]
    radius = float(np.sqrt(max(rest + x**2 + y**2, 0.0)))
    if radius == 0 or np.abs(np.linalg.norm(arm, axis=1) - radius).max() > ROUND * radius:
        return {"kind": "other"}
    outwards = np.einsum("pi,pi->p", across @ turn[:, 1:], arm) / radius
    if np.abs(np.abs(outwards) - 1).max() > 0.01:
        return {"kind": "other"}
    along = points @ axis
    extent = float(np.ptp(along))
    start = turn[:, 1:] @ np.array([x, y]) + along.min() * axis
    return {
        "kind": "cylinder",
        "radius": radius,
        "axis": point_of(axis),
        "start": point_of(start),
        "length": extent,
        "turn": min(area / (2 * np.pi * radius * extent), 1.0) if extent else 0.0,
        "hole": bool(outwards.mean() < 0),
    }


def contacts(faces: Sequence[FaceFacts], corners: Array, face_of: Index) -> list[TouchingFaces]:
    """Faces of different parts that look at each other, the widest first.

    Planes that are nearly parallel, and cylinders in cylinders of nearly their radius on one axis, no farther apart
    than `MAX_DISTANCE` of the whole.
    """
    reach = MAX_DISTANCE * float(np.linalg.norm(np.ptp(corners.reshape(-1, 3), axis=0)))
    rows = _rows(face_of, len(faces))
    low = np.array([corners[r].min(axis=(0, 1)) if len(r) else np.full(3, np.inf) for r in rows])
    high = np.array([corners[r].max(axis=(0, 1)) if len(r) else np.full(3, -np.inf) for r in rows])
    part = np.unique([face.part for face in faces], return_inverse=True)[1]
    kind = np.array([("plane", "cylinder", "other").index(face.kind) for face in faces])
    out = []
    for i, one in enumerate(faces):
        near = (np.arange(len(faces)) > i) & (part != part[i]) & (kind == kind[i]) & (kind < 2)
        near &= np.all((low <= high[i] + reach) & (high >= low[i] - reach), axis=1)
        for j in np.flatnonzero(near).tolist():
            two = faces[j]
            gap = _gap(one, two)
            if gap is None or abs(gap) > reach:
                continue
            area = _facing_area(corners[rows[i]], corners[rows[j]], reach)
            least, own = min((one, rows[i]), (two, rows[j]), key=lambda pair: pair[0].area)
            area *= least.area / _area(corners[own])  # chords have less
            if area > 1e-6 * min(one.area, two.area):
                out.append(TouchingFaces(first=one.side, second=two.side, area=area, gap=gap))
    return sorted(out, key=lambda contact: -contact.area)


def _rows(face_of: Index, count: int) -> list[Index]:
    """The triangles of each of so many faces."""
    return np.split(np.argsort(face_of, kind="stable"), np.cumsum(np.bincount(face_of, minlength=count))[:-1])


def _gap(one: FaceFacts, two: FaceFacts) -> float | None:
    """Distance [m] between two planes or cylinders that look at each other; None where they do not."""
    if one.kind == "plane":
        normal, other = np.array(one.normal), np.array(two.normal)
        if normal @ other > -FACING:
            return None
        return float((np.array(two.centre) - np.array(one.centre)) @ (normal - other) / 2)
    if one.hole == two.hole:
        return None
    hole, shaft = (one, two) if one.hole else (two, one)
    radius = hole.radius or 0.0
    gap = radius - (shaft.radius or 0.0)
    if not hole.line.holds(shaft.line, abs(gap) + ROUND * radius):
        return None
    return 0.0 if abs(gap) < ROUND * radius else gap


def _facing_area(first: Array, second: Array, reach: float) -> float:
    """Area [m2] over which two sets of triangles face each other."""
    points = np.concatenate([first, second]).reshape(-1, 3)
    rows = np.arange(len(points)).reshape(-1, 3)
    cut = overlap(points, (rows[: len(first)],), (rows[len(first) :],), search_distance=reach, degree=1)
    return float(cut.weights.sum())


def _area(corners: Array) -> float:
    """Area [m2] of triangles."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(np.linalg.norm(across, axis=1).sum() / 2)


def shared_volumes(solids: Sequence[Any], names: Sequence[str]) -> list[str]:
    """Which parts have a volume in common, and where."""
    found = []
    for k, one in enumerate(solids):
        for j in range(k):
            (low, high), (bottom, top) = one.bounding_box, solids[j].bounding_box
            if any(a > d or c > b for a, b, c, d in zip(low, high, bottom, top, strict=True)):
                continue
            both = one * solids[j]
            if both.mass > 1e-9 * one.mass:
                low, high = both.bounding_box
                size = " x ".join(f"{b - a:.3g}" for a, b in zip(low, high, strict=True))
                centre = f"({both.center.x:.4g}, {both.center.y:.4g}, {both.center.z:.4g}) mm"
                found.append(f"{names[j]!r} and {names[k]!r} share {size} mm about {centre}")
    return found


def part_distance(path: Path) -> tuple[str, str, float] | None:
    """The two parts of a STEP file that lie nearest to each other, and their distance [m]; None for a single part."""
    return ask_kernel(path, _part_distance)


def _part_distance(path: Path) -> tuple[str, str, float] | None:
    """The same, in a process that has the kernel."""
    cad = read_parts(path)
    pairs = [
        (1e-3 * cad.solids[i].Distance(cad.solids[j]), cad.names[i], cad.names[j])
        for i, j in combinations(range(len(cad.solids)), 2)
    ]
    if not pairs:
        return None
    distance, one, two = min(pairs)
    return one, two, float(distance)
