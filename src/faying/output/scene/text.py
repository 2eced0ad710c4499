"""A scene as text: JSON whose arrays are compressed binary in base64.

    {"format": "faying-scene", "version": 1, "title": ..., "unit": "mm", "factor": 1000.0, "size": 0.41,
     "loads": [4000.0, ...],
     "parts": [{"name": "upper"}, ...],
     "faces": [{"part": 0, "number": 1, "name": "upper.joint", "area": ..., "centre": [x, y, z], "normal": [...]}, ...],
     "joints": [{"name": "flange", "faces": [0, 7], "map": "map0" or null}, ...],
     "bolts": [{"name": "left", "seats": [[x, y, z], [x, y, z]], "diameter": 0.008, "head": 0.012, "meshed": false},
      ...],
     "supports": [{"face": 3, "directions": ["x", "y", "z"], "elastic": false}, ...],
     "masses": [{"mass": 0.2, "point": [x, y, z]}, ...],
     "fields": {"pressure": {"label": "pressure", "unit": "MPa", "factor": 1e-06, "range": [0.0, 1.2e7]}, ...},
     "modes": {"frequencies": [[...], ...], "loss_factors": [[... or null], ...]} or null,
     "arrays": {"points": {"type": "f4", "shape": [n, 3], "scale": 1.0, "data": "..."}, ...}}

Lengths and values are in SI units; "factor" turns metres into "unit", and a field's values into its unit. "range"
spans all loads and joints, so that one colour scale serves all. An array is little-endian, row by row, of type f4
(float), i2, u2 or u4, compressed as zlib (`DecompressionStream("deflate")` in a browser) and written in base64; its
numbers are multiplied by "scale". Names:

- points (n, 3), triangles (t, 3), face_of_triangle (t,), edges (e, 2);
- map0.parents (k, 2), map0.triangles (m, 3), map0.pressure (loads, k), ...: maps of the joints, see `maps`;
- real.L.M and imaginary.L.M (n, 3): the shape of mode M at load L, both from 0. The displacement at a phase is
  cos(phase) real - sin(phase) imaginary. Shapes are rounded to 1/32767 of the greatest component of the mode; an
  imaginary part that vanishes with that is left out. Where shapes would take more than 24 million characters, those of
  the highest modes at the lowest loads are left out.
"""

import json
import zlib
from base64 import b64encode
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from faying.fe.face_map import FaceValues
from faying.result.fields import listed
from faying.typing import Array, Index

UNITS = ((0.5e-3, "µm", 1e6), (2.0, "mm", 1e3), (np.inf, "m", 1.0))  # up to this size of the structure [m]


@dataclass(frozen=True, kw_only=True)
class Face:
    """A face of a part.

    Args:
        part: Part, by its position in `Scene.parts`.
        number: Number within the part, from 1. Of a STEP file: the position in `list(solid.faces)`, before any gluing.
            Of a mesh: the named faces in the order of the mesh, then the smooth regions that have no name.
        name: Its name, empty where it has none.
        area: Area of its triangles [m2].
        centre: Centre of that area (3,) [m].
        normal: Mean unit normal (3,); zero for a closed face, whose normals cancel.
    """

    part: int
    number: int
    name: str
    area: float
    centre: Array
    normal: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class SceneJoint:
    """A joint: its name, its two faces by their position in `Scene.faces`, and the maps on the first of them."""

    name: str
    faces: tuple[int, ...]
    map: FaceValues | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class SceneBolt:
    """A bolt as it is drawn: where its axis meets its seats (2, 3) [m], diameters of shank and head [m].

    A dowel has its ends for seats, and a head of 0.

    meshed: whether it is one of the parts, and so not drawn once more.
    """

    name: str
    seats: Array
    diameter: float
    head: float
    meshed: bool = False


