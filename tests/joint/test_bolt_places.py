"""Bolts in round holes: which ring they press where nobody says it, and places that cannot be meant."""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.bolt.bolt import Bolt, Washer
from faying.bolt.seat import Seat
from faying.fe.holes import holes
from faying.fe.interface import join
from faying.fe.line import Line
from faying.fe.mesh import Mesh
from faying.joint.bolted import overlapping
from faying.joint.joint import FittedJoint
from faying.joint.joint_law import JointLaw
from faying.joint.strength import least_seat_area
from faying.joint.structure import Structure
from tests.helpers.laws import Given
from tests.helpers.sides import sides_on

STEEL = faying.CATALOGUE["45 steel"]
INNER, OUTER, N = 4.5e-3, 20e-3, 24
CENTRE = np.array([0.03, 0.01, 0.0])
LAW = JointLaw(model=Given(k_n=lambda p: 2e7 * p**0.5, k_t=lambda p: 1e7 * p**0.5))


def rings(centres=(CENTRE,)):
    """Two plates, 5 mm each, of rings of bricks: a hole of 9 mm in a disc of 40 mm about each centre."""
    points, parts, faces, owner, offset = [], {}, {}, {}, 0
    radius, layers = np.linspace(INNER, OUTER, 6), 3
    for name, low in (("upper", 0.0), ("lower", -5e-3)):
        places, cells = [], []
        for k, centre in enumerate(centres):
            around = 2 * np.pi * np.arange(N) / N
            r, a, z = np.meshgrid(radius, around, low + np.linspace(0, 5e-3, layers), indexing="ij")
            places.append(np.stack([r * np.cos(a), r * np.sin(a), z], -1).reshape(-1, 3) + centre)
            index = np.arange(r.size).reshape(r.shape) + k * r.size
            turned = np.roll(index, -1, axis=1)
            cube = [index[:-1, :, :-1], index[1:, :, :-1], turned[1:, :, :-1], turned[:-1, :, :-1]]
            cube += [index[:-1, :, 1:], index[1:, :, 1:], turned[1:, :, 1:], turned[:-1, :, 1:]]
            cells.append(np.stack(cube, -1).reshape(-1, 8))
        where, block = np.concatenate(places), np.concatenate(cells)
        for label, height in (("top", low + 5e-3), ("bottom", low)):
            on = np.flatnonzero(np.abs(where[:, 2] - height) < 1e-9)
            faces[f"{name}.{label}"] = tuple(f + offset for f in sides_on(on, (block,), len(where)))
            owner[f"{name}.{label}"] = name
        parts[name] = block + offset
        points.append(where)
        offset += len(where)
    return Mesh(points=np.concatenate(points), parts=parts, faces=faces, face_part=owner)


FACES = ("upper.top", "lower.bottom")


def bolt(**changes):
    return Bolt(**({"name": "b", "faces": FACES, "diameter": 8e-3, "material": STEEL, "at": tuple(CENTRE)} | changes))


def structure(mesh, *bolts):
    joint = FittedJoint(
        name="j", faces=("upper.bottom", "lower.top"), interface=join(mesh, "upper.bottom", "lower.top"), law=LAW
    )
    return Structure(mesh=mesh, materials=dict.fromkeys(mesh.parts, STEEL), joints=(joint,), bolts=bolts)


def test_holes_of_a_face():
    other = CENTRE + np.array([0.05, 0, 0])
    found = holes((mesh := rings((CENTRE, other))).points, mesh.face("upper.top"))
    assert sorted(float(hole.centre[0]) for hole in found) == pytest.approx([CENTRE[0], other[0]], abs=1e-9)
    assert [hole.radius for hole in found] == pytest.approx([INNER, INNER], rel=1e-9)


def test_a_bolt_without_a_seat_presses_from_its_hole_to_its_head():
    """1.5 d across flats: the same load as with that ring given, and a note; not the whole face."""
    mesh = rings()
    chosen, given = bolt().fitted(mesh), bolt(seat=(2 * INNER, 12e-3)).fitted(mesh)
    assert chosen.ring == pytest.approx((2 * INNER, 12e-3), rel=1e-9)
    assert chosen.load == pytest.approx(given.load, abs=1e-12)
    assert [note.code for note in structure(mesh, bolt()).notes] == ["bolt-seat"]
    assert not structure(mesh, bolt(seat=(2 * INNER, 12e-3))).notes
    bare = bolt(diameter=None, material=None).fitted(mesh)
    assert bare.ring == pytest.approx((2 * INNER, 1.5 * 2 * INNER / 1.1), rel=1e-9)
    thinned = bolt(diameter=6.5e-3, thread="M8").fitted(mesh)
    assert thinned.ring == pytest.approx(chosen.ring, rel=1e-9)  # the head is that of an M8


