"""faying condense: a joint of a study as 6 x 6, and how far that holds."""

import json
import tomllib
from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.answer.run import run
from faying.cli.main import cli
from faying.export.condense import condense
from faying.output.terminal import text as shown
from faying.study import Study


@pytest.fixture(scope="module")
def found(file):
    return condense(Study.read(file), preload="2 kN")


@pytest.mark.slow
def test_the_full_model_is_that_of_run(file, found):
    data = tomllib.loads(file.read_text())
    data["bolt"][0]["preload"] = ["2 kN"]
    result = run(Study.from_dict(data, folder=file.parent))
    assert found.load == 2e3
    # those of complex modes are a little higher
    assert found.frequencies == pytest.approx(result.frequencies[0], rel=2e-3)
    assert found.loss == pytest.approx(result.loss_factors[0], rel=0.02)
    total = result.total_k_n[0, 0], result.total_k_t[0, 0], result.total_k_t[0, 0]
    assert np.sort(np.diag(found.joint.stiffness)[:3]) == pytest.approx(np.sort(total), rel=1e-9)


def test_mean_ties_are_softer_than_the_full_model(found):
    known = ~np.isnan(found.mean)
    assert known.any()
    assert np.all(found.mean[known] <= found.frequencies[known] * (1 + 1e-7))


@pytest.mark.parametrize(
    ("errors", "reach"),
    [([0.0, 0.009, -0.009], 300.0), ([0.0, 0.02, 0.0], 100.0), ([-0.02, 0.0, 0.0], 0.0), ([0.0, np.nan, 0.0], 100.0)],
)
def test_the_reach_ends_before_the_first_mode_that_is_wrong(found, errors, reach):
    frequencies = np.array([100.0, 200.0, 300.0])
    made = replace(found, frequencies=frequencies, mean=frequencies * (1 + np.array(errors)))
    assert made.reach == reach


def test_the_table_has_loss_only_where_the_law_predicts_it(found):
    """A law without loss gives a table that a terminal can show, without the two columns of loss."""
    with_loss, without = found.rows(), replace(found, lossless=True).rows()
    assert [row[:4] for row in with_loss] == without
    assert with_loss[0][4:] == ["loss", "mean ties"]
    assert "full [Hz]" in shown(without).splitlines()[0]
    for mode, row in enumerate(without[1:]):
        assert row[1] == f"{found.frequencies[mode]:.2f}"
        error = found.mean[mode] / found.frequencies[mode] - 1
        assert row[3] == ("-" if np.isnan(error) else f"{100 * error:+.3f}")


def test_the_command_writes_a_deck(file, tmp_path, capsys):
    out = tmp_path / "joint"
    given = [
        "condense",
        str(file),
        "--preload",
        "2 kN",
        "--to",
        "abaqus",
        "--unit",
        "mm",
        "--node-a",
        "5",
        "--node-b",
        "6",
    ]
    cli.main(args=[*given, "--point-b", "0 mm; 0 mm; 1 mm", "--out", str(out), "--json"], standalone_mode=False)
    printed = json.loads(capsys.readouterr().out)
    assert printed["files"] == [str(out / "condensed_matrix.inp")]
    assert printed["points"]["values"][1] == pytest.approx([0, 0, 1e-3])
    assert len(printed["stiffness"]["values"]) == 6
    assert "tie node 5 to the first face" in " ".join((out / "condensed_matrix.inp").read_text().split())


@pytest.mark.parametrize(
    ("given", "text"),
    [
        (["--joint", "lid"], r"no joint 'lid'; the study has 'joint'"),
        (["--preload", "3 kN"], "preload = .* no such preload; it has 2 kN, 6 kN"),
        (["--to", "mapdl"], "--to needs --unit"),
        (["--point-a", "1 mm, 2 mm, 3 mm"], "three lengths with semicolons"),
    ],
)
def test_faults(file, given, text):
    with pytest.raises(faying.InputError, match=text):
        cli.main(args=["condense", str(file), *given], standalone_mode=False)


def test_numbers_of_nodes(found):
    for nodes, element in (((3, 3), 1), ((0, 3), 1), ((1, 2), 0)):
        with pytest.raises(faying.InputError, match="give two nodes"):
            found.deck(unit="mm", nodes=nodes, element=element)
