"""Scans and profiles: frozen, checked, in metres."""

import dataclasses

import numpy as np
import pytest

from faying import InputError, Scan
from faying.surface.heights import Instrument, usable
from faying.surface.scan import Profile


def test_scan_is_frozen_and_copies_its_heights():
    z = np.zeros((4, 6))
    scan = Scan(heights=z, spacing=(2e-6, 3e-6))
    z[0, 0] = 5.0
    assert scan.heights[0, 0] == 0
    assert scan.shape == (4, 6)
    assert scan.size == pytest.approx((12e-6, 12e-6))
    with pytest.raises(ValueError, match="read-only"):
        scan.heights[0, 0] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        scan.spacing = (1.0, 1.0)


def test_masked_points_count_as_missing():
    z = np.ma.masked_greater(np.arange(12.0).reshape(3, 4), 9.5)
    scan = Scan(heights=z, spacing=(1e-6, 1e-6))
    assert scan.missing == 2


def test_profiles_of_a_scan_keep_the_right_spacing():
    scan = Scan(heights=np.arange(12.0).reshape(3, 4), spacing=(1e-6, 2e-6))
    row, column = scan.profile("x", 1), scan.profile("y", 2)
    assert list(row.heights) == [4, 5, 6, 7]
    assert row.spacing == 1e-6
    assert list(column.heights) == [2, 6, 10]
    assert column.spacing == 2e-6
    assert column.length == pytest.approx(6e-6)


@pytest.mark.parametrize(
    ("heights", "spacing", "match"),
    [
        (np.zeros(5), (1e-6, 1e-6), "1 dimensions"),
        (np.zeros((1, 5)), (1e-6, 1e-6), "too few points"),
        (np.full((3, 3), np.inf), (1e-6, 1e-6), "infinite"),
        ([["a", "b"], ["c", "d"]], (1e-6, 1e-6), "real numbers"),
        (np.zeros((3, 3)), 1e-6, "give 2 numbers in m"),
        (np.zeros((3, 3)), np.array(1e-6), "give 2 numbers in m"),
        (np.zeros((3, 3)), (1e-6, 0.0), "positive"),
        (np.zeros((3, 3)), (1e-6, "1 kg"), "not in a unit like m"),
        (np.zeros((3, 3)), (1e-6, True), "spacing \\(dx, dy\\) = True; give a number in m"),
        (np.zeros((3, 3)), (float("nan"), 1e-6), "positive"),
    ],
)
def test_what_is_no_scan_is_refused(heights, spacing, match):
    with pytest.raises(InputError, match=match):
        Scan(heights=heights, spacing=spacing)


def test_profile_index_and_direction_are_checked():
    scan = Scan(heights=np.zeros((3, 4)), spacing=(1e-6, 1e-6))
    with pytest.raises(InputError, match="has 3 of them"):
        scan.profile("x", 3)
    with pytest.raises(InputError, match='"x" or "y"'):
        scan.profile("z", 0)


@pytest.mark.parametrize(
    ("heights", "match"),
    [
        (np.full((20, 20), np.nan), "every point is missing"),
        (np.full((20, 20), 3e-6), "all heights are the same"),
        (np.random.default_rng(0).normal(size=(20, 4)), "at least 16"),
        (np.where(np.arange(400).reshape(20, 20) % 5 < 3, np.nan, np.arange(400.0).reshape(20, 20)), "60 %"),
    ],
)
def test_heights_that_carry_no_statistic(heights, match):
    with pytest.raises(InputError, match=match):
        usable(Scan(heights=heights, spacing=(1e-6, 1e-6)))


def test_profile_needs_one_row():
    with pytest.raises(InputError, match="one row"):
        Profile(heights=np.zeros((3, 3)), spacing=1e-6)


@pytest.mark.parametrize(
    ("shape", "share", "rows", "columns"),
    [
        ((40, 60), 0.5, slice(10, 30), slice(15, 45)),
        ((41, 9), 0.6, slice(8, 33), slice(2, 7)),
        ((12, 20), 1.0, slice(0, 12), slice(0, 20)),
    ],
)
def test_cropped_is_the_middle_of_the_scan(shape, share, rows, columns):
    z = np.arange(np.prod(shape), dtype=float).reshape(shape) * 1e-9
    scan = Scan(heights=z, spacing=(2e-6, 3e-6), source="made", instrument=Instrument(resolution=5e-6))
    part = scan.cropped(share)
    np.testing.assert_array_equal(part.heights, z[rows, columns])
    assert (part.spacing, part.source, part.instrument) == (scan.spacing, scan.source, scan.instrument)
    assert "cropped" in part.history[-1]


@pytest.mark.parametrize("share", [0.0, -0.5, 1.0001, float("nan"), float("inf")])
def test_a_share_that_cannot_be_is_refused(share):
    with pytest.raises(InputError, match="above 0 and at most 1"):
        Scan(heights=np.eye(20), spacing=(1e-6, 1e-6)).cropped(share)


def test_a_crop_of_too_few_points_is_refused():
    scan = Scan(heights=np.eye(20), spacing=(1e-6, 1e-6))
    assert scan.cropped(0.25).shape == (5, 5)
    with pytest.raises(InputError, match="4 x 4; at least 5 points a side"):
        scan.cropped(0.2)
