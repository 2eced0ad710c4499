"""The scene of a STEP file: every face of every solid as the CAD kernel draws it, each with its number."""

from pathlib import Path

import numpy as np

from faying.geometry.face_facts import read_facts
from faying.output.scene.build import face, feature_edges, measures
from faying.output.scene.model import Scene

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
