"""Structures of benchmarks/blind: studies pass their check, and what was measured is well formed."""

import csv
import re
from pathlib import Path
from runpy import run_path

import numpy as np
import pytest

import faying
from faying.setup.template import surface
from faying.study import Study

ROOT = Path(__file__).parents[2]
FOLDERS = sorted(path.parent for path in (ROOT / "benchmarks" / "blind").glob("*/study.toml"))
HEAD = ["mode", "kind", "load", "frequency [Hz]", "source"]


def made(folder: Path, to: Path) -> Path:
    """The study file in a folder of its own, with geometry and surface."""
    for name in ("study.toml", "make_geometry.py"):
        (to / name).write_bytes((folder / name).read_bytes())
    run_path(str(to / "make_geometry.py"), run_name="__main__")
    surface(to / f"{next(to.glob('*.step')).stem}-surface.x3p")
    return to / "study.toml"


def rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "measured.csv").open(encoding="utf-8", newline="") as file:
        reader = csv.DictReader(file)
        assert reader.fieldnames == HEAD
        return list(reader)


def test_four_are_measured() -> None:
    assert sum(bool(rows(folder)) for folder in FOLDERS) == 4


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_measured_rises_and_has_its_source(folder: Path) -> None:
    found = rows(folder)
    count = int(re.search(r"^count = (\d+)$", (folder / "study.toml").read_text(encoding="utf-8"), re.M)[1])  # type: ignore[index]
    assert all(row["source"] for row in found)
    assert all(1 <= int(row["mode"]) <= count for row in found)
    for load in {row["load"] for row in found}:
        pairs = [(int(row["mode"]), float(row["frequency [Hz]"])) for row in found if row["load"] == load]
        modes, frequencies = zip(*pairs, strict=True)
        assert list(modes) == sorted(set(modes))
        assert list(frequencies) == sorted(frequencies)
        assert frequencies[0] > 0


@pytest.mark.parametrize(
    "folder",
    [pytest.param(folder, marks=[pytest.mark.slow] * (folder.name != "bolted-cantilever")) for folder in FOLDERS],
    ids=lambda folder: folder.name,
)
def test_study_passes_its_check(folder: Path, tmp_path: Path) -> None:
    study = made(folder, tmp_path)
    assert Study.read(study).title
    assert faying.check(study).faults == ()


@pytest.mark.slow
def test_table_of_the_documentation(tmp_path: Path) -> None:
    """The open prediction of the cantilever: its rows in docs/intervals.md, to the digits printed there."""
    text = (ROOT / "docs" / "intervals.md").read_text(encoding="utf-8")
    printed = re.search(r"\| bolted cantilever.*?\| (.*?) \|", text)
    assert printed is not None
    result = faying.run(made(ROOT / "benchmarks" / "blind" / "bolted-cantilever", tmp_path))
    ends = zip(result.interval.low[-1], result.interval.high[-1], strict=True)
    assert printed[1] == ", ".join(f"{low:.3g} .. {high:.3g}" for low, high in ends) + " Hz"


@pytest.mark.slow
def test_the_half_height_beam_is_inside_as_the_table_says(tmp_path: Path) -> None:
    """Both measured frequencies are inside 90 %, and are of bending along the bolts (z), with one across between."""
    text = (ROOT / "docs" / "intervals.md").read_text(encoding="utf-8")
    folder = ROOT / "benchmarks" / "blind" / "half-brake-reuss-beam"
    result = faying.run(made(folder, tmp_path))
    printed = []
    for row in rows(folder):
        at, test = int(row["mode"]) - 1, float(row["frequency [Hz]"])
        assert result.interval.low[-1][at] < test < result.interval.high[-1][at]
        printed.append(f"{100 * (result.interval.best[-1][at] / test - 1):+.1f}")
    assert f"| {printed[0]} and {printed[1]} % |" in text
    moved = np.square(result.shapes[-1]).sum(axis=1)  # of each mode, along x, y and z
    assert list(moved.argmax(axis=1)[:3]) == [2, 1, 2]
