"""A result that is read is the result that was written, in every part."""

import numpy as np

from faying.joint.attachments import PointMass, Support
from faying.result import Result
from faying.result.groups import Alternatives
from tests.helpers.results import small_result
from tests.helpers.scenes import two_boxes


def test_names_of_other_laws_are_read_as_they_were_given_and_written_again(tmp_path):
    two = np.ones((2, 2, 2))
    written = small_result(
        alternatives=Alternatives(
            names=("JK", "hollow"),
            frequencies=two,
            loss_factors=two,
            above_range_frequencies=two,
            outside_share=two[0],
            above_range_share=two[0],
            reach=two[0, 0],
        ),
    )
    read = Result.load(written.save(tmp_path / "result.nc"))
    assert read.alternatives.names == ("JK", "hollow")
    assert Result.load(read.save(tmp_path / "again.nc")) == written


def test_what_the_structure_is_made_of_is_read_as_it_was_written(tmp_path):
    written = two_boxes(
        supports=(Support(face="p0.left"), Support(face="p1.right", directions=("z",), stiffness=1e9)),
        masses=(PointMass(mass=0.2, point=(0.1, 0.0, 0.0)), PointMass(mass=0.1, face="p1.right")),
    )
    read = Result.load(written.save(tmp_path / "result.nc"))
    assert read == written
    assert read.supports == written.supports
    assert read.masses[0].point == (0.1, 0.0, 0.0)
