"""Backbones of samples: each is that of the study with its numbers, they scale as they must, and ends are said."""

import json
import pickle
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray

import faying
from faying.backbones.backbone import median_of
from faying.cli import main
from faying.errors import InputError
from faying.form.form import Form
from faying.identify import predict as module
from faying.identify import prediction as drawing
from faying.identify.backbones import Backbones
from faying.identify.prediction import Prediction
from faying.identify.sampling import follow
from faying.identify.sampling.ensemble import Ensemble
from faying.identify.sampling.follow import Follower, sliding
from faying.output import prediction as tables
from faying.output.report_predicted import predicted
from faying.progress import silent
from faying.study import Study
from faying.sweeps.trainer import Trainer
from tests.helpers.preloads import pulled

EXAMPLE = Path(__file__).parents[2] / "examples" / "two-blocks"
LAW = """
[law]
model = "power-law"   # knows no modulus
C = 4e-10
m = 0.5

[backbone]
mode = 3   # twists, so that the joint slips and hardly opens
amplitude = ["100 m/s^2", "500 m/s^2"]
harmonics = 1
friction = 0.2
"""
SURFACE = """[surface]
D = 2.39
G = "1.53e-10 m"
scan_area = "16 mm^2"
"""
SCATTER = """
[uncertain]
only = true
friction = "0.1 to 0.6"
E = "200 GPa +- 4 GPa"
preload = { tightening = "torque wrench, friction estimated" }
"""


def study_of(more=SCATTER, law=LAW):
    text = (EXAMPLE / "study.toml").read_text(encoding="utf-8")
    start, end = text.index("[surface]"), text.index("[[joint]]")
    return Study.from_dict(tomllib.loads(text[:start] + text[end:] + law + more), folder=EXAMPLE)


@pytest.fixture(scope="module")
def plan():
    return study_of()


@pytest.fixture(scope="module")
def found(plan):
    return faying.predict(plan, samples=16, seed=1, backbones=8)


def follower(study, values):
    """What follows samples of given values (n, d)."""
    ensemble = Ensemble.of(study, 8, 0).with_values(np.array(values))
    trainer = Trainer.of(study, ensemble, 1e-4, silent)
    shape, at = median_of(trainer.builder.case(trainer.structure, ensemble.middle), study.backbone)
    bare = replace(trainer.structure, assembled=None)
    return Follower(structure=bare, builder=trainer.builder, choice=replace(study.backbone, at=at), shape=shape)


def test_a_sample_has_the_curve_of_the_study_with_its_numbers(plan, found):
    curves, names = found.backbones, list(found.names)
    for sample in (0, 5):
        drawn = dict(zip(names, found.values[sample], strict=True))
        steel = replace(plan.materials["45 steel"], E=drawn["material.45 steel.E"])
        (joint,) = plan.joints
        mine = replace(
            pulled(plan, 3000.0 * drawn["bolt.bolt 1.factor"]),
            materials={**plan.materials, "45 steel": steel},
            joints=(replace(joint, friction=drawn["joint.friction"]),),
            backbone=replace(plan.backbone, friction=()),
            uncertain=None,
        )
        curve = faying.backbone(mine, at=tuple(curves.at))
        f, z = curve.at_acceleration(np.minimum(curves.acceleration, curve.acceleration[-1]))
        np.testing.assert_allclose(curves.frequencies[sample], f, rtol=1e-8)
        np.testing.assert_allclose(curves.damping[sample], z, rtol=1e-5)


def test_a_form_that_scatters_is_that_of_the_study_with_it():
    study = study_of('[uncertain]\nonly = true\njoint.form.crown_along = "0.1 um to 0.9 um"')
    work = follower(study, [[0.7e-6]])
    joint = replace(study.joints[0], form=Form(crown_along=0.7e-6))
    curve = faying.backbone(replace(study, joints=(joint,), uncertain=None), at=work.choice.at)
    rows = work.rows([0])
    f, z = curve.at_acceleration(np.minimum(work.grid, curve.acceleration[-1]))
    np.testing.assert_allclose(rows["frequencies"][0], f, rtol=1e-8)
    np.testing.assert_allclose(rows["damping"][0], z, rtol=1e-5)


def test_at_rest_a_curve_begins_at_the_frequency_of_the_prediction(found):
    """The bases err by 1e-4 of a frequency where they were trained."""
    rest = found.frequencies[:8, -1, 2]
    assert found.backbones.frequencies[:, 0] == pytest.approx(rest, rel=1e-3)
    assert np.all(np.diff(found.backbones.frequencies, axis=1) < 0)
    assert np.all(np.diff(found.backbones.damping, axis=1) > 0)


def test_all_stiffness_times_a_factor_leaves_the_damping_at_an_acceleration():
    """Forces at the same acceleration are the same, and so are pressures and slip: f goes with the root alone."""
    study = study_of('[uncertain]\nonly = true\nE = "200 GPa +- 4 GPa"\nstiffness = "0.9 to 1.1"')
    rows = follower(study, [[200e9, 1.0], [1.04 * 200e9, 1.04]]).rows([0, 1])
    one, two = rows["frequencies"]
    np.testing.assert_allclose(two, 1.04**0.5 * one, rtol=1e-6)
    np.testing.assert_allclose(rows["damping"][1], rows["damping"][0], rtol=2e-3)


