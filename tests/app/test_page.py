"""The page in a real browser: from files to a result."""

import json
import re
import shutil
from contextlib import contextmanager

import numpy as np
import pytest

from faying.setup import template
from faying.surface.files.write import write_scan
from faying.surface.synthesize import spectral
from tests.helpers.browser import WAIT, opened, until
from tests.helpers.laps import lapped


@pytest.fixture(scope="module")
def example(tmp_path_factory):
    folder = tmp_path_factory.mktemp("example")
    study = folder / "study.toml"
    template.write(study)
    (folder / "surface.x3p").unlink()  # of 640 x 640 points; each page reads, draws and fits it
    write_scan(spectral((128, 128), spacing=5e-6, D=2.2, Rq=1e-6, longest=1e-4, seed=7), folder / "surface.x3p")
    text = study.read_text().replace('model = "auto"', 'model = "jk"').replace('["8 kN", "15 kN"]', '"6 kN"')
    text = text.replace("[modes]\n", "[modes]\nlevels = []\nintervals = false\n")
    text = re.sub("(?m)^(scan|counter) = .*\n", "", text)  # no contact to solve: D and G in place of the scan
    study.write_text(text.replace("[surface]\n", '[surface]\nD = 2.39\nG = "1.53e-10 m"\nscan_area = "16 mm^2"\n'))
    return folder


def page_at(browser, server, **how):
    origin = server.address.rsplit("/", 2)[0]
    return opened(browser, server.address, allowed=(origin, "data:", "blob:"), **how)


def set_text(page, text):
    page.fill("#text", text)
    until(page, "document.querySelector('#saved').textContent === 'saved'")


@pytest.mark.slow
def test_a_scan_is_dropped_and_read(browser, server, example, tmp_path):
    with page_at(browser, server) as page:
        page.set_input_files("#file", example / "surface.x3p")
        page.wait_for_selector("#scan-picture:not([hidden])")
        facts = page.inner_text("#scan-facts")
        assert "128 x 128" in facts
        assert "psd" in facts
        width = page.evaluate("document.querySelector('#scan-picture img').naturalWidth")
        assert width > 400
    assert (tmp_path / "surface.x3p").read_bytes() == (example / "surface.x3p").read_bytes()


@pytest.mark.slow
def test_a_scan_without_units_asks_for_them_and_takes_them(browser, server, tmp_path):
    heights = spectral((64, 64), spacing=1e-6, D=2.3, Rq=1e-7, longest=3e-5, seed=1).heights * 1e9
    rows = [f"{x} {y} {height:.3f}" for (y, x), height in np.ndenumerate(heights)]
    (tmp_path / "plain.xyz").write_text("\n".join(rows))
    with page_at(browser, server) as page:
        page.wait_for_selector("#scan-units:not([hidden])")
        assert "unit" in page.inner_text("#scan-fault")
        page.fill("#xy-unit", "um")
        page.fill("#z-unit", "nm")
        page.click("#scan-again")
        page.wait_for_selector("#scan-picture:not([hidden])")
        assert "64 x 64" in page.inner_text("#scan-facts")
        assert page.is_hidden("#scan-fault")


def test_faces_are_picked_into_a_joint(browser, server, example, tmp_path):
    shutil.copy(example / "two-blocks.step", tmp_path)
    with page_at(browser, server) as page:
        page.click("#tab-structure")
        until(page, "window.fayingView !== undefined")
        page.evaluate("window.fayingView.select('upper', 1)")
        page.evaluate("window.fayingView.select('lower', 2)")
        page.wait_for_selector("#picks li:nth-child(2)")
        picked = page.inner_text("#picks")
        assert "mm²" in picked
        page.click("#make-joint")
        assert page.input_value("#text").count("[[joint]]") == 1
        assert page.inner_text("#picks") == ""
        until(page, "document.querySelector('#saved').textContent === 'saved'")
    assert "[[joint]]" in (tmp_path / "study.toml").read_text()


