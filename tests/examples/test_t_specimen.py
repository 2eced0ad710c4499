"""The first command of the README, run from end to end, and what its numbers must be."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import faying

EXAMPLE = Path(__file__).parent.parent.parent / "examples" / "t-specimen"


def command(folder, more=""):
    """What the command prints and its folder of results; `more`: lines of [modes]."""
    shutil.copytree(EXAMPLE, folder, ignore=shutil.ignore_patterns("results"))
    text = (folder / "study.toml").read_text()
    (folder / "study.toml").write_text(text.replace("[modes]\n", f"[modes]\n{more}"))
    done = subprocess.run(
        [sys.executable, "-m", "faying", "run", str(folder / "study.toml"), "--json"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout), folder / "results"


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    """Without levels and intervals, half of the time; what they give is tested on smaller studies."""
    return command(tmp_path_factory.mktemp("example") / "t-specimen", "levels = []\nintervals = false\n")


@pytest.fixture(scope="module")
def full(tmp_path_factory):
    return command(tmp_path_factory.mktemp("full") / "t-specimen")


@pytest.mark.slow
def test_levels_and_intervals_change_no_frequency(outcome, full):
    data, results = full
    expected = np.array(outcome[0]["frequencies"]["values"])
    assert np.array(data["frequencies"]["values"]) == pytest.approx(expected, rel=1e-8)
    assert (results / "report.html").stat().st_size < 3e6
    assert {"intervals.svg", "slip.svg"} <= {path.name for path in results.iterdir()}


@pytest.mark.slow
def test_modes_lie_between_free_and_bonded(outcome):
    data, _ = outcome
    frequencies = np.array(data["frequencies"]["values"])
    assert frequencies.shape == (3, 15)
    assert np.all(frequencies >= np.array(data["free"]["values"]) * (1 - 1e-9))
    assert np.all(frequencies <= np.array(data["bonded"]["values"]) * (1 + 1e-9))
    low, high = (np.array(data[name]["values"]) for name in ("low", "high"))
    assert np.all((low <= frequencies) & (frequencies <= high))
    assert max(data["rigid"]["values"]) < 1e-2


@pytest.mark.slow
def test_all_rows_are_near(outcome, published):
    """Dimensions fit the means, waves are as milled. Bound: 5 %, a little more than the worst of the paper, 4.3 %."""
    c = outcome[0]["comparison"]
    rows = zip(c["frequencies"]["values"][2], c["predicted"]["values"][2], strict=True)
    for number, (measured, ours) in enumerate(rows, start=1):
        published(
            f"T-specimen at 12 kN, predicted: mode {number}",
            measured,
            ours,
            unit="Hz",
            rel=0.05 if number == 3 else 0.01,
            source="doi:10.3390/fractalfract8100611, Table 3, hammer test",
            why="dimensions were fitted to the means over the preloads, waves were not; mode 3 depends on dimensions "
            "that are not published",
            measured=True,
        )
    error = np.array(c["predicted"]["values"]) / np.array(c["frequencies"]["values"]) - 1
    assert np.abs(error).max() < 0.05
    assert np.abs(error[2, [0, 1, 3, 4]]).max() < 0.01  # mode 3 hangs on the dimensions


@pytest.mark.slow
def test_the_change_with_preload_follows_the_test_more_than_the_paper_does(outcome):
    """Modes 1, 3, 4, 5 within a factor of 2 of the test, waves not fitted; the paper's beyond 8."""
    c, loads = outcome[0]["comparison"], np.array(outcome[0]["loads"]["values"])
    slope = {
        name: np.polyfit(loads, np.array(values), 1)[0]
        for name, values in (
            ("test", c["frequencies"]["values"]),
            ("paper", c["published"]["values"]),
            ("JK", c["alternatives"]["values"][0]),
            ("default", c["predicted"]["values"]),
        )
    }
    share = {name: slope[name] / slope["test"] for name in slope}
    assert np.all(np.abs(np.log(share["default"][[0, 2, 3, 4]])) < np.log(2))
    opening = [0, 2, 4]  # they open and close the joint
    assert np.all(share["paper"][opening] < 1 / 8)
    assert np.all(share["default"][opening] > 3 * share["JK"][opening])


