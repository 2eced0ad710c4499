"""The report of a result made by hand: what it says of joints and laws."""

import numpy as np
from matplotlib.figure import Figure

from faying.output import report
from faying.result import Result


def result(joints, laws):
    """One load, one mode, one point on each joint, one tetrahedron's face."""
    one, n = np.ones((1, 1)), len(joints)
    return Result(
        title="t",
        loads=np.array([1e3]),
        frequencies=one,
        loss_factors=one,
        loss_error=one,
        tied=one[0],
        free=one[0],
        rigid=np.zeros(6),
        pressure=np.ones((1, n)),
        k_n=np.ones((1, n)),
        k_t=np.ones((1, n)),
        points=np.zeros((n, 3)),
        weights=np.ones(n),
        joint_of_point=np.arange(n),
        joints=joints,
        unknowns=9,
        solver="s",
        outline=np.eye(3),
        triangles=np.array([[0, 1, 2]]),
        shapes=np.ones((1, 1, 3, 3)),
        bolts=("b",),
        bolt_forces=one,
        slipping=np.zeros((1, n)),
        mac=np.ones((1, 1, 1)),
        surface={"D": 2.4},
        law={"name": "JK", "cutoff": 0.01},
        convergence=({"total_k_n [N/m]": 1.0, "total_k_t [N/m]": 1.0, "imbalance": 0.0},),
        sources=("material steel: book", *(f"contact law {law}: doi:{law}" for law in laws)),
    )


def html(joints, laws):
    return report.html(result(joints, laws), {"law": Figure()})


def test_one_joint_has_the_law():
    page = html(("flange",), ("JK",))
    assert "<h2>Contact law</h2>" in page
    assert "several laws" not in page


def test_joints_of_different_laws_are_told_apart():
    """The result holds the parameters of the first joint's law, and the names and sources of all."""
    page = html(("flange", "<foot>"), ("JK", "GW"))
    assert "<h2>Contact law of flange</h2>" in page
    assert "<h2>Surface of flange</h2>" in page
    assert "The joints have several laws: JK: doi:JK, GW: doi:GW." in page
