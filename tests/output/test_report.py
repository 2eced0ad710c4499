"""The report of a result made by hand: what it says of joints and laws."""

import numpy as np

from faying.output import report
from faying.result import Result
from tests.helpers.results import small_result


def html(joints, laws):
    found = small_result(joints=joints, laws=tuple({"name": law, "source": f"doi:{law}"} for law in laws))
    return report.html(found, {"law": "<svg/>"})


def test_joints_of_one_law_share_a_section():
    page = html(("flange", "foot"), ("JK", "JK"))
    assert "<h2>Contact of flange, foot</h2>" in page
    assert page.count("<h3>Contact law</h3>") == 1


def test_joints_of_different_laws_have_each_its_own():
    page = html(("flange", "<foot>"), ("JK", "GW"))
    assert "<h2>Contact of flange</h2>" in page
    assert "<h2>Contact of &lt;foot&gt;</h2>" in page
    assert "doi:JK" in page
    assert "doi:GW" in page


def test_a_structure_without_rigid_motion_has_a_report():
    found = small_result(rigid=[])
    assert "Rigid-body values" not in report.html(found, {"law": "<svg/>"})


def test_names_of_any_kind_reach_files_and_figures(tmp_path):
    """Characters beyond ASCII, and what matplotlib and HTML would read as their own."""
    grid = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]]) * 1e-2
    q = np.ones((2, 6))
    places = {"points": np.concatenate([grid, grid + 1]), "weights": q[0], "joint_of_point": np.repeat([0, 1], 3)}
    names = (r"$\frac{1}{0$", "Fläche µ")
    found = small_result(title="Träger <b>&", joints=names, pressure=q, k_n=q, k_t=q, **places)
    made = report.write(found, tmp_path)
    assert Result.load(tmp_path / "result.nc") == found
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Träger &lt;b&gt;&amp;" in page
    assert "<b>" not in page
    assert {p.name for p in made} >= {"result.nc", "report.html", "pressure.svg"}
