"""Stress at nodes: even fields exactly, the thick plate of NAFEMS, a hole in a plate, bending."""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

import faying
from faying.fe.elasticity import assemble
from faying.fe.mesh import Mesh
from faying.fe.nodal_forces import pressure_forces
from faying.fe.stress import PartStress, at_outline, part_stresses, von_mises
from faying.numerics.constraint import constrain
from tests.helpers.boxes import SOLID_KINDS, block
from tests.helpers.sides import sides_on

STEEL = faying.Material(name="steel", E=210e9, nu=0.3, density=7800.0)


@pytest.mark.parametrize("kind", SOLID_KINDS)
def test_an_even_strain_has_its_stress_at_every_node(kind):
    points, cells = block(kind, (2, 2, 2), (1.0, 0.7, 0.5), move=(0.15, 3))
    slope = 1e-4 * np.array([[1.0, 0.3, -0.2], [0.5, -0.4, 0.1], [0.2, 0.7, 0.6]])
    mesh = Mesh(points=points, parts={"p": (cells,)}, faces={}, face_part={})
    found = part_stresses(mesh, {"p": STEEL}, (points @ slope.T).ravel()[:, None], {"p": 2e-5})["p"]
    strain = (slope + slope.T) / 2 - 2e-5 * np.eye(3)
    mu = 210e9 / 2.6
    lam = 2 * mu * 0.3 / 0.4
    exact = lam * np.trace(strain) * np.eye(3) + 2 * mu * strain
    rows = np.array([exact[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))])
    assert found.stress[:, :, 0] == pytest.approx(np.tile(rows, (len(points), 1)), rel=1e-9, abs=1e-9 * rows.max())
    assert found.spread.max() < 1e-6 * np.abs(rows).max()
    deviator = exact - np.trace(exact) / 3 * np.eye(3)
    assert found.von_mises[:, 0] == pytest.approx(np.sqrt(1.5 * np.sum(deviator**2)), rel=1e-9)
    # the roots of the characteristic polynomial, from the invariants
    p = np.trace(exact), (np.trace(exact) ** 2 - np.trace(exact @ exact)) / 2, np.linalg.det(exact)
    roots = np.sort(np.roots([1.0, -p[0], p[1], -p[2]]).real)
    for values, root in zip(found.principal, roots[[2, 0]], strict=True):
        assert values[:, 0] == pytest.approx(root, rel=1e-6)


def test_parts_that_share_a_node_show_the_greater_stress_there():
    def part(stress):
        return PartStress(
            nodes=np.array([0, 1]), stress=np.array(stress)[None, :, None].repeat(2, 0), spread=np.zeros((2, 1))
        )

    pulled, pressed = part([5.0, 0, 0, 0, 0, 0]), part([-7.0, 0, 0, 0, 0, 0])
    found = at_outline({"a": pulled, "b": pressed}, 3, np.array([1, 2]))
    assert {name: values.tolist() for name, values in found.items()} == {
        "von_mises": [[7.0, 0.0]],
        "tension": [[5.0, 0.0]],
        "compression": [[-7.0, 0.0]],
    }


def solved(mesh, held, force):
    """Displacement of a mesh whose unknowns `held` are fixed."""
    K, _ = assemble(mesh, {"p": STEEL})
    force = np.array(force)
    force[held] = 0.0
    return spsolve(constrain(K, held).tocsc(), force)


def quarter(counts, inner, outer, height):
    """A quarter of a ring of hexahedra between two ellipses with half axes along x and y."""
    points, cells = block("hex20", counts, (1.0, 1.0, 1.0))
    r, turn = points[:, 0], np.pi / 2 * points[:, 1]
    axes = np.array(inner) + (np.array(outer) - np.array(inner)) * (r**1.5)[:, None]
    where = np.stack([axes[:, 0] * np.cos(turn), axes[:, 1] * np.sin(turn), height * points[:, 2]], axis=1)
    on = {"top": points[:, 2] > 1 - 1e-9, "outer": r > 1 - 1e-9}
    faces = {name: sides_on(np.flatnonzero(some), (cells,), len(points)) for name, some in on.items()}
    return Mesh(points=where, parts={"p": (cells,)}, faces=faces, face_part=dict.fromkeys(faces, "p")), points


