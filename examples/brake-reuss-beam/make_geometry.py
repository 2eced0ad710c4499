"""Write brake-reuss-beam.step: two halves of a steel beam in a lap joint with three bolts, solids and faces named.

Length, section and bolts are those of the beam; the length of the lap, the holes and their distance are those of the
published processing of its scans (github tmd-lab/microslip-rough-contact, SURFACE/asp_id_ltw2.m: half length 60.706 mm,
holes 0.332 in wide, 1.188 in apart). The joint's area comes out at 2916 mm2; the published mesh has 2921 mm2.
"""

from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent
INCH = 25.4


@dataclass(frozen=True)
class Dimensions:
    """Dimensions [mm]: x along the beam, z along the bolts, the joint in the plane z = 0, its middle at the origin."""

    length: float = 720.0
    width: float = INCH
    height: float = INCH
    lap: float = 2 * 60.706
    hole: float = 0.332 * INCH
    pitch: float = 1.188 * INCH
    washer: float = 11 / 16 * INCH  # outer diameter of a plain 5/16 in washer, ASME B18.21.1, SAE series


def write(path: Path, d: Dimensions) -> None:
    """Write both halves to a STEP file."""
    from netgen.occ import Axes, Axis, Box, Compound, Cylinder, Glue, WorkPlane, X, Y, Z, gp_Vec  # noqa: F401

    def half() -> object:
        w, h, end = d.width / 2, d.height / 2, d.lap / 2
        solid = Box((-d.length / 2, -w, -h), (-end, w, h)) + Box((-d.length / 2, -w, -h), (end, w, 0))
        places = {"outer": -d.pitch, "middle": 0.0, "inner": d.pitch}  # inner: next to the other half's full section
        for x in places.values():
            solid = solid - Cylinder((x, 0, -h - 1), Z, r=d.hole / 2, h=h + 2)
        for x in places.values():
            ring = WorkPlane(Axes((x, 0, -h), n=Z, h=X)).Circle(d.washer / 2).Face()
            solid = Glue([solid, ring]).solids[0]
        return solid

    def named(solid: object, name: str, side: float) -> object:
        for face in solid.faces:
            face.name = ""
            centre = face.center
            if abs(centre.z) < 1e-9 and face.mass > 0.9 * d.lap * d.width:
                face.name = f"{name}.joint"
            elif abs(abs(centre.z) - d.height / 2) < 1e-9 and face.mass < 3.2 * (d.washer / 2) ** 2:
                bolt = {-1: "left", 0: "middle", 1: "right"}[round(centre.x / d.pitch)]
                face.name = f"{name}.seat.{bolt}"
            elif abs(centre.x - side * d.length / 2) < 1e-9:
                face.name = f"{name}.end"
        solid.name = name
        return solid

    left = named(half(), "left", -1.0)
    right = named(half().Rotate(Axis((0, 0, 0), Y), 180), "right", 1.0)
    Compound([left, right]).WriteStep(str(path))


if __name__ == "__main__":
    write(HERE / "brake-reuss-beam.step", Dimensions())
