"""The form of faces as an input of a study."""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.joint.form import Form
from faying.study import Study, build, run
from faying.study.keys.solution import ModesChoice
from tests.helpers.studies import write


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("form") / "study.toml"
    write(path)
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


def test_the_old_table_says_its_new_name(path):
    text = path.read_text().replace("\n[[bolt]]", '\n[joint.gap]\nfile = "a.csv"\n\n[[bolt]]', 1)
    path.with_name("old.toml").write_text(text)
    with pytest.raises(faying.InputError, match=r"joint\[1\]\.gap has become joint\[1\]\.form\.gap"):
        Study.read(path.with_name("old.toml"))


@pytest.mark.slow
def test_the_band_of_small_crowns_is_that_of_full_runs(path):
    """d f/d preload with faces crowned by 3 um from the small basis, beside the same as a form given."""
    study = Study.read(path)
    sizes = {name: 1.6 * size for name, size in study.geometry.face_size.items()}
    geometry = replace(study.geometry, size=1.6 * study.geometry.size, face_size=sizes)
    study = replace(study, geometry=geometry, modes=ModesChoice(count=4))
    result = run(study)
    assert result.form_crowns == pytest.approx([-3e-6, 0, 3e-6])
    flat = np.diff(result.frequencies, axis=0)[0] / np.diff(result.loads)
    assert result.form_slopes[1] == pytest.approx(flat)
    crowned = replace(study.joints[0], form=Form(crown_along=3e-6))
    full = run(replace(study, joints=(crowned,)))
    assert full.form_slopes is None  # a form is given: nothing is assumed
    # an error of 1e-5 in a frequency near 30 kHz over 4 kN
    found = np.diff(full.frequencies, axis=0)[0] / np.diff(full.loads)
    assert result.form_slopes[2] == pytest.approx(found, abs=1e-5 * 3e4 / 4e3)
    assert run(replace(study, bolts=(replace(study.bolts[0], preload=(2e3,)),))).form_slopes is None
