"""A scan looked at closely: windows, means of groups, lines, and the page's map and curves of laws."""

import json
from base64 import b64decode
from zipfile import ZipFile

import numpy as np
import pytest

from faying.app.scans import MAX_LINE_POINTS, MAX_MAP_POINTS, MISSING, OpenScan, band_of, window_of
from faying.errors import InputError
from faying.surface.files.write import write_scan
from faying.surface.fractal import fit_fractal
from faying.surface.scan import Profile, Scan
from faying.surface.synthesize import spectral
from tests.app.test_page import page_at
from tests.app.test_server import ask
from tests.helpers.browser import until

WHOLE = (0.0, 0.0, 1.0, 1.0)


def heights_of(found):
    """What the bytes of a map say [m], NaN where missing."""
    levels = np.frombuffer(b64decode(found["data"]), np.uint8).reshape(found["height"], found["width"]).astype(float)
    levels[levels == MISSING] = np.nan
    return found["low"] + levels / (MISSING - 1) * (found["high"] - found["low"])


def wave(shape, spacing, waves=(3, 2)):
    """Whole waves along both sides, whose plane is nought by symmetry, on a tilted plane."""
    y, x = ((np.arange(n) + 0.5) / n for n in shape)
    ripple = np.cos(2 * np.pi * waves[0] * x)[None] * np.cos(2 * np.pi * waves[1] * y)[:, None]
    return 1e-6 * ripple, Scan(heights=1e-6 * ripple + 5e-6 * x[None] - 3e-6 * y[:, None], spacing=spacing)


def test_a_small_scan_is_shown_point_by_point_without_its_tilt():
    ripple, scan = wave((40, 60), (2e-6, 3e-6))
    found = OpenScan(scan).map(WHOLE)
    assert (found["width"], found["height"]) == (60, 40)
    assert found["window"] == pytest.approx([0, 0, 120e-6, 120e-6])
    step = (found["high"] - found["low"]) / (MISSING - 1)
    inside = np.abs(ripple) < 0.95 * found["high"]
    assert np.abs(heights_of(found) - ripple)[inside].max() <= 0.51 * step  # half a level of the bytes


def test_a_large_scan_is_shown_in_means_of_groups():
    rng = np.random.default_rng(3)
    scan = OpenScan(Scan(heights=rng.normal(size=(2 * MAX_MAP_POINTS, 3 * MAX_MAP_POINTS)), spacing=(1e-6, 1e-6)))
    found = scan.map(WHOLE)
    assert (found["width"], found["height"]) == (MAX_MAP_POINTS, MAX_MAP_POINTS)
    mean = scan.scan.heights.reshape(MAX_MAP_POINTS, 2, MAX_MAP_POINTS, 3).mean(axis=(1, 3))
    inside = (mean > found["low"]) & (mean < found["high"])
    assert np.abs(heights_of(found) - mean)[inside].max() <= 0.51 * (found["high"] - found["low"]) / (MISSING - 1)


def test_a_window_is_that_part_of_the_scan():
    ripple, scan = wave((40, 60), (2e-6, 3e-6))
    found = OpenScan(scan).map((0.5, 0.25, 0.75, 1.0))
    assert (found["width"], found["height"]) == (15, 30)
    assert found["window"] == pytest.approx([60e-6, 30e-6, 90e-6, 120e-6])
    part = ripple[10:, 30:45]
    inside = (part > found["low"]) & (part < found["high"])
    assert np.abs(heights_of(found) - part)[inside].max() < 0.02e-6
    tiny = OpenScan(scan).map((0.4, 0.4, 0.4001, 0.4001))
    assert (tiny["width"], tiny["height"]) == (1, 1)


def test_missing_points_are_missing_and_take_no_part_in_a_mean():
    values = np.zeros((2 * MAX_MAP_POINTS, 2 * MAX_MAP_POINTS))
    values[:4, :4] = np.nan  # two groups each way without a point
    values[10, 10] = np.nan  # one of four
    found = OpenScan(Scan(heights=values, spacing=(1e-6, 1e-6))).map(WHOLE)
    shown = heights_of(found)
    assert np.isnan(shown[:2, :2]).all()
    assert np.isnan(shown).sum() == 4
    assert np.nanmax(np.abs(shown)) < 1e-12


def test_a_line_keeps_every_peak():
    n = 10 * MAX_LINE_POINTS
    values = np.zeros((3, n))
    values[1, 4321], values[1, 8765] = 1.0, -2.0
    values[1, :20] = np.nan
    scan = OpenScan(Scan(heights=values, spacing=(1e-6, 2e-6)))
    found = scan.line("x", 0.5, WHOLE)
    assert len(found["along"]) <= MAX_LINE_POINTS
    got = dict(zip(found["along"], found["heights"], strict=True))
    row = scan.scan.heights[1]
    by_place = {round(1e7 * place): height for place, height in got.items()}
    assert by_place[43215] == row[4321]
    assert by_place[87655] == row[8765]
    assert found["heights"][0] is None
    assert found["at"] == pytest.approx(3e-6)


