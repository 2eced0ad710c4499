"""Points that a study names: what each is for, and whether the structure is there."""

from collections.abc import Iterator
from math import pi

import numpy as np

from faying.errors import InputError
from faying.fe.mesh import Mesh
from faying.geometry.face_facts import GeometryFacts
from faying.geometry.mesh_facts import distance_to
from faying.joint.attachments import MAX_DISTANCE, nearest_node, too_far
from faying.study.study import Study
from faying.typing import Array

Point = tuple[float, float, float]


def named_points(study: Study) -> Iterator[tuple[str, str, Point]]:
    """Key, name in messages and place [m] of every point at which a study asks for a node."""
    for k, point in enumerate(study.test.points if study.test else (), 1):
        yield "test.points", f"test.points[{k}]", point
    for k, mass in enumerate(study.masses, 1):
        if mass.point is not None:
            yield f"mass[{k}].point", f"point mass of {mass.mass:g} kg", mass.point
    for k, load in enumerate(study.load_cases, 1):
        for n, force in enumerate(load.forces, 1):
            if force.face is None and force.point is not None:
                yield f"load[{k}].force[{n}].point", f"load {load.name!r}: force", force.point
    for k, one in enumerate(study.vibrations, 1):
        for point in one.points:
            yield f"vibration[{k}].points", f"vibration {one.name!r}: point", point
        if one.force is not None and one.force.face is None and one.force.point is not None:
            yield f"vibration[{k}].point", f"vibration {one.name!r}: force", one.force.point
    if study.response is not None:
        for place, _ in (*study.response.inputs, *study.response.outputs):
            yield "response", "point of the response", place
    if study.backbone is not None and study.backbone.at is not None:
        yield "backbone.at", "point of the backbone", study.backbone.at


def on_structure(what: str, point: Point, where: Mesh | GeometryFacts) -> None:
    """Raise InputError where a structure, meshed or not yet, is farther from a point [m] than `nearest_node` allows.

    Before there is a mesh a point inside a part counts as near, and another one by its distance from the faces.
    """
    if isinstance(where, Mesh):
        nearest_node(where, point, what)
        return
    at = np.array(point)
    distance = distance_to(at, where.corners)
    if distance > MAX_DISTANCE * where.size and not _within(at, where.corners):
        ends = where.corners.reshape(-1, 3)
        raise InputError(too_far(what, point, distance, ends.min(axis=0), ends.max(axis=0)))


def _within(point: Array, corners: Array) -> bool:
    """Whether closed surfaces of triangles (t, 3, 3) go round a point: their solid angles add up to 4 pi each.

    Van Oosterom and Strackee 1983, doi:10.1109/TBME.1983.325207.
    """
    a, b, c = (corners - point).transpose(1, 0, 2)
    la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
    triple = np.einsum("ti,ti->t", a, np.cross(b, c))
    ab, bc, ca = (np.einsum("ti,ti->t", one, other) for one, other in ((a, b), (b, c), (c, a)))
    angles = 2 * np.arctan2(triple, la * lb * lc + ab * lc + bc * la + ca * lb)
    return float(abs(angles.sum())) > 2 * pi
