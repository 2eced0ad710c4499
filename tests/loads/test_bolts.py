"""Forces of bolts under loads: meshed ones against what presses their heads, beams against the cut through a joint."""

import numpy as np
import pytest

import faying
from faying.case.acting import acting, nothing
from faying.loads.solve import of_state, solved, statics_of
from tests.bolt.test_solid_bolt import structure
from tests.helpers.voxels import bolted

PRELOAD = 5e3


@pytest.fixture(scope="module")
def meshed():
    """Two plates under a meshed bolt of a material that expands, and cases on the upper plate."""
    made = structure(bolted(kind="hex8"))
    warm = faying.Material(name="warm", E=200e9, nu=0.3, density=7800.0, expansion=12e-6)
    made = faying.Structure(made.mesh, warm, made.joints, made.bolts)
    state = made.solve(PRELOAD, modes=2)
    top, low = "upper.seat0", "lower.seat0"

    def pair(force, moment=(0, 0, 0)):
        """A force and a moment about one point on both plates, which balance."""
        back = [-np.array(one) for one in (force, moment)]
        return [
            faying.Force(top, force=force, moment=moment, point=(0, 0, 0)),
            faying.Force(low, force=tuple(back[0]), moment=tuple(back[1]), point=(0, 0, 0)),
        ]

    loads = [
        faying.Load("pull", forces=pair((0, 0, 800.0))),
        faying.Load("bend", forces=pair((40.0, 0, 0), (2.0, 3.0, 0))),
        faying.Load("hot bolt", temperature={"bolt0": "40 K"}),
        faying.Load("hot plates", temperature={"lower": "20 K", "upper": "20 K"}),
    ]
    return state, loads, faying.load_cases(state, loads, modes=False)


def test_a_meshed_bolt_carries_what_presses_its_head(meshed):
    """Tension, force across and bending moment are those of the tractions under its head."""
    state, loads, found = meshed
    made = state.structure
    head = [joint.name for joint in made.joints].index("bolt0.head")
    assert found.bolt_force[:, 0] == pytest.approx(found.normal_force[:, head], rel=1e-7)
    assert found.bolt_force[0, 0] > PRELOAD
    assert found.bolt_force[2, 0] < PRELOAD < found.bolt_force[3, 0]
    statics = statics_of(of_state(state, modes=False))
    states = solved(statics, statics.rest_state(nothing(made)), loads, acting(made, loads))
    interface, contact = made.joints[head].interface, statics.joints[head][1]
    arm = interface.positions - made.bolts[0].place(made.mesh)
    axis = made.fitted_bolts[0].seats[1] - made.fitted_bolts[0].seats[0]
    axis /= np.linalg.norm(axis)
    before = contact.advance(contact.start, contact.rest)[1]
    for row, load in enumerate(loads):
        traction = states[load.name][-1].tractions[head] - before
        force = np.einsum("q,qi,qij->qj", interface.weights, traction, interface.frames)
        total, moment = force.sum(axis=0), np.cross(arm, force).sum(axis=0)
        across, bending = (one - (one @ axis) * axis for one in (total, moment))
        assert found.bolt_shear[row, 0] == pytest.approx(np.linalg.norm(across), rel=1e-5, abs=1e-3)
        assert found.bolt_moment[row, 0] == pytest.approx(np.linalg.norm(bending), rel=1e-5, abs=1e-5)
    assert found.bolt_moment[1, 0] > 1e-3


def test_a_share_of_the_load_and_the_rest_of_the_clamp_force(meshed):
    """What acts on the upper plate is what the bolt gains and the joint between the plates loses."""
    _, _, found = meshed
    joint = found.joints.index("lower.joint")
    change = found.bolt_force[:, 0] - PRELOAD
    lost = found.normal_preload[joint] - found.normal_force[:, joint]
    # a case ends where 1e-7 of its forces is left, and those of heat are 77 kN
    assert change + lost == pytest.approx([800, 0, 0, 0], abs=0.01)
    assert found.working_load[:, 0] == pytest.approx([800, 0, 0, 0], abs=0.01)
    assert found.load_factor[0, 0] == pytest.approx(change[0] / 800, rel=1e-5)
    assert np.isnan(found.load_factor[2, 0])
    assert np.isnan(found.seat_pressure).all()  # its heads meet their seats in joints, which have their own pressure
