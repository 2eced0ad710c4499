"""Facts of CAD faces against what they were made from: planes, cylinders, neighbours, contacts, gaps, overlaps."""

import numpy as np
import pytest

from faying.geometry.face_facts import part_distance, read_facts, shape_of


def written(path, *solids):
    from netgen.occ import Compound

    Compound(list(solids)).WriteStep(str(path))
    return path


def box(low, high, name=""):
    from netgen.occ import Box, Pnt

    solid = next(iter(Box(Pnt(*low), Pnt(*high)).solids))
    if name:
        solid.name = name
    return solid


@pytest.fixture(scope="module")
def turned(tmp_path_factory):
    """A plate with a hole and a boss, turned about a slanted axis, so that nothing is along an axis."""
    from netgen.occ import Axis, Cylinder, Vec, Z

    solid = box((0, 0, 0), (40, 30, 10)) - Cylinder((12, 15, -1), Z, r=4, h=12) + Cylinder((30, 15, 10), Z, r=5, h=6)
    solid = next(iter(solid.Rotate(Axis((0, 0, 0), Vec(1, 2, 3)), 40).solids))
    solid.name = "part"
    return read_facts(written(tmp_path_factory.mktemp("t") / "t.step", solid))


def rotation(axis, degrees):
    k = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    a = np.deg2rad(degrees)
    return np.eye(3) + np.sin(a) * cross + (1 - np.cos(a)) * cross @ cross


def test_planes_and_cylinders_of_a_turned_part(turned):
    R = rotation((1, 2, 3), 40)
    hole = next(face for face in turned.faces if face.hole)
    boss = next(face for face in turned.faces if face.kind == "cylinder" and not face.hole)
    for face, radius, length, start in ((hole, 4e-3, 10e-3, (12, 15)), (boss, 5e-3, 6e-3, (30, 15))):
        assert face.radius == pytest.approx(radius, rel=1e-9)
        assert face.length == pytest.approx(length, rel=1e-9)
        assert face.turn == pytest.approx(1.0, rel=1e-6)
        assert face.area == pytest.approx(2 * np.pi * radius * length, rel=1e-9)
        assert abs(np.dot(face.axis, R[:, 2])) == pytest.approx(1.0, abs=1e-9)
        aside = R.T @ np.array(face.start) - 1e-3 * np.array([*start, 0.0])
        assert aside[:2] == pytest.approx([0, 0], abs=1e-9)
    normals = {tuple(np.round(R.T @ face.normal, 9) + 0.0) for face in turned.faces if face.kind == "plane"}
    assert normals == {(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)}
    assert sum(face.area for face in turned.faces) == pytest.approx(turned.parts[0].area)


def test_normals_point_outwards(turned):
    """By the divergence theorem the planes and cylinders, as triangles, enclose the volume of the part."""
    x, y, z = turned.corners.transpose(1, 0, 2)
    volume = np.einsum("ti,ti->", x, np.cross(y, z)) / 6
    assert volume == pytest.approx(turned.parts[0].volume, rel=2e-3)
    for face in turned.faces:
        if face.kind == "plane":
            tris = turned.triangles(face)
            assert np.cross(tris[:, 1] - tris[:, 0], tris[:, 2] - tris[:, 0]) @ face.normal == pytest.approx(
                np.linalg.norm(np.cross(tris[:, 1] - tris[:, 0], tris[:, 2] - tris[:, 0]), axis=1)
            )


def test_neighbours_are_mutual_and_those_of_a_box(turned):
    sets = {face.number: set(face.neighbours) for face in turned.faces}
    assert all(number in sets[other] for number, others in sets.items() for other in others)
    hole = next(face for face in turned.faces if face.hole)
    assert {turned.face("part", number).kind for number in hole.neighbours} == {"plane"}
    assert len(hole.neighbours) == 2


