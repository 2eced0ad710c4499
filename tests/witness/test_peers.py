"""The command that compares with other codes: what it lists, two cheap problems, and codes that are not there."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from peers.__main__ import main
from peers.peer import PEERS, ask, interpreter, present
from peers.problems import PROBLEMS
from peers.rows import HEAD, Row, worst

from tests.helpers.self_affine import self_affine

PAGE = Path(__file__).parents[2] / "docs" / "peers.md"


@pytest.fixture(scope="module")
def there():
    return present(interpreter())


def rows(capsys, *words):
    """The rows that the command prints, as dictionaries."""
    assert main(["--markdown", "--only", *words]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("| ")]
    return [dict(zip(HEAD, (word.strip() for word in line[1:-1].split("|")), strict=True)) for line in lines[1:]]


def test_each_problem_is_listed_with_the_reason_of_its_bounds(capsys):
    assert main(["--list"]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    for problem in PROBLEMS:
        assert f"{problem.name}, {problem.peer}, {problem.seconds:g} s {problem.bound}" in printed
        assert len(problem.bound) > 20
        assert problem.peer in PEERS
    assert sum(problem.seconds for problem in PROBLEMS) < 600


def test_the_page_has_each_problem_and_explains_what_is_above_its_bound():
    text = PAGE.read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if line.endswith(("| within |", "| above |"))]
    named = [tuple(line.split(" | ")[:2]) for line in lines if not line.startswith("| | |")]
    assert [(name.removeprefix("| "), peer) for name, peer in named] == [(one.name, one.peer) for one in PROBLEMS]
    last = ""
    for line in lines:
        last = last if line.startswith("| | |") else line.split(" | ")[0].removeprefix("| ")
        if line.endswith("| above |"):
            assert f"*{last}*" in " ".join(text.split())


def test_frequencies_of_a_universal_file_have_six_digits(capsys, there):
    if "pyuff" not in there:
        pytest.skip(f"not installed: pyuff: {PEERS['pyuff'].get}")
    table = {row["quantity"]: row for row in rows(capsys, "universal file, written", "FV32")}
    (name,) = (name for name in table if name.startswith("frequency of mode"))
    ours, theirs = (float(table[name][key].removesuffix(" Hz")) for key in ("Faying", "other"))
    assert theirs == float(f"{ours:.5e}")
    assert {row["verdict"] for row in table.values()} == {"within"}
    assert table["elastic frequency 2"]["other"] == "130.03 Hz"  # of the printed ones


def test_fatigue_under_random_stress_is_that_of_flife(capsys, there):
    if "FLife" not in there:
        pytest.skip(f"not installed: FLife: {PEERS['FLife'].get}; FAYING_PEERS names another interpreter")
    assert [row["verdict"] for row in rows(capsys, "FLife")] == ["within", "within"]


@pytest.mark.parametrize("peer", ["SurfaceTopography", "surfalize"])
def test_the_height_of_a_map_is_that_of_a_least_squares_plane(peer, there):
    if peer not in there:
        pytest.skip(f"not installed: {peer}: {PEERS[peer].get}; FAYING_PEERS names another interpreter")
    z = self_affine(64)
    y, x = np.indices(z.shape)
    plane = np.stack([np.ones(z.size), x.ravel(), y.ravel()], axis=1)
    left = z.ravel() - plane @ np.linalg.lstsq(plane, z.ravel(), rcond=None)[0]
    level, sloped = left.reshape(z.shape), left.reshape(z.shape) + 0.01 * (x - y)
    found = ask(interpreter(), "heights.py", peer.lower(), heights=level, sloped=sloped, spacing=1.0)
    assert found["Sq"] == pytest.approx(np.sqrt((left**2).mean()), rel=1e-12)
    assert found["Sq of the slope"] == pytest.approx(found["Sq"], rel=1e-9)


def test_a_code_that_is_not_there_is_named_and_left_out(capsys, monkeypatch):
    monkeypatch.setitem(PEERS, "Tamaas", replace(PEERS["Tamaas"], module="no_such_module"))
    monkeypatch.setitem(PEERS, "CalculiX", replace(PEERS["CalculiX"], program="no-such-program"))
    assert rows(capsys, "Tamaas") == []
    assert main(["--only", "T-specimen"]) == 0
    printed = capsys.readouterr().out
    assert "not installed: Tamaas: pip install tamaas" in printed
    assert "not installed: CalculiX: the program ccx on PATH" in printed


def test_a_witness_that_fails_says_why():
    with pytest.raises(RuntimeError, match="KeyError"):
        ask(interpreter(), "heights.py", "no_code", heights=np.zeros((2, 2)))


def test_a_row_is_judged_by_its_bound():
    assert Row(quantity="x", ours=1.01, theirs=1.0, bound=0.02).verdict == "within"
    assert Row(quantity="x", ours=0.97, theirs=1.0, bound=0.02).verdict == "above"
    assert Row(quantity="x", ours=1e-3, theirs=0.0, bound=1e-4).verdict == "above"
    assert Row(quantity="x", ours=float("nan"), theirs=1.0, bound=1.0).verdict == "above"
    row = worst("mode", [1.0, 2.2, 3.0], [1.0, 2.0, 3.1], bound=0.05, unit="Hz")
    assert (row.quantity, row.verdict) == ("mode 2", "above")


def test_no_code_with_a_gpl_is_imported_here():
    folder = Path(main.__globals__["__file__"]).parent
    free = {peer.module for peer in PEERS.values() if "GPL" in peer.licence and peer.module}
    for file in folder.glob("*.py"):
        assert not free & set(re.findall(r"^\s*(?:from|import) (\w+)", file.read_text(encoding="utf-8"), re.M))