@pytest.mark.slow  # test_from_the_text_alone_to_a_result runs a smaller study
def test_from_a_step_file_without_names_and_a_scan_to_a_result(browser, server, example, tmp_path_factory, tmp_path):
    """The newcomer's whole session: two files are dropped, nothing is typed."""
    given = tmp_path_factory.mktemp("given")
    lapped(given / "lap.step", size=(60, 30), holes=((15, 15), (45, 15)))
    with page_at(browser, server) as page:
        page.set_input_files("#file", [example / "surface.x3p", given / "lap.step"])
        until(page, "window.fayingView !== undefined")
        page.click("#propose")
        until(page, "document.querySelector('#text').value.includes('[[bolt]]')")
        study = page.input_value("#text")
        assert study.count("[[bolt]]") == 2
        assert study.count("[[joint]]") == 1
        assert 'scan = "surface.x3p"' in study
        until(page, "document.querySelector('#check-hint').textContent === 'no fault'")
        page.click("#tab-run")
        assert "joint" in page.inner_text("#findings")
        page.click("#start")
        page.wait_for_selector("#report:not([hidden])", timeout=5 * WAIT)
        page.frame_locator("#report").get_by_role("heading", name="Modes at every preload", exact=True).wait_for()
        links = page.locator("#links a").all_inner_texts()
        assert {"result.nc", "modes.csv", "report.html"} <= set(links)
    assert (tmp_path / "results" / "result.nc").is_file()


@pytest.mark.slow
def test_from_the_text_alone_to_a_result(browser, server, example, tmp_path):
    """In an empty folder a STEP file is added, the study is typed, its fault mended by what the page says, and run."""
    typed = (example / "study.toml").read_text()
    wrong = typed.replace('preload = "6 kN"', 'preload = "6 kNm"')
    assert wrong != typed
    with page_at(browser, server) as page:
        page.wait_for_selector("#steps:not([hidden])")
        page.set_input_files("#file", example / "two-blocks.step")
        until(page, "window.fayingView !== undefined")
        set_text(page, wrong)
        until(page, "document.querySelectorAll('#faults li').length > 0")
        assert "preload" in page.inner_text("#faults")
        set_text(page, typed)
        until(page, "document.querySelector('#check-hint').textContent === 'no fault'")
        page.click("#tab-run")
        page.click("#start")
        page.wait_for_selector("#report:not([hidden])", timeout=5 * WAIT)
        page.frame_locator("#report").get_by_role("heading", name="Modes at every preload", exact=True).wait_for()
    assert (tmp_path / "study.toml").read_text() == typed
    assert (tmp_path / "results" / "result.nc").is_file()


def test_faults_stand_at_their_lines_and_go(browser, server, example, tmp_path):
    for name in ("study.toml", "two-blocks.step"):
        shutil.copy(example / name, tmp_path)
    good = (tmp_path / "study.toml").read_text()
    lines = good.splitlines()
    at = next(k for k, line in enumerate(lines) if line.startswith("preload"))
    lines[at] = "preload = 6000"
    with page_at(browser, server) as page:
        set_text(page, "\n".join(lines))
        until(page, "document.querySelectorAll('#faults li').length > 0")
        assert f"line {at + 1}" in page.inner_text("#faults")
        assert 'such as "12 kN"' in page.inner_text("#faults") or "unit" in page.inner_text("#faults")
        assert page.inner_text("#gutter b") == str(at + 1)
        page.click("#faults button")
        chosen = "document.querySelector('#text').value.slice(...['selectionStart', 'selectionEnd']"
        assert page.evaluate(chosen + ".map((end) => document.querySelector('#text')[end]))") == "preload = 6000"
        set_text(page, good)
        until(page, "document.querySelector('#check-hint').textContent === 'no fault'")
        assert page.locator("#gutter b").count() == 0


