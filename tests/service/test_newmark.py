"""Random vibration against integration in time of the reduced structure, its sliders opening, closing and slipping.

Three structures at three levels each, the last with two joints. The noise ends at twice the first mode, so that one
mode leads. A linear mode under the same noise, with the damping and the frequency that are tested, takes out most of
what the sample is off by: 1 % of the rms is left.
"""

import numpy as np
import pytest

import faying
from faying.fe.interface import join
from faying.joint.attachments import Support
from faying.joint.joint import FittedJoint
from faying.joint.joint_law import JointLaw
from faying.joint.structure import Structure
from faying.microslip.levels import cut_laws, level_basis, level_model
from faying.service.excited import Excited
from tests.helpers.bars import SIMPLE
from tests.helpers.boxes import row
from tests.helpers.laws import Given
from tests.helpers.plates import stacked
from tests.helpers.shaken import integrated_joints

pytestmark = pytest.mark.slow
ROOT = 2e13 / np.sqrt(5e6)  # k_n = ROOT sqrt(p): a curve p(w) that is a parabola
LAW = JointLaw(model=Given(k_n=lambda p: ROOT * np.sqrt(p), k_t=lambda p: 0.8 * ROOT * np.sqrt(p)))
COPIES, DECAYS = 64, 10  # realisations, and how many times each forgets its energy


def built(mesh, pairs, seats, support, friction):
    joints = tuple(
        FittedJoint(name=f"j{k}", faces=faces, interface=join(mesh, *faces), law=LAW, friction=friction)
        for k, faces in enumerate(pairs)
    )
    return Structure(
        mesh=mesh,
        materials=dict.fromkeys(mesh.parts, SIMPLE),
        joints=joints,
        bolts=(faying.Bolt("b", seats),),
        supports=[Support(face=support)],
    ).solve(preload=3e3, modes=4)


@pytest.fixture(scope="module")
def states():
    one, two = (
        row([length] * n, [1] * n, kinds=("hex20",) * n, sections=((1, 1),) * n, width=0.02, height=0.014)
        for n, length in ((2, 0.03), (3, 0.01))
    )
    plates = stacked(counts=(2, 1, 1))
    return {
        "beam": built(one, [("p0.right", "p1.left")], ("p0.left", "p1.right"), "p0.left", 0.1),
        "plates": built(plates, [("low.top", "high.bottom")], ("low.bottom", "high.top"), "low.left", 0.2),
        "stack": built(
            two, [("p0.right", "p1.left"), ("p1.right", "p2.left")], ("p0.left", "p2.right"), "p0.left", 0.1
        ),
    }


@pytest.mark.parametrize(
    ("name", "density", "rms"),
    [
        ("beam", 3.0, 0.05),
        ("beam", 8.0, 0.05),
        ("beam", 6.0, 0.05),
        ("plates", 2e-5, 0.05),
        ("plates", 3e-4, 0.05),
        ("plates", 3.5e-3, 0.05),
        ("stack", 1.0, 0.05),
        ("stack", 3.0, 0.05),
        ("stack", 10.0, 0.05),
    ],
)
def test_the_leading_mode_has_the_rms_and_the_damping_of_integration_in_time(states, name, density, rms):
    """Slip adds 0.3 to 3 times the damping at rest; rms to 5 %, damping to 10 %."""
    state = states[name]
    structure, first = state.structure, state.frequencies[0]
    noise = faying.Excitation("n", psd=[(f, density) for f in (first / 50, 2 * first)])
    (found,) = faying.vibration(state, [noise])
    excited = Excited.of(structure, state.springs, state.vibration, noise)
    speed, damping = 2 * np.pi * found.frequency[1, 0], found.damping[1, 0]
    sigma = found.level[1, 0] / (speed**2 * excited.greatest[0])
    laws = cut_laws(structure, state.preload, [joint.friction for joint in structure.joints], 12)
    basis = level_basis(structure, state.preload, state.vibration, [laws], 3 * found.level[1, 0] * np.eye(4)[0])
    slip = level_model(structure, state.preload, basis, laws).slip
    got = integrated_joints(
        slip,
        abs(excited.force[0]),
        density=density,
        rest=found.rest_damping[1, 0],
        linear=(speed, damping),
        time=DECAYS / (damping * speed),
        copies=COPIES,
    )
    assert sigma == pytest.approx(got.sigma(sigma), rel=rms)
    assert damping == pytest.approx(got.damping, rel=0.1)


def test_a_beam_that_slides_at_less_than_two_sigma_says_so(states):
    """Under 20 N2/Hz integration in time has 8.7 % less rms."""
    first = states["beam"].frequencies[0]
    noise = faying.Excitation("n", psd=[(f, 20.0) for f in (first / 50, 2 * first)])
    (found,) = faying.vibration(states["beam"], [noise])
    assert 3 * found.slip_margin[1, 0] < 2
    assert [note.code for note in found.notes if note.severity == "wrong"] == ["vibration-beyond"]
