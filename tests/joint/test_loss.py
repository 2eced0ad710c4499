"""The loss factor by its definition: energy lost in a cycle over 2 pi times the energy stored, in laws and in modes."""

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array

import faying
from faying.contact.models.half_space import HalfSpace
from faying.contact.models.tabulated import TabulatedLaw
from faying.joint.joint_law import JointLaw
from faying.numerics.damped import damped_modes
from faying.numerics.modes import lowest_modes
from faying.surface.scan import Scan
from tests.helpers.scans import gaussian

STEEL = faying.CATALOGUE["45 steel"]
PAIR = faying.ContactPair(STEEL, STEEL)
PRESSURE, AREA = 20e6, 1e-4


def half_space(**options):
    z = gaussian(0.8, 0.06e-3, 8e-6, 1e-6, 5, points=64, side=0.5e-3)
    scan = Scan(heights=z, spacing=(0.5e-3 / 64,) * 2)
    return HalfSpace(scan, PAIR, points=4, lowest=5e6, highest=80e6, **options)


LAWS = {
    "jk": faying.JK(D=2.39, G=1.53e-10, scan_area=16e-6, pair=PAIR),
    "literal jk": faying.JK(D=2.39, G=1.53e-10, scan_area=16e-6, pair=PAIR, loss="literal"),
    "table": TabulatedLaw(
        pressure=[1e6, 1e8], k_n=[1e13, 1e15], k_t=[8e12, 8e14], loss_n=[0.05, 0.02], loss_t=[0.1, 0.06]
    ),
    "half-space, slipping": half_space(shear_ratio=0.6),
}


@pytest.mark.parametrize("name", LAWS)
def test_two_masses_on_a_joint_have_the_loss_factor_of_its_law(name):
    """Two free masses on one spring: w^2 (1 + i eta) = k (1 + i eta) (1/m1 + 1/m2)."""
    law = JointLaw(model=LAWS[name])
    k_n, k_t = law.stiffness(np.array([PRESSURE]))
    loss_n, loss_t = law.loss(np.array([PRESSURE]))
    assert law.predicts_loss
    m = np.array([0.3, 0.8])
    for k, eta in ((k_n, loss_n), (k_t, loss_t)):
        spring = float(k[0]) * AREA * csr_array([[1.0, -1.0], [-1.0, 1.0]])
        mass = diags_array(m).tocsr()
        modes = lowest_modes(spring, mass, 2, shift_frequency=100.0)
        found = damped_modes(modes, spring, mass, float(eta[0]) * spring, rigid=1)
        assert found.loss_factors[0] == pytest.approx(float(eta[0]), rel=1e-4, abs=1e-12)
        expected = np.sqrt(float(k[0]) * AREA * (1 / m).sum()) / (2 * np.pi)
        assert found.frequencies[0] == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("name", LAWS)
def test_energy_lost_in_a_cycle_is_two_pi_times_the_loss_factor_times_what_is_stored(name):
    """The force k (1 + i eta) x, integrated over the path of one period in time."""
    law = JointLaw(model=LAWS[name])
    k, eta = float(law.stiffness(np.array([PRESSURE]))[1][0]), float(law.loss(np.array([PRESSURE]))[1][0])
    t = np.linspace(0, 1, 20_001)
    x = 1e-9 * np.cos(2 * np.pi * t)
    force = (k * (1 + 1j * eta) * 1e-9 * np.exp(2j * np.pi * t)).real
    lost = float(np.trapezoid(force, x))
    assert lost == pytest.approx(2 * np.pi * eta * (0.5 * k * 1e-18), rel=1e-6)


def test_slip_of_the_half_space_loses_what_its_loop_encloses():
    """Masing: the loop of a full swing is the first loading curve twice as large; its area over 2 pi T delta/2."""
    law = half_space(shear_ratio=0.6)
    solved = float(law.series.pressure[2])
    contact = law.contact_at(solved)
    ratios = np.linspace(0, 0.6, 31)
    slips = [contact.slip(float(r), PAIR.friction) for r in ratios[1:]]
    force = np.array([0.0, *(s.tangential_pressure for s in slips)])
    moved = np.array([0.0, *(s.displacement for s in slips)])
    under = float(np.trapezoid(force, moved))
    # loop between +T and -T: 8 times the area between the loading curve and its chord
    loop = 8 * (under - force[-1] * moved[-1] / 2)
    stored = force[-1] * moved[-1] / 2
    assert float(law.at_pressure(solved).loss_t) == pytest.approx(loop / (2 * np.pi * stored), rel=0.02)


def test_the_paper_s_ratio_is_two_pi_times_the_loss_factor():
    """Eqs. 49-53 are dissipated over stored energy; in the small stage nearly alpha/(1 - alpha)."""
    law = LAWS["jk"]
    al = np.geomspace(1e-14, 1e-8, 7)
    normal, tangential = law.specific_damping(al)
    said = law.at_closure(al)
    assert 2 * np.pi * said.loss_n == pytest.approx(normal, rel=1e-12)
    assert 2 * np.pi * said.loss_t == pytest.approx(tangential, rel=1e-12)
    assert law.assumptions == ("its loss rests on an assumed elastic-plastic load index, alpha = 0.2",)


def test_a_law_without_a_loss_predicts_none():
    law = JointLaw(model=half_space())
    answer = law.model.at_pressure(PRESSURE)
    assert answer.loss_n is None
    assert answer.loss_t is None
    assert not law.predicts_loss
