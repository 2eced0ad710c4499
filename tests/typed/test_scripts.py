"""Scripts as users write them: they run, and the type checkers mypy (strict) and pyright accept them."""

import json
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPTS = sorted(path for path in Path(__file__).parent.glob("*.py") if not path.name.startswith(("test_", "__")))


LONG = {"five_tasks"}  # two minutes


@pytest.mark.parametrize(
    "script", [pytest.param(s, marks=[pytest.mark.slow] * (s.stem in LONG), id=s.stem) for s in SCRIPTS]
)
def test_it_runs(script, monkeypatch, capsys, tmp_path):
    import matplotlib.pyplot as plt

    shutil.copytree(ROOT / "examples", tmp_path / "examples", ignore=shutil.ignore_patterns("results"))
    monkeypatch.chdir(tmp_path)
    plt.switch_backend("agg")
    runpy.run_path(str(script))
    figures = [plt.figure(number) for number in plt.get_fignums()]
    plt.close("all")
    assert figures
    assert all(
        ax.get_xlabel() for figure in figures for ax in figure.axes if ax.axison and ax.get_visible() and ax.lines
    )
    assert capsys.readouterr().out


def test_mypy_accepts_them_in_strict_mode(tmp_path):
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file", "", "--cache-dir", str(tmp_path)]
    command += ["--follow-imports", "silent", *map(str, SCRIPTS)]
    found = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert found.returncode == 0, found.stdout


@pytest.mark.slow
def test_pyright_accepts_them(tmp_path):
    pytest.importorskip("basedpyright", reason="the checker pyright is not installed")
    for script in SCRIPTS:
        shutil.copy(script, tmp_path)
    paths = {"typeCheckingMode": "standard", "extraPaths": [str(ROOT / "src")]}
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(paths))
    command = [sys.executable, "-m", "basedpyright", "--project", str(tmp_path), "--pythonpath", sys.executable]
    found = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert found.returncode == 0, found.stdout
