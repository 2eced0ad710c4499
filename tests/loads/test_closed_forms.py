"""Load cases on two bars under a bolt, where all is one-dimensional."""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.case.case import Progress
from faying.case.service_bolts import service_bolts
from faying.fe.bonded import bonded_mesh
from faying.fe.interface import join
from faying.joint.attachments import PointMass, Support
from faying.loads.contact import LoadedContact
from faying.loads.solve import Preloaded, answers, near_factor, of_state
from tests.helpers.bars import AREA, LENGTH, SIMPLE, WIDTH, bars
from tests.helpers.boxes import row

PRELOAD = 5000.0


@pytest.fixture(scope="module")
def free():
    """Bars that nothing holds, under their preload."""
    made = bars()
    return made, made.structure.solve(PRELOAD, modes=2)


@pytest.fixture(scope="module")
def held():
    """Bars held by the left end."""
    made = bars(held=True)
    return made, made.structure.solve(PRELOAD, modes=2)


def pair(name, force, **more):
    """A force that pulls both ends apart."""
    ends = [faying.Force("p0.left", force=(-force, 0, 0)), faying.Force("p1.right", force=(force, 0, 0))]
    return faying.Load(name, forces=ends, **more)


def test_a_load_at_the_seats_is_shared_as_the_compliances_say_until_the_joint_opens(free):
    made, state = free
    opens = PRELOAD / (1 - made.share)  # the load that takes the last of the clamp force
    forces = np.array([-2000.0, 1.0, 2000.0, 0.999 * opens, 1.001 * opens, 1.5 * opens])
    found = faying.load_cases(state, [pair(f"{k}", force) for k, force in enumerate(forces)], modes=False)
    wanted = np.where(forces < opens, PRELOAD + made.share * forces, forces)
    assert found.bolt_force[:, 0] == pytest.approx(wanted, rel=1e-8)
    assert found.bolt_force_linear[:, 0] == pytest.approx(PRELOAD + made.share * forces, rel=1e-8)
    shut = forces < opens
    assert found.opened[:, 0] == pytest.approx(np.where(shut, 0.0, 1.0), abs=1e-12)
    assert found.normal_force[:, 0] == pytest.approx(np.where(shut, wanted - forces, 0.0), rel=1e-7, abs=1e-6)
    assert found.mean_pressure[:, 0] == pytest.approx(found.normal_force[:, 0] / AREA, rel=1e-12)
    assert found.working_load[:, 0] == pytest.approx(forces, rel=1e-7)
    assert np.isnan(found.load_factor[1, 0])  # of 1 N: too little beside the preload
    assert found.load_factor[[0, 2, 3], 0] == pytest.approx(made.share, rel=1e-6)
    assert list(found.superposes) == [*shut[:4], *shut[4:]]
    assert {note.code for note in found.notes} >= {"load-opens"}


def test_modes_keep_their_frequency_while_a_joint_of_one_stiffness_is_shut(free):
    """Under any such load; where the joint opens, the bolt alone holds the bars together, and they are softer."""
    made, state = free
    opens = PRELOAD / (1 - made.share)
    found = faying.load_cases(state, [pair("shut", 0.9 * opens), pair("open", 1.2 * opens)])
    assert found.rest_frequency == pytest.approx(state.modes.frequencies, rel=1e-6)
    assert found.frequency_change[0] == pytest.approx(0, abs=1e-7)
    assert np.all(found.frequency_change[1] < -0.1)
    assert found.likeness[0] == pytest.approx(1, abs=1e-3)


def test_a_joint_without_friction_carries_pressure_alone():
    """Its shear is nothing, and the load at the seats is shared as with friction."""
    made = bars(friction=0.0)
    found = faying.load_cases(made.structure.solve(PRELOAD, modes=2), [pair("pull", 2000.0)], modes=False)
    assert found.bolt_force[0, 0] == pytest.approx(PRELOAD + 2000 * made.share, rel=1e-7)
    assert found.shear_force[0, 0] == pytest.approx(0, abs=1e-6)
    assert found.slip_margin.shape == (1, 1)


