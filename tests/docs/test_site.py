"""The site builds without a warning and without a network, and holds every name that it should."""

import json
import os
import re
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest

import faying
from faying.cli.main import COMMANDS
from faying.contact.build import kinds
from faying.loads.record import LoadCases
from faying.result.backbone import Backbone
from faying.result.bolts import BoltNumbers
from faying.result.fields import declared
from faying.result.result import Result
from faying.result.run_record import MeasuredComparison, Receptance

pytest.importorskip("sphinx", reason="the site needs the group docs")
# half a minute to build; test_sources looks at what it is made from
pytestmark = [] if os.environ.get("FAYING_SITE") else pytest.mark.slow

ROOT = Path(__file__).parents[2]
BROWSER = next((path for name in ("chromium", "chromium-browser", "google-chrome") if (path := shutil.which(name))), "")


@pytest.fixture(scope="session")
def site(tmp_path_factory):
    """The folder of the site: FAYING_SITE, or built by the first worker of a run, while the others wait."""
    if os.environ.get("FAYING_SITE"):
        return Path(os.environ["FAYING_SITE"])
    shared = tmp_path_factory.getbasetemp()
    shared = shared.parent if shared.name.startswith("popen-") else shared
    out, log = shared / "site", shared / "site.log"
    try:
        (shared / "site-begun").mkdir()
    except FileExistsError:
        for _ in range(1200):
            if log.is_file():
                break
            subprocess.run([sys.executable, "-c", "import time; time.sleep(0.5)"], check=True)
        assert log.is_file(), "another worker did not finish the site"
    else:
        words = ["-q", "-n", "-W", "--keep-going", "-D", "plot_gallery=0", "-b", "html", "docs", str(out)]
        done = subprocess.run(
            [sys.executable, "-m", "sphinx", *words], cwd=ROOT, capture_output=True, text=True, check=False
        )
        text = "" if done.returncode == 0 else done.stderr or "no message"
        log.with_suffix(".new").write_text(text)
        log.with_suffix(".new").rename(log)
    assert log.read_text() == ""
    return out


class Page(HTMLParser):
    """What a page loads, its visible text, and how often each tag stands in it."""

    def __init__(self, path):
        super().__init__()
        self.loads, self.ids, self.tags, self.parts = [], set(), {}, []
        self.feed(path.read_text(encoding="utf-8"))
        self.text = " ".join(" ".join(self.parts).split())

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.tags[tag] = self.tags.get(tag, 0) + 1
        self.ids.add(given.get("id"))
        if tag in ("script", "img", "iframe", "source", "video", "audio", "embed"):
            self.loads.append(given.get("src") or "")
        if tag == "link" and given.get("rel") not in ("index", "search", "next", "prev", "canonical", "author"):
            self.loads.append(given.get("href") or "")

    def handle_data(self, data):
        self.parts.append(data)


def test_no_page_asks_a_foreign_host(site):
    pages = list(site.rglob("*.html"))
    assert len(pages) > 80
    for path in pages:
        for name in Page(path).loads:
            assert not re.match(r"(?:[a-z]+:)?//", name), f"{path.relative_to(site)} loads {name}"
    for path in site.rglob("*.css"):
        for name in re.findall(r"url\(\s*['\"]?([^'\")]+)", path.read_text(encoding="utf-8")):
            assert not re.match(r"(?:https?:)?//", name), f"{path.relative_to(site)} loads {name}"
            if not name.startswith(("data:", "#")):
                assert (path.parent / name.split("?")[0].split("#")[0]).is_file(), f"{path.name} lacks {name}"


def test_every_law_has_a_page_with_equations(site):
    ids = set()
    for path in (site / "generated" / "laws").glob("*.html"):
        page = Page(path)
        ids |= page.ids
        assert page.tags.get("math", 0) >= 1, path.name
        assert "Parameters" in page.text
        assert "Holds" in page.text
    assert {f"law-{label.lower().replace(' ', '-')}" for label in kinds() if label != "auto"} <= ids


def test_every_public_name_stands_in_the_reference(site):
    from sphinx.util.inventory import InventoryFile

    known = InventoryFile.loads((site / "objects.inv").read_bytes(), uri="").data
    found = {name for kind, names in known.items() if kind.startswith("py:") for name in names}
    expected = {f"faying.{name}" for name in faying.__all__ if name not in ("contact", "synthesize")}
    for module in (faying.contact, faying.contact.asperity):
        for name in module.__all__:
            own = getattr(module, name)
            public = getattr(faying, name, None) is own
            if name != "asperity":
                expected.add(f"faying.{name}" if public else f"{module.__name__}.{name}")
    assert expected - found == set()


def test_every_command_and_option_stands_in_the_reference(site):
    from importlib import import_module

    import click

    page = Page(site / "reference" / "commands.html")
    for name, (module, text) in COMMANDS.items():
        assert f"command-{name}" in page.ids
        assert text in page.text.replace(" ,", ",")
        for parameter in import_module(f"faying.cli.{module}").command.params:
            if isinstance(parameter, click.Option) and not parameter.hidden:
                assert f"cmdoption-faying-{name}-{parameter.opts[0].lstrip('-')}" in {
                    (one or "").replace("-0", "-") for one in page.ids
                } or any(option in page.text for option in parameter.opts), f"{name} {parameter.opts}"


def test_every_study_key_stands_in_the_reference_with_its_default(site):
    text = Page(site / "reference" / "study-keys.html").text
    tables = ("[material.NAME]", "[geometry]", "[[joint]]", "[joint.form]", "[law]", "[surface]", "[[bolt]]", "[test]")
    assert [name for name in tables if name not in text] == []
    for row in (
        "search_distance quantity [m], positive",
        'tangential "law", "mindlin", or k_t/k_n, above 0 and at most 2',
        "harmonics whole number, 1 to 9 3",
        "cutoff number, between 0 and 1 0.01",
    ):
        assert row in re.sub(r" ,", ",", text.replace("”", '"').replace("“", '"')), row


def test_every_variable_of_a_result_stands_in_the_reference(site):
    text = Page(site / "reference" / "results.html").text
    for kind in (Result, Receptance, MeasuredComparison, BoltNumbers, Backbone, LoadCases):
        for name, one in declared(kind).items():
            assert f" {one.name or name} " in text, name


@pytest.mark.parametrize("word", ["embedding", "cbush", "gasket", "loss factor", "load factor", "scatter", "torque"])
def test_search_finds_the_words_of_users(site, word):
    from sphinx.search.en import SearchEnglish

    stem = SearchEnglish({}).stem
    index = json.loads(re.fullmatch(r"Search\.setIndex\((.*)\)", (site / "searchindex.js").read_text())[1])
    for part in word.split():
        names = set()
        for terms in (index["terms"], index["titleterms"]):
            places = terms.get(stem(part), [])
            names |= {index["docnames"][i] for i in (places if isinstance(places, list) else [places])}
        assert "faq" in names, part


@pytest.mark.slow
@pytest.mark.parametrize(("word", "page"), [("embedding", "bolted-joint-numbers"), ("CBUSH", "solvers")])
def test_search_works_in_a_browser(site, word, page, tmp_path):
    if not BROWSER:
        pytest.skip("no Chromium or Chrome on the PATH")
    words = ["--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path}"]
    words.append("--virtual-time-budget=20000")
    done = subprocess.run(
        [BROWSER, *words, "--dump-dom", f"file://{site}/search.html?q={word}"],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert f"{page}.html" in done.stdout
