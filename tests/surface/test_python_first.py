"""Scans, profiles and fits at a Python prompt: what they print, what they draw, what their numbers are."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.special import ellipe

import faying
from faying.surface.synthesize import spectral
from tests.helpers.imperfect import with_missing

SPACING = 1e-6


@pytest.fixture(scope="module")
def rough():
    return spectral((256, 192), spacing=SPACING, D=2.4, G=1e-10, seed=4)


@pytest.fixture(autouse=True)
def closed():
    import matplotlib.pyplot as plt

    yield
    plt.close("all")


def sheet(heights):
    return faying.Scan(heights=heights, spacing=(SPACING, SPACING))


def test_a_scan_prints_its_size_points_spacing_rms_height_and_source(rough):
    holes = with_missing(rough, share=0.01)
    text = str(holes)
    assert text == repr(holes)
    assert len(text.splitlines()) <= 12
    for part in (
        "192 um x 256 um",
        "192 x 256",
        "spacing  1 um",
        "492 of 49152 points",
        "spectral surface",
        "levelled",
    ):
        assert part in text
    assert f"Sq       {holes.Sq * 1e9:.4g} nm" in text


def test_heights_without_a_statistic_print_all_the_same():
    assert "all heights are the same" in str(sheet(np.zeros((20, 20))))
    assert "every point is missing" in str(sheet(np.full((20, 20), np.nan)))
    assert "at least 16" in str(sheet(np.eye(3)))


def test_html_holds_the_same_and_no_markup_of_the_user():
    heights = np.random.default_rng(1).normal(size=(20, 20)) * 1e-6
    scan = faying.Scan(heights=heights, spacing=(SPACING, SPACING), source="<b>x</b>")
    html = scan._repr_html_()
    assert html.startswith("<table>")
    assert "&lt;b&gt;x&lt;/b&gt;" in html
    assert "<b>x</b>" not in html


def test_everything_prints_a_dozen_lines_at_most(rough):
    line = rough.profile("x", 3)
    for shown in (rough, line, rough.fractal(), line.fractal(), rough.roughness(), line.roughness()):
        assert 2 <= len(str(shown).splitlines()) <= 12
        assert "<td" in shown._repr_html_()


def test_names_of_the_standards(rough):
    areal, line = rough.roughness(), rough.profile("x", 3).roughness()
    assert (rough.Sq, rough.Sa) == (areal.Sq, areal.Sa)
    # Gaussian heights
    assert areal.Sa / areal.Sq == pytest.approx((2 / np.pi) ** 0.5, rel=0.05)
    with pytest.raises(faying.InputError, match="Sq is a number of a scan"):
        _ = line.Sq
    with pytest.raises(faying.InputError, match="Rsk is a number of a profile"):
        _ = areal.Rsk


def test_developed_area_of_a_slope_and_of_waves_is_that_of_closed_forms():
    n = 401
    x = np.arange(n) * SPACING
    tilted = sheet(np.tile(0.7 * x, (n, 1)))
    assert tilted.roughness(degree=0).Sdr == pytest.approx((1 + 0.7**2) ** 0.5 - 1, rel=1e-9)
    both = sheet(0.7 * x + 0.4 * x[:, None])
    assert both.roughness(degree=0).Sdr == pytest.approx((1 + 0.7**2 + 0.4**2) ** 0.5 - 1, rel=1e-9)
    length, slope = 100 * SPACING, 1.5
    waves = slope * length / (2 * np.pi) * np.sin(2 * np.pi * x / length)
    # mean of sqrt(1 + slope^2 cos^2) is a complete elliptic integral
    exact = 2 / np.pi * ellipe(-(slope**2)) - 1
    assert sheet(np.tile(waves, (n, 1))).roughness(degree=0).Sdr == pytest.approx(exact, rel=1e-3)
    line = faying.Profile(heights=waves, spacing=SPACING)
    assert line.roughness(degree=0).Rdr == pytest.approx(exact, rel=1e-3)


def test_levelling_goes_in_a_chain(rough):
    holed = np.array(rough.heights)
    holed[50, 60] = np.nan
    x = np.arange(192) * SPACING
    clean = rough.with_heights(holed + 0.01 * x).levelled().filled()
    assert clean.missing == 0
    assert clean.Sq == pytest.approx(rough.Sq, rel=1e-3)
    assert clean.history[-2:] == ("levelled by a polynomial of degree 1", "1 missing points filled in")


def test_a_scan_draws_a_map_with_its_holes_and_a_spectrum(rough):
    holes = with_missing(rough, share=0.02)
    heights, power = holes.plot()
    drawn = heights.get_images()[0].get_array()
    assert np.ma.getmaskarray(drawn).sum() == holes.missing
    assert heights.get_xlabel() == "x [µm]"
    assert power.get_xlabel() == "frequency [1/m]"
    assert (power.get_xscale(), power.get_yscale()) == ("log", "log")
    own = list(Figure().subplots(1, 2))
    assert rough.plot(own) == own
    assert rough.profile("x", 3).plot(own)[0].get_ylabel().startswith("height [")
    with pytest.raises(faying.InputError, match="2 matplotlib axes"):
        rough.plot(own[0])


@pytest.mark.parametrize("convention", ["yan-komvopoulos", "majumdar-bhushan"])
def test_the_line_of_a_fit_lies_on_the_spectrum_in_both_conventions(rough, convention):
    fit = rough.fractal(convention=convention)
    lines = {line.get_label(): line for line in fit.plot().get_lines()}
    f, law = lines[f"psd, $D$ {fit.D:.3f}"].get_data()
    at, power = lines["spectrum"].get_data()
    inside = (at > f[0]) & (at < f[-1])
    ratio = power[inside] / np.exp(np.interp(np.log(at[inside]), np.log(f), np.log(law)))
    assert np.exp(np.log(ratio).mean()) == pytest.approx(1, abs=0.1)


def test_a_fit_of_two_scans_draws_their_summed_spectrum(rough):
    other = spectral((256, 192), spacing=SPACING, D=2.4, G=1e-10, seed=5)
    both = faying.combine(rough, other)
    lines = {line.get_label(): line for line in both.fit.plot().get_lines()}
    assert np.array_equal(lines["spectrum"].get_ydata(), both.density)


def test_lines_of_an_isotropic_surface_give_the_G_of_the_surface():
    """D and level of the mean over many lines; the scatter of one line is far larger than what is asked for here."""
    D, G = 2.4, 1e-10
    surface = spectral((512, 512), spacing=SPACING, D=D, G=G, seed=7)
    levels = {"own": [], "of the surface": []}
    for row in range(0, 512, 16):
        fit = surface.profile("x", row).fractal()
        f = (fit.band[0] * fit.band[1]) ** -0.5
        for name, value in (("own", fit.G), ("of the surface", fit.surface_G)):
            # ln of the spectral density that D and G state, over that of the surface
            level = (2 * fit.D - 4) * np.log(value) - (7 - 2 * fit.D) * np.log(f)
            levels[name].append(level - ((2 * D - 4) * np.log(G) - (7 - 2 * D) * np.log(f)))
    # a cut has the mean of |cos|^(6 - 2 D) over all directions of the power: by quadrature
    turn = (np.arange(100_000) + 0.5) * np.pi / 100_000
    share = np.mean(np.abs(np.cos(turn)) ** (6 - 2 * D))
    error = np.std(levels["own"]) / len(levels["own"]) ** 0.5
    assert error < 0.1
    assert np.mean(levels["own"]) == pytest.approx(np.log(share), abs=3 * error)
    assert np.mean(levels["of the surface"]) == pytest.approx(0, abs=3 * error)
    assert abs(np.log(share)) > 4 * error
    assert surface.fractal().surface_G == surface.fractal().G