def test_heat_of_bolt_and_bars(free):
    """dF = l (alpha_P dT_P - alpha_S dT_S)/(delta_S + delta_P), and nothing where all is heated alike."""
    made, state = free
    loads = [
        faying.Load("bars", temperature={"p0": "60 K", "p1": "60 K"}),
        faying.Load("bolt", temperature={"b": 40.0}),
        faying.Load("all", temperature={"p0": 50.0, "p1": 50.0, "b": 50.0}),
        faying.Load("one", temperature={"p0": 30.0}),
    ]
    found = faying.load_cases(state, loads, modes=False)
    per_kelvin = 2 * LENGTH * SIMPLE.expansion / (made.bolt + made.members)
    change = found.bolt_force[:, 0] - PRELOAD
    assert change == pytest.approx(per_kelvin * np.array([60, -40, 0, 15]), rel=1e-6, abs=1e-6 * PRELOAD)
    assert found.normal_force[:, 0] - PRELOAD == pytest.approx(change, rel=1e-6, abs=1e-6 * PRELOAD)
    assert found.working_load[:, 0] == pytest.approx(0, abs=1e-6 * PRELOAD)


def test_even_heat_leaves_a_bolt_with_washers_alone():
    """What all expands alike changes no force: washers grow as the bolt does."""
    made = bars(held=False)
    old = made.structure
    washer = faying.Washer(outer=0.016, inner=0.009, thickness=0.004, material=SIMPLE)
    bolt = replace(old.bolts[0], washers=(washer,))
    state = faying.Structure(old.mesh, old.materials, old.joints, (bolt,)).solve(PRELOAD, modes=2)
    found = faying.load_cases(state, [faying.Load("all", temperature={"p0": 50, "p1": 50, "b": 50})], modes=False)
    assert found.bolt_force[0, 0] == pytest.approx(PRELOAD, abs=1e-6 * PRELOAD)


def test_a_torque_needs_friction(held):
    """Of one bolt, without any force across: the torque over the friction that the pressure has about its centre."""
    made = bars(held=True, friction=0.3)
    state = made.structure.solve(PRELOAD, modes=2)
    torque = 5.0
    turn = faying.Load("turn", forces=[faying.Force("p1.right", moment=(torque, 0, 0))])
    found = faying.load_cases(state, [turn], modes=False)
    joint = state.structure.joints[0].interface
    press = joint.weights * found.pressure[0]
    arm = joint.positions - press @ joint.positions / press.sum()
    reach = press @ np.hypot(arm[:, 1], arm[:, 2]) / press.sum()
    shank = torque - found.torque[0, 0]  # what the bolt bears by its own torsion
    assert 0 <= shank < 0.1 * torque
    assert found.shear_force[0, 0] == pytest.approx(0, abs=1e-3 * torque / reach)
    assert found.friction_needed[0, 0] == pytest.approx(found.torque[0, 0] / reach / press.sum(), rel=1e-6)
    assert 1 < found.slip_margin[0, 0] < 3


def test_what_does_nothing_changes_nothing(held):
    state = held[1]
    loads = [
        faying.Load("none", pressures=[faying.Pressure("p1.right", 0.0)]),
        faying.Load("at rest", temperature={"p0": 0.0}),
        faying.Load("at the support", forces=[faying.Force("p0.left", force=(100.0, 0, 0))]),
    ]
    for load in loads:
        found = faying.load_cases(state, [load], modes=False)
        assert found.bolt_force[0, 0] == pytest.approx(PRELOAD, rel=1e-9)
        assert found.error[0] == 0
    with pytest.raises(faying.InputError, match="two loads are called 'none'"):
        faying.load_cases(state, [loads[0], loads[0]], modes=False)


def test_a_load_across_that_changes_no_bolt_force_superposes(held):
    """By symmetry the bolt keeps its force; what rounding makes of that is not a departure."""
    across = faying.Load("across", forces=[faying.Force("p1.right", force=(0, 1.0, 0))])
    found = faying.load_cases(held[1], [across], modes=False)
    assert found.superposition[0] < 0.05
    assert found.superposes[0]


