"""The error of a mesh in its modes, beside the modes of the mesh with those functions and of a finer one."""

import numpy as np
import pytest
from scipy.linalg import eigh

from faying.fe import surplus
from faying.fe.elasticity import assemble, rigid_motions
from faying.fe.elements import KINDS
from faying.fe.interface import join
from faying.fe.mesh import Mesh
from faying.fe.solids import least_jacobian
from faying.fe.surplus import Surplus, _higher
from faying.materials import CATALOGUE
from faying.numerics.modes import lowest_modes
from tests.helpers.boxes import block, row

STEEL = CATALOGUE["45 steel"]
SIZE = (0.12, 0.03, 0.01)


def plate(kind, counts):
    """Mesh, its materials, circular frequencies squared and shapes of its elastic modes, free."""
    points, cells = block(kind, counts, SIZE)
    mesh = Mesh(points=points, parts={"plate": cells}, faces={}, face_part={})
    materials = {"plate": STEEL}
    K, M = assemble(mesh, materials)
    found = lowest_modes(K, M, 12, shift_frequency=500.0, rigid=rigid_motions(points))
    return mesh, materials, (2 * np.pi * found.frequencies[6:]) ** 2, found.shapes[:, 6:]


def test_quadratic_functions_on_edges_are_what_linear_tetrahedra_lack():
    """With one function on each edge, the mesh is that of tetrahedra with ten nodes, which have the modes without."""
    mesh, materials, squares, shapes = plate("tet4", (16, 4, 2))
    estimate = Surplus.of(mesh, materials, np.zeros(len(mesh.points), dtype=bool)).error(shapes, squares)
    _, _, right, _ = plate("tet10", (16, 4, 2))
    # solved with the nodes at rest, they take up less than the modes of both together
    error = squares / right - 1
    assert np.all(estimate < error)
    assert estimate[0] > 0.25 * error[0]


@pytest.mark.parametrize("counts", [(6, 2, 1), (10, 3, 1)])
def test_the_estimate_holds_a_finer_mesh(counts):
    mesh, materials, squares, shapes = plate("tet10", counts)
    estimate = Surplus.of(mesh, materials, np.zeros(len(mesh.points), dtype=bool)).error(shapes, squares)
    _, _, right, _ = plate("tet10", (28, 7, 3))
    error = 1 - right / squares
    assert np.all(estimate > 0.5 * error)
    assert np.all(estimate < 1.5 * error)


def test_functions_and_those_of_the_element_are_all_cubic_polynomials():
    places = np.random.default_rng(3).dirichlet(np.ones(4), 40)[:, 1:]
    element = KINDS["tet10"]
    own, own_slopes = element.at(places.T)
    high, slopes = _higher(element, places)
    every = np.concatenate([own, high], axis=1)
    x, y, z = places.T
    cubic = x**3 - 2 * x * y * z + y**2 * z + 3 * x * y - z + 1
    factors, *_ = np.linalg.lstsq(every, cubic, rcond=None)
    assert every @ factors == pytest.approx(cubic, abs=1e-12)
    slope = np.einsum("qaj,a->qj", np.concatenate([own_slopes, slopes], axis=1), factors)
    expected = np.stack([3 * x**2 - 2 * y * z + 3 * y, -2 * x * z + 2 * y * z + 3 * x, -2 * x * y + y**2 - 1], axis=1)
    assert slope == pytest.approx(expected, abs=1e-11)


def test_the_energy_is_that_of_the_functions_alone():
    """Solved densely, without conjugate gradients; functions on loaded nodes stay 0."""
    mesh, materials, squares, shapes = plate("tet10", (4, 1, 1))
    loaded = mesh.points[:, 0] < 1e-9
    made = Surplus.of(mesh, materials, loaded)
    residual = made._residual(shapes, squares)
    inside = ~made.left_out
    assert 0 < np.count_nonzero(made.left_out) < len(inside) / 4
    K = made.stiffness.toarray()[np.ix_(inside, inside)]
    assert eigh(K, eigvals_only=True, subset_by_index=[0, 0])[0] > 0
    exact = np.einsum("im,im->m", residual[inside], np.linalg.solve(K, residual[inside])) / squares
    assert made.error(shapes, squares) == pytest.approx(exact, rel=0.1)