@pytest.mark.slow
def test_draws_of_waves_hold_the_change_of_mode_1(outcome, tmp_path):
    """Four draws, nothing fitted: the test's slope of mode 1 lies between the least and the greatest."""
    c, loads = outcome[0]["comparison"], np.array(outcome[0]["loads"]["values"])
    texts = ("joint.form.waviness_seed=0,1,2,3", "bolt.preload=4 kN,8 kN,12 kN")
    axes = [faying.axis_of(text) for text in texts]
    found = faying.sweep(EXAMPLE / "study.toml", axes, tmp_path / "draws.nc", tolerance=1e-4).frequencies
    ours = np.array(outcome[0]["frequencies"]["values"])
    assert found[0] == pytest.approx(ours, rel=2e-4)  # the draw that the study names
    slopes = np.array([np.polyfit(loads, one[:, c["modes"]["values"][0][0]], 1)[0] for one in found])
    test = np.polyfit(loads, np.array(c["frequencies"]["values"]), 1)[0][0]
    assert slopes.min() < test < slopes.max()


@pytest.mark.slow
def test_a_study_that_gives_its_waves_is_answered_by_one_draw_and_says_so(full):
    """The note names the size, the draw, and what shows how far draws differ; its draw is one of four."""
    drawn = np.array(full[0]["wave_frequencies"]["values"])
    assert drawn.shape[0] == 4
    assert drawn[0] == pytest.approx(np.array(full[0]["frequencies"]["values"]), rel=1e-12)
    (text,) = [note["text"] for note in full[0]["notes"] if note["code"] == "waves"]
    assert "rms 1.156 um on each face" in text
    assert "draw 0; another draw gives other frequencies" in text
    assert "faying sweep over joint.flange.form.waviness_seed" in text


@pytest.mark.slow
def test_only_the_law_that_has_a_loss_damps(outcome):
    data = outcome[0]
    assert data["alternatives"] == ["JK"]
    assert all(value is None for row in data["loss_factors"]["values"] for value in row)
    loss = np.array(data["alternative_loss_factors"]["values"][0], dtype=float)
    assert np.all((loss > 0) & (loss < 0.0398))  # never more than the joint's own, alpha/(1 - alpha)/(2 pi)


@pytest.mark.slow
def test_the_comparison_names_test_paper_and_us(outcome):
    c = outcome[0]["comparison"]
    assert c["published_name"] == "JK paper"
    assert all(np.shape(c[name]["values"]) == (3, 5) for name in ("frequencies", "published", "predicted"))


@pytest.mark.slow
def test_the_surface_comes_from_the_scan_and_its_roughness_is_consistent(outcome):
    surface = outcome[0]["surfaces"][0]
    assert surface["origin"] == "milled.x3p"
    assert 2 < surface["D_interval"][0] < surface["D"] < surface["D_interval"][1] < 3
    assert surface["implied_Rq [m]"] == pytest.approx(surface["Rq [m]"], rel=0.5)


@pytest.mark.slow
def test_bolt_forces_balance(outcome):
    assert all(value < 1e-8 for value in outcome[0]["imbalance"]["values"])


@pytest.mark.slow
def test_files(outcome):
    _, results = outcome
    names = {path.name for path in results.iterdir()}
    assert {"result.nc", "modes.csv", "report.html", "frequencies.svg", "comparison.svg"} <= names
    assert {"pressure.svg", "modes.png"} <= names


@pytest.mark.slow
def test_the_backbone_of_mode_3_has_a_witness():
    """Harmonic balance and the static cycle within 2 % of the damping, or the curve says where they part."""
    curve = faying.backbone(EXAMPLE / "study.toml", mode=3, friction=0.2, amplitude=(20.0, 500.0))
    assert curve.code == "amplitude"
    assert np.all(np.diff(curve.damping) > 0)
    apart = np.abs(curve.witness.damping_change) > 0.02
    assert np.count_nonzero(apart) == sum(note.code == "backbone-witness" for note in curve.notes)
    assert abs(curve.witness.damping_change[-1]) < 0.05
    assert np.all(np.abs(curve.witness.frequency_change) < 1e-3)
    assert curve.bounds.residual < 0.01
    coarse = abs(curve.bounds.points_damping)
    assert (coarse > 0.05) == any("half of the joints' points" in note.text for note in curve.notes)
    if 0.02 < coarse < 0.1:
        pytest.xfail(f"half of the points move the damping by {coarse:.1%}, for 2 %")
    assert coarse < 0.02