def test_acceleration_pulls_by_the_mass_beyond_the_joint(held):
    """The joint loses, and the bolt gains, what the free bar and the free end of the bolt weigh under 1000 m/s2."""
    _, state = held
    found = faying.load_cases(state, [faying.Load("a", acceleration=(-1000.0, "0 m/s^2", 0))], modes=False)
    end = state.structure.fitted_bolts[0].mass @ np.tile([1.0, 0, 0], len(state.structure.mesh.points))
    right = state.structure.mesh.points[:, 0] > LENGTH * 1.5  # the seat of the nut
    beyond = SIMPLE.density * AREA * LENGTH + end.reshape(-1, 3)[right, 0].sum()
    assert found.working_load[0, 0] == pytest.approx(1000.0 * beyond, rel=1e-8)
    weight = 1000.0 * (state.structure.mass / 2 + end.reshape(-1, 3)[right, 0].sum())
    assert found.bolt_force[0, 0] - found.normal_force[0, 0] == pytest.approx(weight, rel=1e-8)


def test_acceleration_of_a_free_body_is_refused(free):
    """Its mass times the acceleration is left over."""
    made, state = free
    bolt = made.structure.fitted_bolts[0].mass @ np.tile([1.0, 0, 0], len(made.structure.mesh.points))
    force = 3.0 * (made.structure.mass + bolt.sum())
    with pytest.raises(faying.InputError, match=rf"load 'a' does not balance: forces of \({-force:.4g}, 0, 0\) N"):
        faying.load_cases(state, [faying.Load("a", acceleration=(3.0, 0, 0))])


def test_what_is_bonded_to_a_bar_pulls_with_it():
    """A third bar that is bonded to the second: the joint loses what both weigh."""
    made = bars(held=True, diameter=None)
    apart = row([LENGTH] * 3, [2] * 3, kinds=("hex20",) * 3, sections=((1, 1),) * 3, width=WIDTH, height=WIDTH)
    mesh = bonded_mesh(apart, [("weld", ("p1.right", "p2.left"))])
    assert len(mesh.points) < len(apart.points)
    joint = replace(made.structure.joints[0], interface=join(mesh, "p0.right", "p1.left"))
    bolt = faying.Bolt("b", ("p0.left", "p2.right"))
    structure = faying.Structure(
        mesh, dict.fromkeys(mesh.parts, SIMPLE), (joint,), (bolt,), supports=made.structure.supports
    )
    loads = [faying.Load("a", acceleration=(-500.0, 0, 0))]
    found = faying.load_cases(structure.solve(PRELOAD, modes=2), loads, modes=False)
    assert PRELOAD - found.normal_force[0, 0] == pytest.approx(500 * SIMPLE.density * AREA * 2 * LENGTH, rel=1e-8)


def test_numbers_that_are_none_are_no_answer(held, monkeypatch):
    """A law that ends in NaN stops the case by its name."""
    closing = LoadedContact.normal

    def broken(self, motion):
        pressure, slope = closing(self, motion)
        return np.where(pressure < 0.5 * PRELOAD / AREA, np.nan, pressure), slope

    monkeypatch.setattr(LoadedContact, "normal", broken)
    loads = [faying.Load("much", forces=[faying.Force("p1.right", force=(4000.0, 0, 0))])]
    with pytest.raises(faying.NotConverged, match="load 'much': no equilibrium is found"):
        faying.load_cases(held[1], loads, modes=False)


def test_a_point_mass_pulls_as_well():
    made = bars(held=True, diameter=None)
    heavy = faying.Structure(
        made.structure.mesh,
        made.structure.materials,
        made.structure.joints,
        made.structure.bolts,
        supports=made.structure.supports,
        masses=[PointMass(mass=0.5, face="p1.right")],
    )
    loads = [faying.Load("a", acceleration=(-100.0, 0, 0))]
    found = faying.load_cases(heavy.solve(PRELOAD, modes=2), loads, modes=False)
    bar = SIMPLE.density * AREA * LENGTH
    assert PRELOAD - found.normal_force[0, 0] == pytest.approx(100 * (bar + 0.5), rel=1e-8)


