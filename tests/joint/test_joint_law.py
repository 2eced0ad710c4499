from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.fe.interface import join
from faying.joint.attachments import Support
from faying.joint.joint import FittedJoint
from faying.joint.joint_law import JointLaw
from faying.joint.structure import Structure
from tests.helpers.boxes import stack
from tests.helpers.laws import Given

STEEL = faying.CATALOGUE["45 steel"]
LAW = faying.JK(D=2.39, G=1.53e-10, pair=faying.ContactPair(STEEL, STEEL), scan_area=16e-6)


def test_closing_is_the_integral_of_compliance():
    """w(p2) - w(p1) is the integral of dp/k_n from p1 to p2, here by a fine trapezoidal sum in ln p (k_n has kinks)."""
    law = JointLaw(model=LAW)
    for low, high in ((10.0, 1e3), (1e3, 1e5), (1e5, 1e6), (1e6, 4e7)):
        s = np.linspace(np.log(low), np.log(high), 20001)
        exact = np.trapezoid(np.exp(s) / LAW.at_pressure(np.exp(s)).k_n, s)
        assert law.approach(high) - law.approach(low) == pytest.approx(exact, rel=1e-5)


def test_pressure_inverts_closing():
    law = JointLaw(model=LAW)
    for p in (10.0, 1e3, 1e5, 2e7):
        assert law.pressure(np.array([law.approach(p)]))[0][0] == pytest.approx(p, rel=1e-4)


def test_the_tangent_is_the_stiffness_of_the_law():
    law = JointLaw(model=LAW)
    w = np.geomspace(law.approach(1e2), law.approach(4e7), 50)
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


def test_a_law_without_tangential_stiffness_takes_mindlin_s_and_says_so():
    bare = Given("bare", k_n=lambda p: 1e9 * p**0.5)
    law = JointLaw(model=bare, nu=0.3)
    k_n, k_t = law.stiffness(np.array([1e6]))
    assert k_t / k_n == pytest.approx(2 * 0.7 / 1.7, rel=1e-12)
    assert law.assumes_mindlin
    assert not law.predicts_loss
    assert [float(part[0]) for part in law.loss(np.array([1e6]))] == [0, 0]
    with pytest.raises(faying.InputError, match="bare defines no tangential stiffness"):
        JointLaw(model=bare, tangential="law").stiffness(np.array([1e6]))
    own = JointLaw(model=Given(k_n=lambda p: 1e9 * p**0.5, k_t=lambda p: 3e8 * p**0.5, loss_t=lambda p: 0.1 + 0 * p))
    assert not own.assumes_mindlin
    assert own.predicts_loss
    assert own.stiffness(np.array([1e6]))[1] == pytest.approx([3e11], rel=1e-12)


def test_a_law_without_normal_stiffness_is_refused():
    with pytest.raises(faying.InputError, match="no normal stiffness"):
        JointLaw(model=Given("bare")).stiffness(np.array([1e6]))


def test_a_power_law_closes_as_a_power():
    """k = c p^m gives w = p^(1-m)/(c (1-m)) exactly."""
    law = JointLaw(model=Given("bare", k_n=lambda p: 1e9 * p**0.5, k_t=lambda p: 8e8 * p**0.5))
    w = np.geomspace(1e-12, 1e-6, 7)
    assert law.pressure(w)[0] == pytest.approx((w * 1e9 * 0.5) ** 2, rel=1e-8)


def test_faces_meet_under_a_law_that_grows_in_proportion_to_pressure():
    """k = p/s means p = p0 exp((w - w0)/s): the first touch lies a few s away, where that law had it infinitely far."""
    s = 0.4e-6
    law = JointLaw(model=Given("bare", k_n=lambda p: p / s), tangential="mindlin")
    first = law.approach(law.least_pressure)
    assert 0 < first <= 3 * s * (1 + 1e-9)
    for pressure in (1e3, 1e6, 1e8):
        expected = first + s * np.log(pressure / law.least_pressure)
        assert law.approach(pressure) == pytest.approx(expected, rel=1e-6)
        assert law.pressure(np.array([expected]))[0] == pytest.approx(pressure, rel=1e-5)
    assert law.pressure(np.array([0.0, -1e-9]))[0].tolist() == [0, 0]


