"""faying faces: the table, its JSON, one part, and the named faces of a mesh file."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

import faying
from faying.cli.faces import command
from faying.geometry.mesh_facts import mesh_facts
from tests.geometry.test_face_facts import box, written
from tests.helpers.boxes import row

EXAMPLE = Path(__file__).parents[2] / "examples" / "two-blocks"


@pytest.fixture(scope="module")
def lap(tmp_path_factory):
    upper = box((0, 0, 10), (60, 20, 20), "upper")
    for face in upper.faces:
        face.name = "a very long name of the joint face" if face.center.z < 11 else ""
    return written(tmp_path_factory.mktemp("lap") / "lap.step", box((0, 0, 0), (60, 20, 10), "lower"), upper)


def call(*words):
    return CliRunner().invoke(command, list(map(str, words)), catch_exceptions=False, standalone_mode=False).output


def test_the_table_fits_80_columns_and_shows_what_touches(lap):
    out = call(lap)
    assert max(map(len, out.splitlines())) <= 80
    assert "lower: 6 faces, 12 cm3, within 60 x 20 x 10 mm" in out
    assert "..f the joint face" in out
    rows = [line.split() for line in out.splitlines()]
    assert any(row[1:5] == ["plane", "1200", "-z", "30"] for row in rows if len(row) > 5)
    assert any(row[:1] == ["lower"] and row[-2:] == ["1200", "0"] for row in rows)


def test_json_in_si_of_one_part(lap):
    out = json.loads(call(lap, "--part", "upper", "--json"))
    assert [one["name"] for one in out["parts"]] == ["upper"]
    top = next(face for face in out["faces"] if face["normal"] == [0, 0, 1])
    assert top["area"] == pytest.approx(1.2e-3)
    assert top["centre"] == pytest.approx([0.03, 0.01, 0.02])
    assert out["contacts"][0]["gap"] == pytest.approx(0, abs=1e-12)
    assert out["units"]["area"] == "m^2"


def test_an_unknown_part_is_refused(lap):
    with pytest.raises(faying.InputError, match="no part is called 'roof'; the parts are 'lower', 'upper'"):
        call(lap, "--part", "roof")


def test_the_named_faces_of_a_mesh():
    """Two boxes end to end: areas and normals of the ends, the contact between them, and a point's distance."""
    mesh = row((0.06, 0.04), (3, 2), width=0.02, height=0.01)
    facts = mesh_facts(mesh, {"it": ("p1", (0.07, 0.005, 0.005))})
    assert [(face.part, face.name, face.kind, face.normal[0]) for face in facts.faces] == [
        ("p0", "p0.left", "plane", -1.0),
        ("p0", "p0.right", "plane", 1.0),
        ("p1", "p1.left", "plane", -1.0),
        ("p1", "p1.right", "plane", 1.0),
    ]
    assert [face.area for face in facts.faces] == pytest.approx([2e-4] * 4)
    (contact,) = facts.contacts
    assert (contact.first, contact.second) == (("p0", 2), ("p1", 1))
    assert contact.area == pytest.approx(2e-4)
    assert facts.parts[0].volume == pytest.approx(1.2e-5)
    assert facts.distances["it"] == pytest.approx([0.01, 0.03])


def test_a_mesh_file_is_read_with_its_unit(tmp_path):
    out = call(EXAMPLE / "model.inp", "--unit", "mm", "--json")
    faces = {face["name"]: face for face in json.loads(out)["faces"]}
    assert len(faces) >= 2
    with pytest.raises(faying.InputError, match="unit"):
        call(EXAMPLE / "model.inp")
