"""Stress areas and proof loads against the tables of ISO 898-1."""

import pytest

import faying
from faying.bolt.threads import Fastener, Thread


@pytest.mark.parametrize(
    ("thread", "area"),
    [
        ("M3", 5.03),
        ("M4", 8.78),
        ("M5", 14.2),
        ("M6", 20.1),
        ("M8", 36.6),
        ("M10", 58.0),
        ("M12", 84.3),
        ("M16", 157),
        ("M20", 245),
        ("M24", 353),
        ("M30", 561),
        ("M39", 976),
        ("M42", 1121),
        ("M48", 1473),
        ("M56", 2030),
        ("M64", 2676),
        ("M72", 3460),
        ("M80", 4344),
        ("M90", 5590),
        ("M100", 6995),
        ("M8x1", 39.2),
        ("M12 x 1.25", 92.1),
    ],
)
def test_stress_areas(thread, area, published):
    ours = Thread.parse(thread).stress_area * 1e6
    source = "ISO 898-1:2013, Tables 4 and 6; DIN 13-28 above M39"
    published(
        f"stress area of {thread}", area, ours, unit="mm2", rel=3e-3, source=source, why="printed to three digits"
    )


@pytest.mark.parametrize(
    ("thread", "grade", "load"),
    [
        ("M6", "4.8", 6230),
        ("M6", "8.8", 11600),
        ("M8", "6.8", 16100),
        ("M8", "8.8", 21200),
        ("M10", "10.9", 48100),
        ("M12", "12.9", 81800),
        ("M16", "8.8", 91000),
        ("M20", "8.8", 147000),
    ],
)
def test_proof_loads(thread, grade, load, published):
    ours = Fastener(thread=Thread.parse(thread), grade=grade).proof_load
    source, why = "ISO 898-1:2013, Table 5", "printed to three digits, rounded down"
    published(f"proof load of {thread} of class {grade}", load, ours, unit="N", rel=8e-3, source=source, why=why)


@pytest.mark.parametrize("text", ["8 mm", "m8", "M8-1", "M", "M9", "M50", "M8x3"])
def test_threads_that_are_none(text):
    with pytest.raises(faying.InputError, match="thread"):
        Thread.parse(text)


def test_a_grade_that_is_none():
    with pytest.raises(faying.InputError, match=r"not a property class of ISO 898-1; give one of 4\.6"):
        Fastener(thread=Thread.parse("M8"), grade="A2-70")


def test_a_thread_says_what_it_is():
    assert str(Thread.parse("M8")) == "M8x1.25"


@pytest.mark.parametrize("pitch", [1.25e-6, 0.1e-3, 2.7e-3])
def test_a_pitch_in_another_unit_is_refused(pitch):
    """1.25 um for 1.25 mm would give M8 a stress area of 50 mm2 in place of 37."""
    with pytest.raises(faying.InputError, match="a pitch from 0.2 mm to a third of the diameter"):
        Thread(diameter=8e-3, pitch=pitch)
