"""Parts that nothing holds are named: no contact left, no tangential stiffness."""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.bolt.bolt import Bolt
from faying.fe.interface import join
from faying.joint.attachments import Support
from faying.joint.joint import FittedJoint
from faying.joint.joint_law import JointLaw
from faying.joint.preload_case import PreloadCase
from faying.joint.structure import Structure
from faying.joint.support_check import check_motions, checked_preload, open_joints
from faying.numerics.modes import lowest_modes
from tests.helpers.boxes import stack
from tests.helpers.laws import Given

STEEL = faying.CATALOGUE["45 steel"]


SLIPPERY = Given("slippery", k_n=lambda p: 2 * np.sqrt(1e19 * p), k_t=np.zeros_like)  # p = c w^2


def law():
    return faying.JK(D=2.39, G=1.53e-10, pair=faying.ContactPair(STEEL, STEEL), scan_area=16e-6)


def three(gap, **changes):
    """Bars in a row, pulled together at the first joint only; the second lies `gap` apart."""
    mesh = stack([0.03] * 3, [2] * 3, width=0.02, height=0.02)
    joints = []
    for name, faces, apart in (("a", ("p0.right", "p1.left"), 0.0), ("b", ("p1.right", "p2.left"), gap)):
        interface = join(mesh, *faces)
        interface = replace(interface, gap=interface.gap + apart)
        joints.append(FittedJoint(name=name, faces=faces, interface=interface, law=JointLaw(model=law())))
    bolt = Bolt(name="bolt", faces=("p0.left", "p1.right"))
    return Structure(
        mesh=mesh, materials=dict.fromkeys(mesh.parts, STEEL), joints=tuple(joints), bolts=(bolt,), **changes
    )


def test_a_gap_that_the_preload_does_not_close():
    """The bolt shortens its bars by far less than 50 um, and nothing presses the third bar."""
    structure = three(50e-6, supports=(Support(face="p0.left"),))
    with pytest.raises(
        faying.InputError, match=r"part 'p2' is free to move .* joint 'b' \(.* um apart .* gap map and its unit"
    ):
        checked_preload(structure, structure.assembly(), PreloadCase((2e3,)))


def test_an_open_joint_between_parts_that_are_held_otherwise():
    structure = three(50e-6, supports=(Support(face="p0.left"), Support(face="p2.right")))
    found = checked_preload(structure, structure.assembly(), PreloadCase((2e3,)))
    assert open_joints(structure, found.pressures) == ["b"]
    assert found.openings[1].min() == pytest.approx(50e-6, rel=0.1)
    assert not np.any(found.pressures[1])


def test_a_part_that_slides_freely_is_named():
    mesh = stack([0.05, 0.03], [3, 2], width=0.02, height=0.02)
    joint = FittedJoint(
        name="j",
        faces=("p0.right", "p1.left"),
        interface=join(mesh, "p0.right", "p1.left"),
        law=JointLaw(model=SLIPPERY),
    )
    bolt = Bolt(name="bolt", faces=("p0.left", "p1.right"))
    free = Structure(mesh=mesh, materials=dict.fromkeys(mesh.parts, STEEL), joints=(joint,), bolts=(bolt,))
    for structure, still in ((free, 6), (replace(free, supports=(Support(face="p0.left"),)), 0)):
        K, _ = structure.coupled(structure.springs((np.full(len(joint.interface.weights), 5e6),)))
        modes = lowest_modes(K, structure.dynamic_matrices[1], 12, shift_frequency=structure.shift_frequency)
        # two slips and a twist beside the rigid motions of the whole; the smaller part does most of it
        with pytest.raises(
            faying.InputError, match=f"{still + 3} motions cost no energy and {still} of them .* part 'p1' moves"
        ):
            check_motions(structure, modes)
    sticking = replace(free, joints=(replace(joint, law=JointLaw(model=law())),))
    K, _ = sticking.coupled(sticking.springs((np.full(len(joint.interface.weights), 5e6),)))
    check_motions(sticking, lowest_modes(K, sticking.dynamic_matrices[1], 12, shift_frequency=sticking.shift_frequency))


def clamped_pair(*supports):
    """Two bars bolted together on supports."""
    mesh = stack([0.03, 0.03], [2, 2], width=0.02, height=0.02)
    joint = FittedJoint(
        name="j", faces=("p0.right", "p1.left"), interface=join(mesh, "p0.right", "p1.left"), law=JointLaw(model=law())
    )
    bolt = Bolt(name="bolt", faces=("p0.left", "p1.right"))
    return Structure(
        mesh=mesh, materials=dict.fromkeys(mesh.parts, STEEL), joints=(joint,), bolts=(bolt,), supports=supports
    )


def modes_of(structure):
    found = checked_preload(structure, structure.assembly(), PreloadCase((2e3,)))
    K, _ = structure.coupled(structure.springs(found.pressures))
    return lowest_modes(K, structure.dynamic_matrices[1], 8, shift_frequency=structure.shift_frequency)


def test_a_soft_suspension_is_no_loose_part():
    """100 Pa/um in all directions: the whole sways far below its first elastic mode, f = sqrt(k A/m)/2 pi."""
    structure = clamped_pair(Support(face="p0.left", stiffness=1e8))
    assert structure.rigid_count == 0
    modes = modes_of(structure)
    check_motions(structure, modes)
    along = np.sqrt(1e8 * 4e-4 / (STEEL.density * 0.06 * 4e-4)) / (2 * np.pi)
    assert np.abs(modes.frequencies[:6] / along - 1).min() < 0.01


def test_springs_that_a_fixed_face_takes_away_leave_the_free_motions():
    """z at rest and springs along z on one face: what they resist is fixed already, and four motions are left."""
    structure = clamped_pair(
        Support(face="p0.left", directions=("z",)), Support(face="p0.left", directions=("z",), stiffness=1e12)
    )
    only_fixed = clamped_pair(Support(face="p0.left", directions=("z",)))
    assert structure.rigid_count == only_fixed.rigid_count == 4
    check_motions(structure, modes_of(structure))
