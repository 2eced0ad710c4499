"""The first command of the README, run once from end to end, and what its numbers must be."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

EXAMPLE = Path(__file__).parent.parent.parent / "examples" / "t-specimen"


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    folder = tmp_path_factory.mktemp("example") / "t-specimen"
    shutil.copytree(EXAMPLE, folder, ignore=shutil.ignore_patterns("results"))
    done = subprocess.run(
        [sys.executable, "-m", "faying", "run", str(folder / "study.toml"), "--json"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout), folder / "results"


def test_modes_lie_between_free_and_bonded(outcome):
    data, _ = outcome
    frequencies = np.array(data["frequencies"]["values"])
    assert frequencies.shape == (3, 15)
    assert np.all(frequencies >= np.array(data["free"]["values"]) * (1 - 1e-9))
    assert np.all(frequencies <= np.array(data["bonded"]["values"]) * (1 + 1e-9))
    low, high = (np.array(data[name]["values"]) for name in ("low", "high"))
    assert np.all((low <= frequencies) & (frequencies <= high))
    assert max(data["rigid"]["values"]) < 1e-2


def test_the_row_used_for_identification_fits_and_the_others_are_near(outcome):
    """4 kN was used to find the dimensions, under JK, 8 and 12 kN are predictions. Bound: the worst of the paper."""
    c = outcome[0]["comparison"]
    error = np.array(c["beside"]["values"][0]) / np.array(c["frequencies"]["values"]) - 1
    assert np.abs(error[0]).max() < 0.041
    assert np.abs(error[1:]).max() < 0.05
    assert np.abs(np.array(c["predicted"]["values"]) / np.array(c["frequencies"]["values"]) - 1).max() < 0.06


def test_the_default_changes_with_preload_as_the_test_does_more_than_jk_or_the_paper(outcome):
    c, loads = outcome[0]["comparison"], np.array(outcome[0]["loads"]["values"])
    slope = {
        name: np.polyfit(loads, np.array(values), 1)[0]
        for name, values in (
            ("test", c["frequencies"]["values"]),
            ("paper", c["published"]["values"]),
            ("JK", c["beside"]["values"][0]),
            ("default", c["predicted"]["values"]),
        )
    }
    share = {name: slope[name] / slope["test"] for name in slope}
    kept = [0, 2, 3, 4]  # the second mode hardly bends the joint
    assert np.all(share["default"][kept] > 2 * share["JK"][kept])
    assert np.all(share["default"][kept] > share["paper"][kept])
    assert np.all((share["default"][kept] > 0.25) & (share["default"][kept] < 1))


def test_only_the_law_that_has_a_loss_damps(outcome):
    data = outcome[0]
    assert data["beside"] == ["JK"]
    assert all(value is None for row in data["loss_factors"]["values"] for value in row)
    loss = np.array(data["beside_loss_factors"]["values"][0], dtype=float)
    assert np.all((loss > 0) & (loss < 0.0398))  # never more than the joint's own, alpha/(1 - alpha)/(2 pi)


def test_the_comparison_names_test_paper_and_us(outcome):
    c = outcome[0]["comparison"]
    assert c["published_name"] == "JK paper"
    assert all(np.shape(c[name]["values"]) == (3, 5) for name in ("frequencies", "published", "predicted"))


def test_the_surface_comes_from_the_scan_and_its_roughness_is_consistent(outcome):
    surface = outcome[0]["surfaces"][0]
    assert surface["origin"] == "milled.x3p"
    assert 2 < surface["D_interval"][0] < surface["D"] < surface["D_interval"][1] < 3
    assert surface["implied_Rq [m]"] == pytest.approx(surface["Rq [m]"], rel=0.5)


def test_bolt_forces_balance(outcome):
    assert all(value < 1e-8 for value in outcome[0]["imbalance"]["values"])


def test_files(outcome):
    _, results = outcome
    names = {path.name for path in results.iterdir()}
    assert {
        "result.nc",
        "modes.csv",
        "report.html",
        "frequencies.svg",
        "comparison.svg",
        "pressure.svg",
        "modes.png",
    } <= names
