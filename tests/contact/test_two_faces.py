"""Two rough faces as one surface: sums of maps, of moments, of spectra."""

import numpy as np
import pytest

import faying
from faying.contact.two_faces import RELATED, face_to_face, faces_of
from faying.errors import InputError
from faying.surface.scan import Scan
from tests.helpers.scans import gaussian

POINTS, SIDE = 128, 0.5e-3


def rough(seed, rms=1e-6, points=POINTS, hurst=0.8, source="one"):
    z = gaussian(hurst, 0.06e-3, 8e-6, rms, seed, points=points, side=SIDE)
    return Scan(heights=z, spacing=(SIDE / points,) * 2, source=source)


def test_the_second_face_is_turned_over_before_heights_are_added():
    z = np.zeros((20, 24))
    z[3, 5] = 1e-6
    one, other = (Scan(heights=z, spacing=(1e-6, 1e-6)) for _ in range(2))
    total = face_to_face(one, other).heights
    # a peak meets its like in another row: turned over about x, row 3 of 20 lies on row 16
    assert sorted(map(tuple, np.argwhere(total > 0.9e-6).tolist())) == [(3, 5), (16, 5)]


def test_a_like_face_doubles_the_mean_squares_of_the_sum():
    """Heights, slopes and curvatures of an isotropic surface and an unrelated one of the same make."""
    scan = rough(1)
    same, smooth = faces_of(scan, "same").rough, faces_of(scan, "smooth").rough
    for name in ("m0", "m2", "m4"):
        assert getattr(same.inputs, name) == pytest.approx(2 * getattr(smooth.inputs, name), rel=1e-12)
    assert same.inputs.slope == pytest.approx(2**0.5 * smooth.inputs.slope, rel=1e-12)
    # the map itself: 8 by 8 independent waves of the longest kind scatter by some per cent
    assert same.scan.heights.std() == pytest.approx(2**0.5 * smooth.scan.heights.std(), rel=0.08)
    steps = [np.diff(r.scan.heights, axis=1).std() for r in (same, smooth)]
    assert steps[0] == pytest.approx(2**0.5 * steps[1], rel=0.08)


def test_the_scan_of_the_other_face_adds_its_spectrum():
    one, other = rough(1), rough(2, rms=2e-6, source="other")
    found = faces_of(one, other).rough
    apart = [faces_of(scan, "smooth").rough.inputs for scan in (one, other)]
    assert found.inputs.m0 == pytest.approx(sum(a.m0 for a in apart), rel=1e-12)
    assert found.inputs.h_rms == pytest.approx(5**0.5 * 1e-6, rel=0.05)
    assert found.scan.heights.std() == pytest.approx(found.inputs.h_rms, rel=0.05)
    like = faces_of(one, rough(2)).rough.inputs
    low, high = faces_of(one, "same").fit.D_interval
    assert low - 0.1 < like.D < high + 0.1


def test_faces_of_other_spacing_and_size_meet_on_the_finer_grid_over_what_is_common():
    def sine(points, step, length):
        x = np.arange(points) * step
        return Scan(heights=np.tile(1e-6 * np.sin(2 * np.pi * x / length), (points, 1)), spacing=(step, step))

    both = face_to_face(sine(240, 1e-6, 12e-6), sine(61, 2e-6, 20e-6))
    assert both.spacing == (1e-6, 1e-6)
    assert both.shape == (121, 121)
    # two unlike sines of 1 um: mean squares of half a square micrometre each
    assert both.heights.std() == pytest.approx(1e-6, rel=0.02)


def test_given_numbers_are_those_of_both_faces():
    found = faces_of(rough(1), "same", D=2.4, G=1e-10, scan_area=1e-6).rough.inputs
    assert (found.D, found.G, found.scan_area) == (2.4, 1e-10, 1e-6)


@pytest.mark.parametrize(
    ("counter", "words"), [("alike", '"same" or "smooth"'), (Scan(heights=np.eye(8), spacing=(1.0, 1.0)), "16")]
)
def test_other_faces_that_are_none(counter, words):
    with pytest.raises(InputError, match=words):
        _ = faces_of(rough(1), counter).unfitted


def test_a_rougher_pair_is_softer():
    """k_n falls as the heights grow by the root of two, for any law without a length of its own: k ~ p/h."""
    pair = faying.ContactPair(faying.CATALOGUE["45 steel"], faying.RIGID)
    scan = rough(3)
    for model in ("persson", "gw-ke"):
        both, one = (
            float(faying.Mates(scan, materials=pair, other=c).law(model).at_pressure(1e7).k_n)
            for c in ("same", "smooth")
        )
        assert both / one == pytest.approx(2**-0.5, rel=0.02)


@pytest.mark.parametrize("marks", [20, 21, 22])
@pytest.mark.parametrize("turned", [False, True])
def test_marks_along_a_side_neither_cancel_nor_double(marks, turned):
    """Two like faces have the root of 2 of the rms of one; by where the scan ended it was 0.1 or 2 times."""
    rows = np.arange(128)
    heights = 1e-6 * np.cos(2 * np.pi * marks * rows / 128)[:, None] * np.ones(128)
    heights = heights + 1e-7 * np.random.default_rng(marks).standard_normal(heights.shape)
    scan = Scan(heights=heights.T if turned else heights, spacing=(30e-6, 30e-6))
    both = faces_of(scan).unfitted.scan.heights
    assert 1 - RELATED <= both.var() / (2 * scan.heights.var()) <= 1 + RELATED
