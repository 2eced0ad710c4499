"""What long work shows on stderr."""

import json
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from faying.answer.run import run, stages
from faying.cli import progress
from faying.cli.main import cli
from faying.cli.progress import Shown
from faying.progress import duration
from faying.study import Study


class Clock:
    def __init__(self):
        self.now = 100.0

    def monotonic(self):
        return self.now


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(progress.time, "monotonic", clock.monotonic)
    return clock


def test_time_left_of_counted_steps_is_theirs_at_the_rate_so_far(clock):
    shown = Shown("sweep", "none")
    shown("mesh", 0, 0)
    clock.now += 30  # no part of the rate
    shown("evaluations", 100, 500)  # 100 of them were found on disk
    assert shown.left() is None
    clock.now += 8
    shown("evaluations", 180, 500)
    assert shown.left() == pytest.approx(8 / 80 * 320)


def test_time_left_of_planned_stages_follows_earlier_ones_of_their_kind(clock):
    plan = ["mesh", "preload 1 kN", "modes at 1 kN", "preload 2.5 kN", "modes at 2.5 kN"]
    shown = Shown("study", "none", plan)
    for number, (stage, seconds) in enumerate(zip(plan[:3], (10, 4, 20), strict=True)):
        shown(stage, number, 5)
        clock.now += seconds
    shown("preload 2.5 kN", 3, 5)
    clock.now += 1
    assert shown.left() == pytest.approx(4 - 1 + 20)


def test_stages_without_an_earlier_one_scale_with_those_that_are_over(clock):
    left = {}
    for seconds in (5, 50):
        shown = Shown("study", "none", ["mesh", "preload 1 kN", "modes at 1 kN"])
        shown("mesh", 0, 3)
        clock.now += seconds
        shown("preload 1 kN", 1, 3)
        left[seconds] = shown.left()
    assert left[50] == pytest.approx(10 * left[5])


def test_a_bar_fits_80_columns_and_is_wiped(clock, capsys):
    with Shown("study", "bar") as shown:
        shown("frequency response at the points of the test of a very long name indeed", 3, 9)
        clock.now += 5
        shown("modes free and bonded", 4, 9)
    written = capsys.readouterr().err
    assert all(len(line) <= 79 for line in written.split("\r"))
    assert "4 of 9" in written
    assert "40 s left" not in written.split("\r")[1]
    assert written.split("\r")[-2].strip() == ""


@pytest.mark.parametrize(("seconds", "text"), [(8, "8 s"), (119, "119 s"), (121, "2 min"), (9000, "2.5 h")])
def test_durations(seconds, text):
    assert duration(seconds) == text


EXAMPLE = Path(__file__).parents[2] / "examples" / "two-blocks" / "study.toml"


def test_a_run_reports_the_stages_that_it_plans():
    said = []
    plan = Study.read(EXAMPLE)
    run(plan, report=lambda stage, done, total: said.append((stage, done, total)))
    assert [stage for stage, *_ in said] == stages(plan)
    assert [done for _, done, _ in said] == list(range(len(said)))
    assert {total for *_, total in said} == {len(said)}


def test_options_choose_what_stderr_shows():
    study = str(EXAMPLE)
    found = {
        option: CliRunner().invoke(cli, ["run", study, "--no-files", *option.split()])
        for option in ("-q", "-v", "--progress json")
    }
    assert all(one.exit_code == 0 for one in found.values())
    assert found["-q"].stderr == ""
    lines = found["-v"].stderr.splitlines()
    assert lines[0].split(" s  ")[1] == "surface"
    assert lines[-1].endswith(" s  done")
    events = [json.loads(line) for line in found["--progress json"].stderr.splitlines()]
    assert [event["stage"] for event in events] == [*stages(Study.read(study)), "done"]
    assert events[-1]["done"] == events[-1]["total"]
    assert all(event["left_s"] is not None for event in events[1:-1])


def test_a_pipe_gets_a_line_where_work_takes_long(monkeypatch, capsys):
    with Shown("study") as shown:
        shown("mesh", 0, 0)
    assert capsys.readouterr().err == ""
    monkeypatch.setattr("faying.cli.progress.SELDOM", 0.01)
    with Shown("study") as shown:
        shown("preload", 1, 4)
        time.sleep(0.2)
        shown("modes", 2, 4)
        time.sleep(0.2)
    lines = capsys.readouterr().err.splitlines()
    assert lines[0].endswith("s  preload")
    assert "s  modes, about" in lines[-1]
