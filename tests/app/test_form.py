"""The form of a study: what its fields show, and that a change in one is a change of one key in the text."""

import json
import time
import tomllib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from faying.app.form import added, changed, form_of, removed
from faying.errors import InputError
from faying.setup.edit import written
from faying.setup.template import TEXT
from faying.study import Study
from faying.study.declaration.reader import StudyFaults
from faying.study.keys.tables import STUDY as STUDY_KEYS
from tests.app.test_server import ask
from tests.setup.test_edit import leaves

STUDY = TEXT.format(name="study.toml", step="two-blocks.step", scan="surface.x3p")
EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*/*.toml"))
TEXTS = [STUDY, *(path.read_text() for path in EXAMPLES)]


def fields(text, **files):
    return {one["name"]: one for group in form_of(text, files) for one in group["fields"]}


def groups(text):
    return {group["name"]: group for group in form_of(text, {})}


@pytest.mark.parametrize("text", TEXTS, ids=["template", *(path.stem for path in EXAMPLES)])
def test_every_key_of_an_example_is_in_its_form_and_writes_itself(text):
    """What a field shows, written back into a text without it, gives the study as it was."""
    data = tomllib.loads(text)
    shown = {tuple(one["path"]): one for one in fields(text).values() if one["value"] is not None}
    for path in leaves(data):
        held = next((path[:n] for n in range(len(path), 0, -1) if path[:n] in shown), None)
        assert held is not None, path
    for path, one in shown.items():
        assert changed(text, path, one["value"]) == text
        other = changed(text, path, "0.123" if one["value"] != "0.123" else "0.124")
        assert tomllib.loads(changed(other, path, one["value"])) == data, one["name"]


@pytest.mark.parametrize(
    ("path", "value", "read"),
    [
        (("bolt", 0, "preload"), "5 kN", "5 kN"),
        (("bolt", 0, "preload"), "5 kN, 6 kN", ["5 kN", "6 kN"]),
        (("bolt", 0, "at"), "0 mm, 1 mm, 2 mm", ["0 mm", "1 mm", "2 mm"]),
        (("modes", "count"), "7", 7),
        (("modes", "count"), "many", "many"),
        (("modes", "intervals"), "false", False),
        (("surface", "D"), "2.4", 2.4),
        (("surface", "D"), "2.4 +- 0.1", "2.4 +- 0.1"),
        (("joint", 0, "tangential"), "mindlin", "mindlin"),
        (("joint", 0, "tangential"), "0.4", 0.4),
        (("joint", 0, "faces"), "a, b", ["a", "b"]),
        (("joint", 0, "faces"), '["a", {part = "p", number = 3}]', ["a", {"part": "p", "number": 3}]),
        (("title",), "3", "3"),
        (("title",), "[x]", "[x]"),
        (("uncertain", "joint.friction"), "0.1 to 0.6", "0.1 to 0.6"),
        (("uncertain", "surface.fit"), "true", True),
        (("uncertain", "preload"), '{scatter = "25 %"}', {"scatter": "25 %"}),
        (("geometry", "face_size", "upper.seat"), "2 mm", "2 mm"),
        (("material", "mine", "nu"), "0.3", 0.3),
        (("joint", 0, "form", "crown_along"), "3 um", "3 um"),
    ],
)
def test_what_is_written_in_a_field_becomes(path, value, read):
    at = tomllib.loads(changed(STUDY, path, value))
    for one in path:
        at = at[one]
    assert at == read
    assert type(at) is type(read)


def test_a_form_offers_the_keys_of_its_law_and_no_other():
    jk = changed(STUDY, ("law", "model"), "jk")
    assert {"law.closure", "law.loss", "law.cutoff"} <= set(fields(jk))
    assert not {"law.closure", "law.loss"} & set(fields(STUDY))
    assert fields(jk)["law.closure"]["choices"] == ["consistent", "printed"]
    assert "law.D" not in fields(jk)  # stands under [surface]


def test_a_form_offers_files_materials_and_faces():
    found = fields(STUDY + '\n[material."my steel"]\nE = "210 GPa"\n', geometry=["b.step"], scan=["s.x3p"])
    assert found["geometry.step"]["suggestions"] == ["b.step"]
    assert found["surface.counter"]["suggestions"] == ["same", "smooth", "s.x3p"]
    assert {"45 steel", "my steel"} <= set(found["part.upper.material"]["suggestions"])
    support = fields(added(STUDY, ("support", 0)))["support[1].face"]
    assert "lower.joint" in support["suggestions"]
    assert support["needed"]
    scatter = groups(STUDY)["uncertain"]["additions"][0]["suggestions"]
    assert {"friction", "preload", "part.upper.stiffness", "joint.joint.friction"} <= set(scatter)


def test_what_is_offered_to_scatter_can(tmp_path):
    """Each key that the form proposes is taken by the reader, or refused for its value, never for its name."""
    scatter = groups(STUDY)["uncertain"]["additions"][0]["suggestions"]
    for name in scatter:
        with pytest.raises(StudyFaults) as faults:
            Study.from_dict(tomllib.loads(changed(STUDY, ("uncertain", name), "x")), folder=tmp_path)
        assert "cannot scatter" not in str(faults.value), name


def test_names_are_those_of_the_messages(tmp_path):
    """A fault begins with the name of its field, so that it shows there."""
    text = changed(STUDY, ("bolt", 0, "preload"), "6000").replace("[[joint]]", "[joint]")
    text = changed(changed(text, ("joint", "friction"), "-3"), ("modes", "count"), "0")
    with pytest.raises(StudyFaults) as faults:
        Study.from_dict(tomllib.loads(text), folder=tmp_path)
    for name in ("bolt[1].preload", "joint[1].friction", "modes.count"):
        assert name in fields(text)
        assert any(line.startswith(name) for line in faults.value.lines), name


def test_tables_are_added_and_removed():
    text = added(STUDY, ("bolt", 1))
    assert tomllib.loads(text)["bolt"][1] == {}
    assert removed(text, ("bolt", 1)).replace("\n", "") == STUDY.replace("\n", "")
    assert tomllib.loads(added(STUDY, ("joint", 0, "form")))["joint"][0]["form"] == {}
    assert tomllib.loads(added(STUDY, ("material", "a b")))["material"] == {"a b": {}}


@pytest.mark.parametrize(
    ("work", "said"),
    [
        (lambda: changed(STUDY, ("modes", "cuont"), "3"), "modes.cuont is not a key"),
        (lambda: changed(STUDY, ("bolt",), "3"), "bolt is not a key"),
        (lambda: added(STUDY, ("modes",)), "is there already"),
        (lambda: added(STUDY, ("nothing",)), "nothing is not a table"),
        (lambda: added(STUDY, ("bolt", 5)), r"bolt\[6\] has no place"),
        (lambda: changed(STUDY, ("joint", 0, "faces"), "[a"), "not a list or table as TOML"),
        (lambda: form_of("a = ", {}), "not TOML"),
    ],
)
def test_what_cannot_be_done_is_said(work, said):
    with pytest.raises(InputError, match=said):
        work()


def test_emptied_fields_are_taken_out():
    assert "count" not in tomllib.loads(changed(STUDY, ("modes", "count"), ""))["modes"]
    assert changed(STUDY, ("modes", "solver"), " ") == STUDY


def test_the_server_gives_the_form_and_changes_a_text(server, tmp_path):
    _, found = ask(server, "api/read", "POST", json.dumps({"text": STUDY}).encode())
    assert [group["name"] for group in json.loads(found)["form"]][:2] == ["", "geometry"]
    _, found = ask(server, "api/read", "POST", json.dumps({"text": "a = "}).encode())
    assert json.loads(found)["form"] is None
    body = {"text": STUDY, "path": ["modes", "count"], "value": "3"}
    _, found = ask(server, "api/edit", "POST", json.dumps(body).encode())
    assert json.loads(found)["text"] == STUDY.replace("count = 6 ", "count = 3 ")
    assert list(tmp_path.iterdir()) == []  # nothing is saved
    for wrong in ({"path": []}, {"path": [1.5]}, {"value": 3}, {"text": None}):
        assert "fault" in json.loads(ask(server, "api/edit", "POST", json.dumps(body | wrong).encode())[1])


ODD = st.recursive(
    st.one_of(st.integers(0, 9), st.booleans(), st.sampled_from(["jk", "a", "", "1 kN", "a.b"])),
    lambda inner: st.one_of(
        st.lists(inner, max_size=2),
        st.dictionaries(
            st.sampled_from(["name", "model", "faces", "law", "face", "washer", "x", "part"]), inner, max_size=3
        ),
    ),
    max_leaves=5,
)


@given(st.dictionaries(st.sampled_from(sorted(STUDY_KEYS)), ODD, max_size=4), st.data())
@settings(max_examples=50, deadline=None)
def test_whatever_a_text_says_has_a_form(data, more):
    """Tables where keys should be, and keys where tables should be: half of what is typed is on its way."""
    text = "".join(f"{name} = {written(value)}\n" for name, value in data.items())
    found = [one for group in form_of(text, {}) for one in group["fields"]]
    one = more.draw(st.sampled_from(found))
    try:
        changed(text, tuple(one["path"]), "0.5")
    except InputError:
        return


def test_a_form_is_quick():
    """It is made after every pause in typing."""
    form_of(STUDY, {})
    start = time.perf_counter()
    for _ in range(5):
        form_of(STUDY, {})
    assert (time.perf_counter() - start) / 5 < 0.5
