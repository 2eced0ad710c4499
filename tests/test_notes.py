"""Notes: what they mean for a result, and how many of a kind are said as one."""

import pytest

from faying.notes import LIMITS, WRONG, Note, by_severity, grouped, percent


def outside(load, share, joint="flange", why="fewer than 10 spots touch"):
    where = f"outside its validity range for {percent(share)} of the joint's stiffness"
    text = f"{joint}, {load:g} kN: the law is {where}: {why}"
    return Note(code="outside-validity", joint=joint, load=1e3 * load, share=share, text=text)


def test_loads_and_shares_become_spans():
    (one,) = grouped([outside(4, 0.16), outside(8, 0.16), outside(12, 0.18)])
    assert one.text == (
        "flange, 4 to 12 kN: the law is outside its validity range for 16 to 18% of the joint's stiffness: "
        "fewer than 10 spots touch"
    )
    assert one.load is None


def test_what_differs_in_words_stays_apart():
    notes = [outside(4, 0.2), outside(4, 0.3, joint="lap"), outside(4, 0.4, why="another reason"), outside(8, 0.2)]
    assert [note.joint for note in grouped(notes)] == ["flange", "lap", "flange"]
    assert grouped(notes)[1] == notes[1]


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


def test_the_gravest_come_first():
    assert not WRONG & LIMITS
    notes = [Note(code="mates", text="a"), outside(4, 0.2), Note(code="open", text="b")]
    assert list(by_severity(notes)) == ["wrong", "limit", "remark"]
