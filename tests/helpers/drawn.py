"""STEP files of assemblies whose fasteners are drawn as bodies, with what each of them has, counted by hand."""

from dataclasses import dataclass, replace
from math import cos, pi, sin, tan

from tests.helpers.assemblies import _box, _drilled, _shapes, _write


def hexagon(x, y, low, high, flats):
    """A prism between two heights, of a width across flats."""
    occ, _ = _shapes()
    corners = [(flats / 3**0.5 * cos(k * pi / 3), flats / 3**0.5 * sin(k * pi / 3)) for k in range(6)]
    plane = occ.WorkPlane(occ.Axes(occ.Pnt(x, y, low), n=occ.Z, h=occ.X)).MoveTo(*corners[0])
    for corner in corners[1:]:
        plane = plane.LineTo(*corner)
    return plane.Close().Face().Extrude((high - low) * occ.Z)


def screw(place, seat, d, length, head, *, up=True, core=None, plain=0.0):
    """A screw with its head above (up) or below a height of its seat: ("hexagon" | "socket" | "flange" | "sunk", size).

    core: diameter of the thread, where it is drawn, behind a plain length.
    """
    occ, cylinder = _shapes()
    (x, y), (kind, wide) = place, head
    away = 1 if up else -1

    def tube(start, end, radius):
        return cylinder(x, y, *sorted((seat + away * start, seat + away * end)), radius)

    stem = tube(-length, 0, d / 2) if core is None else tube(-plain, 0, d / 2) + tube(-length, -plain, core / 2)
    if kind == "socket":
        top = tube(0, d, wide / 2) - hexagon(x, y, *sorted((seat + away * d / 2, seat + away * d)), 0.8 * d)
    elif kind == "sunk":  # the seat is the wide end of the cone of 90 degrees
        depth = (wide - d) / 2
        cone = occ.WorkPlane(occ.Axes(occ.Pnt(x, y, seat), n=occ.Y, h=occ.X)).MoveTo(0, 0).LineTo(wide / 2, 0)
        cone = cone.LineTo(d / 2, -away * -depth * tan(pi / 4)).LineTo(0, -away * -depth).Close().Face()
        top = cone.Revolve(occ.Axis(occ.Pnt(x, y, 0), occ.Z), 360)
    else:
        top = hexagon(x, y, *sorted((seat, seat + away * 0.64 * d)), wide)
        if kind == "flange":
            top = top + tube(0, 0.15 * d, wide * 0.75)
    return next(iter((stem + top).solids))


def nut(place, low, d, height, flats):
    """A hexagon nut on a thread of a diameter."""
    return _drilled(hexagon(*place, low, low + height, flats), [place], low, low + height, d)


def washer(place, low, sizes, *, split=False):
    """A washer of inner and outer diameter and thickness; split: with a gap."""
    _, cylinder = _shapes()
    inner, outer, thick = sizes
    ring = _drilled(cylinder(*place, low, low + thick, outer / 2), [place], low, low + thick, inner)
    if split:
        x, y = place
        ring = ring - _box((x, x + outer), (y - 0.5, y + 0.5), (low, low + thick))
    return next(iter(ring.solids))


def grooves(place, seat, d, pitch, count, flat=0.0):
    """A thread as V-grooves one below the other, with crests of a flat width."""
    occ, _ = _shapes()
    profile = occ.WorkPlane(occ.Axes(occ.Pnt(*place, seat), n=occ.Y, h=occ.X)).MoveTo(0, 0).LineTo(d / 2, 0)
    for k in range(count):
        if flat:
            profile = profile.LineTo(d / 2, k * pitch + flat)
        profile = profile.LineTo(d / 2 - 0.6 * pitch, (k + 0.5) * pitch + flat / 2).LineTo(d / 2, (k + 1) * pitch)
    return profile.LineTo(0, count * pitch).Close().Face().Revolve(occ.Axis(occ.Pnt(*place, 0), occ.Z), 360)


@dataclass(frozen=True, kw_only=True)
class Drawn:
    """What a study must have of one bolt: size, head, tapped, ring [mm], washers, engaged [mm], words of its remark."""

    size: float
    head: str = "hexagon"
    tapped: bool = False
    ring: tuple[float, float]
    washers: int = 0
    engaged: float | None = None
    says: str = ""


A, B = (25, 25), (95, 25)
BOTH = (A, B)


def _plates(holes, heights, places=BOTH):
    """Plates of 120 x 50 mm on each other, with holes of a diameter in each."""
    names = "abcdef"
    low, made = 0.0, {}
    for name, hole, height in zip(names, holes, heights, strict=False):
        made[f"plate {name}"] = _drilled(_box((0, 120), (0, 50), (low, low + height)), places, low, low + height, hole)
        low += height
    return made


