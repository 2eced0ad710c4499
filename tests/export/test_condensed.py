"""A joint as 6 x 6 against sums in closed form and against the full model."""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.export.condense import CondensedJoint, condensed_modes
from faying.fe.elasticity import unit_motions
from faying.fe.interface import join
from faying.joint.attachments import Support
from faying.joint.joint import FittedJoint
from faying.joint.joint_law import JointLaw
from faying.joint.structure import Structure
from faying.numerics.modes import lowest_modes
from tests.helpers.boxes import stack
from tests.helpers.laws import Given

STEEL = faying.Material(name="steel", E=200e9, nu=0.3, density=7800.0)
WIDTH, HEIGHT, LENGTH = 20e-3, 30e-3, 60e-3
K_N, K_T, ETA_N, ETA_T = 4e12, 3e12, 0.02, 0.05


def rods(k=1.0, slope=0.0, material=STEEL, **mesh):
    """Two rods along x, on end: structure and springs; slope: of k_n over z."""
    made = stack([LENGTH, LENGTH], mesh.pop("counts", [4, 4]), width=WIDTH, height=HEIGHT, **mesh)
    law = JointLaw(model=Given(k_n=lambda p: k * K_N + 0 * p, k_t=lambda p: k * K_T + 0 * p))
    joint = FittedJoint(name="j", faces=("p0.right", "p1.left"), interface=join(made, "p0.right", "p1.left"), law=law)
    structure = Structure(mesh=made, materials=dict.fromkeys(made.parts, material), joints=(joint,))
    i = joint.interface
    (plain,) = structure.springs([np.full(len(i.weights), 1e6)])
    vary = 1 + slope * (i.positions[:, 2] / HEIGHT - 0.5)
    flat = np.ones(len(i.weights))
    springs = replace(plain, k_n=plain.k_n * vary, k_t=plain.k_t, loss_n=ETA_N * flat, loss_t=ETA_T * flat)
    return structure, springs


def test_even_springs_on_rigid_faces_in_closed_form():
    """k_n A along the normal, k_t A across, k_n I about axes in the face and k_t (I_y + I_z) about the normal."""
    _, springs = rods()
    found = CondensedJoint.of(springs)
    A, about_y, about_z = WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12, HEIGHT * WIDTH**3 / 12
    assert found.point == pytest.approx([LENGTH, WIDTH / 2, HEIGHT / 2])
    wanted = [K_N * A, K_T * A, K_T * A, K_T * (about_y + about_z), K_N * about_y, K_N * about_z]
    assert np.diag(found.stiffness) == pytest.approx(wanted, rel=1e-9)
    rest = found.stiffness - np.diag(wanted)
    assert np.abs(rest / np.sqrt(np.outer(wanted, wanted))).max() < 1e-9
    assert np.diag(found.loss) == pytest.approx(np.array(wanted) * [ETA_N, ETA_T, ETA_T, ETA_T, ETA_N, ETA_N], rel=1e-9)


def test_springs_that_vary_couple():
    """k_n = k (1 + s (z/h - 1/2)): about the middle a turn about y takes the normal force -k s h/12 A."""
    slope = 0.8
    _, springs = rods(slope=slope)
    middle = np.array([LENGTH, WIDTH / 2, HEIGHT / 2])
    found = CondensedJoint.of(springs, middle)
    coupling = K_N * WIDTH * HEIGHT * slope * HEIGHT / 12
    assert found.stiffness[0, 4] == pytest.approx(coupling, rel=1e-9)
    assert CondensedJoint.of(springs).stiffness[0, 4] == pytest.approx(0.0, abs=1e-9 * coupling)


def test_between_two_points():
    """Rigid motions of both cost nothing; with both at the point it is [[K, -K], [-K, K]]; forces balance."""
    _, springs = rods(slope=0.5)
    found = CondensedJoint.of(springs)
    K = found.stiffness
    same, lost = found.between(found.point, found.point)
    assert same == pytest.approx(np.block([[K, -K], [-K, K]]))
    assert lost[6:, 6:] == pytest.approx(found.loss)
    first, second = found.point + np.array([-0.02, 0.01, 0.003]), found.point + np.array([0.05, 0.0, -0.01])
    matrix, _ = found.between(first, second)
    rigid = np.zeros((12, 6))
    for rows, at in ((slice(0, 6), first), (slice(6, 12), second)):
        rigid[rows] = np.eye(6)
        rigid[rows][:3] = unit_motions(at)
    assert np.abs(matrix @ rigid).max() < 1e-9 * np.abs(matrix).max()
    assert matrix == pytest.approx(matrix.T, abs=1e-12 * np.abs(matrix).max())
    assert np.linalg.matrix_rank(matrix, tol=1e-9 * np.abs(matrix).max()) == 6