def test_lines_along_both_sides_within_a_window():
    ripple, scan = wave((40, 60), (2e-6, 3e-6))
    opened = OpenScan(scan)
    along = opened.line("y", 0.51, (0.0, 0.25, 1.0, 0.5))
    assert along["at"] == pytest.approx(30.5 * 2e-6)
    assert along["along"] == pytest.approx((np.arange(10, 20) + 0.5) * 3e-6)
    assert along["heights"] == pytest.approx(ripple[10:20, 30], abs=1e-12)


@pytest.fixture(scope="module")
def rough():
    return OpenScan(spectral((256, 256), spacing=2e-6, D=2.3, Rq=0.5e-6, longest=2e-4, seed=11))


def test_the_spectrum_has_the_power_of_the_heights(rough):
    """Parseval: the power over all radial frequencies is the mean square of the levelled heights."""
    found = rough.spectrum()
    f, power = 1 / np.array(found["wavelength"]), np.array(found["density"])
    assert np.trapezoid(power, f) == pytest.approx(np.mean(rough.scan.heights**2), rel=0.15)  # Hann window, corners


def test_a_band_is_fitted_as_the_command_fits_it(rough):
    found = rough.spectrum()["fit"]
    assert found["D_interval"][0] < 2.3 < found["D_interval"][1]
    band = (8e-6, 80e-6)
    narrow = rough.spectrum(band)["fit"]
    assert band[0] * 0.99 < narrow["band"][0] < narrow["band"][1] < band[1] * 1.01
    assert narrow["D"] == fit_fractal(rough.measured, band=band).D
    ends, law = np.array(narrow["band"]), np.array(narrow["law"])
    slope = np.diff(np.log(law)) / np.diff(np.log(ends))
    assert slope[0] == pytest.approx(7 - 2 * narrow["D"])  # S(f) = B f^-(7-2D)


@pytest.mark.parametrize(
    ("work", "said"),
    [
        (lambda scan: scan.map((0.5, 0, 0.5, 1)), "a window has"),
        (lambda scan: scan.map((float("nan"), 0, 1, 1)), "a window has"),
        (lambda scan: scan.line("z", 0.5, WHOLE), 'along = "z"'),
        (lambda scan: scan.line("x", 1.5, WHOLE), "at = 1.5"),
        (lambda scan: window_of("0,1,2"), "four numbers"),
        (lambda scan: band_of("1"), "two wavelengths"),
        (lambda scan: scan.spectrum((1e-3, 1e-2)), "band"),
        (lambda scan: OpenScan(Profile(heights=np.zeros(9), spacing=1e-6)), "a line scan has no map"),
    ],
)
def test_what_cannot_be_shown_is_said(work, said):
    with pytest.raises(InputError, match=said):
        work(OpenScan(wave((20, 24), (1e-6, 1e-6))[1]))


@pytest.fixture
def scanned(tmp_path):
    ripple, scan = wave((128, 192), (2e-6, 2e-6))
    write_scan(scan, tmp_path / "wave.x3p")
    return ripple


def test_the_server_gives_maps_and_lines(server, scanned):
    found = json.loads(ask(server, "api/map?name=wave.x3p&window=0,0,0.5,0.5")[1])
    assert (found["width"], found["height"]) == (96, 64)
    line = json.loads(ask(server, "api/line?name=wave.x3p&window=0,0,1,1&along=x&at=0.5")[1])
    assert line["heights"] == pytest.approx(scanned[64], abs=1e-9)
    for wrong in ("map?name=wave.x3p&window=x", "line?name=wave.x3p&window=0,0,1,1&along=x&at=y", "map?name=no.x3p"):
        assert "fault" in json.loads(ask(server, f"api/{wrong}")[1])