@pytest.mark.slow
def test_the_thick_plate_of_nafems_has_its_stress():
    """LE10 (NAFEMS 1990, The Standard NAFEMS Benchmarks): sigma_yy at D on top is -5.38 MPa under 1 MPa.

    D is a corner, where the stress converges with the size of the elements: two meshes are extrapolated to none.
    """
    values = []
    for counts in ((6, 8, 8), (10, 12, 8)):
        mesh, local = quarter(counts, (2.0, 1.0), (3.25, 2.75), 0.6)
        r, turn, z = local.T
        node = np.arange(len(local))
        held = [3 * node[turn < 1e-9] + 1, 3 * node[turn > 1 - 1e-9]]
        held += [3 * node[r > 1 - 1e-9], 3 * node[r > 1 - 1e-9] + 1]
        held += [3 * node[(r > 1 - 1e-9) & (np.abs(z - 0.5) < 1e-9)] + 2]
        moved = solved(mesh, np.unique(np.concatenate(held)), 1e6 * pressure_forces(mesh, "top"))
        found = part_stresses(mesh, {"p": STEEL}, moved[:, None])["p"]
        d = int(np.argmin(np.linalg.norm(mesh.points[found.nodes] - [2.0, 0.0, 0.6], axis=1)))
        values.append(found.stress[d, 1, 0])
    coarse, fine = values
    assert fine == pytest.approx(-5.38e6, rel=0.06)
    assert fine + (fine - coarse) * 6 / (10 - 6) == pytest.approx(-5.38e6, rel=0.025)


def test_a_hole_raises_the_stress_threefold_and_a_finer_mesh_comes_nearer():
    """Kirsch 1898: tension S far away makes 3 S at the hole. His tractions act on the outer ring, at five radii."""
    errors = []
    for counts in ((8, 8, 1), (16, 16, 1)):
        mesh, local = quarter(counts, (1.0, 1.0), (5.0, 5.0), 0.4)
        r, turn, _ = local.T
        node = np.arange(len(local))
        held = np.unique(np.concatenate([3 * node[turn < 1e-9] + 1, 3 * node[turn > 1 - 1e-9], 3 * node + 2]))
        nu = 0.3
        x, y = mesh.points[:, :2].T
        radius, angle = np.hypot(x, y), np.arctan2(y, x)
        # plane strain: radial and tangential motion of the infinite plate under S = 1 along x
        E, k = 210e9 / (1 - nu**2), nu / (1 - nu)
        u_r = (
            radius
            / (2 * E)
            * ((1 - k) + (1 + k) / radius**2 + np.cos(2 * angle) * ((1 + k) + 4 / radius**2 - (1 + k) / radius**4))
        )
        u_t = -radius / (2 * E) * np.sin(2 * angle) * ((1 + k) + 2 * (1 - k) / radius**2 + (1 + k) / radius**4)
        motion = np.zeros((len(node), 3))
        motion[:, 0] = u_r * np.cos(angle) - u_t * np.sin(angle)
        motion[:, 1] = u_r * np.sin(angle) + u_t * np.cos(angle)
        outer = r > 1 - 1e-9
        given = np.where(outer[:, None], motion, 0.0).ravel()
        held = np.unique(np.concatenate([held, 3 * node[outer], 3 * node[outer] + 1]))
        K, _ = assemble(mesh, {"p": STEEL})
        moved = solved(mesh, held, -(K @ given)) + given
        found = part_stresses(mesh, {"p": STEEL}, moved[:, None])["p"]
        top = int(np.argmin(np.linalg.norm(mesh.points[found.nodes] - [0.0, 1.0, 0.2], axis=1)))
        errors.append(abs(found.stress[top, 0, 0] / 3 - 1))
        if counts[0] == 16:
            assert found.spread[top, 0] / found.von_mises[top, 0] < 0.1
    assert errors[1] < 0.025  # the value at the edge is extrapolated
    assert errors[1] < 0.6 * errors[0]


def test_the_square_of_von_mises_is_that_of_one_axis():
    assert von_mises(np.array([[[7.0], [0], [0], [0], [0], [0]]]))[0, 0] == pytest.approx(7.0)
    assert von_mises(np.array([[[0.0], [0], [0], [2], [0], [0]]]))[0, 0] == pytest.approx(2 * np.sqrt(3))