@contextmanager
def waiting(page):
    """The page loaded anew, the answer to its first question held back to the end."""
    held = []
    page.route("**/api/project*", lambda route: held.append(route), times=1)
    page.reload()
    while not held:
        page.wait_for_timeout(20)
    answer = held[0].fetch()
    yield
    held[0].fulfill(response=answer)


def test_a_view_that_was_chosen_stays_when_the_project_comes(browser, server, example, tmp_path):
    for name in ("study.toml", "two-blocks.step"):  # of itself the page opens the structure
        shutil.copy(example / name, tmp_path)
    with page_at(browser, server) as page:
        until(page, "document.querySelector('#tab-structure').ariaSelected === 'true'")
        with waiting(page):
            page.click("#tab-run")
        until(page, "document.querySelector('#text').value.length > 0")
        assert page.is_visible("#run")
        assert page.is_hidden("#structure")


@pytest.mark.slow
def test_an_answer_that_comes_late_does_not_replace_a_newer_one(browser, server, example):
    with page_at(browser, server) as page:
        with waiting(page):
            with page.expect_response("**/api/file*"):
                page.set_input_files("#file", example / "surface.x3p")
            until(page, "document.querySelector('#status').textContent === ''")
        page.wait_for_selector("#scan-picture:not([hidden])")
        assert page.input_value("#scans") == "surface.x3p"


@pytest.mark.slow
def test_nothing_is_typed_before_the_study_is_there(browser, server, example, tmp_path):
    shutil.copy(example / "study.toml", tmp_path)
    with page_at(browser, server) as page:
        with waiting(page):
            assert not page.is_editable("#text")
        set_text(page, (tmp_path / "study.toml").read_text() + "# mine\n")
    assert (tmp_path / "study.toml").read_text().endswith("# mine\n")


def test_a_run_is_cancelled_and_leaves_nothing(browser, server, example, tmp_path):
    for name in ("study.toml", "surface.x3p", "two-blocks.step"):
        shutil.copy(example / name, tmp_path)
    with page_at(browser, server) as page:
        page.click("#tab-run")
        page.click("#start")
        until(page, "document.querySelector('#job-line').textContent.includes(' of ')")
        page.click("#cancel")
        until(page, "document.querySelector('#job-line').textContent.includes('cancelled')")
        assert page.is_enabled("#start")
    assert not (tmp_path / "results").exists()
    assert not list(tmp_path.glob("*.part"))


@pytest.mark.slow
def test_closing_the_page_loses_nothing(browser, server, example, tmp_path):
    for name in ("study.toml", "surface.x3p", "two-blocks.step"):
        shutil.copy(example / name, tmp_path)
    with page_at(browser, server) as page:
        set_text(page, (example / "study.toml").read_text().replace("Two blocks", "Mine: two blocks"))
        page.click("#tab-run")
        page.click("#start")
        until(page, "document.querySelector('#job-line').textContent.includes(' of ')")
    with page_at(browser, server) as page:  # the run went on
        until(page, "document.querySelector('#text').value.includes('Mine: two blocks')")
        page.wait_for_selector("#report:not([hidden])")
        assert "Mine" in page.frame_locator("#report").locator("h1").inner_text()


def test_scripts_in_names_and_texts_are_inert(browser, server, example, tmp_path):
    for name in ("surface.x3p", "two-blocks.step"):
        shutil.copy(example / name, tmp_path)
    evil = "<img src=x onerror=alert(1)></script><script>alert(2)</script>"
    text = (example / "study.toml").read_text().replace("Two blocks and a bolt", evil)
    (tmp_path / "<img src=x onerror=alert(3)>.x3p").write_bytes(b"")
    (tmp_path / "study.toml").write_text(text.replace('name = "joint"', f"name = '{evil}'"))
    with page_at(browser, server) as page:
        said = []
        page.on("dialog", lambda dialog: (said.append(dialog.message), dialog.dismiss()))
        page.click("#tab-structure")
        until(page, "window.fayingView !== undefined")
        assert page.locator("#scans option").all_inner_texts() == ["<img src=x onerror=alert(3)>.x3p", "surface.x3p"]
        page.click("#tab-run")
        until(page, "document.querySelectorAll('#findings li').length > 0")
        assert page.locator("#findings img, #view img").count() == 0
        assert evil in page.inner_text("#view")
        assert said == []


