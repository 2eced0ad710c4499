"""D and G found again on surfaces of known D and G, with intervals that hold."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from faying import FractalFit, InputError, NotConverged, Scan, fit_fractal
from faying.surface.convention import cut_factor, implied_Rq
from faying.surface.estimators.table import ESTIMATORS, METHODS
from faying.surface.fractal import fit_all
from faying.surface.fractal_fit import consistency
from faying.surface.synthesize import spectral
from faying.units import parse
from tests.helpers.imperfect import with_missing, with_noise
from tests.helpers.weierstrass import weierstrass_mandelbrot

G = 1e-9


def many(method, H, count, side, **options):
    fits = [
        fit_fractal(spectral((side, side), spacing=1e-6, D=3 - H, G=G, seed=s, **options), method) for s in range(count)
    ]
    return np.array([f.D - 3 + H for f in fits]), fits


@pytest.mark.parametrize("H", [0.35, 0.75])
def test_the_spectral_estimator_is_unbiased_and_its_intervals_hold(H):
    error, fits = many("psd", H, 20, 256)
    half = np.array([f.D_interval[1] - f.D for f in fits])
    # the mean of 20 within 3.5 of its standard errors; the intervals' width true to the spread within 40 %
    assert abs(error.mean()) < 3.5 * error.std(ddof=1) / 20**0.5
    assert half.mean() / 1.96 == pytest.approx(error.std(ddof=1), rel=0.45)
    # at 95 %, fewer than 15 of 20 inside has a probability of 3e-4
    assert np.sum(np.abs(error) < half) >= 15
    assert sum(f.G_interval[0] < G < f.G_interval[1] for f in fits) >= 15


@pytest.mark.parametrize(
    ("method", "bias"),
    [("structure", 0.1)],
)
def test_other_estimators_are_as_far_off_as_the_table_says_and_say_so(method, bias):
    error, fits = many(method, 0.6, 4, 256)
    assert abs(error.mean()) < bias
    assert all(any("without a bias" in w for w in f.warnings) for f in fits)


@pytest.mark.parametrize("treatment", ["lay", "noise", "tilt", "missing", "all"])
def test_what_a_real_scan_adds_does_not_move_D(treatment):
    error = []
    for seed in range(6):
        lay = (0.4, 2.0) if treatment in ("lay", "all") else None
        scan = spectral((256, 256), spacing=1e-6, D=2.5, G=G, lay=lay, seed=seed)
        rq = scan.heights.std()
        if treatment in ("tilt", "all"):
            scan = scan.with_heights(scan.heights + 20 * rq * np.linspace(0, 1, 256)[:, None])
        if treatment in ("noise", "all"):
            scan = with_noise(scan, rms=0.02 * rq, seed=seed)
        if treatment in ("missing", "all"):
            scan = with_missing(scan, share=0.05, seed=seed)
        fit = fit_fractal(scan)
        error.append((fit.D - 2.5) / ((fit.D_interval[1] - fit.D) / 1.96))
    # standard scores: mean of six within 3.5/6^.5
    assert abs(np.mean(error)) < 1.43
    assert np.max(np.abs(error)) < 4


def test_white_noise_is_measured():
    scan = with_noise(spectral((512, 512), spacing=1e-6, D=2.3, Rq=1e-6, seed=1), rms=3e-8)
    assert fit_fractal(scan).noise == pytest.approx(3e-8, rel=0.1)


@pytest.mark.parametrize("gamma", [1.5, 2.0])
def test_a_weierstrass_mandelbrot_surface_gives_its_D_and_G(gamma):
    scan = weierstrass_mandelbrot((512, 512), spacing=1e-6, D=2.4, G=G, gamma=gamma, seed=1)
    fit = fit_fractal(scan)
    assert pytest.approx(2.4, abs=0.07) == fit.D
    assert fit.G_interval[0] < G < fit.G_interval[1]
    assert any("lines" in w for w in fit.warnings)


def test_a_profile_across_and_a_cut_from_a_surface_differ_by_the_cut_factor():
    # many lines of one isotropic surface: their own G is below the surface's by the factor that the text states
    D = 2.5
    scan = spectral((512, 512), spacing=1e-6, D=D, G=G, seed=3)
    fits = [fit_fractal(scan.profile("x", i)) for i in range(0, 512, 8)]
    levels = [(2 * f.D - 4) * np.log(f.G) - (7 - 2 * f.D) * np.log(5e4) for f in fits if f.G > 0]
    own = (2 * D - 4) * np.log(G) - (7 - 2 * D) * np.log(5e4)
    assert np.mean(levels) - own == pytest.approx(np.log(cut_factor(D)), abs=0.15)
    assert "G of the profile itself" in fits[0].convention
    assert "power summed over all directions" in fit_fractal(scan).convention


@settings(max_examples=10, deadline=None)
@given(scale=st.floats(1e-2, 1e2), length=st.floats(1e-2, 1e2))
def test_answers_have_no_unit(scale, length):
    a = spectral((96, 96), spacing=1e-6, D=2.5, G=G, seed=2)
    fa = fit_fractal(a)
    fb = fit_fractal(Scan(heights=a.heights * scale, spacing=(1e-6 * length, 1e-6 * length)))
    assert pytest.approx(fa.D, abs=1e-5) == fb.D
    # G^(D-2) scales with heights over length^(3-D)
    ratio = np.log(scale) / (fa.D - 2) - (3 - fa.D) / (fa.D - 2) * np.log(length)
    assert np.log(fb.G / fa.G) == pytest.approx(ratio, abs=1e-3)
    assert fb.implied_Rq == pytest.approx(fa.implied_Rq * scale, rel=1e-3)


def test_majumdar_bhushan_G_is_the_other_convention_s():
    scan = spectral((128, 128), spacing=1e-6, D=2.5, G=G, seed=2)
    a, b = fit_fractal(scan), fit_fractal(scan, convention="majumdar-bhushan")
    assert pytest.approx(np.log(1.5) ** (1 / (2 * a.D - 4)), rel=1e-9) == b.G / a.G
    assert b.implied_Rq == pytest.approx(a.implied_Rq, rel=1e-9)
    assert "Majumdar-Bhushan" in b.convention
    assert "Yan-Komvopoulos" in a.convention


def test_implied_roughness_and_the_paper_s_inconsistency():
    assert consistency(2.39, 1.53e-10, Rq=1.0e-6, length=4e-3)[0].startswith(
        "D and G imply Rq 3.28 um over 4 mm, the surface's own is 1 um"
    )
    assert not consistency(2.39, 1.53e-10, Rq=3.3e-6, length=4e-3)
    fit = fit_fractal(spectral((256, 256), spacing=1e-6, D=2.6, G=G, seed=1))
    assert fit.implied_Rq == pytest.approx(implied_Rq(fit.D, fit.G, 256e-6))


def test_a_band_is_kept_to_and_checked():
    scan = spectral((256, 256), spacing=1e-6, D=2.5, G=G, seed=1)
    fit = fit_fractal(scan, band=(6e-6, 3e-5))
    assert 6e-6 <= fit.band[0] < fit.band[1] <= 3e-5
    for band in ((1e-6, 1e-5), (1e-5, 1e-3), (2e-5, 2e-5)):
        with pytest.raises(InputError, match="twice the spacing"):
            fit_fractal(scan, band=band)


@pytest.mark.parametrize("method", METHODS)
def test_every_method_answers_for_scans_and_profiles(method):
    for scan in (
        spectral((256, 256), spacing=1e-6, D=2.5, G=G, seed=1),
        spectral(2048, spacing=1e-6, D=2.5, G=G, seed=1),
    ):
        fit = fit_fractal(scan, method)
        assert isinstance(fit, FractalFit)
        assert fit.method == method
        assert 2 < fit.D < 3
        assert 0 <= fit.G_interval[0] <= fit.G <= fit.G_interval[1]


def test_errors_say_what_is_allowed():
    scan = spectral((64, 64), spacing=1e-6, D=2.5, G=G, seed=1)
    with pytest.raises(InputError, match='allowed: "psd", "structure"'):
        fit_fractal(scan, "wavelet")
    with pytest.raises(InputError, match=r"scan: an array of shape .*give a Scan or a Profile"):
        fit_fractal(scan.heights)
    with pytest.raises(InputError, match="every point is missing"):
        fit_fractal(scan.with_heights(np.full((64, 64), np.nan)))
    with pytest.raises(InputError, match="all heights are the same"):
        fit_fractal(scan.with_heights(np.ones((64, 64))))
    with pytest.raises(NotConverged, match="use method psd"):
        fit_fractal(spectral((20, 20), spacing=1e-6, D=2.5, G=G), "structure")
    texts = [f for f in fit_all(spectral((24, 24), spacing=1e-6, D=2.5, G=G)).values() if isinstance(f, str)]
    assert texts
    assert all(len(text) > 20 for text in texts)


def test_a_smooth_surface_is_called_not_fractal():
    y, x = np.mgrid[0:128, 0:128] * 1e-6
    hills = 1e-6 * np.sin(2e5 * x) * np.sin(1.7e5 * y) + 1e-12 * np.random.default_rng(0).normal(size=(128, 128))
    fit = fit_fractal(Scan(heights=hills, spacing=(1e-6, 1e-6)))
    assert fit.warnings


@pytest.mark.slow
def test_coverage_over_many_surfaces():
    rng = np.random.default_rng(8)
    inside = 0
    for k in range(120):
        D = rng.uniform(2.1, 2.7)
        low, high = fit_fractal(spectral((192, 192), spacing=1e-6, D=D, G=G, seed=k)).D_interval
        inside += low < D < high
    # 95 % of 120 is 114; below 106 or above 119 has a probability of a few in a thousand
    assert 106 <= inside <= 119


def test_the_theory_page_states_the_bias_that_each_estimator_declares():
    page = (Path(__file__).parents[2] / "docs" / "theory" / "surface.md").read_text()
    rows = {cells[1].strip(): cells[-2].strip() for line in page.splitlines() if len(cells := line.split("|")) == 6}
    assert {name: rows[name] for name in METHODS if name != "psd"} == {
        name: entry.bias for name, entry in ESTIMATORS.items() if name != "psd"
    }
    assert METHODS[0] == "psd"  # the default


@pytest.mark.parametrize("D", [pytest.param(2.2, marks=pytest.mark.slow), 2.41])
def test_a_plateau_of_long_waves_is_not_taken_for_the_power_law(D):
    # 4.1 mm with a roll-off at 60 um: the plateau is the wider band, the power law lies beyond it
    scan = spectral((1640, 1640), spacing=2.5e-6, D=D, Rq=1e-6, longest=60e-6, seed=1)
    fit = fit_fractal(scan)
    assert fit.D == pytest.approx(D, abs=0.03)
    assert fit.D_interval[0] < D < fit.D_interval[1]
    assert fit.band[1] < 65e-6
    told = next(w for w in fit.warnings if "roll-off at about" in w)
    assert parse(told.split("about ")[1].split(";")[0], "m") == pytest.approx(60e-6, rel=0.05)


def test_the_roll_off_of_a_profile_is_found():
    fit = fit_fractal(spectral(2**15, spacing=1e-6, D=2.4, Rq=1e-6, longest=100e-6, seed=3))
    assert fit.D_interval[0] < 2.4 < fit.D_interval[1]
    told = next(w for w in fit.warnings if "roll-off at about" in w)
    assert parse(told.split("about ")[1].split(";")[0], "m") == pytest.approx(100e-6, rel=0.1)


def test_a_plateau_without_a_power_law_beyond_it_is_called_one():
    # the roll-off lies at three times the shortest usable wavelength: too few waves beyond it
    fit = fit_fractal(spectral((820, 820), spacing=5e-6, D=2.41, Rq=1e-6, longest=60e-6, seed=0))
    assert any("plateau of the spectrum and no band of shorter waves" in w for w in fit.warnings)
