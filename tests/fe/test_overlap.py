"""Faces whose meshes do not match: areas, moments and patches against closed forms, and against matched meshes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import faying
from faying.fe.elasticity import assemble, rigid_motions
from faying.fe.interface import join
from faying.fe.mesh import Mesh
from faying.fe.overlap import overlap
from faying.joint.joint import FittedJoint
from faying.joint.joint_law import JointLaw
from faying.joint.structure import Structure
from faying.numerics.modes import lowest_modes
from tests.helpers.boxes import SOLID_KINDS, block, row
from tests.helpers.loads import bolt_load
from tests.helpers.sides import sides_on

STEEL = faying.Material(name="steel", E=200e9, nu=0.3, density=7800.0)
SIMPLE = faying.Material(name="simple", E=200e9, nu=0.0, density=7800.0)
WIDTH, HEIGHT = 0.4, 0.3
PAIRS = [(a, a) for a in SOLID_KINDS] + [("hex20", "tet10"), ("hex8", "tet10"), ("tet4", "wedge15")]


def unmatched(kinds, gap=0.0):
    return row([1.0, 0.5], [2, 2], kinds=kinds, sections=((3, 2), (4, 5)), width=WIDTH, height=HEIGHT, gap=gap)


@pytest.mark.parametrize("kinds", PAIRS, ids="-".join)
def test_area_and_second_moment_of_the_springs(kinds):
    """Tilting one part by y stores k times the second moment of the face: width^3 height / 3."""
    mesh = unmatched(kinds)
    joint = join(mesh, "p0.right", "p1.left")
    assert joint.area == pytest.approx(WIDTH * HEIGHT, rel=1e-12)
    ones = np.ones(len(joint.weights))
    K = joint.springs(7.0 * ones, 3.0 * ones)
    move = np.zeros((len(mesh.points), 3))
    right = mesh.part_nodes("p1")
    move[right, 0] = mesh.points[right, 1]
    assert move.ravel() @ (K @ move.ravel()) == pytest.approx(7.0 * WIDTH**3 * HEIGHT / 3, rel=1e-10)
    assert np.abs(joint.relative @ rigid_motions(mesh.points)).max() < 1e-12


def law():
    steel = faying.CATALOGUE["45 steel"]
    return faying.JK(D=2.39, G=1.53e-10, pair=faying.ContactPair(steel, steel), scan_area=16e-6)


@pytest.mark.parametrize("kinds", PAIRS, ids="-".join)
def test_patch_uniform_pressure_passes(kinds):
    """Bars of nu = 0 pressed by uniform end loads: p = F/A at every point, whatever meets at the joint."""
    mesh = row([0.05, 0.05], [2, 2], kinds=kinds, sections=((3, 2), (4, 5)), width=0.02, height=0.02)
    interface = join(mesh, "p0.right", "p1.left")
    joint = FittedJoint(name="j", faces=("p0.right", "p1.left"), interface=interface, law=JointLaw(model=law()))
    structure = Structure(mesh=mesh, materials=dict.fromkeys(mesh.parts, SIMPLE), joints=(joint,))
    found = structure.assembly().solve(2000.0 * bolt_load(structure, "p1.right", "p0.left"))
    assert found.pressures[0] == pytest.approx(np.full_like(found.pressures[0], 2000.0 / 4e-4), rel=1e-8)
    assert -found.openings[0] == pytest.approx(joint.law.approach(2000.0 / 4e-4) + 0 * found.openings[0], rel=1e-8)


def test_frequencies_are_those_of_the_matched_mesh():
    """A joint of springs: what the change of mesh alone makes, matched or not, and what the unmatched joint adds."""

    def lowest(sections):
        mesh = row([0.1, 0.1], [6, 6], kinds=("hex20", "hex20"), sections=sections, width=0.02, height=0.02)
        K, M = assemble(mesh, dict.fromkeys(mesh.parts, STEEL))
        joint = join(mesh, "p0.right", "p1.left")
        ones = np.ones(len(joint.weights))
        return lowest_modes(K + joint.springs(3e12 * ones, 1e12 * ones), M, 10, shift_frequency=500.0).frequencies[6:]

    coarse, fine, mixed = lowest(((2, 2), (2, 2))), lowest(((3, 3), (3, 3))), lowest(((2, 2), (3, 3)))
    by_mesh = np.abs(coarse / fine - 1).max()
    assert by_mesh < 5e-3
    # the mixed mesh lies between the two matched ones
    assert np.all(mixed <= np.maximum(coarse, fine) * (1 + 0.1 * by_mesh))
    assert np.all(mixed >= np.minimum(coarse, fine) * (1 - 0.1 * by_mesh))


def test_faces_that_overlap_only_in_part():
    a, cells_a = block("hex8", (2, 3, 2), (1.0, WIDTH, HEIGHT))
    b, cells_b = block("tet10", (2, 2, 3), (0.5, WIDTH, HEIGHT), (1.0, 0.13, -0.07))
    points = np.concatenate([a, b])
    right = sides_on(np.flatnonzero(np.isclose(a[:, 0], 1.0)), (cells_a,), len(a))
    left = tuple(s + len(a) for s in sides_on(np.flatnonzero(np.isclose(b[:, 0], 1.0)), (cells_b,), len(b)))
    mesh = Mesh(
        points=points,
        parts={"a": cells_a, "b": cells_b + len(a)},
        faces={"a.r": right, "b.l": left},
        face_part={"a.r": "a", "b.l": "b"},
    )
    for names in (("a.r", "b.l"), ("b.l", "a.r")):
        joint = join(mesh, *names)
        assert joint.area == pytest.approx((WIDTH - 0.13) * (HEIGHT - 0.07), rel=1e-10)
        centre = joint.weights @ joint.positions / joint.area
        assert centre == pytest.approx([1.0, (0.13 + WIDTH) / 2, (HEIGHT - 0.07) / 2], abs=1e-10)


@given(
    angle=st.floats(0, 2 * np.pi),
    shift=st.tuples(st.floats(-0.6, 0.6), st.floats(-0.6, 0.6)),
    gap=st.floats(0, 0.1),
)
def test_two_squares_at_any_angle(angle, shift, gap):
    """Area of overlap against sampling: 160000 points on a grid of one square, inside the other or not."""
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    other = (square - 0.5) @ turn.T + [0.5 + shift[0], 0.5 + shift[1], gap]
    points = np.concatenate([square, other])
    found = overlap(points, (np.array([[0, 1, 2, 3]]),), (np.array([[4, 7, 6, 5]]),), search_distance=0.2, degree=2)
    grid = (np.arange(400) + 0.5) / 400
    x, y = np.meshgrid(grid, grid)
    local = (np.stack([x, y, 0 * x], -1) - [0.5 + shift[0], 0.5 + shift[1], 0]) @ turn
    sampled = np.mean(np.all(np.abs(local[..., :2]) <= 0.5, axis=-1))
    assert found.weights.sum() == pytest.approx(sampled, abs=6e-3)
    assert np.all(found.weights > 0)


def ring(inner, outer, counts, kind, angle=np.pi / 2, height=0.3):
    points, cells = block(kind, counts, (outer - inner, angle, height), (inner, 0.0, 0.0))
    r, phi, z = points.T
    return np.column_stack([r * np.cos(phi), r * np.sin(phi), z]), cells, r


@pytest.mark.parametrize(("kind", "tolerance"), [("hex20", 3e-4), ("tet10", 3e-4), ("hex8", 5e-3)])
def test_curved_faces_that_do_not_match(kind, tolerance):
    """A shaft in a quarter of a bush: area of the cylinder, and springs that resist a radial motion of one.

    The planes of the pieces, 3.75 degrees wide, miss the cylinder by strips of relative width (.065/2)^2/6 = 2e-4.
    """
    a, cells_a, r_a = ring(0.7, 1.0, (1, 12, 2), kind)
    b, cells_b, r_b = ring(1.0, 1.2, (1, 17, 3), kind)
    points = np.concatenate([a, b])
    shaft = sides_on(np.flatnonzero(np.isclose(r_a, 1.0)), (cells_a,), len(a))
    bush = tuple(s + len(a) for s in sides_on(np.flatnonzero(np.isclose(r_b, 1.0)), (cells_b,), len(b)))
    mesh = Mesh(
        points=points,
        parts={"a": cells_a, "b": cells_b + len(a)},
        faces={"s": shaft, "b": bush},
        face_part={"s": "a", "b": "b"},
    )
    joint = join(mesh, "s", "b")
    area = np.pi / 2 * 0.3
    assert joint.area == pytest.approx(area, rel=tolerance)
    assert np.linalg.norm(joint.positions[:, :2], axis=1) == pytest.approx(np.ones(len(joint.weights)), abs=4e-3)
    assert np.abs(joint.gap).max() < 5e-3
    move = np.zeros_like(points)
    outer = mesh.part_nodes("b")
    move[outer, :2] = points[outer, :2] / np.linalg.norm(points[outer, :2], axis=1)[:, None]
    ones = np.ones(len(joint.weights))
    assert move.ravel() @ (joint.springs(7.0 * ones, 0 * ones) @ move.ravel()) == pytest.approx(
        7 * area, rel=3 * tolerance
    )


def test_a_hole_on_one_side_only():
    """Element faces with a curved edge: the ring's flat end on a plate; the rim is followed between middle nodes."""
    a, cells_a, _ = ring(0.5, 1.0, (3, 12, 1), "hex20", angle=np.pi / 2, height=0.2)
    b, cells_b = block("hex20", (5, 4, 1), (1.2, 1.1, 0.2), (-0.1, -0.05, 0.2))
    top = sides_on(np.flatnonzero(np.isclose(a[:, 2], 0.2)), (cells_a,), len(a))
    plate = tuple(s + len(a) for s in sides_on(np.flatnonzero(np.isclose(b[:, 2], 0.2)), (cells_b,), len(b)))
    mesh = Mesh(
        points=np.concatenate([a, b]),
        parts={"a": cells_a, "b": cells_b + len(a)},
        faces={"t": top, "p": plate},
        face_part={"t": "a", "p": "b"},
    )
    exact = np.pi / 4 * (1.0 - 0.25)
    assert join(mesh, "t", "p").area == pytest.approx(exact, rel=1.5e-3)
    assert join(mesh, "p", "t").area == pytest.approx(exact, rel=1.5e-3)