def test_the_report_in_the_page_cannot_ask_the_server(browser, server, example, tmp_path):
    (tmp_path / "results").mkdir()
    script = (
        "fetch('../api/project').then(r => r.text()).then(t => document.title = t, e => document.title = 'refused')"
    )
    (tmp_path / "results" / "report.html").write_text(f"<!doctype html><h1>x</h1><script>{script}</script>")
    made = browser.new_context()
    page = made.new_page()
    page.goto(server.address + "results/report.html")
    until(page, "document.title !== ''")
    assert page.title() == "refused"
    made.close()


def test_keyboard_alone_reaches_every_view(browser, server, example, tmp_path):
    for name in ("study.toml", "surface.x3p", "two-blocks.step"):
        shutil.copy(example / name, tmp_path)
    with page_at(browser, server) as page:
        until(page, "document.querySelector('#text').value.length > 0")
        page.focus("#tab-surface")
        for name in ("structure", "form", "run", "result", "steps", "surface"):
            page.keyboard.press("ArrowRight")
            assert page.evaluate("document.activeElement.id") == f"tab-{name}"
            assert page.is_visible(f"#{name}")
        page.focus("#text")
        page.keyboard.press("Control+End")
        page.keyboard.type("# typed")
        page.keyboard.press("Control+s")
        until(page, "document.querySelector('#saved').textContent === 'saved'")
    assert (tmp_path / "study.toml").read_text().endswith("# typed")


@pytest.mark.slow
def test_nothing_is_cut_off(browser, server, example, tmp_path):
    for name in ("study.toml", "surface.x3p", "two-blocks.step"):
        shutil.copy(example / name, tmp_path)
    with page_at(browser, server) as page:
        until(page, "document.querySelectorAll('#groups fieldset').length > 5")
        for width, height in ((1280, 800), (800, 600), (640, 400)):  # the last: 1280 at 200 % zoom
            page.set_viewport_size({"width": width, "height": height})
            for name in ("structure", "form", "run", "result", "surface", "steps"):
                page.click(f"#tab-{name}")
                assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), name
            for button in page.locator("button:visible").all():
                box = button.bounding_box()
                assert box["x"] >= 0
                assert box["x"] + box["width"] <= width


def test_a_server_that_is_gone_is_said_and_the_text_stays(browser, server, example, tmp_path):
    (tmp_path / "study.toml").write_text('title = "x"\n')
    made = browser.new_context()
    page = made.new_page()
    page.goto(server.address)
    until(page, "document.querySelector('#text').value.length > 0")
    page.route("**/api/**", lambda route: route.abort())
    page.fill("#text", 'title = "precious"')
    page.wait_for_selector("#lost:not([hidden])", timeout=WAIT)
    assert "precious" in page.input_value("#text")
    made.close()


def test_the_page_does_what_the_command_line_does(server, example, tmp_path):
    """The answers are those of the commands, word for word."""
    from faying.app.commands import answer

    shutil.copy(example / "surface.x3p", tmp_path)
    found = answer(["surface", "surface.x3p"], tmp_path)
    assert found["points"] == [128, 128]
    assert json.dumps(found)


@pytest.mark.slow
def test_the_first_screen_leads_and_the_example_opens_in_one_click(browser, server, tmp_path):
    with page_at(browser, server) as page:
        until(page, "document.querySelector('#step-surface').textContent.includes('Missing: a scan')")
        assert "Missing: a STEP file or a mesh" in page.inner_text("#step-structure")
        assert page.inner_text("#next") == "Next: add a scan, or open the small example."
        page.click("#try")
        until(page, "window.fayingView !== undefined")
        assert (tmp_path / "study.toml").is_file()
        page.click("#tab-steps")
        until(page, "document.querySelector('#next').textContent === 'Next: run the study.'")
        assert page.get_attribute("#step-surface", "class") == "done"
        assert page.get_attribute("#step-run", "class") == "now"
        assert page.is_hidden("#offer")
        page.click("#step-run button")
        page.select_option("#command", "identify")
        assert "Needs [test]" in page.inner_text("#needs")


