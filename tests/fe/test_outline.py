"""The outer surface with parts and faces: areas of boxes, faces of several names, smooth regions of a cylinder."""

import numpy as np
import pytest

from faying.fe.outline import normals, outline, regions
from tests.helpers.boxes import SOLID_KINDS, row


@pytest.mark.parametrize("kind", SOLID_KINDS)
def test_triangles_know_their_part_and_face(kind):
    mesh = row([1.0, 2.0], [2, 3], kinds=(kind, kind))
    found = outline(mesh)
    points = mesh.points[found.nodes]
    a, b, c = (points[found.triangles[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    for part, length in enumerate((1.0, 2.0)):
        mine = found.part_of_triangle == part
        assert area[mine].sum() == pytest.approx(2 + 4 * length)
        for side, sign in (("left", -1), ("right", 1)):
            here = found.face_of_triangle == found.faces.index(f"p{part}.{side}")
            assert np.all(mine[here])
            assert area[here].sum() == pytest.approx(1.0)
            np.testing.assert_allclose(normals(points, found.triangles[here])[:, 0], sign, atol=1e-12)


def test_a_triangle_on_two_faces_belongs_to_the_one_that_comes_first():
    from dataclasses import replace

    mesh = row([1.0], [2], kinds=("hex8",))
    twice = replace(
        mesh,
        faces={**mesh.faces, "again": mesh.faces["p0.left"]},
        face_part={**mesh.face_part, "again": "p0"},
    )
    for first in ("p0.left", "again"):
        found = outline(twice, [first])
        assert found.faces[0] == first
        assert np.count_nonzero(found.face_of_triangle == 0) == 8
        others = {found.faces[k] for k in found.face_of_triangle[found.face_of_triangle > 0]}
        assert others == {"p0.right"}


def test_smooth_regions_of_a_cylinder_are_its_mantle_and_its_ends():
    n = 24
    angle = 2 * np.pi * np.arange(n) / n
    ring = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    points = np.concatenate([ring, ring + np.array([0, 0, 2]), [[0, 0, 0], [0, 0, 2]]])
    k, j = np.arange(n), (np.arange(n) + 1) % n
    mantle = np.concatenate([np.stack([k, j, n + j], 1), np.stack([k, n + j, n + k], 1)])
    ends = np.concatenate([np.stack([j, k, 0 * k + 2 * n], 1), np.stack([n + k, n + j, 0 * k + 2 * n + 1], 1)])
    triangles = np.concatenate([mantle, ends])
    found = regions(points, triangles, np.zeros(len(triangles), dtype=np.int64))
    assert len(np.unique(found)) == 3
    assert len(np.unique(found[: 2 * n])) == 1
    apart = np.arange(len(triangles)) % 2
    assert len(np.unique(regions(points, triangles, apart))) > 3
