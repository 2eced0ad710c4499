"""Write t-specimen.step: two T-shaped parts bolted flange to flange, stems in line, with named solids and faces.

The published text gives no dimensions. Those below come from identify.py: least squares within bounds on the test
frequencies at 4 and 8 kN, together with the form of the flanges in study.toml. What the frequencies cannot tell
(width, bolts) is a plain choice, marked as such.
"""

from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent


@dataclass(frozen=True)
class Dimensions:
    """Dimensions [mm]. Stems and flanges have one width; bending in the test is across the thin side of the stems."""

    stem_height: float = 364.7
    stem_thickness: float = 51.2
    flange_length: float = 118.8
    flange_thickness: float = 26.6
    width: float = 60.0  # chosen
    bolt_distance: float = 85.0  # chosen: the bolts in the middle of what the flange stands out
    hole: float = 9.0  # clearance hole of an M8 bolt, ISO 273
    washer: float = 16.0  # outer diameter of an M8 washer, ISO 7089


def write(path: Path, d: Dimensions) -> None:
    """Write both parts to a STEP file."""
    from netgen.occ import Axes, Axis, Box, Compound, Cylinder, Glue, WorkPlane, X, Y, Z, gp_Vec  # noqa: F401

    def tee(name: str) -> object:
        flange = Box((-d.flange_length / 2, -d.width / 2, 0), (d.flange_length / 2, d.width / 2, d.flange_thickness))
        top = d.flange_thickness + d.stem_height
        stem = Box((-d.stem_thickness / 2, -d.width / 2, 0), (d.stem_thickness / 2, d.width / 2, top))
        solid = flange + stem
        for x in (-d.bolt_distance / 2, d.bolt_distance / 2):
            solid = solid - Cylinder((x, 0, -1), Z, r=d.hole / 2, h=d.flange_thickness + 2)
        for x in (-d.bolt_distance / 2, d.bolt_distance / 2):
            ring = WorkPlane(Axes((x, 0, d.flange_thickness), n=Z, h=X)).Circle(d.washer / 2).Face()
            solid = Glue([solid, ring]).solids[0]
        for face in solid.faces:
            face.name = ""
            centre = face.center
            if abs(centre.z) < 1e-9:
                face.name = f"{name}.joint"
            elif abs(centre.z - d.flange_thickness) < 1e-9 and face.mass < 3.2 * (d.washer / 2) ** 2:
                face.name = f"{name}.seat.{'left' if centre.x < 0 else 'right'}"
            elif abs(centre.z - top) < 1e-9:
                face.name = f"{name}.end"
        solid.name = name
        return solid

    upper = tee("upper")
    lower = tee("lower").Rotate(Axis((0, 0, 0), X), 180)
    lower.name = "lower"
    Compound([upper, lower]).WriteStep(str(path))


if __name__ == "__main__":
    write(HERE / "t-specimen.step", Dimensions())
