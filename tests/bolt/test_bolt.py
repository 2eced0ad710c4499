"""Bolts: torque, beam between the seats, load, rings, washers, masses."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

import faying
from faying.bolt.bolt import Bolt, Washer, torque_to_preload
from faying.fe.attach import Ring, mean_motion
from faying.fe.elasticity import rigid_motions
from tests.helpers.plates import STEEL, plates, stacked

FACES = ("high.top", "low.bottom")
WASHER = Washer(outer=16e-3, inner=8.4e-3, thickness=1.6e-3, material=STEEL)


def bolt(**changes):
    return Bolt(**({"name": "b", "faces": FACES, "diameter": 8e-3, "material": STEEL} | changes))


def test_torque_by_nut_factor():
    """Shigley.

    Mechanical Engineering Design, 9th ed., example 8-3 (b): 25 kip in a 3/4 in bolt, K = .2: 3750 lbf in.
    """
    pound_force, inch = 4.4482216, 0.0254
    found = torque_to_preload(3750 * pound_force * inch, 0.75 * inch, nut_factor=0.2)
    assert found == pytest.approx(25e3 * pound_force, rel=1e-6)


@pytest.mark.parametrize(
    ("d", "pitch", "friction", "force", "torque"),
    [
        (8, 1, 0.10, 20.7, 22.8),
        (8, 1, 0.12, 20.2, 26.1),
        (8, 1, 0.14, 19.7, 29.2),
        (10, 1.25, 0.12, 31.6, 51),
        (12, 1.25, 0.10, 49.1, 79),
        (16, 1.5, 0.12, 87.6, 218),
        (24, 2, 0.14, 204, 865),
    ],
)
def test_torque_by_friction(d, pitch, friction, force, torque):
    """Table of VDI 2230:2001 for fine threads of class 8.8; its heads bear on 1.25 to 1.34 d, ours on 1.3 d: 2.5 %."""
    found = torque_to_preload(torque, d * 1e-3, pitch=pitch * 1e-3, thread_friction=friction, head_friction=friction)
    assert found == pytest.approx(force * 1e3, rel=0.025)


def test_torque_needs_all_it_takes():
    for given, text in (
        ({"torque": -1.0, "nut_factor": 0.2}, "must both be positive"),
        ({"nut_factor": 20.0}, "must be at least 0.02 and at most 1"),
        ({}, "a torque gives no preload by itself"),
        ({"pitch": 1e-3, "thread_friction": 0.1}, "a torque gives no preload by itself"),
    ):
        with pytest.raises(faying.InputError, match=text):
            torque_to_preload(given.pop("torque", 10.0), 8e-3, **given)


def beam(length=0.02, nu=0.3):
    """Stiffness (12, 12) of a bolt's shank and its data."""
    material = faying.Material(name="m", E=200e9, nu=nu, density=7800.0)
    fitted = bolt(material=material).fitted(stacked(size=(0.08, 0.04, length / 2)))
    return fitted._beam(), material, fitted


def test_the_shank_is_a_cantilever_with_shear():
    """One end held: tip compliances delta_S, L/GJ, L3/3EI + L/kGA, L/EI, L2/2EI.

    delta_S of an M8 threaded up to its head: (.5 + .4) d on pi d^2/4, L + .5 d on pi d_3^2/4 (VDI 2230).
    """
    full, m, fitted = beam()
    d, L = 8e-3, fitted.length
    area, inertia = pi / 4 * d**2, pi / 64 * d**4
    shear = 6 * (1 + m.nu) / (7 + 6 * m.nu) * m.G * area
    tip = np.linalg.inv(full[6:, 6:])
    minor = pi / 4 * (d - 1.22687 * 1.25e-3) ** 2
    assert tip[0, 0] == pytest.approx((0.9 * d / area + (L + 0.5 * d) / minor) / m.E)
    assert tip[3, 3] == pytest.approx(L / (m.G * 2 * inertia))
    for axis, turn in ((1, 5), (2, 4)):
        assert tip[axis, axis] == pytest.approx(L**3 / (3 * m.E * inertia) + L / shear)
        assert tip[turn, turn] == pytest.approx(L / (m.E * inertia))
        assert abs(tip[axis, turn]) == pytest.approx(L**2 / (2 * m.E * inertia))
    assert full == pytest.approx(full.T)


