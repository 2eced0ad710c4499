"""How far the change of a frequency with preload rests on flat faces: the same with a small crown, in a small basis."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying.errors import FayingError
from faying.joint.face_axes import FaceAxes
from faying.joint.form import Form
from faying.joint.joint_law import JointLaw
from faying.joint.reduce import Reduction
from faying.joint.solid_bolt import SolidBolt
from faying.notes import Note
from faying.result.result import preload_slope
from faying.study.case import Case
from faying.study.solve import State
from faying.typing import Array

CROWN = 3e-6  # m, what a ground or finely milled face has of form
TOLERANCE = 1e-5  # of a frequency


@dataclass(frozen=True, kw_only=True)
class FormBand:
    """Change of the frequencies with preload, d f/d preload [Hz/N] (3, m), by a line through all loads.

    crowns: hollow, flat and crowned [m] (3,).
    """

    crowns: Array
    slopes: Array


def form_band(case: Case, states: Sequence[State]) -> tuple[FormBand | None, list[Note]]:
    """Take the slopes with every face crowned and hollow by `CROWN` along its longer side, at no full solution.

    Nothing where a form is given, where there is one load, or where a sweep has no answer either: bolts tightened in
    order, viscous dampers, springs per node. The seats of solid bolts and curved faces stay as they are.
    """
    study, structure = case.study, case.structure
    given = any(joint.form is not None for joint in study.joints)
    apart = study.order is not None or study.modes.damping == "viscous" or any(j.per_node for j in structure.joints)
    if given or apart or len(states) < 2 or not _crowned(case, 0.0):
        return None, []
    last = states[-1]
    reduction = Reduction.about(
        structure,
        factor=last.modes.factorisation,
        reference=(last.modes.factorised + last.modes.shift * structure.vibrating[1]).tocsr(),
        state=last.preload.displacement,
        shapes=last.modes.shapes[:, case.rigid_count :],
        count=study.modes.count,
    )
    laws = [joint.law for joint in structure.joints]
    friction = [joint.friction for joint in structure.joints]
    flat = np.stack([s.damped.frequencies for s in states])
    try:
        rows = [_frequencies(case, reduction, laws, friction, crown) for crown in (-CROWN, CROWN)]
    except FayingError as fault:
        return None, [Note(code="form-band", text=f"no answer for faces crowned by 3 um: {fault}")]
    slopes = np.stack([preload_slope(values, case.loads) for values in (rows[0], flat, rows[1])])
    return FormBand(crowns=np.array([-CROWN, 0.0, CROWN]), slopes=slopes), []


def _crowned(case: Case, crown: float) -> list[Array | None]:
    """Gap [m] (q,) of each joint with a crown on its faces; None where it stays as it is."""
    out: list[Array | None] = []
    structure = case.structure
    bolts = {bolt.part for bolt in structure.bolts if isinstance(bolt, SolidBolt)}
    for joint in structure.joints:
        axes = FaceAxes.of(structure.mesh, joint.faces, joint.interface)
        seat = any(structure.mesh.face_part[face] in bolts for face in joint.faces)
        if seat or not axes.flat:
            out.append(None)
            continue
        form = Form(crown_along=crown)
        laid = form.at(joint.interface.positions, replace(axes, certain=True))  # on a square either way will do
        out.append(joint.interface.gap + laid)
    return out if any(gap is not None for gap in out) else []


def _frequencies(
    case: Case, reduction: Reduction, laws: list[JointLaw], friction: list[float | None], crown: float
) -> Array:
    """Frequencies [Hz] (loads, m) with a crown; the basis is made for the first and the last load."""
    joints = case.structure.joints
    gaps = [
        joint.interface.gap if gap is None else gap for joint, gap in zip(joints, _crowned(case, crown), strict=True)
    ]
    forces = [np.array(case.study.forces(k)) for k in range(len(case.loads))]
    start = None
    for force in (forces[-1], forces[0]):
        start = reduction.train(laws, force, friction, tolerance=TOLERANCE, start=start, gaps=gaps)
    return np.stack([reduction.evaluate(laws, force, friction, start).frequencies for force in forces])
