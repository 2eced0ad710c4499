"""faying view: what each kind of file shows, where the page is written, and what is refused."""

import json
import re
import webbrowser
from pathlib import Path

import pytest
from click.testing import CliRunner

from faying.cli.main import cli
from faying.errors import InputError, ReadError
from tests.helpers.scenes import two_boxes

EXAMPLES = Path(__file__).parents[2] / "examples"


def view(*arguments):
    done = CliRunner().invoke(cli, ["view", *map(str, arguments)])
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    return done


def scene(page):
    return json.loads(re.search('id="scene">(.*?)</script>', page.read_text(encoding="utf-8"), re.S).group(1))


def test_a_study_shows_its_mesh_with_joints_bolts_and_nothing_solved(tmp_path):
    page = tmp_path / "a.html"
    said = view(EXAMPLES / "two-blocks" / "study.toml", "--out", page, "--no-open").output
    assert "2 parts" in said
    assert str(page) in said
    found = scene(page)
    assert [joint["name"] for joint in found["joints"]] == ["joint"]
    assert len(found["bolts"]) == 1
    assert found["modes"] is None
    assert found["loads"] == []


def test_a_result_shows_its_modes_and_lies_beside_it_by_default(tmp_path):
    two_boxes().save(tmp_path / "result.nc")
    view(tmp_path / "result.nc", "--no-open")
    found = scene(tmp_path / "result-view.html")
    assert len(found["modes"]["frequencies"][0]) == 3
    assert found["joints"][0]["map"] == "map0"


def test_a_step_file_and_a_mesh_show_parts_and_faces(tmp_path):
    page = tmp_path / "a.html"
    view(EXAMPLES / "plates-and-bolts" / "plates.step", "--out", page, "--no-open")
    assert {face["name"] for face in scene(page)["faces"]} > {"upper.joint", "lower.joint"}
    view(EXAMPLES / "two-blocks" / "model.inp", "--unit", "mm", "--out", page, "--no-open")
    assert {face["name"] for face in scene(page)["faces"]} > {"FACE_A", "FACE_B"}


def test_the_page_is_opened_unless_that_is_refused(tmp_path, monkeypatch):
    opened = []
    monkeypatch.setattr(webbrowser, "open", lambda address: opened.append(address) or False)
    two_boxes().save(tmp_path / "result.nc")
    said = view(tmp_path / "result.nc")
    assert opened == [(tmp_path / "result-view.html").as_uri()]
    assert "no browser was found" in said.stderr
    view(tmp_path / "result.nc", "--no-open")
    assert len(opened) == 1


def test_what_cannot_be_looked_at_is_said(tmp_path):
    with pytest.raises(ReadError, match="no file"):
        view(tmp_path / "none.step")
    with pytest.raises(InputError, match="does not state its unit"):
        view(EXAMPLES / "two-blocks" / "model.inp", "--no-open")
    two_boxes().save(tmp_path / "result.nc")
    with pytest.raises(InputError, match="states its units"):
        view(tmp_path / "result.nc", "--unit", "mm")