def test_a_rigid_motion_costs_no_energy_and_is_followed_exactly():
    mesh = stacked()
    fitted = bolt(at=(0.03, 0.02, 0.0), seat=(9e-3, 30e-3)).fitted(mesh)
    rigid = rigid_motions(mesh.points)
    energy = rigid.T @ (fitted.stiffness @ rigid)
    assert np.abs(energy).max() < 1e-9 * fitted.axial_stiffness * mesh.size**2
    # each seat takes the three translations in full, turned into the bolt's axes, and the same rotation as the other
    ends = fitted.motion @ rigid
    shift = fitted.motion @ np.kron(np.ones((len(mesh.points), 1)), np.eye(3))
    for rows in (slice(0, 3), slice(6, 9)):
        assert shift[rows].T @ shift[rows] == pytest.approx(np.eye(3))
    assert ends[3:6] == pytest.approx(ends[9:12])
    assert fitted.axis == pytest.approx([0, 0, -1])


def test_mean_motion_of_a_linear_field_and_of_a_ring():
    """u = (a . x) e is followed at the centre of the face; a ring sees the field about its own middle."""
    mesh = stacked(counts=(8, 8, 1), size=(0.04, 0.04, 0.01))
    field = np.zeros_like(mesh.points)
    field[:, 2] = 3e-3 * mesh.points[:, 0] - 1e-3 * mesh.points[:, 1]
    at = np.array([0.02, 0.02, 0.02])
    for ring in (None, Ring(point=at, axis=np.array([0, 0, 1.0]), inner=2e-3, outer=15e-3)):
        motion = mean_motion(mesh.points, mesh.face("high.top"), at, ring) @ field.ravel()
        expected = [0, 0, 3e-3 * 0.02 - 1e-3 * 0.02, -1e-3, -3e-3, 0]
        assert motion == pytest.approx(expected, abs=1e-9 if ring is None else 2e-5)


def test_a_ring_that_meets_nothing():
    mesh = stacked()
    far = Ring(point=np.array([1.0, 1.0, 0.0]), axis=np.array([0, 0, 1.0]), inner=0.0, outer=5e-3)
    with pytest.raises(faying.InputError, match="a ring of 10 mm outer diameter meets nothing"):
        mean_motion(mesh.points, mesh.face("high.top"), np.array([1.0, 1.0, 0.02]), far)


@pytest.mark.parametrize("given", [{}, {"at": (0.03, 0.015, 0.0), "seat": (9e-3, 30e-3)}], ids=["face", "ring"])
def test_the_load_is_one_newton_each_way_and_balances(given):
    mesh = stacked()
    load = bolt(**given).fitted(mesh).load
    assert rigid_motions(mesh.points).T @ load == pytest.approx(np.zeros(6), abs=1e-10)
    low = np.isin(np.arange(len(mesh.points)), mesh.part_nodes("low"))
    forces = load.reshape(-1, 3)
    assert forces[low].sum(axis=0) == pytest.approx([0, 0, 1], abs=1e-10)
    assert forces[~low].sum(axis=0) == pytest.approx([0, 0, -1], abs=1e-10)
    if given:  # the resultant runs along the axis through the point
        moment = np.cross(mesh.points[low] - [0.03, 0.015, 0.0], forces[low]).sum(axis=0)
        assert moment == pytest.approx(np.zeros(3), abs=1e-10)


def test_a_ring_presses_only_where_it_lies():
    mesh = stacked(counts=(16, 8, 1))
    load = bolt(at=(0.02, 0.02, 0.0), seat=(0.0, 12e-3)).fitted(mesh).load.reshape(-1, 3)
    loaded = np.flatnonzero(np.abs(load).max(axis=1) > 1e-12)
    radius = np.linalg.norm(mesh.points[loaded, :2] - [0.02, 0.02], axis=1)
    assert radius.max() < 6e-3 + 2 * 5e-3  # the ring and one element around it


def test_washers_lie_in_series_and_give_the_seat():
    mesh = stacked(counts=(16, 8, 1))
    with_two = bolt(at=(0.04, 0.02, 0.0), washers=(WASHER, WASHER)).fitted(mesh)
    bare = bolt(at=(0.04, 0.02, 0.0), seat=(8.4e-3, 16e-3)).fitted(mesh)
    area = pi / 4 * (16e-3**2 - 8.4e-3**2)
    more = 2 * 1.6e-3 / (STEEL.E * area)  # of the washers, and of the bolt that is longer by them
    more += 2 * 1.6e-3 / (STEEL.E * pi / 4 * (8e-3 - 1.22687 * 1.25e-3) ** 2)
    assert 1 / with_two.axial_stiffness - 1 / bare.axial_stiffness == pytest.approx(more)
    assert with_two.load == pytest.approx(bare.load, abs=1e-15)


