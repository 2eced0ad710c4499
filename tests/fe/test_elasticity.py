import numpy as np
import pytest

import faying
from faying.fe.elasticity import assemble, rigid_motions
from faying.fe.mesh import Mesh
from faying.numerics.modes import lowest_modes
from tests.helpers.boxes import block, stack

STEEL = faying.Material(name="steel", E=200e9, nu=0.3, density=7800.0)


def crooked():
    """A box whose inner nodes are moved, edges straight, so that no symmetry of the mesh can help."""
    points, cells = block("tet10", (3, 3, 3), (1.0, 0.8, 0.6))
    rng = np.random.default_rng(3)
    size = points.max(axis=0)
    inside = np.all((points > 1e-9) & (points < size - 1e-9), axis=1)
    corners = np.unique(cells[:, :4])
    move = np.zeros_like(points)
    move[corners] = 0.02 * rng.standard_normal((len(corners), 3)) * inside[corners, None]
    points = points + move
    for k, (a, b) in enumerate(((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))):
        points[cells[:, 4 + k]] = (points[cells[:, a]] + points[cells[:, b]]) / 2
    return Mesh(points=points, parts={"p": cells}, faces={}, face_part={})


def test_patch():
    """A linear displacement gives the exact uniform stress: no force on inner nodes, and the exact energy."""
    mesh = crooked()
    K, _ = assemble(mesh, {"p": STEEL})
    gradient = np.array([[1.0, 0.3, -0.2], [0.1, -0.5, 0.4], [0.25, 0.6, 0.7]]) * 1e-4
    u = (mesh.points @ gradient.T).ravel()
    force = (K @ u).reshape(-1, 3)
    size = np.array([1.0, 0.8, 0.6])
    inside = np.all((mesh.points > 1e-9) & (mesh.points < size - 1e-9), axis=1)
    assert np.abs(force[inside]).max() < 1e-9 * np.abs(force).max()
    strain = (gradient + gradient.T) / 2
    lam, mu = STEEL.E * 0.3 / (1.3 * 0.4), STEEL.G
    density = lam / 2 * np.trace(strain) ** 2 + mu * np.sum(strain**2)
    assert u @ force.ravel() / 2 == pytest.approx(density * size.prod(), rel=1e-11)


def test_rigid_motions_cost_nothing():
    mesh = crooked()
    K, _ = assemble(mesh, {"p": STEEL})
    modes = rigid_motions(mesh.points)
    assert np.abs(K @ modes).max() < 1e-11 * np.abs(K).max()


def test_mass_and_inertia_of_a_box():
    mesh = stack([2.0], [3])
    _, M = assemble(mesh, {"p0": STEEL})
    modes = rigid_motions(mesh.points)
    inertia = np.diag(modes.T @ (M @ modes))
    mass = STEEL.density * 2.0
    about_x = mass * (1 + 1) / 12 / 6.0  # rotations are scaled by the diagonal of the box, squared: 6 m2
    assert inertia[:3] == pytest.approx([mass] * 3, rel=1e-12)
    assert inertia[3] == pytest.approx(about_x, rel=1e-12)


def test_second_order_elements_converge_at_fourth_order_in_frequency():
    """Lowest elastic frequency of a free bar: the error of P2 elements falls as h^4 (energy norm h^2)."""
    bar = faying.Material(name="bar", E=200e9, nu=0.0, density=7800.0)
    found = []
    for n in (2, 4, 8):
        mesh = stack([2.0], [n], sections=[(1, 1)], width=0.05, height=0.05)
        K, M = assemble(mesh, {"p0": bar})
        modes = lowest_modes(K, M, 20, shift_frequency=50.0)
        axial = np.array([np.sum(modes.shapes[0::3, i] ** 2) / np.sum(modes.shapes[:, i] ** 2) for i in range(20)])
        elastic = modes.frequencies > 1.0
        found.append(modes.frequencies[(axial > 0.99) & elastic][0])
    exact = np.sqrt(bar.E / bar.density) / (2 * 2.0)
    errors = np.array(found) / exact - 1
    assert np.all(errors > -1e-9)
    rates = np.log2(errors[:-1] / errors[1:])
    assert rates[-1] == pytest.approx(4, abs=0.4)


def test_faults_of_a_mesh():
    points, cells = block("tet10", (1, 1, 1), (1.0, 1.0, 1.0))
    with pytest.raises(faying.InputError, match="no or negative volume"):
        Mesh(points=points, parts={"p": cells[:, [1, 0, 2, 3, 4, 6, 5, 8, 7, 9]]}, faces={}, face_part={})
    with pytest.raises(faying.InputError, match="belong to no element"):
        Mesh(points=np.concatenate([points, [[5.0, 5, 5]]]), parts={"p": cells}, faces={}, face_part={})
    with pytest.raises(faying.InputError, match="shares nodes"):
        Mesh(points=points, parts={"p": cells, "q": cells}, faces={}, face_part={})
    with pytest.raises(faying.InputError, match="NaN"):
        Mesh(points=points * np.nan, parts={"p": cells}, faces={}, face_part={})
    with pytest.raises(faying.InputError, match="no parts"):
        Mesh(points=points, parts={}, faces={}, face_part={})
    with pytest.raises(faying.InputError, match="no face is called 'top'; the faces are 'p0.left', 'p0.right'"):
        stack([1.0], [1]).face("top")
