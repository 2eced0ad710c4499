"""Damping at levels of acceleration, in a run."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import faying
from faying.answer.run import run
from faying.case import level_damping
from faying.case.level_damping import FRICTION, REST
from faying.cli.run import text
from faying.distribution import Distribution
from faying.export import universal
from faying.form.form import Form
from faying.notes import Note, grave
from faying.output import table
from faying.study import Study
from faying.study.keys.uncertain import Input, UncertainChoice
from tests.helpers import studies

BLOCKS = Path(__file__).parents[2] / "examples" / "two-blocks" / "study.toml"
PLATES = Path(__file__).parents[2] / "examples" / "plates-and-bolts" / "plates.toml"


@pytest.fixture(scope="module")
def fine(tmp_path_factory):
    """Two blocks under JK."""
    path = tmp_path_factory.mktemp("levels") / "study.toml"
    studies.write(path)
    text = path.read_text().replace("levels = []\n", "").replace('["2 kN", "6 kN"]', '"6 kN"')
    path.write_text(text.replace('joint" = "8 mm"', 'joint" = "4 mm"').replace('size = "16 mm"', 'size = "8 mm"'))
    return Study.read(path)


@pytest.fixture(scope="module")
def study(fine):
    """The same on a coarse mesh."""
    sizes = {name: 2 * size for name, size in fine.geometry.face_size.items()}
    geometry = replace(fine.geometry, size=2 * fine.geometry.size, face_size=sizes)
    return replace(fine, geometry=geometry, modes=replace(fine.modes, count=4))


@pytest.fixture(scope="module")
def found(study):
    return run(study)


def test_every_mode_has_a_damping_with_both_ends(study, found):
    assert found.levels.accelerations == pytest.approx([0.1, 1.0, 10.0])
    assert found.levels.damping.shape == (1, 3, 4)
    assert np.all(found.levels.low <= found.levels.damping)
    assert np.all(found.levels.damping <= found.levels.high)
    assert np.all(np.diff(found.levels.slip, axis=1) >= -1e-12)
    assert np.all(found.levels.error < 0.02)
    # the law has a loss of its own, which is that at rest
    assert found.levels.damping == pytest.approx(found.levels.slip + found.loss_factors[:, None] / 2)


def test_small_motions_have_the_frequency_at_rest_and_larger_ones_less(found):
    assert found.levels.frequencies[:, 0] == pytest.approx(found.frequencies, rel=1e-5)
    assert np.all(found.levels.frequencies[:, 2] <= found.frequencies * (1 + 1e-6))


def test_a_friction_that_is_given_leaves_nothing_open(study, found):
    joints = tuple(replace(joint, friction=FRICTION[1]) for joint in study.joints)
    given = run(replace(study, joints=joints))
    assert given.levels.low == pytest.approx(given.levels.high, rel=1e-12)
    assert given.levels.slip == pytest.approx(found.levels.slip, rel=0.05, abs=1e-7)
    assert not [note for note in given.notes if note.code == "level-damping"]
    assert [note for note in found.notes if note.code == "level-damping"]


def test_a_friction_that_scatters_has_its_own_ends(study, found):
    """As [uncertain] lists it, also where the joint has a number: the prior again gives what no number at all does.

    Its least friction is 0.0288 as a lognormal, for 0.03.
    """
    spread = Distribution(kind="lognormal", centre=FRICTION[1], spread=np.log(FRICTION[2] / FRICTION[1]) / 1.6449)
    listed = UncertainChoice(inputs=(Input(key="joint.friction", distribution=spread, unit=""),))
    joints = tuple(replace(joint, friction=0.2) for joint in study.joints)
    scatters = run(replace(study, joints=joints, uncertain=listed)).levels
    assert scatters.slip == pytest.approx(found.levels.slip, rel=1e-3)
    assert scatters.low == pytest.approx(found.levels.low, rel=1e-3)
    assert scatters.high == pytest.approx(found.levels.high, rel=0.05)
    assert np.max(scatters.high / scatters.damping) > 1.2


def test_what_is_not_known_of_friction_and_of_rest_adds_by_squares(study, found, monkeypatch):
    """Of each side by itself: the distance by friction alone is that of a law whose loss is known."""
    monkeypatch.setattr(level_damping, "rest_damping", lambda *_: np.tile(np.array(REST)[:, None], 4))
    both, alone = run(study).levels, found.levels
    assert both.slip == pytest.approx(alone.slip)
    for side, rest in (("low", REST[0] - REST[1]), ("high", REST[2] - REST[1])):
        friction = getattr(alone, side) - alone.damping
        assert np.abs(getattr(both, side) - both.damping) == pytest.approx(np.hypot(friction, rest), rel=1e-9)


def test_the_table_has_a_row_for_each_mode(found):
    rows = table.damping(found)
    assert [len(row) for row in rows] == [5] * 5
    assert rows[1][1].count(" .. ") == 2
    assert not {"-0.000", "+0.000"} & {row[-1] for row in rows}


def test_the_terminal_says_no_note_twice_and_three_first(found):
    more = tuple(
        Note(code="window", severity="limit", text=f"joint: {word} of the scan")
        for word in ("half", "quarter", "third", "fifth")
    )
    lines = text(replace(found, notes=(*found.notes, *more))).splitlines()
    said = [line for line in lines if line.startswith("- ")]
    assert len(said) == len(set(said))
    end = lines.index(f"  {len(grave((*found.notes, *more))) - 3} more at the end")
    assert sum(line.startswith("- ") for line in lines[:end]) == 3
    assert all(any(note.text in line for line in said) for note in more)


def test_csv_and_universal_file_have_the_damping(found, tmp_path):
    heads, first = (line.split(",") for line in found.csv_text().splitlines()[:2])
    assert heads[-3:] == [f"damping ratio at {level} m/s2 [-]" for level in ("0.1", "1", "10")]
    assert [float(value) for value in first[-3:]] == pytest.approx(found.levels.damping[0, :, 0], rel=1e-7)
    # where no law has a loss, the modes of data set 55 have that of the middle level
    lossless = replace(found, loss_factors=np.full(found.loss_factors.shape, np.nan))
    universal.write(lossless, tmp_path)
    modes = faying.read_uff(tmp_path / "modes.uff").modes()
    assert modes.loss_factors == pytest.approx(2 * found.levels.damping[-1, 1], rel=1e-4)


def test_springs_that_do_not_slip_have_a_note_in_place_of_damping(study):
    joints = tuple(replace(joint, springs="per-node") for joint in study.joints)
    bare = run(replace(study, joints=joints))
    assert bare.levels is None
    (note,) = [note for note in bare.notes if note.code == "no-level-damping"]
    assert "springs per node" in note.text
    assert note.severity == "limit"


def test_no_levels_no_damping(study):
    bare = run(replace(study, modes=replace(study.modes, levels=())))
    assert bare.levels is None
    assert not [note for note in bare.notes if note.code == "no-level-damping"]
    assert table.damping(bare) == []
    assert 0 < REST[0] < REST[1] < REST[2]


@pytest.mark.slow
@pytest.mark.parametrize(("mode", "friction", "top"), [(3, 0.03, 100.0), (4, 0.1, 300.0), (5, 0.2, 100.0)])
def test_levels_are_those_of_the_backbone(fine, mode, friction, top):
    """Harmonic balance with harmonics 0 to 3, on the same laws and points: half a per cent of a damping up to 0.3 %."""
    joints = tuple(replace(joint, friction=friction) for joint in fine.joints)
    plan = replace(fine, joints=joints)
    curve = faying.backbone(plan, mode, friction, (0.1, top), rest_damping=0.0)
    picked = [k for k in range(len(curve.acceleration)) if curve.damping[k] > 1e-5][::4]
    levels = tuple(float(curve.acceleration[k]) for k in picked)
    found = run(replace(plan, modes=replace(plan.modes, levels=levels)))
    slip = found.levels.slip[0, :, mode - 1]
    few = curve.damping[picked] < 3e-3
    assert slip[few] == pytest.approx(curve.damping[picked][few], rel=5e-3, abs=1e-7)
    assert slip == pytest.approx(curve.damping[picked], rel=0.02)
    assert np.all(np.abs(slip / curve.damping[picked] - 1) < found.levels.error[0, :, mode - 1] + 2e-3)
    # the loss of the law at rest, which the curve leaves out, moves the complex mode by as much at every level
    change = np.diff(found.levels.frequencies[0, :, mode - 1])
    assert change == pytest.approx(np.diff(curve.frequency[picked]), abs=5e-4 * curve.frequency[0])


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_any_small_structure_has_damping_as_harmonic_balance_has_or_says_that_it_has_none(seed):
    """From motions that nothing slips at to those that no friction holds, on two blocks at random."""
    rng = np.random.default_rng(seed)
    friction, preload = np.exp(rng.uniform(np.log([0.03, 200.0]), np.log([0.5, 2e4])))
    read = Study.read(BLOCKS)
    plan = replace(
        read,
        joints=tuple(replace(joint, friction=float(friction)) for joint in read.joints),
        preloads=(replace(read.preloads[0], forces=(float(preload),)),),
        modes=replace(read.modes, levels=tuple(np.geomspace(0.01, 1000.0, 6).tolist()), intervals=False),
    )
    found = run(plan)
    none = np.isnan(found.levels.damping)
    assert np.array_equal(none, np.isnan(found.levels.frequencies))
    assert any(note.code == "no-level-answer" for note in found.notes) == bool(none.any())
    assert np.all(found.levels.slip[~none] < 1.0)
    mode = 1 + int(np.nanargmax(found.levels.slip[0, -2]))
    curve = faying.backbone(plan, mode, float(friction), (1.0, 1000.0), rest_damping=0.0)
    picked = np.flatnonzero(curve.damping > 1e-6)[::4]
    levels = tuple(float(curve.acceleration[k]) for k in picked)
    found = run(replace(plan, modes=replace(plan.modes, levels=levels)))
    slip, stated = found.levels.slip[0, :, mode - 1], found.levels.error[0, :, mode - 1]
    answered = np.isfinite(slip)
    assert np.count_nonzero(answered) >= len(levels) - 1
    # 3e-6 of a ratio is below the last printed digit
    room = (stated * curve.damping[picked] + 3e-6)[answered]
    assert np.all(np.abs(slip - curve.damping[picked])[answered] < room)


@pytest.mark.slow
@pytest.mark.parametrize(("mode", "friction", "top"), [(1, 0.1, 100.0), (3, 0.2, 100.0), (4, 0.5, 300.0)])
def test_levels_are_those_of_the_backbone_on_lapped_plates(mode, friction, top):
    """Thin laps open and slip at single points: 1 % of the damping up to 100 m/s2, within the stated error."""
    study = Study.read(PLATES)
    sizes = {name: 1.6 * size for name, size in study.geometry.face_size.items()}
    plan = replace(
        study,
        geometry=replace(study.geometry, size=1.6 * study.geometry.size, face_size=sizes),
        preloads=study.preloads[-1:],
        joints=tuple(replace(joint, friction=friction, form=Form()) for joint in study.joints),
        modes=replace(study.modes, count=5, intervals=False),
    )
    curve = faying.backbone(plan, mode, friction, (1.0, top), rest_damping=0.0)
    picked = np.flatnonzero(curve.damping > 1e-6)[::3]
    levels = tuple(float(curve.acceleration[k]) for k in picked)
    found = run(replace(plan, modes=replace(plan.modes, levels=levels)))
    slip, stated = found.levels.slip[0, :, mode - 1], found.levels.error[0, :, mode - 1]
    assert slip == pytest.approx(curve.damping[picked], rel=0.01)
    assert np.all(np.abs(slip / curve.damping[picked] - 1) < stated + 2e-3)
    assert found.levels.frequencies[0, :, mode - 1] == pytest.approx(curve.frequency[picked], rel=1e-4)
