"""The paper: its length and words, its sources, and that pandoc makes it."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.test_words import HISTORY, PLACES, PRIVATE, found, long_sentences

ROOT = Path(__file__).parents[2]
PAPER = ROOT / "paper" / "paper.md"
TEXT = PAPER.read_text(encoding="utf-8")
BODY = TEXT.split("---\n", 2)[2]


def entries(path):
    """DOI of each entry of a file of sources."""
    each = re.findall(r"^@\w+\{(\w+),(.*?)^\}", path.read_text(encoding="utf-8"), re.M | re.S)
    return {key: re.search(r"doi = \{(.*?)\}", body)[1] for key, body in each if "doi" in body}


def test_length_and_sections():
    plain = re.sub(r"!\[.*?\)(?:\{.*?\})?", "", BODY, flags=re.S)
    assert 750 <= len(plain.split()) <= 1250
    heads = re.findall(r"^# (.*)", BODY, re.M)
    assert heads[:3] == ["Summary", "Statement of need", "State of the field"]
    assert heads[-2:] == ["Acknowledgements", "References"]


def test_the_words_are_those_of_the_documentation():
    text = re.sub(r"\]\(.*?\)(?:\{.*?\})?", "]", BODY)
    assert not list(found(PRIVATE | HISTORY | PLACES, text))
    assert not list(long_sentences(text))


def test_sources_are_cited_and_those_of_the_documentation():
    own, site = entries(PAPER.with_name("paper.bib")), entries(ROOT / "docs" / "references.bib")
    assert set(re.findall(r"@([a-z]+\d{4})", BODY)) == set(own)
    assert {key: doi for key, doi in own.items() if key in site} == {key: site[key] for key in own if key in site}


def test_figures_are_there():
    figures = re.findall(r"!\[.*?\]\((.*?)\)", BODY, re.S)
    assert len(figures) == 2
    assert all((PAPER.parent / figure).is_file() for figure in figures)


@pytest.mark.skipif(shutil.which("pandoc") is None, reason="pandoc is not installed")
def test_pandoc_makes_it(tmp_path):
    """From the folder of the paper, as the journal does."""
    out = tmp_path / "out.html"
    command = ["pandoc", "paper.md", "--citeproc", "-o", str(out)]
    done = subprocess.run(command, cwd=PAPER.parent, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "not found" not in done.stderr  # a source
    html = out.read_text(encoding="utf-8")
    assert all(f"https://doi.org/{doi}" in html for doi in entries(PAPER.with_name("paper.bib")).values())


@pytest.mark.skipif(
    not (shutil.which("pandoc") and shutil.which("weasyprint")), reason="pandoc or weasyprint is missing"
)
def test_it_is_a_pdf(tmp_path):
    out = tmp_path / "paper.pdf"
    command = ["pandoc", "paper.md", "--citeproc", "--pdf-engine=weasyprint", "-o", str(out)]
    subprocess.run(command, cwd=PAPER.parent, capture_output=True, check=True)
    assert out.read_bytes()[:5] == b"%PDF-"
    assert out.stat().st_size > sum(path.stat().st_size for path in PAPER.parent.glob("*.md"))  # with its figures
