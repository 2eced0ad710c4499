"""Any TOML in place of any value of a study is read or refused in words."""

import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from faying import FayingError
from faying.study import Study
from tests.fuzz.seeds import STUDY, studies

SCALARS = st.one_of(
    st.booleans(),
    st.integers(-(10**30), 10**30),
    st.floats(allow_nan=True, allow_infinity=True),
    st.text(max_size=12),
    st.dates(),
    st.sampled_from(["1 mm", "-3 kN", "nan N", "1e400 m", "5", "mm", "4,5 kN", "p0.right", "gw", "45 steel", "x.x3p"]),
)
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(st.text(max_size=6), inner, max_size=3)),
    max_leaves=6,
)


def places(value, path=()):
    """The way to every value of a study, tables and lists included."""
    if path:
        yield path
    pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in pairs:
        yield from places(inner, (*path, key))


PLACES = list(places(tomllib.loads(STUDY)))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    where = tmp_path_factory.mktemp("study")
    list(studies(where))
    return where


def outcome(data, folder):
    """ "read", or the text of the refusal; any other exception is a fault."""
    try:
        Study.from_dict(data, folder=folder, where="study.toml")
    except FayingError as fault:
        return str(fault)
    return "read"


@settings(max_examples=300, deadline=None)
@given(st.sampled_from(PLACES), VALUES)
def test_any_value_in_any_place(folder, place, value):
    data = tomllib.loads(STUDY)
    inner = data
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    assert outcome(data, folder) == "read" or len(outcome(data, folder)) > 20


@settings(max_examples=100, deadline=None)
@given(st.sampled_from([p for p in PLACES if isinstance(p[-1], str)]), st.text(min_size=1, max_size=8), VALUES)
def test_any_key_beside_any_key(folder, place, key, value):
    data = tomllib.loads(STUDY)
    inner = data
    for step in place[:-1]:
        inner = inner[step]
    inner[key] = value
    assert outcome(data, folder) == "read" or len(outcome(data, folder)) > 20
