"""The scene of a STEP file: every face of every solid as the CAD kernel draws it, each with its number."""

from pathlib import Path
from typing import Any

import numpy as np

from faying.fe.cad import check_head, read_parts
from faying.fe.cad_process import Answer, ask
from faying.output.scene.build import face, feature_edges, measures
from faying.output.scene.model import Scene
from faying.typing import Array, Index

CLOSE = 1e-7  # of the size: corners of triangles nearer than this are one


def of_step(path: str | Path) -> Scene:
    """Return the scene of a STEP file, tessellated by the CAD kernel in a process of its own.

    The number of a face is its position, from 1, in `list(solid.faces)` of its solid, before any gluing.

    Raises:
        ReadError: The file cannot be read, also where the CAD kernel dies on it.
    """
    file = Path(path)
    check_head(file)
    answer = ask(tessellate, {"path": str(file.resolve())}, path=file)
    return _scene(file.name, answer.arrays["corners"] * 1e-3, answer.arrays["owner"], answer.facts)


def tessellate(request: dict[str, Any]) -> Answer:
    """Corners of the triangles of a STEP file (t, 3, 3) [mm], the face of each, and the faces; in its own process."""
    read = read_parts(Path(request["path"]))
    found: list[Array] = []
    owner: list[Index] = []
    faces: list[tuple[int, int, str, float, tuple[float, ...]]] = []
    for number, solid in enumerate(read.solids):
        solid._webgui_data()  # the triangles of neighbours then meet at their common edge
        for position, one in enumerate(solid.faces, start=1):
            drawn = one._webgui_data()["Bezier_trig_points"][:3]
            corners = np.array(drawn, dtype=float).reshape(3, -1, 4)[:, :, :3].transpose(1, 0, 2)
            found.append(corners)
            owner.append(np.full(len(corners), len(faces)))
            centre = tuple(1e-3 * getattr(one.center, axis) for axis in "xyz")
            faces.append((number, position, one.name or "", 1e-6 * one.mass, centre))
    arrays = {"corners": np.concatenate(found), "owner": np.concatenate(owner)}
    return Answer(facts={"parts": read.names, "faces": faces}, arrays=arrays)


def _scene(title: str, corners: Array, owner: Index, known: dict[str, Any]) -> Scene:
    """Join the corners that lie in one place on one part, and leave out triangles without area."""
    parts, listed = known["parts"], known["faces"]
    part_of_triangle = np.array([number for number, *_ in listed])[owner]
    size = float(np.linalg.norm(np.ptp(corners.reshape(-1, 3), axis=0)))
    grid = np.rint(corners.reshape(-1, 3) / (CLOSE * size)).astype(np.int64)
    _, first, inverse = np.unique(
        np.column_stack([np.repeat(part_of_triangle, 3), grid]), axis=0, return_index=True, return_inverse=True
    )
    points, triangles = corners.reshape(-1, 3)[first], inverse.reshape(-1, 3).astype(np.int64)
    a, b, c = triangles.T
    whole = (a != b) & (b != c) & (c != a)
    triangles, owner = triangles[whole], owner[whole].astype(np.int64)
    _, _, normal = measures(points, triangles, owner, len(listed))
    faces = [
        face(part, number, name, area, np.array(centre), normal[k])
        for k, (part, number, name, area, centre) in enumerate(listed)
    ]
    return Scene(
        title=title,
        points=points,
        triangles=triangles,
        parts=tuple(parts),
        faces=tuple(faces),
        face_of_triangle=owner,
        edges=feature_edges(points, triangles, owner),
    )
