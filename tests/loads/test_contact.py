"""One joint about its preload: the way back of its law, its first slope, where it opens, and its derivatives."""

from types import SimpleNamespace

import numpy as np
import pytest

from faying.joint.joint_law import JointLaw
from faying.joint.springs import Springs
from faying.loads.contact import LoadedContact
from tests.helpers.laws import Given

A = 3e9  # Pa^(1/2)/m: k_n = A p^(1/2), so that the way back is p = (A w/2)^2


def laid(friction, *, yields):
    """Three points at 1, 4 and 9 MPa and one that is open, of a law whose loading is half as stiff where it yields."""
    given = {"k_n": lambda p: A * np.sqrt(p), "k_t": lambda p: 0.6 * A * np.sqrt(p)}
    if yields:
        given["k_load"] = lambda p: 0.5 * A * np.sqrt(p)
    law = JointLaw(model=Given(greatest_pressure=1e8, **given))
    pressure = np.array([1e6, 4e6, 9e6, 0.0])
    way = 2 * np.sqrt(pressure) / A * (2 if yields else 1)  # on loading
    way[3] = -2e-7
    k_n, k_t = law.stiffness(pressure)
    rest = np.stack([-way, np.array([1e-7, -2e-7, 0, 3e-7]), np.zeros(4)], axis=1)
    joint = SimpleNamespace(weights=np.full(4, 1e-6), gap=np.zeros(4), relative=np.eye(12))
    springs = Springs(interface=joint, pressure=pressure, k_n=k_n, k_t=k_t, loss_n=0 * k_n, loss_t=0 * k_n)
    return LoadedContact.of(joint, law, springs, rest.ravel(), friction), rest, pressure, k_n, k_t


@pytest.mark.parametrize("yields", [False, True], ids=["elastic", "yields"])
@pytest.mark.parametrize("friction", [None, 0.3], ids=["sticks", "slips"])
def test_it_starts_with_the_pressure_and_the_stiffness_of_the_preload(friction, yields):
    contact, rest, pressure, k_n, k_t = laid(friction, yields=yields)
    _, traction, tangent = contact.advance(contact.start, rest)
    assert -traction[:, 0] == pytest.approx(pressure, rel=1e-6, abs=1.0)
    assert traction[:, 1:] == pytest.approx(0, abs=1e-6)
    assert tangent[:3, 0, 0] == pytest.approx(k_n[:3], rel=1e-9)
    assert tangent[:3, 1, 1] == pytest.approx(k_t[:3], rel=1e-6)
    assert np.all(tangent[3] == 0)


@pytest.mark.parametrize("yields", [False, True], ids=["elastic", "yields"])
def test_it_goes_back_by_the_curve_of_k_n_and_opens_at_its_end(yields):
    """p = (A w/2)^2 less what was opened, whatever the way of loading was."""
    contact, rest, pressure, _, _ = laid(None, yields=yields)
    back = 2 * np.sqrt(pressure) / A  # from the preload to first touch
    for share in (0.0, 0.3, 0.9, -0.2):
        motion = rest.copy()
        motion[:, 0] += share * back
        found, _ = contact.normal(motion)
        assert found[:3] == pytest.approx(pressure[:3] * (1 - share) ** 2, rel=1e-4)
    for share, opened in ((0.999, False), (1.001, True)):
        motion = rest.copy()
        motion[:, 0] += share * back
        assert list(contact.opened(motion)) == [opened] * 3 + [False]
    closed = rest.copy()
    closed[3, 0] = -1e-7  # what was open closes by the same law
    assert contact.normal(closed)[0][3] == pytest.approx((A * 1e-7 / 2) ** 2, rel=1e-4)


@pytest.mark.parametrize("friction", [None, 0.3], ids=["sticks", "slips"])
def test_its_tangent_is_the_derivative_of_its_traction(friction):
    contact, rest, _, _, _ = laid(friction, yields=True)
    rng = np.random.default_rng(4)
    moved = rest + rng.uniform(-1, 1, rest.shape) * 2e-7
    _, _, tangent = contact.advance(contact.start, moved)
    step = 1e-13
    for axis in range(3):
        ahead, behind = moved.copy(), moved.copy()
        ahead[:, axis] += step
        behind[:, axis] -= step
        sides = [contact.advance(contact.start, one)[1] for one in (ahead, behind)]
        slope = (sides[0] - sides[1]) / (2 * step)
        assert tangent[:, :, axis] == pytest.approx(slope, abs=2e-3 * np.abs(slope).max())


def test_friction_bounds_the_shear_and_what_slid_is_dissipated():
    contact, rest, pressure, _, k_t = laid(0.3, yields=False)
    far = rest.copy()
    far[:, 1] += 5e-6
    state, traction, _ = contact.advance(contact.start, far)
    assert traction[:3, 1] == pytest.approx(0.3 * pressure[:3], rel=0.01)
    assert list(contact.sliding(far, traction)) == [True, True, True, False]
    taken = contact.dissipated(contact.start, state)
    # no more than the limit over the way, no less than that less what the springs keep
    assert np.all(taken[:3] < 0.3 * pressure[:3] * 5e-6)
    assert np.all(taken >= 0)
    _, sticks, _ = laid(None, yields=False)[0].advance(laid(None, yields=False)[0].start, far)
    assert sticks[:3, 1] == pytest.approx(k_t[:3] * 5e-6, rel=1e-6)


def test_a_point_that_opens_and_closes_elsewhere_starts_without_shear():
    """The way that it went while it was open is no slip of the joint: it touches where it lands."""
    contact, rest, _, _, k_t = laid(None, yields=False)
    shut, apart = contact.start, rest.copy()
    apart[:3, 0] += 1e-5  # open
    apart[:3, 1] += 3e-6
    opened, traction, _ = contact.advance(shut, apart)
    assert np.all(traction[:3] == 0)
    landed = rest.copy()
    landed[:3, 1] += 3e-6
    _, traction, _ = contact.advance(opened, landed)
    assert traction[:3, 1:] == pytest.approx(0, abs=1e-9 * float(k_t.max()) * 3e-6)
    _, never_opened, _ = contact.advance(shut, landed)
    assert never_opened[:3, 1] == pytest.approx(k_t[:3] * 3e-6, rel=1e-4)


def test_a_point_slides_from_friction_times_pressure_on():
    """Between half of that and all of it some of its sliders have slid, but the point still sticks."""
    contact, rest, pressure, _, k_t = laid(0.3, yields=False)
    for share, slides in ((0.7, False), (3.0, True)):
        moved = rest.copy()
        moved[:3, 1] += share * 0.3 * pressure[:3] / k_t[:3]
        _, traction, _ = contact.advance(contact.start, moved)
        shear = np.linalg.norm(traction[:3, 1:], axis=1) / (0.3 * pressure[:3])
        assert np.all((shear > 0.5) & (shear < 1 + 1e-6))
        assert list(contact.sliding(moved, traction)) == [slides] * 3 + [False]