def hexagon_and_nut(path):
    """Two M10 with a washer under each head and each nut."""
    parts = _plates((11, 11), (12, 12))
    for k, place in enumerate(BOTH, 1):
        parts[f"bolt {k}"] = screw(place, 26, 10, 45, ("hexagon", 16))
        parts[f"top washer {k}"] = washer(place, 24, (10.5, 20, 2))
        parts[f"low washer {k}"] = washer(place, -2, (10.5, 20, 2))
        parts[f"nut {k}"] = nut(place, -10.4, 10, 8.4, 16)
    return _write(path, **parts), [Drawn(size=10, ring=(11, 20), washers=2, says="nut")] * 2


def one_plate(path):
    """Two M10 with their nuts in a plate that no other part touches."""
    parts = _plates((11,), (24,))
    for k, place in enumerate(BOTH, 1):
        parts |= {f"bolt {k}": screw(place, 24, 10, 45, ("hexagon", 16)), f"nut {k}": nut(place, -8.4, 10, 8.4, 16)}
    return _write(path, **parts)


def ring_nuts(path):
    """Two M10 in holes without play, each with a thin round ring without play for a nut."""
    parts = _plates((10, 10), (12, 12))
    for k, place in enumerate(BOTH, 1):
        parts[f"bolt {k}"] = screw(place, 24, 10, 30, ("hexagon", 16))
        parts[f"ring {k}"] = washer(place, -3, (10, 25, 3))
    return _write(path, **parts), [Drawn(size=10, ring=(10, 16), says=f"nut 'ring {k}'") for k in (1, 2)]


def socket_in_thread(path):
    """Two cap screws M8 with 14 mm of plain shank and 18 mm in holes of 6.8 mm."""
    parts = _plates((6.8, 9), (30, 14))
    for k, place in enumerate(BOTH, 1):
        parts[f"screw {k}"] = screw(place, 44, 8, 32, ("socket", 13), core=6.8, plain=14)
    return _write(path, **parts), [Drawn(size=8, head="socket", tapped=True, ring=(9, 13), engaged=18)] * 2


def countersunk(path):
    """One countersunk M6 and one flanged M6 in threads of 5 mm, drawn at the nominal diameter."""
    occ, _ = _shapes()
    parts = _plates((5, 6.6), (25, 10))
    cone = occ.WorkPlane(occ.Axes(occ.Pnt(*A, 35), n=occ.Y, h=occ.X)).MoveTo(0, 0).LineTo(6.6, 0)
    cone = cone.LineTo(3.3, 3.3).LineTo(0, 3.3).Close().Face().Revolve(occ.Axis(occ.Pnt(*A, 0), occ.Z), 360)
    parts["plate b"] = parts["plate b"] - cone
    parts["sunk"] = screw(A, 35, 6, 24, ("sunk", 13.2))
    parts["flanged"] = screw(B, 35, 6, 22, ("flange", 10))
    expected = [
        Drawn(size=6, tapped=True, ring=(6.6, 13.2), engaged=14, says="countersunk head"),
        Drawn(size=6, tapped=True, ring=(6.6, 15), engaged=12, says="a flange of 15 mm"),
    ]
    return _write(path, **parts), expected


def sunk_in_a_sheet(path):
    """Two countersunk M5 in a sheet of 2.5 mm, of whose holes the countersinks leave 0.05 mm, with nuts."""
    occ, _ = _shapes()
    parts = _plates((5.2, 5.2), (3, 2.5))
    for k, place in enumerate(BOTH, 1):
        cone = occ.WorkPlane(occ.Axes(occ.Pnt(*place, 5.5), n=occ.Y, h=occ.X)).MoveTo(0, 0).LineTo(5.05, 0)
        cone = cone.LineTo(2.6, 2.45).LineTo(0, 2.45).Close().Face().Revolve(occ.Axis(occ.Pnt(*place, 0), occ.Z), 360)
        parts["plate b"] = parts["plate b"] - cone
        parts[f"sunk {k}"] = screw(place, 5.1, 5, 14, ("sunk", 9.3))
        parts[f"nut {k}"] = nut(place, -4.7, 5, 4.7, 8)
    sunk = Drawn(size=5, ring=(5.2, 9.3), says="its hole of 5.2 mm is none of ISO 273")
    return _write(path, **parts), [sunk, replace(sunk, says="its head has 9.3 mm, where ISO 10642 has 9.43 to 11.2")]


