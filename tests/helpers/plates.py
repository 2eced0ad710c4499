"""Two plates on each other, pulled together by bolts: what the tests of bolts and friction share."""

import numpy as np

import faying
from faying.fe.interface import join
from faying.fe.mesh import Mesh
from faying.joint.joint import FittedJoint
from faying.joint.joint_law import JointLaw
from faying.joint.structure import Structure
from tests.helpers.boxes import block
from tests.helpers.sides import sides_on

STEEL = faying.CATALOGUE["45 steel"]
LAW = faying.JK(D=2.39, G=1.53e-10, pair=faying.ContactPair(STEEL, STEEL), scan_area=16e-6)


def stacked(counts=(4, 2, 1), size=(0.08, 0.04, 0.01), gap=0.0, kind="hex20"):
    """Plates one on the other along z: parts low and high; faces low.top, high.bottom, low.bottom, high.top, ends."""
    points, parts, faces, owner, offset = [], {}, {}, {}, 0
    for name, height in (("low", 0.0), ("high", size[2] + gap)):
        where, cells = block(kind, counts, size, (0.0, 0.0, height))
        parts[name] = cells + offset
        for side, axis, place in (
            ("bottom", 2, height),
            ("top", 2, height + size[2]),
            ("left", 0, 0.0),
            ("right", 0, size[0]),
        ):
            chosen = np.flatnonzero(np.abs(where[:, axis] - place) < 1e-9)
            faces[f"{name}.{side}"] = tuple(f + offset for f in sides_on(chosen, (cells,), len(where)))
            owner[f"{name}.{side}"] = name
        points.append(where)
        offset += len(where)
    return Mesh(points=np.concatenate(points), parts=parts, faces=faces, face_part=owner)


def plates(mesh=None, material=STEEL, bolts=(), law=LAW, friction=None, **changes):
    """The structure of two plates; changes go to Structure."""
    mesh = stacked() if mesh is None else mesh
    joint = FittedJoint(
        name="j",
        faces=("low.top", "high.bottom"),
        interface=join(mesh, "low.top", "high.bottom"),
        law=JointLaw(model=law),
        friction=friction,
    )
    return Structure(mesh=mesh, materials=dict.fromkeys(mesh.parts, material), joints=(joint,), bolts=bolts, **changes)
