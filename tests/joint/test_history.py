"""Joints that were tightened, loosened and tightened again."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import faying
from faying.contact.models.greenwood_williamson import GreenwoodWilliamson
from faying.joint.joint_law import JointLaw
from faying.joint.loaded_before import LoadedBefore, in_service, loaded_before
from faying.joint.preload_case import PreloadCase, after_greatest, each_once, preload_index, with_history
from faying.loads.contact import LoadedContact
from faying.microslip.microslip import Microslip
from tests.helpers.bars import bars, even
from tests.helpers.boxes import row
from tests.helpers.plates import plates, stacked

STEEL = faying.Material(name="steel", E=206e9, nu=0.3, hardness=2e9, density=7850.0)
LAW = GreenwoodWilliamson(
    density=2e10, radius=20e-6, sigma=0.5e-6, pair=faying.ContactPair(STEEL, STEEL), asperity="KogutEtsion"
)
MOST = np.array([0.0, 1e5, 1e6, 5e6, 2e7])
FORCES = ["2 kN", "6 kN", "2 kN", "4 kN", "6 kN", "8 kN"]


@pytest.fixture(scope="module")
def first():
    return JointLaw(model=LAW, tangential=0.6)


@pytest.fixture(scope="module")
def used(first):
    found = loaded_before(first, MOST)
    assert isinstance(found, LoadedBefore)
    return found


def ways(used, count=4000):
    """Approaches (q, count) [m] of each point that carried something, from parting to the greatest pressure."""
    curve = used.elastic.at(MOST > 0)
    share = np.linspace(0, 1, count)
    return curve, curve.parted[:, None] + share * (curve.turn - curve.parted)[:, None]


def test_the_way_back_meets_first_loading_where_it_turned(first, used):
    """In pressure and, up to the flattening that ends there, in approach; below, it is steeper throughout."""
    turn = np.array([first.approach(p) for p in MOST[1:]])
    curve, _ = ways(used)
    assert curve.turn == pytest.approx(turn, rel=1e-6)
    p, k = curve.pressure(curve.turn * (1 - 1e-12))
    assert p == pytest.approx(MOST[1:], rel=1e-3)
    later, _ = curve.pressure(1.2 * curve.turn)
    assert later == pytest.approx(first.pressure(1.2 * turn)[0], rel=1e-9)
    assert np.all(k > first.pressure(turn)[1])
    assert np.all(curve.parted > 0)


def test_stiffness_is_the_slope_of_pressure_and_that_of_the_law(used):
    """By the trapezoidal rule along the way back, and against what the law says after the same pressure."""
    curve, w = ways(used)
    p, k = curve.pressure(w)
    assert np.trapezoid(k[:, 400:], w[:, 400:]) == pytest.approx(p[:, -1] - p[:, 400], rel=2e-3)
    half = 0.5 * MOST
    k_n, k_t = used.stiffness(half)
    for at in (2, 3, 4):
        assert k_n[at] == pytest.approx(float(LAW.at_pressure(half[at], after=MOST[at]).k_n), rel=1e-4)
    assert k_t == pytest.approx(0.6 * k_n)


def test_a_closed_cycle_loses_the_work_of_first_loading_and_nothing_again(first, used):
    """Work up by first loading, down and up by the way back: the second cycle closes to rounding."""
    curve, w = ways(used)
    down = np.trapezoid(curve.pressure(w)[0], w)
    up = np.trapezoid(curve.pressure(w[:, ::-1])[0], w[:, ::-1])
    assert down + up == pytest.approx(np.zeros(4), abs=1e-12)
    for at, turn in enumerate(curve.turn):
        first_way = np.linspace(0, turn, 4000)
        taken = np.trapezoid(first.pressure(first_way)[0], first_way)
        assert 0 < down[at] < taken


def test_what_lasts_has_been_left_already(first, used):
    assert np.all(np.array(used.lasting_approach(0.5 * MOST)) == 0)
    assert used.first_loading == first


def test_loads_of_service_part_on_the_way_back_and_press_on_by_k_n(first):
    """About a preload that nothing came before, and about one below what was carried."""
    serving = in_service(first, MOST).elastic.at(MOST > 0)
    back = loaded_before(first, MOST).elastic.at(MOST > 0)
    below = back.turn - back.parted
    for share in (0.2, 0.5, 0.9):
        p, k = serving.pressure(serving.parted + share * below)
        q, slope = back.pressure(back.parted + share * below)
        assert p == pytest.approx(q, rel=1e-9)
        assert k == pytest.approx(slope, rel=1e-9)
    more = 1.1 * MOST[1:]
    assert serving.pressure(serving.approach(more))[1] == pytest.approx(first.stiffness(more)[0], rel=0.02)
    half = in_service(loaded_before(first, MOST), 0.5 * MOST)
    assert half.greatest == pytest.approx(MOST)
    unknowing = even()
    assert in_service(unknowing, MOST) is unknowing


@pytest.mark.parametrize("friction", [None, 0.3])
def test_a_load_that_takes_half_of_a_preload_leaves_the_joint_as_loosening_does(first, friction):
    """Bars under a bolt that is a force: the modes of a pull are those of the bolt let go to the same clamp force."""
    structure = bars(law=first, diameter=None, held=True, friction=friction).structure
    tight, loose = structure.solve([4e3, 2e3], modes=4)
    pull = faying.Load("pull", forces=[faying.Force("p1.right", force=(2e3, 0, 0))])
    found = faying.load_cases(tight, [pull])
    assert found.normal_force[0, 0] == pytest.approx(2e3, rel=1e-6)
    assert found.frequency[0] == pytest.approx(loose.frequencies, rel=1e-6)
    assert found.frequency[0, 0] > 1.005 * structure.solve(2e3, modes=4).frequencies[0]


@pytest.mark.parametrize("friction", [None, 0.2])
def test_a_load_that_relieves_a_joint_goes_down_its_own_way(used, friction):
    """A relative motion of the faces about half of the greatest pressure: the pressure is that of the curve there."""
    n, p = len(MOST), np.where(MOST > 0, 0.5 * MOST, 0.0)
    rest = np.zeros((n, 3))
    rest[:, 0] = -used.elastic.approach(p)
    k_n, k_t = used.stiffness(p)
    gap, ones = np.zeros(n), np.ones(n)
    sliders = None
    if friction is not None:
        sliders = Microslip.cut(used, -rest[:, 0], friction=friction, springs=24)
        assert sliders.k_n[1:, :24].sum(axis=1) == pytest.approx(k_n[1:], rel=1e-6)
    contact = LoadedContact(
        law=used, weights=ones, gap=gap, rest=rest, pressure=p, k_n=k_n, k_t=k_t, friction=friction, sliders=sliders
    )
    opened = rest.copy()
    opened[:, 0] += 0.2 * (-rest[:, 0] - used.elastic.parted)
    expected = used.pressure(-opened[:, 0])[0]
    _, traction, _ = contact.advance(contact.start, opened)
    assert -traction[1:, 0] == pytest.approx(expected[1:], rel=5e-3)
    apart = rest.copy()
    apart[:, 0] = -0.5 * used.elastic.parted
    assert list(contact.opened(apart)) == [False, True, True, True, True]


@pytest.fixture(scope="module")
def blocks():
    mesh = row([0.03, 0.03], [2, 2], kinds=("hex20", "hex20"), sections=((2, 2), (2, 2)), width=0.02, height=0.02)
    return faying.Structure(
        mesh,
        materials=STEEL,
        joints=[faying.Joint(("p0.right", "p1.left"), LAW, name="j", tangential=0.6)],
        bolts=[faying.Bolt("b", ("p0.left", "p1.right"))],
    )


@pytest.fixture(scope="module")
def states(blocks):
    return blocks.solve(FORCES, modes=4)


def test_a_structure_remembers_its_greatest_preload(blocks, states):
    """Rising preloads are those of first loading to the digit; on the way back each point has its own p_max."""
    alone = [blocks.solve(force, modes=4) for force in ("2 kN", "6 kN", "8 kN")]
    for at, one in zip((0, 1, 5), alone, strict=True):
        assert states[at].frequencies == pytest.approx(one.frequencies, rel=1e-8)
    assert states[4].frequencies == pytest.approx(states[1].frequencies, rel=1e-7)
    assert np.all(states[2].frequencies[:2] > 1.001 * states[0].frequencies[:2])
    assert np.all(states[3].frequencies[:2] > states[2].frequencies[:2])
    most, back = states[1].pressures["j"], states[2].springs[0]
    shut = back.pressure > 1e4
    law = LAW.at_pressure(back.pressure[shut], after=most[shut])
    assert back.k_n[shut] == pytest.approx(law.k_n, rel=1e-4)
    area = back.interface.weights
    assert float(area @ back.pressure) == pytest.approx(2e3, rel=1e-6)


def test_both_engines_go_the_same_way(blocks, states):
    direct = blocks.solve(FORCES, modes=4, engine="direct")
    for one, other in zip(direct, states, strict=True):
        assert one.frequencies == pytest.approx(other.frequencies, rel=1e-8)


def test_a_state_that_was_loosened_can_be_solved_anew(states):
    """Its structure is put together fresh: first loading."""
    again = states[2].structure.solve("2 kN", modes=4)
    assert again.frequencies == pytest.approx(states[0].frequencies, rel=1e-8)


@pytest.mark.parametrize("engine", ["reanalysis", "direct"])
def test_bolts_in_turn_leave_what_each_point_carried(engine):
    """Tightened, loosened and tightened one bolt after the other: each point goes by its own greatest pressure."""
    structure = plates(
        stacked(counts=(8, 4, 1), size=(0.08, 0.04, 0.03)),
        bolts=tuple(
            faying.Bolt(
                name, ("high.top", "low.bottom"), at=(x, 0.02, 0.0), seat=(0.0, 24e-3), diameter=8e-3, material=STEEL
            )
            for name, x in (("one", 0.03), ("two", 0.05))
        ),
        law=LAW,
    )
    given = {"modes": 2, "order": ["two", "one"], "engine": engine}
    up, top, back = structure.solve(["2 kN", "6 kN", "2 kN"], **given)
    assert up.frequencies == pytest.approx(structure.solve("2 kN", **given).frequencies, rel=1e-8)
    springs, most = back.springs[0], top.springs[0].pressure
    assert springs.interface.weights @ springs.pressure == pytest.approx(sum(back.preload.bolt_forces), rel=1e-6)
    used = (springs.pressure > 1e4) & (springs.pressure < most)
    expected = LAW.at_pressure(springs.pressure[used], after=most[used])
    assert springs.k_n[used] == pytest.approx(expected.k_n, rel=1e-4)
    assert used.mean() > 0.5
    assert np.all(back.frequencies > up.frequencies)


def test_a_joint_that_was_loosened_shakes_with_the_stiffness_that_it_has(first):
    """At rest the modes of its state; under noise that slides it no faster than these."""
    structure = bars(law=first, held=True, friction=0.3).structure
    up, _, back = structure.solve(["2 kN", "8 kN", "2 kN"], modes=3)
    noise = faying.Excitation("noise", psd=[("200 Hz", "0.1 g^2/Hz"), ("30 kHz", "0.1 g^2/Hz")], direction=(0, 1, 0))
    (fresh,), (used,) = (faying.vibration(state, [noise]) for state in (up, back))
    assert used.rest_frequency == pytest.approx(back.frequencies, rel=1e-9)
    assert used.rest_frequency[0] > 1.005 * fresh.rest_frequency[0]
    assert np.all(used.frequency[1] <= used.rest_frequency * (1 + 1e-9))


def test_which_preloads_count_before_another():
    cases = [PreloadCase(forces=forces) for forces in ((4.0, 4.0), (12.0, 8.0), (2.0, 10.0), (4.0, 4.0), (13.0, 13.0))]
    found = with_history(cases)
    assert [one.after for one in found] == [(), (), ((12.0, 8.0),), ((12.0, 8.0), (2.0, 10.0)), ()]
    assert [one.after for one in after_greatest(cases[:2])] == [((12.0, 8.0),), ()]
    thrice = [PreloadCase(forces=(f,)) for f in (4e3, 12e3, 4e3, 12e3, 4e3)]
    names = each_once(one.name for one in with_history(thrice))
    assert names == ("4 kN", "12 kN", "4 kN after 12 kN", "12 kN (2)", "4 kN after 12 kN (2)")


def test_a_preload_that_comes_twice_is_asked_for_by_its_name():
    loads, names = (4e3, 12e3, 4e3), ("4 kN", "12 kN", "4 kN after 12 kN")
    assert preload_index(loads, "4 kN after 12 kN", names=names) == 2
    assert preload_index(loads, "12 kN", names=names) == 1
    with pytest.raises(faying.InputError, match="may be '4 kN' or '4 kN after 12 kN'; give one of these names"):
        preload_index(loads, 4e3, names=names)


def test_a_law_without_memory_is_said_to_have_none(blocks):
    """GW-ZMC has no law of unloading: the joint is as on first loading, and a note says so."""
    law = JointLaw(model=replace(LAW, asperity="ZhaoMaiettaChang"), tangential=0.6)
    plain = blocks.with_joints(laws=[law]).solve(["2 kN", "6 kN", "2 kN"], modes=2)
    assert plain[2].frequencies == pytest.approx(plain[0].frequencies, rel=1e-7)
    assert [note.code for note in plain[2].notes].count("no-memory") == 1
    assert "no-memory" not in [note.code for note in plain[0].notes]


def test_springs_per_node_remember_no_pressure(blocks):
    (joint,) = blocks.joints
    per_node = replace(blocks, joints=(replace(joint, per_node=True),))
    with pytest.raises(faying.InputError, match="springs per node, which remember no pressure"):
        per_node.loaded_before([np.ones(len(joint.interface.weights))])


def test_points_that_carried_next_to_nothing_are_on_first_loading(first):
    found = loaded_before(first, np.full(3, 0.5))
    w = np.array([1e-9, 1e-8, 1e-7])
    assert found.pressure(w)[0] == pytest.approx(first.pressure(w)[0])
    unknowing = JointLaw(model=SimpleNamespace(memory=None))
    assert loaded_before(unknowing, np.ones(3)) is unknowing
