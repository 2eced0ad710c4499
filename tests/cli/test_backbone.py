"""faying backbone: what it prints, writes and refuses."""

import json
from pathlib import Path

import pytest

import faying
from faying.cli import main
from faying.cli.backbone import place
from faying.errors import InputError

STUDY = str(Path(__file__).parents[2] / "examples" / "two-blocks" / "study.toml")
QUICK = ("--amplitude", "500 m/s^2:1500 m/s^2", "--harmonics", "1")


def call(capsys, *args):
    with pytest.raises(SystemExit) as stop:
        main(["backbone", STUDY, *args])
    return stop.value.code, capsys.readouterr()


def test_it_prints_writes_and_draws(capsys, tmp_path):
    out, plot, points = tmp_path / "curve.nc", tmp_path / "curve.svg", tmp_path / "test.csv"
    points.write_text("acceleration [m/s^2],frequency [Hz],damping [%]\n600,8727,.001\n1200,8725,.002\n")
    code, said = call(
        capsys, *QUICK, "--friction", "0.2", "--out", str(out), "--plot", str(plot), "--measured", str(points), "--json"
    )
    assert not code, said.err
    found = json.loads(said.out)
    assert found["files"] == [str(out), str(plot)]
    curve = faying.Backbone.load(out)
    assert found["curves"][0]["frequency"]["values"] == pytest.approx(curve.frequency.tolist())
    assert "static cycle" in plot.read_text() or plot.stat().st_size > 10_000


def test_several_frictions_and_preloads_give_numbered_files(capsys, tmp_path):
    out = tmp_path / "curve.nc"
    code, said = call(
        capsys, *QUICK, "--friction", "0.2,0.4", "--preload", "all", "--at", "0,0,0 mm", "--out", str(out)
    )
    assert not code, said.err
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"curve-{k}.nc" for k in (1, 2, 3, 4)]
    for words in ("mode 1, 1 kN, JK, friction 0.2", "mode 1, 3 kN, JK, friction 0.4", "error bounds", "ends: "):
        assert words in " ".join(said.out.split())


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((), "has no friction"),
        (("--friction", "rough"), "should be a plain finite number"),
        (("--friction", "0.2", "--amplitude", "1:60"), "has no unit"),
        (("--friction", "0.2", "--amplitude", "60 m/s^2"), "two accelerations"),
        (("--friction", "0.2", "--at", "1,2"), "three lengths"),
        (("--friction", "0.2", "--preload", "2 kN"), "it has 1 kN, 3 kN"),
        (("--friction", "0.2", "--preload", "all", "--preload", "1 kN"), "leave out the others"),
        (("--friction", "0.2", "--rest-damping", "some"), "plain finite number"),
        (("--friction", "0.2", "--plot", "curve.xyz"), "figures can be written as"),
        (("--friction", "0.2", "--measured", "none.csv"), "none.csv"),
        (("--friction", "0.2", "--law", "jk,j-q"), "no contact law 'j-q'"),
        (("--friction", "0.2", "--law", "jk,gw"), "GW needs density"),
    ],
)
def test_faults_are_named(capsys, tmp_path, options, words):
    code, said = call(capsys, *options, "--out", str(tmp_path / "curve.nc"))
    assert code == 1
    assert words in said.err
    assert not list(tmp_path.iterdir())


def test_a_point_is_three_lengths():
    assert place("10, 0,-5 mm") == pytest.approx((0.01, 0.0, -0.005))
    with pytest.raises(InputError, match="three lengths"):
        place("10 mm")
