"""What a result says beside its numbers: the law that was taken, what it assumes, what falls with preload."""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.answer.run import run
from faying.contact.stability import stability
from faying.form.form import Form
from faying.output import table
from faying.setup.template import write
from faying.study import Study


def coarse(folder, law="", extra=""):
    """The study of `faying init` on a coarse mesh, without intervals and levels, under another law if one is given."""
    path = folder / "study.toml"
    write(path, force=True)
    text = path.read_text().replace('size = "8 mm"', 'size = "14 mm"').replace('joint" = "4 mm"', 'joint" = "9 mm"')
    text = text.replace("[modes]\n", "[modes]\nintervals = false\nlevels = []\n")
    if law:
        text = text.replace('model = "auto"', f'model = "{law}"')
    path.write_text(text + extra)
    return path


def codes(result):
    return {note.code for note in result.notes}


def texts(result, code):
    return [note.text for note in result.notes if note.code == code]


BESIDE = """
[[alternative]]
name = "JK, one rough face"
law = { model = "jk" }
surface = { scan = "surface.x3p", counter = "smooth" }
[[alternative]]
name = "GW"
law = { model = "gw-ke" }
[[alternative]]
name = "hollow"
form = { crown_along = "-20 um" }
"""


@pytest.fixture(scope="module")
def default(tmp_path_factory):
    return run(coarse(tmp_path_factory.mktemp("default"), extra=BESIDE))


@pytest.fixture(scope="module")
def closed(tmp_path_factory):
    return run(coarse(tmp_path_factory.mktemp("closed"), "gw-ke"))


def test_the_default_says_what_it_took_and_what_it_does_not_know(default):
    (choice,) = texts(default, "law-choice")
    assert "half-space" in choice
    assert "times this stiffness" in choice
    assert default.laws[0]["name"] == "half-space"
    assert texts(default, "mates")[0].startswith("both faces as surface.x3p, unrelated; ")
    assert "gives no damping at rest" in texts(default, "no-loss")[0]
    assert np.isnan(default.loss_factors).all()
    assert "loss" not in default.csv_text().splitlines()[1]
    assert default.to_dict()["loss_factors"]["values"][0][0] is None


def test_the_first_study_starts_inside_the_validity_of_its_law(default):
    outside = [note for note in default.notes if note.code == "outside-validity" and "alternative" not in note.text]
    assert all(note.share < 0.15 for note in outside)


def test_frequencies_lie_inside_their_range_and_the_range_inside_the_bounds(default):
    assert np.all(default.low <= default.frequencies * (1 + 1e-6))
    assert np.all(default.frequencies <= default.high * (1 + 1e-6))
    assert np.all(default.high <= default.bonded * (1 + 1e-6))
    assert np.all(default.low >= default.free)
    assert np.any(default.high > 1.01 * default.low)


def test_a_range_is_shown_to_the_five_digits_that_it_is_found_to(default):
    ends = replace(default, low=np.full_like(default.low, 1128.456), high=np.full_like(default.high, 40012.3))
    assert table.ranges(ends)[1][1] == "1128.5 .. 40012"
    ends = replace(default, low=np.zeros_like(default.low), high=np.full_like(default.high, 9.87654))
    assert table.ranges(ends)[1][1] == "0.00 .. 9.8765"


def test_modes_that_fall_with_preload_are_named_with_the_reason(default):
    first, last = default.frequencies
    fallen = [str(k + 1) for k in np.flatnonzero(last < first * (1 - 1e-6))]
    found = texts(default, "falls")
    assert len(found) == bool(fallen)
    for text in found:
        assert text.startswith(f"mode{'s' * (len(fallen) > 1)} {', '.join(fallen)} fall")
        share = float(default.weights @ (default.pressure[1] < default.pressure[0]) / default.weights.sum())
        assert f"pressure falls on {share:.0%} of the joint" in text


def test_other_laws_stand_beside_as_if_they_were_run_alone(default, closed, tmp_path):
    assert default.alternatives.names == ("JK, one rough face", "GW", "hollow")
    assert default.alternatives.frequencies[1] == pytest.approx(closed.frequencies, rel=1e-6)
    assert np.isnan(default.alternatives.loss_factors[1]).all()
    assert np.all(default.alternatives.loss_factors[0] > 0)
    assert "k_t/k_n = 0.824 is Mindlin's, assumed" in " ".join(texts(closed, "assumed"))
    told = texts(default, "assumed")
    assert all(text.startswith("alternative ") for text in told)
    assert any("alpha = 0.2" in text for text in told)
    again = faying.Result.load(default.save(tmp_path / "result.nc"))
    assert again == default


