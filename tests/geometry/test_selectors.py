"""Selectors of faces: what they choose, what they refuse and which candidates they list, from facts and in meshes."""

import pytest

import faying
from faying.fe.sides import face_centre
from faying.geometry.face_facts import read_facts
from faying.geometry.geometry import mesh_step
from faying.geometry.selectors import Selector, chosen, points_of
from tests.geometry.test_face_facts import box, written


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """A base with two pads on which a plate lies; a lid 0.2 mm above the plate."""
    base = box((0, 0, 0), (60, 20, 10)) + box((0, 0, 10), (15, 20, 14)) + box((45, 0, 10), (60, 20, 14))
    base = next(iter(base.solids))
    base.name = "base"
    plate, lid = box((0, 0, 14), (60, 20, 20), "plate"), box((0, 0, 20.2), (60, 20, 26), "lid")
    return written(tmp_path_factory.mktemp("s") / "pads.step", base, plate, lid)


POINTS = {"pad": (7e-3, 10e-3, 14e-3), "floor": (30e-3, 10e-3, 10.5e-3), "beside": (-3e-3, 10e-3, 3e-3)}


@pytest.fixture(scope="module")
def facts(path):
    points = points_of({label: Selector(part="base", nearest=at) for label, at in POINTS.items()})
    return read_facts(path, points=points)


def select(facts, label="it", snap=0.0, **given):
    return chosen(label, Selector(nearest=POINTS.get(label), **given), facts, snap=snap)


@pytest.mark.parametrize(
    ("given", "centre", "area"),
    [
        ({"part": "plate", "normal": (0, 0, 1)}, (30, 10, 20), 1200),
        ({"part": "plate", "touching": "base"}, (30, 10, 14), 1200),
        ({"part": "base", "normal": (0, 0, -1)}, (30, 10, 0), 1200),
        ({"part": "base", "touching": "plate", "label": "pad"}, (7.5, 10, 14), 300),
        ({"part": "base", "normal": (0, 0, 1), "label": "floor"}, (30, 10, 10), 600),
        ({"part": "base", "label": "beside", "within": 5e-3}, (0, 10, 7), None),
    ],
)
def test_one_face_is_chosen(facts, given, centre, area):
    (face,) = select(facts, **given)
    assert 1e3 * face.centre[0] == pytest.approx(centre[0], abs=1e-6)
    assert 1e3 * face.centre[2] == pytest.approx(centre[2], abs=1e-6)
    assert area is None or 1e6 * face.area == pytest.approx(area)


def test_a_number_is_that_of_the_table(facts):
    for face in facts.by_part["base"]:
        assert select(facts, part="base", number=face.number)[0] == face
    with pytest.raises(faying.InputError, match=r"no face of 'base' fits .*number = 99; it has \d+: number"):
        select(facts, part="base", number=99)


def test_several_faces_are_refused_with_a_list_or_taken_together(facts):
    with pytest.raises(faying.InputError) as fault:
        select(facts, part="base", touching="plate")
    text = str(fault.value)
    assert "2 faces fit part = 'base', touching = 'plate'" in text
    assert "(300 mm2 about (7.5, 10, 14) mm, normal (0, 0, 1))" in text
    assert "(300 mm2 about (52.5, 10, 14) mm, normal (0, 0, 1))" in text
    assert "all = true" in text
    assert len(select(facts, part="base", touching="plate", all=True)) == 2


def test_a_gap_is_no_touching_unless_snap_covers_it(facts):
    with pytest.raises(faying.InputError, match=r"touches it; nearest is number .* 200 um away; geometry.snap of 200"):
        select(facts, part="lid", touching="plate")
    (face,) = select(facts, snap=0.25e-3, part="lid", touching="plate")
    assert 1e3 * face.centre[2] == pytest.approx(20.2)


def test_a_normal_holds_within_a_degree(facts):
    from math import cos, radians, sin

    for degrees, fits in ((0.9, True), (1.1, False)):
        tilted = (sin(radians(degrees)), 0.0, cos(radians(degrees)))
        if fits:
            assert select(facts, part="plate", normal=tilted)
            continue
        with pytest.raises(faying.InputError, match="no face of 'plate' fits"):
            select(facts, part="plate", normal=tilted)


@pytest.mark.parametrize("given", [{"part": "roof", "number": 1}, {"part": "base", "touching": "roof"}])
def test_an_unknown_part_is_refused(facts, given):
    with pytest.raises(faying.InputError, match="no part is called 'roof'; the parts are 'base', 'plate', 'lid'"):
        select(facts, **given)


def test_a_meshed_face_is_the_face_that_was_chosen(path):
    """The pads together make one face of the mesh; a face of the other part lies on both."""
    chosen_faces = {
        "pads": Selector(part="base", touching="plate", all=True),
        "plate.under": Selector(part="plate", normal=(0, 0, -1)),
    }
    with pytest.raises(faying.InputError, match="the file has a face of this name"):
        mesh_step(named(path), size=10e-3, faces={"top": Selector(part="plate", number=1)})
    mesh = mesh_step(path, size=10e-3, faces=chosen_faces)
    centre, normal, area = face_centre(mesh.points, mesh.face("pads"))
    assert area == pytest.approx(600e-6)
    assert 1e3 * centre == pytest.approx([30, 10, 14])
    assert normal == pytest.approx([0, 0, 1])
    assert face_centre(mesh.points, mesh.face("plate.under"))[2] == pytest.approx(1200e-6)
    assert mesh.face_part["pads"] == "base"


def named(path):
    other = path.with_name("named.step")
    solid = box((0, 0, 0), (10, 10, 10), "plate")
    for face in solid.faces:
        face.name = "top" if face.center.z > 9 else ""
    return written(other, solid)


def test_a_point_farther_than_its_limit_means_no_face(facts):
    with pytest.raises(faying.InputError, match=r"is 3 mm away, more than 1 mm: number .*check the point and its unit"):
        select(facts, "beside", part="base")
