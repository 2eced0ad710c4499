"""The interval that a run gives: beside samples of the whole, and beside runs with a narrower input."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import faying
from faying.answer.interval import _bolts_alike, _together
from faying.case.case import Case
from faying.case.law_range import law_range
from faying.case.scatter import known_of
from faying.errors import InputError
from faying.result.interval_figure import intervals
from faying.study import Study
from tests.helpers import studies

EXAMPLE = Path(__file__).parents[2] / "examples" / "two-blocks"


def study(folder: Path, uncertain: str = "", *, loads: str = '["1 kN", "3 kN"]', intervals: bool = True) -> Path:
    """The two blocks of the examples with flat faces; `uncertain`: lines of that table."""
    path = folder / "study.toml"
    text = (EXAMPLE / "study.toml").read_text(encoding="utf-8")
    text = text.replace('"model.inp"', f'"{(EXAMPLE / "model.inp").as_posix()}"').replace('["1 kN", "3 kN"]', loads)
    text = text.replace("\n[[bolt]]", "\n[joint.form]\nflat = true\n\n[[bolt]]", 1)
    text = text.replace("[modes]\n", f"[modes]\nlevels = []\nintervals = {str(intervals).lower()}\n")
    path.write_text(text + (f"\n[uncertain]\n{uncertain}\n" if uncertain else ""), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    return faying.run(study(tmp_path_factory.mktemp("plain")))


def test_every_run_has_an_interval_of_each_frequency(plain):
    assert plain.interval.sources == ("law", "k_t/k_n", "preload", "structure", "mode")
    interval = plain.interval
    assert np.all(plain.interval.low < plain.interval.high)
    assert interval.shares.sum(axis=0) == pytest.approx(1.0)
    # 3 % of the structure and 2.5 % of each mode are in all of them
    assert np.all(interval.width >= 2 * 1.6448 * np.hypot(0.03, 0.025))
    assert interval.shares[3] / interval.shares[4] == pytest.approx(1.2**2 * np.ones_like(interval.shares[3]))


def test_a_mode_has_the_same_number_in_a_run_and_in_samples(plain, tmp_path):
    """Under the medians torsion is below the bending mode that it is above as modelled."""
    best = plain.interval.best[0]
    assert best[4] < best[3]
    sampled = np.median(faying.predict(study(tmp_path), samples=16).frequencies, axis=0)[0]
    assert np.array_equal(np.argsort(sampled), np.argsort(best))


def test_the_interval_of_a_preload_does_not_depend_on_others_in_the_list(tmp_path):
    """That of runs at its ends, alone, in rising and in falling lists; the law is elastic and remembers none."""
    only = "only = true\npreload = { scatter = '40 %' }\nstructure = '0.01 %'\ndiscrepancy = '0.01 %'"
    found = {}
    for loads in ('["1 kN"]', '["1 kN", "3 kN", "8 kN"]', '["8 kN", "3 kN", "1 kN"]'):
        result = faying.run(study(tmp_path, only, loads=loads))
        at = int(np.argmin(np.abs(result.loads - 1e3)))
        found[loads] = result.interval.ends[:, at]
    alone = found.pop('["1 kN"]')
    for ends in found.values():
        assert ends == pytest.approx(alone, rel=5e-5)
    factor = 0.2 * 1.6449  # the range is two standard deviations each way
    direct = [
        faying.run(study(tmp_path, loads=f'["{1 + sign * factor} kN"]', intervals=False)).frequencies[0]
        for sign in (-1, 1)
    ]
    assert alone[:, :3] == pytest.approx(np.array(direct)[:, :3], rel=2e-4)


def test_a_bolt_that_is_listed_by_name_scatters_alone():
    case = SimpleNamespace(study=SimpleNamespace(bolts=[SimpleNamespace(name=name) for name in "abcd"]))
    assert _bolts_alike(case, {"bolt.b.factor": None, "bolt.preload": None}) == [[1], [0, 2, 3]]
    assert _bolts_alike(case, {f"bolt.{name}.factor": None for name in "abcd"}) == [[0], [1], [2], [3]]
    assert _bolts_alike(case, {}) == [[0, 1, 2, 3]]


@pytest.mark.parametrize("product", [0.0, 0.08, -0.15])
def test_what_two_do_together_is_what_their_samples_do(product):
    """ln f = 0.2 x + 0.1 y + product x y, of normal scores over that of 95 %: the ends of a million draws, to 2 %."""
    law, ratio = (np.array([-size, size]).reshape(2, 1, 1) for size in (0.2, 0.1))
    corners = np.array([0.2 * x + 0.1 * y + product * x * y for x in (-1, 1) for y in (-1, 1)]).reshape(4, 1, 1)
    found = _together({"k_t/k_n": ratio, "law": law}, corners)
    x, y = np.random.default_rng(1).standard_normal((2, 1_000_000)) / 1.6449
    exact = np.quantile(0.2 * x + 0.1 * y + product * x * y, [0.05, 0.95])
    ends = np.hypot(found["law"], found["k_t/k_n"]).ravel()
    assert ends == pytest.approx(np.abs(exact), rel=0.02)
    assert found["law"] / found["k_t/k_n"] == pytest.approx(2.0)


@pytest.mark.slow
def test_one_at_a_time_gives_the_interval_of_samples_of_the_whole(plain, tmp_path):
    """With the law and k_t/k_n together: alone they miss ends by 0.14 of the width, where a soft joint shears."""
    sampled = faying.predict(study(tmp_path), samples=1024)
    low, _, high = sampled.quantiles().frequencies
    miss = np.abs(np.log([plain.interval.low / low, plain.interval.high / high])) / np.log(high / low)
    assert np.median(miss) < 0.02
    assert miss.max() < 0.1


# 0.15 of what JK has: a factor of 4.2 about a median of 0.26, 5 to 95 %
LAW = f"stiffness = {{ distribution = 'lognormal', median = 0.26, factor = {4.2**0.15:.6g} }}"


@pytest.mark.parametrize(
    ("source", "left", "lines"),
    [
        ("law", 0.15, LAW),
        # 0.55 +- 0.389, as 0.2 to 0.9 from 5 to 95 %
        ("k_t/k_n", 0.2, 'joint.joint.tangential = "0.4722 to 0.6278"'),
        ("preload", 5 / 28, 'preload = { tightening = "elongation" }'),
        ("structure", 0.2, 'structure = "0.6 %"'),
    ],
)
def test_narrowing_is_what_a_run_with_the_narrower_input_finds(plain, tmp_path, source, left, lines):
    """What would narrow an interval, by reweighting and by another run: within 10 % of the greatest gain.

    Next to the law of these blocks the other inputs hardly count: theirs are narrowed where the law is known better.
    """
    known = "" if source == "law" else LAW
    wide = faying.run(study(tmp_path, known)) if known else plain
    narrow = faying.run(study(tmp_path, f"{known}\n{lines}"))
    expected = wide.interval.narrowed_width({source: left})
    gain, again = 1 - expected / wide.interval.width, 1 - narrow.interval.width / wide.interval.width
    assert gain.max() > {"law": 0.1}.get(source, 1e-3)
    assert again == pytest.approx(gain, abs=0.1 * gain.max())


def test_what_the_study_says_replaces_the_table(plain, tmp_path):
    lines = 'preload = { tightening = "elongation" }\nE = "206 GPa +- 1 GPa"\ndiscrepancy = "0.4 %"\n'
    lines += 'joint.joint.tangential = "0.5 +- 0.01"'
    found = faying.run(study(tmp_path, lines)).interval
    before = plain.interval
    spread = {name: before.offsets[k, 1] - before.offsets[k, 0] for k, name in enumerate(before.sources)}
    now = {name: found.offsets[k, 1] - found.offsets[k, 0] for k, name in enumerate(found.sources)}
    assert np.abs(now["preload"]) == pytest.approx(np.abs(spread["preload"]) * 5 / 28, rel=0.15, abs=1e-6)
    # half of the scatter of E is that of a frequency, in place of 1.5 % of the 3 %
    sd = np.sqrt(0.03**2 - 0.015**2 + (0.5 / 206) ** 2)
    assert now["structure"] == pytest.approx(2 * 1.6449 * sd * np.ones_like(now["structure"]), rel=0.01)
    assert now["mode"] == pytest.approx(2 * 1.6449 * 0.004 * np.ones_like(now["mode"]))
    assert np.all(np.abs(now["k_t/k_n"]) < 0.1 * np.abs(spread["k_t/k_n"]).max())


def test_a_law_far_from_measured_joints_is_noted_unless_the_study_says_better(plain, tmp_path):
    """JK on steel: a median of 0.26, so that every frequency is above the middle of its interval."""
    (note,) = [note for note in plain.notes if note.code == "law-off"]
    assert note.severity == "limit"
    assert "0.26 times the stiffness of JK in the median, 0.062 to 1.1 times from 5 to 95 %" in note.text
    assert np.all(np.log(plain.frequencies) > np.log([plain.interval.low, plain.interval.high]).mean(axis=0))
    known = faying.run(study(tmp_path, "stiffness = { distribution = 'lognormal', median = 0.4, factor = 1.3 }"))
    assert not [note for note in known.notes if note.code == "law-off"]


def test_one_load_has_a_share_of_the_preload_as_well(plain, tmp_path):
    single = faying.run(study(tmp_path, loads='["3 kN"]'))
    k = single.interval.sources.index("preload")
    one = np.ptp(single.interval.offsets[k], axis=0)[-1]
    both = np.ptp(plain.interval.offsets[plain.interval.sources.index("preload")], axis=0)[-1]
    # two loads: a line through them in ln F; one: other equilibria at 0.77 and 1.23 times the force
    assert one == pytest.approx(both, rel=0.5, abs=2e-4)


def test_a_result_keeps_its_interval_in_its_file(plain, tmp_path):
    again = faying.load(plain.save(tmp_path / "result.nc"))
    assert again == plain == faying.load(tmp_path)
    assert np.array_equal(again.interval.moved, plain.interval.moved)
    assert again.interval.sources == plain.interval.sources
    tree = plain.to_xarray()
    assert tree["modes"].interval_low.sel(load="3 kN").values == pytest.approx(plain.interval.low[-1])
    rows = plain.csv_text().splitlines()
    assert rows[0].endswith("5 % [Hz],95 % [Hz]")


def test_intervals_can_be_left_out(tmp_path):
    found = faying.run(study(tmp_path, intervals=False))
    assert found.interval is None
    with pytest.raises(InputError, match="intervals = true"):
        intervals(found)


def test_the_figure_has_a_bar_from_5_to_95_percent_of_each_mode(plain):
    left, right = intervals(plain).axes
    bars = left.patches[: len(plain.bonded)]
    value = plain.frequencies[-1]
    assert [bar.get_x() for bar in bars] == pytest.approx(100 * (plain.interval.low[-1] / value - 1))
    assert [bar.get_width() for bar in bars] == pytest.approx(
        100 * (plain.interval.high - plain.interval.low)[-1] / value
    )
    # shares of a mode fill its row
    assert sum(bar.get_width() for bar in right.patches[:: len(plain.bonded)]) == pytest.approx(100)


def test_a_prediction_takes_the_same_table_where_the_study_says_nothing(tmp_path):
    found = Study.read(study(tmp_path))
    keys = known_of(Case.of(found))
    assert set(keys) == {"joint.stiffness", "joint.tangential", *(f"bolt.{bolt.name}.factor" for bolt in found.bolts)}
    assert keys["joint.stiffness"] == law_range("JK").of(soft=False)
    # faces of which nothing is said have waves, with a draw of their own in each sample, where the mesh carries them
    silent = replace(found, joints=tuple(replace(joint, form=None) for joint in found.joints))
    assert set(known_of(Case.of(silent))) == set(keys)
    studies.write(tmp_path / "finer.toml", flat=False)
    finer = Study.read(tmp_path / "finer.toml")
    name = finer.joints[0].name
    waves = {f"joint.{name}.form.waviness", f"joint.{name}.form.waviness_seed"}
    assert waves <= set(known_of(Case.of(finer)))