def both(structure, springs, count=12):
    K, _ = structure.coupled([springs])
    full = lowest_modes(K, structure.dynamic_matrices[1], count, shift_frequency=structure.shift_frequency)
    ties = condensed_modes(structure, [springs], 0, count)
    return full.frequencies[6:], ties.frequencies[6:], full, ties


@pytest.mark.parametrize("slope", [0.0, 0.9])
def test_against_the_full_model_below_the_first_internal_mode(slope):
    """Sections stay plane in the lowest modes: bending, twist and length within 1 %, and softer."""
    structure, springs = rods(slope=slope, sections=[(3, 4), (3, 4)])
    full, found, _, _ = both(structure, springs)
    assert found == pytest.approx(full, rel=0.01)
    assert np.all(found <= full * (1 + 1e-7))


def test_rigid_parts_make_the_condensed_joint_exact():
    """Rods ten thousand times as stiff: the six lowest modes are those of the joint."""
    structure, springs = rods(material=replace(STEEL, E=200e13))
    full, found, _, _ = both(structure, springs)
    assert found == pytest.approx(full[:6], rel=1e-4)
    M = WIDTH * HEIGHT * LENGTH * 7800.0
    assert np.min(np.abs(full - np.sqrt(2 * K_N * WIDTH * HEIGHT / M) / (2 * np.pi))) < 1e-3 * full[0]


def test_loss_factors_are_those_of_the_full_joint():
    """To first order, energy lost in the springs over that of the mode."""
    structure, springs = rods(k=0.1)
    full, _, modes, ties = both(structure, springs)
    shapes = modes.shapes[:, 6:]
    lost = np.einsum("im,im->m", shapes, springs.loss() @ shapes) / (2 * np.pi * full) ** 2
    assert ties.loss_factors[6:] == pytest.approx(lost, rel=0.03, abs=1e-5)


def test_what_cannot_be_condensed():
    _, springs = rods()
    nothing = replace(springs, k_n=0 * springs.k_n, k_t=0 * springs.k_t)
    with pytest.raises(faying.InputError, match="the joint is open"):
        CondensedJoint.of(nothing)
    one = np.arange(len(springs.k_n)) == 0
    point = replace(springs, k_n=np.where(one, springs.k_n, 0.0), k_t=np.where(one, springs.k_t, 0.0))
    with pytest.raises(faying.InputError, match="one line or at one point"):
        CondensedJoint.of(point)


def test_supports_and_other_joints_stay():
    """Three rods, fixed at one end: one joint is condensed, the other keeps its springs."""
    made = stack([LENGTH] * 3, [3] * 3, width=WIDTH, height=HEIGHT)
    law = JointLaw(model=Given(k_n=lambda p: K_N + 0 * p, k_t=lambda p: K_T + 0 * p))
    joints = tuple(
        FittedJoint(name=str(k), faces=pair, interface=join(made, *pair), law=law)
        for k, pair in enumerate((("p0.right", "p1.left"), ("p1.right", "p2.left")))
    )
    structure = Structure(
        mesh=made, materials=dict.fromkeys(made.parts, STEEL), joints=joints, supports=(Support(face="p0.left"),)
    )
    springs = structure.springs([np.full(len(j.interface.weights), 1e6) for j in joints])
    K, _ = structure.coupled(springs)
    full = lowest_modes(K, structure.dynamic_matrices[1], 5, shift_frequency=structure.shift_frequency).frequencies
    for number in (0, 1):
        mean = condensed_modes(structure, springs, number, 5).frequencies
        assert mean == pytest.approx(full, rel=0.01)
        assert np.all(mean <= full * (1 + 1e-7))
