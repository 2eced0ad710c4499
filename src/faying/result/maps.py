"""Maps of a result on the faces of its joints."""

import numpy as np

from faying.fe.face_map import FaceValues, joint_map
from faying.result.run_record import RunRecord


def joint_map_of(result: RunRecord, joint: int, *, contact: bool = False) -> FaceValues | None:
    """Values on the first face of a joint; None where the result does not say which triangles those are.

    contact: whether the share of the area around each place that carries pressure is one of them.
    """
    if result.face_of_triangle is None or joint >= len(result.joint_faces):
        return None
    name = result.joint_faces[joint][0]
    if name not in result.faces:
        return None
    at, here = result.joint_of_point == joint, result.face_of_triangle == result.faces.index(name)
    if not np.any(here) or not np.any(at):
        return None
    fields = {"pressure": result.pressure, "k_n": result.k_n, "k_t": result.k_t, "slip": result.slip}
    values = {name: rows[:, at] for name, rows in fields.items() if rows is not None}
    if result.gap is not None and np.ptp(result.gap) > 1e-9 * float(np.ptp(result.outline)):
        values["gap"] = result.gap[None, at]
    if contact:
        values["contact"] = (result.pressure[:, at] > 0).astype(float)
    return joint_map(result.outline, result.triangles[here], result.points[at], result.weights[at], values)
