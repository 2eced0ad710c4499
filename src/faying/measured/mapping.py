"""Points of a test on a model: a rigid transformation, given or fitted, and the nearest place."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from faying.columns import read_columns
from faying.errors import InputError, ReadError
from faying.geometry.mesh_facts import nearest_places
from faying.measured.frf import Position
from faying.typing import Array, Index

SAME_PLACE = 1e-7  # of the size of a model: nodes nearer than that are those of two parts that meet


@dataclass(frozen=True, kw_only=True)
class Transform:
    """x_model = rotation @ x_test + shift [m]; rms [m]: what a fit left of the distances between the pairs."""

    rotation: Array = field(default_factory=lambda: np.eye(3))
    shift: Array = field(default_factory=lambda: np.zeros(3))
    rms: float = 0.0

    def __post_init__(self) -> None:
        r = np.asarray(self.rotation, float)
        if r.shape != (3, 3) or not np.allclose(r @ r.T, np.eye(3), atol=1e-6) or np.linalg.det(r) < 0:
            raise InputError(
                f"rotation {r.tolist()} is not a rotation: rows of length 1, at right angles, right-handed; scale and "
                "mirror nothing"
            )

    def points(self, positions: Any) -> Array:
        """Positions (..., 3) of the test in the frame of the model."""
        return np.asarray(np.asarray(positions, float) @ self.rotation.T + self.shift)

    def directions(self, axes: Any) -> Array:
        """Directions (..., 3) of the test in the frame of the model."""
        return np.asarray(np.asarray(axes, float) @ self.rotation.T)


def fit_transform(test: Any, model: Any) -> Transform:
    """The rigid transformation that carries test points (k, 3) onto model points (k, 3) best, k of 3 or more.

    Least squares by singular values (Arun, Huang and Blostein 1987, doi:10.1109/TPAMI.1987.4767965; proper rotation
    after Umeyama 1991, doi:10.1109/34.88573). Raises InputError for fewer than three pairs or pairs on one line, and
    where the fit leaves more than a tenth of the points' spread: a mirrored frame, a wrong unit or a wrong pair.
    """
    from scipy.spatial.transform import Rotation

    a, b = np.asarray(test, float), np.asarray(model, float)
    if a.shape != b.shape or a.ndim != 2 or a.shape[1:] != (3,) or len(a) < 3:
        raise InputError(
            f"points of the shapes {a.shape} and {b.shape}; give three pairs or more, each x, y, z in both frames"
        )
    a0, b0 = a - a.mean(axis=0), b - b.mean(axis=0)
    spread = np.linalg.svd(a0, compute_uv=False)
    if spread[1] < 1e-3 * spread[0] or spread[0] == 0:
        raise InputError(
            "the points of the pairs are on one line, about which the test can turn; add one off that line"
        )
    rotation = np.asarray(Rotation.align_vectors(b0, a0)[0].as_matrix())
    shift = b.mean(axis=0) - rotation @ a.mean(axis=0)
    rms = float(np.sqrt(np.mean(np.sum((a @ rotation.T + shift - b) ** 2, axis=1))))
    ratio = np.linalg.norm(b0) / np.linalg.norm(a0)
    if rms > 0.1 * np.linalg.norm(b0) / np.sqrt(len(b)):
        raise InputError(
            f"no rigid motion carries the test's points onto the model's: {rms * 1e3:.3g} mm remain and the sizes "
            f"are as 1 to {ratio:.4g}. Check the pairs, the unit of length, and that neither frame is "
            "left-handed"
        )
    return Transform(rotation=rotation, shift=shift, rms=rms)


@dataclass(frozen=True, kw_only=True)
class PointMap:
    """Where the points of a test lie on a model.

    nodes: point -> nearest node; corners, weights: point -> three nodes and their weights, between which the model's
    motion is interpolated there; distance: point -> distance from the model [m]; missing: points too far from it;
    seams: points whose node lies on one of another part, which moves otherwise.
    """

    nodes: Mapping[int, int]
    corners: Mapping[int, tuple[int, int, int]]
    weights: Mapping[int, tuple[float, float, float]]
    distance: Mapping[int, float]
    missing: Mapping[int, float]
    transform: Transform
    tolerance: float
    seams: tuple[int, ...] = ()


def map_points(
    positions: Mapping[int, Position],
    nodes: Any,
    *,
    triangles: Any = (),
    transform: Transform | None = None,
    tolerance: float | None = None,
) -> PointMap:
    """Find where each point lies on the nodes (n, 3) [m] and the triangles (t, 3) between them.

    The distance counts from the nearest place on a triangle, or node. A point farther away than `tolerance` [m]
    (default: 2 % of the model's diagonal) is listed as missing with its distance. Raises InputError where no point is
    near enough.
    """
    from scipy.spatial import KDTree

    transform = transform or Transform()
    cloud = np.asarray(nodes, float)
    size = float(np.linalg.norm(np.ptp(cloud, axis=0)))
    limit = 0.02 * size if tolerance is None else tolerance
    if not limit > 0:
        raise InputError(f"tolerance = {limit}: the distance allowed between point and model must be positive")
    if not positions:
        raise InputError(
            "the test states no positions of its points; give them in a table: --points points.csv (point,x [mm],"
            "y [mm],z [mm])"
        )
    labels = list(positions)
    there = transform.points([positions[k] for k in labels])
    tree = KDTree(cloud)
    nearest = tree.query(there)[1]
    corners, weights = _on_triangles(there, cloud, nearest, np.asarray(triangles, np.int64).reshape(-1, 3))
    distance = np.linalg.norm(np.einsum("pc,pcx->px", weights, cloud[corners]) - there, axis=1)
    here = distance <= limit
    if not here.any():
        own = float(np.linalg.norm(np.ptp(there, axis=0)))
        raise InputError(
            f"no point of the test is within {limit * 1e3:.3g} mm of the model; the nearest is "
            f"{distance.min() * 1e3:.3g} mm away. The test spans {own:.3g} m, the model {size:.3g} m: check the unit "
            "(--length-unit), give the frame (--frame pairs.csv), or raise the tolerance"
        )
    kept = np.flatnonzero(here)
    return PointMap(
        nodes={labels[k]: int(nearest[k]) for k in kept},
        corners={labels[k]: tuple(corners[k].tolist()) for k in kept},
        weights={labels[k]: tuple(weights[k].tolist()) for k in kept},
        distance={labels[k]: float(distance[k]) for k in kept},
        missing={labels[k]: float(distance[k]) for k in np.flatnonzero(~here)},
        transform=transform,
        tolerance=limit,
        seams=tuple(labels[k] for k in kept if len(tree.query_ball_point(cloud[nearest[k]], SAME_PLACE * size)) > 1),
    )


def _on_triangles(points: Array, cloud: Array, nearest: Index, triangles: Index) -> tuple[Index, Array]:
    """Three nodes and their weights for each point: the nearest place on a triangle, or the nearest node alone."""
    corners = np.repeat(nearest[:, None], 3, axis=1)
    weights = np.tile([1.0, 0.0, 0.0], (len(points), 1))
    if not len(triangles):
        return corners, weights
    abc = cloud[triangles]
    middle = abc.mean(axis=1)
    radius = np.linalg.norm(abc - middle[:, None], axis=2).max(axis=1)
    for k, point in enumerate(points):
        best = float(np.linalg.norm(cloud[nearest[k]] - point))
        near = np.flatnonzero(np.linalg.norm(middle - point, axis=1) - radius < best)
        if not len(near):
            continue
        share, distance = nearest_places(point, abc[near])
        found = int(np.argmin(distance))
        if distance[found] < best - 1e-9 * float(radius[near[found]]):
            corners[k], weights[k] = triangles[near[found]], share[found]
    return corners, weights


POINTS = "give a CSV table point,x [mm],y [mm],z [mm]"


def read_points(path: str | Path) -> dict[int, Position]:
    """Read a table of points with a heading that states the units: point,x [mm],y [mm],z [mm]. Positions in [m].

    Raises ReadError where the file is not such a table or a point appears twice.
    """
    file = Path(path)
    table = read_columns(
        file, {"point": "", **dict.fromkeys("xyz", "m")}, needed=("point", *"xyz"), form=POINTS, examples={"m": "mm"}
    )
    if not table.lines:
        raise ReadError(f"{file}: no points under its heading; {POINTS}")
    out: dict[int, Position] = {}
    for k, (label, *place) in enumerate(zip(*(table.values[name] for name in ("point", *"xyz")), strict=True)):
        if label != int(label) or abs(label) > 2**53:
            raise ReadError(
                f"{file}, line {table.lines[k]}: {label:g} is not a point number; give a whole number; {POINTS}"
            )
        if int(label) in out:
            raise ReadError(f"{file}: point {int(label)} appears twice; give each point once")
        x, y, z = (float(v) for v in place)
        out[int(label)] = (x, y, z)
    return out
