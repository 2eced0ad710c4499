"""Which joints a bolt clamps and what crosses them: each against the equilibrium of the part beyond the joint."""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.case.acting import acting, nothing
from faying.case.case import Progress
from faying.fe.interface import join
from faying.joint.attachments import Support
from faying.joint.joint import FittedJoint
from faying.joint.joint_law import JointLaw
from faying.joint.load_path import Cut, LoadPaths
from faying.joint.structure import Structure
from faying.loads.answers import bolt_changes, cut_loads
from faying.loads.solve import answers, near_factor, of_state, solved, statics_of
from tests.helpers.sides import sides_on
from tests.helpers.voxels import voxels
from tests.joint.test_tighten import bed

STEEL = faying.Material(name="steel", E=200e9, nu=0.3, density=7800.0)
MM = 1e-3


def box(x=(0, 40), y=(0, 40), z=(0, 10)):
    """Whether points lie in a box [mm], its faces included."""
    low, high = np.array([x, y, z], float).T * MM
    return lambda p: np.all((p > low - 1e-9) & (p < high + 1e-9), axis=1)


def on(z, **where):
    """Whether points lie on a level of a box [mm]."""
    return lambda p: (np.abs(p[:, 2] - z * MM) < 1e-9) & box(z=(-1e3, 1e3), **where)(p)


def bolt(name, faces, x, y, size=4):
    """A bolt of steel on an axis [mm] with a seat twice as wide."""
    at = (x * MM, y * MM, 0.0)
    seat = (0.0, 2 * size * MM)
    return faying.Bolt(name, faces, at=at, diameter=size * MM, material=STEEL, seat=seat)


def structure(mesh, pairs, bolts, friction=None):
    """Bonded to the ground at the side of its first part."""
    joints = tuple(
        FittedJoint(
            name=f"{first} on {second}",
            faces=(first, second),
            interface=join(mesh, first, second),
            law=JointLaw(model=bed(2e13), tangential="law", nu=0.3),
            friction=friction,
        )
        for first, second in pairs
    )
    materials = dict.fromkeys(mesh.parts, STEEL)
    return Structure(mesh=mesh, materials=materials, joints=joints, bolts=bolts, supports=(Support(face="side"),))


def crossing(made, preload, loads):
    """For each load: what crosses each cut of each bolt [N], and the answers of the public function."""
    state = made.solve(preload, modes=1)
    statics = statics_of(of_state(state, modes=False))
    states = solved(statics, statics.rest_state(nothing(made)), loads, acting(made, loads))
    contacts, paths = [contact for _, contact in statics.joints], LoadPaths.of(made)
    found = []
    for load in loads:
        here = states[load.name][-1]
        found.append(cut_loads(contacts, here, paths, bolt_changes(made, here, statics.motion(here))))
    return found, faying.load_cases(state, loads, modes=False)


LINES = np.arange(0, 41, 5) * MM


def spool():
    """A base, a spool with a flange at each end, a lid: two bolts on one axis, through 30 mm of air."""
    parts = {
        "base": box(z=(0, 10)),
        "spool": lambda p: box(z=(10, 20))(p) | box(z=(20, 50), x=(20, 40))(p) | box(z=(50, 60))(p),
        "lid": box(z=(60, 70)),
    }
    faces = {
        "side": ("base", lambda p: p[:, 0] > 40 * MM - 1e-9),
        "base.seat": ("base", on(0)),
        "base.joint": ("base", on(10)),
        "spool.low": ("spool", on(10)),
        "spool.low seat": ("spool", on(20, x=(0, 20))),
        "spool.high seat": ("spool", on(50, x=(0, 20))),
        "spool.high": ("spool", on(60)),
        "lid.joint": ("lid", on(60)),
        "lid.seat": ("lid", on(70)),
    }
    mesh = voxels((LINES, LINES, np.array([0, 5, 10, 15, 20, 35, 50, 55, 60, 65, 70]) * MM), parts, faces, "hex8")
    low, high = ("base.seat", "spool.low seat"), ("spool.high seat", "lid.seat")
    bolts = (bolt("low", low, 10, 20), bolt("high", high, 10, 20))
    return structure(mesh, [("base.joint", "spool.low"), ("spool.high", "lid.joint")], bolts)


