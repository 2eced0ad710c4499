"""Notes: what they mean for a result, and how many of a kind are said as one."""

import re
from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import pytest

import faying
from faying.notes import Note, by_severity, grave, grouped, percent

SOURCE = Path(faying.__file__).parent


def outside(load, share, joint="flange", why="fewer than 10 spots touch"):
    where = f"outside its validity range for {percent(share)} of the joint's stiffness"
    text = f"{joint}, {load:g} kN: the law is {where}: {why}"
    return Note(code="outside-validity", severity="limit", joint=joint, load=1e3 * load, share=share, text=text)


def test_loads_and_shares_become_spans():
    (one,) = grouped([outside(4, 0.16), outside(8, 0.16), outside(12, 0.18)])
    assert one.text == (
        "flange, 4 to 12 kN: the law is outside its validity range for 16 to 18% of the joint's stiffness: "
        "fewer than 10 spots touch"
    )
    assert one.load is None


def test_what_differs_in_words_stays_apart():
    notes = [outside(4, 0.2), outside(4, 0.4, why="another reason"), outside(8, 0.2)]
    assert [note.text[:16] for note in grouped(notes)] == ["flange, 4 to 8 k", "flange, 4 kN: th"]
    assert grouped(notes)[1] == notes[1]


def test_many_joints_are_named_in_one_note():
    both = [outside(load, 0.1 * load, joint=joint) for joint in ("flange 1", "lap") for load in (2, 4)]
    (one,) = grouped(both)
    assert one.text.startswith("flange 1 and lap, 2 to 4 kN: the law is outside its validity range for 20 to 40%")
    assert (one.joint, one.share) == ("", 0.4)
    silent = [Note(code="no-loss", joint=f"joint {k}", text=f"joint {k}: no damping at rest") for k in range(1, 7)]
    assert [note.text for note in grouped(silent)] == ["joint 1, joint 2 and 4 more: no damping at rest"]
    other = [replace(note, text=f"alternative JK: {note.text}") for note in silent[:3]]
    assert grouped(other)[0].text == "alternative JK: joint 1, joint 2 and joint 3: no damping at rest"


def test_joints_that_differ_in_too_many_numbers_have_a_note_each():
    def four(joint, load):
        return Note(code="x", joint=joint, text=f"{joint}, {load} kN: at {load}, {load + 1} and {len(joint)} mm")

    notes = [four(joint, load) for joint in ("a", "bbb") for load in (1, 2)]
    assert [note.text for note in grouped(notes)] == [
        "a, 1 to 2 kN: at 1 to 2, 2 to 3 and 1 mm",
        "bbb, 1 to 2 kN: at 1 to 2, 2 to 3 and 3 mm",
    ]


def test_many_differences_are_no_spans():
    notes = [Note(code="x", text=f"at {k}, {k + 1}, {k + 2} and {k + 3} mm") for k in range(2)]
    assert grouped(notes) == tuple(notes)


def test_numbers_inside_words_are_no_numbers():
    notes = [Note(code="x", text=f"bolt M{size} in S355") for size in (8, 10)]
    assert grouped(notes) == tuple(notes)


def test_the_same_twice_is_said_once():
    assert grouped([outside(4, 0.2)] * 2) == (outside(4, 0.2),)


@pytest.mark.parametrize(
    ("share", "words"), [(0.0, "0%"), (1e-6, "less than 1%"), (0.0099, "less than 1%"), (0.126, "13%")]
)
def test_no_share_is_said_to_be_none(share, words):
    assert percent(share) == words


def test_what_concerns_little_or_an_alternative_alone_comes_last():
    other = Note(code="window", severity="limit", text="alternative JK: c")
    notes = [
        other,
        outside(4, 0.01),
        outside(8, 0.04),
        Note(code="window", severity="limit", text="b"),
        outside(4, 0.6, why="c"),
    ]
    found = grave(notes)
    assert [note.text[:5] for note in found] == ["b", "flang", "flang", "alter"]
    assert found[1].share == 0.6
    assert found[2].share == 0.04  # the greatest of those that are said as one
    assert by_severity(notes, found[:3]) == {"limit": (other,)}
    assert by_severity(notes, found) == {}


def test_notes_of_one_code_are_equally_grave():
    written = re.compile(r'Note\(\s*code=("[\w-]+"|\w+),(?:\s*severity="(\w+)")?')
    found = defaultdict(set)
    for file in SOURCE.rglob("*.py"):
        text = file.read_text()
        assert not re.findall(r'Note\(\s*code=f"', text)  # a code that is put together is found by nobody
        for code, severity in written.findall(text):
            found[code].add(severity or "remark")
    assert len(found) > 80
    assert {code: kinds for code, kinds in found.items() if len(kinds) > 1} == {}


def test_the_gravest_come_first():
    notes = [Note(code="mates", text="a"), outside(4, 0.2), Note(code="open", severity="wrong", text="b")]
    assert list(by_severity(notes)) == ["wrong", "limit", "remark"]
