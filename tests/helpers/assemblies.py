"""STEP files of ordinary bolted joints, without names of faces, as a CAD program leaves them."""

from math import cos, pi, sin

from faying.geometry.cad import write_step

MM = 1e-3


def _shapes():
    from netgen import occ

    def cylinder(x, y, low, high, radius):
        return occ.Cylinder(occ.Pnt(x, y, low), occ.Z, r=radius, h=high - low)

    return occ, cylinder


def _write(path, **parts):
    for name, shape in parts.items():
        shape.name = name
    write_step(path, parts.values())
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


def flanges(path, raised=0.0, pipe=0.0, hole=11.0):
    """Two rings of 150 mm with six holes on 114 mm; raised: height of the faces that meet; pipe: length."""
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
            shape = shape - cylinder(57 * cos(k * pi / 3), 57 * sin(k * pi / 3), low, high, hole / 2)
        return shape

    return _write(path, upper=one(True), lower=one(False))


def _box(x, y, z):
    """A box between two corners, from pairs."""
    occ, _ = _shapes()
    return occ.Box(occ.Pnt(x[0], y[0], z[0]), occ.Pnt(x[1], y[1], z[1]))


def _drilled(shape, places, low, high, diameter):
    _, cylinder = _shapes()
    for x, y in places:
        shape = shape - cylinder(x, y, low, high, diameter / 2)
    return shape


def t_slots(path):
    """A foot of 16 mm with two holes of 9 mm over a T-slot of 10 mm, whose lips are 10 mm thick."""
    base = _box((0, 100), (-40, 40), (-45, 0)) - _box((0, 100), (-5, 5), (-10, 0)) - _box((0, 100), (-9, 9), (-20, -10))
    foot = _drilled(_box((0, 100), (-30, 30), (0, 16)), ((25, 0), (75, 0)), 0, 16, 9)
    return _write(path, foot=foot, base=base)


def counterbored(path):
    """A cover of 20 mm with three cap screws M8 in counterbores of 15 mm, on a block with holes of 6.8 mm."""
    places = ((20, 20), (60, 20), (100, 20))
    cover = _drilled(_box((0, 120), (0, 40), (30, 50)), places, 30, 50, 9)
    cover = _drilled(cover, places, 41, 50, 15)
    block = _drilled(_box((0, 120), (0, 40), (0, 30)), places, 12, 30, 6.8)
    return _write(path, cover=cover, block=block)


def countersunk(path):
    """A plate of 10 mm on a block, with two countersunk screws M6: cones of 90 degrees from 6.6 to 13.2 mm."""
    occ, _ = _shapes()
    places = ((20, 20), (60, 20))
    plate = _drilled(_box((0, 80), (0, 40), (25, 35)), places, 25, 35, 6.6)
    for x, y in places:
        triangle = occ.WorkPlane(occ.Axes(occ.Pnt(x, y, 35), n=occ.Y, h=occ.X)).MoveTo(0, 0).LineTo(6.6, 0)
        triangle = triangle.LineTo(3.3, 3.3).LineTo(0, 3.3).Close().Face()
        plate = plate - triangle.Revolve(occ.Axis(occ.Pnt(x, y, 0), occ.Z), 360)
    block = _drilled(_box((0, 80), (0, 40), (0, 25)), places, 10, 25, 5)
    return _write(path, plate=plate, block=block)


def studded(path):
    """A cover of 12 mm on a body, with two studs M10 as parts in holes of 10 mm, and a nut on each."""
    _, cylinder = _shapes()
    places = ((20, 30), (80, 30))
    cover = _drilled(_box((0, 100), (0, 60), (40, 52)), places, 40, 52, 11)
    body = _drilled(_box((0, 100), (0, 60), (0, 40)), places, 20, 40, 10)
    more = {}
    for k, (x, y) in enumerate(places, 1):
        more[f"stud {k}"] = cylinder(x, y, 20, 65, 5)
        more[f"nut {k}"] = cylinder(x, y, 52, 60, 8) - cylinder(x, y, 52, 60, 5)
    return _write(path, cover=cover, body=body, **more)


def spacers(path):
    """Two plates of 10 mm with two spacers of 15 mm between them at each of two bolts M10."""
    places = ((25, 25), (95, 25))
    parts = {
        "lower": _drilled(_box((0, 120), (0, 50), (0, 10)), places, 0, 10, 11),
        "upper": _drilled(_box((0, 120), (0, 50), (40, 50)), places, 40, 50, 11),
    }
    _, cylinder = _shapes()
    for k, (x, y) in enumerate(places, 1):
        for word, low in (("a", 10), ("b", 25)):
            parts[f"spacer {k}{word}"] = cylinder(x, y, low, low + 15, 15) - cylinder(x, y, low, low + 15, 5.5)
    return _write(path, **parts)