@dataclass(frozen=True, kw_only=True)
class SceneSupport:
    """A face, by its position in `Scene.faces`, the directions in which it is held, and whether by springs."""

    face: int
    directions: tuple[str, ...]
    elastic: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class Mass:
    """A point mass [kg] and its place (3,) [m]."""

    mass: float
    point: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class SceneModes:
    """Complex modes at each load: displacement = cos(phase) real - sin(phase) imaginary.

    Args:
        frequencies: (l, m) [Hz].
        loss_factors: (l, m) [-], NaN where none is predicted.
        real: (l, m, n, 3) [kg^-1/2], at the points of the scene.
        imaginary: Likewise.
    """

    frequencies: Array
    loss_factors: Array
    real: Array
    imaginary: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """A structure to look at.

    Args:
        title: What it is called.
        points: Nodes (n, 3) [m].
        triangles: Triangles (t, 3), normals outwards.
        parts: Names of the parts.
        faces: Faces of the parts; face_of_triangle: the face of each triangle (t,).
        edges: Feature edges (e, 2) between nodes: rims of faces, and sharp bends.
        joints, bolts, supports, masses: Where there are any.
        loads: Preloads of the first bolt [N] (l,); empty before a run.
        modes: Modes at each load; None before a run.
    """

    title: str
    points: Array
    triangles: Index
    parts: tuple[str, ...]
    faces: tuple[Face, ...]
    face_of_triangle: Index
    edges: Index
    joints: tuple[SceneJoint, ...] = ()
    bolts: tuple[SceneBolt, ...] = ()
    supports: tuple[SceneSupport, ...] = ()
    masses: tuple[Mass, ...] = ()
    loads: Array = field(default_factory=lambda: np.zeros(0))
    modes: SceneModes | None = None

    @property
    def unit(self) -> tuple[str, float]:
        """Unit in which lengths are read, and how many of it are in a metre."""
        return next((unit, factor) for most, unit, factor in UNITS if self.size <= most)

    @property
    def size(self) -> float:
        """Diagonal of the box around all nodes [m]."""
        return float(np.linalg.norm(np.ptp(self.points, axis=0)))


VERSION = 1
STEPS = 32767  # of a 16-bit integer on each side of zero
MAX_CHARACTERS = 24e6  # characters of shapes: more is left out


@dataclass(frozen=True, kw_only=True)
class SceneField:
    """A field on the faces of joints: its label, the unit in which it is read, and how many of that are 1 in SI."""

    label: str
    unit: str
    factor: float


FIELDS = {
    "pressure": SceneField(label="pressure", unit="MPa", factor=1e-6),
    "slip": SceneField(label="slip under the preload", unit="µm", factor=1e6),
    "k_n": SceneField(label="normal stiffness k_n", unit="MPa/µm", factor=1e-12),
    "k_t": SceneField(label="tangential stiffness k_t", unit="MPa/µm", factor=1e-12),
    "gap": SceneField(label="gap before any load", unit="µm", factor=1e6),
}


