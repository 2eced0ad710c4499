"""D and G of a scan with their intervals, in the same words wherever a law rests on them."""

import re
from pathlib import Path

import pytest

import faying
from faying.cli.main import main
from faying.cli.run import text
from faying.contact.two_faces import faces_of
from faying.result import Result
from faying.setup import template
from faying.surface.files.read import read_scan
from faying.surface.fractal import fit_fractal

EXAMPLE = Path(__file__).parents[2] / "examples" / "two-blocks"
GIVEN = 'D = 2.39\nG = "1.53e-10 m"\nscan_area = "16 mm^2"\n'
HEAD = "D and G of the scans that the laws rest on"


def study(folder, law="jk", surface='scan = "s.x3p"\n'):
    template.surface(folder / "s.x3p")
    words = (EXAMPLE / "study.toml").read_text().replace("model.inp", str(EXAMPLE / "model.inp"))
    assert GIVEN in words
    words = words.replace(GIVEN, f'{surface}[law]\nmodel = "{law}"\n').replace('["1 kN", "3 kN"]', '"3 kN"')
    (folder / "study.toml").write_text(words)
    return str(folder / "study.toml")


def printed(capsys, *words):
    with pytest.raises(SystemExit) as stop:
        main(list(words))
    assert stop.value.code == 0
    return capsys.readouterr().out


def numbers(out):
    """Cells of the row of the table that has a band, whose columns are in two blocks with the names in both."""
    lines = out.splitlines()
    second = next(k for k, line in enumerate(lines) if " band " in line)
    first = next(k for k in range(second, -1, -1) if "95 % interval" in lines[k])
    rows = [re.split(r"\s{2,}", lines[k + 1].strip()) for k in (first, second)]
    names = next(k for k, (one, other) in enumerate(zip(*rows, strict=False)) if one != other)
    return [*rows[0], *rows[1][names:]]


def test_run_law_and_surface_print_the_same(tmp_path, capsys):
    scan = str(tmp_path / "s.x3p")
    ran = printed(capsys, "run", study(tmp_path), "--all", "--no-files")
    joint, file, *in_run, of_law = numbers(ran[ran.index(HEAD) :])
    assert (joint, file) == ("joint", "s.x3p")
    assert in_run == numbers(printed(capsys, "surface", scan))[1:]
    assert in_run == numbers(printed(capsys, "law", "--scan", scan, "--material", "45 steel", "--model", "jk"))[1:]
    fit, both = fit_fractal(read_scan(scan)), faces_of(read_scan(scan)).rough.inputs
    assert in_run[0] == f"{fit.D:.3f}"
    assert in_run[1] == f"{fit.D_interval[0]:.3f} .. {fit.D_interval[1]:.3f}"
    assert of_law == faying.units.show(both.G, "m", digits=3) != in_run[2]
    # the verdict, as `faying surface` gives it
    assert fit.warnings
    for words in fit.warnings:
        assert words in " ".join(ran.split())


def test_a_result_that_is_read_prints_them_too(tmp_path):
    result = faying.run(study(tmp_path))
    again = Result.load(result.save(tmp_path / "r.nc") or tmp_path / "r.nc")
    assert HEAD in text(result)
    assert text(again) == text(result)


@pytest.mark.parametrize(
    ("law", "surface"),
    [
        ("gw", 'scan = "s.x3p"\n'),  # rests on moments
        ("jk", f'scan = "s.x3p"\n{GIVEN}'),  # D and G were given
        ("jk", GIVEN),
    ],
)
def test_where_no_law_rests_on_them_they_are_not_shown(tmp_path, law, surface):
    assert HEAD not in text(faying.run(study(tmp_path, law, surface)))
