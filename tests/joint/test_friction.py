"""Friction under the preload: the limit, stick, what is left after slip, the tangent of the shear."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import faying
from faying.joint.attachments import Support
from faying.joint.equilibrium import StickSlip
from tests.helpers.loads import bolt_load, face_load
from tests.helpers.plates import plates, stacked

MU = 0.3


def pushed(structure, normal, side):
    """Load [N] (unknowns,): the plates pressed together by `normal`, the upper one pushed along x by `side`."""
    mesh = structure.mesh
    load = normal * bolt_load(structure, "high.top", "low.bottom")
    push = np.zeros_like(mesh.points)
    nodes = mesh.face_nodes("high.top")
    face = face_load(mesh.points, mesh.face("high.top"), np.array([0.04, 0.02, 0.02]), np.array([0.0, 0.0, 1.0]))
    push[nodes, 0] = face.reshape(-1, 3)[nodes, 2]  # the shares of an even traction, turned to x
    load = load + side * push.ravel()
    load[structure.fixed] = 0.0
    return load


def held(friction, thickness=0.002):
    """A thin upper plate, so that the push hardly tilts it, on a plate held from below."""
    return plates(
        stacked(counts=(4, 2, 1), size=(0.08, 0.04, thickness)),
        friction=friction,
        supports=(Support(face="low.bottom"),),
    )


def shear(structure, found, friction):
    """Total shear force [N] along x at the state found, by the equilibrium of the lower plate's held face."""
    force = structure.matrices[0] @ found.displacement
    bottom = structure.mesh.face_nodes("low.bottom")
    return -force.reshape(-1, 3)[bottom, 0].sum()


def test_below_the_limit_it_is_the_same_as_without_friction():
    sticks, slip_states = held(None), held(MU)
    a = sticks.assembly().solve(pushed(sticks, 2e3, 100.0))
    b = slip_states.assembly().solve(pushed(slip_states, 2e3, 100.0))
    assert b.slipping == (0.0,)
    assert b.displacement == pytest.approx(a.displacement, rel=1e-6, abs=1e-16)


def test_the_joint_carries_what_is_pushed():
    made = held(MU)
    found = made.assembly().solve(pushed(made, 2e3, 300.0))
    assert shear(made, found, MU) == pytest.approx(300.0, rel=1e-6)
    assert made.joints[0].interface.weights @ found.pressures[0] == pytest.approx(2e3, rel=1e-6)


def test_more_than_friction_holds_never_balances():
    """mu N = 600 N: at 560 N much of the joint slips, at 640 N there is no equilibrium."""
    made = held(MU)
    found = made.assembly().solve(pushed(made, 2e3, 560.0))
    assert 0.2 < found.slipping[0] <= 1
    assert shear(made, found, MU) == pytest.approx(560.0, rel=1e-6)
    with pytest.raises(faying.NotConverged):
        held(MU).assembly().solve(pushed(made, 2e3, 640.0))


def test_slip_grows_with_the_push():
    made = held(MU)
    assembly = made.assembly()
    shares = [assembly.solve(pushed(made, 2e3, side)).slipping[0] for side in (100.0, 450.0, 560.0)]
    assert shares[0] <= shares[1] < shares[2]


def test_what_slipped_does_not_come_back_by_itself():
    """Pushed until it slips, then let go: a part of the slip is left, held by shear of the other sign.

    Without friction none.
    """
    left = {}
    for friction in (None, MU):
        made = held(friction)
        assembly = made.assembly()
        assembly.solve(pushed(made, 2e3, 560.0))
        found = assembly.solve(pushed(made, 2e3, 0.0))
        left[friction] = made.joints[0].interface.slip(found.displacement)
        fresh = made.assembly().solve(pushed(made, 2e3, 0.0))
        left[friction] = np.linalg.norm(left[friction] - made.joints[0].interface.slip(fresh.displacement))
        assert shear(made, found, friction) == pytest.approx(0.0, abs=1e-5)
    assert left[MU] > 100 * left[None]


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(1e-6, 2.0))
def test_the_tangent_is_the_derivative_of_the_shear(x: float, y: float, limit: float):
    slip, anchor = 1e-6 * np.array([[x, y]]), np.array([[2e-7, -1e-7]])
    slip_state = StickSlip(k_t=np.array([1e12]), limit=1e6 * np.array([limit]), anchor=anchor)
    size = 1e12 * np.linalg.norm(slip - anchor)
    if abs(size - 1e6 * limit) < 1e3:
        return  # at the edge of slip there is no derivative
    step = 1e-11
    columns = [
        (slip_state.shear(slip + step * axis) - slip_state.shear(slip - step * axis))[0] / (2 * step)
        for axis in np.eye(2)
    ]
    assert slip_state.tangent(slip)[0] == pytest.approx(np.stack(columns, axis=1), rel=1e-4, abs=1e12 * 1e-4)
    assert np.linalg.norm(slip_state.shear(slip)) <= 1e6 * limit * (1 + 1e-12)