def test_two_bolts_in_series_each_carry_all_of_the_load():
    """A load at the end of the stack crosses both joints whole; each joint is that of the bolt with seats around it."""
    made = spool()
    paths = LoadPaths.of(made)
    assert [[cut.joints for cut in cuts] for cuts in paths.cuts] == [[(0,)], [(1,)]]
    assert [cut.depth for (cut,) in paths.cuts] == pytest.approx([10 * MM, 10 * MM])
    pull = faying.Load("pull", forces=[faying.Force("lid.seat", force=(0, 0, 500.0), point=(10 * MM, 20 * MM, 0.07))])
    [[[low], [high]]], found = crossing(made, 4e3, [pull])
    assert (low, high) == pytest.approx((500, 500), rel=1e-6)
    assert found.working_load[0] == pytest.approx([500, 500], rel=1e-6)


def stack():
    """Three plates: a long bolt through all, two short ones through the lower two."""
    parts = {"low": box(z=(0, 10)), "middle": box(z=(10, 20)), "top": box(z=(20, 30), x=(0, 20))}
    faces = {
        "side": ("low", lambda p: p[:, 0] > 40 * MM - 1e-9),
        "low.seat": ("low", on(0)),
        "low.top": ("low", on(10)),
        "middle.bottom": ("middle", on(10)),
        "middle.joint": ("middle", on(20, x=(0, 20))),
        "middle.seat": ("middle", on(20, x=(20, 40))),
        "top.joint": ("top", on(20)),
        "top.seat": ("top", on(30)),
    }
    mesh = voxels((LINES, LINES, np.arange(0, 31, 5) * MM), parts, faces, "hex8")
    bolts = (
        bolt("long", ("top.seat", "low.seat"), 10, 20),
        bolt("one", ("middle.seat", "low.seat"), 30, 10),
        bolt("other", ("middle.seat", "low.seat"), 30, 30),
    )
    return structure(mesh, [("low.top", "middle.bottom"), ("middle.joint", "top.joint")], bolts)


def test_a_stack_of_one_long_and_two_short_bolts():
    made = stack()
    paths = LoadPaths.of(made)
    assert [[cut.joints for cut in cuts] for cuts in paths.cuts] == [[(1,), (0,)], [(0,)], [(0,)]]
    axes = np.array([[10, 20], [30, 10], [30, 30]]) * MM
    away = np.linalg.norm(made.joints[0].interface.positions[:, None, :2] - axes, axis=2)
    apart = np.ptp(np.sort(away, axis=1)[:, :2], axis=1) > 1e-9  # from points that lie half-way
    assert np.array_equal(paths.owner[0][apart], np.argmin(away, axis=1)[apart])
    assert set(paths.owner[1]) == {0}
    assert sorted(paths.interfaces) == [((0,), (0, 1, 2)), ((1,), (0,))]
    at = (12 * MM, 15 * MM, 30 * MM)
    loads = [
        faying.Load("top", forces=[faying.Force("top.seat", force=(20.0, 30.0, 500.0), point=at)]),
        faying.Load("middle", forces=[faying.Force("middle.seat", force=(0, 0, 300.0))]),
    ]
    (first, second), found = crossing(made, 4e3, loads)
    assert first[0][0] == pytest.approx(500, rel=1e-6)
    assert first[0][1] + first[1][0] + first[2][0] == pytest.approx(500, rel=1e-6)
    assert second[0][0] == pytest.approx(0, abs=1e-3)
    assert second[0][1] + second[1][0] + second[2][0] == pytest.approx(300, rel=1e-6)
    assert found.working_load[0, 0] == pytest.approx(max(first[0], key=abs), rel=1e-6)


