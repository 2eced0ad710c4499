"""Write cantilever.step: two bars with a half lap on two bolts (UNESP-BERT). Dimensions [mm]: README.md."""

from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
LONG, WIDE, THICK, LAP = 270.0, 25.4, 6.35, 40.0  # of each bar
BOLTS = (240.0, 260.0)  # x; the quarters of the lap
HOLE = 6.6


def bored(solid: Any, name: str) -> Any:
    """The solid with both holes along z, and a name."""
    from netgen.occ import Cylinder, Z

    for x in BOLTS:
        solid = solid - Cylinder((x, 0, -THICK), Z, r=HOLE / 2, h=2 * THICK)
    solid.name = name
    for face in solid.faces:
        face.name = ""
    return solid


def main() -> None:
    """Write the file beside this one."""
    from netgen.occ import Box, Compound

    def bar(low: float, high: float, bottom: float, top: float) -> Any:
        return Box((low, -WIDE / 2, bottom), (high, WIDE / 2, top))

    start, half = LONG - LAP, THICK / 2
    held = bar(0, start, -half, half) + bar(start, LONG, -half, 0)
    free = bar(LONG, start + LONG, -half, half) + bar(start, LONG, 0, half)
    Compound([bored(held, "held"), bored(free, "free")]).WriteStep(str(HERE / "cantilever.step"))


if __name__ == "__main__":
    main()
