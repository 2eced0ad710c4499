"""The macro for FreeCAD: from the solids of a document to a spreadsheet of frequencies, and springs in a deck."""

import csv
import json
import os
import shutil
import subprocess
import sys
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from types import SimpleNamespace

import pytest

from tests.export.test_attach import FACES, model
from tests.helpers.examples import ROOT

MACRO = ROOT / "integrations" / "freecad" / "FayingJoint.FCMacro"
FAYING = shutil.which("faying", path=os.path.dirname(sys.executable)) or "faying"
PLATES = """
import json
from importlib.machinery import SourceFileLoader
from pathlib import Path

import FreeCAD as App
import Part

macro = SourceFileLoader("faying_joint", MACRO).load_module()
document = App.newDocument("plates")
for name, z, thick in (("lower", 0, 10), ("upper", 10, 8)):
    plate = document.addObject("Part::Feature", name)
    hole = Part.makeCylinder(4.5, thick, App.Vector(30, 15, z))
    plate.Shape = Part.makeBox(60, 30, thick, App.Vector(0, 0, z)).cut(hole)
document.recompute()
folder = Path(FOLDER)
study = macro.study_of(document, folder)
study.write_text(study.read_text().replace('size = "4 mm"', 'size = "10 mm"'))
sheet = macro.shown(document, macro.run(study))
cells = [[sheet.get(f"{column}{row}") for column in "ABCDE"] for row in range(1, 5)]
(folder / "cells.json").write_text(json.dumps(cells))
"""


@pytest.mark.slow
def test_plates_of_a_document_become_frequencies_in_its_spreadsheet(tmp_path):
    program = shutil.which("freecadcmd") or shutil.which("FreeCADCmd")
    if program is None:
        pytest.skip("FreeCADCmd is not installed (Debian: freecad-python3)")
    script = tmp_path / "plates.py"
    script.write_text(PLATES.replace("MACRO", repr(str(MACRO))).replace("FOLDER", repr(str(tmp_path))))
    clean = {**os.environ, "FAYING": FAYING, "QT_QPA_PLATFORM": "offscreen"}
    done = subprocess.run([program, script], capture_output=True, text=True, env=clean, stdin=subprocess.DEVNULL)
    assert (tmp_path / "cells.json").exists(), done.stdout + done.stderr
    head, *rows = json.loads((tmp_path / "cells.json").read_text())
    assert head == ["mode", "best estimate [Hz]", "5 % [Hz]", "95 % [Hz]", "as modelled [Hz]"]
    with (tmp_path / "results" / "modes.csv").open() as file:
        modes = list(csv.DictReader(file))
    for row, mode in zip(rows, modes, strict=False):
        told = [float(mode[name]) for name in ("best [Hz]", "5 % [Hz]", "95 % [Hz]", "frequency [Hz]")]
        assert row == [int(mode["mode"]), *(pytest.approx(value, rel=1e-5) for value in told)]
    assert (tmp_path / "results" / "report.html").exists()


@pytest.fixture
def macro(monkeypatch):
    """The macro without FreeCAD, whose part it is to call faying."""
    monkeypatch.setitem(sys.modules, "FreeCAD", SimpleNamespace(GuiUp=False))
    monkeypatch.setitem(sys.modules, "Import", SimpleNamespace())
    monkeypatch.setenv("FAYING", FAYING)
    loader = SourceFileLoader("faying_joint", str(MACRO))
    made = module_from_spec(spec_from_loader("faying_joint", loader))
    loader.exec_module(made)
    return made


def test_springs_of_the_joint_stand_before_the_first_step_of_a_deck(macro, tmp_path):
    deck, _ = model(tmp_path)
    deck.write_text(f"{deck.read_text()}\n*STEP\n*FREQUENCY\n14\n*END STEP\n")
    joined = macro.springs(deck, *FACES, tmp_path / "study.toml", "3 kN")
    text = joined.read_text()
    assert text.index("*INCLUDE, INPUT=joint_spring2.inp") < text.index("*STEP")
    assert "SPRING2" in (tmp_path / "joint_spring2.inp").read_text().upper()
    tied = tmp_path / "tied.inp"
    tied.write_text(f"{deck.read_text()}\n*TIE, NAME=t\n{FACES[0]}, {FACES[1]}\n")
    with pytest.raises(RuntimeError, match=r"tied.inp has \*TIE, NAME=T between p0.right and p1.left; take it out"):
        macro.springs(tied, *FACES, tmp_path / "study.toml", "3 kN")


def test_what_faying_refuses_is_said(macro, tmp_path):
    with pytest.raises(RuntimeError, match="no file"):
        macro.run(tmp_path / "none.toml")