@pytest.mark.slow
def test_one_of_several_maps_of_heights_is_named_on_the_page(browser, server, tmp_path):
    """A container with heights of 1 and 3 um rms: the map that is named is read, drawn and looked at closely."""
    pytest.importorskip("SurfaceTopography", reason="reads containers")
    heights = spectral((64, 64), spacing=1e-6, D=2.3, Rq=1e-6, longest=3e-5, seed=1).heights * 1e6
    lines = ["surfaces:", "- name: one", "  topographies:"]
    with ZipFile(tmp_path / "two.zip", "w") as archive:
        for name, factor in {"low": 1, "high": 3}.items():
            file = f"    datafile: {{original: {name}.txt}}"
            lines += [f"  - name: {name}", file, "    unit: um", "    size: [64, 64]"]
            archive.writestr(f"{name}.txt", "\n".join(" ".join(map(str, factor * row)) for row in heights))
        archive.writestr("meta.yml", "\n".join(lines) + "\n")
    with page_at(browser, server) as page:
        page.wait_for_selector("#scan-units:not([hidden])")
        assert "holds 2 maps of heights" in page.inner_text("#scan-fault")
        page.fill("#channel", "high")
        page.click("#scan-again")
        page.wait_for_selector("#scan-picture:not([hidden])")
        page.wait_for_selector("#map:not([hidden])")
        assert "64 x 64" in page.inner_text("#scan-facts")
    low, high = (json.loads(ask(server, f"api/scan?name=two.zip&channel={one}")[1])["facts"] for one in ("low", "high"))
    assert high["roughness"]["Rq"] == pytest.approx(3 * low["roughness"]["Rq"], rel=0.05)  # spikes differ


LAWS = {
    "facts": {
        "pressure": {"unit": "Pa", "values": [1e5, 1e6, 1e7]},
        "laws": {
            "One": {
                "k_n": {"values": [1e12, 1e13, 1e14]},
                "area": {"values": [0.1, 0.2, 0.3]},
                "valid": [True, True, False],
            },
            "Two": {
                "k_n": {"values": [2e12, None, 3e14]},
                "area": {"values": [0.1, 0.2, 0.4]},
                "valid": [True, True, True],
            },
            "Three": {"area": {"values": [0.1, 0.2, 0.5]}, "valid": [True, True, True]},
        },
    }
}


@pytest.mark.slow
def test_a_map_zooms_and_laws_are_switched(browser, server, scanned):
    says, paths = (
        "document.querySelector('#map-says').textContent",
        "document.querySelectorAll('#laws-curves path').length",
    )
    with page_at(browser, server, width=800, height=900, color_scheme="dark") as page:
        page.route("**/api/laws*", lambda route: route.fulfill(json=LAWS))
        page.wait_for_selector("#map-line svg")
        assert "x 0 to 0.384 mm, y 0 to 0.256 mm" in page.evaluate(says)
        colours = (
            "new Set(document.querySelector('#map-canvas').getContext('2d').getImageData(0, 0, 200, 200).data).size"
        )
        assert page.evaluate(colours) > 50  # something is painted
        page.focus("#map-canvas")
        page.keyboard.press("+")
        until(page, f"{says}.includes('x 0.096 to 0.288 mm, y 0.064 to 0.192 mm')")
        page.keyboard.press("ArrowRight")
        until(page, f"{says}.includes('x 0.144 to 0.336 mm')")
        page.keyboard.press("-")
        until(page, f"{says}.includes('x 0 to 0.384 mm')")
        page.select_option("#map-along", "y")
        until(
            page, "document.querySelector('#map-line title').textContent.startsWith('Heights along y at x = 0.193 mm')"
        )
        assert page.is_disabled("#map-out")
        page.click("#show-laws")
        page.wait_for_selector("#laws-curves svg")
        boxes = page.locator("#laws-curves input")
        assert boxes.count() == 3
        assert boxes.nth(2).is_disabled()  # has no stiffness
        assert page.evaluate(paths) == 4  # where it is valid and where not; two sides of a gap
        assert page.locator("#laws-curves path.faint").count() == 1
        boxes.nth(0).uncheck()
        assert page.evaluate(paths) == 2
        page.select_option("#laws-curves select", "area")
        assert page.evaluate(paths) == 2
        assert "real area [%]" in page.inner_html("#laws-curves svg")
        page.get_by_role("button", name="None", exact=True).click()
        assert page.locator("#laws-curves svg").count() == 0
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


@pytest.mark.slow
def test_a_band_is_set_by_keys_and_taken_back(browser, server, rough, tmp_path):
    write_scan(rough.measured, tmp_path / "rough.x3p")
    says = "document.querySelector('#band-says').textContent"
    with page_at(browser, server) as page:
        page.wait_for_selector("#band:not([hidden])")
        until(page, f"{says}.includes('D = ')")
        first = page.evaluate(says)
        shown = rough.spectrum()["fit"]
        assert f"D = {shown['D']:.4g}"[:8] in first
        page.focus("#band-to")
        for _ in range(20):
            page.keyboard.press("ArrowLeft")
        until(page, f"{says}.includes('D = ') && {says} !== {json.dumps(first)}")
        assert page.get_attribute("#band-to", "aria-valuetext").endswith("µm")
        page.click("#band-auto")
        until(page, f"{says} === {json.dumps(first)}")