def test_the_table_of_laws_has_shares_reach_and_both_answers(default, closed):
    """The other law's columns are those of its own run."""
    head, own, jk, gw, hollow = table.laws(default)
    assert [row[0] for row in (own, jk, gw, hollow)] == ["half-space", *default.alternatives.names]
    assert default.alternatives.reach[1] == pytest.approx(closed.laws[0]["greatest_pressure [Pa]"])
    assert default.alternatives.outside_share[1] == pytest.approx(closed.outside_share, abs=1e-6)
    past = default.pressure > default.alternatives.reach[0]
    assert default.alternatives.above_range_share[0] == pytest.approx(
        past @ default.weights / default.weights.sum(), abs=0.05
    )
    assert np.all(default.alternatives.above_range_frequencies >= default.alternatives.frequencies * (1 - 1e-9))
    assert np.all(default.alternatives.above_range_share[1] == 0)
    assert len(head) == len(own) == len(jk) == len(gw)


@pytest.mark.slow
def test_a_form_beside_is_that_of_a_run_with_it(default, tmp_path):
    hollow = Study.read(coarse(tmp_path))
    joint = replace(hollow.joints[0], form=Form(crown_along=-20e-6))
    found = run(replace(hollow, joints=(joint,)))
    assert default.alternatives.frequencies[2] == pytest.approx(found.frequencies, rel=1e-6)
    assert np.abs(found.frequencies / default.frequencies - 1).max() > 1e-3


@pytest.mark.slow
def test_a_law_far_from_the_contact_of_its_scan_is_told(closed, tmp_path):
    """JK grows more slowly with pressure than the contact of this scan; GW-KE stays within a factor of two of it."""
    path = coarse(tmp_path, "jk")
    path.write_text(path.read_text().replace('["8 kN", "15 kN"]', '"40 kN"'))
    (far,) = texts(run(path), "far-from-exact")
    assert not 0.5 <= float(far.partition("JK is ")[2].split()[0]) <= 2
    assert "far-from-exact" not in codes(closed)
    assert closed.low is None
    assert "law-choice" not in codes(closed)


def test_a_stiffness_that_hangs_on_the_window_is_told_where_it_does(default, closed, tmp_path):
    write(tmp_path / "study.toml")
    scan = faying.read_scan(tmp_path / "surface.x3p")
    steel = faying.CATALOGUE["45 steel"]
    for result, model in ((default, "half-space"), (closed, "gw-ke")):
        touching = result.pressure[0] > 0
        mean = np.average(result.pressure[0][touching], weights=result.weights[touching])
        found = stability(faying.Mates(scan, materials=steel), model=model, pressure=float(mean))
        told = [text for text in texts(result, "window") if "beside" not in text]
        assert len(told) == (not found.stable)
        for text in told:
            assert f"{found.worst[1]:.2g} times the k_n on the {found.worst[0]}" in text


def test_faults_of_beside_are_found_when_the_study_is_read(tmp_path):
    for extra, words in (
        ("\n[[alternative]]\nname = 'x'\n", "give a law, a surface or a form"),
        ("\n[[alternative]]\nlaw = { model = 'jk', cutof = 1 }\n", "cutoff"),
        ("\n[[alternative]]\nlaw = { model = 'power-law' }\n", "power-law|Power law"),
    ):
        with pytest.raises(faying.InputError, match=words):
            Study.read(coarse(tmp_path, extra=extra))


def test_a_law_beside_that_has_no_answer_stops_nothing(tmp_path):
    """D and G of given numbers, and a law beside that needs a scan: refused when read; a missing scan is, too."""
    text = coarse(tmp_path).read_text()
    lost = text + "\n[[alternative]]\nname = 'lost'\nsurface = { scan = 'nowhere.x3p' }\n"
    (tmp_path / "study.toml").write_text(lost)
    with pytest.raises(faying.InputError, match=r"nowhere\.x3p"):
        Study.read(tmp_path / "study.toml")
