"""`faying asperity` and the study of many cases."""

import json

import numpy as np
import pytest
import xarray
from click.testing import CliRunner

from faying.cli.scan.asperity import command
from faying.errors import FayingError, InputError, ReadError

SMALL = ["--elements", "6", "--E", "100 GPa"]
ONE = ["--R", "20 um", "--h-a", "750 nm", "--displacement", "30 nm", *SMALL]


def call(*words):
    return CliRunner().invoke(command, list(words), catch_exceptions=False)


def test_one_case_as_table_json_netcdf_and_figure(tmp_path):
    shown = call(*ONE, "--displacement", "0", "--netcdf", str(tmp_path / "a.nc"), "--plot", str(tmp_path / "a.png"))
    assert shown.exit_code == 0
    assert "2.3" in shown.output
    assert "mN" in shown.output
    assert "um2" in shown.output
    assert (tmp_path / "a.png").stat().st_size > 10_000
    entry = json.loads(CliRunner().invoke(command, [*ONE, "--json"]).stdout)[0]
    with xarray.open_dataset(tmp_path / "a.nc") as found:
        assert found.force.attrs["units"] == "N"
        assert np.nanmax(found.force[0]) == pytest.approx(entry["force"], rel=1e-9)
        assert found.residual[0] > 0
    assert entry["pressure"] == pytest.approx(entry["force"] / entry["area"])


def test_a_table_in_two_processes(tmp_path):
    (tmp_path / "cases.csv").write_text(
        "R,h_a,displacement,substrate_E\n20 um,750 nm,30 nm,\n20 um,750 nm,30 nm,50 GPa\n"
    )
    shown = CliRunner().invoke(command, [*SMALL, "--table", str(tmp_path / "cases.csv"), "--processes", "2", "--json"])
    assert shown.exit_code == 0
    hard, soft = json.loads(shown.stdout)
    alone = json.loads(CliRunner().invoke(command, [*ONE, "--json"]).stdout)[0]
    assert hard["force"] == pytest.approx(alone["force"], rel=1e-9)
    assert soft["force"] < hard["force"]


def test_a_failed_case_does_not_stop_the_others(tmp_path):
    (tmp_path / "cases.csv").write_text("R,h_a,displacement\n20 um,750 nm,800 nm\n20 um,750 nm,30 nm\n")
    with pytest.raises(FayingError, match="1 of 2 cases failed"):
        call(*SMALL, "--table", str(tmp_path / "cases.csv"), "--processes", "1", "--netcdf", str(tmp_path / "b.nc"))
    with xarray.open_dataset(tmp_path / "b.nc") as found:
        assert np.isnan(found.force[0]).all()
        assert np.nanmax(found.force[1]) > 0
        assert "more than the height" in str(found.message.values[0])


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--h-a", "1 um", "--displacement", "1 nm"], "R is missing"),
        (["--R", "20 um", "--h-a", "1 um"], "displacement is missing"),
        (["--R", "20 um", "--h-a", "1 um", "--displacement", "1 nm", "--material", "cheese"], "choose from"),
        (["--R", "20 um", "--h-a", "1 um", "--displacement", "1 kN"], "displacement"),
    ],
)
def test_what_is_missing_or_wrong_is_said(words, said):
    with pytest.raises(InputError, match=said):
        call(*words)


def test_a_table_with_other_columns_is_refused(tmp_path):
    (tmp_path / "cases.csv").write_text("R,radius\n1 um,2\n")
    with pytest.raises(InputError, match="radius unknown, h_a missing"):
        call("--table", str(tmp_path / "cases.csv"))
    with pytest.raises(ReadError, match="cannot be read"):
        call("--table", str(tmp_path / "none.csv"))