def test_masses_of_shank_head_nut_and_washers():
    mesh = stacked()
    d, length = 8e-3, 0.02
    shank = STEEL.density * pi / 4 * d**2 * length
    for given, ends in (({"head_mass": 0.0, "nut_mass": 0.0}, 0.0), ({"head_mass": 5e-3, "nut_mass": 3e-3}, 8e-3)):
        mass = bolt(**given).fitted(mesh).mass
        uniform = np.tile([0.0, 1.0, 0.0], len(mesh.points))
        assert uniform @ (mass @ uniform) == pytest.approx(shank + ends)
    hexagon = STEEL.density * 3**0.5 / 2 * (1.5 * d) ** 2 * d * (0.64 + 0.85)
    whole = bolt(washers=(WASHER, WASHER), seat=(0.0, 40e-3)).fitted(mesh).mass
    assert uniform @ (whole @ uniform) == pytest.approx(shank + hexagon + 2 * WASHER.mass)
    assert WASHER.mass == pytest.approx(7800 * WASHER.area * 1.6e-3)


def test_tension_is_stiffness_times_stretch():
    mesh = stacked()
    fitted = bolt().fitted(mesh)
    high = np.isin(np.arange(len(mesh.points)), mesh.part_nodes("high"))
    lifted = np.zeros_like(mesh.points)
    lifted[high, 2] = 1e-6
    assert fitted.tension(lifted.ravel()) == pytest.approx(fitted.axial_stiffness * 1e-6)
    assert fitted.tension(-lifted.ravel()) == pytest.approx(-fitted.axial_stiffness * 1e-6)


def test_bolts_against_a_fixed_plate_in_closed_form():
    """A plate of high mass on a bolt over a held plate.

    F of the point mass is sqrt(k/m) of the bolt, elastic plates aside.
    """
    stiff = faying.Material(name="stiff", E=2e15, nu=0.3, density=7800.0)
    mesh = stacked(gap=1e-6)
    from faying.joint.attachments import Support
    from faying.numerics.modes import lowest_modes

    structure = plates(
        mesh, material=stiff, bolts=(bolt(head_mass=0.0, nut_mass=0.0),), supports=(Support(face="low.bottom"),)
    )
    K, M = structure.dynamic_matrices
    modes = lowest_modes(K, M, 6, shift_frequency=100.0)
    fitted = structure.fitted_bolts[0]
    mass = 7800 * 0.08 * 0.04 * 0.01 + 7800 * pi / 4 * 8e-3**2 * fitted.length / 2
    axial = np.sqrt(fitted.axial_stiffness / mass) / (2 * pi)
    assert np.abs(modes.frequencies / axial - 1).min() < 2e-3


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"material": None}, "needs both diameter and material, or neither"),
        ({"diameter": -1.0}, "diameter = -1 m; it must be positive"),
        ({"seat": (16e-3, 8e-3)}, "inner diameter must be less than its outer"),
        ({"faces": ("low.top", "high.bottom")}, "do not look away from each other"),
        ({"faces": ("high.top", "low.left")}, "do not look away from each other"),
        ({"faces": ("low.left", "low.right"), "diameter": None, "material": None}, "both on part 'low'"),
        ({"faces": ("low.left", "low.left")}, "both faces are 'low.left'"),
    ],
)
def test_messages(given, text):
    with pytest.raises(faying.InputError, match=text):
        bolt(**given).fitted(stacked())


def test_seats_without_a_common_axis_need_a_point_on_it():
    """Centres 60 mm aside and 20 mm apart."""
    mesh = stacked(counts=(16, 8, 1))
    points = mesh.points.copy()
    points[mesh.part_nodes("high"), 0] += 0.06
    shifted = replace(mesh, points=points)
    with pytest.raises(
        faying.InputError, match=r"look away from each other, but no axis .* 60 mm apart .*give at .* and seat"
    ):
        bolt().fitted(shifted)
    fitted = bolt(at=(0.07, 0.02, 0.0), seat=(0.0, 12e-3)).fitted(shifted)
    assert fitted.axis == pytest.approx([0, 0, -1])
    assert fitted.length == pytest.approx(0.02)


def test_the_head_goes_with_one_part_and_the_nut_with_the_other():
    """Moving one part alone moves half of the shank and what is on its side: a head of 0.64 d, a nut of 0.85 d."""
    d, rho = 8e-3, STEEL.density
    made = plates(stacked(), bolts=(bolt(),))
    fitted, mesh = bolt().fitted(made.mesh), made.mesh
    hexagon = 3**0.5 / 2 * (1.5 * d) ** 2
    shank = rho * pi / 4 * d**2 * fitted.length
    for part, height in (("high", 0.64), ("low", 0.85)):
        move = np.zeros((len(mesh.points), 3))
        move[mesh.part_nodes(part), 1] = 1.0
        expected = shank / 2 + rho * hexagon * height * d
        assert move.ravel() @ (fitted.mass @ move.ravel()) == pytest.approx(expected, rel=1e-9)
