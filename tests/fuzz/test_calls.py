"""Wrong calls of every public name: an error of Faying says what is wrong. New names come in by themselves.

Names of the rooms in ELSEWHERE have tests of their own, with valid arguments about the wrong one.
"""

import inspect
from pathlib import Path

import numpy as np
import pytest

import faying

ELSEWHERE = ("surface", "contact", "halfspace", "materials", "distribution", "errors")
JUNK = {
    "None": None,
    "True": True,
    "negative": -1.0,
    "NaN": float("nan"),
    "number": 7,
    "text": "junk",
    "empty text": "",
    "wrong unit": "8 kg/s",
    "bytes": b"x",
    "object": object(),
    "list": [],
    "nested": [["a", 1], None],
    "mapping": {},
    "array": np.full((2, 3), np.nan),
    "array of no dimension": np.array(1.0),
    "path": Path("absent.file"),
    "complex": 1j,
    "complex array": np.array([1j, 2.0]),
    "array of text": np.array(["a"]),
    "text of no dimension": np.array("a"),
    "long name": "x" * 300,
    "zero byte": "a\0b",
}


def public():
    """The public classes and functions by name, but for those that have tests elsewhere."""
    for name in sorted(faying.__all__):
        one = getattr(faying, name)
        room = getattr(one, "__module__", "").split(".")
        if callable(one) and room[0] == "faying" and room[1] not in ELSEWHERE:
            yield name, one


NAMES = dict(public())


def refused(call, *args, **kwargs):
    """Whether a call was refused in words; any error that is not Faying's comes through."""
    try:
        call(*args, **kwargs)
    except faying.FayingError as fault:
        return len(str(fault)) > 10
    return False


def parameters(one):
    return [
        p
        for p in inspect.signature(one).parameters.values()
        if p.kind not in (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    ]


def test_all_public_names_are_asked():
    assert len(NAMES) > 30


@pytest.mark.parametrize("name", NAMES)
def test_missing_and_unknown_arguments(name):
    one = NAMES[name]
    needed = [p.name for p in parameters(one) if p.default is inspect.Parameter.empty]
    if needed:
        with pytest.raises(faying.FayingError, match=needed[0]):
            one()
    with pytest.raises(faying.FayingError, match="no_such_argument"):
        one(**dict.fromkeys(needed), no_such_argument=1)


@pytest.mark.parametrize("name", NAMES)
def test_junk_in_place_of_all_needed_arguments(name):
    one = NAMES[name]
    needed = [p for p in parameters(one) if p.default is inspect.Parameter.empty]
    for junk in JUNK.values():
        refused(one, **{p.name: junk for p in needed})


@pytest.mark.parametrize("name", NAMES)
def test_junk_in_place_of_one_argument(name, tmp_path, monkeypatch):
    """The others are what their type says, as far as a sample of it is at hand."""
    monkeypatch.chdir(tmp_path)
    one = NAMES[name]
    every = parameters(one)
    valid = {p.name: sample(p) for p in every if p.default is inspect.Parameter.empty}
    for p in every:
        for junk in JUNK.values():
            refused(one, **{**valid, p.name: junk})


def sample(parameter):
    """A value of the type of a parameter."""
    text = str(parameter.annotation)
    for word, value in (
        ("tuple[str, str]", ("low.top", "high.bottom")),
        ("Sequence", ()),
        ("str", "name"),
        ("Path", "absent.toml"),
        ("float", 1.0),
        ("int", 1),
        ("ndarray", np.ones((3, 3))),
        ("Mapping", {}),
    ):
        if word in text:
            return value
    return None


def test_methods_of_a_structure_and_a_state(tmp_path, monkeypatch):
    """Every public method of what can be made quickly, with junk for each argument."""
    from tests.helpers.plates import LAW, stacked
    from tests.helpers.scenes import two_boxes

    monkeypatch.chdir(tmp_path)
    joint = faying.Joint(("low.top", "high.bottom"), LAW)
    bolt = faying.Bolt("b", ("high.top", "low.bottom"))
    structure = faying.Structure(stacked(), "45 steel", [joint], [bolt])
    state = structure.solve("5 kN", modes=2)
    result = two_boxes()
    calls = {
        "solve": (structure.solve, ("preload", "modes", "damping", "order", "solver")),
        "structure.plot": (structure.plot, ("ax",)),
        "mesh.plot": (structure.mesh.plot, ("ax",)),
        "plot_pressure": (state.plot_pressure, ("joint", "ax")),
        "modes.plot": (state.modes.plot, ("mode", "ax")),
        "result.plot": (result.plot, ("modes", "ax")),
        "result.save": (result.save, ("path",)),
        "to_dataframe": (result.to_dataframe, ("group",)),
        "load": (faying.load, ("path",)),
        "modes_at": (result.modes_at, ("load",)),
    }
    given = {"solve": {"preload": "5 kN", "modes": 2}}
    for name, (call, keys) in calls.items():
        for key in keys:
            for junk in JUNK.values():
                if junk is not None:  # the default of many
                    refused(call, **{**given.get(name, {}), key: junk})
    import matplotlib.pyplot

    matplotlib.pyplot.close("all")
