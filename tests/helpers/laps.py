"""Lapped plates with bolt holes, written by the CAD kernel: geometry as it comes from a CAD program."""

from faying.geometry.cad import write_step


def lapped(path, *, holes=((20, 20), (50, 20), (80, 20)), diameter=9.0, size=(100, 40), thick=(10, 12), **more):
    """Two plates on z = 0 with holes through both, without any names.

    holes: x, y of each [mm]; thick: of the lower and the upper plate. more: names of the plates, gap between them,
    bore (diameter, depth) of counterbores in the upper plate, lower_diameter of the holes there.
    """
    from netgen.occ import Box, Cylinder, Pnt, Z

    gap, high = more.get("gap", 0.0), thick[0] + thick[1] + more.get("gap", 0.0)
    lower = Box(Pnt(0, 0, 0), Pnt(*size, thick[0]))
    upper = Box(Pnt(0, 0, thick[0] + gap), Pnt(*size, high))
    for x, y in holes:
        lower = lower - Cylinder(Pnt(x, y, -1), Z, r=more.get("lower_diameter", diameter) / 2, h=high + 2)
        upper = upper - Cylinder(Pnt(x, y, -1), Z, r=diameter / 2, h=high + 2)
        if "bore" in more:
            wide, deep = more["bore"]
            upper = upper - Cylinder(Pnt(x, y, high - deep), Z, r=wide / 2, h=deep + 1)
    solids = [next(iter(one.solids)) for one in (lower, upper)]
    for solid, name in zip(solids, more.get("names", ("", "")), strict=True):
        if name:
            solid.name = name
    write_step(path, solids)
    return path
