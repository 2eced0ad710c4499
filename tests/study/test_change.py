"""A study with one thing changed is the study of a file that says so."""

from dataclasses import fields

import numpy as np
import pytest

import faying
from faying.study import Study
from tests.helpers.studies import write


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    path = tmp_path_factory.mktemp("change") / "study.toml"
    write(path)
    return Study.read(path)


def alike(one, other):
    own = ("text", "data", "files")
    return all(getattr(one, f.name) == getattr(other, f.name) for f in fields(Study) if f.name not in own)


@pytest.mark.parametrize(
    ("path", "value", "old", "new"),
    [
        ("geometry.size", "9 mm", 'size = "16 mm"', 'size = "9 mm"'),
        ("geometry.size", 9e-3, 'size = "16 mm"', 'size = "0.009 m"'),
        ("bolt.preload", ["1 kN", "3 kN"], 'preload = ["2 kN", "6 kN"]', 'preload = ["1 kN", "3 kN"]'),
        ("bolt.bolt.preload", [1e3, np.float64(3e3)], 'preload = ["2 kN", "6 kN"]', 'preload = ["1 kN", "3 kN"]'),
        ("law.cutoff", 0.02, "cutoff = 0.01", "cutoff = 0.02"),
        ("joint.joint.form.twist", 2e-6, "flat = true", 'flat = true\ntwist = "2 um"'),
        ("modes.count", 4, "[modes]", "[modes]"),
        ("part.upper.material", "S355", '[part.upper]\nmaterial = "45 steel"', '[part.upper]\nmaterial = "S355"'),
        ("title", "another", 'title = "Two blocks and a bolt"', 'title = "another"'),
    ],
)
def test_it_is_the_study_of_the_file_that_says_so(study, path, value, old, new):
    text = study.text.replace(old, new, 1)
    assert (text == study.text) == (old == new)
    if path == "modes.count":
        text = "\n".join("count = 4" if line.startswith("count =") else line for line in text.splitlines())
    if path.endswith("twist"):  # flat stands alone: both refuse it
        with pytest.raises(faying.InputError, match="flat = true says that the faces have no form"):
            study.with_(path, value)
        study = study.with_("joint.form.flat", None)
        text = text.replace("flat = true\n", "", 1)
    file = study.folder / "study.toml"
    before = file.read_text()
    try:
        file.write_text(text)
        typed = Study.read(file)
    finally:
        file.write_text(before)
    made = study.with_(path, value)
    assert alike(made, typed)
    assert not alike(made, study)
    assert f"# changed in Python: {path} = " in made.text


def test_changes_add_up_and_leave_the_study_alone(study):
    both = study.with_("joint.friction", 0.3).with_("modes.levels", [2.0])
    assert (both.joints[0].friction, both.modes.levels) == (0.3, (2.0,))
    assert both.text.count("# changed in Python") == 2
    assert study.joints[0].friction is None
    assert both.with_("joint.friction", None).joints[0].friction is None


def test_a_whole_table_is_changed(study):
    other = study.with_("law", {"model": "jk", "cutoff": 0.05})
    assert (other.law.model, dict(other.law.given)) == ("JK", {"cutoff": 0.05})


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        ("geometry.sise", "9 mm", "'sise'; did you mean size?"),
        ("nothing.at.all", 1, "is not a key of a study: 'nothing'; give one of title, material"),
        ("bolt.left.preload", "1 kN", "no bolt is called 'left'; give one of bolt"),
        ("joint.stiffness", 0.5, "sweeps and .uncertain. vary it"),
        ("bolt.prelod", "1 kN", "give one of bolt; did you mean preload"),
        ("bolt.bolt", "1 kN", "is a bolt, not a key; add one of its keys: name, faces"),
        ("support.face", "upper.end", r"the study has no \[\[support\]\]"),
        ("title.of.it", "x", "title has no other keys; leave out of.it"),
        ("not a path", 1, "should be keys with dots"),
        ("a = 1\nb", 1, "should be keys with dots"),
        ("modes.count", "many", "modes.count = 'many' should be a whole number from 1 to"),
        ("bolt.preload", "9 mm", "is not in a unit like N"),
        ("law.cutoff", 7.0, "law.cutoff = 7; it must be"),
        (3, 1, "path = 3; give text"),
    ],
)
def test_what_cannot_be_changed_is_said(study, path, value, says):
    with pytest.raises(faying.InputError, match=says):
        study.with_(path, value)
