"""Areal parameters of ISO 25178-2 against closed forms of normal heights and a known autocorrelation."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.integrate import quad
from scipy.stats import norm

import faying
from faying.cli.scan.surface import command

SIDE = 512
# 512^2 normal heights: relative standard error of Sq 0.14 %, of a quantile of 2.5 % of the area 0.3 %
SAMPLING = 1e-2


@pytest.fixture(scope="module")
def noise():
    """Independent normal heights of 1 um."""
    heights = 1e-6 * np.random.default_rng(5).standard_normal((SIDE, SIDE))
    return faying.Scan(heights=heights, spacing=(1e-3, 1e-3)).areal(spikes=False)


def test_the_core_of_normal_heights_is_the_line_of_least_squares_about_their_median(noise):
    """The flattest 40 % lie about the median, where the density is greatest; ISO 13565-2, 4.2, fits the line there."""
    core = quad(lambda share: (share - 0.5) * norm.ppf(share), 0.3, 0.7)[0] / (0.4**3 / 12)
    tail = norm.sf(core / 2)
    triangle = 2 * (norm.pdf(core / 2) - core / 2 * tail) / tail
    assert noise.Sk == pytest.approx(1e-6 * core, rel=SAMPLING)
    assert [noise.Spk, noise.Svk] == pytest.approx([1e-6 * triangle] * 2, rel=2 * SAMPLING)
    assert [noise.Smr1, 1 - noise.Smr2] == pytest.approx([tail] * 2, rel=2 * SAMPLING)


def test_volumes_of_normal_heights(noise):
    def material(share):
        return norm.pdf(norm.isf(share)) - share * norm.isf(share)

    def void(share):
        return material(share) + norm.isf(share)  # their difference is the height, above the mean

    found = [noise.Vmp, noise.Vmc, noise.Vvc, noise.Vvv, noise.Sxp]
    expected = [material(0.1), material(0.8) - material(0.1), void(0.1) - void(0.8), void(0.8), norm.isf(0.025)]
    assert found == pytest.approx(1e-6 * np.array(expected), rel=SAMPLING)
    assert noise.Sp > 4e-6 < noise.Sv  # the greatest of 260,000


@pytest.mark.parametrize(("dx", "dy"), [(1e-6, 1e-6), (2e-6, 1e-6)])
def test_sal_and_str_of_a_gaussian_autocorrelation(dx, dy):
    """White noise smoothed by a Gaussian of width s has exp(-r^2/4 s^2), which is 0.2 at 2 s sqrt(ln 5).

    A map has 500 independent patches and four maps 2000: the autocorrelation is known to 2 %, the distance to 1.5 %.
    """
    x, y = np.fft.fftfreq(SIDE), np.fft.fftfreq(SIDE)
    sx, sy = 8.0, 4.0
    smooth = np.exp(-2 * np.pi**2 * ((sx * x[None, :]) ** 2 + (sy * y[:, None]) ** 2))
    found = []
    for seed in range(4):
        white = np.random.default_rng(seed).standard_normal((SIDE, SIDE))
        heights = np.fft.ifft2(np.fft.fft2(white) * smooth).real
        found.append(faying.Scan(heights=1e-6 * heights, spacing=(dx, dy)).areal())
    near, far = sorted((sx * dx, sy * dy))
    assert np.mean([one.Sal for one in found]) == pytest.approx(2 * near * np.sqrt(np.log(5)), rel=0.05)
    assert np.mean([one.Str for one in found]) == pytest.approx(near / far, rel=0.05)


def test_grooves_have_no_str():
    x = np.arange(128) / 128
    grooves = np.sin(2 * np.pi * (16 * x[None, :] + 16 * x[:, None]))
    one = faying.Scan(heights=1e-6 * grooves, spacing=(1e-5, 1e-5)).areal()
    assert np.isnan(one.Str)  # along the grooves the heights never change
    assert one.Sal == pytest.approx(np.arccos(0.2) / (2 * np.pi) * 128e-5 / (16 * np.sqrt(2)), rel=0.02)


def test_a_flat_top_has_reduced_valleys_and_no_peaks():
    """Plateaus: nine tenths of the area at one height, the rest a ramp down."""
    heights = np.zeros((100, 100))
    heights[:, :10] = -np.linspace(1e-6, 2e-6, 10)
    one = faying.Scan(heights=heights, spacing=(1e-5, 1e-5)).areal(degree=0, spikes=False)
    assert (one.Sk, one.Spk, one.Smr1) == pytest.approx((0, 0, 0), abs=1e-12)
    assert one.Smr2 == pytest.approx(0.9)
    assert one.Svk == pytest.approx(2 * 1.5e-6, rel=1e-9)  # a triangle of the same area, 0.1 wide


def test_the_command_prints_them_and_refuses_a_profile(tmp_path):
    file = tmp_path / "profile.csv"
    file.write_text("x [um], z [um]\n" + "\n".join(f"{k}, {np.sin(k)}" for k in range(200)))
    heights = 1e-6 * np.random.default_rng(1).standard_normal((64, 64))
    scan = faying.Scan(heights=heights, spacing=(1e-6, 1e-6))
    faying.write_scan(scan, tmp_path / "scan.x3p")
    printed = CliRunner().invoke(command, [str(tmp_path / "scan.x3p"), "--iso"])
    assert printed.exit_code == 0
    assert all(f"{name} " in printed.output for name in ("Sk", "Spk", "Vmp", "Sal", "Str"))
    tree = CliRunner().invoke(command, [str(tmp_path / "scan.x3p"), "--iso", "--json"])
    assert json.loads(tree.output)["areal"]["Sk"] == pytest.approx(scan.areal().Sk, rel=1e-3)  # heights in the file
    with pytest.raises(faying.InputError, match="--iso is for scans"):
        CliRunner().invoke(command, [str(file), "--iso"], catch_exceptions=False)
