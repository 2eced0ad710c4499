"""Write beam.step: two plates on the edges of a third, with three screws each ("Jim beam").

Dimensions [mm] of the plates are those of the published mesh. The screws are assumed.
"""

from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
LONG, WIDE, THICK, APART = 300.0, 150.0, 10.0, 120.0  # plates; outer faces 120 apart
SCREWS = (-125.0, -75.0, -25.0)  # y; ASSUMED
HOLE, TAP, DEEP = 6.6, 5.0, 15.0  # ASSUMED: M6


def named(solid: Any, name: str) -> Any:
    """The solid with a name."""
    solid.name = name
    for face in solid.faces:
        face.name = ""
    return solid


def main() -> None:
    """Write the file beside this one."""
    from netgen.occ import Box, Compound, Cylinder, X

    lower = Box((0, -WIDE, -LONG), (THICK, 0, 0))
    upper = Box((APART - THICK, -WIDE, -LONG), (APART, 0, 0))
    web = Box((THICK, -WIDE, -THICK), (APART - THICK, 0, 0))
    for y in SCREWS:
        lower = lower - Cylinder((-1, y, -THICK / 2), X, r=HOLE / 2, h=THICK + 2)
        upper = upper - Cylinder((APART - THICK - 1, y, -THICK / 2), X, r=HOLE / 2, h=THICK + 2)
        web = web - Cylinder((THICK - 1, y, -THICK / 2), X, r=TAP / 2, h=DEEP + 1)
        web = web - Cylinder((APART - THICK - DEEP, y, -THICK / 2), X, r=TAP / 2, h=DEEP + 1)
    parts = [named(lower, "lower"), named(upper, "upper"), named(web, "web")]
    Compound(parts).WriteStep(str(HERE / "beam.step"))


if __name__ == "__main__":
    main()