def test_pressure_is_force_over_area_and_loads_combine(held):
    _, state = held
    loads = [
        faying.Load("pull", pressures=[faying.Pressure("p1.right", "-2 MPa")]),
        faying.Load("force", forces=[faying.Force("p1.right", force=("800 N", 0, 0))]),
        faying.Load("both", combine={"pull": 0.5, "force": -2}, acceleration=(0, 0, 1e-9)),
    ]
    found = faying.load_cases(state, loads, modes=False)
    change = found.bolt_force[:, 0] - PRELOAD
    assert change[0] == pytest.approx(change[1], rel=1e-8)
    assert change[2] == pytest.approx(-1.5 * change[1], rel=1e-7)


def test_displacement_of_a_support(held):
    """Both ends held, one moved: joint and bolt change by the way over their compliances."""
    made, tight = held
    # a bolt between two ends that are held presses nothing: the bars are tightened first, then held
    both = faying.Structure(
        made.structure.mesh,
        made.structure.materials,
        made.structure.joints,
        made.structure.bolts,
        supports=[Support(face="p0.left"), Support(face="p1.right")],
    )
    base = Preloaded(
        title="bars",
        structure=both,
        preload=tight.preload,
        springs=tight.springs,
        factor=near_factor(both, tight.springs, None),
        rest=None,
        modes=lambda _: pytest.fail("no modes are asked for"),
        bolts=service_bolts(both),
    )
    move = 1e-7
    loads = (
        faying.Load("m", displacements=[faying.Displacement("p1.right", (move, "0 mm", 0))]),
        faying.Load("back", combine={"m": -2}),
    )
    found = answers(base, loads, Progress(0))
    ways = np.array([1, -2]) * move
    assert found.bolt_force[:, 0] == pytest.approx(PRELOAD + ways / made.bolt, rel=1e-8)
    assert found.normal_force[:, 0] == pytest.approx(PRELOAD - ways / made.members, rel=1e-8)
    assert found.displacement == pytest.approx(np.abs(ways), rel=1e-8)
    assert found.bolt_force_linear[:, 0] == pytest.approx(found.bolt_force[:, 0], rel=1e-8)  # no spring changes here
    assert found.superposition == pytest.approx(0, abs=1e-6)


def test_a_rigid_motion_of_all_supports_does_nothing(held):
    """100 mm along an axis strain nothing: no force of a bolt changes, nothing slides, superposition holds."""
    load = faying.Load("m", displacements=[faying.Displacement("p0.left", ("100 mm", "40 mm", "-70 mm"))])
    push = faying.Load("push", forces=[faying.Force("p1.right", force=(70.0, 0, 0))])
    pull = faying.Load("pull", forces=[faying.Force("p1.right", force=(-70.0, 0, 0))])
    nothing = faying.Load("nothing", combine={"push": 1.0, "pull": 1.0})
    found = faying.load_cases(held[1], [load, push, pull, nothing], modes=False)
    assert found.superposition[3] == pytest.approx(0, abs=1e-6)  # not one rounding over another
    assert found.displacement[0] == pytest.approx(np.linalg.norm([0.1, 0.04, 0.07]), rel=1e-9)
    assert found.bolt_force[0] == pytest.approx(found.bolt_preload, abs=1e-3)
    assert found.normal_force[0] == pytest.approx(found.normal_preload, abs=1e-3)
    assert found.superposition[0] == pytest.approx(0, abs=1e-6)


def test_two_displacements_of_one_face_are_refused(held):
    """Unless they say the same, or speak of different directions."""
    move = [faying.Displacement("p0.left", (1e-6, 0, 0)), faying.Displacement("p0.left", ("2 um", 0, 0))]
    with pytest.raises(faying.InputError, match=r"'p0.left' is moved along x by 2 um, and some of its nodes by 1 um"):
        faying.load_cases(held[1], [faying.Load("m", displacements=move)], modes=False)
    same = [move[0], faying.Displacement("p0.left", (1e-6, 0, 1e-6))]
    found = faying.load_cases(held[1], [faying.Load("m", displacements=same)], modes=False)
    assert found.displacement[0] == pytest.approx(np.sqrt(2) * 1e-6, rel=1e-6)  # all of it moves as one
    assert found.bolt_force[0, 0] == pytest.approx(PRELOAD, rel=1e-8)


