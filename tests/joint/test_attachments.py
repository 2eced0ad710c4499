"""Supports and point masses: bars against their closed forms."""

from math import pi

import numpy as np
import pytest
from scipy.optimize import brentq

import faying
from faying.fe.mesh import Mesh
from faying.joint.attachments import PointMass, Support
from faying.joint.structure import Structure
from faying.numerics.modes import lowest_modes
from tests.helpers.boxes import block
from tests.helpers.sides import sides_on

SIMPLE = faying.Material(name="simple", E=200e9, nu=0.0, density=7800.0)
SPEED = (200e9 / 7800) ** 0.5
L, WIDTH, HEIGHT = 0.5, 0.02, 0.03


def bar(counts=(12, 1, 1)):
    """A bar along x with the faces foot and tip."""
    points, cells = block("hex20", counts, (L, WIDTH, HEIGHT))
    faces = {
        name: sides_on(np.flatnonzero(np.abs(points[:, 0] - x) < 1e-9), (cells,), len(points))
        for name, x in (("foot", 0.0), ("tip", L))
    }
    return Mesh(points=points, parts={"bar": cells}, faces=faces, face_part={"foot": "bar", "tip": "bar"})


def structure(**changes):
    return Structure(mesh=bar(), materials={"bar": SIMPLE}, joints=(), **changes)


def modes(made, count=8):
    K, M = made.dynamic_matrices
    return lowest_modes(K, M, count, shift_frequency=made.shift_frequency)


def axial(found):
    """Frequencies [Hz] of the modes that move along x only."""
    shape = (found.shapes.reshape(-1, 3, found.shapes.shape[1]) ** 2).sum(axis=0)
    return found.frequencies[shape[0] > 0.99 * shape.sum(axis=0)]


def test_the_mass_of_a_part_is_its_density_times_its_volume():
    made = structure(supports=(Support(face="foot"),), masses=(PointMass(mass=3.0, face="tip"),))
    assert made.part_masses == pytest.approx([7800 * L * WIDTH * HEIGHT])  # the point mass is none of its own


def test_a_beam_on_two_edges_and_one_on_two_points():
    """Bending pi/(2 L^2) sqrt(EI/rho A) of a beam on two pins, one of which slides: both lie on its lower edges.

    The ends turn about the edges, so that all of it moves along x by the turn times half of the depth h, which adds
    (pi h/L)^2/2 to the mass. Shear and rotary inertia lower the frequency by (1 + 2.4)/2 (pi r/L)^2, r = h/sqrt(12).
    """
    mesh = bar((24, 1, 2))
    low = sides_on(np.flatnonzero(np.abs(mesh.points[:, 2]) < 1e-9), mesh.parts["bar"], len(mesh.points))
    mesh = Mesh(
        points=mesh.points,
        parts=dict(mesh.parts),
        faces={**mesh.faces, "low": low},
        face_part={**mesh.face_part, "low": "bar"},
    )
    pin, slide = Support(face="foot", edge="low"), Support(face="tip", edge="low", directions=("y", "z"))
    assert len(pin.nodes(mesh)) == 3
    made = Structure(mesh=mesh, materials={"bar": SIMPLE}, joints=(), supports=(pin, slide))
    assert made.rigid.shape[1] == 0
    euler = pi / (2 * L**2) * SPEED * HEIGHT / 12**0.5
    bend = (pi * HEIGHT / L) ** 2
    assert np.abs(modes(made, 6).frequencies / euler / (1 - bend / 4 - 1.7 * bend / 12) - 1).min() < 2e-3
    corners = [
        Support(face=face, edge="low", point=(x, y, 0.0)) for face, x in (("foot", 0), ("tip", L)) for y in (0, WIDTH)
    ]
    assert [len(one.nodes(mesh)) for one in corners] == [1] * 4
    held = Structure(mesh=mesh, materials={"bar": SIMPLE}, joints=(), supports=corners[:1])
    assert held.rigid.shape[1] == 3  # it turns about a point
    with pytest.raises(faying.InputError, match="share no edge"):
        Support(face="foot", edge="tip").nodes(mesh)
    with pytest.raises(faying.InputError, match="nearest node"):
        Support(face="foot", point=(0.3, 0.0, 0.0)).nodes(mesh)
    with pytest.raises(faying.InputError, match="per area"):
        Support(face="foot", edge="low", stiffness=1e12)


