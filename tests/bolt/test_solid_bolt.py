"""Solid bolts: what presses the seats is the tension asked for, wherever the shank is drawn in, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.bolt.solid_bolt import SolidBolt
from faying.fe.elasticity import assemble
from faying.fe.interface import join
from faying.fe.stress import part_stresses
from faying.joint.joint import FittedJoint
from faying.joint.joint_law import JointLaw
from faying.joint.structure import Structure
from faying.joint.tighten import tighten
from tests.helpers.voxels import bolted, voxels
from tests.joint.test_tighten import bed

STEEL = faying.Material(name="steel", E=200e9, nu=0.3, density=7800.0)


def structure(mesh, bolts=1, **changes):
    pairs = [("lower.joint", "upper.joint")]
    for i in range(bolts):
        pairs += [(f"bolt{i}.head", f"upper.seat{i}"), (f"bolt{i}.nut", f"lower.seat{i}")]
    joints = tuple(
        FittedJoint(
            name=first,
            faces=(first, second),
            interface=join(mesh, first, second),
            law=JointLaw(model=bed(2e13), tangential="law", nu=0.3),
        )
        for first, second in pairs
    )
    solids = tuple(
        SolidBolt(name=f"bolt{i}", part=f"bolt{i}", faces=(f"bolt{i}.head", f"bolt{i}.nut"), **changes)
        for i in range(bolts)
    )
    return Structure(mesh=mesh, materials=dict.fromkeys(mesh.parts, STEEL), joints=joints, bolts=solids)


@pytest.fixture(scope="module")
def single():
    return bolted(kind="hex8")


def structure_strained(mesh):
    """What strains the parts where the plane of the bolt lies half-way between its faces (unknowns, 1)."""
    made = structure(mesh)
    return made.strained(tighten(made, made.assembly(), [5e3]))[:, None]


def test_the_loss_of_one_joint_is_not_that_of_a_mode(single):
    """With a law that gives none in the other joints a mode has no loss factor, and damping at rest its prior."""
    made = structure(single)
    lossy = faying.JK(D=2.39, G=1.53e-10, scan_area=16e-6, pair=faying.ContactPair("45 steel", "45 steel"))
    joints = [replace(made.joints[0], law=JointLaw(model=lossy)), *made.joints[1:]]
    for some, known in ((joints, False), ([replace(one, law=joints[0].law) for one in joints], True)):
        mixed = replace(made, joints=some)
        assert mixed.predicts_loss is known
        assert np.isfinite(mixed.solve(5e3, modes=2).modes.loss_factors).all() == known


@pytest.mark.parametrize("height", [12.5e-3, 17.5e-3])
def test_the_shank_bears_its_tension_wherever_it_is_drawn_in(single, height):
    """F/A in the middle, and nowhere much more; the layer that is drawn in had some 40 times of it."""
    made = structure(single, at=(0.02, 0.02, height))
    strained = made.strained(tighten(made, made.assembly(), [5e3]))
    found = part_stresses(single, made.materials, strained[:, None])["bolt0"]
    z = single.points[found.nodes, 2]
    assert found.von_mises.max() < 1.2 * 5e3 / 16e-6
    assert np.mean(found.stress[np.abs(z - 10e-3) < 1e-6, 2, 0]) == pytest.approx(5e3 / 16e-6, rel=0.01)
    whole = part_stresses(single, made.materials, structure_strained(single))["bolt0"]
    np.testing.assert_allclose(found.von_mises, whole.von_mises, rtol=1e-5, atol=1e-6 * whole.von_mises.max())


def squeezed(made, found):
    """Force [N] through each joint."""
    return np.array([j.interface.weights @ p for j, p in zip(made.joints, found.pressures, strict=True)])


def test_the_seats_and_the_joint_carry_the_tension(single):
    made = structure(single)
    found = tighten(made, made.assembly(), [5e3])
    assert squeezed(made, found) == pytest.approx(5e3, rel=1e-7)


def test_a_bolt_is_not_drawn_in_where_it_shares_nodes_with_a_part():
    """The elements of the sleeve would be drawn with it, and its tension would be none of the preload."""
    mm = 1e-3
    across = np.array([-6, -3, 3, 6]) * mm
    high = np.array([-3, 0, 2, 5, 10, 15, 18, 20, 23]) * mm

    def off(p):
        return np.abs(p[:, :2]).max(axis=1) / mm

    def wall(p):
        return (np.abs(p[:, 0] - 3 * mm) < 1e-9) & (np.abs(p[:, 1]) < 3.1 * mm) & (np.abs(p[:, 2] - 10 * mm) < 5.1 * mm)

    parts = {
        "bolt": lambda p: (off(p) < 3) | (p[:, 2] < 0) | (p[:, 2] > 20 * mm),
        "sleeve": lambda p: (off(p) > 3) & (np.abs(p[:, 2] - 10 * mm) < 5 * mm),
    }
    faces = {
        "head": ("bolt", lambda p: (np.abs(p[:, 2] - 20 * mm) < 1e-9) & (off(p) > 2.9)),
        "nut": ("bolt", lambda p: (np.abs(p[:, 2]) < 1e-9) & (off(p) > 2.9)),
        "wall": ("bolt", wall),
        "inside": ("sleeve", wall),
    }
    mesh = voxels((across, across, high), parts, faces, kind="hex8").bonded_at(("wall", "inside"))
    bolt = SolidBolt(name="b", part="bolt", faces=("head", "nut"))
    K = assemble(mesh, dict.fromkeys(mesh.parts, STEEL))[0]
    with pytest.raises(faying.InputError, match="nodes that it shares with 'sleeve'"):
        bolt.fitted(mesh, K)
    assert replace(bolt, at=(0, 0, 19 * mm)).fitted(mesh, K).rigidity > 0


@pytest.mark.parametrize("height", [2.5e-3, 13e-3, 17e-3])
def test_where_the_shank_is_drawn_in_makes_no_difference(single, height):
    middle = structure(single)
    other = structure(single, at=(0.02, 0.02, height))
    first, second = (tighten(made, made.assembly(), [5e3]) for made in (middle, other))
    for a, b in zip(first.pressures, second.pressures, strict=True):
        assert b == pytest.approx(a, rel=1e-6, abs=1e-6 * a.max())


def test_the_force_is_that_of_the_stresses_in_the_shank(single):
    """Mean axial stress in the shank's elements away from the plane, from their strains, times the area 16 mm2."""
    made = structure(single, at=(0.02, 0.02, 17e-3))
    found = tighten(made, made.assembly(), [5e3])
    u = found.displacement.reshape(-1, 3)
    points = single.points
    nodes = single.part_nodes("bolt0")
    shank = nodes[np.max(np.abs(points[nodes, :2] - 0.02), axis=1) < 2.1e-3]
    low, high = (shank[np.abs(points[shank, 2] - z) < 1e-9] for z in (5e-3, 10e-3))
    stretch = (u[high, 2].mean() - u[low, 2].mean()) / 5e-3
    assert STEEL.E * stretch * 16e-6 == pytest.approx(5e3, rel=0.02)  # ends of the shank bulge under the head