def test_friction_scales_small_motions_and_changes_nothing_at_rest():
    """In Mindlin's solution what a small motion loses and softens goes with the motion over the friction."""
    study = study_of('[uncertain]\nonly = true\nfriction = "0.1 to 0.6"')
    study = replace(study, backbone=replace(study.backbone, amplitude=(120.0, 300.0)))
    friction = np.array([[0.15], [0.3], [0.6]])
    rows = follower(study, friction).rows([0, 1, 2])
    f, z = rows["frequencies"], rows["damping"]
    assert np.all(np.diff(f, axis=0) > 0)
    np.testing.assert_allclose(z * friction, np.broadcast_to(z[1] * friction[1], z.shape), rtol=0.07)
    at_rest = f[1:] + np.diff(f, axis=0) * friction[:-1] / (friction[1:] - friction[:-1])  # f = f_rest - c/friction
    assert np.ptp(at_rest) < 0.05 * np.ptp(f[:, -1])


def test_a_joint_that_slides_ends_its_curve():
    study = study_of('[uncertain]\nonly = true\nfriction = "0.01 to 0.6"')
    study = replace(study, backbone=replace(study.backbone, amplitude=(100.0, 5e3)))
    rows = pickle.loads(pickle.dumps(follower(study, [[0.1]]))).rows([0])  # as other processes have it
    going = np.isfinite(rows["frequencies"][0])
    assert 2 < going.sum() < len(going)
    assert not np.any(np.diff(going.astype(int)) > 0)  # without gaps
    assert np.array_equal(going, np.isfinite(rows["damping"][0]))
    assert "slide" in rows["ends"][0] or "other modes" in rows["ends"][0]
    assert rows["reasons"][0] == ""


def test_a_sample_whose_modes_are_others_has_no_curve(plan):
    work = follower(plan, [[0.2, 200e9, 1.0]])
    other = np.random.default_rng(0).standard_normal(len(work.shape))
    rows = replace(work, shape=other).rows([0])
    assert rows["reasons"][0].startswith("no mode has the shape of mode 3")
    assert np.isnan(rows["frequencies"]).all()


def given(frequencies, **more):
    """Backbones of given frequencies (curve, amplitude)."""
    values = np.array(frequencies)
    return Backbones(
        mode=1,
        preload=1e3,
        at=np.zeros(3),
        acceleration=np.geomspace(1.0, 10.0, values.shape[1]),
        frequencies=values,
        damping=1e-3 * values,
        **more,
    )


def test_quantiles_stop_where_fewer_than_half_of_the_curves_go_on():
    nan = np.nan
    rows = [[10, 9, 8], [20, 18, nan], [30, nan, nan], [40, 36, nan], [nan, nan, nan]]
    curves = given(rows, reasons={"no answer": 1}, ends={"it slides": 3})
    assert curves.answered == 4
    assert curves.reached.tolist() == [4, 3, 1]
    frequencies, damping = curves.quantiles((0.0, 0.5, 1.0))
    np.testing.assert_array_equal(frequencies, [[10, 9, nan], [25, 18, nan], [40, 36, nan]])
    np.testing.assert_allclose(damping, 1e-3 * frequencies)
    told = {note.code: note.text for note in curves.notes}
    assert told["no-backbone"] == "1 of 5 samples have no backbone: no answer"
    assert told["backbone-ends"] == "3 of 4 backbones end early: it slides"
    assert told["backbone-survivors"].startswith(
        "from 3.16 m/s2 on the quantiles are those of the backbones that go on"
    )
    assert "from 10 m/s2 on fewer than half do" in told["backbone-survivors"]
    assert not given([[10.0, 9.0]]).notes


@pytest.mark.slow
def test_without_any_curve_there_are_no_quantiles(found):
    curves = given(np.full((3, 2), np.nan), reasons={"no answer": 3})
    assert np.isnan(curves.quantiles((0.5,))).all()
    assert not curves.enough.any()
    shown = replace(found, backbones=curves)
    assert tables.backbones(shown)[1][1:] == ["-", "-", "0 of 0"]
    assert drawing.backbones(shown).axes


def test_it_is_written_and_read(found, tmp_path):
    path = found.save(tmp_path / "prediction.nc")
    assert Prediction.load(path) == found
    with xarray.open_dataset(path, group="backbones") as data:
        assert data.frequencies.dims == ("curve", "amplitude")
        assert data.damping.shape == found.backbones.damping.shape


