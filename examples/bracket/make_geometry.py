"""Write bracket.step: a bracket of 10 mm on a base of 20 mm, two M8 through both, with named solids and faces.

Holes are those of ISO 273, medium; seats those of the washers of ISO 7089.
"""

import math
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
HOLE, WASHER = 9.0, 16.0  # mm
PLACES = {"left": (-6.0, -16.0), "right": (-6.0, 16.0)}
FOOT, THICK, BASE, HIGH, LONG = 60.0, 10.0, 20.0, 80.0, 140.0


def drilled(solid: Any, low: float, high: float, seat: float, up: bool) -> Any:
    """The solid with both holes along z, and at the height `seat` the rings that the washers press on."""
    from netgen.occ import Axes, Cylinder, Glue, WorkPlane, X, Z

    for x, y in PLACES.values():
        solid = solid - Cylinder((x, y, low - 1), Z, r=HOLE / 2, h=high - low + 2)
    for x, y in PLACES.values():
        ring = WorkPlane(Axes((x, y, seat), n=Z if up else -Z, h=X)).Circle(WASHER / 2).Face()
        solid = Glue([solid, ring]).solids[0]
    return solid


def named(solid: Any, name: str, seat: float) -> Any:
    """Name seats, joint, ends and top by where they lie."""
    ring = math.pi / 4 * (WASHER**2 - HOLE**2)
    joint = FOOT**2 - 2 * math.pi / 4 * HOLE**2
    for face in solid.faces:
        face.name, centre = "", face.center
        if abs(centre.z - seat) < 1e-6 and abs(face.mass / ring - 1) < 1e-3:
            near = min(PLACES, key=lambda key: math.dist(PLACES[key], (centre.x, centre.y)))
            face.name = f"{name}.seat.{near}"
        elif abs(centre.z) < 1e-6 and abs(face.mass / joint - 1) < 1e-3:
            face.name = f"{name}.joint"
        elif abs(abs(centre.x) - LONG / 2) < 1e-6:
            face.name = f"{name}.{'left' if centre.x < 0 else 'right'}"
        elif abs(centre.z - HIGH) < 1e-6:
            face.name = f"{name}.top"
    solid.name = name
    return solid


def main() -> None:
    """Write the file beside this one."""
    from netgen.occ import Axes, Box, Compound, Glue, WorkPlane, X, Z

    half = FOOT / 2
    bracket = Box((-half, -half, 0), (half, half, THICK)) + Box((half - THICK, -half, 0), (half, half, HIGH))
    base = Box((-LONG / 2, -half, -BASE), (LONG / 2, half, 0))
    patch = WorkPlane(Axes((0, 0, 0), n=Z, h=X)).RectangleC(FOOT, FOOT).Face()
    base = Glue([base, patch]).solids[0]
    bracket = named(drilled(bracket, 0, THICK, THICK, up=True), "bracket", THICK)
    base = named(drilled(base, -BASE, 0, -BASE, up=False), "base", -BASE)
    Compound([bracket, base]).WriteStep(str(HERE / "bracket.step"))


if __name__ == "__main__":
    main()