def test_outside_validity_counts_stiffness_and_no_area():
    """k_n = C p: a point at a hundredth of the pressure has a hundredth of the stiffness. Below 1 % nothing is said."""

    class Light(Given):
        def at_pressure(self, pressure):
            found = super().at_pressure(pressure)
            return replace(found, reasons={"light": found.pressure < 2e6, "heavy": found.pressure > 8e6})

    law = JointLaw(model=Light(k_n=lambda p: 1e6 * p, k_t=lambda p: 8e5 * p))
    pressure, area = np.array([0.0, 1e5, 1e6, 4e6, 10e6]), np.array([5.0, 1.0, 2.0, 1.0, 0.3])
    shares = law.outside_validity(pressure, area)
    assert shares == pytest.approx({"light": 2.1 / 9.1, "heavy": 3.0 / 9.1}, abs=1e-6)
    assert law.outside_validity(pressure[[1, 3]], area[[1, 3]] * [0.3, 1.0]) == {}
    assert law.outside_validity(pressure[:1], area[:1]) == {}


@pytest.mark.parametrize("scan_area", [None, 16e-6])
def test_springs_per_node_are_those_of_the_law_at_the_force_of_each_node(scan_area):
    """The paper's use: a node's force on the scan's area gives the node's spring.

    What is reported is what is assembled.
    """
    mesh = stack([0.03, 0.03], [2, 2], width=0.02, height=0.02)
    faces = "p0.right", "p1.left"
    law = JointLaw(model=Given(k_n=lambda p: 3e9 * p**0.5, k_t=lambda p: 2e9 * p**0.5, loss_n=lambda p: 0.1 + 0 * p))
    joint = FittedJoint(
        name="j", faces=faces, interface=join(mesh, *faces), law=law, per_node=True, scan_area=scan_area
    )
    pressure = 1e6 + 2e7 * joint.interface.positions[:, 1]
    springs = joint.springs(pressure)
    force = springs.pressure * springs.interface.weights
    assert force.sum() == pytest.approx(joint.interface.weights @ pressure, rel=1e-2)  # nodes share what varies
    area = scan_area or 1.0
    assert springs.k_n * springs.interface.weights == pytest.approx(3e9 * (force / area) ** 0.5 * area, rel=1e-5)
    assert springs.k_t / springs.k_n == pytest.approx(np.full(len(force), 2 / 3), rel=1e-5)
    along = np.zeros((len(mesh.points), 3))
    along[mesh.part_nodes("p1"), 0] = 1.0
    assert along.ravel() @ (springs.stiffness() @ along.ravel()) == pytest.approx(springs.total()[0], rel=1e-12)
    assert along.ravel() @ (springs.loss() @ along.ravel()) == pytest.approx(0.1 * springs.total()[0], rel=1e-9)


def test_structures_that_differ_in_their_laws_share_what_is_assembled():
    from dataclasses import replace

    mesh = stack([0.03, 0.03], [2, 2], width=0.02, height=0.02)
    faces = "p0.right", "p1.left"
    joint = FittedJoint(name="j", faces=faces, interface=join(mesh, *faces), law=JointLaw(model=LAW))
    first = Structure(mesh=mesh, materials=dict.fromkeys(mesh.parts, faying.CATALOGUE["45 steel"]), joints=(joint,))
    other = replace(first, joints=(replace(joint, law=JointLaw(model=LAW, scale=2.0)),))
    assert other.matrices[0] is first.matrices[0]
    fixed = replace(first, supports=(Support(face="p0.left"),))
    assert len(fixed.fixed)
    assert not len(first.fixed)


def given(k_n, **changes):
    return JointLaw(model=Given(**({"k_n": k_n, "k_t": lambda p: 0.5 * k_n(p)} | changes)))


def test_scale_multiplies_every_stiffness():
    """Twice as stiff: both springs double and the faces close by half, whichever slope the law closes by."""
    k = lambda p: 1e9 * np.sqrt(p)  # noqa: E731
    for more in ({}, {"k_load": lambda p: 0.7 * k(p)}):
        one = given(k, **more)
        two = JointLaw(model=one.model, scale=2.0)
        p = np.geomspace(10.0, 1e8, 7)
        assert np.array(two.stiffness(p)) == pytest.approx(2 * np.array(one.stiffness(p)), rel=1e-12)
        assert two.approach(1e6) == pytest.approx(one.approach(1e6) / 2, rel=1e-9)


