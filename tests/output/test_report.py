"""The report of a result made by hand: what it says of joints and laws."""

from matplotlib.figure import Figure

from faying.output import report
from tests.helpers.results import small_result


def html(joints, laws):
    found = small_result(joints=joints, laws=tuple({"name": law, "source": f"doi:{law}"} for law in laws))
    return report.html(found, {"law": Figure()})


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
    assert "Rigid-body values" not in report.html(found, {"law": Figure()})
