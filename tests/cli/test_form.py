"""`faying form`: what it prints of a known form."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import faying
from faying.cli.main import cli


@pytest.fixture
def file(tmp_path):
    x, y = np.meshgrid(np.linspace(0, 40, 30), np.linspace(0, 90, 40))
    heights = -6 * ((y - 45) / 45) ** 2 + 0.5 * x  # um over mm: crowned along y, tilted
    path = tmp_path / "face.csv"
    np.savetxt(path, np.column_stack([x.ravel(), y.ravel(), heights.ravel()]), delimiter=",", header="x, y, z")
    return path


def test_text_and_json(file, tmp_path):
    units = ["--xy-unit", "mm", "--z-unit", "um"]
    done = CliRunner().invoke(cli, ["form", str(file), *units, "--plot", str(tmp_path / "map.png")])
    assert done.exit_code == 0, done.output
    assert 'crown_along = "6 um"' in done.output
    assert "90 mm x 40 mm, longer along y" in done.output
    assert (tmp_path / "map.png").stat().st_size > 10_000
    found = json.loads(CliRunner().invoke(cli, ["form", str(file), *units, "--json"]).output)
    assert found["flatness"] == {"unit": "m", "values": pytest.approx(6e-6, rel=1e-3)}  # no point on the very top
    as_gap = json.loads(CliRunner().invoke(cli, ["form", str(file), *units, "--gap", "--json"]).output)
    assert as_gap["crown_along"]["values"] == pytest.approx(-6e-6)


def test_gaps_are_no_heights(file, tmp_path):
    """A gap that is wide in the middle is a hollow: without --gap its crowns came out with the other sign."""
    gaps = tmp_path / "gap.csv"
    gaps.write_text(file.read_text().replace("x, y, z", "x [mm], y [mm], gap [um]").replace("# ", ""))
    done = CliRunner().invoke(cli, ["form", str(gaps)])
    assert isinstance(done.exception, faying.FayingError)
    found = json.loads(CliRunner().invoke(cli, ["form", str(gaps), "--gap", "--json"]).output)
    assert found["crown_along"]["values"] == pytest.approx(-6e-6)


def test_what_it_refuses(file):
    done = CliRunner().invoke(cli, ["form", str(file), "--xy-unit", "mm"])
    assert isinstance(done.exception, faying.InputError)
    assert "give z_unit" in str(done.exception)
