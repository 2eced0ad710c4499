"""Three ordinary joints with the default law: an answer with bounds at any preload, and every law beside it."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

EXAMPLES = Path(__file__).parent.parent.parent / "examples"


def result_of(name, tmp_path):
    """What `faying run NAME.toml --json` prints."""
    for folder in ("plates-and-bolts", "t-specimen"):
        shutil.copytree(EXAMPLES / folder, tmp_path / folder, ignore=shutil.ignore_patterns("results"))
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "faying",
            "run",
            str(tmp_path / f"plates-and-bolts/{name}.toml"),
            "--json",
            "--no-files",
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize(
    ("name", "proof_share"),
    [
        # preload over proof load: ISO 898-1 gives 11.6, 21.2 and 48.9 kN for M6, M8 and M12 of class 8.8
        pytest.param("sheets", 8 / 11.6, marks=pytest.mark.slow),
        pytest.param("plates", 16 / 21.2, marks=pytest.mark.slow),
        pytest.param("flanges", 45 / 48.9, marks=pytest.mark.slow),
    ],
)
def test_an_ordinary_joint_has_an_answer_with_bounds(name, proof_share, tmp_path):
    data = result_of(name, tmp_path)
    value = {key: np.array(data[key]["values"]) for key in ("frequencies", "free", "bonded", "low", "high")}
    assert data["laws"][0]["name"] == "half-space"
    assert np.all(value["free"] <= value["low"] * (1 + 1e-9))
    assert np.all(value["low"] <= value["frequencies"] * (1 + 1e-6))
    assert np.all(value["frequencies"] <= value["high"] * (1 + 1e-6))
    assert np.all(value["high"] <= value["bonded"] * (1 + 1e-6))
    assert np.all(value["high"][:, :3] > value["low"][:, :3] * (1 + 1e-4))  # a range, not a number written twice
    assert np.array(data["greatest_pressure"]["values"]).max() > 30e6  # where JK ends on this surface by half
    assert data["above_range_share"]["values"] == [0.0, 0.0]
    assert max(data["imbalance"]["values"]) < 1e-8
    found = np.array(data["bolt_numbers"]["proof_share"]["values"])[-1]
    assert found == pytest.approx(proof_share, rel=1e-2)  # the standard rounds its loads


@pytest.mark.slow
def test_every_law_of_one_scan_has_its_row(tmp_path):
    """Laws that end below the bolts' pressure are bounded; those without a stiffness say so and stop nothing."""
    data = result_of("laws", tmp_path)
    rows = dict(zip(data["alternatives"], range(len(data["alternatives"])), strict=True))
    held, bonded = (
        np.array(data[key]["values"], dtype=float)[:, -1]
        for key in ("alternative_frequencies", "alternative_above_range_frequencies")
    )
    reach = np.array(data["alternative_reach"]["values"], dtype=float)
    beyond = np.array(data["alternative_above_range_share"]["values"], dtype=float)[:, -1]
    silent = {name for name, row in rows.items() if np.isnan(held[row]).all()}
    assert silent == {"JS", "MB", "WK", "YK"}
    own = np.array(data["frequencies"]["values"])[-1]
    assert held[rows["half-space"]] == pytest.approx(own, rel=1e-6)
    for name in set(rows) - silent:
        row = rows[name]
        ends = reach[row] < data["greatest_pressure"]["values"][-1]
        assert (beyond[row] > 0) == ends or abs(reach[row] / data["greatest_pressure"]["values"][-1] - 1) < 0.2
        assert np.all(bonded[row] >= held[row] * (1 - 1e-9))
        assert np.any(bonded[row] > held[row] * (1 + 1e-5)) == (beyond[row] > 0)
    assert {"JK", "ME"} <= {name for name, row in rows.items() if beyond[row] > 0}
    loss = np.array(data["alternative_loss_factors"]["values"][rows["JK"]], dtype=float)
    assert np.all(loss > 0)
