"""What somebody gets who installs the wheel: the commands work from an empty environment, away from the checkout."""

import os
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


@pytest.mark.slow
def test_the_wheel_in_an_empty_environment(tmp_path):
    uv = shutil.which("uv")
    if uv is None:
        pytest.skip("uv is not installed")
    called(uv, "build", "--wheel", "--out-dir", tmp_path / "dist", ROOT, cwd=tmp_path)
    (wheel,) = (tmp_path / "dist").glob("*.whl")
    version = ".".join(map(str, sys.version_info[:2]))
    called(uv, "venv", "--python", version, tmp_path / "venv", cwd=tmp_path)
    bin_folder = tmp_path / "venv" / ("Scripts" if sys.platform == "win32" else "bin")
    called(uv, "pip", "install", "--python", bin_folder / "python", wheel, cwd=tmp_path)
    where = called(bin_folder / "python", "-c", "import faying; print(faying.__file__)", cwd=tmp_path)
    assert where.startswith(str(tmp_path / "venv"))
    called(bin_folder / "faying", "init", "study.toml", cwd=tmp_path)
    said = called(bin_folder / "faying", "run", "study.toml", cwd=tmp_path)
    assert "Two blocks and a bolt" in said
    assert {"result.nc", "report.html"} <= {path.name for path in (tmp_path / "results").iterdir()}


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
    assert len(text.splitlines()) <= 12
    assert all(name in text for name in needed)
