"""How the force of a bolt is shared by joints side by side: against a quadrature of the cone, and symmetry."""

import numpy as np
import pytest

import faying
from faying.bolt.bolt import BoltPlace
from faying.bolt.seat import Seat
from faying.bolt.vdi2230 import cone_angle
from faying.geometry.face_triangles import FaceTriangles
from faying.setup.reach import WIDE, load_shares

HOLE, SEAT, LENGTH, DEPTH = 9e-3, 16e-3, 40e-3, 15e-3


def strips(*edges):
    """Faces at z = 0 from one x to the next [mm], 200 mm wide: pairs of one from above and one from below."""
    points, triangles, owner = [], {}, {}
    for k, (low, high) in enumerate(edges):
        for side in ("up", "down"):
            start = len(points)
            points += [(x, y, 0.0) for x, y in ((low, -100), (high, -100), (high, 100), (low, 100))]
            triangles[f"{side} {k}"] = np.array([[0, 1, 2], [0, 2, 3]]) + start
            owner[f"{side} {k}"] = side
    return FaceTriangles(points=1e-3 * np.array(points, float), triangles=triangles, face_part=owner, size=0.3)


def shared(mesh, count, depths=None, ring=(HOLE, SEAT)):
    bolt = faying.Bolt("bolt", ("up 0", "down 0"), seat=ring)
    axis = np.array([0.0, 0.0, -1.0])
    pressed = (Seat(face="up 0", inner=ring[0], outer=ring[1], area=1e-4),)
    place = BoltPlace(bolt=bolt, point=np.array([0, 0, DEPTH]), axis=axis, length=LENGTH, ring=ring, pressed=pressed)
    names = [f"joint {k}" for k in range(count)]
    found = load_shares(
        mesh,
        {name: (f"up {k}", f"down {k}") for k, name in enumerate(names)},
        {name: [(place, DEPTH if depths is None else depths[k])] for k, name in enumerate(names)},
        dict.fromkeys(names, 1e-3),
    )
    return [found[name][0] for name in names]


def weight(low, high):
    """Pressure of the cone, 1 at the hole, over low < x < high [m2], on a square grid."""
    edge = SEAT / 2 + DEPTH * cone_angle(LENGTH, SEAT, WIDE * SEAT)
    step = 2 * edge / 2000
    axis = -edge + step * (np.arange(2000) + 0.5)
    r = np.hypot(axis[:, None], axis[None])
    pressure = np.where((r > HOLE / 2) & (r < edge), (edge - r) / (edge - HOLE / 2), 0.0)
    return float(pressure[(axis > low) & (axis < high)].sum() * step**2)


def test_two_faces_alike_on_both_sides_have_half_each():
    first, second = shared(strips((-100, -5), (5, 100)), 2)
    assert first.share == pytest.approx(0.5, abs=1e-6)
    assert second.share == pytest.approx(0.5, abs=1e-6)
    assert first.rise == second.rise > 1


def test_shares_are_those_of_a_quadrature_of_the_cone():
    edges = ((-100, -6), (-2, 4), (8, 100))
    found = shared(strips(*edges), 3)
    each = np.array([weight(1e-3 * low, 1e-3 * high) for low, high in edges])
    assert [one.share for one in found] == pytest.approx(each / each.sum(), abs=0.01)
    ring = weight(-1.0, 1.0)
    assert [one.rise for one in found] == pytest.approx([ring / each.sum()] * 3, rel=0.02)
    assert sum(one.share for one in found) == pytest.approx(1)


def test_joints_one_behind_the_other_carry_all_of_it():
    found = shared(strips((-100, 100), (-100, 100)), 2, depths=(10e-3, 20e-3))
    assert [(one.share, one.rise) for one in found] == [(1.0, 1.0)] * 2


def test_without_a_cone_the_areas_share():
    found = shared(strips((60, 100), (-100, -60)), 2)
    assert [one.share for one in found] == pytest.approx([0.5, 0.5])
