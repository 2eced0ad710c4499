import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from faying import InputError, ReadError
from faying.measured.mapping import Transform, fit_transform, map_points, read_points

seeds = st.integers(0, 2**32 - 1)


def rotation(rng):
    q, r = np.linalg.qr(rng.standard_normal((3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


@given(seeds, st.integers(3, 9), st.floats(0, 0.02))
def test_a_turned_and_shifted_frame_is_found_again(seed, count, noise):
    """Exact pairs give the transformation back; noisy ones leave no more than their own noise."""
    rng = np.random.default_rng(seed)
    r, shift = rotation(rng), rng.standard_normal(3)
    a = rng.standard_normal((count, 3))
    a[:3] += np.eye(3)[:3] * 4  # a wide triangle, so that the rotation is well determined
    error = noise * rng.standard_normal(a.shape)
    found = fit_transform(a, a @ r.T + shift + error)
    assert found.rms <= np.sqrt(np.mean(np.sum(error**2, axis=1))) + 1e-12
    np.testing.assert_allclose(found.rotation, r, atol=max(1e-9, 5 * noise))
    np.testing.assert_allclose(found.points(a), a @ r.T + shift, atol=max(1e-9, 6 * noise))
    np.testing.assert_allclose(found.directions([0, 0, 1.0]), r[:, 2], atol=max(1e-9, 5 * noise))


def test_three_points_are_enough_even_in_a_plane():
    a = np.array([[0, 0, 0], [1.0, 0, 0], [0, 2.0, 0]])
    r = rotation(np.random.default_rng(0))
    np.testing.assert_allclose(fit_transform(a, a @ r.T).rotation, r, atol=1e-12)


@pytest.mark.parametrize(
    ("test", "model", "match"),
    [
        (np.eye(3)[:2], np.eye(3)[:2], "three pairs or more"),
        (np.outer(range(4), [1.0, 1, 0]), np.outer(range(4), [1.0, 1, 0]), "are on one line"),
        (np.vstack([np.eye(3), np.zeros(3)]), np.vstack([np.eye(3), np.zeros(3)]) * [1, 1, -1], "left-handed"),
        (np.eye(3) * 1000, np.eye(3), "the sizes are as 1 to 0.001"),
    ],
)
def test_pairs_that_cannot_be_fitted(test, model, match):
    with pytest.raises(InputError, match=match):
        fit_transform(test, model)


def test_a_transformation_neither_scales_nor_mirrors():
    for matrix in (2 * np.eye(3), np.diag([1, 1, -1.0])):
        with pytest.raises(InputError, match="is not a rotation"):
            Transform(rotation=matrix)


GRID = np.stack(np.meshgrid(*[np.linspace(0, 1, 11)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)


def test_nearest_nodes_and_what_found_none():
    found = map_points({1: (0.52, 0.5, 0.0), 2: (0, 0, 1.2), 9: (0, 0.97, 0)}, GRID, tolerance=0.05)
    np.testing.assert_allclose(GRID[found.nodes[1]], [0.5, 0.5, 0])
    np.testing.assert_allclose(GRID[found.nodes[9]], [0, 1, 0])
    assert found.distance[1] == pytest.approx(0.02)
    assert found.missing == {2: pytest.approx(0.2)}


def test_points_on_nodes_of_two_parts_are_named():
    """Two cubes that touch at x = 1, each with nodes of its own there."""
    found = map_points({1: (0.5, 0.5, 0.0), 7: (1.0, 0.3, 0.3)}, np.concatenate([GRID, GRID + np.array([1.0, 0, 0])]))
    assert found.seams == (7,)


def test_default_tolerance_is_two_per_cent_of_the_diagonal():
    assert map_points({1: (0, 0, 0)}, GRID).tolerance == pytest.approx(0.02 * np.sqrt(3))


@pytest.mark.parametrize(
    ("positions", "tolerance", "match"),
    [
        ({}, None, "--points points.csv"),
        ({1: (0, 0, 0)}, 0.0, "must be positive"),
        ({1: (100.0, 0, 0), 2: (0, 400, 300)}, None, "check the unit"),
    ],
)
def test_points_that_find_nothing(positions, tolerance, match):
    with pytest.raises(InputError, match=match):
        map_points(positions, GRID, tolerance=tolerance)


def test_a_table_of_points(tmp_path):
    file = tmp_path / "points.csv"
    file.write_text("point,x [mm],y [mm],z [mm]\n1,10,-20,0.5\n\n7,0,0,1e3\n")
    assert {k: pytest.approx(v) for k, v in read_points(file).items()} == {1: (0.01, -0.02, 5e-4), 7: (0, 0, 1)}


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("", "the head is empty"),
        ("1,2,3,4\n", "no head with the names"),
        ("point,x [mm],y,z [mm]\n1,2,3,4\n", 'the column "y" lacks its unit'),
        ("point,x [mm],y [s],z [mm]\n1,2,3,4\n", '"s" of the column .* is not a unit like m'),
        ("point,x [mm],y [mm],height [mm]\n1,2,3,4\n", 'the column "height .mm." is unknown'),
        ("point,x [mm],y [mm],z [mm]\n1.5,2,3,4\n", "line 2: 1.5 is not a point number"),
        ("point,x [mm],y [mm],z [mm]\n", "no points under its heading"),
        ("point,x [mm],y [mm],z [mm]\n1,2,3\n", 'line 2: no value in the column "z"'),
        ("point,x [mm],y [mm],z [mm]\n1,2,3,four\n", 'line 2: "four" in the column "z" is not a number'),
        ("point,x [mm],y [mm],z [mm]\n1,2,3,4\n1,2,3,4\n", "appears twice"),
    ],
)
def test_tables_that_are_none(tmp_path, text, match):
    file = tmp_path / "points.csv"
    file.write_text(text)
    with pytest.raises(ReadError, match=match):
        read_points(file)
    with pytest.raises(ReadError, match="cannot be read"):
        read_points(tmp_path / "absent.csv")


@pytest.mark.parametrize(
    ("row", "match"),
    [
        ("1,nan,0,0", "not a finite number"),
        ("1,1,inf,0", "not a finite number"),
        ("1;0.5;0;0", "not a number"),
        ("1,0.5 0 0", '"0.5 0 0" in'),
    ],
)
def test_coordinates_that_cannot_be(tmp_path, row, match):
    path = tmp_path / "points.csv"
    path.write_text(f"point,x [mm],y [mm],z [mm]\n{row}\n")
    with pytest.raises(ReadError, match=match):
        read_points(path)


@pytest.mark.parametrize("mark", [";", "\t"])
def test_decimal_commas_of_points_are_refused(tmp_path, mark):
    path = tmp_path / "points.csv"
    path.write_text(
        mark.join(["point", "x [mm]", "y [mm]", "z [mm]"]) + "\n" + mark.join(["1", "0,5", "0", "0"]) + "\n"
    )
    with pytest.raises(ReadError, match="line 2.*decimal commas"):
        read_points(path)


def test_points_are_read_by_the_names_and_units_of_their_columns(tmp_path):
    path = tmp_path / "points.csv"
    path.write_text("z (um);Point;y [cm];x [m]\n5;3;2;0.1\n")
    assert read_points(path) == {3: pytest.approx((0.1, 0.02, 5e-6))}


SQUARE = np.array([[0.0, 0, 0], [0.01, 0, 0], [0.01, 0.01, 0], [0, 0.01, 0]])
HALVES = np.array([[0, 1, 2], [0, 2, 3]])


@given(st.floats(0.0, 0.01), st.floats(0.0, 0.01), st.floats(-2e-3, 2e-3))
def test_a_point_over_a_face_lies_on_it_at_its_foot(x, y, z):
    found = map_points({1: (x, y, z)}, SQUARE, triangles=HALVES, tolerance=3e-3)
    corners, weights = list(found.corners[1]), np.array(found.weights[1])
    assert weights.sum() == pytest.approx(1)
    # a node that is as near within 1e-9 of the triangle's size is taken, up to sqrt(2e-9 size z) beside the foot
    np.testing.assert_allclose(weights @ SQUARE[corners], [x, y, 0], atol=2e-7)
    assert found.distance[1] == pytest.approx(abs(z), abs=1e-9)


@pytest.mark.parametrize(
    ("point", "place"),
    [
        ((-0.001, 0.004, 0), (0, 0.004, 0)),
        ((0.012, 0.013, 0), (0.01, 0.01, 0)),
        ((0.004, -0.002, 0.001), (0.004, 0, 0)),
    ],
)
def test_a_point_beside_a_face_lies_on_its_nearest_edge_or_corner(point, place):
    found = map_points({1: point}, SQUARE, triangles=HALVES, tolerance=5e-3)
    np.testing.assert_allclose(np.array(found.weights[1]) @ SQUARE[list(found.corners[1])], place, atol=1e-12)
    assert found.distance[1] == pytest.approx(np.linalg.norm(np.subtract(point, place)))


def test_triangles_without_area_do_no_harm():
    found = map_points({1: (0.003, 0.001, 0)}, SQUARE, triangles=[[0, 1, 1], [0, 0, 0], [0, 1, 2]], tolerance=1e-3)
    assert found.distance[1] == pytest.approx(0, abs=1e-12)