def grooved(path):
    """Two M8 without any plain shank, one whose nut has grooves, too; the hexagon one has no cylinder at all."""
    parts = _plates((9, 9), (12, 12))
    _, cylinder = _shapes()
    threads = [grooves(place, 24, 8, 1.25, 32, flat) for place, flat in ((A, 0.15), (B, 0.0))]
    heads = cylinder(*A, 24, 32, 6.5), hexagon(*B, 24, 29.12, 13)
    for k, (thread, head) in enumerate(zip(threads, heads, strict=True), 1):
        parts[f"bolt {k}"] = next(iter((thread + head).solids))
    parts["nut 1"] = nut(A, -6.8, 8, 6.8, 13)
    parts["nut 2"] = next(iter((hexagon(*B, -6.8, 0, 13) - grooves(B, 24, 8, 1.25, 32)).solids))
    return _write(path, **parts), [
        Drawn(size=8, head="socket", ring=(9, 13), says="nut 'nut 1'"),
        Drawn(size=8, ring=(9, 13), says="nut 'nut 2'"),
    ]


def mixed(path):
    """One M10 drawn with its nut, one bare hole of 11 mm."""
    parts = _plates((11, 11), (12, 12))
    parts["bolt"] = screw(A, 24, 10, 40, ("hexagon", 16))
    parts["nut"] = nut(A, -8.4, 10, 8.4, 16)
    return _write(path, **parts), [Drawn(size=10, ring=(11, 16)), Drawn(size=10, ring=(11, 20), says="ISO 7089")]


def both_sides(path):
    """Two cap screws M8 on one axis, from above and from below into one thread of 40 mm; and two bare holes alike."""
    parts = _plates((9, 6.8, 9), (12, 40, 12))
    parts["upper"] = screw(A, 64, 8, 28, ("socket", 13))
    parts["lower"] = screw(A, 0, 8, 28, ("socket", 13), up=False)
    drawn = Drawn(size=8, head="socket", tapped=True, ring=(9, 13), engaged=16)
    bare = Drawn(size=8, head="socket", tapped=True, ring=(9, 13), engaged=12, says="the other side")
    return _write(path, **parts), [drawn, drawn, bare, bare]


def one_axis(path, lows=(0, 50)):
    """Two M10 on one axis: plates a and b, 30 mm of air, plates c and d, with a column between; and two bare holes.

    lows: where the drawn bolts begin [mm]; the other holes are bare.
    """
    places = BOTH
    parts = {}
    for name, (low, high) in {"a": (0, 10), "b": (10, 20), "c": (50, 60), "d": (60, 70)}.items():
        parts[f"plate {name}"] = _drilled(_box((0, 120), (0, 50), (low, high)), places, low, high, 11)
    parts["plate column"] = _box((55, 65), (20, 30), (20, 50))
    for k, low in enumerate(lows, 1):
        parts[f"bolt {k}"] = screw(A, low + 20, 10, 30, ("hexagon", 16))
        parts[f"nut {k}"] = nut(A, low - 8.4, 10, 8.4, 16)
    drawn, bare = Drawn(size=10, ring=(11, 16)), Drawn(size=10, ring=(11, 20))
    return _write(path, **parts), [*[drawn] * len(lows), *[bare] * (4 - len(lows))]


def through_tube(path):
    """Two M10 through a plate and both walls of a tube of 50 x 40 mm, one drawn and one a bare hole."""
    tube = _box((0, 120), (0, 50), (0, 40)) - _box((0, 120), (5, 45), (5, 35))
    tube = _drilled(tube, BOTH, 0, 40, 11)
    plate = _drilled(_box((0, 120), (0, 50), (40, 52)), BOTH, 40, 52, 11)
    parts = {"tube": tube, "plate": plate}
    parts["bolt"] = screw(A, 52, 10, 66, ("hexagon", 16))
    parts["nut"] = nut(A, -8.4, 10, 8.4, 16)
    return _write(path, **parts), [Drawn(size=10, ring=(11, 16)), Drawn(size=10, ring=(11, 20))]


def three_parts(path):
    """Two M12 through three plates; one stud with two nuts, one screw whose nut is not drawn."""
    parts = _plates((13.5, 13.5, 13.5), (10, 15, 10))
    _, cylinder = _shapes()
    parts["stud"] = cylinder(*A, -16, 51, 6)
    parts["upper nut"] = nut(A, 35, 12, 10.8, 18)
    parts["lower nut"] = nut(A, -10.8, 12, 10.8, 18)
    parts["screw"] = screw(B, 35, 12, 50, ("hexagon", 18))
    says = "no nut is drawn"
    return _write(path, **parts), [Drawn(size=12, ring=(13.5, 18)), Drawn(size=12, ring=(13.5, 18), says=says)]


