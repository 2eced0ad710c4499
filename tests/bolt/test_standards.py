"""The table of fasteners: what its numbers must be to each other, whatever they are."""

from itertools import pairwise

import pytest

import faying
from faying.bolt.threads import COMMON, METRIC, PINS, metric, nearest_size


def test_a_washer_lies_under_its_head_and_over_its_hole():
    for size, one in METRIC.items():
        fine, medium, coarse = one.holes
        assert size < fine < medium < coarse
        if one.washer is not None:
            inner, outer, _ = one.washer
            assert inner in one.holes[:2]  # ISO 7089: the fine hole up to M36, the medium one above
            assert outer > max(one.flats or 0, one.socket or 0)
        for head in (one.flats, one.socket):
            assert head is None or head > coarse or size <= 3  # a head does not fall through its hole


def test_numbers_rise_with_the_size():
    for column in ("pitch", "flats", "socket", "washer"):
        found = [value for one in METRIC.values() if (value := getattr(one, column)) is not None]
        assert all(low <= high for low, high in pairwise(found))
    assert all(low < high for low, high in pairwise(PINS))


def test_the_ends_and_the_sizes_that_holes_are_taken_for():
    assert (min(METRIC), max(METRIC)) == (1.6, 100)
    assert (min(COMMON), max(COMMON)) == (3, 24)
    assert nearest_size(24.0, lambda one: one.flats, 0.01) == 16
    assert nearest_size(9.0, lambda one: one.size, 0.02) is None
    with pytest.raises(faying.InputError, match="M9 is not in the tables"):
        metric(9)
