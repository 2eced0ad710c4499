"""The form of faces as an input of a study."""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.answer.run import run
from faying.case.case import Case, build
from faying.case.changed import TOLERANCE
from faying.form.form import Form
from faying.form.waviness import ASSUMED, GAUSSIAN, PROCESSES
from faying.joint.modal import ModesChoice
from faying.study import Study
from tests.helpers.preloads import pulled
from tests.helpers.studies import write


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("form") / "study.toml"
    write(path, flat=False)
    return path


def with_form(path, text):
    """The template's study with a table [joint.form]."""
    lines = path.read_text().replace("\n[[bolt]]", f"\n[joint.form]\n{text}\n\n[[bolt]]", 1)
    other = path.with_name("formed.toml")
    other.write_text(lines)
    return Study.read(other)


def test_shapes_of_the_study_are_on_the_joint(path):
    study = with_form(path, 'crown_along = "14 um"\nflatness = "20 um"\nseed = 4\nalong = [1, 0, 0]')
    form = study.joints[0].form
    assert (form.crown_along, form.flatness, form.seed) == pytest.approx((14e-6, 20e-6, 4))
    flat, formed = (build(s).joints[0].interface for s in (Study.read(path), study))
    assert np.ptp(formed.gap - flat.gap) > 10e-6


def test_faults_are_collected(path):
    with pytest.raises(faying.InputError) as caught:
        with_form(path, 'crown_along = 14\ntwist = "3 kg"\nwaves = "2 um"\nseed = -1')
    text = str(caught.value)
    assert "joint[1].form.crown_along = 14 has no unit" in text
    assert 'joint[1].form.twist = "3 kg" is not in a unit like m' in text
    assert "joint[1].form.waves is not a key that a study has; did you mean wave?" in text
    assert "joint[1].form.seed = -1; it must be a whole number" in text
    with pytest.raises(faying.InputError, match="wave needs its length"):
        with_form(path, 'wave = "2 um"')


def test_maps_count_among_the_files_of_the_study(path):
    (path.parent / "first.csv").write_text("0 0 0\n30 0 1\n0 30 2\n30 30 4\n")
    study = with_form(path, '[joint.form.first]\nfile = "first.csv"\nxy_unit = "mm"\nz_unit = "um"')
    assert path.parent / "first.csv" in study.files
    assert study.joints[0].form.first.heights == pytest.approx([0, 1e-6, 2e-6, 4e-6])


@pytest.mark.parametrize(
    ("text", "Wq"),
    [
        ('Wq = "1.5 um"', 1.5e-6),
        ('Wa = "1.5 um"', 1.5e-6 * np.sqrt(np.pi / 2)),
        ('flatness = "18 um"', 1e-6),
        ('process = "ground"', np.sqrt(0.15e-6 * 0.6e-6) * np.sqrt(np.pi / 2)),
    ],
)
def test_the_size_of_waves_is_said_in_one_way(path, text, Wq):
    study = with_form(path, f'waviness = {{ {text}, hurst = 0.6, shortest = "3 mm", longest = "20 mm", seed = 9 }}')
    waves = study.joints[0].form.waviness
    assert pytest.approx(Wq) == waves.Wq
    assert (waves.hurst, waves.shortest, waves.longest, waves.seed) == pytest.approx((0.6, 3e-3, 20e-3, 9))
    assert PROCESSES["milled"].Wa * GAUSSIAN > Wq or "ground" not in text


def test_faults_of_waves(path):
    with pytest.raises(faying.InputError, match=r'waviness has no size; give one of Wq = "1 um", Wa = "0.8 um", flat'):
        with_form(path, "waviness = { seed = 1 }")
    with pytest.raises(faying.InputError, match=r"waviness has sizes by Wq and process; give one of"):
        with_form(path, 'waviness = { Wq = "1 um", process = "milled" }')
    with pytest.raises(faying.InputError, match=r'waviness.process = "cast" should be one of milled, turned, ground'):
        with_form(path, 'waviness = { process = "cast" }')
    with pytest.raises(faying.InputError, match=r"Wt is not a key that a study has"):
        with_form(path, 'waviness = { Wt = "3 um" }')
    with pytest.raises(faying.InputError, match=r"form: flat = true says that the faces have no form; leave out twist"):
        with_form(path, 'flat = true\ntwist = "1 um"')
    for text, said in (
        ("seed = 3", "form.seed belongs to flatness, which is missing"),
        ('twist = "1 um"\nwave_length = "30 mm"', "form.wave_length belongs to wave, which is missing"),
        ("along = [1, 0, 0]", "form.along turns a shape, and none is given"),
    ):
        with pytest.raises(faying.InputError, match=said):
            with_form(path, text)
    assert with_form(path, "flat = false").joints[0].form is None  # as if it were not there: waves are assumed
    with pytest.raises(faying.InputError, match=r'from = "scan" needs a scan whose D and G can be fitted'):
        build(with_form(path, 'waviness = { from = "scan" }'))  # the surface is given as D and G