def spring_washers(path):
    """Two M8 with spring washers; one in a hole without play, one of a head that is no ISO 4014."""
    parts = _plates((9, 9), (12, 12), [A]) | {}
    parts = {name: _drilled(plate, [B], -1, 30, 8) for name, plate in parts.items()}
    for k, (place, flats) in enumerate(((A, 14), (B, 13)), 1):
        parts[f"bolt {k}"] = screw(place, 26, 8, 40, ("hexagon", flats))
        parts[f"ring {k}"] = washer(place, 24, (8.1, 14.8, 2), split=True)
        parts[f"nut {k}"] = nut(place, -6.8, 8, 6.8, 13)
    expected = [
        Drawn(size=8, ring=(9, 13), washers=1, says="14 mm across flats, where ISO 4014 has 13 mm"),
        Drawn(size=8, ring=(8.1, 13), washers=1, says="its hole of 8 mm leaves no play"),
    ]
    return _write(path, **parts), expected


def repeated(path):
    """Six M16 with nuts on a circle, each an instance of one body, and M42 in the middle."""
    _, cylinder = _shapes()
    places = [(70 * cos(k * pi / 3), 70 * sin(k * pi / 3)) for k in range(6)]
    parts = {}
    for name, low in (("lower", 0), ("upper", 20)):
        disc = _drilled(cylinder(0, 0, low, low + 20, 100), places, low, low + 20, 17.5)
        parts[name] = _drilled(disc, [(0, 0)], low, low + 20, 45)
    for k, place in enumerate(places, 1):
        parts[f"bolt {k}"] = screw(place, 40, 16, 60, ("hexagon", 24))
        parts[f"nut {k}"] = nut(place, -14.8, 16, 14.8, 24)
    parts["large"] = screw((0, 0), 40, 42, 85, ("hexagon", 65))
    parts["large nut"] = nut((0, 0), -34, 42, 34, 65)
    return _write(path, **parts), [*[Drawn(size=16, ring=(17.5, 24))] * 6, Drawn(size=42, ring=(45, 65))]


def turned(path):
    """A bolt with a fillet under its head, a chamfer at its tip and a chamfered nut drawn at its core, on a slant."""
    occ, _ = _shapes()
    parts = _plates((11, 11), (12, 12), [A])
    bolt, core = screw(A, 24, 10, 45, ("hexagon", 16)), nut(A, -8.4, 8.5, 8.4, 16)

    def rims(shape, height):
        return [edge for edge in shape.edges if abs(edge.center.z - height) + abs(edge.center.x - A[0]) < 1e-6]

    bolt = next(iter(bolt.MakeChamfer(rims(bolt, 24 - 45), 1.0).solids))
    parts["bolt"] = bolt.MakeFillet(rims(bolt, 24), 0.4)
    parts["nut"] = core.MakeChamfer([edge for z in (-8.4, 0) for edge in rims(core, z)], 0.8)
    slant = occ.Axis((0, 0, 0), occ.Vec(1, 2, 3))
    parts = {name: next(iter(shape.Rotate(slant, 40).solids)) for name, shape in parts.items()}
    return _write(path, **parts), [Drawn(size=10, ring=(11, 16), says="nut 'nut'")]


def t_slot(path):
    """A foot on a T-slot with square-headed M8 in it, whose nuts lie on top on washers."""
    base = _box((0, 120), (-40, 40), (-45, 0)) - _box((0, 120), (-5, 5), (-10, 0)) - _box((0, 120), (-9, 9), (-20, -10))
    places = ((25, 0), (95, 0))
    parts = {"plate base": base, "plate foot": _drilled(_box((0, 120), (-30, 30), (0, 16)), places, 0, 16, 9)}
    _, cylinder = _shapes()
    for k, (x, y) in enumerate(places, 1):
        parts[f"bolt {k}"] = _box((x - 8, x + 8), (-8, 8), (-16, -10)) + cylinder(x, y, -10, 30, 4)
        parts[f"washer {k}"] = washer((x, y), 16, (8.4, 16, 1.6))
        parts[f"nut {k}"] = nut((x, y), 17.6, 8, 6.8, 13)
    return _write(path, **parts), [Drawn(size=8, ring=(9, 16), washers=1)] * 2


MADE = {
    one.__name__: one
    for one in (
        hexagon_and_nut,
        ring_nuts,
        socket_in_thread,
        countersunk,
        sunk_in_a_sheet,
        grooved,
        mixed,
        both_sides,
        one_axis,
        through_tube,
        three_parts,
        spring_washers,
        repeated,
        turned,
        t_slot,
    )
}
