"""Waves that scatter: another draw in each sample, the same again with the same seed, and not for identification."""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.answer.run import run
from faying.identify.sampling.ensemble import Ensemble
from faying.identify.sampling.evaluate import DRAWN, LIMIT, Evaluator, Reduced
from faying.study import Study
from faying.study.keys import test as keys
from tests.helpers.studies import write

MEASURED = keys.TestChoice(
    source="none: the fault comes before it is used",
    frequencies=((9e3, 1e4), (9.1e3, 1.01e4)),
    published=None,
    published_name="",
    kind="test",
    points=((0.0, 0.0, 0.0),),
    direction=(1.0, 0.0, 0.0),
)


def study_of(folder, uncertain, form=""):
    """The blocks of `faying init` on a coarse mesh, with a form and [uncertain]."""
    path = folder / "study.toml"
    write(path, force=True, flat=False)
    text = path.read_text()
    if form:
        text = text.replace("\n[[bolt]]", f"\n[joint.form]\n{form}\n\n[[bolt]]", 1)
    path.write_text(f"{text}\n[uncertain]\nonly = true\n{uncertain}\n")
    study = Study.read(path)
    return replace(study, modes=replace(study.modes, count=2))


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return study_of(tmp_path_factory.mktemp("waves"), 'waviness = "0.3 um to 1 um"')


@pytest.fixture(scope="module")
def found(study):
    return faying.predict(study, samples=8, seed=4)


def test_size_and_draw_are_inputs_of_every_joint(study):
    (size, draw) = study.uncertain.inputs
    assert (size.key, draw.key) == ("joint.joint.form.waviness", "joint.joint.form.waviness_seed")
    assert size.unit == "m"
    ensemble = Ensemble.of(study, 32, 0)
    forms = [
        ensemble.point(2 * k).study.joints[0].form.waviness for k in range(ensemble.training, len(ensemble.values))
    ]
    sizes = np.array([w.Wq for w in forms])
    assert 0.3e-6 <= sizes.min() < 0.35e-6 < 0.95e-6 < sizes.max() <= 1e-6
    assert len({w.seed for w in forms}) == 32
    both = [ensemble.point(k).study.joints[0].form for k in (0, 1)]
    assert both[0] == both[1]  # a sample has the same waves at all of its loads


@pytest.mark.slow
def test_samples_differ_and_come_again_with_the_seed(study, found):
    assert np.isfinite(found.frequencies).all()
    assert len(np.unique(np.round(found.frequencies[:, 0, 0], 3))) == 8
    again, other = (Ensemble.of(study, 8, seed) for seed in (4, 5))
    assert np.array_equal(again.values[again.training :], found.values)
    assert not np.isin(other.values[other.training :, 1], found.values[:, 1]).any()


@pytest.mark.slow
def test_a_sample_is_the_study_with_its_waves(study, found):
    """A sample from the small bases, against a full run with its size and its draw as a form: to what bases promise.

    The sample follows the modes of the median, which may be higher ones here. As modelled: a prediction takes off the
    error of the mesh.
    """
    ensemble = Ensemble.of(study, 8, 4)
    modelled = Reduced(ensemble).rows(ensemble)["frequencies"]
    joint, bare = study.joints[0], replace(study, uncertain=None, modes=replace(study.modes, count=6, levels=()))
    names = [name.rpartition(".")[2] for name in found.names]
    for number in (3,):
        values = dict(zip(names, found.values[number], strict=True))
        waves = faying.Waviness(Wq=values["waviness"], seed=int(values["waviness_seed"]))
        full = run(replace(bare, joints=(replace(joint, form=faying.Form(waviness=waves)),)))
        apart = np.abs(modelled[number][..., None] / full.frequencies[:, None] - 1)
        assert apart.min(axis=-1).max() < 2 * DRAWN
        assert all(len(set(row)) == len(row) for row in apart.argmin(axis=-1).tolist())


@pytest.mark.slow
def test_modes_have_the_names_of_those_as_modelled(study):
    """Those of one draw of waves took them: two modes of the study of `init` went from 17.3 to 10.5 kHz by preload."""
    reduced = Reduced(Ensemble.of(study, 8, 4))
    named = Evaluator(model=reduced.model, builder=reduced.trainer.builder).with_median(0).median
    modelled = run(replace(study, uncertain=None, modes=replace(study.modes, levels=())))
    assert [one.frequencies for one in named] == [pytest.approx(row, rel=LIMIT) for row in modelled.frequencies]


@pytest.mark.slow
def test_a_sample_that_cannot_be_loses_no_other(study):
    """Waves of 5 mm on a face of 30 mm are refused; the sample beside them has the answer that it has alone."""
    ensemble = Ensemble.of(study, 8, 4)
    reduced = Reduced(ensemble)
    both = reduced.rows(ensemble.with_values(np.array([[5e-7, 3.0], [5e-3, 4.0]])), "both")
    alone = reduced.rows(ensemble.with_values(np.array([[5e-7, 3.0]])), "alone")
    assert both["frequencies"][0] == pytest.approx(alone["frequencies"][0], rel=2 * DRAWN)
    assert np.isnan(both["frequencies"][1]).all()
    assert "waviness" in both["reasons"][1]


def test_true_draws_waves_of_the_size_that_the_form_gives(tmp_path):
    study = study_of(tmp_path, "waviness = true", 'waviness = { Wq = "0.5 um" }')
    assert [one.key for one in study.uncertain.inputs] == ["joint.joint.form.waviness_seed"]
    forms = [Ensemble.of(study, 8, 0).point(k).study.joints[0].form for k in (0, 4)]
    assert [form.waviness.Wq for form in forms] == pytest.approx([0.5e-6] * 2)
    with pytest.raises(faying.InputError, match="whose size the joint gives, and 'joint' gives none"):
        study_of(tmp_path, "waviness = true")


def test_a_size_in_its_place_scatters_with_one_draw(tmp_path):
    study = study_of(tmp_path, "", 'waviness = { Wq = "0.3 um to 1 um", seed = 5 }')
    assert [one.key for one in study.uncertain.inputs] == ["joint.joint.form.waviness"]
    assert study.joints[0].form.waviness.Wq == pytest.approx(0.65e-6)
    assert Ensemble.of(study, 8, 0).point(20).study.joints[0].form.waviness.seed == 5


def test_an_identification_cannot_follow_draws(study):
    tested = replace(study, test=MEASURED)
    with pytest.raises(faying.InputError, match="drawn anew in each sample, and no identification can follow"):
        faying.identify(tested)
