"""Seats beyond the end of a bore: lips of T-slots, countersinks, and slotted holes, against what was drawn."""

from math import pi, sqrt

import numpy as np
import pytest

from faying.geometry.bores import bores, rows
from faying.geometry.face_facts import read_facts
from faying.geometry.seats import countersink, lips
from tests.geometry.test_face_facts import box, written
from tests.helpers import assemblies


def one_bore(facts, part):
    return next(bore for bore in bores(facts) if bore.part == part)


def slot_of(tmp_path, *extra, narrow=False):
    """A foot with one hole of 9 mm over a T-slot of 10 mm, its lips 10 mm thick; narrow: with the lip at +y alone."""
    from netgen.occ import Cylinder, Pnt, Z

    base = box((0, -40, -45), (50, 40, 0)) - box((0, -5, -10), (50, 5, 0))
    base = base - box((0, -5 if narrow else -9, -20), (50, 9, -10))
    foot = box((0, -30, 0), (50, 30, 16)) - Cylinder(Pnt(25, 0, -1), Z, r=4.5, h=20)
    solids = [next(iter(one.solids)) for one in (base, foot)]
    for solid, name in zip(solids, ("base", "foot"), strict=True):
        solid.name = name
    return read_facts(written(tmp_path / "slot.step", *solids, *extra))


def under(facts, top=False):
    return lips(facts, one_bore(facts, "foot"), top=top, shank=8e-3, ring=(9e-3, 16e-3))


def test_the_undersides_of_both_lips(tmp_path):
    facts = slot_of(tmp_path)
    found = under(facts)
    assert {face.part for face in found} == {"base"}
    assert [face.normal for face in found] == [pytest.approx((0, 0, -1))] * 2
    assert sorted(face.centre[1] for face in found) == pytest.approx([-7e-3, 7e-3])
    assert [face.area for face in found] == pytest.approx([50 * 4 * 1e-6] * 2)
    assert not under(facts, top=True)


def test_no_lips_where_the_way_is_blocked_or_one_lip_lacks(tmp_path):
    plug = box((10, -5, -10), (40, 5, -5), "plug")
    assert not under(slot_of(tmp_path, plug))
    assert not under(slot_of(tmp_path, narrow=True))


def test_no_lips_where_another_part_lies_against_them(tmp_path):
    """No nut finds room behind a face that is a joint."""
    filling = box((0, -9, -20), (50, 9, -10), "filling")
    assert not under(slot_of(tmp_path, filling))


def test_a_countersink_is_a_cone_to_its_wide_end(tmp_path):
    facts = read_facts(assemblies.countersunk(tmp_path / "sunk.step"))
    bore = one_bore(facts, "plate")
    cone = countersink(facts, bore, top=True)
    assert cone.outer == pytest.approx(13.2e-3)
    slant = sqrt(2) * 3.3
    assert sum(face.area for face in cone.faces) == pytest.approx(pi * (3.3 + 6.6) * slant * 1e-6, rel=1e-6)
    assert countersink(facts, bore, top=False) is None


def test_a_slot_is_one_hole_with_its_axis_in_the_middle(tmp_path):
    facts = read_facts(assemblies.channel(tmp_path / "channel.step"))
    slots = [bore for bore in bores(facts) if bore.part == "channel"]
    assert len(slots) == 2
    for slot, x in zip(slots, (30, 90), strict=True):
        assert slot.radius == pytest.approx(4.5e-3)
        assert np.abs(slot.slot) == pytest.approx([12e-3, 0, 0], abs=1e-9)
        assert slot.line.at(slot.low) == pytest.approx([x * 1e-3, 30e-3, 12e-3], abs=1e-9)
    assert [row.parts for row in rows(bores(facts), reach=1e-3)] == [("plate", "channel")] * 2


def test_a_bolt_may_stand_anywhere_in_a_slot(tmp_path):
    from netgen.occ import Cylinder, Pnt, Z

    def hole(x, low):
        return Cylinder(Pnt(x, 20, low), Z, r=4.5, h=10)

    slotted = box((0, 0, 10), (60, 40, 20)) - box((20, 15.5, 10), (40, 24.5, 20)) - hole(20, 10) - hole(40, 10)
    for x, met in ((38.0, True), (44.0, False)):
        plate = box((0, 0, 0), (60, 40, 10)) - hole(x, 0)
        solids = [next(iter(one.solids)) for one in (plate, slotted)]
        found = rows(bores(read_facts(written(tmp_path / f"{met}.step", *solids))), reach=1e-3)
        assert [len(row.bores) for row in found] == ([2] if met else [1, 1])
        if met:
            assert found[0].middle == pytest.approx([x * 1e-3, 20e-3, 10e-3])