def test_vibration_has_the_whole_bolt(single):
    """Once tight, the structure is the mesh and its joints: nothing is left of how the bolt was pulled."""
    made = structure(single)
    found = tighten(made, made.assembly(), [5e3])
    K, _ = made.coupled(made.springs(found.pressures))
    plain = made.matrices[0] + sum(s.stiffness() for s in made.springs(found.pressures))
    assert abs(K - plain).max() < 1e-12 * abs(plain).max()
    assert abs(made.dynamic_matrices[1] - made.matrices[1]).max() == 0


def test_bolts_in_turn_leave_what_presses_their_heads():
    """The force that is left in a bolt is worked out from its stretch.

    The pressure under its head knows nothing of it.
    """
    mesh = bolted(places=((14e-3, 20e-3), (32e-3, 20e-3)), length=46e-3, kind="hex8")
    made = structure(mesh, bolts=2)
    found = tighten(made, made.assembly(), [5e3, 5e3], order=[0, 1])
    presses = squeezed(made, found)
    heads, nuts = presses[1::2], presses[2::2]
    assert found.bolt_forces == pytest.approx(heads, rel=1e-6)
    assert nuts == pytest.approx(heads, rel=1e-6)
    assert presses[0] == pytest.approx(heads.sum(), rel=1e-6)
    assert found.bolt_forces[1] == pytest.approx(5e3, rel=1e-9)
    assert found.bolt_forces[0] < 4.99e3  # relaxed by its neighbour
    once = tighten(made, made.assembly(), [5e3, 5e3], order=[0, 1, 0, 1])
    assert abs(once.bolt_forces[0] - 5e3) < abs(found.bolt_forces[0] - 5e3)


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({"at": (0.02, 0.02, 22e-3)}, "does not part 'bolt0.head' from 'bolt0.nut'; give a point between them"),
        ({"at": (0.02, 0.02, 12e-3)}, "'bolt0.shank', which is in a joint; give a point of the bare shank"),
        ({"faces": ("bolt0.nut", "bolt0.nut")}, "does not look towards"),
        ({"faces": ("bolt0.head", "lower.seat0")}, "its face 'lower.seat0' is on 'lower'"),
        ({"faces": ("upper.seat0", "bolt0.nut")}, "its face 'upper.seat0' is on 'upper'"),
    ],
)
def test_what_is_refused(single, changes, fault):
    made = structure(single)
    bolt = SolidBolt(**({"name": "bolt0", "part": "bolt0", "faces": ("bolt0.head", "bolt0.nut")} | changes))
    with pytest.raises(faying.InputError, match=fault):
        bolt.fitted(single, made.matrices[0], ["bolt0.head", "bolt0.nut", "bolt0.shank"])


def test_bolts_that_are_no_bolts_of_a_structure(single):
    made = structure(single)
    with pytest.raises(faying.InputError, match="bolt 'bolt0': its face 'bolt0.nut' is in no joint; add a"):
        replace(made, joints=made.joints[:2])
    with pytest.raises(faying.InputError, match="part bolt0 is two solid bolts"):
        replace(made, bolts=made.bolts * 2)


def test_a_layer_too_fine_to_couple(single, monkeypatch):
    monkeypatch.setattr("faying.bolt.solid_bolt.MAX_LAYER_UNKNOWNS", 30)
    with pytest.raises(faying.InputError, match="unknowns, which all couple .* mesh the shank more coarsely"):
        structure(single).loads  # noqa: B018
