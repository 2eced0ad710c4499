"""Write three bolted joints as STEP files with named solids and faces.

- sheets.step: two sheets of 3 mm, lapped over 30 mm, one M6.
- plates.step: two plates of 10 mm, lapped over 60 mm, two M8.
- flanges.step: two tubes with flanges of 20 mm, four M12.

Holes are those of ISO 273, medium; seats those of the washers of ISO 7089.
"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent


@dataclass(frozen=True)
class Size:
    """Clearance hole and washer [mm] of a bolt."""

    hole: float
    washer: float


M6, M8, M12 = Size(6.6, 12.0), Size(9.0, 16.0), Size(13.5, 24.0)


def drilled(solid: Any, places: dict[str, tuple[float, float]], bottom: float, top: float, bolt: Size) -> Any:
    """The solid with holes along z, and on its top the rings that the washers press on."""
    from netgen.occ import Axes, Cylinder, Glue, WorkPlane, X, Z

    for x, y in places.values():
        solid = solid - Cylinder((x, y, bottom - 1), Z, r=bolt.hole / 2, h=top - bottom + 2)
    for x, y in places.values():
        ring = WorkPlane(Axes((x, y, top), n=Z, h=X)).Circle(bolt.washer / 2).Face()
        solid = Glue([solid, ring]).solids[0]
    return solid


def named(solid: Any, name: str, places: dict[str, tuple[float, float]], top: float, bolt: Size, area: float) -> Any:
    """Name the seats of the bolts, and the joint: the face of that area [mm2] in the plane z = 0."""
    ring = math.pi / 4 * (bolt.washer**2 - bolt.hole**2)
    for face in solid.faces:
        face.name, centre = "", face.center
        if abs(centre.z - top) < 1e-6 and abs(face.mass / ring - 1) < 1e-3:
            near = min(places, key=lambda key: math.dist(places[key], (centre.x, centre.y)))
            face.name = f"{name}.seat.{near}"
        elif abs(centre.z) < 1e-6 and abs(face.mass / area - 1) < 1e-3:
            face.name = f"{name}.joint"
    solid.name = name
    return solid


def lap(path: Path, *, length: float, width: float, thick: float, over: float, places: Any, bolt: Size) -> None:
    """Two plates [mm] lapped over `over`; the upper one ends at x = over/2, the lower one at -over/2."""
    from netgen.occ import Axes, Axis, Box, Compound, Glue, WorkPlane, X, Y, Z

    area = over * width - len(places) * math.pi / 4 * bolt.hole**2

    def plate(name: str) -> Any:
        solid = Box((over / 2 - length, -width / 2, 0), (over / 2, width / 2, thick))
        patch = WorkPlane(Axes((0, 0, 0), n=Z, h=X)).RectangleC(over, width).Face()
        solid = drilled(Glue([solid, patch]).solids[0], places, 0, thick, bolt)
        return named(solid, name, places, thick, bolt, area)

    upper, lower = plate("upper"), plate("lower").Rotate(Axis((0, 0, 0), Y), 180)
    lower.name = "lower"
    Compound([upper, lower]).WriteStep(str(path))


def flanges(path: Path) -> None:
    """Two tubes of 60 x 8 mm, 150 mm long, with flanges of 140 x 20 mm; four M12 on a circle of 105 mm."""
    from netgen.occ import Axis, Compound, Cylinder, X, Z

    outer, thick, tube, wall, length, circle = 140.0, 20.0, 60.0, 8.0, 150.0, 105.0
    corner = circle / 2 * math.sqrt(0.5)
    places = {"a": (corner, corner), "b": (-corner, corner), "c": (-corner, -corner), "d": (corner, -corner)}
    area = math.pi / 4 * (outer**2 - (tube - 2 * wall) ** 2 - len(places) * M12.hole**2)

    def half(name: str) -> Any:
        solid = Cylinder((0, 0, 0), Z, r=outer / 2, h=thick) + Cylinder((0, 0, 0), Z, r=tube / 2, h=length)
        solid = solid - Cylinder((0, 0, -1), Z, r=tube / 2 - wall, h=length + 2)
        return named(drilled(solid, places, 0, thick, M12), name, places, thick, M12, area)

    upper, lower = half("upper"), half("lower").Rotate(Axis((0, 0, 0), X), 180)
    lower.name = "lower"
    swapped = {"a": "d", "b": "c", "c": "b", "d": "a"}  # half a turn about x takes y to -y
    for face in lower.faces:
        if face.name and ".seat." in face.name:
            face.name = f"lower.seat.{swapped[face.name[-1]]}"
    Compound([upper, lower]).WriteStep(str(path))


def main() -> None:
    """Write the three files beside this one."""
    lap(HERE / "sheets.step", length=120, width=30, thick=3, over=30, places={"middle": (0.0, 0.0)}, bolt=M6)
    two = {"left": (0.0, -15.0), "right": (0.0, 15.0)}
    lap(HERE / "plates.step", length=180, width=60, thick=10, over=60, places=two, bolt=M8)
    flanges(HERE / "flanges.step")


if __name__ == "__main__":
    main()