def test_seats_are_where_the_axis_meets_the_faces_and_reach_from_the_hole_to_the_rim():
    mesh = rings()
    whole = bolt(at=None).fitted(mesh)
    assert (whole.pressed[0].inner, whole.pressed[0].outer) == pytest.approx((2 * INNER, 2 * OUTER), rel=1e-6)
    np.testing.assert_allclose(whole.seats, CENTRE + np.array([[0, 0, 5e-3], [0, 0, -5e-3]]), atol=1e-6)
    ring = bolt().fitted(mesh).pressed[0]
    assert (ring.inner, ring.outer) == pytest.approx((2 * INNER, 12e-3), rel=1e-9)


def test_a_seat_wider_than_its_face_counts_as_what_lies_on_it():
    """A ring to 50 mm on a face that ends at 40 mm bears what the face has, and torque turns about its middle."""
    mesh = rings()
    wide = bolt(seat=(2 * INNER, "50 mm")).fitted(mesh)
    seat = wide.pressed[0]
    assert (seat.inner, seat.outer, seat.is_ring) == (2 * INNER, pytest.approx(2 * OUTER, rel=1e-6), True)
    assert least_seat_area(wide) == pytest.approx(np.pi * (OUTER**2 - INNER**2), rel=1e-6)
    head, nut = structure(mesh, bolt(seat=(2 * INNER, "50 mm"))).notes
    assert (head.code, nut.code) == ("seat-beyond-face", "seat-beyond-face")
    share = (OUTER**2 - INNER**2) / (25e-3**2 - INNER**2)
    assert f"of its ring of 9 mm to 50 mm only {share:.0%} lie on 'upper.top'" in head.text
    narrow = bolt(seat=("2 mm", "12 mm")).fitted(mesh).pressed[0]  # what would lie in the hole bears nothing
    assert (narrow.inner, narrow.area) == pytest.approx((2 * INNER, np.pi * (6e-3**2 - INNER**2)), rel=2e-2)
    with pytest.raises(faying.InputError, match="meets nothing of its face"):
        bolt(seat=("41 mm", "50 mm")).placed(mesh)


@pytest.mark.parametrize("x", [0.0, 4e-3, 9e-3])
def test_a_seat_over_an_edge_has_the_area_of_a_segment(x):
    """A head whose axis is x from the straight edge of a plate."""
    from tests.helpers.boxes import stack

    mesh = stack([0.03, 0.03], [3, 3], width=0.02, height=0.06)
    r, R = 4e-3, 8e-3
    centre = mesh.points[mesh.face_nodes("p1.right")].mean(axis=0)
    axis = np.array([1.0, 0.0, 0.0])
    ends = mesh.points[mesh.face_nodes("p1.right")]
    point = np.array([centre[0], centre[1], ends[:, 2].max() - x])

    def inside(radius):
        beyond = radius**2 * np.arccos(x / radius) - x * np.sqrt(radius**2 - x**2) if x < radius else 0.0
        return np.pi * radius**2 - beyond

    seat = Seat.of(mesh, "p1.right", Line(point=point, axis=axis), (2 * r, 2 * R))
    assert seat.area == pytest.approx(inside(R) - inside(r), rel=1e-9)
    assert bool(seat.overhang) == (x < R)


def test_a_seat_that_nothing_tells_is_asked_for():
    from tests.helpers.boxes import stack

    plain = replace(bolt(diameter=None, material=None), faces=("p1.right", "p0.left"), at=(0.0, 0.01, 0.01))
    mesh = stack([0.03, 0.03], [2, 2], width=0.02, height=0.02)
    with pytest.raises(faying.InputError, match="neither seat, washer, diameter nor a round hole says how much"):
        plain.fitted(mesh)
    sized = replace(plain, diameter=8e-3, material=STEEL)
    assert sized.fitted(mesh).ring == pytest.approx((0.0, 12e-3))
    with pytest.raises(faying.InputError, match="a head of 7.5 mm across flats falls through its hole of 9 mm"):
        bolt(diameter=5e-3).fitted(rings())
    washer = Washer(outer=18e-3, inner=9e-3, thickness=1e-3, material=STEEL)
    assert bolt(diameter=5e-3, washers=(washer,)).fitted(rings()).ring == pytest.approx((9e-3, 18e-3))


