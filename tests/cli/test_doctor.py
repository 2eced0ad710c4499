"""`faying doctor`: it says what is missing, what that costs and what to do, and fails only where a run would."""

import json

import pytest
from click.testing import CliRunner

import faying
from faying.cli.doctor import LOOKS, command
from faying.numerics import solve


def found(*args):
    done = CliRunner().invoke(command, ["--json", *args])
    return done.exit_code, {row["what"]: row for row in json.loads(done.output)["findings"]}


def test_every_finding_has_a_state_and_a_remedy_where_it_is_not_well():
    code, rows = found()
    assert set(rows) == set(LOOKS)
    assert code == (1 if any(row["state"] == "missing" for row in rows.values()) else 0)
    assert all(bool(row["remedy"]) == (row["state"] != "ok") for row in rows.values())
    assert faying.__version__ in rows["versions"]["found"]
    assert rows["solver"]["found"].startswith(solve.chosen())


def test_the_table_has_the_same():
    text = CliRunner().invoke(command, []).output
    for row in found()[1].values():
        assert row["what"] in text


def test_a_kernel_that_lacks_a_library_fails_with_the_packages(monkeypatch):
    def without():
        raise faying.InputError("the CAD kernel lacks a library of the system (libGL.so.1). Debian: apt install libgl1")

    monkeypatch.setattr("faying.geometry.cad.kernel", without)
    code, rows = found()
    assert code == 1
    assert rows["STEP"]["state"] == "missing"
    assert "apt install libgl1" in rows["STEP"]["remedy"]


@pytest.mark.parametrize(
    ("name", "value", "what", "words"),
    [
        ("FAYING_MEMORY", "24", "memory", "24 GB can be taken (FAYING_MEMORY)"),
        ("FAYING_CACHE", "off", "cache", "off"),
        ("FAYING_CACHE", "/elsewhere", "cache", "/elsewhere"),
    ],
)
def test_the_environment_counts(monkeypatch, name, value, what, words):
    monkeypatch.setenv(name, value)
    assert words in found()[1][what]["found"]


def test_a_slow_solver_is_no_fault(monkeypatch):
    monkeypatch.setattr(solve, "available", lambda: ("superlu",))
    monkeypatch.delenv("FAYING_SOLVER", raising=False)
    code, rows = found()
    assert (code, rows["solver"]["state"]) == (0 if rows["STEP"]["state"] == "ok" else 1, "optional")
    assert "--extra pardiso" in rows["solver"]["remedy"]
