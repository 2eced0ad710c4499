"""The form in a real browser: beside the text, both ways, and from nothing typed in the text to a result."""

import shutil
import tomllib

import pytest

from tests.app.test_page import example, page_at, set_text  # noqa: F401
from tests.helpers.browser import WAIT, until

MOST_TABS = 150


def tab_to(page, name):
    """Go to a field as the keyboard does."""
    for _ in range(MOST_TABS):
        if page.evaluate("document.activeElement.id") == name:
            return
        page.keyboard.press("Tab")
    raise AssertionError(f"{name} is not reached in {MOST_TABS} steps")


def write(page, name, value):
    tab_to(page, f"field-{name}")
    page.keyboard.press("Control+A")
    page.keyboard.type(value)
    page.keyboard.press("Enter")


def opened_form(page):
    until(page, "document.querySelectorAll('#groups fieldset').length > 5")
    page.click("#tab-form")


def put(example, folder):  # noqa: F811
    for name in ("study.toml", "two-blocks.step"):
        shutil.copy(example / name, folder)
    return (folder / "study.toml").read_text()


@pytest.mark.slow
def test_from_the_form_alone_by_keyboard_alone_to_a_result(browser, server, example, tmp_path):  # noqa: F811
    text = put(example, tmp_path).replace('model = "jk"', 'model = "auto"')
    text = text.replace("levels = []\nintervals = false\n", "")
    (tmp_path / "study.toml").write_text(text)
    with page_at(browser, server) as page:
        until(page, "document.querySelectorAll('#groups fieldset').length > 5")
        before = page.input_value("#text")
        page.focus("#tab-structure")
        page.keyboard.press("ArrowRight")
        assert page.evaluate("document.activeElement.id") == "tab-form"
        write(page, "geometry.step", "two-blocks.step")  # as it is: nothing changes
        assert page.input_value("#text") == before
        write(page, "law.model", "jk")
        until(page, "document.getElementById('field-law.closure')")  # the keys of the law that was chosen
        write(page, "geometry.face_size.upper.joint", "8 mm")
        write(page, "bolt[1].preload", "6 kN, 9 kN")
        write(page, "modes.count", "3")
        page.keyboard.press("Tab")
        tab_to(page, "field-modes.damping")
        page.keyboard.press("Tab")
        page.keyboard.press("Enter")  # shows the other keys of the table
        tab_to(page, "field-modes.intervals")
        page.keyboard.type("f")
        until(page, "document.querySelector('#text').value.includes('count = 3')")
        until(page, "document.querySelector('#text').value.includes('intervals = false')")
        text = page.input_value("#text")
        gone = [line for line in before.splitlines() if line not in text.splitlines()]
        assert [line.split()[0] for line in gone] == [
            '"upper.joint"',
            "model",
            "preload",
            "count",
        ]  # all other lines and comments stay
        assert 'preload = ["6 kN", "9 kN"]            # one or more, in turn' in text
        until(page, "document.querySelector('#check-hint').textContent === 'no fault'")
        page.focus("#tab-form")
        page.keyboard.press("ArrowRight")
        tab_to(page, "start")
        page.keyboard.press("Enter")
        page.wait_for_selector("#report:not([hidden])", timeout=WAIT)
    assert (tmp_path / "study.toml").read_text() == text
    assert (tmp_path / "results" / "result.nc").is_file()


def test_text_and_form_follow_each_other(browser, server, example, tmp_path):  # noqa: F811
    good = put(example, tmp_path)
    with page_at(browser, server) as page:
        page.route("**/api/check*", lambda route: None)  # never answered: the faults are those of the text
        opened_form(page)
        count, box = "[id='field-modes.count']", "document.getElementById('field-modes.count')"
        set_text(page, good.replace("count = 6 ", "count = 4 "))
        until(page, f"{box}.value === '4'")
        page.fill(count, "many")
        page.press(count, "Enter")
        until(page, f"{box}.ariaInvalid === 'true'")
        assert "whole number" in page.inner_text("[id='field-modes.count-fault']")
        assert "whole number" in page.inner_text("#faults")
        page.click("#form-undo")
        until(page, f"{box}.value === '4' && {box}.ariaInvalid === null")
        assert page.is_disabled("#form-undo")
        page.fill(count, "5")
        page.press(count, "Enter")
        until(page, "!document.querySelector('#form-undo').disabled")
        page.fill("#text", "[modes\n")
        until(page, "!document.querySelector('#form-off').hidden")
        assert page.evaluate("document.querySelector('#groups').inert")
        set_text(page, good)
        until(page, f"{box}.value === '6' && !document.querySelector('#groups').inert")
        assert page.is_disabled("#form-undo")  # what was typed since would be lost
        page.unroute_all(behavior="ignoreErrors")


@pytest.mark.slow
def test_tables_and_numbers_that_scatter_are_added_and_removed(browser, server, example, tmp_path):  # noqa: F811
    good = put(example, tmp_path)
    with page_at(browser, server) as page:
        page.route("**/api/check*", lambda route: None)  # never answered: the faults are those of the text
        opened_form(page)
        page.locator("#add-study").select_option("support")
        page.locator(".add-row", has=page.locator("#add-study")).get_by_role("button").click()
        until(page, "document.activeElement.id === 'field-support[1].face'")
        until(page, "document.activeElement.ariaInvalid === 'true'")  # a face is needed, and the field says so
        page.keyboard.type("lower.joint")
        page.keyboard.press("Enter")
        row = page.locator(".add-row", has=page.locator("#add-uncertain"))
        row.locator("input").first.fill("joint.friction")
        row.locator("input").last.fill("0.1 to 0.6")
        row.get_by_role("button").click()
        until(page, "document.querySelector('#text').value.includes('0.1 to 0.6')")
        data = tomllib.loads(page.input_value("#text"))
        assert data["support"] == [{"face": "lower.joint"}]
        assert data["uncertain"] == {"joint.friction": "0.1 to 0.6"}
        page.get_by_role("button", name="Remove support[1]").click()
        page.get_by_role("button", name="Remove uncertain").click()
        until(page, "!document.querySelector('#text').value.includes('uncertain')")
        assert tomllib.loads(page.input_value("#text")) == tomllib.loads(good)
        assert set(good.splitlines()) == set(page.input_value("#text").splitlines())
        until(page, "document.querySelector('#saved').textContent === 'saved'")
        page.unroute_all(behavior="ignoreErrors")