@pytest.mark.parametrize("away", [5, 10])  # mm: the head of M8 is 12 mm wide
def test_an_axis_beside_its_hole_is_refused(away):
    with pytest.raises(
        faying.InputError,
        match=rf"its axis is {away} mm away from the centre of the hole of 9 mm in 'upper.top', at \(30",
    ):
        bolt(at=tuple(CENTRE + np.array([away * 1e-3, 0, 0]))).fitted(rings())
    assert bolt(at=tuple(CENTRE + np.array([0.5e-3, 0, 0]))).fitted(rings()).length == pytest.approx(10e-3)


def test_two_bolts_in_one_place_and_one_thing_twice_are_refused():
    other = CENTRE + np.array([0.05, 0, 0])
    mesh = rings((CENTRE, other))
    assert structure(mesh, bolt(), bolt(name="c", at=tuple(other))).loads.shape[1] == 2
    with pytest.raises(faying.InputError, match="bolts 'b' and 'c' run through one place"):
        structure(mesh, bolt(), bolt(name="c")).loads  # noqa: B018
    with pytest.raises(faying.InputError, match="two bolts are called 'b'"):
        structure(mesh, bolt(), bolt(at=tuple(other)))
    made = structure(mesh, bolt())
    again = replace(made.joints[0], name="k", faces=made.joints[0].faces[::-1])
    with pytest.raises(faying.InputError, match="joints 'j' and 'k' join the same faces .* would double the stiffness"):
        replace(made, joints=(*made.joints, again))


def test_joints_of_some_of_the_same_sides_are_refused():
    """Half of both faces again, under other names; halves of one face alone, or of both that do not overlap, may be."""
    mesh = rings()
    made = structure(mesh, bolt())
    (j,) = made.joints

    def half(face, first):
        return tuple(sides[: len(sides) // 2] if first else sides[len(sides) // 2 :] for sides in mesh.face(face))

    named = {f"{face}.{k}": half(face, k == 1) for face in j.faces for k in (1, 2)}
    owner = {name: mesh.face_part[name.rpartition(".")[0]] for name in named}
    both = replace(mesh, faces={**mesh.faces, **named}, face_part={**mesh.face_part, **owner})
    one, two = j.faces
    assert overlapping(both, {"a": (one, two), "b": (f"{one}.1", f"{two}.1")})
    assert overlapping(both, {"a": (f"{two}.1", one), "b": (f"{one}.1", two)})
    assert not overlapping(both, {"a": (f"{one}.1", f"{two}.1"), "b": (f"{one}.2", f"{two}.2")})
    assert not overlapping(both, {"a": (one, f"{two}.1"), "b": (one, f"{two}.2")})


@pytest.mark.parametrize(("share", "refused"), [(0.15, False), (0.25, True)])
def test_an_axis_may_lie_a_fifth_of_its_radius_beside_the_hole(share, refused):
    at = CENTRE + np.array([share * INNER, 0.0, 0.0])
    made = Bolt(name="b", faces=FACES, at=tuple(at), diameter=8e-3, material=STEEL)
    if refused:
        with pytest.raises(faying.InputError, match="its axis is .* away from the centre of the hole"):
            made.fitted(rings())
    else:
        assert made.fitted(rings()).length == pytest.approx(10e-3)


def test_bolts_that_cross_at_an_angle_are_not_in_one_place():
    """Two screws of one named face that look different ways may pass close by each other; parallel ones may not."""
    from faying.bolt.bolt import BoltPlace, each_in_its_place

    def place(name, axis):
        bolt = Bolt(name, ("both walls", f"{name}.nut"), diameter="8 mm", material=STEEL)
        return BoltPlace(bolt=bolt, point=np.zeros(3), axis=np.array(axis, float), length=0.02, ring=None, pressed=())

    each_in_its_place([place("a", (0, 0, 1)), place("b", (1, 0, 0))])
    for axis in ((0, 0, 1), (0, 0, -1)):
        with pytest.raises(faying.InputError, match="bolts 'a' and 'b' run through one place"):
            each_in_its_place([place("a", (0, 0, 1)), place("b", axis)])
