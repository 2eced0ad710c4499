"""Questions to the CAD kernel in a process of its own: answers, faults and its death."""

import os
from pathlib import Path

import numpy as np
import pytest

import faying
from faying.geometry.cad_process import Answer, ask

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def _importable(monkeypatch):
    """The tasks of this file are imported by name in the other process."""
    monkeypatch.syspath_prepend(ROOT)


def doubled(request):
    return Answer(facts={"pid": os.getpid()}, arrays={"twice": 2 * np.array(request["values"])})


def refused(request):
    raise {"read": faying.ReadError, "input": faying.InputError}[request["kind"]](f"no {request['kind']}")


def dead(request):
    os.abort()


def test_an_answer_comes_from_another_process():
    found = ask(doubled, {"values": [1.0, 2.5]}, path=Path("a.step"))
    assert found.facts["pid"] != os.getpid()
    assert found.arrays["twice"] == pytest.approx([2.0, 5.0])


@pytest.mark.parametrize(("kind", "fault"), [("read", faying.ReadError), ("input", faying.InputError)])
def test_faults_of_the_task_are_raised_here(kind, fault):
    with pytest.raises(fault, match=f"^no {kind}$") as raised:
        ask(refused, {"kind": kind}, path=Path("a.step"))
    assert raised.type is fault


def test_the_death_of_the_kernel_is_a_fault_of_the_file():
    with pytest.raises(faying.ReadError, match=r"a\.step: the CAD kernel died on it \(signal 6\)"):
        ask(dead, {}, path=Path("a.step"))
