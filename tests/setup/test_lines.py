"""On which line a key stands: against a text whose lines are known, and every key of every example."""

import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from faying.setup.edit import key_of, line_of, lines_of

TEXT = '''# title = "no"
title = """several
lines = 3
[joint]"""

[geometry]
step = "a#b.step" # comment = 1
face_size."upper.joint" = "1 mm"
[geometry.face]
"upper.seat" = { part = "upper",
  normal = "+z" }

[[bolt]]
faces = [
  "a", # faces = "c"
  'b[[bolt]]',
]
preload = "1 kN"
[[bolt.washer]]
outer = "1 mm"
[[bolt.washer]]
outer = "2 mm"

[[bolt]]
name = 'x\\'
  preload = ["1 kN"]
[[bolt.washer]]
outer = "3 mm"
[part . "a b"]
material = "S355"
'''


def test_lines_of_a_text():
    assert lines_of(TEXT) == {
        "title": 2,
        "geometry": 6,
        "geometry.step": 7,
        "geometry.face_size.upper.joint": 8,
        "geometry.face": 9,
        "geometry.face.upper.seat": 10,
        "bolt[1]": 13,
        "bolt[1].faces": 14,
        "bolt[1].preload": 18,
        "bolt[1].washer[1]": 19,
        "bolt[1].washer[1].outer": 20,
        "bolt[1].washer[2]": 21,
        "bolt[1].washer[2].outer": 22,
        "bolt[2]": 24,
        "bolt[2].name": 25,
        "bolt[2].preload": 26,
        "bolt[2].washer[1]": 27,
        "bolt[2].washer[1].outer": 28,
        "part.a b": 29,
        "part.a b.material": 30,
    }


@pytest.mark.parametrize(
    ("key", "line"),
    [
        ("bolt[2].preload", 26),
        ("bolt[2].seat", 24),
        ("bolt[1].faces[2].normal", 14),
        ("geometry.face.upper.seat.normal", 10),
        ("geometry.size", 6),
        ("joint[1].faces", None),
        ("", None),
    ],
)
def test_a_key_that_is_not_there_has_the_line_of_what_holds_it(key, line):
    assert line_of(key, lines_of(TEXT)) == line


def test_a_single_table_is_the_first_of_its_list():
    assert line_of("bolt[1].preload", lines_of('[bolt]\npreload = "1 kN"\n')) == 2


@pytest.mark.parametrize(
    ("fault", "key"),
    [
        ('bolt[2].preload = "x" has no unit', "bolt[2].preload"),
        ("bolt[2].seat is missing", "bolt[2].seat"),
        ("bolt[1].faces[1].part is missing", "bolt[1].faces[1].part"),
        ("[surface] is missing; model", ""),
        ("the bolts have 1 and 2 preloads", ""),
        ("part.a b.material = 3 should be text", "part.a b.material"),
    ],
)
def test_the_key_of_a_fault(fault, key):
    assert key_of(fault, lines_of(TEXT)) == key


EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*/*.toml"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.name)
def test_every_key_of_the_examples_is_found_where_it_is_written(path):
    text = path.read_text()
    lines, found = text.splitlines(), lines_of(text)
    data = tomllib.loads(text)
    for key in data:
        line = line_of(key, found) or line_of(f"{key}[1]", found)
        assert key in lines[line - 1]
    for k, bolt in enumerate(data.get("bolt", []), 1):
        for key in bolt:
            if f"bolt[{k}].{key}" in found:
                assert key in lines[found[f"bolt[{k}].{key}"] - 1]


@given(st.text(alphabet="[]{}\"'=#.,\\ \nabc1", max_size=80))
def test_any_text_ends(text):
    lines_of(text)


@pytest.mark.parametrize("key", ["geometry.face.load[1] force 1", "load[3] force 2", "[", ".", "a b", "]x", "no[such"])
def test_the_line_of_any_key_is_found_or_none(key):
    """A key that is no path is cut at its separators alone: `faying check` went on for ever."""
    assert line_of(key, {"load[1].force[1].face": 7}) in (7, None)