def test_a_clamped_bar():
    """Axial (2n - 1) c/4L; bending 1.8751^2/(2 pi L^2) sqrt(EI/rho A), lowered by shear as Timoshenko's beam is."""
    made = structure(supports=(Support(face="foot"),))
    assert made.rigid.shape[1] == 0
    found = modes(made, 12)
    assert axial(found)[0] == pytest.approx(SPEED / (4 * L), rel=1e-4)
    for depth, tolerance in ((WIDTH, 2e-3), (HEIGHT, 5e-3)):  # the first-order correction is of (r/L)^2: .1 and .3 %
        euler = 1.8751041**2 / (2 * pi * L**2) * SPEED * depth / 12**0.5
        assert np.abs(found.frequencies / euler - 1).min() < tolerance


def test_only_some_directions_held_leave_rigid_motions():
    assert structure(supports=(Support(face="foot", directions=("x",)),)).rigid.shape[1] == 3
    assert structure(supports=(Support(face="foot", directions=("y", "z")),)).rigid.shape[1] == 3
    assert structure().rigid.shape[1] == 6
    made = structure(supports=(Support(face="foot", directions=("x",)),))
    found = modes(made, 6)
    assert found.frequencies[:3].max() < 1e-2 < found.frequencies[3]


def test_an_elastic_foundation():
    """Springs k A at the foot of a free bar: tan(w L/c) = k A c/(E A w)."""
    k = 2e11
    made = structure(supports=(Support(face="foot", directions=("x",), stiffness=k),))
    assert made.rigid.shape[1] == 3  # sideways, and about the axis
    exact = brentq(lambda w: np.tan(w * L / SPEED) - k * SPEED / (200e9 * w), 1.0, 0.999 * pi / 2 * SPEED / L)
    found = axial(modes(made, 14))
    assert found[found > 1][0] == pytest.approx(exact / (2 * pi), rel=1e-5)


def test_stiff_springs_become_a_clamp():
    clamped = axial(modes(structure(supports=(Support(face="foot"),)), 12))[0]
    springs = axial(modes(structure(supports=(Support(face="foot", stiffness=1e16),)), 12))[0]
    assert springs == pytest.approx(clamped, rel=1e-4)


@pytest.mark.parametrize("where", [{"face": "tip"}, {"point": (L, WIDTH / 2, 0.0)}], ids=["face", "node"])
def test_a_mass_on_the_end_of_a_clamped_bar(where):
    """(w L/c) tan(w L/c) = rho A L/m; a node instead of the whole face gives way locally, so it lies a little lower."""
    m = 1.5
    made = structure(supports=(Support(face="foot"),), masses=(PointMass(mass=m, **where),))
    ratio = 7800 * WIDTH * HEIGHT * L / m
    exact = brentq(lambda x: x * np.tan(x) - ratio, 1e-3, pi / 2 - 1e-6) * SPEED / L / (2 * pi)
    if "face" in where:
        assert axial(modes(made, 12))[0] == pytest.approx(exact, rel=1e-4)
    matrix = made.masses[0].matrix(made.mesh)
    for axis in np.eye(3):
        uniform = np.tile(axis, len(made.mesh.points))
        assert uniform @ (matrix @ uniform) == pytest.approx(m)


def test_a_mass_off_the_face_swings():
    """A turn about the centre of the face by 1 rad moves a mass at offset h by h: inertia m h^2."""
    mesh = bar()
    matrix = PointMass(mass=2.0, face="tip", offset=(0.1, 0.0, 0.0)).matrix(mesh)
    arm = mesh.points - [L, WIDTH / 2, HEIGHT / 2]
    turn = np.stack([-arm[:, 1], arm[:, 0], np.zeros(len(arm))], axis=1).ravel()
    assert turn @ (matrix @ turn) == pytest.approx(2.0 * 0.1**2)


def test_messages():
    for make, text in (
        (lambda: Support(face="a", directions=("w",)), "should be some of x, y, z"),
        (lambda: Support(face="a", directions=()), "should be some of x, y, z"),
        (lambda: Support(face="a", stiffness=0.0), "must be positive"),
        (lambda: PointMass(mass=0.0, face="a"), "must be positive"),
        (lambda: PointMass(mass=1.0), "on a face or at a point"),
        (lambda: PointMass(mass=1.0, face="a", point=(0.0, 0.0, 0.0)), "on a face or at a point"),
        (lambda: PointMass(mass=1.0, point=(0.0, 0.0, 0.0), offset=(0.1, 0.0, 0.0)), "offset is from the centre of a"),
        (lambda: PointMass(mass=1.0, point=(50.0, 0.0, 0.0)).matrix(bar()), "mm away; the structure is between"),
        (lambda: Support(face="none").fixed(bar()), "no face is called 'none'"),
    ):
        with pytest.raises(faying.InputError, match=text):
            make()
