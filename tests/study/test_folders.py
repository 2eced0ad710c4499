"""Where results of a study lie: two studies in one folder, and the paths that are printed."""

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from faying.app.project import Project
from faying.cli.main import cli
from faying.setup import template
from faying.study import Study
from tests.helpers.results import small_result


def call(*words):
    return CliRunner().invoke(cli, list(map(str, words)), catch_exceptions=False, standalone_mode=False)


@pytest.fixture
def folder(tmp_path):
    """A folder with two studies of one geometry."""
    template.write(tmp_path / "study.toml", force=False)
    (tmp_path / "thick.toml").write_text((tmp_path / "study.toml").read_text())
    return tmp_path


def test_two_studies_in_one_folder_have_two_folders_of_results(folder, monkeypatch):
    monkeypatch.setattr("faying.answer.run.run", lambda *_, **__: small_result())
    monkeypatch.setattr(
        "faying.output.report.write", lambda result, hidden, drawn=True: [result.save(hidden / "result.nc")]
    )
    first = call("run", folder / "study.toml").output
    written = {path: path.read_bytes() for path in (folder / "results").iterdir()}
    second = call("run", folder / "thick.toml").output
    for out, place in ((first, folder / "results"), (second, folder / "results" / "thick")):
        line = re.search(r"^written to (.+): (.+)$", out, re.M)
        assert Path(line[1]) == place
        assert "result.nc" in line[2]
        assert all((place / name).is_file() for name in line[2].split(", "))
    assert {path: path.read_bytes() for path in written} == written


def test_every_command_and_the_app_know_the_same_folder(folder):
    for name in ("study", "thick"):
        study = Study.read(folder / f"{name}.toml")
        project = Project(folder=folder, study_name=f"{name}.toml")
        assert study.results == project.results
        assert folder / project.results_name == project.results
    assert Study.read(folder / "thick.toml").results == folder / "results" / "thick"