def test_waves_lie_on_the_joint_and_a_note_says_which(path):
    plain = build(replace(Study.read(path)))
    structure = build(with_form(path, 'waviness = { Wq = "1 um" }'))
    one, other = (s.joints[0].interface for s in (plain, structure))
    codes = {note.code: note.text for note in structure.mesh.notes}
    assert "rms 1 um on each face (Wq 1 um), draw 0" in codes["waves"]
    assert "the mesh carries waves longer than" in codes["waves-mesh"]
    gap = other.gap - one.gap
    assert gap.min() == pytest.approx(0, abs=1e-15)
    area = one.weights / one.area
    rms = np.sqrt(area @ (gap - area @ gap) ** 2)
    assert 0.5e-6 < rms < 1.42e-6 * 1.6  # of one draw, without what the mesh does not carry
    flat = build(with_form(path, "flat = true"))
    assert np.array_equal(flat.joints[0].interface.gap, one.gap)


def test_waves_of_another_file_of_the_same_study_are_the_same(path):
    texts = ['waviness = { Wq = "1 um", seed = 3 }', 'waviness = { Wq = "2 um", seed = 3 }']
    one, two = (build(with_form(path, text)).joints[0].interface for text in texts)
    flat = build(Study.read(path)).joints[0].interface.gap
    assert two.gap - flat == pytest.approx(2 * (one.gap - flat), abs=1e-15)


@pytest.fixture(scope="module")
def coarse(path):
    # the blocks are 30 mm wide: waves from 8 to 15 mm in place of those above the side of the scan
    return replace(Study.read(path), modes=ModesChoice(count=4, levels=()))


@pytest.fixture(scope="module")
def assumed(coarse):
    return run(coarse)


def test_waves_are_assumed_where_nothing_is_said(coarse, assumed):
    draws, loads, modes = assumed.waves.frequencies.shape
    assert (draws, loads, modes) == (4, 2, 4)
    assert assumed.waves.rms == pytest.approx([ASSUMED.Wq])
    assert assumed.waves.slopes == pytest.approx(
        np.diff(assumed.waves.frequencies, axis=1)[:, 0] / np.diff(assumed.loads), abs=1e-9
    )
    assert len(np.unique(np.round(assumed.waves.frequencies[:, 0, 0], 3))) == 4
    (note,) = [note for note in assumed.notes if note.code == "waves-assumed"]
    assert "the study gives no form of the faces" in note.text
    assert "flat faces" not in " ".join(assumed.warnings)


def are_among(few, many, tolerance):
    """Whether each of some frequencies (load, m) is another one of more (load, n)."""
    apart = np.abs(few[..., None] / many[:, None] - 1)
    return apart.min(axis=-1).max() < tolerance and all(len(set(k)) == len(k) for k in apart.argmin(axis=-1).tolist())


@pytest.mark.slow
def test_a_draw_of_the_band_is_that_of_a_full_run(coarse, assumed):
    """The frequencies with waves from the small basis, against the same waves given as a form."""
    form = Form(waviness=replace(ASSUMED, seed=1))
    more = replace(coarse.modes, count=8)  # the draw follows modes of flat faces, which may be higher ones there
    full = run(replace(coarse, joints=(replace(coarse.joints[0], form=form),), modes=more))
    assert are_among(assumed.waves.frequencies[1], full.frequencies, TOLERANCE)
    # the study has said which draw: the others make its interval
    assert np.array_equal(full.waves.frequencies[1], full.frequencies)
    # from another basis, made to an estimated error of 2e-4
    assert all(are_among(*two, 1e-3) for two in zip(assumed.waves.frequencies, full.waves.frequencies, strict=True))
    assert "waves-assumed" not in [note.code for note in full.notes]


@pytest.mark.parametrize(
    "form", [Form(), pytest.param(Form(crown_along=3e-6), marks=pytest.mark.slow)], ids=["flat", "crowned"]
)
def test_a_form_that_is_given_has_no_waves(coarse, form):
    result = run(replace(coarse, joints=(replace(coarse.joints[0], form=form),)))
    assert result.waves is None
    assert not [note for note in result.notes if note.code.startswith("waves")]


@pytest.mark.slow
def test_one_load_has_a_band_without_slopes(coarse):
    result = run(pulled(coarse, 2e3))
    assert result.waves.slopes is None
    assert result.waves.frequencies.shape == (4, 1, 4)
    assert np.all(np.ptp(result.waves.frequencies[:, 0], axis=0) > 0)


def test_a_wave_that_the_mesh_cannot_follow_is_noted(path):
    """Its points fall anywhere on a wave of 2 mm on elements of 10: k_n moved by half for a tenth of the length."""

    def codes(length):
        study = with_form(path, f'wave = "2 um"\nwave_length = "{length}"')
        return [note.text for note in Case.of(study).notes if note.code == "waves-mesh"]

    (said,) = codes("2 mm")
    assert "do not follow a wave of 2 mm; the mesh carries" in said
    assert not codes("200 mm")
