"""STEP files of ordinary bolted joints, without names of faces, as a CAD program leaves them."""

from math import cos, pi, sin

MM = 1e-3


def _shapes():
    from netgen import occ

    def cylinder(x, y, low, high, radius):
        return occ.Cylinder(occ.Pnt(x, y, low), occ.Z, r=radius, h=high - low)

    return occ, cylinder


def _write(path, **parts):
    occ, _ = _shapes()
    for name, shape in parts.items():
        shape.name = name
    occ.Compound(list(parts.values())).WriteStep(str(path))
    return path


def bracket(path, tapped=8.5, depth=25.0):
    """A plate of 12 mm on a block of 40 mm, with two holes of 11 mm over two blind holes."""
    occ, cylinder = _shapes()
    plate = occ.Box(occ.Pnt(0, 0, 40), occ.Pnt(100, 60, 52))
    base = occ.Box(occ.Pnt(0, 0, 0), occ.Pnt(100, 60, 40))
    for x in (25, 75):
        plate = plate - cylinder(x, 30, 40, 52, 5.5)
        base = base - cylinder(x, 30, 40 - depth, 40, tapped / 2)
    return _write(path, bracket=plate, base=base)


def flanges(path, raised=0.0, pipe=0.0):
    """Two rings of 150 mm with six holes of 11 mm on 114 mm; raised: height of the faces that meet; pipe: length."""
    _, cylinder = _shapes()

    def one(up):
        low, high = (raised, raised + 12) if up else (-raised - 12, -raised)
        shape = cylinder(0, 0, low, high, 75)
        if raised:
            shape = shape + cylinder(0, 0, *sorted((0, raised if up else -raised)), 40)
        if pipe:
            shape = shape + cylinder(0, 0, *((high, high + pipe) if up else (low - pipe, low)), 30)
        shape = shape - cylinder(0, 0, -200, 200, 26)
        for k in range(6):
            shape = shape - cylinder(57 * cos(k * pi / 3), 57 * sin(k * pi / 3), low, high, 5.5)
        return shape

    return _write(path, upper=one(True), lower=one(False))
