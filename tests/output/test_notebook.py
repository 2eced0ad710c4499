"""The viewer in a notebook: the frame that a cell shows moves in a real browser, beside hostile text."""

import re

import pytest

import faying
from faying.output.scene import page
from tests.helpers.browser import opened, until
from tests.helpers.scenes import two_boxes


def test_the_frame_of_a_cell_shows_the_viewer(browser, tmp_path):
    shown = two_boxes(title="boxes \"' <b> & -->").show(height=500)
    text = shown._repr_html_()
    (tmp_path / "cell.html").write_text(f"<!doctype html><html><body><p>before</p>{text}<p>after</p></body></html>")
    with opened(browser, (tmp_path / "cell.html").as_uri(), allowed=("file:", "data:", "blob:", "about:")) as cell:
        until(cell, "frames[0].view")
        assert cell.evaluate("frames[0].view.state.mode") == 0
        assert cell.locator("iframe").bounding_box()["height"] == 500
        assert cell.locator("iframe").get_attribute("title") == "boxes \"' <b> & -->"
        assert cell.locator("p").all_inner_texts() == ["before", "after"]


def test_it_is_the_page_of_faying_view(tmp_path):
    result = two_boxes()
    file = result.show().save(tmp_path / "view.html")
    assert file.read_text(encoding="utf-8") == page(faying.view(result).scene)
    result.save(tmp_path / "result.nc")
    of_file = faying.view(tmp_path / "result.nc")
    assert of_file.scene.title == "two boxes"
    assert repr(of_file) == "View of 'two boxes': a notebook shows it; .save(PATH) writes it as a page"
    assert len(re.findall("<iframe", of_file._repr_html_())) == 1


@pytest.mark.parametrize(
    ("of", "more", "words"),
    [(3, {}, "of = 3; give a Result, a Mesh, text or a path"), ("r", {"height": 20}, "200 to 4000 pixels high")],
)
def test_what_cannot_be_shown_is_refused(of, more, words):
    with pytest.raises(faying.InputError, match=words):
        faying.view(two_boxes() if of == "r" else of, **more)
    with pytest.raises(faying.InputError, match="unit is for mesh files"):
        faying.view(two_boxes(), unit="mm")
