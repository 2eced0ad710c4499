"""Holes and rows of holes: radii and places against what was drilled, seats, and the room around them."""

import numpy as np
import pytest

from faying.geometry.bores import Bore, bores, room_around, rows, seat
from faying.geometry.face_facts import read_facts
from tests.geometry.test_face_facts import box, written
from tests.helpers.laps import lapped


def found(path, reach=1e-3):
    facts = read_facts(path)
    return facts, [row for row in rows(bores(facts), reach=reach) if len(row.bores) > 1]


def test_rows_of_holes_through_two_plates(tmp_path):
    facts, rows = found(lapped(tmp_path / "lap.step", names=("lower", "upper")))
    assert len(rows) == 3
    for row, x in zip(rows, (20, 50, 80), strict=True):
        assert row.parts == ("lower", "upper")
        assert 1e3 * row.middle == pytest.approx([x, 20, 11])
        assert [bore.radius for bore in row.bores] == pytest.approx([4.5e-3, 4.5e-3])
        ends = seat(facts, row.bores[0], top=False), seat(facts, row.bores[1], top=True)
        assert [end.centre[2] for end in ends] == pytest.approx([0, 22e-3])
        # the nearest edge is that of the plate or of the next hole, by chords a little short
        room = min(20.0, 30 - 4.5)
        assert 1e3 * room_around(facts, ends[0], row.bores[0]) == pytest.approx(room, rel=1e-9)


def test_the_floor_of_a_counterbore_is_the_seat(tmp_path):
    facts, rows = found(lapped(tmp_path / "lap.step", holes=((50, 20),), bore=(15.0, 5.0), names=("lower", "upper")))
    (row,) = rows
    floor = seat(facts, row.bores[1], top=True)
    assert 1e3 * floor.centre[2] == pytest.approx(17)
    assert 1e6 * floor.area == pytest.approx(np.pi * (7.5**2 - 4.5**2))
    assert 1e3 * room_around(facts, floor, row.bores[1]) == pytest.approx(7.5, rel=0.02)


def test_holes_that_do_not_line_up_or_do_not_meet_are_no_row(tmp_path):
    from netgen.occ import Cylinder, Pnt, Z

    lower = box((0, 0, 0), (60, 40, 10)) - Cylinder(Pnt(20, 20, -1), Z, r=4.5, h=12)
    upper = box((0, 0, 10), (60, 40, 20)) - Cylinder(Pnt(22, 20, 5), Z, r=4.5, h=20)
    far = box((0, 0, 60), (60, 40, 70)) - Cylinder(Pnt(20, 20, 55), Z, r=4.5, h=20)
    solids = [next(iter(one.solids)) for one in (lower, upper, far)]
    facts, rows = found(written(tmp_path / "x.step", *solids))
    assert len(bores(facts)) == 3
    assert not rows


def test_a_fillet_is_no_hole_and_halves_of_a_hole_are_one(tmp_path):
    from netgen.occ import Cylinder, Glue, Pnt, Z

    plate = box((0, 0, 0), (60, 40, 10)) - Cylinder(Pnt(30, 20, -1), Z, r=4.5, h=12)
    corner = box((0, 0, 10), (20, 40, 30)) - Cylinder(Pnt(20, 20, 30), Z, r=8, h=1)
    solid = next(iter((plate + corner).solids))
    inner = [edge for edge in solid.edges if abs(edge.center.x - 20) < 1e-6 and abs(edge.center.z - 10) < 1e-6]
    solid = next(iter(solid.MakeFillet(inner, 3.0).solids))
    facts = read_facts(written(tmp_path / "f.step", solid))
    hollow = [face for face in facts.faces if face.hole]
    assert any(face.turn == pytest.approx(0.25, rel=1e-3) for face in hollow)
    (bore,) = bores(facts)
    assert bore.radius == pytest.approx(4.5e-3)
    # the same hole in two half plates glued along its axis: its halves are two faces of one solid each
    halves = Glue([box((0, 0, 0), (30, 40, 10)), box((30, 0, 0), (60, 40, 10))])
    assert len(list(halves.solids)) == 2


def test_bores_of_one_radius_are_told_apart():
    """A pattern of holes that agree to the last bit: a row for each axis."""
    made = [
        Bore(
            part=part,
            radius=4.5e-3,
            axis=np.array([0.0, 0.0, 1.0]),
            point=np.array([x, 0.0, low]),
            low=low,
            high=low + 0.01,
            faces=(k,),
        )
        for part, low in (("a", 0.0), ("b", 0.01))
        for k, x in enumerate((0.0, 0.02, 0.04), 7)
    ]
    found_rows = [row for row in rows(made, reach=1e-3) if len(row.bores) > 1]
    assert [row.parts for row in found_rows] == [("a", "b")] * 3
    assert [row.middle[0] for row in found_rows] == [0.0, 0.02, 0.04]
