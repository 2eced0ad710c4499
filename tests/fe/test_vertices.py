"""The coarse space of the corners: what it holds exactly, and the matrices on it."""

import numpy as np
import pytest

import faying
from faying.fe.elasticity import assemble
from faying.fe.mesh import Mesh
from faying.fe.vertices import VertexRestriction
from tests.helpers.boxes import block

STEEL = faying.CATALOGUE["45 steel"]
LINEAR = {"tet10": "tet4", "wedge15": "wedge6", "hex20": "hex8"}


def box(kind, move=None):
    points, cells = block(kind, (2, 3, 2), (0.03, 0.02, 0.01), move=move)
    return Mesh(points=points, parts={"p": cells}, faces={}, face_part={})


@pytest.mark.parametrize("kind", LINEAR)
def test_a_linear_motion_is_that_of_the_corners(kind):
    mesh = box(kind, move=(0.2, 4))
    corners = VertexRestriction.of(mesh)
    assert len(corners.unknowns) == 3 * len(box(LINEAR[kind]).points)
    motion = (mesh.points @ np.random.default_rng(1).standard_normal((3, 3)) + [1.0, 2.0, 3.0]).ravel()
    assert corners.spread @ motion[corners.unknowns] == pytest.approx(motion, rel=1e-13)


@pytest.mark.parametrize("kind", LINEAR)
def test_on_the_corners_the_matrices_are_those_of_elements_of_first_order(kind):
    corners = VertexRestriction.of(box(kind))
    stiffness, mass = (corners.of_matrix(matrix) for matrix in assemble(box(kind), {"p": STEEL}))
    wanted = assemble(box(LINEAR[kind]), {"p": STEEL})
    assert abs(mass - wanted[1]).max() < 1e-12 * abs(mass).max()
    if kind != "hex20":  # eight nodes bend by modes of their own, too
        assert abs(stiffness - wanted[0]).max() < 1e-12 * abs(stiffness).max()


@pytest.mark.parametrize("kind", LINEAR.values())
def test_where_every_node_is_a_corner_there_is_no_coarse_space(kind):
    assert VertexRestriction.of(box(kind)) is None