def slotted():
    """A foot on both sides of a slot in a base, under one bolt in the slot: two joints side by side."""
    parts = {
        "base": lambda p: box(z=(0, 20))(p) & ~box(z=(10, 20), x=(15, 25))(p),
        "foot": box(z=(20, 30)),
    }
    faces = {
        "side": ("base", lambda p: (p[:, 0] > 40 * MM - 1e-9) & (p[:, 2] < 11 * MM)),
        "base.seat": ("base", on(0)),
        "left": ("base", on(20, x=(0, 15))),
        "right": ("base", on(20, x=(25, 40))),
        "foot.left": ("foot", on(20, x=(0, 15))),
        "foot.right": ("foot", on(20, x=(25, 40))),
        "foot.seat": ("foot", on(30)),
    }
    mesh = voxels((LINES, LINES, np.arange(0, 31, 5) * MM), parts, faces, "hex8")
    bolts = (bolt("b", ("foot.seat", "base.seat"), 20, 20, size=8),)
    return structure(mesh, [("left", "foot.left"), ("right", "foot.right")], bolts)


def test_joints_side_by_side_are_one_cut():
    made = slotted()
    ((cut,),) = LoadPaths.of(made).cuts
    assert cut.joints == (0, 1)
    pull = faying.Load("pull", forces=[faying.Force("foot.seat", force=(0, 0, 700.0), point=(22 * MM, 20 * MM, 0.03))])
    (((load,),),), found = crossing(made, 4e3, [pull])
    assert load == pytest.approx(700, rel=1e-6)
    assert found.working_load[0, 0] == pytest.approx(700, rel=1e-6)


CORNERS = ((10, 10), (30, 10), (10, 30), (30, 30))


def flange(friction=None):
    """Two plates under four bolts; the heads of two of them lie on the other side."""
    parts = {"low": box(z=(0, 10)), "top": box(z=(10, 20))}
    faces = {
        "side": ("low", lambda p: p[:, 0] > 40 * MM - 1e-9),
        "low.seat": ("low", on(0)),
        "low.joint": ("low", on(10)),
        "top.joint": ("top", on(10)),
        "top.seat": ("top", on(20)),
    }
    mesh = voxels((LINES, LINES, np.arange(0, 21, 5) * MM), parts, faces, "hex8")
    seats = ("top.seat", "low.seat")
    bolts = tuple(bolt(f"b{k}", seats[::-1] if k % 2 else seats, x, y) for k, (x, y) in enumerate(CORNERS))
    return structure(mesh, [("low.joint", "top.joint")], bolts, friction)


@pytest.mark.parametrize("friction", [None, 0.02])
def test_the_load_across_each_bolt_is_that_of_the_equilibrium_of_the_part_beyond(friction):
    """Shear V and torque T give V/4 and T/(4 r); shear that an axial pull makes balances itself, and asks for none.

    With friction of 0.02 the joint slides, and shanks carry the rest.
    """
    made = flange(friction)
    middle = (20 * MM, 20 * MM, 10 * MM)
    r = 10 * MM * np.sqrt(2)
    loads = [
        faying.Load("shear", forces=[faying.Force("top.seat", force=(240.0, 320.0, 0), point=middle)]),
        faying.Load("torque", forces=[faying.Force("top.seat", force=(0, 0, 0), moment=(0, 0, 6.0), point=middle)]),
        faying.Load("pull", forces=[faying.Force("top.seat", force=(0, 0, 4000.0), point=middle)]),
        faying.Load("both", forces=[faying.Force("top.seat", force=(80.0, 0, 0), moment=(0, 0, 2.0), point=middle)]),
    ]
    _, found = crossing(made, 4e3, loads)
    assert found.transverse_load[0] == pytest.approx(4 * [100], rel=1e-3)
    assert found.transverse_load[1] == pytest.approx(4 * [6.0 / (4 * r)], rel=1e-3)
    assert found.transverse_load[2] == pytest.approx(4 * [0], abs=0.5)
    arms = np.array(CORNERS) * MM - 20 * MM
    both = np.array([20.0, 0]) + 2.0 / (4 * r**2) * np.stack([-arms[:, 1], arms[:, 0]], axis=1)
    assert found.transverse_load[3] == pytest.approx(np.linalg.norm(both, axis=1), rel=1e-3)
    if friction is not None:
        assert found.bolt_shear[0].min() > 1.0