def test_the_tangent_of_a_joint_against_differences():
    """The out-of-balance force of the whole.

    K_t and limit held, moved by a small step: K x with the tangents of the joint.
    """
    made = held(MU)
    assembly = made.assembly()
    load = pushed(made, 2e3, 560.0)
    found = assembly.solve(load)
    u = found.displacement
    assembly = made.assembly()  # without the memory of what has slipped, which lies at the very edge of slip
    slip_states = assembly._stick_slip(u)
    rng = np.random.default_rng(2)
    step = rng.standard_normal(len(u)) * 1e-12
    step[made.fixed] = 0.0
    moved = (
        assembly._out_of_balance(u - step, load, slip_states) - assembly._out_of_balance(u + step, load, slip_states)
    ) / 2
    expected = assembly.stiffness @ step
    for trace, k_n, k_t in assembly._tangents(u, slip_states):
        move = assembly._move(trace, step)
        local = np.concatenate([k_n[:, None] * move[:, :1], np.einsum("qij,qj->qi", k_t, move[:, 1:])], axis=1)
        expected = expected + trace.relative.T @ local.ravel()
    expected[made.fixed] = 0.0
    assert np.linalg.norm(moved - expected) < 1e-4 * np.linalg.norm(expected)


def test_a_friction_that_is_none():
    with pytest.raises(faying.InputError, match="friction -0.1 is not a coefficient of friction"):
        plates(friction=-0.1)


def test_no_friction_at_all_is_the_limit_of_a_little():
    """The plate slides as if on ice; what holds it sideways is a soft spring."""
    made = [
        replace(held(mu), supports=(Support(face="low.bottom"), Support(face="high.top", stiffness=1e9)))
        for mu in (1e-5, 0.0)
    ]
    little, none = (s.assembly().solve(pushed(s, 2e3, 1.0)) for s in made)
    assert none.slipping == little.slipping == (1.0,)
    assert none.displacement == pytest.approx(little.displacement, abs=0.02 * np.abs(little.displacement).max())
    assert none.newton_steps <= little.newton_steps + 2
    moved = none.displacement.reshape(-1, 3)[made[1].mesh.face_nodes("high.top"), 0].mean()
    assert moved == pytest.approx(1.0 / (1e9 * 0.08 * 0.04), rel=0.01)


def test_what_moves_while_it_is_open_closes_without_shear():
    """Pushed over a gap.

    Then pressed: the joint closes where the push has brought it, and takes nothing of the push.
    """
    mesh = stacked(gap=2e-6)
    supports = (Support(face="low.bottom"), Support(face="high.top", stiffness=3e9))
    structure = plates(mesh, friction=0.2, supports=supports)
    up = face_load(mesh.points, mesh.face("high.top"), np.array([0.04, 0.02, 0.02]), np.array([0.0, 0.0, 1.0]))
    push = np.zeros_like(mesh.points)
    nodes = mesh.face_nodes("high.top")
    push[nodes, 0] = up.reshape(-1, 3)[nodes, 2]
    assembly, joint = structure.assembly(), structure.joints[0].interface
    load = 50 * push.ravel()
    load[structure.fixed] = 0.0
    before = assembly.solve(load)
    assert not before.pressures[0].any()
    slipped = joint.slip(before.displacement).mean(axis=0)
    after = assembly.solve(load - 4e4 * up)
    assert joint.weights @ after.pressures[0] > 1e4
    assert np.linalg.norm(joint.slip(after.displacement).mean(axis=0) - slipped) < 0.03 * np.linalg.norm(slipped)
    assert abs(shear(structure, after, 0.2)) < 1.5  # of the 50 N
