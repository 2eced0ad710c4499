"""Friction under loads: a strip that creeps along its bed, against the one-dimensional closed form, and its loss."""

import numpy as np
import pytest

import faying
from faying.case.acting import acting, nothing
from faying.fe.interface import join
from faying.joint.attachments import Support
from faying.joint.joint import FittedJoint
from faying.joint.structure import Structure
from faying.loads.solve import of_state, statics_of
from tests.helpers.bars import even
from tests.helpers.plates import stacked

LONG, WIDE, THICK = 0.06, 0.004, 0.001
E, FRICTION, K_N, K_T = 70e9, 0.3, 2e14, 1e14
PRELOAD = 0.24e3  # N, that press 1 MPa
PRESSURE = PRELOAD / (LONG * WIDE)
SHEAR = FRICTION * PRESSURE * WIDE  # N/m, that friction carries at most
STRIP = faying.Material(name="strip", E=E, nu=0.0, density=2700.0)
BED = faying.Material(name="bed", E=1e15, nu=0.0, density=7800.0)


@pytest.fixture(scope="module")
def strip():
    """A strip on a stiff bed that is held, pressed evenly over its length."""
    mesh = stacked(counts=(40, 1, 1), size=(LONG, WIDE, THICK))
    joint = FittedJoint(
        name="bed",
        faces=("low.top", "high.bottom"),
        interface=join(mesh, "low.top", "high.bottom"),
        law=even(K_N, K_T),
        friction=FRICTION,
    )
    structure = Structure(
        mesh=mesh,
        materials={"low": BED, "high": STRIP},
        joints=(joint,),
        bolts=(faying.Bolt("b", ("low.bottom", "high.top")),),
        supports=[Support(face="low.bottom")],
    )
    return structure.solve(PRELOAD, modes=1)


def end_motion(force):
    """Motion [m] of the end of the strip: E A u'' = friction where it slides, k_t w u where it sticks.

    Where sliding ends, at the depth s, the slip is that of the limit and the force what sticking then carries:
    decay^-1 times the limit, with decay^2 = k_t w/(E A).
    """
    stiff, limit = E * WIDE * THICK, SHEAR / (K_T * WIDE)
    decay = np.sqrt(K_T * WIDE / stiff)
    s = force / SHEAR - 1 / decay
    assert s > 0
    return limit + SHEAR / (decay * stiff) * s + SHEAR / (2 * stiff) * s**2, s


def pull(name, force, **more):
    return faying.Load(name, forces=[faying.Force("high.right", force=(force, 0, 0))], **more)


def test_a_strip_creeps_as_far_as_friction_says(strip):
    """Slid length and motion of the end to 2 %; each bears on the law of friction alone."""
    forces = np.array([0.3, 0.6, 0.8]) * SHEAR * LONG
    found = faying.load_cases(strip, [pull(f"{k}", f) for k, f in enumerate(forces)], modes=False)
    wanted, slid = np.array([end_motion(f) for f in forces]).T
    assert found.displacement == pytest.approx(wanted, rel=0.02)
    assert found.sliding[:, 0] * LONG == pytest.approx(slid, abs=0.0015)  # the length of an element
    assert found.shear_force[:, 0] == pytest.approx(forces, rel=1e-6)
    assert found.slip_margin[:, 0] == pytest.approx(SHEAR * LONG / forces, rel=1e-5)


def test_all_of_it_slides_and_no_equilibrium_is_left(strip):
    with pytest.raises(faying.NotConverged, match="load 'too much'"):
        faying.load_cases(strip, [pull("too much", 1.05 * SHEAR * LONG)], modes=False)


def test_up_down_and_up_again_dissipates_what_the_sliders_say(strip):
    """The outer work of a loop between +P and -P is what the sliders take: 2 P^3/(3 E A q) where nothing else gives.

    Closed form: Goodman 1959 for a strip on a rigid bed, q being the friction per length.
    """
    steps, force = 5, 0.7 * SHEAR * LONG
    sizes = np.concatenate([np.linspace(0, 1, steps + 1), np.linspace(1, -1, 2 * steps + 1)[1:]])
    sizes = np.concatenate([sizes, np.linspace(-1, 1, 2 * steps + 1)[1:]])
    statics = statics_of(of_state(strip, modes=False))
    unit = acting(strip.structure, [pull("unit", force)])["unit"]
    states = [statics.rest_state(nothing(strip.structure))]
    for size in sizes[1:]:
        [found] = statics.solve([("way", states[-1], unit.times(size), 1)])
        states += found
    ends = np.array([unit.force @ statics.motion(state) for state in states])  # work of the whole force
    loop = slice(steps, None)
    work = np.sum((sizes[loop][1:] + sizes[loop][:-1]) / 2 * np.diff(ends[loop]))
    taken = sum(float(state.dissipated.sum()) for state in states[steps + 1 :])
    assert ends[-1] == pytest.approx(ends[steps], rel=1e-3)  # the second way up ends where the first did
    assert taken == pytest.approx(work, rel=1e-3)
    assert taken == pytest.approx(masing_loop(force), rel=0.03)  # steps of a third of P
    assert masing_loop(force) == pytest.approx(2 * force**3 / (3 * E * WIDE * THICK * SHEAR), rel=0.1)  # k_t stores


def masing_loop(force, points=2001):
    """Loss [J] of a loop by Masing's rule on the closed form of the first loading, which holds at constant pressure."""
    at = np.linspace(0, force, points)
    stiff, decay = E * WIDE * THICK, np.sqrt(K_T * WIDE / (E * WIDE * THICK))
    sticks = at / (decay * stiff)  # u = P/(E A decay) until the end of the strip slides
    ends = np.array([end_motion(f)[0] if f > SHEAR / decay else u for f, u in zip(at, sticks, strict=True)])
    area = float(np.sum((ends[1:] + ends[:-1]) / 2 * np.diff(at)))
    # a way from -P to P is the first loading doubled in both
    return 8 * (force * ends[-1] / 2 - area)


def test_a_way_back_to_no_load_leaves_slip(strip):
    """After a load and its end the strip stays moved by half of what the slip was, within a tenth: Masing's rule."""
    force = 0.7 * SHEAR * LONG
    loads = [
        pull("up", force, increments=6),
        faying.Load("off", after="up", increments=6),
        pull("up again", force, after="off", increments=6),
        pull("back", -force),
        faying.Load("undone", combine={"up": 1.0, "back": 1.0}, after="up", increments=6),
    ]
    found = faying.load_cases(strip, loads, modes=False)
    up, off, again, _, undone = found.displacement
    assert off == pytest.approx(up - 2 * end_motion(force / 2)[0], rel=0.03)
    assert again == pytest.approx(up, rel=1e-3)
    assert found.after == ("", "up", "off", "", "up")
    assert found.superposition[1] == 1.0  # the linear answer to nothing is nothing
    assert undone == pytest.approx(off, rel=1e-6)
    assert found.superposition[4] == 1.0  # to loads that cancel out it is rounding
