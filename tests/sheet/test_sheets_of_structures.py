"""Sheets of ordinary joints: each step is the load case at its own preload, and the load across crosses the joint."""

from pathlib import Path

import pytest

import faying
from faying.sheet.bolt_sheet import bolt_sheet
from faying.study import Study

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
LOW = {"D": 2.39, "G": "1.53e-10 m", "scan_area": "16 mm^2"}
END = {"part": "upper", "number": 14}
RADIUS = 52.5e-3  # m: of the circle of the bolts
FAST = {"modes.count": 1, "modes.levels": [], "modes.intervals": False}


def changed(path, values):
    study = Study.read(path)
    for key, value in (FAST | values).items():
        study = study.with_(key, value)
    return study


def stub():
    """A T-stub that pries: half of 2 kN and a prying force on each bolt."""
    return changed(
        ROOT / "reference-problems" / "2-t-stub-prying" / "problem.toml",
        {"bolt.preload": "3 kN", "bolt_sheet": {"load": "pull", "tightening_factor": 1.5}},
    )


def tubes():
    """A tube with a flange and four M12, pulled by 20 kN and turned by 300 N m."""
    loads = [
        {"name": "pull", "force": [{"face": END, "force": ["0 N", "0 N", "20 kN"]}]},
        {"name": "turn", "force": [{"face": END, "moment": ["0 N m", "0 N m", "300 N m"]}]},
    ]
    more = {"surface": LOW, "geometry.size": "24 mm", "geometry.face_size": None, "bolt.preload": "30 kN"}
    sheet = {"load": ["pull", "turn"], "tightening_factor": 1.4}
    return changed(
        EXAMPLES / "plates-and-bolts" / "flanges.toml",
        more
        | {
            "joint.form": {"flat": True},
            "support": [{"face": {"part": "lower", "number": 14}}],
            "load": loads,
            "bolt_sheet": sheet,
        },
    )


def meshed():
    """A bolt of solids through two blocks, which its load lifts."""
    loads = [{"name": "pull", "force": [{"face": "upper.seat", "force": ["0 N", "0 N", "500 N"]}]}]
    sheet = {"load": "pull", "tightening_factor": 1.3}
    held = [{"face": {"part": "lower", "normal": "-z", "all": True}}]
    return changed(
        EXAMPLES / "solid-bolt" / "study.toml",
        {"bolt.preload": "3 kN", "joint.form": {"flat": True}, "support": held, "load": loads, "bolt_sheet": sheet},
    )


def value(sheet, symbol):
    return sheet.row(symbol).result.value


def inputs(sheet):
    return {one.symbol: one.value for row in sheet.rows for one in row.inputs}


@pytest.mark.parametrize("make", [stub, pytest.param(tubes, marks=pytest.mark.slow), meshed])
def test_every_step_is_the_load_case_at_its_own_preload(make):
    """To 1 %: additional forces at F_Vmin and at F_Mmax, by load cases that are solved there."""
    study = make()
    sheets = bolt_sheet(study).sheets
    for symbol, changes, largest in (("F_Vmin", ("F_SAu", "F_SAo"), (0, 1)), ("F_Mmax", ("F_SAM",), (1,))):
        # without embedding that is known, F_Vmin is the least preload at assembly
        forces = [value(sheet, symbol) or value(sheet, "F_Mmin") for sheet in sheets]
        there = study
        for bolt, force in zip(study.bolts, forces, strict=True):
            there = there.with_(f"bolt.{bolt.name}.preload", f"{force!r} N")
        cases = faying.load_cases(there, modes=False)
        change = cases.bolt_force - cases.bolt_preload
        for k, sheet in enumerate(sheets):
            ends = min(change[:, k].min(), 0.0), max(change[:, k].max(), 0.0)
            for name, end in zip(changes, largest, strict=True):
                assert value(sheet, name) == pytest.approx(ends[end], rel=0.01, abs=0.01 * abs(ends[1]))


@pytest.mark.slow
def test_the_load_across_is_what_crosses_the_joint():
    """Of a torque on four bolts T/(4 r) each, of an axial pull nothing: the equilibrium of the tube, to 1e-3."""
    turned, pulled = (tubes().with_("bolt_sheet.load", load) for load in ("turn", "pull"))
    wanted = 300 / (4 * RADIUS)
    assert [inputs(one)["F_Q"] for one in bolt_sheet(turned).sheets] == pytest.approx([wanted] * 4, rel=1e-3)
    assert max(inputs(one)["F_Q"] for one in bolt_sheet(pulled).sheets) < 1e-3 * 20e3 / 4
