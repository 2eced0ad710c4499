"""Selectors in a study: in [geometry.face], in joints, bolts, supports and masses; their faults."""

import tomllib

import pytest

import faying
from faying.case.case import checked_mesh
from faying.geometry.selectors import Selector
from faying.study import Study
from faying.study.keys.geometry import GeometryChoice, with_faces
from tests.helpers.boxes import row
from tests.helpers.studies import write


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    write(folder / "study.toml")
    return folder


def study(folder, **tables):
    data = tomllib.loads((folder / "study.toml").read_text())
    return Study.from_dict(data | tables, folder=folder)


UPPER = {"part": "upper", "touching": "lower"}
LOWER = {"part": "lower", "touching": "upper"}


def test_joint_bolt_support_and_mass_take_selectors(folder):
    data = tomllib.loads((folder / "study.toml").read_text())
    found = study(
        folder,
        geometry=data["geometry"] | {"face_size": {}, "face": {"below": {"part": "lower", "normal": [0, 0, -2]}}},
        joint=[{"name": "lap", "faces": [UPPER, LOWER]}],
        bolt=[{"faces": [{"part": "upper", "nearest": ["6 mm", "0 mm", "15 mm"]}, "lower.seat"], "preload": "6 kN"}],
        support=[{"face": {"part": "lower", "number": 2, "normal": "-x", "all": True}}],
        mass=[{"mass": "0.1 kg", "face": {"part": "upper", "normal": "+x"}}],
    )
    assert found.joints[0].faces == ("lap first", "lap second")
    assert found.bolts[0].faces == ("bolt 1 first", "lower.seat")
    assert found.supports[0].face == "support[1]"
    assert found.masses[0].face == "mass[1]"
    face = found.geometry.face
    assert face["lap first"] == Selector(part="upper", touching="lower")
    assert face["below"].normal == (0.0, 0.0, -1.0)
    assert face["support[1]"] == Selector(part="lower", number=2, normal=(-1.0, 0.0, 0.0), all=True)
    assert face["mass[1]"].normal == (1.0, 0.0, 0.0)


def test_the_mesh_has_the_faces_that_selectors_name(folder):
    """Selectors and the names of the file mean the same faces: the meshes have the same elements there."""
    seats = [{"part": p, "nearest": ["6 mm", "0 mm", z]} for p, z in (("upper", "15 mm"), ("lower", "-15 mm"))]
    made = checked_mesh(study(folder, joint=[{"name": "lap", "faces": [UPPER, LOWER]}], bolt=[BOLT | {"faces": seats}]))
    pairs = {"lap first": "upper.joint", "lap second": "lower.joint", "bolt 1 first": "upper.seat"}
    for label, name in pairs.items():
        assert (made.face(label)[0] == made.face(name)[0]).all()
        assert made.face_part[label] == made.face_part[name]


BOLT = {"preload": "6 kN"}


@pytest.mark.parametrize(
    ("selector", "fault"),
    [
        ({"part": "upper"}, r"joint\[1\].faces\[1\] gives a part but no face of it; add normal"),
        (
            {"part": "upper", "normal": "up"},
            r'normal = "up" should be one of \+x, -x, \+y, -y, \+z, -z, or three numbers',
        ),
        ({"part": "upper", "normal": [0, 0, 0]}, "has no length"),
        ({"part": "upper", "nearest": [0, 0, 5]}, "has no unit"),
        ({"part": "upper", "number": 0}, "whole number from 1 to"),
        ({"part": "upper", "number": 1, "within": "1 mm"}, "within needs nearest"),
        ({"part": "upper", "touch": "lower"}, "did you mean touching"),
        ({"part": "upper", "number": 1, "all": "yes"}, "should be true or false"),
        ({"normal": "+z"}, r"joint\[1\].faces\[1\].part is missing"),
        (7, "should be a list of 2 names"),
    ],
)
def test_faults_of_a_selector(folder, selector, fault):
    with pytest.raises(faying.InputError, match=fault):
        study(folder, joint=[{"faces": [selector, "lower.joint"]}])


def test_a_name_is_not_given_twice(folder):
    geometry = {"step": "two-blocks.step", "size": "8 mm", "face": {"lap first": {"part": "upper", "number": 1}}}
    with pytest.raises(faying.InputError, match="the name that a selector elsewhere gets"):
        study(folder, geometry=geometry, joint=[{"name": "lap", "faces": [UPPER, LOWER]}])


def test_selectors_choose_among_the_named_faces_of_a_mesh():
    mesh = row((0.06, 0.04), (3, 2), width=0.02, height=0.01)
    spec = GeometryChoice(face={"end": Selector(part="p1", normal=(1.0, 0.0, 0.0))})
    made = with_faces(mesh, spec)
    assert (made.face("end")[0] == mesh.face("p1.right")[0]).all()
    assert made.face_part["end"] == "p1"
    with pytest.raises(faying.InputError, match="has a face of this name already"):
        with_faces(mesh, GeometryChoice(face={"p1.right": Selector(part="p1", number=1)}))
