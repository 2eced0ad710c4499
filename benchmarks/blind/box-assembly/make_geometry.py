"""Write box.step: the box assembly with removable component (BARC), four parts with plain holes for ten bolts.

Dimensions [mm] are those of the published mesh of the assembly that was tested (README.md), and so are the axes.
"""

from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
INCH = 25.4
HALF, LONG, WALL, CUT = 3 * INCH, 3 * INCH, INCH / 4, INCH / 2  # square tube of 6 x 6 x 3 in, cut open on top
THIN, FOOT, HIGH = INCH / 8, INCH, 2 * INCH  # channels of 1 x 1 x 2 in, and the strip across them
FRONT = INCH  # z of the front of channels and strip
MIDDLE = 2 * INCH  # x of the middle of a channel
PITCH, FOOT_HOLE, TOP_HOLE = 9.525, 4.305, 5.613


def hole(x: float, z: float, diameter: float, low: float, high: float) -> Any:
    """A cylinder along y."""
    from netgen.occ import Cylinder, Y

    return Cylinder((x, low - 1, z), Y, r=diameter / 2, h=high - low + 2)


def bored(solid: Any, name: str, feet: tuple[float, ...], tops: tuple[float, ...]) -> Any:
    """The solid with four holes at each foot and one at each top, whose middles are at these x."""
    centre = FRONT + FOOT / 2
    for x in feet:
        for dx in (-PITCH / 2, PITCH / 2):
            for dz in (-PITCH / 2, PITCH / 2):
                solid = solid - hole(x + dx, centre + dz, FOOT_HOLE, HALF - WALL, HALF + THIN)
    for x in tops:
        solid = solid - hole(x, centre, TOP_HOLE, HALF + HIGH - THIN, HALF + HIGH + THIN)
    solid.name = name
    for face in solid.faces:
        face.name = ""
    return solid


def main() -> None:
    """Write the file beside this one."""
    from netgen.occ import Box, Compound

    inner, back = HALF - WALL, FRONT + FOOT
    tube = Box((-HALF, -HALF, 0), (HALF, HALF, LONG)) - Box((-inner, -inner, -1), (inner, inner, LONG + 1))
    tube = tube - Box((-CUT / 2, 0, -1), (CUT / 2, HALF + 1, LONG + 1))
    channels = []
    for side in (-1, 1):
        low, high = side * MIDDLE - FOOT / 2, side * MIDDLE + FOOT / 2
        solid = Box((low, HALF, FRONT), (high, HALF + HIGH, back))
        if side < 0:  # open to the back
            room = Box((low - 1, HALF + THIN, FRONT + THIN), (high + 1, HALF + HIGH - THIN, back + 1))
        else:  # open to the middle
            room = Box((low - 1, HALF + THIN, FRONT - 1), (high - THIN, HALF + HIGH - THIN, back + 1))
        channels.append(solid - room)
    strip = Box((-MIDDLE - FOOT / 2, HALF + HIGH, FRONT), (MIDDLE + FOOT / 2, HALF + HIGH + THIN, back))
    parts = [
        bored(tube, "box", (-MIDDLE, MIDDLE), ()),
        bored(channels[0], "left", (-MIDDLE,), (-MIDDLE,)),
        bored(channels[1], "right", (MIDDLE,), (MIDDLE,)),
        bored(strip, "strip", (), (-MIDDLE, MIDDLE)),
    ]
    Compound(parts).WriteStep(str(HERE / "box.step"))


if __name__ == "__main__":
    main()
