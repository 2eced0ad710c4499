"""What somebody gets who installs the wheel: the commands work from an empty environment, away from the checkout."""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import faying

ROOT = Path(__file__).parents[2]


def called(*command, cwd):
    env = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "VIRTUAL_ENV")}
    done = subprocess.run([*map(str, command)], cwd=cwd, env=env, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """The folder of programs of an empty environment with the wheel, which the sdist makes."""
    folder, uv = tmp_path_factory.mktemp("wheel"), shutil.which("uv")
    if uv is None:
        pytest.skip("uv is not installed")
    called(uv, "build", "--out-dir", folder / "dist", ROOT, cwd=folder)
    (wheel,) = (folder / "dist").glob("*.whl")
    assert list((folder / "dist").glob("*.tar.gz"))
    version = ".".join(map(str, sys.version_info[:2]))
    called(uv, "venv", "--seed", "--python", version, folder / "venv", cwd=folder)
    bin_folder = folder / "venv" / ("Scripts" if sys.platform == "win32" else "bin")
    called(bin_folder / "python", "-m", "pip", "install", "--quiet", f"{wheel}[pardiso]", cwd=folder)
    where = called(bin_folder / "python", "-c", "import faying; print(faying.__file__)", cwd=folder)
    assert where.startswith(str(folder / "venv"))
    return bin_folder


@pytest.mark.slow
def test_what_the_readme_types_works_from_the_wheel(installed, tmp_path):
    """Its commands word for word behind `uv run`, and its Python, beside a copy of the examples."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples", ignore=shutil.ignore_patterns("results"))
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    typed = re.findall(r"^(?:pip install uv && )?uv run (?:--extra \w+ )*faying (.*)$", text, re.M)
    assert len(typed) > 4
    said = {words: called(installed / "faying", *shlex.split(words), cwd=tmp_path) for words in typed}
    assert "Two blocks and a bolt" in said["run study.toml"]
    assert {"result.nc", "report.html"} <= {path.name for path in (tmp_path / "results").iterdir()}
    (script,) = re.findall(r"^```python\n(.*?)^```", text, re.M | re.S)
    assert "k_n 17.6 MPa/um" in called(installed / "python", "-c", script, cwd=tmp_path)


def test_one_version_and_one_licence_everywhere():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    lines = (ROOT / "CITATION.cff").read_text().splitlines()
    citation = dict(line.split(": ", 1) for line in lines if line[:1].isalpha() and ": " in line)
    assert project["version"] == citation["version"] == faying.__version__
    assert project["license"] == citation["license"]
    least = project["requires-python"].removeprefix(">=")
    assert f"Programming Language :: Python :: {least}" in project["classifiers"]


def test_the_container_installs_the_libraries_that_the_message_names():
    from faying.geometry.cad import LIBRARIES

    needed = LIBRARIES["Debian, Ubuntu"].removeprefix("apt-get install ").split()
    text = (ROOT / "Dockerfile").read_text()
    assert len(text.splitlines()) <= 14
    assert 'pip install --no-cache-dir "$(ls /dist/*.whl)' in text
    assert all(name in text for name in needed)
