"""Synthetic surfaces hold what they were asked for."""

import numpy as np
import pytest

from faying import InputError, Scan
from faying.surface.scan import Profile
from faying.surface.synthesize import spectral
from tests.helpers.weierstrass import weierstrass_mandelbrot


def test_weierstrass_mandelbrot_surface_equals_its_double_sum():
    # eq. (5) of Yan and Komvopoulos, term by term at a few points
    D, G, L, gamma, M = 2.4, 1e-9, 1e-4, 1.5, 4
    scan = weierstrass_mandelbrot(
        (12, 10), spacing=1e-6, D=D, G=G, gamma=gamma, ridges=M, length=L, shortest=5e-6, seed=9
    )
    terms = int(np.log(L / 5e-6) / np.log(gamma)) + 1
    phase = np.random.default_rng(9).uniform(0, 2 * np.pi, (M, terms))
    for iy, ix in ((0, 0), (3, 7), (11, 9)):
        x, y = ix * 1e-6, iy * 1e-6
        r, theta = np.hypot(x, y), np.arctan2(y, x)
        total = 0.0
        for m in range(M):
            for n in range(terms):
                wave = 2 * np.pi * gamma**n * r / L * np.cos(theta - np.pi * m / M)
                total += gamma ** ((D - 3) * n) * (np.cos(phase[m, n]) - np.cos(wave + phase[m, n]))
        z = L * (G / L) ** (D - 2) * (np.log(gamma) / M) ** 0.5 * total
        assert scan.heights[iy, ix] == pytest.approx(z, rel=1e-9, abs=1e-18)


def test_the_two_conventions_differ_by_the_root_of_ln_gamma():
    a, b = (
        weierstrass_mandelbrot(64, spacing=1e-6, D=2.4, G=1e-9, convention=name).heights
        for name in ("yan-komvopoulos", "majumdar-bhushan")
    )
    assert np.allclose(a, b * np.log(1.5) ** 0.5)


def test_zero_phases_start_at_zero():
    assert weierstrass_mandelbrot((8, 8), spacing=1e-6, D=2.4, G=1e-9, seed=None).heights[0, 0] == pytest.approx(
        0, abs=1e-20
    )


@pytest.mark.parametrize("lay", [None, (0.5, 3.0)])
def test_rms_height_is_the_one_that_G_implies(lay):
    # periodic: waves 1/L and up only, so the mean square is the sum over the grid; G and Rq options agree
    D, side, n = 2.6, 1e-3, 256
    from faying.surface.convention import density

    squares = [
        spectral((n, n), spacing=side / n, D=D, G=1e-9, lay=lay, periodic=True, seed=s).heights.var() for s in range(24)
    ]
    fx = np.fft.fftfreq(n, side / n)
    fy = fx[:, None]
    f = np.hypot(fx, fy)
    use = (f > 0) & (f <= n / side / 2)
    power = density(D, 1e-9) * f[use] ** (2 * D - 7) / (2 * np.pi * f[use])
    expected = np.sum(power) / side**2
    # with a lay the power of a ring is the same only on average over directions, which few low waves do not resolve
    assert np.mean(squares) == pytest.approx(expected, rel=0.12 if lay is None else 0.3)


def test_asked_for_Rq_is_met_and_seeds_repeat():
    a = spectral((64, 48), spacing=(1e-6, 2e-6), D=2.3, Rq=3e-7, seed=5)
    assert isinstance(a, Scan)
    assert a.shape == (64, 48)
    assert a.spacing == (1e-6, 2e-6)
    assert a.heights.std() == pytest.approx(3e-7, rel=1e-9)
    assert np.array_equal(a.heights, spectral((64, 48), spacing=(1e-6, 2e-6), D=2.3, Rq=3e-7, seed=5).heights)
    assert not np.array_equal(a.heights, spectral((64, 48), spacing=(1e-6, 2e-6), D=2.3, Rq=3e-7, seed=6).heights)
    assert isinstance(spectral(100, spacing=1e-6, D=2.3, Rq=1e-7), Profile)


def test_periodic_surfaces_close_on_themselves_and_others_do_not():
    def jump(periodic):
        z = spectral((128, 128), spacing=1e-6, D=2.2, Rq=1e-6, periodic=periodic, seed=1).heights
        return np.std(z[:, 0] - z[:, -1]) / np.std(np.diff(z, axis=1))

    assert jump(True) < 2
    assert jump(False) > 5


def test_shortest_and_longest_waves():
    from faying.surface.spectrum import spectrum

    s = spectrum(spectral((256, 256), spacing=1e-6, D=2.4, Rq=1e-6, shortest=1e-5, longest=5e-5, seed=1))
    above = s.density[s.frequency > 1.3e5].max() / s.density[(s.frequency > 6e4) & (s.frequency < 9e4)].min()
    assert above < 1e-3
    low = (
        s.density[(s.frequency > 6e3) & (s.frequency < 1.8e4)]
        / s.frequency[(s.frequency > 6e3) & (s.frequency < 1.8e4)]
    )
    # a plateau of the areal density below 1/longest
    assert low.max() / low.min() < 5


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"D": 3.0}, "between 2 and 3"),
        ({"G": 1e-9}, "one of them"),
        ({"Rq": None}, "one of them"),
        ({"Rq": -1.0}, "must be positive"),
        ({"longest": 0.0}, "must be positive"),
        ({"lay": (0.0, 0.5)}, "stretch of the lay = 0.5; it must be at least 1"),
        ({"shape": (1, 5)}, "a whole number, at least 2"),
        ({"spacing": (1e-6, -1e-6)}, "spacing = -1e-06 m; it must be positive"),
    ],
)
def test_faulty_requests(change, match):
    given = {"shape": (32, 32), "spacing": 1e-6, "D": 2.4, "Rq": 1e-6} | change
    with pytest.raises(InputError, match=match):
        spectral(given.pop("shape"), **given)
