"""Everything that is counted has a greatest number, refused with a message before time and memory are taken."""

import json
import tomllib
from importlib import import_module

import click
import numpy as np
import pytest

import faying
from faying.cli.main import COMMANDS, main
from faying.contact.build import laws
from faying.fe.response import frequency_response
from faying.form.form import PARAMETERS
from faying.numerics.memory import check_modes
from faying.study import Study
from faying.study.schema import schema_text
from tests.helpers.meshfiles import STUDY

SCHEMA = json.loads(schema_text())
POINT = {"point": ["0 mm", "0 mm", "0 mm"], "direction": [0, 0, 1]}
RESPONSE = {"from": "1 Hz", "to": "2 Hz", "input": [POINT], "output": [POINT]}
HUGE = 10**9


def integers(part, path=""):
    """Every place of the schema that takes a whole number."""
    if isinstance(part, dict):
        if part.get("type") == "integer":
            yield path, part
        for key, inner in part.items():
            yield from integers(inner, f"{path}.{key}")
    elif isinstance(part, list):
        for k, inner in enumerate(part):
            yield from integers(inner, f"{path}[{k}]")


def test_every_whole_number_of_a_study_has_a_greatest():
    found = dict(integers(SCHEMA))
    assert len(found) >= 6
    assert [path for path, part in found.items() if not part["minimum"] <= part.get("maximum", np.inf) <= 1e15] == []


def test_every_whole_number_of_a_law_or_a_form_has_a_greatest():
    tables = [law.parameters for law in laws().values()] + [PARAMETERS]
    whole = [(name, p) for table in tables for name, p in table.items() if p.whole]
    assert {"points", "corrected", "seed"} <= {name for name, _ in whole}
    assert [name for name, p in whole if not p.greatest <= 1e15] == []


@pytest.mark.parametrize(
    ("table", "key"),
    [
        ({"modes": {"count": HUGE}}, "modes.count"),
        ({"response": RESPONSE | {"points": HUGE}}, "response.points"),
        ({"tightening": {"order": ["bolt 1"], "passes": HUGE}}, "tightening.passes"),
        ({"backbone": {"mode": HUGE}}, "backbone.mode"),
        ({"backbone": {"harmonics": HUGE}}, "backbone.harmonics"),
        ({"geometry": {"face": {"f": {"part": "p0", "number": HUGE}}}}, "geometry.face.f.number"),
    ],
)
@pytest.mark.parametrize("value", [HUGE, 10**400, -1, 0, 2.0, True])
def test_a_count_out_of_range_is_refused_by_the_reader(tmp_path, table, key, value):
    (tmp_path / "model.inp").write_text("*NODE\n")
    text = json.dumps(table).replace(str(HUGE), "1" + "0" * 400 if value == 10**400 else json.dumps(value))
    data = tomllib.loads(STUDY)
    for name, inner in json.loads(text).items():
        data[name] = data.get(name, {}) | inner
    with pytest.raises(faying.InputError, match=rf"{key} = .* should be a whole number from 1 to "):
        Study.from_dict(data, folder=tmp_path)


def options():
    for name, (module, _) in COMMANDS.items():
        command = import_module(f"faying.cli.{module}").command
        for one in command.params:
            if isinstance(one.type, click.types.IntParamType) and not one.count:
                yield name, one


def test_every_whole_number_of_a_command_has_both_ends():
    found = list(options())
    assert len(found) >= 15
    ends = [(name, one.name, getattr(one.type, "min", None), getattr(one.type, "max", None)) for name, one in found]
    assert [end for end in ends if None in end] == []


@pytest.mark.parametrize(
    "command",
    [
        ["modes", "x.toml", "--count", "1000000000"],
        ["sweep", "x.toml", "--jobs", "1000000000"],
        ["predict", "x.toml", "--samples", "1000000000"],
        ["identify", "x.toml", "--count", "1000000000"],
        ["backbone", "x.toml", "--harmonics", "1000000000"],
        [
            "law",
            "--model",
            "jk",
            "--D",
            "2.4",
            "--G",
            "1 nm",
            "--material",
            "45 steel",
            "--scan-area",
            "1 mm^2",
            "--pressure",
            "1 MPa:2 MPa:1000000000",
        ],
        ["sweep", "x.toml", "--set", "surface.D=2.1:2.9:1000000000"],
    ],
)
def test_a_huge_count_on_the_command_line_is_refused_at_once(command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x.toml").write_text("title = 1\n")
    with pytest.raises(SystemExit) as stop:
        main(command)
    assert stop.value.code in (1, 2)
    said = capsys.readouterr().err
    assert "1000000000" in said
    assert "Traceback" not in said


def test_what_fits_no_memory_is_refused_before_it_is_taken(monkeypatch):
    monkeypatch.setenv("FAYING_MEMORY", "0.01")
    with pytest.raises(
        faying.InputError, match="1,000 modes of 30,000 unknowns need about .* GB .*ask for fewer modes"
    ):
        check_modes(1000, 30_000)
    check_modes(10, 3000)
    few = np.zeros((3, 1))
    modes = type("Modes", (), {"shapes": few})
    with pytest.raises(
        faying.InputError, match="responses at 1,000,000 frequencies, 1 outputs and 1 inputs need about"
    ):
        frequency_response(None, modes, modes, forces=few, outputs=few, frequencies=np.linspace(1.0, 2.0, 1_000_000))
