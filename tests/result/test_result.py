"""A result that is read is the result that was written, in every part."""

import numpy as np

from faying.result import Result
from tests.helpers.results import small_result


def test_names_of_other_laws_are_read_as_they_were_given_and_written_again(tmp_path):
    two = np.ones((2, 2, 2))
    written = small_result(
        beside=("JK", "hollow"),
        beside_frequencies=two,
        beside_loss_factors=two,
        beside_beyond_frequencies=two,
        beside_outside_share=two[0],
        beside_beyond_share=two[0],
        beside_reach=two[0, 0],
    )
    read = Result.load(written.to_netcdf(tmp_path / "result.nc"))
    assert read.beside == ("JK", "hollow")
    assert Result.load(read.to_netcdf(tmp_path / "again.nc")) == written
