"""What the models take from a scan."""

from math import log, pi, sqrt

import numpy as np
import pytest

from faying import JK, RIGID, ContactPair, InputError, Material
from faying.cli import main
from faying.contact import SurfaceInputs, laws

PAIR = ContactPair(Material(name="m", E=200e9, nu=0.3, yield_strength=355e6), RIGID)


def waves(n: int = 400) -> SurfaceInputs:
    x = np.arange(n) * 1e-6
    q = [2 * pi * 4 / (n * 1e-6), 2 * pi * 10 / (n * 1e-6)]
    z = sum(1e-6 / k * (np.cos(q[i] * x)[None, :] + np.cos(q[i] * x)[:, None]) for i, k in enumerate((1, 4)))
    return SurfaceInputs.from_heights(z, (1e-6, 1e-6), D=2.4, G=1e-10)


def test_moments_of_waves_are_known() -> None:
    s = waves()
    q = 2 * pi * np.array([4, 10]) / 400e-6
    a2 = np.array([1.0, 1 / 16]) * 1e-12
    # two directions, each a^2/2; a profile along x sees the waves along x only
    assert s.m0 == pytest.approx(sum(a2), rel=1e-9)
    assert s.m2 == pytest.approx(sum(a2 * q**2) / 2, rel=1e-2)
    assert s.m4 == pytest.approx(sum(a2 * q**4) / 2, rel=3e-2)
    assert s.slope == pytest.approx(sqrt(sum(a2 * q**2)), rel=1e-2)
    assert s.h_rms == pytest.approx(sqrt(s.m0))
    assert s.scan_area == pytest.approx(400e-6**2)
    assert s.shortest == 2e-6


def test_summits_follow_from_the_moments() -> None:
    s = SurfaceInputs(
        D=2.4, G=1e-10, scan_area=16e-6, m0=4e-14, m2=1e-4, m4=1e6, slope=0.014, h_rms=2e-7, shortest=1e-6
    )
    assert s.alpha == pytest.approx(4e-14 * 1e6 / 1e-8)
    assert s.summit_density == pytest.approx(1e10 / (6 * pi * sqrt(3)))
    assert s.summit_radius == pytest.approx(0.375 * sqrt(pi / 1e6))
    assert s.summit_deviation == pytest.approx(sqrt((1 - 0.8968 / 4) * 4e-14))
    # c G^(2D-4) is the same: c = 1 for Yan and Komvopoulos, 1/ln(gamma) for Majumdar and Bhushan
    assert s.G_majumdar_bhushan**0.8 / log(1.5) == pytest.approx(s.G**0.8)


def test_missing_points_are_left_out() -> None:
    z = np.random.default_rng(1).normal(size=(200, 200)) * 1e-7
    full = SurfaceInputs.from_heights(z, (1e-6, 1e-6), D=2.4, G=1e-10)
    z[50:60, 50:60] = np.nan
    holed = SurfaceInputs.from_heights(z, (1e-6, 1e-6), D=2.4, G=1e-10)
    assert holed.m4 == pytest.approx(full.m4, rel=0.02)


def test_moments_of_an_ideal_fractal_surface() -> None:
    s = SurfaceInputs.from_fractal(D=2.39, G=1.53e-10, scan_area=16e-6, shortest=1e-5)
    # the paper's D and G imply 3.3 um over 4 mm by a continuous spectrum; the series has its first whole wave there
    assert s.h_rms == pytest.approx(3.3e-6, rel=0.15)
    finer = SurfaceInputs.from_fractal(D=2.39, G=1.53e-10, scan_area=16e-6, shortest=1e-6)
    assert finer.h_rms == pytest.approx(s.h_rms, rel=1e-2)
    assert finer.slope > 1.5 * s.slope
    # variance of the wave n is G^(2D-4) ln(gamma) l^(6-2D)/2: the series summed to infinity is geometric
    first = 1.53e-10**0.78 * log(1.5) * 4e-3**1.22 / 2
    assert finer.m0 == pytest.approx(first / (1 - 1.5**-1.22), rel=1e-3)
    # isotropic: squared gradient is the sum of two profiles, and m4 of a profile 3/8 of the fourth moment
    assert s.m2 == pytest.approx(s.slope**2 / 2)
    with pytest.raises(InputError, match="below the side"):
        SurfaceInputs.from_fractal(D=2.39, G=1.53e-10, scan_area=16e-6, shortest=1.0)


def test_faults_are_told() -> None:
    with pytest.raises(InputError, match="at least 5 x 5"):
        SurfaceInputs.from_heights(np.zeros((4, 9)), (1e-6, 1e-6), D=2.4, G=1e-10)
    with pytest.raises(InputError, match=r"m0 = 0.0; it must be positive"):
        SurfaceInputs.from_heights(np.zeros((9, 9)), (1e-6, 1e-6), D=2.4, G=1e-10)
    with pytest.raises(InputError, match=r"m0 m4/m2\^2 = 0.25"):
        SurfaceInputs(D=2.4, G=1e-10, scan_area=1e-6, m0=1e-12, m2=2e-3, m4=1e6, slope=0.1, h_rms=1e-6, shortest=1e-6)


@pytest.mark.parametrize("name", laws())
def test_every_law_takes_a_surface_or_says_why_not(name: str) -> None:
    s = SurfaceInputs(
        D=2.4, G=1e-10, scan_area=16e-6, m0=1e-12, m2=1e-3, m4=1e8, slope=0.045, h_rms=1e-6, shortest=1e-6
    )
    cls = laws()[name]
    if cls.takes() not in ("fractal", "moments"):
        with pytest.raises(InputError, match="takes no .* from this surface"):
            cls.from_surface(s, PAIR)
        return
    law = cls.from_surface(s, PAIR)
    assert isinstance(law, cls)
    r = law.at_pressure(np.geomspace(1e5, 1e7, 5))
    assert np.all(np.diff(r.area) > 0)


def test_jk_of_a_surface() -> None:
    s = SurfaceInputs(
        D=2.4, G=1e-10, scan_area=16e-6, m0=1e-12, m2=1e-3, m4=1e8, slope=0.045, h_rms=1e-6, shortest=1e-6
    )
    assert JK.from_surface(s, PAIR) == JK(D=2.4, G=1e-10, pair=PAIR, scan_area=16e-6)


@pytest.mark.parametrize("model", ["mb", "wk", "yk"])
@pytest.mark.parametrize("D", ["2.0001", "2.0003", "2.9999"])
def test_a_dimension_beside_its_limits_is_answered_or_refused_in_words(model, D, capsys):
    """Their critical areas are powers of 1 / (D - 2)."""
    command = ["law", "--model", model, "--D", D, "--G", "1e-10 m", "--scan-area", "16 mm^2", "--pressure", "1 MPa"]
    with pytest.raises(SystemExit) as stop:
        main([*command, "--material", "45 steel"])
    said = capsys.readouterr()
    assert stop.value.code == 0 or said.err.startswith("faying: ")
