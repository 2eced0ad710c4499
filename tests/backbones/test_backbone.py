"""Backbones of a study: limits, bases, bundles, what is kept of a computation that is killed, and faults by name."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import faying
from faying.backbones import backbone as backbone_store
from faying.errors import InputError
from faying.joint.joint import FittedJoint
from faying.microslip.epmc import Epmc
from faying.output import table
from faying.output.sections import sections
from faying.result import Result
from faying.result.backbone import label
from faying.study import Study
from faying.study.keys.backbone import BackboneChoice
from faying.study.keys.law import LawChoice
from faying.study.study import Study as StudyClass
from tests.helpers.laws import Given

EXAMPLE = Path(__file__).parents[2] / "examples" / "two-blocks"
RANGE = 500.0, 4000.0
LOW = {"mode": 1, "friction": 0.2, "amplitude": RANGE}


@pytest.fixture(scope="module")
def study():
    return Study.read(EXAMPLE / "study.toml")


@pytest.fixture(scope="module")
def curve(study):
    return faying.backbone(study, **LOW)


def test_it_begins_at_the_mode_at_rest(study, curve):
    result = faying.run(study)
    assert curve.preload == 3000.0
    # the mode of the complex problem differs from the real one by the square of its loss factor
    assert curve.linear_frequency == pytest.approx(result.frequencies[1, 0], rel=1e-4)
    slow = faying.backbone(study, mode=1, friction=0.2, amplitude=(1e-3, 2e-3), harmonics=1)
    assert slow.frequency[0] == pytest.approx(curve.linear_frequency, rel=1e-8)
    assert abs(slow.damping[0]) < 1e-9


def test_the_curve_softens_and_loses_more(curve):
    assert np.all(np.diff(curve.acceleration) > 0)
    assert np.all(np.diff(curve.damping) > 0)
    assert curve.frequency[-1] < curve.linear_frequency
    assert np.all((curve.slipping >= 0) & (curve.slipping <= 1))
    assert curve.code == "amplitude"
    assert curve.acceleration[-1] == pytest.approx(RANGE[1], rel=5e-3)


def test_the_loss_of_the_joints_is_that_of_the_damping(curve):
    # harmonics above the first add what their share squared is
    w = 2 * np.pi * curve.frequency
    assert np.allclose(
        curve.energy.sum(axis=1), 2 * np.pi * curve.damping * (w * curve.modal_amplitude) ** 2, rtol=0.02
    )
    assert np.allclose(curve.displacement * w**2, curve.acceleration, rtol=1e-12)


def test_the_static_cycle_stands_beside_the_curve(curve):
    assert curve.witness is not None
    assert np.all(np.abs(curve.witness.frequency_change) < 2e-3)
    noted = [note for note in curve.notes if note.code == "backbone-witness"]
    assert len(noted) == np.count_nonzero(np.abs(curve.witness.damping_change) > 0.02)


def test_a_basis_of_all_modes_moves_nothing(study, curve, monkeypatch):
    from faying.backbones import backbone as module

    monkeypatch.setattr(module, "EXTRA_MODES", 2 * curve.basis_size)
    large = faying.backbone(study, **LOW)
    assert large.basis_size > 2 * curve.basis_size
    f, z = large.at_acceleration(curve.acceleration[:-1])
    np.testing.assert_allclose(f, curve.frequency[:-1], rtol=2e-5)
    np.testing.assert_allclose(z, curve.damping[:-1], rtol=0.01)


def test_a_list_of_frictions_gives_curves_from_one_basis(study, curve):
    both = faying.backbone(study, mode=1, friction=[0.2, 0.8], amplitude=RANGE, harmonics=1)
    assert [c.friction for c in both] == [(0.2,), (0.8,)]
    assert both[0].basis_size == both[1].basis_size
    assert np.all(both[1].damping < both[0].damping[: len(both[1].damping)])


@pytest.mark.slow
def test_a_list_of_laws_gives_curves_from_one_basis(study, curve):
    """A law with 1.9 times the radius is stiffer: its curve in the common basis is that which it has alone."""
    given = {"density": 2e10, "radius": 30e-6, "sigma": 0.4e-6}
    stiff = LawChoice(model="gw", given=given)
    mine = replace(study, joints=tuple(replace(joint, law=stiff) for joint in study.joints))
    quick = {"mode": 1, "friction": 0.2, "amplitude": RANGE, "harmonics": 1}
    jk, gw = faying.backbone(mine, **quick, law=["jk", "gw"])
    assert (jk.laws, gw.laws) == (("JK",), ("GW",))
    assert jk.basis_size == gw.basis_size
    alone = faying.backbone(mine, **quick)
    for found, own in ((jk, faying.backbone(study, **quick)), (gw, alone)):
        assert found.linear_frequency == pytest.approx(own.linear_frequency, rel=1e-7)
        f, z = found.at_acceleration(own.acceleration[:-1])
        np.testing.assert_allclose(f, own.frequency[:-1], rtol=2e-5)
        np.testing.assert_allclose(z, own.damping[:-1], rtol=0.02)
    assert label(jk, (jk, gw)) == "JK"
    assert any("tangential" in note.text for note in gw.notes)
    assert not any("tangential" in note.text for note in jk.notes)


def test_measured_points_of_the_study_stand_beside_the_curve(study, tmp_path):
    file = tmp_path / "points.csv"
    file.write_text("acceleration [m/s^2],frequency [Hz],damping [%]\n600,8727,.001\n9000,8725,.01\n", encoding="utf-8")
    mine = replace(study, backbone=BackboneChoice(friction=(0.2,), amplitude=RANGE, harmonics=1, measured=file))
    found = faying.backbone(mine)
    assert found.measured.source == "points.csv"
    assert found.measured.damping[0] == pytest.approx(1e-5)
    frequency, damping = found.at_measured()
    f, z = found.at_acceleration(600.0)
    assert (frequency[0], damping[0]) == (pytest.approx(float(f)), pytest.approx(float(z)))
    assert np.isnan(frequency[1])  # beyond the end of the curve
    found.save(tmp_path / "curve.nc")
    assert faying.Backbone.load(tmp_path / "curve.nc") == found
    rows = table.backbone_measured(found)
    assert [row[0] for row in rows[1:]] == ["600", "9000"]
    assert rows[2][2] == "-"


def test_preload_stiffens_and_holds(study):
    loose, tight = (faying.backbone(study, **LOW, harmonics=1, load=load) for load in (1000.0, 3000.0))
    assert loose.linear_frequency < tight.linear_frequency
    assert loose.slipping[-1] > tight.slipping[-1]


@pytest.mark.slow
def test_loads_share_a_basis(study):
    from faying.backbones.backbone import backbones, chosen

    choice = chosen(study, 0.2, {"amplitude": RANGE, "harmonics": 1})
    loose, tight = backbones(study, choice)
    alone = faying.backbone(study, **LOW, harmonics=1, load=3000.0)
    assert loose.preload == 1000.0
    assert tight.frequency[-1] == pytest.approx(alone.frequency[-1], rel=2e-4)
    assert tight.linear_frequency == pytest.approx(alone.linear_frequency, rel=1e-6)


def test_what_is_asked_for_at_a_point(study, curve):
    corner = faying.backbone(study, **LOW, harmonics=1, at=(0.0, 0.0, 0.0))
    assert np.allclose(corner.at, 0)
    assert abs(corner.shape_at) <= abs(curve.shape_at) * (1 + 1e-9)
    assert np.linalg.norm(corner.direction) == pytest.approx(1)


@pytest.mark.slow
def test_damping_at_rest_is_added(study, curve):
    more = faying.backbone(study, **LOW, rest_damping=0.001)
    np.testing.assert_allclose(more.damping, curve.damping + 0.001, rtol=1e-9)
    assert [n.code for n in curve.notes if n.code == "backbone-rest"] == ["backbone-rest"]
    law = faying.backbone(study, **LOW, harmonics=1, rest_damping="law")
    assert law.rest_damping == pytest.approx(faying.run(study).loss_factors[1, 0] / 2, rel=1e-3)


def test_a_killed_computation_goes_on(study, curve, tmp_path, monkeypatch):
    out = tmp_path / "curve.nc"
    solved = []
    solve = Epmc.solve

    def killed(self, amplitude, known=()):
        if len(solved) == 12:
            raise KeyboardInterrupt
        if self.harmonics == 3:
            solved.append(amplitude)
        return solve(self, amplitude, known)

    half = {**LOW, "amplitude": (50.0, 4000.0)}
    monkeypatch.setattr(Epmc, "solve", killed)
    with pytest.raises(KeyboardInterrupt):
        faying.backbone(study, **half, out=out)
    part = tmp_path / "curve.nc.part"
    kept = len(list(part.glob("curve-0-*.npz")))
    assert kept > 5
    first = solved[:kept]
    solved.clear()
    monkeypatch.setattr(Epmc, "solve", lambda self, q, known=(): (solved.append(q), solve(self, q, known))[1])
    again = faying.backbone(study, **half, out=out)
    assert not set(first) & set(solved)
    assert not part.exists()
    assert faying.Backbone.load(out) == again
    np.testing.assert_allclose(again.modal_amplitude[: len(first)], first, rtol=1e-12)
    with pytest.raises(InputError, match=r"should end in \.nc"):
        faying.backbone(study, **LOW, out=tmp_path / "curve.csv")


def test_leftovers_of_another_curve_are_not_taken_up(study, tmp_path):
    out = tmp_path / "curve.nc"
    with backbone_store.CurveStore(out, "another") as store:
        store.keep_basis(np.zeros((3, 1)))
    with pytest.raises(InputError, match="another backbone has left"):
        faying.backbone(study, **LOW, out=out)


def test_friction_of_the_joints_is_taken(study):
    joints = tuple(replace(joint, friction=0.3) for joint in study.joints)
    own = faying.backbone(replace(study, joints=joints), mode=1, amplitude=RANGE, harmonics=1)
    assert own.friction == (0.3,)


def _without_shear(monkeypatch):
    law = Given(k_n=lambda p: 1e9 * p**0.5, k_t=lambda p: 0.0 * p)
    springs = FittedJoint.springs

    def slippery(self, pressure):
        return springs(replace(self, law=replace(self.law, model=law, tangential="law")), pressure)

    monkeypatch.setattr(FittedJoint, "springs", slippery)


def test_faults_are_named(study, monkeypatch):
    with pytest.raises(InputError, match="joint 'joint' has no friction.*give friction = 0.2"):
        faying.backbone(study)
    with pytest.raises(InputError, match="friction = 0 is not a coefficient"):
        faying.backbone(study, friction=0.0)
    with pytest.raises(InputError, match="give the least acceleration"):
        faying.backbone(study, friction=0.2, amplitude=(5.0, 1.0))
    with pytest.raises(InputError, match="harmonics = 0"):
        faying.backbone(study, friction=0.2, harmonics=0)
    with pytest.raises(InputError, match="elastic modes count from 1"):
        faying.backbone(study, friction=0.2, mode=0)
    with pytest.raises(InputError, match="preload = 2 kN: the study has no such preload; it has 1 kN, 3 kN"):
        faying.backbone(study, friction=0.2, load=2000.0)
    with pytest.raises(InputError, match="rest_damping = 2"):
        faying.backbone(study, friction=0.2, rest_damping=2.0)
    with pytest.raises(InputError, match="point of the backbone: the nearest node"):
        faying.backbone(study, friction=0.2, at=(9.0, 0.0, 0.0))
    per_node = replace(study, joints=tuple(replace(joint, springs="per-node") for joint in study.joints))
    with pytest.raises(InputError, match="springs per area"):
        faying.backbone(per_node, friction=0.2)
    _without_shear(monkeypatch)
    with pytest.raises(InputError, match="no tangential stiffness"):
        faying.backbone(study, friction=0.2)


KEYS = """
[backbone]
mode = 2
amplitude = ["1 m/s^2", "60 m/s^2"]
at = ["0 mm", "10 mm", "0 mm"]
friction = [0.1, 0.2]
harmonics = 1
rest_damping = "law"
slip = "coulomb"
law = ["jk", "mb"]
"""


@pytest.mark.slow
def test_a_run_follows_the_mode_that_the_study_names(tmp_path):
    text = (EXAMPLE / "study.toml").read_text().replace("model.inp", str(EXAMPLE / "model.inp"))
    keys = '[backbone]\namplitude = ["300 m/s^2", "900 m/s^2"]\nharmonics = 1\nfriction = [0.1, 0.3]\n'
    (tmp_path / "study.toml").write_text(text + keys)
    said = []
    found = faying.run(tmp_path / "study.toml", report=lambda stage, *_: said.append(stage))
    assert said[-1] == "mode 1 over amplitude"
    alone = faying.backbone(tmp_path / "study.toml", friction=[0.1, 0.3])
    for curve, other in zip(found.backbones, alone, strict=True):
        assert curve.preload == found.loads[-1]
        assert curve.linear_frequency == pytest.approx(found.frequencies[-1, 0], rel=1e-3)
        assert np.allclose(curve.frequency, other.frequency, rtol=1e-9)
        assert np.allclose(curve.damping, other.damping, rtol=1e-6)
    assert Result.load(found.save(tmp_path / "result.nc")) == found
    assert len(found.to_dict()["backbones"]) == 2
    shown = [section.name for section in sections(found)]
    assert shown.count("backbone") == shown.count("backbone bounds") == 2


def test_a_run_without_friction_says_so_before_the_work(tmp_path):
    text = (EXAMPLE / "study.toml").read_text().replace("model.inp", str(EXAMPLE / "model.inp"))
    (tmp_path / "study.toml").write_text(text + "[backbone]\nmode = 2\n")
    said = []
    with pytest.raises(InputError, match="has no friction, and without it nothing slips"):
        faying.run(tmp_path / "study.toml", report=lambda stage, *_: said.append(stage))
    assert said == []


def test_the_study_says_which_curve(tmp_path):
    text = (EXAMPLE / "study.toml").read_text().replace("model.inp", str(EXAMPLE / "model.inp"))
    file = tmp_path / "study.toml"
    file.write_text(text + KEYS)
    assert StudyClass.read(file).backbone == BackboneChoice(
        mode=2,
        amplitude=(1.0, 60.0),
        at=(0.0, 0.01, 0.0),
        friction=(0.1, 0.2),
        harmonics=1,
        rest_damping="law",
        slip="coulomb",
        laws=(LawChoice(model="JK"), LawChoice(model="MB")),
    )
    with pytest.raises(InputError, match="lists friction 0.1, 0.2: give one"):
        faying.backbone(file)
    file.write_text(text + '[backbone]\namplitude = "1:60"\nfriction = "rough"\nspeed = 3\n')
    with pytest.raises(InputError) as fault:
        StudyClass.read(file)
    for words in ("has no unit", "backbone.friction", "backbone.speed is not a key"):
        assert words in str(fault.value)


def test_coulomb_loses_nothing_until_a_point_slides(study):
    coarse = faying.backbone(study, mode=1, friction=0.5, amplitude=(10.0, 100.0), slip="coulomb", harmonics=1)
    assert np.all(np.abs(coarse.damping) < 1e-8)
