"""Python gives what the commands give: the same numbers, the same files, and every command has its line."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import faying
from faying.cli.main import COMMANDS, cli
from faying.output.sections import sections
from tests.helpers import studies

ROOT = Path(__file__).parents[2]
BLOCKS = ROOT / "examples" / "two-blocks"
STEP = ROOT / "examples" / "t-specimen" / "t-specimen.step"
PAGE = (ROOT / "docs" / "reference" / "python.md").read_text()


def call(*words):
    found = CliRunner().invoke(cli, [str(word) for word in words], catch_exceptions=False)
    return json.loads(found.stdout)


def plain(tree):
    """A tree as JSON has it."""
    return json.loads(json.dumps(tree))


def test_every_command_has_its_line():
    lines = set(re.findall(r"^\| `faying ([a-z-]+)`", PAGE, re.M))
    terminal = set(
        re.findall(r"`(?:faying )?([a-z-]+)`", PAGE[PAGE.index("`faying app`") : PAGE.index("are for the terminal")])
    )
    assert lines | terminal == set(COMMANDS)
    assert not lines & terminal


def test_every_name_of_the_page_is_there():
    for path in re.findall(r"`(?:faying\.)([A-Za-z_.]+)\(", PAGE):
        owner = faying
        for name in path.split("."):
            owner = getattr(owner, name)
    for words in ("Mates.law", "Mates.compare", "Scan.roughness", "Scan.fractal", "Structure.solve"):
        kind, method = words.split(".")
        assert callable(getattr(getattr(faying, kind), method)), words


def test_faces(tmp_path):
    facts = faying.faces(STEP)
    assert plain(facts.to_dict()) == call("faces", STEP, "--json")
    assert plain(facts.of_part("upper").to_dict()) == call("faces", STEP, "--part", "upper", "--json")
    triangles = sum(len(facts.triangles(face)) for face in facts.faces if face.part == "upper")
    alone = facts.of_part("upper")
    assert sum(len(alone.triangles(face)) for face in alone.faces) == triangles
    with pytest.raises(faying.InputError, match="no part is called 'none'; the parts are 'upper', 'lower'"):
        facts.of_part("none")
    with pytest.raises(faying.InputError, match="a STEP file states its unit"):
        faying.faces(STEP, unit="mm")


def test_check(tmp_path):
    found, printed = faying.check(BLOCKS / "study.toml"), call("check", BLOCKS / "study.toml", "--json")
    assert plain(found.to_dict()) == printed
    notes = sum(one.level == "note" for one in found.findings)
    assert re.fullmatch(rf"{len(found.faults)} faults?, {notes} notes?", found.count)
    levels = [one.level for one in found.by_level]
    assert levels == sorted(levels, key=("fault", "note", "ok").index)
    assert len(repr(found).splitlines()) <= 12


@pytest.mark.slow
def test_a_study_of_a_geometry(tmp_path):
    by_hand, by_command = tmp_path / "python" / "s.toml", tmp_path / "command" / "s.toml"
    for path in (by_hand, by_command):
        path.parent.mkdir()
    made = faying.new_study(STEP, by_hand)
    call("new", STEP, "--yes", "--json", "--out", by_command)
    assert by_hand.read_text() == by_command.read_text()
    assert [file.name for file in made.files] == ["s.toml", "s-surface.x3p"]
    assert "2 bolts" in repr(made)
    with pytest.raises(faying.InputError, match="exists already"):
        faying.new_study(STEP, by_hand)


def test_what_is_given_of_a_geometry_stands_in_its_study(tmp_path):
    scan = ROOT / "examples" / "t-specimen" / "milled.x3p"
    made = faying.new_study(STEP, tmp_path / "s.toml", scan=scan, materials={"upper": "45 steel"}, preload="12 kN")
    study = faying.Study.read(made.files[0])
    assert study.parts["upper"] == "45 steel"
    assert study.preloads[0].forces == pytest.approx([12e3, 12e3])
    assert len(made.files) == 1
    for wrong, words in (
        ({"materials": {"none": "45 steel"}}, "no part is called 'none'"),
        ({"materials": "cheese"}, 'material "cheese" is not in the catalogue'),
        ({"preload": "12"}, "preload"),
    ):
        with pytest.raises(faying.InputError, match=words):
            faying.new_study(STEP, tmp_path / "t.toml", **wrong)
    assert not (tmp_path / "t.toml").exists()


def test_a_joint_in_a_model(tmp_path):
    study, mesh = BLOCKS / "study.toml", BLOCKS / "model.inp"
    faces = ("FACE_A", "FACE_B")
    made = faying.attach(mesh, faces, unit="mm", study=study, pressure="5 MPa", frequency="500 Hz", tolerance="0.1 mm")
    files = made.write("mapdl", tmp_path / "python")
    words = ("--face-a", faces[0], "--face-b", faces[1], "--unit", "mm", "--law", study, "--pressure", "5 MPa")
    options = ("--frequency", "500 Hz", "--tolerance", "0.1 mm", "--to", "mapdl", "--out", tmp_path / "command")
    found = call("attach", mesh, *words, *options, "--json")
    assert [Path(file).name for file in found["files"]] == [file.name for file in files]
    for file in files:
        assert file.read_bytes() == (tmp_path / "command" / file.name).read_bytes()


LOSSY = """
[response]
from = "100 Hz"
to = "2 kHz"
points = 5
structural_loss = 0.03
[[response.input]]
point = ["40 mm", "15 mm", "15 mm"]
direction = [0, 0, 1]
[[response.output]]
point = ["40 mm", "15 mm", "15 mm"]
direction = [0, 0, 1]
"""
SHAKEN = """
[[vibration]]
name = "noise"
psd = [["20 Hz", "+3 dB/oct"], ["80 Hz", "0.001 N^2/Hz"], ["2 kHz", "0.001 N^2/Hz"]]
point = ["40 mm", "15 mm", "15 mm"]
duration = "1 min"
"""


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """Two blocks, quick to solve."""
    path = tmp_path_factory.mktemp("small") / "study.toml"
    studies.write(path)
    return path


@pytest.mark.slow
def test_a_condensed_joint(small, tmp_path):
    found = faying.condense(small, points=(("0 mm", "0 mm", "1 mm"), None))
    printed = call("condense", small, "--point-a", "0 mm; 0 mm; 1 mm", "--json")
    stiffness = np.array(printed["stiffness"]["values"])
    assert found.joint.stiffness == pytest.approx(stiffness, rel=1e-9, abs=1e-9 * np.abs(stiffness).max())
    assert found.points[0] == pytest.approx([0, 0, 1e-3])
    assert found.write("nastran", tmp_path / "k", unit="mm")
    with pytest.raises(faying.InputError, match="no exporter"):
        found.write("calculix", tmp_path / "c", unit="mm")
    assert not (tmp_path / "c").exists()


@pytest.mark.slow
def test_modes_of_matrices(small, tmp_path):
    CliRunner().invoke(cli, ["modes", str(small), "--export", str(tmp_path / "m")], catch_exceptions=False)
    files = tmp_path / "m" / "stiffness.npz", tmp_path / "m" / "mass.npz"
    found = faying.matrix_modes(*files, count=8)
    printed = call("modes", "--stiffness", files[0], "--mass", files[1], "--count", 8, "--json")
    assert found.frequencies[6:] == pytest.approx(printed["frequencies"]["values"][6:], rel=1e-9)
    assert found.shapes.shape == (len(found.dofs), 8)
    assert found.missed == 0
    of_study = faying.matrix_modes(small, count=8)
    assert of_study.frequencies[6:] == pytest.approx(found.frequencies[6:], rel=1e-9)
    for wrong in ({"count": 0}, {"shift": "0 Hz"}, {"mass_unit": "N"}):
        with pytest.raises(faying.InputError):
            faying.matrix_modes(*files, **wrong)


@pytest.mark.slow
def test_a_report(small, tmp_path):
    """The files of a run, and nothing where the folder cannot be made."""
    result = faying.run(small)
    files = faying.write_report(result, tmp_path / "out")
    CliRunner().invoke(cli, ["run", str(small), "--out", str(tmp_path / "run")], catch_exceptions=False)
    assert {file.name for file in files} == {file.name for file in (tmp_path / "run").iterdir()}
    assert faying.load(tmp_path / "out" / "result.nc") == result
    (tmp_path / "file").write_text("")
    with pytest.raises(faying.InputError, match="a file has this name"):
        faying.write_report(result, tmp_path / "file")


@pytest.mark.slow
def test_vibration_in_service(small, tmp_path):
    """The command prints what the result of a run has; faying.load reads what it saves."""
    text = small.read_text().replace("[[joint]]\n", "[[joint]]\nfriction = 0.2\n") + LOSSY + SHAKEN
    study = tmp_path / "shaken.toml"
    for file in small.parent.iterdir():
        if file.is_file() and file != small:
            (tmp_path / file.name).write_bytes(file.read_bytes())
    study.write_text(text)
    result = faying.run(study)
    printed = call("vibration", study, "--json", "--out", tmp_path / "v.nc")
    assert plain([one.to_dict() for one in result.vibrations]) == printed["vibrations"]
    assert plain(faying.load(tmp_path / "v-1.nc").to_dict()) == printed["vibrations"][0]
    assert any(section.name == "vibration" for section in sections(result))
    # the loss factor of the parts, which stands in [response], damps in both
    assert np.all(result.vibrations[0].rest_damping[1] > 0.01)