def test_an_upload_asks_before_it_replaces_the_study(browser, server, tmp_path):
    (tmp_path / "study.toml").write_text('title = "precious"\n')
    new = {"name": "study.toml", "mimeType": "text/plain", "buffer": b'title = "new"\n'}
    with page_at(browser, server) as page:
        until(page, "document.querySelector('#text').value.length > 0")
        asked = []
        page.once("dialog", lambda dialog: (asked.append(dialog.message), dialog.dismiss()))
        page.set_input_files("#file", new)
        until(page, "document.querySelector('#status').textContent === ''")
        assert asked == ["Replace study.toml? Its text is lost."]
        assert "precious" in (tmp_path / "study.toml").read_text()
        page.once("dialog", lambda dialog: dialog.accept())
        page.set_input_files("#file", new)
        until(page, "document.querySelector('#text').value.includes('new')")
    assert "new" in (tmp_path / "study.toml").read_text()


def test_keys_are_explained_completed_and_coloured(browser, server, tmp_path):
    (tmp_path / "study.toml").write_text('# mine\n[modes]\ncount = 3\n\n[[bolt]]\npreload = "2 kN"\n')
    offers = "[...document.querySelector('#keys').options].map((one) => one.value)"
    with page_at(browser, server) as page:
        with waiting(page):
            until(page, f"{offers}.includes('modes')")
        until(page, f"!{offers}.includes('modes')")  # the caret is at the end, in [[bolt]]
        page.evaluate(
            "(at => { const t = document.querySelector('#text'); t.focus(); t.setSelectionRange(at, at) })(20)"
        )
        page.keyboard.press("ArrowRight")
        assert page.inner_text("#help") == "modes.count: Number of elastic modes. Default: 10."
        offered = page.evaluate(offers)
        assert "solver" in offered
        assert "count" not in offered  # is there already
        page.keyboard.press("Control+Space")
        assert page.evaluate("document.activeElement.id") == "keys"
        page.select_option("#keys", "damping")
        assert "count = 3\ndamping = \n" in page.input_value("#text")
        assert 'Choices: "hysteretic", "viscous"' in page.inner_text("#help")
        spans = "[...document.querySelectorAll('#paint span')]"
        kinds = dict(page.evaluate(f"{spans}.map((one) => [one.textContent.trim(), one.className])"))
        assert kinds["# mine"] == "c"
        assert kinds["[modes]"] == "t"
        assert kinds["count"] == "k"
        assert kinds["3"] == "n"
        assert kinds['"2 kN"'] == "s"
        painted = page.evaluate("document.querySelector('#paint').textContent")
        assert painted.rstrip("\n") == page.input_value("#text").rstrip("\n")


@pytest.mark.slow
def test_a_fault_shows_while_it_is_typed(browser, server, example, tmp_path):
    """Before the text is saved, and without the check of the geometry."""
    for name in ("study.toml", "two-blocks.step"):
        shutil.copy(example / name, tmp_path)
    with page_at(browser, server) as page:
        until(page, "document.querySelector('#text').value.length > 0")
        page.route("**/api/check*", lambda route: None)  # never answered
        page.route("**/api/study*", lambda route: None)
        text = (tmp_path / "study.toml").read_text()
        page.fill("#text", text.replace("[modes]", "[modes]\ncuont = 3"))
        until(page, "document.querySelectorAll('#faults li').length === 1")
        assert "cuont" in page.inner_text("#faults")
        line = text.splitlines().index("[modes]") + 2
        assert page.inner_text("#gutter b") == str(line)
        page.unroute_all(behavior="ignoreErrors")
