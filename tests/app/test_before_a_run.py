"""Intervals, identification and backbones in the page before the study has been run."""

import re
import shutil

import pytest

from tests.app.test_page import example, page_at, set_text  # noqa: F401
from tests.helpers.browser import WAIT, until

MORE = """
[uncertain]
stiffness = "0.8 to 1.25"

[test]
source = "a hammer test by hand"
frequencies = [["9900 Hz", "13300 Hz"]]
direction = [0, 0, 1]
points = [["40 mm", "15 mm", "15 mm"]]

[backbone]
mode = 1
friction = 0.3
amplitude = ["1 m/s^2", "100 m/s^2"]
harmonics = 1
"""


@pytest.mark.slow
def test_predict_identify_and_backbone_need_no_run(browser, server, example, tmp_path):  # noqa: F811
    for name in ("study.toml", "two-blocks.step"):
        shutil.copy(example / name, tmp_path)
    text = (tmp_path / "study.toml").read_text()
    text = re.sub(r'"upper.joint" = "4 mm"', '"upper.joint" = "8 mm"', text).replace("count = 6 ", "count = 3 ")
    with page_at(browser, server) as page:
        set_text(page, text + MORE)
        until(page, "document.querySelector('#check-hint').textContent === 'no fault'")
        for command, picture in (
            ("predict", "prediction.svg"),
            ("identify", "identification.svg"),
            ("backbone", "backbone.svg"),
        ):
            page.click("#tab-run")
            page.select_option("#command", command)
            page.click("#start")
            page.wait_for_selector(f"#pictures img[alt='{picture}']", timeout=5 * WAIT)
            until(page, f"document.querySelector(\"#pictures img[alt='{picture}']\").naturalWidth > 300")
    assert not (tmp_path / "results" / "result.nc").exists()
