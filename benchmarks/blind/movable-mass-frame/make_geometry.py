"""Write frame.step: seven bars on screws, two steel bars below it, and four steel halves of two movable masses.

Holes are left out but for threads, which have six sides: round ones make the mesh three times as large.
Centre lines and the section of the bars [mm] are those of the published beam model; screws, angles, ridges and the
widths of the steel bars are assumed (README.md). x across the bars, y along the base, z up.
"""

from math import pi, sqrt
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
WIDE, THICK, BASE, HIGH, MIDDLE = 60.0, 9.4, 400.0, 800.0, 400.0  # bars; outer size; centre line of the middle bar
LOWER, UPPER = 100.0, 300.0  # y of the inner bars
MASSES = 200.0, 200.0  # heights of the masses over the base and over the centre line of the middle bar
SCREWS, TAP, DEEP = (-20.0, 0.0, 20.0), 3.3, 12.0  # x; ASSUMED: M4
ANGLE, LEG = 3.0, 25.0  # ASSUMED: thickness and leg of the angles
FEET, FOOT, TALL, FIXED, ROOT = (50.0, 350.0), 50.0, 20.0, (-15.0, 15.0), 5.0  # y published; ASSUMED: M6
HALF, RIDGE, OUT = (101.6, 25.4, 50.8), 4.0, 1.0  # ASSUMED: halves of 4 x 1 x 2 in for 2.03 kg; ridge on the bar


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> Any:
    """A box between two corners."""
    from netgen.occ import Box

    return Box(low, high)


def tapped(solid: Any, along: int, places: list[tuple[float, float, float]], tap: float) -> Any:
    """The solid with six-sided holes of the area of a tap along an axis (y 1, z 2) from these places on."""
    from netgen.occ import Axis, Y, Z

    flat = tap / 2 * sqrt(pi / (2 * sqrt(3)))  # half of the width across flats
    for place in places:
        low, high = ([one + side * 2 * flat for one in place] for side in (-1, 1))
        low[along], high[along] = place[along], place[along] + DEEP
        low[0], high[0] = place[0] - flat, place[0] + flat
        slab = box((low[0], low[1], low[2]), (high[0], high[1], high[2]))
        axis = Axis(place, Y if along == 1 else Z)
        solid = solid - slab * slab.Rotate(axis, 60) * slab.Rotate(axis, 120)
    return solid


def named(solid: Any, name: str) -> Any:
    """The solid with a name."""
    solid.name = name
    for face in solid.faces:
        face.name = ""
    return solid


def row(y: float, z: float) -> list[tuple[float, float, float]]:
    """The places of three screws side by side."""
    return [(x, y, z) for x in SCREWS]


def main() -> None:
    """Write the file beside this one."""
    from netgen.occ import Compound

    w, h, t = WIDE / 2, THICK / 2, THICK
    ends = (h, BASE - h)
    bottom = box((-w, 0, 0), (w, BASE, t))
    top = box((-w, 0, HIGH - t), (w, BASE, HIGH))
    middle = box((-w, t, MIDDLE - h), (w, BASE - t, MIDDLE + h))
    middle = tapped(middle, 1, row(t, MIDDLE), TAP)
    middle = tapped(middle, 1, row(BASE - t - DEEP, MIDDLE), TAP)
    outer = []
    for y in ends:
        bar = box((-w, y - h, t), (w, y + h, HIGH - t))
        for z in (t, HIGH - t - DEEP):
            bar = tapped(bar, 2, row(y, z), TAP)
        outer.append(bar)
    inner = []
    for y, low, high, foot, up in (
        (LOWER, t, MIDDLE - h, MIDDLE - h, -1),
        (UPPER, MIDDLE + h, HIGH - t, MIDDLE + h, 1),
    ):
        bar = box((-w, y - h, low), (w, y + h, high))
        reach, side = sorted((foot, foot + up * ANGLE)), sorted((foot, foot + up * LEG))
        bar = bar + box((-w, y - h - LEG, reach[0]), (w, y + h + LEG, reach[1]))
        bar = bar + box((-w, y - h - ANGLE, side[0]), (w, y + h + ANGLE, side[1]))
        inner.append(tapped(bar, 2, row(y, low if up < 0 else high - DEEP), TAP))
    feet = [box((-w, y - FOOT / 2, -TALL), (w, y + FOOT / 2, 0)) for y in FEET]
    feet = [tapped(foot, 2, [(x, y, -DEEP) for x in FIXED], ROOT) for foot, y in zip(feet, FEET, strict=True)]
    halves = []
    for y, z in ((LOWER, t + MASSES[0]), (UPPER, MIDDLE + MASSES[1])):
        for side in (-1, 1):
            near, far = y + side * (h + OUT), y + side * (h + OUT + HALF[1])
            one = box(
                (-HALF[0] / 2, min(near, far), z - HALF[2] / 2),
                (HALF[0] / 2, max(near, far), z + HALF[2] / 2),
            )
            face = y + side * h
            halves.append(one + box((-w, min(face, near), z - RIDGE / 2), (w, max(face, near), z + RIDGE / 2)))
    names = ["bottom", "top", "middle", "right", "left", "lower", "upper", "foot1", "foot2"]
    solids = [bottom, top, middle, *outer, *inner, *feet, *halves]
    names += ["mass1a", "mass1b", "mass2a", "mass2b"]
    parts = [named(solid, name) for solid, name in zip(solids, names, strict=True)]
    Compound(parts).WriteStep(str(HERE / "frame.step"))


if __name__ == "__main__":
    main()
