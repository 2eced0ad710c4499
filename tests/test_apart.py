"""Calls in a process of their own: answers, faults, death and time."""

import os
import time
from pathlib import Path

import numpy as np
import pytest

import faying
from faying.apart import Died, apart
from faying.geometry.cad import ask_kernel

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(autouse=True)
def _importable(monkeypatch):
    """The tasks of this file are imported by name in the other process."""
    monkeypatch.syspath_prepend(ROOT)


def doubled(values):
    return os.getpid(), 2 * np.array(values)


def refused(kind):
    raise {"read": faying.ReadError, "input": faying.InputError}[kind](f"no {kind}")


def dead(*_):
    os.abort()


def test_an_answer_comes_from_another_process():
    process, twice = apart(None, doubled, [1.0, 2.5])
    assert process != os.getpid()
    assert twice == pytest.approx([2.0, 5.0])


@pytest.mark.parametrize(("kind", "fault"), [("read", faying.ReadError), ("input", faying.InputError)])
def test_faults_of_the_task_are_raised_here(kind, fault):
    with pytest.raises(fault, match=f"^no {kind}$") as raised:
        apart(None, refused, kind)
    assert raised.type is fault


def test_what_takes_too_long_is_ended():
    with pytest.raises(Died, match="no end within 0 s"):
        apart(0.05, time.sleep, 60.0)


def test_the_death_of_the_kernel_is_a_fault_of_the_file():
    with pytest.raises(faying.ReadError, match=r"a\.step: the CAD kernel died on it \(signal 6\)"):
        ask_kernel(Path("a.step"), dead)
