"""Every command and every Python block of the README and the docs runs."""

import json
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import click
import pytest

from faying.cli import main
from faying.cli.main import cli

ROOT = Path(__file__).parent.parent
SITE = ROOT / "docs" / "generated"  # made by a build of the site
PAGES = [ROOT / "README.md", *sorted(p for p in (ROOT / "docs").rglob("*.md") if SITE not in p.parents)]
T_SPECIMEN = "examples/t-specimen/study.toml"
# how many samples a page asks for, and how many show that its command runs
FEWER = {"samples": 16, "assemblies": 4, "count": 100}
ELSEWHERE = (T_SPECIMEN, "examples/plates-and-bolts/")  # minutes long: tests/examples runs them


def fewer(text):
    """A command or a block with small counts of samples."""
    for name, count in FEWER.items():
        text = re.sub(rf"\b({name}[ =])(\d+)\b", lambda m, n=count: f"{m[1]}{min(n, int(m[2]))}", text)
    return text


def blocks(page, language):
    """Bodies of the blocks of a language; all are matched in turn, so that the end of one is not taken for a start."""
    fenced = re.findall(r"^```([^\n]*)\n(.*?)^```\s*?$", page.read_text(), re.M | re.S)
    return [body for name, body in fenced if re.fullmatch(language, name)]


def commands(page):
    """Lines of the plain blocks that call faying, without the set-up before them."""
    for block in blocks(page, "(?:sh|console)?"):
        for line in block.replace("\\\n", " ").splitlines():
            found = re.search(r"(?:^|&& )(?:uv run [^&]*?)?faying( .*)$", line)
            if found and "pytest" not in line:
                yield found.group(1).strip()


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """A copy of what the commands need, so that nothing is written to the repository."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples", ignore=shutil.ignore_patterns("results"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


# a minute and more: tests/loads, tests/identify, tests/measured and tests/halfspace have the same in small
LONG = {"bracket-under-10-g.md", "intervals.md", "with-intervals.md", "hammer-test.md", "speed.md"}
LONG |= {"bolted-joint-numbers.md", "own-joint.md", "sweeps.md"}  # tests/sheet, tests/export, tests/setup, tests/sweeps
# tests/service, tests/witness and tests/reference_problems, tests/case
LONG |= {"bracket-on-a-shaker.md", "solvers.md", "weigh-it-ring-it-bolt-it.md"}
# tests/identify, tests/examples, tests/typed, tests/service
LONG_PYTHON = {"intervals.md", "plates-and-bolts.md", "first-study.md", "bracket-on-a-shaker.md", "solvers.md"}
LONG_PYTHON |= {"with-intervals.md", "weigh-it-ring-it-bolt-it.md"}  # tests/answer, tests/case
COMMANDED, CALLED = (
    [pytest.param(p, marks=[pytest.mark.slow] * (p.name in long), id=str(p.relative_to(ROOT))) for p in PAGES]
    for long in (LONG, LONG_PYTHON)
)


def called(line):
    """Call the command of a page in this process: to start two hundred of them takes minutes, and tests/cli does."""
    with pytest.raises(SystemExit) as stop:
        main(shlex.split(fewer(line)))
    assert stop.value.code == 0, f"faying {line}"


@pytest.mark.parametrize("page", COMMANDED)
def test_commands(page, checkout):
    """They run, in one folder; what they write there lies where git does not see it."""
    before = {path for path in checkout.rglob("*") if path.is_file()}
    for line in commands(page):
        if line.startswith("run ") and any(study in line for study in ELSEWHERE):
            continue
        if line == "run study.toml":  # a minute long: tests/cli/test_main.py runs it
            assert "init study.toml" in commands(page)
            continue
        if line == "app":  # it serves until it is ended; tests/app has it
            continue
        # minutes: tests/form/test_waviness.py has the draws, tests/identify small identifications of laws
        if "waviness_seed" in line or "laws-evidence" in line:
            named, *words = shlex.split(line)
            command = cli.get_command(click.Context(cli), named)
            command.make_context(named, words)  # raises where the words are wrong
            continue
        if line == "run lap.toml":  # a minute long; tests/setup/test_new.py runs such a study
            assert any(words.startswith("new ") and "lap.toml" in words for words in commands(page))
            continue
        called(line)
    made = [str(path.relative_to(checkout)) for path in checkout.rglob("*") if path.is_file() and path not in before]
    if made and (ROOT / ".git").exists() and shutil.which("git"):
        told = subprocess.run(
            ["git", "check-ignore", "--no-index", *made], cwd=ROOT, capture_output=True, text=True, check=False
        )
        assert sorted(told.stdout.split()) == sorted(made)


def test_one_folder_holds_the_studies_of_all_pages(checkout):
    for line in [line for page in PAGES for line in commands(page) if line.startswith("init ")]:
        called(line)


@pytest.mark.parametrize("page", CALLED)
def test_python_blocks(page, checkout):
    for block in blocks(page, "python"):
        exec(compile(fewer(block), str(page), "exec"), {"__name__": "__main__"})


def test_the_readme_has_commands():
    found = list(commands(ROOT / "README.md"))
    assert f"run {T_SPECIMEN}" in found
    assert len(found) >= 5


def test_the_readme_gives_one_stiffness_within_the_range_of_its_law(checkout):
    """Its command, its Python block and its sentence: the same number, and valid."""
    readme = ROOT / "README.md"
    (line,) = [line for line in commands(readme) if line.startswith("law --D")]
    words = [sys.executable, "-m", "faying", *shlex.split(line), "--json"]
    tree = json.loads(subprocess.run(words, capture_output=True, text=True, check=True).stdout)
    assert all(tree["valid"])
    assert tree["pressure"]["values"][-1] == pytest.approx(2e6, rel=1e-12)
    by_command = f"{tree['k_n']['values'][-1] / 1e12:.1f} MPa/um"
    (block,) = [block for block in blocks(readme, "python") if "of_fractal" in block]
    said = subprocess.run([sys.executable, "-c", block], capture_output=True, text=True, check=True).stdout
    assert said.startswith(f"k_n {by_command}, ")
    assert said.splitlines()[0].endswith("valid: True")
    assert f"{by_command} at 2 MPa" in readme.read_text()


@pytest.mark.parametrize("page", [*PAGES, ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md"], ids=lambda p: p.name)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\((?!https?:|#)([^)#]+)", page.read_text()):
        assert (page.parent / target).exists(), f"{page.name} links to {target}"
