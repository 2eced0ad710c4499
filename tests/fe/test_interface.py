import numpy as np
import pytest

import faying
from faying.fe.elasticity import assemble, rigid_motions
from faying.fe.interface import join
from faying.joint.bolted import bond, merged
from tests.helpers.boxes import stack


@pytest.fixture(params=[((2, 3), (2, 3)), ((2, 3), (3, 2))], ids=["matched", "unmatched"])
def pair(request):
    mesh = stack([1.0, 1.5], [2, 2], sections=request.param, width=0.4, height=0.3)
    return mesh, join(mesh, "p0.right", "p1.left")


def test_sum_of_springs_is_stiffness_times_area(pair):
    mesh, joint = pair
    assert joint.area == pytest.approx(0.12, rel=1e-12)
    K = joint.springs(np.full(len(joint.weights), 7.0), np.full(len(joint.weights), 3.0))
    move = np.zeros((len(mesh.points), 3))
    move[np.unique(mesh.parts["p1"]), 0] = 1.0
    assert move.ravel() @ (K @ move.ravel()) == pytest.approx(7.0 * 0.12, rel=1e-12)
    slide = np.roll(move, 1, axis=1)
    assert slide.ravel() @ (K @ slide.ravel()) == pytest.approx(3.0 * 0.12, rel=1e-12)


def test_rigid_motion_of_both_parts_opens_nothing(pair):
    mesh, joint = pair
    assert np.abs(joint.relative @ rigid_motions(mesh.points)).max() < 1e-13


def test_opening_of_a_tilt(pair):
    """Turn the second part about z: the opening grows linearly across the face."""
    mesh, joint = pair
    move = np.zeros((len(mesh.points), 3))
    right = np.unique(mesh.parts["p1"])
    move[right, 0] = mesh.points[right, 1]
    assert joint.opening(move.ravel()) == pytest.approx(joint.positions[:, 1], abs=1e-12)


def test_normals_run_from_the_first_face_to_the_second(pair):
    assert pair[1].normals == pytest.approx(np.tile([1.0, 0, 0], (len(pair[1].weights), 1)))


def test_gap_is_measured():
    mesh = stack([1.0, 1.0], [1, 1], gap=2e-3)
    joint = join(mesh, "p0.right", "p1.left")
    assert joint.gap == pytest.approx(np.full(len(joint.weights), 2e-3))


def test_faces_that_do_not_touch():
    mesh = stack([1.0, 1.0], [1, 1], gap=0.5)
    with pytest.raises(faying.InputError, match=r"do not touch: they are 500 mm apart .* check the unit"):
        join(mesh, "p0.right", "p1.left")
    with pytest.raises(faying.InputError, match="both on part 'p0'"):
        join(mesh, "p0.right", "p0.left")


def test_nodal_shares_are_positive_and_fill_the_area():
    mesh = stack([1.0, 1.0], [2, 2])
    nodes = join(mesh, "p0.right", "p1.left").at_nodes()
    assert np.all(nodes.weights > 0)
    assert nodes.area == pytest.approx(1.0, rel=1e-12)
    assert mesh.points[nodes.first_nodes[:, 0]] == pytest.approx(mesh.points[nodes.second_nodes[:, 0]])


def test_node_springs_need_matched_faces():
    mesh = stack([1.0, 1.0], [2, 2], sections=[(2, 2), (3, 3)])
    with pytest.raises(faying.InputError, match="meshes match"):
        join(mesh, "p0.right", "p1.left").at_nodes()


def test_tie_merges_matched_faces_only():
    mesh = stack([1.0, 1.0], [2, 2])
    grown = bond(mesh, [("p0.right", "p1.left")])
    assert grown.shape == (mesh.unknowns, mesh.unknowns - 3 * 25)
    for matrix in assemble(mesh, dict.fromkeys(mesh.parts, faying.CATALOGUE["45 steel"])):
        wanted = grown.T @ matrix @ grown
        assert abs(merged(matrix, grown) - wanted).max() <= 1e-14 * abs(wanted).max()
    assert bond(stack([1.0, 1.0], [2, 2], sections=[(2, 2), (3, 3)]), [("p0.right", "p1.left")]) is None
