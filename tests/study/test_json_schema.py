"""The JSON schema of a study: as the readers are, right for every example, and against wrong types and keys."""

import copy
import json
import tomllib
from pathlib import Path

import pytest

from faying.cli.main import main
from faying.setup import template
from faying.study.schema import schema_text
from tests.geometry.test_face_facts import box, written

jsonschema = pytest.importorskip("jsonschema", reason="the group dev has it")
ROOT = Path(__file__).parents[2]
SCHEMA = json.loads(schema_text())
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)
EXAMPLES = sorted((ROOT / "examples").glob("*/*.toml"))


def accepts(data):
    return VALIDATOR.is_valid(data)


def base():
    return tomllib.loads(template.TEXT.format(name="s.toml", step="s.step", scan="s.x3p"))


def test_it_is_a_schema():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_it_accepts_every_example(path):
    errors = [error.message[:200] for error in VALIDATOR.iter_errors(tomllib.loads(path.read_text()))]
    assert not errors


def test_it_accepts_what_init_and_new_write(tmp_path):
    from faying.setup import new

    assert accepts(base())
    step = written(tmp_path / "two.step", box((0, 0, 0), (40, 20, 10), "a"), box((0, 0, 10), (40, 20, 20), "b"))
    text, _ = new.study_text(new.find(step), step, tmp_path / "s.toml", new.Answers())
    data = tomllib.loads(text) | {"bolt": base()["bolt"]}
    assert accepts(data)
    for first in (text, template.TEXT):
        assert first.startswith("#:schema ./faying.schema.json\n")


@pytest.mark.parametrize(
    "change",
    [
        {"title": "other"},
        {"bolt": {"faces": ["a", "b"], "preload": "1 kN"}},
        {"joint": [{"faces": [{"part": "a", "normal": "+z"}, {"part": "b", "normal": [0, 0, 1], "all": True}]}]},
        {"support": [{"face": {"part": "a", "number": 3}, "directions": ["x"]}]},
        {"material": {"m": {"E": "200 GPa +- 4 GPa", "nu": 0.3, "density": "7800 kg/m^3"}}},
        {"surface": {"D": 2.4, "G": "1e-10 m", "scan_area": "1 mm^2"}},
        {"law": {"model": "jk", "cutoff": 0.01, "loss": "held"}},
        {"law": {"model": "persson", "corrected": True}},
        {"backbone": {"friction": [0.1, 0.2], "rest_damping": "law", "amplitude": ["0.1 m/s^2", "60 m/s^2"]}},
        {"geometry": {"mesh": "m.inp", "unit": "mm", "sets": {"upper": "E1"}, "snap": "10 um"}},
    ],
)
def test_it_accepts_other_ways(change):
    assert accepts(base() | change)


@pytest.mark.parametrize(
    "change",
    [
        {"titel": "x"},
        {"title": 3},
        {"bolt": [{"faces": ["a", "b"], "preload": 12}]},
        {"bolt": [{"faces": ["a"], "preload": "1 kN"}]},
        {"bolt": [{"faces": ["a", "b"], "preload": "1 kN", "diametre": "8 mm"}]},
        {"joint": [{"faces": ["a", {"part": "b", "normal": "up"}]}]},
        {"joint": [{"faces": ["a", {"normal": "+z"}]}]},
        {"joint": [{"faces": ["a", "b"], "springs": "per-face"}]},
        {"joint": [{"name": "no faces"}]},
        {"material": {"m": {"E": 200e9, "nu": 0.3, "density": "7800 kg/m^3"}}},
        {"material": {"m": {"nu": 0.3, "density": "7800 kg/m^3"}}},
        {"modes": {"count": 0}},
        {"modes": {"count": 2.5}},
        {"modes": {"solver": "magic"}},
        {"support": [{"face": "a", "directions": ["w"]}]},
        {"geometry": {"step": "a.step", "size": 5}},
        {"geometry": {"step": "a.step", "size": "5 mm", "face_at": {}}},
        {"response": {"from": "5 kHz", "to": "1", "points": 4, "input": [], "output": []}},
    ],
)
def test_it_refuses_wrong_types_and_keys(change):
    assert not accepts(copy.deepcopy(base()) | change)


def test_every_key_has_its_words():
    """Keys of the first two levels say what they are, for the editor to show."""
    for name, table in SCHEMA["properties"].items():
        several = [one["properties"] for one in table.get("anyOf", []) if "properties" in one]
        inner = table.get("properties") or (several[0] if several else {})
        for key, what in inner.items():
            if "properties" not in what and "anyOf" not in what:
                assert what.get("description"), f"{name}.{key}"


def test_the_command_prints_or_writes_it(tmp_path, capsys):
    with pytest.raises(SystemExit) as stop:
        main(["schema"])
    assert stop.value.code == 0
    assert json.loads(capsys.readouterr().out) == SCHEMA
    with pytest.raises(SystemExit):
        main(["schema", "--out", str(tmp_path / "faying.schema.json")])
    assert json.loads((tmp_path / "faying.schema.json").read_text()) == SCHEMA
    with pytest.raises(SystemExit) as stop:
        main(["schema", "--out", str(tmp_path / "x"), "--json"])
    assert stop.value.code == 1


def described(part, path=""):
    """Every key of the schema that has a default or examples, through tables and lists."""
    if isinstance(part, dict):
        if "description" in part and {"default", "examples"} & set(part):
            yield path, part
        for key, inner in part.items():
            yield from described(inner, f"{path}.{key}")
    elif isinstance(part, list):
        for k, inner in enumerate(part):
            yield from described(inner, f"{path}[{k}]")


def test_defaults_and_examples_are_what_a_study_may_say():
    found = dict(described(SCHEMA))
    assert len([path for path, part in found.items() if "default" in part]) > 40
    for path, part in found.items():
        one = jsonschema.Draft202012Validator(part | {"$defs": SCHEMA["$defs"]})
        for value in [*([part["default"]] if "default" in part else []), *part.get("examples", [])]:
            assert one.is_valid(value), (path, value)


def test_the_keys_of_laws_say_whose_they_are():
    keys = SCHEMA["properties"]["law"]["properties"]
    assert {"auto", "jk", "gw-ke"} <= set(keys["model"]["examples"])
    owners = {name: one["x-laws"] for name, one in keys.items() if "x-laws" in one}
    assert owners["closure"] == ["jk"]
    assert set(keys) - set(owners) == {"model", "counterbody"}
    assert {law for laws in owners.values() for law in laws} <= set(keys["model"]["examples"])
