"""The last runs of a study: kept, listed with what changed, and compared in the page."""

import json
import os

import pytest

from faying.app.project import Project
from faying.app.runs import Runs, changes
from faying.errors import InputError
from faying.result import Provenance
from tests.app.test_page import page_at
from tests.app.test_server import ask
from tests.helpers.browser import until
from tests.helpers.scenes import two_boxes

STUDY = '# mine\ntitle = "two boxes"\n[law]\nmodel = "{law}"\n[[bolt]]\npreload = {preload}\n'


def run_of(folder, law, *, second=0, preload='"8 kN"', **changed):
    """Put a result into the folder, as a run does, made so many seconds after the first."""
    files = {"surface.x3p": changed.pop("scan", "a")}
    study = STUDY.format(law=law, preload=preload)
    (folder / "study.toml").write_text(study)
    (folder / "results").mkdir(exist_ok=True)
    out = folder / "results" / "result.nc"
    two_boxes(provenance=Provenance(study=study, files=files), **changed).save(out)
    os.utime(out, (1.7e9 + second, 1.7e9 + second))


def test_runs_are_kept_once_and_the_oldest_go(tmp_path, monkeypatch):
    monkeypatch.setattr("faying.app.runs.MAX_RUNS", 2)
    runs = Runs(Project.at(tmp_path))
    runs.keep()
    assert runs.names() == []
    for second in range(4):
        run_of(tmp_path, "jk", second=second, title=f"run {second}")
        runs.keep()
        runs.keep()
    Runs(Project.at(tmp_path)).keep()  # as another start of the page does
    titles = [one["title"] for one in runs.listed()]
    assert titles == [f"run {second}" for second in reversed(range(2, 4))]
    assert sorted(path.name for path in (tmp_path / "results").iterdir()) == ["result.nc"]


def test_large_runs_go_earlier_and_the_newest_stays(tmp_path, monkeypatch):
    runs = Runs(Project.at(tmp_path))
    run_of(tmp_path, "jk")
    size = (tmp_path / "results" / "result.nc").stat().st_size
    for limit, left, start in ((int(2.5 * size), 2, 0), (size // 2, 1, 3)):
        monkeypatch.setattr("faying.app.runs.MAX_BYTES", limit)
        for second in range(3):  # each at a time of its own: the newest of one second is not known
            run_of(tmp_path, "jk", second=start + second, title=f"{limit} {second}")
            runs.keep()
        assert len(runs.names()) == left
        assert runs.listed()[0]["title"] == f"{limit} 2"


def test_runs_of_two_studies_of_a_folder_stay_apart(tmp_path):
    run_of(tmp_path, "jk")
    Runs(Project.at(tmp_path)).keep()
    other = Runs(Project(folder=tmp_path, study_name="other.toml"))
    other.keep()
    assert other.names() == []


def test_a_run_says_what_changed_in_its_study(tmp_path):
    runs = Runs(Project.at(tmp_path))
    run_of(tmp_path, "jk")
    runs.keep()
    run_of(tmp_path, "gw", second=5, preload='["8 kN", "9 kN"]')
    runs.keep()
    new, old = runs.listed()
    assert new["changes"] == [["law.model", "jk", "gw"], ["bolt[1].preload", "8 kN", '["8 kN", "9 kN"]']]
    assert old["changes"] == []
    assert changes("a = 1\n", "[b]\nc = 2\n") == [["a", "1", "-"], ["b.c", "-", "2"]]
    assert changes("# x\na = 1", "a=1 # y") == []


def test_a_damaged_run_is_listed_and_refused_in_words(tmp_path):
    runs = Runs(Project.at(tmp_path))
    run_of(tmp_path, "jk")
    runs.keep()
    (tmp_path / ".faying" / "runs" / "study" / "20200101-000000-00000000.nc").write_bytes(b"no")
    good, bad = runs.listed()
    assert good["title"] == "two boxes"
    assert bad["laws"] == []
    with pytest.raises(InputError, match="no run"):
        runs.compared("../../secret", good["id"])
    with pytest.raises(Exception, match="20200101-000000-00000000"):
        runs.compared(bad["id"], good["id"])


def test_the_server_compares_two_runs(server, tmp_path):
    run_of(tmp_path, "jk")
    ask(server, "api/project")
    run_of(tmp_path, "gw", second=5, scan="b")
    ask(server, "api/project")
    new, old = json.loads(ask(server, "api/runs")[1])["runs"]
    found = json.loads(ask(server, f"api/compare?first={old['id']}&second={new['id']}")[1])
    assert found["changes"] == [["law.model", "jk", "gw"], ["surface.x3p", "file", "other content"]]
    assert found["modes"][1][:4] == ["1", "110.00", "110.00", "+0.00"]
    assert "fault" in json.loads(ask(server, "api/compare?first=x&second=y")[1])
    pair = f"api/compare?first={old['id']}&second={new['id']}"
    at = json.loads(ask(server, f"{pair}&preload=2%20kN")[1])
    assert (found["preloads"], at["preloads"]) == (["8 kN", "8 kN"], ["2 kN", "2 kN"])
    assert at["shared"] == ["2 kN", "8 kN"]
    assert "no such preload" in json.loads(ask(server, f"{pair}&preload=3%20kN")[1])["fault"]


@pytest.mark.slow
def test_two_runs_stand_next_to_each_other_in_the_page(browser, server, tmp_path):
    run_of(tmp_path, "jk")
    ask(server, "api/project")
    run_of(tmp_path, "gw", second=5, frequencies=two_boxes().frequencies * 1.01)
    with page_at(browser, server, width=800, height=700, color_scheme="dark") as page:
        page.route("**/api/check*", lambda route: None)
        page.click("#tab-result")
        page.wait_for_selector("#two:not([hidden])")
        page.focus("#two summary")
        page.keyboard.press("Enter")
        page.wait_for_selector("#two-found img")
        rows = page.locator("#two-found table").all_inner_texts()
        assert "law.model\tjk\tgw" in rows[0]
        assert "1\t110.00\t111.10\t+1.00" in rows[1]
        assert "flange" in rows[2]
        assert page.evaluate("document.querySelector('#two-found img').naturalWidth") > 400
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        page.select_option("#run-load", "2 kN")
        until(page, "document.querySelector('#two-found figcaption')?.textContent.includes('Preload 2 kN')")
        page.select_option("#run-second", index=1)
        until(page, "document.querySelector('#two-found').textContent.includes('The studies say the same')")
        page.unroute_all(behavior="ignoreErrors")