def test_a_gap_between_faces_that_do_not_match():
    joint = join(unmatched(("hex8", "tet4"), gap=2e-3), "p0.right", "p1.left")
    assert joint.gap == pytest.approx(np.full(len(joint.weights), 2e-3))
    assert joint.area == pytest.approx(WIDTH * HEIGHT)


def test_matched_faces_keep_their_points():
    for kind, per_face in (("tet10", 6), ("hex20", 9), ("hex8", 4)):
        mesh = row([1.0, 0.5], [2, 2], kinds=(kind, kind), sections=((2, 3), (2, 3)), width=WIDTH, height=HEIGHT)
        assert len(join(mesh, "p0.right", "p1.left").weights) == per_face * len(mesh.face("p0.right")[0])


def test_only_faces_that_look_at_each_other_overlap():
    """A plate 1 mm thick in front of a face: its near side counts, its far side does not, though it is as near."""
    mesh = row([1.0, 1e-3], [1, 1], kinds=("hex8", "hex8"), sections=((2, 2), (3, 3)), width=WIDTH, height=HEIGHT)
    both = (*mesh.face("p1.left"), *mesh.face("p1.right"))
    found = overlap(mesh.points, mesh.face("p0.right"), both, search_distance=0.1, degree=2)
    assert found.weights.sum() == pytest.approx(WIDTH * HEIGHT, rel=1e-12)


def test_faces_are_found_as_far_as_asked():
    """A gap many elements wide: all within the search distance meet."""
    mesh = row(
        [1.0, 0.5], [1, 1], kinds=("hex8", "hex8"), sections=((20, 20), (15, 15)), width=0.04, height=0.03, gap=0.1
    )
    found = overlap(mesh.points, mesh.face("p0.right"), mesh.face("p1.left"), search_distance=0.11, degree=2)
    assert found.weights.sum() == pytest.approx(0.04 * 0.03, rel=1e-12)
