"""The report in a real browser: tables linked with the view, curves that zoom, paper, no scripts, hostile names."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from faying.output import report
from faying.output import report as curves
from faying.result import Provenance, Receptance
from tests.helpers.backbones import made
from tests.helpers.browser import opened, until
from tests.helpers.scenes import two_boxes
from tests.output.test_scene import array

HOSTILE = '</script><script>window.hurt=1</script><img src=x onerror="window.hurt=2"><!--'
LINES = np.linspace(10.0, 400.0, 391)


def one_mass():
    """The receptance of one mass on a spring at two loads, at one point."""
    square = (2 * np.pi * np.array([[100.0], [110.0]])) ** 2
    values = 1 / (3.0 * (square * (1 + 0.02j) - (2 * np.pi * LINES) ** 2))
    return Receptance(
        frequencies=LINES,
        values=values[:, :, None, None],
        error=np.zeros(2),
        input_points=np.zeros((1, 3)),
        input_directions=np.array([[0.0, 0.0, 1.0]]),
        output_points=np.zeros((1, 3)),
        output_directions=np.array([[0.0, 0.0, 1.0]]),
    )


@pytest.fixture(scope="module")
def result():
    known = Provenance(
        study='title = "two boxes"',
        files={"a.step": "0" * 64},
        versions={"faying": "0.1.0"},
        date="2026-01-02T03:04:05",
    )
    return two_boxes(response=one_mass(), provenance=known)


@pytest.fixture(scope="module")
def address(result, tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    report.write(result, folder)
    return (folder / "report.html").as_uri()


@pytest.fixture
def page(browser, address):
    with opened(browser, address, reduced_motion="reduce") as page:
        until(page, "window.ready")
        yield page


def test_rows_of_modes_and_joints_lead_to_what_is_shown(page, result):
    page.locator("[data-table=modes] tr").nth(3).get_by_role("button").first.click()
    until(page, "window.view.state.mode === 2")
    page.locator("[data-table=modes] tr").nth(2).get_by_role("button").nth(1).click()  # the first preload
    until(page, "window.view.state.mode === 1 && window.view.state.load === 0")
    # the text comes once the mode's shape is unpacked, after the state
    until(page, "document.querySelector('.fv-head').textContent.includes('Mode 2: 250 Hz')")
    until(page, "document.querySelector('[data-table=modes] tr.now').cells[0].textContent === '2'")
    page.get_by_label("Mode", exact=True).select_option("0")
    until(page, "document.querySelector('[data-table=modes] tr.now').cells[0].textContent === '1'")
    page.locator("[data-table=joints] tr").nth(2).get_by_role("button").click()
    until(page, "window.view.state.field === 'pressure' && window.view.state.load === 1")
    assert page.evaluate("window.view.highlighted.length") == 2


def test_the_page_says_what_it_was_made_from(page):
    text = page.locator("body").inner_text()
    for part in ('title = "two boxes"', "0" * 64, "2026-01-02", "flange", "kg", "Faying 0.1.0"):
        assert part in text


def test_curves_zoom_by_mouse_and_keyboard_and_both_together(page):
    charts = page.locator("[data-curves] .fc > svg")
    assert charts.count() == 2
    ends = (
        "[...document.querySelectorAll('[data-curves] .fc > svg')].map((s) =>"
        " [...s.querySelectorAll('text')].map((t) => t.textContent).join(' '))"
    )
    charts.first.scroll_into_view_if_needed()
    before = page.evaluate(ends)
    box = charts.first.bounding_box()
    page.mouse.move(box["x"] + 0.2 * box["width"], box["y"] + 60)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 60)
    page.mouse.up()
    after = page.evaluate(ends)
    assert after[0] != before[0]
    assert after[1] != before[1]
    assert " 400 " not in after[0]
    charts.first.focus()
    page.keyboard.press("Escape")
    assert page.evaluate(ends) == before
    page.keyboard.press("+")
    assert page.evaluate(ends)[0] != before[0]


@pytest.mark.slow
def test_backbones_zoom_over_amplitude_on_a_logarithmic_axis(browser, result, tmp_path):
    curves = (
        made(frequency=lambda a: 100 - a, damping=lambda a: 1e-3 * a),
        replace(made(frequency=90.0, damping=0.01), friction=(0.4,)),
    )
    (tmp_path / "report.html").write_text(report.html(replace(result, backbones=curves)), encoding="utf-8")
    with opened(browser, (tmp_path / "report.html").as_uri(), reduced_motion="reduce") as page:
        until(page, "window.ready")
        place = page.locator("[data-curves=backbones]")
        charts = place.locator(".fc > svg")
        assert charts.count() == 2
        seen = [float(text) for text in charts.first.locator("text").all_text_contents()[:7]]
        assert seen == [0.1, 0.2, 0.5, 1, 2, 5, 10]  # 0.1 to 20 m/s2
        key = place.locator(".fc-key").first.inner_text()
        assert "friction 0.2" in key
        assert "friction 0.4" in key
        # the middle of the axis is the geometric mean, and the curve is read there
        charts.first.scroll_into_view_if_needed()
        box = charts.first.bounding_box()
        page.mouse.move(box["x"] + box["width"] * (62 + (box["width"] - 74) / 2) / box["width"], box["y"] + 60)
        read = re.search(r"friction 0.2: ([\d.]+) at ([\d.]+)", place.locator(".fc-key").first.inner_text())
        assert float(read[2]) == pytest.approx(np.sqrt(0.1 * 20), rel=0.03)
        assert float(read[1]) == pytest.approx(100 - float(read[2]), rel=1e-3)
        charts.first.focus()
        page.keyboard.press("+")
        assert charts.nth(1).locator("text").first.text_content() != "0.1"  # both charts zoom
        assert page.locator("figure.of-backbones").is_hidden()
        assert page.locator("h3", has_text="Error bounds of mode 1 over amplitude").count() == 2


@pytest.mark.slow
def test_measured_points_are_marked_on_the_curves_of_a_backbone(browser, result, tmp_path):
    points = {"measured_acceleration": [0.5, 5.0, 40.0], "measured_frequency": [98.0, 95.0, 80.0]}
    curve = replace(made(frequency=lambda a: 100 - a, damping=0.01), **points, measured_damping=[0.01, np.nan, 0.02])
    curve = replace(curve, measured_source="points.csv")
    (tmp_path / "report.html").write_text(report.html(replace(result, backbones=(curve,))), encoding="utf-8")
    with opened(browser, (tmp_path / "report.html").as_uri(), reduced_motion="reduce") as page:
        until(page, "window.ready")
        charts = page.locator("[data-curves=backbones] .fc")
        circles = [charts.nth(k).locator("svg svg path").nth(1).get_attribute("d").count("a3.5") / 2 for k in (0, 1)]
        assert circles == [3, 2]  # damping was measured at two of them
        assert "measured (points.csv)" in charts.first.locator(".fc-key").inner_text()
        assert page.locator("h3", has_text="Measured points against mode 1").count() == 1


def test_the_packed_curves_are_the_accelerance(result):
    (group,) = curves.response_curves(result)
    np.testing.assert_allclose(array(group["frequencies"]), LINES, rtol=1e-6)
    both = array(group["values"])
    wanted = -((2 * np.pi * LINES) ** 2) * result.response.values[:, :, 0, 0]
    np.testing.assert_allclose(both[:, 0] + 1j * both[:, 1], wanted, rtol=1e-5)
    assert group["names"] == ["2 kN", "8 kN"]


def test_on_paper_and_without_scripts_the_pictures_stand(browser, address, page):
    pictures = page.locator("figure.static, figure.of-response")
    assert pictures.count() == 2
    assert not pictures.first.is_visible()
    page.emulate_media(media="print")
    assert all(pictures.nth(k).is_visible() for k in range(2))
    assert not page.locator("#stage").is_visible()
    with opened(browser, address, java_script_enabled=False) as still:
        pictures = still.locator("figure.static, figure.of-response")
        assert all(pictures.nth(k).is_visible() for k in range(2))
        assert "the pictures below replace it" in still.locator("#why").inner_text()


def test_without_webgl_the_pictures_stand(browser, address):
    with opened(browser, "about:blank") as page:
        page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
        page.goto(address)
        until(page, "window.ready")
        assert "WebGL 2 is not available" in page.locator("#why").inner_text()
        assert page.locator("figure.static").first.is_visible()
        assert page.locator("[data-curves] svg").count() > 0


@pytest.mark.parametrize(("width", "scale", "scheme"), [(1280, 1, "light"), (800, 1, "dark"), (640, 2, "light")])
def test_the_page_fits_its_window(browser, address, width, scale, scheme):
    with opened(browser, address, width=width, device_scale_factor=scale, color_scheme=scheme) as page:
        until(page, "window.ready")
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        dark = page.evaluate("getComputedStyle(document.body).backgroundColor") != "rgb(255, 255, 255)"
        assert dark == (scheme == "dark")


def test_hostile_names_stay_text(browser, tmp_path, result):
    known = replace(result.provenance, study=HOSTILE, files={HOSTILE: "0" * 64})
    found = two_boxes(
        title=HOSTILE,
        names=(HOSTILE,),
        parts=(HOSTILE, "b"),
        bolts=(HOSTILE,),
        provenance=known,
        sources=(HOSTILE,),
        solver=HOSTILE,
        response=one_mass(),
    )
    text = report.html(found)
    (tmp_path / "a.html").write_text(text, encoding="utf-8")
    assert len(re.findall("<script", text)) == 3  # two of data, one that runs
    assert json.loads(re.search('id="scene">(.*?)</script>', text, re.S).group(1))["title"] == HOSTILE
    with opened(browser, (tmp_path / "a.html").as_uri()) as page:
        until(page, "window.ready")
        assert page.evaluate("window.hurt") is None
        assert page.title() == HOSTILE
        assert page.evaluate("[...document.images].every((i) => i.src.startsWith('data:'))")


def test_a_report_is_small(address):
    from pathlib import Path
    from urllib.parse import urlparse

    assert Path(urlparse(address).path).stat().st_size < 2e6