def test_one_bolt_bears_a_torque_by_friction_round_it():
    """V and T on the joint of one bolt: the shear that needs as much friction, T over the mean arm of the pressure."""
    made = slotted()
    point = (20 * MM, 20 * MM, 20 * MM)
    twist = faying.Load("twist", forces=[faying.Force("foot.seat", force=(0, 0, 0), moment=(0, 0, 2.0), point=point)])
    _, found = crossing(made, 4e3, [twist])
    arm = np.linalg.norm(found.positions[:, :2] - np.array(point[:2]), axis=1)
    mean = (found.areas * found.pressure[0]) @ arm / (found.areas @ found.pressure[0])
    assert found.transverse_load[0, 0] == pytest.approx(2.0 / mean, rel=1e-3)


def test_a_joint_in_the_plane_of_a_seat_is_not_clamped():
    """A bracket that stands on the plate where the bolt's head lies: rounding of the depth decides nothing."""
    line = LoadPaths.of(flange()).lines[0]
    for depth in (0.0, 1e-17, line.length, line.length - 1e-17):
        place = (line.seats[0] + depth * line.axis + np.array([1 * MM, 0, 0]))[None]
        assert not line.passes(place, line.axis[None])


def test_cuts_of_one_bolt_are_crossed_one_after_the_other():
    """A shim between two parts that meet round it as well: both cuts share a joint, and no shear counts twice."""
    cut = {"depth": 0.01, "area": 1e-4}
    first = Cut(joints=(0, 1), parts=("a", "b"), **cut)
    second = Cut(joints=(1, 2), parts=("b", "c"), **cut)
    paths = LoadPaths(lines=(), owner=(), cuts=((first, second), (first, second)))
    assert sorted(paths.interfaces) == [((0, 1), (0, 1)), ((1, 2), (0, 1))]


def test_a_joint_along_the_axis_is_not_clamped():
    """A wall beside a bolt, whose normal lies across the axis, slides under its force."""
    made = flange()
    line = LoadPaths.of(made).lines[0]
    place = np.array([[11.0, 10.0, 10.0]]) * MM
    assert line.passes(place, np.array([[0.0, 0.0, -1.0]]))
    assert not line.passes(place, np.array([[1.0, 0.0, 0.0]]))
    assert not line.passes(place - np.array([0, 0, 11 * MM]), np.array([[0.0, 0.0, 1.0]]))
    assert not line.passes(place + np.array([line.reach, 0, 0]), np.array([[0.0, 0.0, 1.0]]))


def test_supports_that_move_apart_at_the_edge_of_a_joint_strain_its_springs():
    """The joint has one stiffness whatever its pressure, so that the linear answer is the answer."""
    made = flange()
    mesh = made.mesh
    side = sides_on(np.flatnonzero(mesh.points[:, 0] > 40 * MM - 1e-9), mesh.parts["top"], len(mesh.points))
    mesh = replace(mesh, faces=mesh.faces | {"top side": side}, face_part=mesh.face_part | {"top side": "top"})
    tight = made.solve(4e3, modes=1)
    supports = (Support(face="side"), Support(face="top side"))
    ends = Structure(mesh, made.materials, made.joints, made.bolts, supports=supports)
    base = replace(
        of_state(tight, modes=False),
        structure=ends,
        factor=near_factor(ends, tight.springs, None),
        modes=lambda _: None,
    )
    loads = (faying.Load("apart", displacements=[faying.Displacement("top side", (0, 2e-8, 3e-8))]),)
    found = answers(base, loads, Progress(0))
    change = found.bolt_force[0] - 4e3
    assert abs(change).max() > 0.1
    assert found.bolt_force_linear[0] - 4e3 == pytest.approx(change, abs=1e-3 * abs(change).max())
    assert found.superposition[0] < 1e-3
