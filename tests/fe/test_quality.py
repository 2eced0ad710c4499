"""Scaled Jacobians against closed forms, and what is noted."""

import numpy as np
import pytest

from faying.fe.mesh import Mesh
from faying.fe.quality import quality, scaled_jacobian
from tests.helpers.boxes import SOLID_KINDS, block

IDEAL = {
    "tet4": [[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]],
    "hex8": [[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))],
    "wedge6": [[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (0.5, 3**0.5 / 2))],
}


@pytest.mark.parametrize("kind", IDEAL)
def test_ideal_elements_have_one_and_flat_ones_nothing(kind):
    points = np.array(IDEAL[kind], dtype=float)
    cells = np.arange(len(points))[None]
    volume = np.linalg.det(points[[1, 2, 3]] - points[0]) if kind == "tet4" else 1.0
    cells = cells if volume > 0 else cells[:, [0, 2, 1, 3]]
    assert scaled_jacobian(points, cells) == pytest.approx([1.0], rel=1e-12)
    assert scaled_jacobian(points * 7e-3, cells) == pytest.approx([1.0], rel=1e-12)
    flat = scaled_jacobian(points * [1, 1, 1e-4], cells)
    assert flat < 0.01 if kind == "tet4" else flat == pytest.approx([1.0], rel=1e-9)


def test_a_sheared_brick_has_the_sine_of_its_angle():
    points = np.array(IDEAL["hex8"], dtype=float)
    angle = np.deg2rad(20)
    points[:, 0], points[:, 1] = points[:, 0] + points[:, 1] * np.cos(angle), points[:, 1] * np.sin(angle)
    assert scaled_jacobian(points, np.arange(8)[None]) == pytest.approx([np.sin(angle)], rel=1e-12)


@pytest.mark.parametrize("kind", SOLID_KINDS)
@pytest.mark.parametrize("height", [0.6, 1e-3])
def test_notes(kind, height):
    points, cells = block(kind, (2, 2, 2), (1.0, 0.8, height))
    found = quality(Mesh(points=points, parts={"p": cells}, faces={}, face_part={}))
    assert found.counts == {kind: len(cells)}
    codes = [note.code for note in found.notes]
    assert ("stiff-elements" in codes) == (kind == "tet4")
    assert ("distorted-elements" in codes) == (kind.startswith("tet") and height < 0.01)