def test_ranges_of_factors_and_temperatures():
    for given, text in (
        ({"combine": {"a": 1001.0}}, r"combine takes 'a' 1001 times; give a factor from -1000 to 1000"),
        ({"temperature": {"p0": "-474 K"}}, r"temperature of 'p0' changes by -474 K; give a change since"),
        ({"temperature": {"p0": 2001.0}}, "-473 to 2000 K"),
    ):
        with pytest.raises(faying.InputError, match=text):
            faying.Load("far", **given)


def test_a_load_that_nothing_holds_is_refused(free):
    _, state = free
    with pytest.raises(faying.InputError, match=r"load 'a' does not balance: forces of \(100, 0, 0\) N"):
        faying.load_cases(state, [faying.Load("a", forces=[faying.Force("p1.right", force=(100, 0, 0))])])
    with pytest.raises(faying.InputError, match=r"forces of \(0, 0, 0\) N and moments of \(0, 5, 0\) N m"):
        faying.load_cases(state, [faying.Load("a", forces=[faying.Force("p1.right", moment=(0, 5, 0))])])
    with pytest.raises(faying.InputError, match="no rigid support holds"):
        faying.load_cases(state, [faying.Load("m", displacements=[faying.Displacement("p1.right", (1e-6, 0, 0))])])
    with pytest.raises(faying.InputError, match="neither a part nor a bolt; give one of 'p0', 'p1', 'b'"):
        faying.load_cases(state, [faying.Load("m", temperature={"nut": 3.0})])


def test_cycles_of_a_load_damage_the_bolt_by_its_own_change_of_force():
    """Half of the range over the stress area; from the preload, or from the case before. VDI 2230's slopes."""
    made = bars(friction=None, held=True)
    state = made.structure.solve(preload=PRELOAD, modes=1)
    pull = faying.Load("pull", forces=[faying.Force("p1.right", force=(4e3, 0, 0))], cycles=1e6)
    back = faying.Load("back", forces=[faying.Force("p1.right", force=(-4e3, 0, 0))], after="pull", cycles=5e7)
    found = faying.load_cases(state, loads=[pull, back], modes=False)
    area = np.pi / 4 * (8e-3 - (0.6495 + 1.2269) / 2 * 1.25e-3) ** 2  # of the thread M8, ISO 898-1
    change = found.bolt_force[:, 0] - PRELOAD
    ranges = np.array([change[0], change[1] - change[0]])
    assert found.stress_amplitude[:, 0] == pytest.approx(np.abs(ranges) / (2 * area), rel=1e-4)
    endurance = 0.85 * (150 / 8 + 45) * 1e6
    slopes = np.where(found.stress_amplitude[:, 0] > endurance, 3, 5)
    exact = np.array([1e6, 5e7]) / 2e6 * (found.stress_amplitude[:, 0] / endurance) ** slopes
    assert found.damage[:, 0] == pytest.approx(exact, rel=1e-9)
    assert np.isnan(found.head_motion).all()  # nothing is said of the friction under the head
    # rolled after heat treatment: more, the less it is pulled on average, about the preload or about the case before
    base = of_state(state, modes=False)
    rolled = replace(base, bolts=tuple(replace(bolt, yield_force=2 * PRELOAD) for bolt in base.bolts))
    after = answers(rolled, (pull, back), Progress(0))
    mean = PRELOAD + np.array([change[0] / 2, (change[0] + change[1]) / 2])
    endurance *= 2 - mean / (2 * PRELOAD)
    slopes = np.where(found.stress_amplitude[:, 0] > endurance, 3, 5)
    exact = np.array([1e6, 5e7]) / 2e6 * (found.stress_amplitude[:, 0] / endurance) ** slopes
    assert after.damage[:, 0] == pytest.approx(exact, rel=1e-9)


def test_a_load_that_stays_has_no_range_of_stress(held):
    """Bent as before and pulled as before: the case that starts from it repeats nothing."""
    across = [faying.Force("p1.right", force=(200.0, 50.0, 0))]
    loads = [faying.Load("once", forces=across), faying.Load("still", forces=across, after="once")]
    found = faying.load_cases(held[1], loads, modes=False)
    assert found.bolt_moment[0, 0] > 0
    assert found.stress_amplitude[1, 0] == pytest.approx(0, abs=1e-6 * found.stress_amplitude[0, 0])
