"""Write blocks-and-bolt.step: two blocks with a clearance hole and the M8 bolt that holds them, head, shank and nut.

python make_geometry.py
"""

from pathlib import Path

from netgen.occ import Axes, Axis, Box, Compound, Cylinder, Glue, WorkPlane, X, Z

LENGTH, WIDTH, THICK = 80, 30, 15  # of a block [mm]
HOLE, SHANK, HEAD, SEAT = 4.5, 4.0, 6.5, 8.0  # radii
HIGH, NUT = 5.3, 6.8  # of head and nut


def block(name):
    """A block on z = 0 with its hole and the seat of a head, a ring on its far side."""
    solid = Box((-LENGTH / 2, -WIDTH / 2, 0), (LENGTH / 2, WIDTH / 2, THICK)) - Cylinder(
        (0, 0, -1), Z, r=HOLE, h=THICK + 2
    )
    ring = WorkPlane(Axes((0, 0, THICK), n=Z, h=X)).Circle(SEAT).Face()
    solid = Glue([solid, ring]).solids[0]
    for face in solid.faces:
        face.name = ""
        if abs(face.center.z) < 1e-9:
            face.name = f"{name}.joint"
        elif abs(face.center.z - THICK) < 1e-9 and face.mass < 300:
            face.name = f"{name}.seat"
    solid.name = name
    return solid


def bolt():
    """Head on top, nut below, and the shank between them through both blocks."""
    solid = (
        Cylinder((0, 0, -THICK - NUT), Z, r=HEAD, h=NUT)
        + Cylinder((0, 0, -THICK), Z, r=SHANK, h=2 * THICK)
        + Cylinder((0, 0, THICK), Z, r=HEAD, h=HIGH)
    )
    for face in solid.faces:
        face.name = ""
        for name, height in (("bolt.head", THICK), ("bolt.nut", -THICK)):
            if abs(face.center.z - height) < 1e-9 and face.mass < 120:
                face.name = name
    solid.name = "bolt"
    return solid


if __name__ == "__main__":
    upper, lower = block("upper"), block("lower").Rotate(Axis((0, 0, 0), X), 180)
    lower.name = "lower"
    Compound([upper, lower, bolt()]).WriteStep(str(Path(__file__).with_name("blocks-and-bolt.step")))