def to_text(scene: Scene) -> str:
    """Return a scene as JSON text; see the top of this module."""
    return json.dumps(to_dict(scene), ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def to_dict(scene: Scene) -> dict[str, Any]:
    """Return a scene as what `to_text` writes."""
    arrays = {
        "points": packed(scene.points, "f4"),
        "triangles": packed(scene.triangles, "u4"),
        "face_of_triangle": packed(scene.face_of_triangle, "u4"),
        "edges": packed(scene.edges, "u4"),
    }
    joints = [_joint(joint, f"map{k}", arrays) for k, joint in enumerate(scene.joints)]
    return {
        "format": "faying-scene",
        "version": VERSION,
        "title": scene.title,
        "unit": scene.unit[0],
        "factor": scene.unit[1],
        "size": scene.size,
        "loads": scene.loads.tolist(),
        "parts": [{"name": name} for name in scene.parts],
        "faces": [vars(f) | {"centre": f.centre.tolist(), "normal": f.normal.tolist()} for f in scene.faces],
        "joints": joints,
        "bolts": [vars(bolt) | {"seats": bolt.seats.tolist()} for bolt in scene.bolts],
        "supports": [vars(support) for support in scene.supports],
        "masses": [vars(mass) | {"point": mass.point.tolist()} for mass in scene.masses],
        "fields": _fields(scene),
        "modes": _modes(scene.modes, arrays),
        "arrays": arrays,
    }


def _joint(joint: SceneJoint, key: str, arrays: dict[str, Any]) -> dict[str, Any]:
    if joint.map is not None:
        arrays[f"{key}.parents"] = packed(joint.map.parents, "u4")
        arrays[f"{key}.triangles"] = packed(joint.map.triangles, "u4")
        for name, values in joint.map.fields.items():
            arrays[f"{key}.{name}"] = packed(values, "f4")
    return {"name": joint.name, "faces": list(joint.faces), "map": None if joint.map is None else key}


def _fields(scene: Scene) -> dict[str, Any]:
    """The fields that any joint has, each with its range over all joints and loads."""
    out: dict[str, Any] = {}
    for name, known in FIELDS.items():
        values = [j.map.fields[name] for j in scene.joints if j.map is not None and name in j.map.fields]
        if values:
            low, high = min(float(v.min()) for v in values), max(float(v.max()) for v in values)
            out[name] = vars(known) | {"range": [min(low, 0.0), high]}
    return out


def _modes(modes: SceneModes | None, arrays: dict[str, Any]) -> dict[str, Any] | None:
    if modes is None:
        return None
    loads, count = modes.frequencies.shape
    room = MAX_CHARACTERS
    for load, mode in ((k, j) for k in reversed(range(loads)) for j in range(count)):
        if room <= 0:
            break
        real = np.asarray(modes.real[load, mode])
        imaginary = np.asarray(modes.imaginary[load, mode])
        greatest = float(max(np.abs(real).max(), np.abs(imaginary).max()))
        scale = greatest / STEPS or 1.0
        arrays[f"real.{load}.{mode}"] = packed(real, "i2", scale)
        if float(np.abs(imaginary).max()) >= scale / 2:
            arrays[f"imaginary.{load}.{mode}"] = packed(imaginary, "i2", scale)
        kept = (arrays.get(f"{part}.{load}.{mode}") for part in ("real", "imaginary"))
        room -= sum(len(one["data"]) for one in kept if one is not None)
    return {"frequencies": modes.frequencies.tolist(), "loss_factors": listed(modes.loss_factors)}


def packed(values: Any, kind: str, scale: float = 1.0) -> dict[str, Any]:
    """An array as JSON holds it."""
    array: Array = np.asarray(values)
    if kind == "i2":
        array = np.rint(array / scale)
    small = np.ascontiguousarray(array, dtype=f"<{kind}")
    data = b64encode(zlib.compress(small.tobytes(), 6)).decode("ascii")
    return {"type": kind, "shape": list(small.shape), "scale": scale, "data": data}


def packed_backbones(
    title: str, acceleration: Array, curves: dict[str, tuple[Array, Array]], marked: str = ""
) -> dict[str, Any]:
    """Frequencies [Hz] and damping ratios [%] over accelerations [m/s2] (k,) by their names, for `report.js`.

    marked: name of the one that is drawn as points.
    """
    return {
        "title": title,
        "names": list(curves),
        "marked": marked,
        "acceleration": packed(acceleration, "f4"),
        "frequency": packed(np.stack([frequency for frequency, _ in curves.values()]), "f4"),
        "damping": packed(np.stack([damping for _, damping in curves.values()]), "f4"),
    }


def packed_curves(title: str, label: str, frequencies: Array, curves: dict[str, Any]) -> dict[str, Any]:
    """Complex curves over frequency [Hz] (f,) by their names, as `report.js` draws them; label: of their size."""
    both = np.stack([[values.real, values.imag] for values in curves.values()])  # curve, part, line
    return {
        "title": title,
        "label": label,
        "names": list(curves),
        "frequencies": packed(frequencies, "f4"),
        "values": packed(both, "f4"),
    }
