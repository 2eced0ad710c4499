"""Points of a test to nodes of a model: a rigid transformation, given or fitted, and the nearest node."""

import csv
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import InputError, ReadError
from faying.files import refuse_decimal_comma
from faying.measured.frf import Position
from faying.typing import Array
from faying.units import scale


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
                f"rotation {r.tolist()} is no rotation: rows of length 1, at right angles, right-handed; scale and "
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
    a, b = np.asarray(test, float), np.asarray(model, float)
    if a.shape != b.shape or a.ndim != 2 or a.shape[1:] != (3,) or len(a) < 3:
        raise InputError(
            f"points of the shapes {a.shape} and {b.shape}; give three pairs or more, each x, y, z in both frames"
        )
    a0, b0 = a - a.mean(axis=0), b - b.mean(axis=0)
    spread = np.linalg.svd(a0, compute_uv=False)
    if spread[1] < 1e-3 * spread[0] or spread[0] == 0:
        raise InputError(
            "the points of the pairs lie on one line, about which the test may be turned at will; add one off that line"
        )
    u, _, vt = np.linalg.svd(a0.T @ b0)
    flip = np.diag([1.0, 1.0, np.sign(np.linalg.det(vt.T @ u.T))])
    rotation = vt.T @ flip @ u.T
    shift = b.mean(axis=0) - rotation @ a.mean(axis=0)
    rms = float(np.sqrt(np.mean(np.sum((a @ rotation.T + shift - b) ** 2, axis=1))))
    ratio = np.linalg.norm(b0) / np.linalg.norm(a0)
    if rms > 0.1 * np.linalg.norm(b0) / np.sqrt(len(b)):
        raise InputError(
            f"no rigid motion carries the test's points onto the model's: {rms * 1e3:.3g} mm remain and the sizes "
            f"stand as 1 to {ratio:.4g}. Check the pairs, the unit of length, and that neither frame is "
            "left-handed"
        )
    return Transform(rotation=rotation, shift=shift, rms=rms)


@dataclass(frozen=True, kw_only=True)
class PointMap:
    """Where the points of a test lie. nodes: point -> nearest node; distance: point -> [m]; missing: points without."""

    nodes: Mapping[int, int]
    distance: Mapping[int, float]
    missing: Mapping[int, float]
    transform: Transform
    tolerance: float


def map_points(
    positions: Mapping[int, Position], nodes: Any, *, transform: Transform | None = None, tolerance: float | None = None
) -> PointMap:
    """Find the nearest node (n, 3) [m] of each point, within tolerance [m] (default: 2 % of the model's diagonal).

    Points farther away are listed as missing with their distance. Raises InputError where no point finds a node.
    """
    from scipy.spatial import KDTree

    transform = transform or Transform()
    cloud = np.asarray(nodes, float)
    size = float(np.linalg.norm(np.ptp(cloud, axis=0)))
    limit = 0.02 * size if tolerance is None else tolerance
    if not limit > 0:
        raise InputError(f"tolerance = {limit}: the distance allowed between point and node must be positive")
    if not positions:
        raise InputError(
            "the test states no positions of its points; give them in a table: --points points.csv (point,x [mm],"
            "y [mm],z [mm])"
        )
    labels = list(positions)
    there = transform.points([positions[k] for k in labels])
    distance, nearest = KDTree(cloud).query(there)
    here = distance <= limit
    if not here.any():
        own = float(np.linalg.norm(np.ptp(there, axis=0)))
        raise InputError(
            f"no point of the test lies within {limit * 1e3:.3g} mm of the model; the nearest is "
            f"{distance.min() * 1e3:.3g} mm away. The test spans {own:.3g} m, the model {size:.3g} m: check the unit "
            "(--length-unit), give the frame (--frame pairs.csv), or raise the tolerance"
        )
    return PointMap(
        nodes={k: int(n) for k, n, ok in zip(labels, nearest, here, strict=True) if ok},
        distance={k: float(d) for k, d, ok in zip(labels, distance, here, strict=True) if ok},
        missing={k: float(d) for k, d, ok in zip(labels, distance, here, strict=True) if not ok},
        transform=transform,
        tolerance=limit,
    )


def read_points(path: str | Path) -> dict[int, Position]:
    """Read a table of points with a heading that states the unit: point,x [mm],y [mm],z [mm]. Positions in [m].

    Raises ReadError where the file is no such table or a point stands twice.
    """
    file = Path(path)
    try:
        text = file.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as fault:
        raise ReadError(f"{file}: cannot be read ({fault}); give a CSV table point,x [mm],y [mm],z [mm]") from None
    for number, line in enumerate(text.splitlines(), 1):
        refuse_decimal_comma(line, f"{file}, line {number}")
    rows = [[c.strip() for c in row] for row in csv.reader(text.splitlines()) if any(row)]
    units = re.findall(r"\[([^\]]+)\]", ",".join(rows[0])) if rows else []
    if len(units) != 3 or len(set(units)) > 1:
        raise ReadError(f"{file}: its first line states no unit of length; begin with: point,x [mm],y [mm],z [mm]")
    metre = scale(units[0], "m", name=f"{file}, heading")
    out: dict[int, Position] = {}
    for row in rows[1:]:
        try:
            label, x, y, z = int(row[0]), *(float(c) * metre for c in row[1:])
        except ValueError:
            raise ReadError(f"{file}: {','.join(row)} is not a point number and three lengths: point,x,y,z") from None
        if not all(isfinite(v) for v in (x, y, z)):
            raise ReadError(f"{file}: {','.join(row)} has a coordinate that is not finite; measure that point again")
        if label in out:
            raise ReadError(f"{file}: point {label} stands twice; give each point once")
        out[label] = (x, y, z)
    if not out:
        raise ReadError(f"{file}: no points under its heading; give a CSV table point,x [mm],y [mm],z [mm]")
    return out