@pytest.mark.parametrize("gap", [0.0, 0.1, -0.1])
def test_contact_area_and_gap_of_two_blocks(tmp_path, gap):
    """The second block overhangs the first: they face each other over 30 mm x 20 mm, with the gap that was made."""
    path = written(tmp_path / "two.step", box((0, 0, 0), (40, 20, 10), "a"), box((10, 0, 10 + gap), (60, 30, 20), "b"))
    facts = read_facts(path, overlaps=True)
    (contact,) = [one for one in facts.contacts if facts.face(*one.first).normal == (0.0, 0.0, 1.0)]
    assert contact.area == pytest.approx(600e-6, rel=1e-9)
    assert contact.gap == pytest.approx(gap * 1e-3, abs=1e-12)
    assert bool(facts.overlaps) == (gap < 0)
    if gap < 0:
        assert "'a' and 'b' share 30 x 20 x 0.1 mm about (25, 10, 9.95) mm" in facts.overlaps[0]


def test_a_shaft_in_a_hole_is_a_contact_with_its_clearance(tmp_path):
    from netgen.occ import Cylinder, Z

    for radius, gap in ((4.0, 0.0), (3.9, 1e-4)):
        plate = box((-20, -20, 0), (20, 20, 10)) - Cylinder((0, 0, -1), Z, r=4, h=12)
        pin = next(iter(Cylinder((0, 0, -5), Z, r=radius, h=20).solids))
        plate = next(iter(plate.solids))
        plate.name, pin.name = "plate", "pin"
        facts = read_facts(written(tmp_path / "pin.step", plate, pin))
        (contact,) = facts.contacts
        assert contact.gap == pytest.approx(gap, abs=1e-9)
        assert contact.area == pytest.approx(2 * np.pi * 4e-3 * 10e-3, rel=1e-6)  # that of the hole


def test_a_round_contact_has_its_area_and_a_slanted_cylinder_its_extent(tmp_path):
    """Not those of chords: a ring from 5 to 10 mm; x of a cylinder of radius r and length l about (1, 1, 0)."""
    from netgen.occ import Cylinder, Dir, Pnt, Z

    ring = Cylinder(Pnt(0, 0, 10), Z, r=10, h=5) - Cylinder(Pnt(0, 0, 10), Z, r=5, h=5)
    slanted = Cylinder(Pnt(50, 0, 5), Dir(1, 1, 0), r=5, h=20)
    facts = read_facts(written(tmp_path / "r.step", box((-20, -20, 0), (20, 20, 10)), ring, slanted))
    assert facts.contacts[0].area == pytest.approx(np.pi * (10**2 - 5**2) * 1e-6, rel=1e-9)
    low, high = facts.parts[-1].low[0], facts.parts[-1].high[0]
    assert (low, high) == pytest.approx((50e-3 - 5e-3 / 2**0.5, 50e-3 + 25e-3 / 2**0.5), abs=2e-9)


def test_parts_far_apart(tmp_path):
    path = written(tmp_path / "far.step", box((0, 0, 0), (10, 10, 10), "a"), box((0, 0, 13), (10, 10, 20), "b"))
    assert not read_facts(path).contacts
    one, two, distance = part_distance(path)
    assert {one, two} == {"a", "b"}
    assert distance == pytest.approx(3e-3)
    assert part_distance(written(tmp_path / "one.step", box((0, 0, 0), (1, 1, 1)))) is None


def test_a_cone_and_a_sphere_are_neither_plane_nor_cylinder(tmp_path):
    from netgen.occ import Cone, Pnt, Sphere, Z, gp_Ax2

    cone = next(iter(Cone(gp_Ax2(Pnt(0, 0, 0), Z), 5, 3, 10, 6.283185307179586).solids))
    ball = next(iter(Sphere(Pnt(40, 0, 0), 5).solids))
    kinds = [face.kind for face in read_facts(written(tmp_path / "c.step", cone, ball)).faces]
    assert sorted(kinds) == ["other", "other", "plane", "plane"]


def test_a_face_of_which_the_kernel_makes_no_triangles_is_of_no_kind():
    """As of text on a part whose bounds do not close; a whole file was refused for one."""
    assert shape_of(np.zeros((0, 3, 3)), np.zeros((0, 3, 3)), 7e-6) == {"kind": "other"}