@pytest.mark.parametrize("least", [0.0, 1e4])
def test_below_its_least_pressure_a_law_goes_on_as_the_power_it_was(least):
    """k = c p^0.6: w = p^0.4/(0.4 c) everywhere, and the law itself is asked from its least pressure on."""
    law = given(lambda p: 1e9 * p**0.6)
    law.model.least_pressure = least
    low = max(least, 1.0)
    p = low * np.array([0.01, 0.3, 1.0005, 1.2, 50.0])
    assert law.stiffness(p)[0] == pytest.approx(1e9 * p**0.6, rel=1e-6)
    found, slope = law.pressure(p**0.4 / 0.4e9)
    assert found == pytest.approx(p, rel=1e-5)
    assert slope == pytest.approx(1e9 * p**0.6, rel=1e-4)
    assert law.least_pressure == pytest.approx(low, rel=2e-3)
    assert low <= law.least_pressure


def test_beyond_its_end_a_law_goes_on_without_a_kink():
    """The exponent at the end is another than at the beginning: 0.9 against 0.2."""
    law = given(lambda p: 1e9 * p**0.2 * (1 + p / 1e4) ** 0.7, greatest_pressure=1e7)
    end = law.approach(1e7)
    (low, high), slopes = law.pressure(end * np.array([1 - 1e-6, 1 + 1e-6]))
    assert slopes[1] == pytest.approx(slopes[0], rel=1e-4)
    assert high - low == pytest.approx(2e-6 * end * slopes[0], rel=1e-3)
    far, _ = law.pressure(np.array([1.5 * end]))
    power = end * slopes[0] / 1e7
    assert far[0] == pytest.approx(1e7 * 1.5**power, rel=1e-3)


def test_stiffness_in_proportion_to_pressure_closes_as_a_logarithm():
    """From 1 kPa on k = p/s, as of an exponential law: w(p2) - w(p1) = s ln(p2/p1)."""
    s = 1e-7
    law = given(lambda p: np.where(p < 1e3, np.sqrt(p * 1e3), p) / s)
    assert law.approach(1e6) - law.approach(1e4) == pytest.approx(s * np.log(100.0), rel=1e-8)


def test_open_points_lose_nothing_however_many_there_are():
    law = given(lambda p: 1e9 * p**0.5, loss_n=lambda p: 0.2 + 0 * p, loss_t=lambda p: 0.1 + 0 * p)
    for count in (5, 500):
        p = np.where(np.arange(count) % 2, 1e6, 0.0)
        n, t = law.loss(p)
        assert n[p > 0] == pytest.approx(0.2)
        assert t[p > 0] == pytest.approx(0.1)
        springs = law.stiffness(p)[0]
        assert np.all(springs[p == 0] * n[p == 0] == 0)


def test_stiffness_between_the_pressures_of_the_table_is_that_of_the_law():
    """Linear in ln p at 1 % of p: what the law bends within a step is left, but for one step at each of its kinks."""
    p = np.geomspace(10.0, 4e7, 5000)
    k_n, k_t = JointLaw(model=LAW).stiffness(p)
    at = LAW.at_pressure(p)
    for found, exact in ((k_n, at.k_n), (k_t, at.k_t)):
        assert np.quantile(np.abs(found / exact - 1), 0.99) < 1e-5


@pytest.mark.parametrize("count", [3, 500])
def test_a_scaled_law_with_another_ratio_or_end_has_tables_of_its_own(count):
    """k_t = 0.4 k_n and the low end of a stated range, after a factor on the stiffness was put on."""
    given = {"k_n": lambda p: 1e9 * p**0.5, "k_t": lambda p: 8e8 * p**0.5, "k_n_low": lambda p: 6e8 * p**0.5}
    law = JointLaw(model=Given(**given, k_n_high=lambda p: 2e9 * p**0.5)).scaled(0.5)
    p = np.geomspace(1e3, 1e7, count)
    assert law.stiffness(p)[0] == pytest.approx(5e8 * p**0.5)
    k_n, k_t = replace(law, tangential=0.4).stiffness(p)
    assert k_t == pytest.approx(0.4 * k_n)
    low = replace(law, end="low")
    assert low.stiffness(p)[0] == pytest.approx(3e8 * p**0.5)
    assert low.pressure(np.array([low.approach(1e6)]))[1][0] == pytest.approx(3e8 * 1e3, rel=1e-6)
