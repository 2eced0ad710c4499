"""`faying law` with the numerical contact of the scan among its models."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from faying.cli.main import cli
from faying.materials import CATALOGUE

STEEL = ["--material", "45 steel", "--pressure", "5 MPa:200 MPa:5"]
HARDEST = float(CATALOGUE["45 steel"].vickers.at(np.sqrt(2) * 5e-6))  # of a spot of one point [Pa]


@pytest.fixture(scope="module")
def scan_file(tmp_path_factory):
    n, dx = 64, 5e-6
    random = np.random.default_rng(3)
    k = np.hypot(np.fft.fftfreq(n)[:, None], np.fft.rfftfreq(n)[None, :])
    k[0, 0] = np.inf
    z = np.fft.irfft2(np.fft.rfft2(random.standard_normal((n, n))) * k**-1.7, s=(n, n))
    z *= 1e-6 / z.std()
    y, x = np.mgrid[0:n, 0:n] * dx
    file = tmp_path_factory.mktemp("scan") / "scan.csv"
    np.savetxt(file, np.c_[x.ravel() * 1e3, y.ravel() * 1e3, z.ravel() * 1e6], delimiter=",")
    return ["--scan", str(file), "--xy-unit", "mm", "--z-unit", "um"]


def run(*arguments):
    result = CliRunner().invoke(cli, ["law", *arguments], catch_exceptions=True)
    if result.exception and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result


@pytest.mark.slow
def test_the_half_space_stands_beside_the_analytic_laws(scan_file, tmp_path):
    plot = tmp_path / "law.png"
    result = run(*scan_file, *STEEL, "--models", "jk,gw,persson,halfspace", "--plot", str(plot))
    assert result.exit_code == 0, result.output
    assert "half-space" in result.stdout
    assert "max / min" in result.stdout
    assert plot.read_bytes()[:4] == b"\x89PNG"


def test_the_half_space_alone_takes_the_scan(scan_file):
    given = json.loads(run(*scan_file, *STEEL, "--model", "halfspace", "--set", "points=16", "--json").stdout)
    p, area = np.array(given["pressure"]["values"]), np.array(given["area"]["values"])
    assert given["law"] == "half-space"
    # no spot carries more than the hardness of the smallest, of one point
    assert np.all(area >= p / HARDEST * 0.95)
    assert np.all(np.diff(given["k_n"]["values"]) > 0)


def test_what_the_scan_does_not_resolve_is_said_beside_the_numbers(scan_file):
    words = "fewer than 10 spots of the scan touch"
    both = [*scan_file, *STEEL, "--models", "jk,halfspace"]
    assert words in run(*both).stdout
    assert words in json.loads(run(*both, "--json").stdout)["laws"]["half-space"]["reasons"]
    alone = run(*scan_file, *STEEL, "--model", "halfspace").stdout
    assert words in alone
    assert " *" in alone
