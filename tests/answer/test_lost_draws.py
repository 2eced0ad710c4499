"""A draw, or a cause, that finds no answer is named and loses nothing else."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import faying
from faying.answer.interval import Joints, _combined
from faying.errors import NotConverged
from faying.joint.modal import ModesChoice
from faying.notes import INCOMPLETE
from faying.output.answer import answer
from faying.reduction.reduce import Reduction
from faying.result.groups import WaveDraws
from faying.study import Study
from tests.helpers.preloads import pulled
from tests.helpers.studies import write


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """The blocks of `faying init` on a coarse mesh, at one preload."""
    path = tmp_path_factory.mktemp("blocks") / "study.toml"
    write(path, flat=False)
    return replace(pulled(Study.read(path), 6e3), alternatives=(), modes=ModesChoice(count=5, levels=()))


@pytest.fixture(scope="module")
def complete(study):
    return faying.run(study)


def without(monkeypatch, is_lost):
    """Let no variant that `is_lost` find its equilibrium."""
    train = Reduction.train_together

    def trained(self, variants, tolerance):
        if any(is_lost(one) for one in variants):
            raise NotConverged("no equilibrium after 60 steps")
        return train(self, variants, tolerance)

    monkeypatch.setattr(Reduction, "train_together", trained)


def test_one_draw_that_has_no_answer_loses_one_draw(study, complete, monkeypatch):
    lost: list[np.ndarray] = []

    def third_of_the_gaps(variant):
        gap = variant.gaps[0]
        if not any(np.array_equal(gap, other) for other in lost) and np.ptp(gap) > 0 and len(lost) < 3:
            lost.append(gap)
        return len(lost) == 3 and np.array_equal(gap, lost[2])

    without(monkeypatch, third_of_the_gaps)
    found = faying.run(study)
    assert found.interval.sources == complete.interval.sources
    assert len(found.waves.seeds) == len(complete.waves.seeds) - 1
    left = [list(complete.waves.seeds).index(seed) for seed in found.waves.seeds]
    # within what the small bases miss
    assert found.waves.frequencies == pytest.approx(complete.waves.frequencies[left], rel=5e-4)
    (note,) = [note for note in found.notes if note.code == INCOMPLETE]
    assert "1 of 4 draws of waves, which found no answer: no equilibrium" in note.text
    assert note.severity == "wrong"
    assert answer(found)[0][3] == "5 to 95 %, incomplete"
    assert answer(complete)[0][3] == "5 to 95 %"


@pytest.mark.slow
def test_a_law_that_has_no_answer_leaves_the_waves(study, complete, monkeypatch):
    def stiff(variant):
        return variant.laws[0].scale > 1.0

    without(monkeypatch, stiff)
    found = faying.run(study)
    assert set(complete.interval.sources) - set(found.interval.sources) == {"law"}
    assert found.waves.frequencies == pytest.approx(complete.waves.frequencies, rel=5e-4)
    assert any("do not contain law, which found no answer" in note.text for note in found.notes)


@pytest.mark.slow
def test_a_lost_first_draw_leaves_the_law(study, complete, monkeypatch):
    first: list[np.ndarray] = []

    def of_the_first(variant):
        gap, own = variant.gaps[0], variant.laws[0]
        if np.ptp(gap) > 0 and not first:
            first.append(gap)
        plain = own.scale == 1.0 and not isinstance(own.tangential, float)
        return bool(first) and plain and np.array_equal(gap, first[0])

    without(monkeypatch, of_the_first)
    found = faying.run(study)
    assert found.interval.sources == complete.interval.sources
    # a draw is worth its distance from the others
    assert found.interval.best == pytest.approx(complete.interval.best, rel=0.3)


def test_the_best_estimate_has_the_medians_of_the_law_in_every_draw():
    """Not in the first alone, where the law may do more or less than in the others."""
    f = np.array([100.0, 200.0, 300.0])
    study = SimpleNamespace(uncertain=None, assumes_scatter=True)
    states = [SimpleNamespace(damped=SimpleNamespace(frequencies=f), ends=None)]
    draws = f * np.array([1.1, 0.9, 1.2, 1.0])[:, None, None]
    medians = draws * np.array([0.5, 0.8, 1.0, 1.3])[:, None, None]
    band = WaveDraws(seeds=np.arange(4), frequencies=draws, rms=np.zeros(1), lengths=np.zeros((1, 2)))
    joints = Joints(band=band, medians=list(zip(draws, medians, strict=True)))
    best = _combined(SimpleNamespace(study=study, loads=np.ones(1)), {}, states, None, None, joints).best
    assert best == pytest.approx(np.exp(np.log(medians).mean(axis=0)), rel=1e-12)
