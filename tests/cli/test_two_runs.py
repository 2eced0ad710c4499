"""`faying compare` of two results: at each preload that both have, at one, as JSON and as files."""

import csv
import json

import numpy as np
import pytest

import faying
from faying.cli import main
from tests.helpers.scenes import two_boxes


def run(*args):
    with pytest.raises(SystemExit) as stop:
        main([str(arg) for arg in args])
    return stop.value.code


@pytest.fixture
def files(tmp_path):
    first = two_boxes()
    second = two_boxes(frequencies=first.frequencies * np.array([[1.02], [0.99]]))
    return first.save(tmp_path / "first.nc"), second.save(tmp_path / "second.nc")


def test_every_preload_that_both_have(files, capsys):
    assert run("compare", *files) == 0
    out = capsys.readouterr().out
    low, high = out.index("\n2 kN\n"), out.index("\n8 kN\n")
    assert out[low:high].count("+2.00") == out[high:].count("-1.00") == 3
    assert max(map(len, out.splitlines()[2:])) <= 80


def test_one_preload_as_json_and_files(files, tmp_path, capsys):
    assert run("compare", *files, "--load", "2 kN", "--out", tmp_path / "out", "--json") == 0
    document = json.loads(capsys.readouterr().out)
    (one,) = document["differences"]
    assert one["preloads"] == [2e3, 2e3]
    for mode in one["modes"]:
        assert mode["frequencies"][1] / mode["frequencies"][0] == pytest.approx(1.02, rel=1e-12)
        assert mode["mac"] == pytest.approx(1.0)
    assert one["joints"]["flange"][0] == one["joints"]["flange"][1]
    table, picture = (tmp_path / "out" / f"difference-2-kN.{kind}" for kind in ("csv", "svg"))
    assert document["files"] == [str(table), str(picture)]
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert [float(row["second frequency [Hz]"]) for row in rows] == [m["frequencies"][1] for m in one["modes"]]
    assert "<svg" in picture.read_text()


@pytest.mark.parametrize(
    ("more", "match"),
    [
        (("--load", "5 kN"), "the first run has no such preload; it has 2 kN, 8 kN"),
        (
            ("--tolerance", "5 mm", "--least-mac", "0.8"),
            "--tolerance, --least-mac: for a hammer test alone, where two results are compared; leave it out",
        ),
    ],
)
def test_what_two_runs_cannot_take(files, more, match, capsys):
    assert run("compare", *files, *more) == 1
    assert match in capsys.readouterr().err


def test_in_python(files):
    found = faying.compare_runs(*map(faying.load, files), "2 kN")
    assert isinstance(found, faying.RunDifference)
    assert "mode 1: +2.00 %" in repr(found)
    assert len(repr(found).splitlines()) <= 12