def test_an_element_that_nearly_folds_leaves_the_stiffness_positive():
    """The middle of one edge on the surface is moved inwards by a seventh of the edge."""
    mesh, materials, squares, shapes = plate("tet10", (4, 1, 1))
    points = mesh.points.copy()
    cells = mesh.blocks[0]
    cell = cells[np.argmax((points[cells[:, 4], 2] < 1e-9) & (points[cells[:, 2], 2] > 1e-9))]
    points[cell[4], 2] += 0.14 * np.linalg.norm(points[cell[1]] - points[cell[0]])
    bent = Mesh(points=points, parts=mesh.parts, faces={}, face_part={})  # refused where its stiffness folds
    assert least_jacobian(points, cells, of_mass=True).min() < 0
    made = Surplus.of(bent, materials, np.zeros(len(points), dtype=bool))
    assert eigh(made.stiffness.toarray(), eigvals_only=True, subset_by_index=[0, 0])[0] > 0
    assert np.all(np.isfinite(made.error(shapes, squares)))


def in_two(stiffness):
    """The estimate of a plate that a joint across it cuts in two, with springs per area [Pa/m], and its frequencies."""
    mesh = row((0.06, 0.06), (3, 3), kinds=("tet10", "tet10"), sections=((2, 1), (2, 1)), width=0.03, height=0.01)
    materials = dict.fromkeys(mesh.parts, STEEL)
    interface = join(mesh, "p0.right", "p1.left")
    k = np.full(len(interface.weights), stiffness)
    K, M = assemble(mesh, materials)
    rigid = rigid_motions(mesh.points)
    found = lowest_modes(K + interface.springs(k, k), M, 10, shift_frequency=500.0, rigid=rigid)
    squares, shapes = (2 * np.pi * found.frequencies[6:]) ** 2, found.shapes[:, 6:]
    made = Surplus.of(mesh, materials, np.zeros(len(mesh.points), dtype=bool))
    return made.error(shapes, squares, [(interface, k, k)]), squares


def test_a_stiff_joint_has_the_error_of_one_body(monkeypatch):
    """Functions on both faces then move together, as those inside a plate; as stiff as 10 um of the plate."""
    monkeypatch.setattr(surplus, "STEPS", 60)  # conjugate gradients need more of them for so stiff a joint
    estimate, squares = in_two(STEEL.E / 1e-5)
    mesh, materials, right, shapes = plate("tet10", (6, 2, 1))
    alone = Surplus.of(mesh, materials, np.zeros(len(mesh.points), dtype=bool)).error(shapes, right)
    assert squares == pytest.approx(right[: len(squares)], rel=1e-3)
    assert estimate == pytest.approx(alone[: len(estimate)], rel=5e-3)


def test_the_error_at_a_joint_holds_a_finer_mesh():
    """The plate in two, with a joint as stiff as a third of one half, beside ever smaller elements of both."""
    k = STEEL.E / 0.02
    estimate, squares = in_two(k)
    fine = row((0.06, 0.06), (14, 14), kinds=("tet10", "tet10"), sections=((7, 3), (7, 3)), width=0.03, height=0.01)
    interface = join(fine, "p0.right", "p1.left")
    K, M = assemble(fine, dict.fromkeys(fine.parts, STEEL))
    both = np.full(len(interface.weights), k)
    rigid = rigid_motions(fine.points)
    found = lowest_modes(K + interface.springs(both, both), M, 10, shift_frequency=500.0, rigid=rigid)
    error = 1 - (2 * np.pi * found.frequencies[6:]) ** 2 / squares
    assert np.all(estimate > 0.5 * error)
    assert np.all(estimate < 1.5 * error)


def test_other_elements_have_no_estimate():
    mesh, materials, _, _ = plate("hex20", (2, 1, 1))
    assert Surplus.of(mesh, materials, np.zeros(len(mesh.points), dtype=bool)) is None
