"""Maps of a result on the faces of its joints."""

import numpy as np

from faying.fe.face_map import FaceValues, joint_map
from faying.result.run_record import RunRecord


def joint_map_of(result: RunRecord, joint: int, *, contact: bool = False) -> FaceValues | None:
    """Values where the faces of a joint touch; None where all their triangles belong to other faces too.

    contact: whether the share of the area around each place that carries pressure is one of them.
    """
    known = [name for name in result.joint_faces[joint] if name in result.faces]
    faces = [result.triangles[result.face_of_triangle == result.faces.index(name)] for name in known]
    faces = [face for face in faces if len(face)]  # a triangle on several faces is given to one of them
    at = result.joint_of_point == joint
    if not faces or not np.any(at):
        return None
    fields = {"pressure": result.pressure, "k_n": result.k_n, "k_t": result.k_t, "slip": result.slip}
    values = {name: rows[:, at] for name, rows in fields.items()}
    if np.ptp(result.gap) > 1e-9 * float(np.ptp(result.outline)):
        values["gap"] = result.gap[None, at]
    if contact:
        values["contact"] = (result.pressure[:, at] > 0).astype(float)
    return joint_map(result.outline, faces, result.points[at], result.weights[at], values)