def stepped_lap(path):
    """Two bars of 30 mm that step to half of their height over 60 mm, with two M10 and two shoulders."""
    places = ((85, 25), (115, 25))
    left = _box((0, 70), (0, 50), (0, 30)) + _box((70, 130), (0, 50), (0, 15))
    right = _box((70, 130), (0, 50), (15, 30)) + _box((130, 200), (0, 50), (0, 30))
    return _write(path, left=_drilled(left, places, 0, 15, 11), right=_drilled(right, places, 15, 30, 11))


def segments(path):
    """A ring of four segments, 1 mm apart, on a ring of 15 mm, with two M10 in each."""
    _, cylinder = _shapes()
    base = cylinder(0, 0, 0, 15, 100) - cylinder(0, 0, 0, 15, 60)
    ring = cylinder(0, 0, 15, 30, 100) - cylinder(0, 0, 15, 30, 60)
    ring = ring - _box((-120, 120), (-0.5, 0.5), (0, 40)) - _box((-0.5, 0.5), (-120, 120), (0, 40))
    places = [(80 * cos(a), 80 * sin(a)) for a in (pi / 8 + k * pi / 4 for k in range(8))]
    base, ring = (_drilled(shape, places, *z, 11) for shape, z in ((base, (0, 15)), (ring, (15, 30))))
    found = list(ring.solids)
    assert len(found) == 4
    return _write(path, base=base, **{f"segment {k}": solid for k, solid in enumerate(found, 1)})


def cover(path, pins_drawn=False, bore=0.0):
    """A cover of 10 mm on a frame, with four M6 and two holes of 6 mm for dowels, blind in the frame.

    bore: diameter of a hole through the pins.
    """
    bolts = ((10, 10), (110, 10), (10, 70), (110, 70))
    pins = ((60, 10), (60, 70))
    plate = _drilled(_drilled(_box((0, 120), (0, 80), (30, 40)), bolts, 30, 40, 6.6), pins, 30, 40, 6)
    frame = _box((0, 120), (0, 80), (0, 30)) - _box((20, 100), (20, 60), (0, 30))
    frame = _drilled(_drilled(frame, bolts, 0, 30, 6.6), pins, 18, 30, 6)
    _, cylinder = _shapes()
    more = (
        {
            f"pin {k}": _drilled(cylinder(x, y, 18, 40, 3), [(x, y)] if bore else (), 18, 40, bore)
            for k, (x, y) in enumerate(pins, 1)
        }
        if pins_drawn
        else {}
    )
    return _write(path, cover=plate, frame=frame, **more)


def channel(path):
    """A channel of 120 mm with two slots of 9 x 21 mm in its web, on a plate with round holes of 9 mm."""
    places = ((30, 30), (90, 30))
    plate = _drilled(_box((0, 120), (0, 60), (0, 12)), places, 0, 12, 9)
    web = _box((0, 120), (0, 60), (12, 52)) - _box((0, 120), (10, 50), (22, 52))
    for x, y in places:
        web = _drilled(web - _box((x - 6, x + 6), (y - 4.5, y + 4.5), (12, 22)), ((x - 6, y), (x + 6, y)), 12, 22, 9)
    return _write(path, channel=web, plate=plate)


MADE = {
    "flanges": lambda path: flanges(path, pipe=20.0),
    "raised_flanges": lambda path: flanges(path, raised=2.0, pipe=20.0),
    "bracket": bracket,
    "t_slots": t_slots,
    "counterbored": counterbored,
    "countersunk": countersunk,
    "studded": studded,
    "spacers": spacers,
    "stepped_lap": stepped_lap,
    "segments": segments,
    "cover": cover,
    "channel": channel,
}
# of elements that are coarse and cheap; the last two are files of others
SIZES = {
    "flanges": "15 mm",
    "raised_flanges": "15 mm",
    "bracket": "14 mm",
    "t_slots": "14 mm",
    "counterbored": "14 mm",
    "countersunk": "10 mm",
    "studded": "14 mm",
    "spacers": "12 mm",
    "stepped_lap": "15 mm",
    "segments": "16 mm",
    "cover": "12 mm",
    "channel": "14 mm",
    "pipe-flanges-flat": "15 mm",
    "column-on-t-slots": "30 mm",
}


def made(name, path):
    """Write the STEP file of an assembly."""
    return MADE[name](path)
