import numpy as np
import pytest

import faying
from faying.joint.joint_law import JointLaw

STEEL = faying.CATALOGUE["45 steel"]
LAW = faying.JK(D=2.39, G=1.53e-10, pair=faying.ContactPair(STEEL, STEEL), scan_area=16e-6)


def test_closing_is_the_integral_of_compliance():
    """w(p2) - w(p1) is the integral of dp/k_n from p1 to p2, here by a fine trapezoidal sum in ln p (k_n has kinks)."""
    law = JointLaw(model=LAW)
    for low, high in ((10.0, 1e3), (1e3, 1e5), (1e5, 1e6), (1e6, 4e7)):
        s = np.linspace(np.log(low), np.log(high), 20001)
        exact = np.trapezoid(np.exp(s) / LAW.at_pressure(np.exp(s)).k_n, s)
        assert law.closing(high) - law.closing(low) == pytest.approx(exact, rel=1e-5)


def test_pressure_inverts_closing():
    law = JointLaw(model=LAW)
    for p in (10.0, 1e3, 1e5, 2e7):
        assert law.pressure(np.array([law.closing(p)]))[0][0] == pytest.approx(p, rel=1e-4)


def test_the_tangent_is_the_stiffness_of_the_law():
    law = JointLaw(model=LAW)
    w = np.geomspace(law.closing(1e2), law.closing(4e7), 50)
    p, slope = law.pressure(w)
    assert slope == pytest.approx(LAW.at_pressure(p).k_n, rel=2e-4)
    step = 1e-4
    difference = (law.pressure(w * (1 + step))[0] - law.pressure(w * (1 - step))[0]) / (2 * step * w)
    assert slope == pytest.approx(difference, rel=1e-5)


def test_open_points_carry_nothing():
    p, slope = JointLaw(model=LAW).pressure(np.array([-1e-6, 0.0]))
    assert np.all(p == 0)
    assert np.all(slope == 0)


def test_pressure_grows_and_is_smooth_through_the_ends_of_the_table():
    law = JointLaw(model=LAW)
    w = np.geomspace(1e-15, 1e-4, 4000)
    p, slope = law.pressure(w)
    assert np.all(np.diff(p) > 0)
    assert np.all(slope > 0)


def test_mindlin_in_place_of_the_laws_own():
    k_n, k_t = JointLaw(model=LAW, tangential="mindlin", nu=0.3).stiffness(np.array([1e6]))
    assert k_t / k_n == pytest.approx(2 * 0.7 / 1.7)


class Bare:
    """A law that defines less than a joint needs."""

    name = "bare"
    greatest_pressure = 1e8

    def __init__(self, **given):
        self.given = given

    def at_pressure(self, p, *, exact=None):
        nothing = dict.fromkeys(("k_n", "k_t", "loss_n", "loss_t"))
        return type("Answer", (), nothing | {k: f(np.asarray(p)) for k, f in self.given.items()})


def test_a_law_without_tangential_stiffness_is_refused_with_advice():
    law = JointLaw(model=Bare(k_n=lambda p: 1e9 * p**0.5))
    with pytest.raises(faying.InputError, match='bare defines no tangential stiffness; set tangential = "mindlin"'):
        law.stiffness(np.array([1e6]))
    loss = law.loss(np.array([1e6]))
    assert loss[0] == loss[1] == 0


def test_a_law_without_normal_stiffness_is_refused():
    with pytest.raises(faying.InputError, match="no normal stiffness"):
        JointLaw(model=Bare()).stiffness(np.array([1e6]))


def test_a_power_law_closes_as_a_power():
    """k = c p^m gives w = p^(1-m)/(c (1-m)) exactly."""
    law = JointLaw(model=Bare(k_n=lambda p: 1e9 * p**0.5, k_t=lambda p: 8e8 * p**0.5))
    w = np.geomspace(1e-12, 1e-6, 7)
    assert law.pressure(w)[0] == pytest.approx((w * 1e9 * 0.5) ** 2, rel=1e-8)


def test_a_law_whose_stiffness_outgrows_its_pressure_is_refused():
    with pytest.raises(faying.InputError, match="never meet"):
        JointLaw(model=Bare(k_n=lambda p: 1e3 * p**1.1), tangential="mindlin").pressure(np.array([1e-9]))
