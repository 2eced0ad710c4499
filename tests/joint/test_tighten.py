"""Bolts tightened one after another: against springs by hand, all at once, and what an order must name."""

import numpy as np
import pytest

import faying
from faying.bolt.bolt import Bolt
from faying.joint.tighten import tighten
from tests.helpers.laws import Given
from tests.helpers.plates import STEEL, plates, stacked

FACES = ("high.top", "low.bottom")
RIGID_LIKE = faying.Material(name="stiff", E=2e12, nu=0.0, density=7800.0)


def bed(k):
    """k_n = k everywhere it matters: a bed of springs, so that two bolts on it can be worked out by hand."""
    stiffness = lambda p: k * np.sqrt(p / (p + 1e3))  # noqa: E731  rises from zero, then stays
    return Given("bed", 1e12, k_n=stiffness, k_t=stiffness)


def two_bolts(material=RIGID_LIKE, k=1e10, thickness=0.03):
    bolts = tuple(
        Bolt(name=name, faces=FACES, at=(x, 0.02, 0.0), seat=(0.0, 24e-3), diameter=8e-3, material=STEEL)
        for name, x in (("one", 0.03), ("two", 0.05))
    )
    return plates(stacked(counts=(8, 4, 1), size=(0.08, 0.04, thickness)), material=material, bolts=bolts, law=bed(k))


def test_two_bolts_in_turn_against_springs_by_hand():
    """Rigid plates on a bed of springs k: bolt two closes and tilts the joint, and relaxes bolt one.

    Bed: axial A k, tilt k b a^3/12 about the middle. Bolt one, once tight: a spring c at -x, and EI/L against tilt.
    """
    made = two_bolts()
    k, a, b, x = 1e10, 0.08, 0.04, 0.01
    bolt = made.fitted_bolts[0]
    c, bending = bolt.axial_stiffness, STEEL.E * np.pi / 64 * 8e-3**4 / bolt.length
    F1, F2 = 4e3, 5e3
    bed = np.diag([k * a * b, k * b * a**3 / 12])
    at_one, at_two = np.array([1.0, -x]), np.array([1.0, x])
    before = np.linalg.solve(bed, F1 * at_one)
    shank = c * np.outer(at_one, at_one) + np.diag([0.0, bending])
    after = np.linalg.solve(bed + shank, F1 * at_one + shank @ before + F2 * at_two)
    left = F1 - c * (at_one @ after - at_one @ before)
    found = tighten(made, made.assembly(), [F1, F2], order=(0, 1))
    assert found.bolt_forces[1] == pytest.approx(F2, rel=1e-9)
    assert found.bolt_forces[0] - F1 == pytest.approx(
        left - F1, rel=0.02
    )  # the plates give a little, the bed is not a law
    assert found.bolt_forces[0] < F1
    joint = made.joints[0].interface
    assert joint.weights @ found.pressures[0] == pytest.approx(sum(found.bolt_forces), rel=1e-6)


def test_more_passes_approach_the_forces_asked_for():
    made = two_bolts(STEEL)
    miss = [abs(tighten(made, made.assembly(), [4e3, 4e3], order=(0, 1) * n).bolt_forces[0] - 4e3) for n in (1, 2, 3)]
    assert miss[0] > 2 * miss[1] > 4 * miss[2]


def test_all_at_once_gives_every_bolt_its_force():
    made = two_bolts(STEEL)
    found = tighten(made, made.assembly(), [4e3, 5e3])
    assert found.bolt_forces == (4e3, 5e3)
    assert made.joints[0].interface.weights @ found.pressures[0] == pytest.approx(9e3, rel=1e-8)


def test_an_order_leaves_the_assembly_as_it_was():
    made = two_bolts(STEEL)
    assembly = made.assembly()
    tighten(made, assembly, [4e3, 4e3], order=(1, 0))
    again = tighten(made, assembly, [4e3, 4e3])
    fresh = tighten(made, made.assembly(), [4e3, 4e3])
    assert again.pressures[0] == pytest.approx(fresh.pressures[0], rel=1e-7)


def test_messages():
    made = two_bolts(STEEL)
    with pytest.raises(faying.InputError, match=r"must name every bolt; it misses \['two'\]"):
        tighten(made, made.assembly(), [1e3, 1e3], order=(0, 0))
    with pytest.raises(faying.InputError, match="must name every bolt"):
        tighten(made, made.assembly(), [1e3, 1e3], order=(0, 1, 2))
    bare = plates(
        bolts=(
            *(
                Bolt(name=n, faces=FACES, at=(x, 0.02, 0.0), seat=(0.0, 24e-3))
                for n, x in (("one", 0.03), ("two", 0.05))
            ),
        )
    )
    with pytest.raises(faying.InputError, match="bolts one, two have no shank"):
        tighten(bare, bare.assembly(), [1e3, 1e3], order=(0, 1))


def test_a_joint_far_softer_than_its_parts_converges_to_what_rounding_leaves():
    """Steel on a bed of 0.1 N/mm3: digits lost in K u keep the imbalance above 1e-10.

    The force is still that of the bolts.
    """
    made = two_bolts(STEEL, k=1e8)
    found = made.assembly().solve(40.0 * made.loads[:, 0])
    assert found.imbalance < 1e-8
    lost = np.linalg.norm(abs(made.matrices[0]) @ np.abs(found.displacement)) / np.linalg.norm(40.0 * made.loads[:, 0])
    assert found.imbalance < 4 * np.finfo(float).eps * lost
    assert made.joints[0].interface.weights @ found.pressures[0] == pytest.approx(40.0, rel=1e-6)
