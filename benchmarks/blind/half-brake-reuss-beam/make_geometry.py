"""Write beam.step: two halves in a lap on three bolts, the half-height Brake-Reuss beam. Dimensions: README.md."""

from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
LONG, WIDE, HIGH, LAP = 720.0, 25.4, 12.7, 120.0
BOLTS = (-30.0, 0.0, 30.0)  # x; the quarters of the lap
HOLE = 0.33 * 25.4


def bored(solid: Any, name: str) -> Any:
    """The solid with three holes along z, and a name."""
    from netgen.occ import Cylinder, Z

    for x in BOLTS:
        solid = solid - Cylinder((x, 0, -HIGH), Z, r=HOLE / 2, h=2 * HIGH)
    solid.name = name
    for face in solid.faces:
        face.name = ""
    return solid


def main() -> None:
    """Write the file beside this one."""
    from netgen.occ import Box, Compound

    def bar(low: float, high: float, bottom: float, top: float) -> Any:
        return Box((low, -WIDE / 2, bottom), (high, WIDE / 2, top))

    end, lap, half = LONG / 2, LAP / 2, HIGH / 2
    left = bar(-end, -lap, -half, half) + bar(-lap, lap, -half, 0)
    right = bar(lap, end, -half, half) + bar(-lap, lap, 0, half)
    Compound([bored(left, "left"), bored(right, "right")]).WriteStep(str(HERE / "beam.step"))


if __name__ == "__main__":
    main()