def test_it_is_shown(found, tmp_path):
    q = found.quantiles()
    assert q.backbone_frequencies.shape == q.backbone_damping.shape == (3, len(found.backbones.acceleration))
    assert replace(found, backbones=None).quantiles().backbone_frequencies is None
    rows = tables.backbones(found)
    assert rows[1][0] == "100"
    assert rows[-1][-1] == "8 of 8"
    assert f"{q.backbone_frequencies[1, 0]:.1f}" in rows[1][1]
    assert "backbones, 5 % .. median .. 95 %: mode 3 at 3 kN" in tables.text(found)
    page = predicted(found)
    assert "Backbones, 5% .. median .. 95%" in page
    assert page.count("<figure>") == 3
    summary = json.loads(json.dumps(found.to_dict()))["backbones"]
    assert summary["reached"] == [8] * len(found.backbones.acceleration)
    assert summary["frequencies"]["values"][1][0] == pytest.approx(q.backbone_frequencies[1, 0])
    with pytest.raises(InputError, match="--backbones"):
        drawing.backbones(replace(found, backbones=None))


def test_measured_points_of_the_study_stand_over_the_bands(found, tmp_path):
    file = tmp_path / "points.csv"
    file.write_text("acceleration [m/s^2],frequency [Hz],damping [%]\n600,8727,.001\n", encoding="utf-8")
    measured = follow.measured_points(file)
    curves = replace(found.backbones, **measured)
    assert curves.measured.source == "points.csv"
    fig = drawing.backbones(replace(found, backbones=curves))
    assert "points" in fig.axes[0].get_legend_handles_labels()[1]


@pytest.mark.slow
def test_what_was_done_before_an_interruption_is_kept(plan, found, tmp_path, monkeypatch):
    out, calls = tmp_path / "p.nc", []
    curve = Follower.curve

    def stops(self, sample):
        calls.append(sample)
        if len(calls) == 4:
            raise KeyboardInterrupt
        return curve(self, sample)

    monkeypatch.setattr(Follower, "curve", stops)
    with pytest.raises(KeyboardInterrupt):
        faying.predict(plan, samples=16, seed=1, backbones=8, out=out)
    monkeypatch.setattr(follow, "median_of", None)  # not looked for again
    again = faying.predict(plan, samples=16, seed=1, backbones=8, out=out)
    assert calls == [0, 1, 2, 3, 3, 4, 5, 6, 7]
    np.testing.assert_allclose(again.backbones.frequencies, found.backbones.frequencies, rtol=1e-10)
    np.testing.assert_allclose(again.backbones.damping, found.backbones.damping, rtol=1e-6)
    assert Prediction.load(out) == again


@pytest.mark.parametrize(
    ("more", "law", "count", "words"),
    [
        (SCATTER, LAW.partition("[backbone]")[0], 8, r"need a \[backbone\]"),
        (SCATTER, LAW, 4, "whole number from 8"),
        (SCATTER, LAW, 17, "to that of the samples, 16"),
        (SCATTER, LAW, True, "give a whole number"),
        (SCATTER, LAW.replace("friction = 0.2", "friction = [0.2, 0.4]"), 8, "one friction and no law"),
        (SCATTER, LAW.replace("[backbone]", SURFACE + '[backbone]\nlaw = "jk"'), 8, "one friction and no law"),
        ('[uncertain]\nonly = true\nE = "200 GPa +- 4 GPa"', LAW.replace("friction = 0.2", ""), 8, "has no friction"),
    ],
)
def test_what_cannot_be_is_refused_before_the_mesh(more, law, count, words, monkeypatch):
    study = study_of(more, law)
    monkeypatch.setattr(Trainer, "of", None)
    with pytest.raises(InputError, match=words):
        faying.predict(study, samples=16, backbones=count)


def test_drawn_friction_goes_before_that_of_the_backbone():
    both = study_of()
    drawn, other = (
        Ensemble.of(study_of(more), 8, 0) for more in (SCATTER, '[uncertain]\nonly = true\nE = "200 GPa +- 4 GPa"')
    )
    assert sliding(drawn, both.backbone, 0) == pytest.approx((0.35,))
    assert sliding(other, both.backbone, 0) == (0.2,)


def test_the_command_draws_bands_and_prints_them(capsys, tmp_path, monkeypatch, found):
    asked = {}

    def given_back(study, *args, **options):
        asked.update(options)
        return found

    monkeypatch.setattr(module, "predict", given_back)
    bands = tmp_path / "bands.svg"
    out = ["--out", str(tmp_path / "p.nc"), "--json"]
    with pytest.raises(SystemExit) as stop:
        main(["predict", str(EXAMPLE / "uncertain.toml"), "--backbones", "8", "--bands", str(bands), *out])
    assert not stop.value.code
    assert asked["backbones"] == 8
    summary = json.loads(capsys.readouterr().out)
    assert summary["files"][-1] == str(bands)
    assert summary["backbones"]["answered"] == 8
    assert bands.stat().st_size > 10_000


def test_the_command_asks_for_backbones_before_it_draws_them(capsys, tmp_path):
    with pytest.raises(SystemExit) as stop:
        main(["predict", str(EXAMPLE / "uncertain.toml"), "--bands", str(tmp_path / "bands.svg")])
    assert stop.value.code
    assert "--backbones 32" in capsys.readouterr().err
