"""What the viewer shows, as compact arrays."""

from dataclasses import dataclass, field

import numpy as np

from faying.fe.face_map import FaceValues
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
        imaginary: Likewise, None where the modes are real.
    """

    frequencies: Array
    loss_factors: Array
    real: Array
    imaginary: Array | None


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
