"""Every element against closed forms: shape functions, quadrature, patches, rigid motions, convergence, bending."""

from math import factorial

import numpy as np
import pytest

import faying
from faying.fe.elasticity import assemble, element_mass, element_stiffness, rigid_motions
from faying.fe.elements import KINDS, SOLIDS
from faying.fe.interface import join
from faying.fe.mesh import Mesh
from faying.fe.sides import all_sides, face_centre, nodes_of, skin
from faying.fe.solids import least_jacobian
from faying.joint.bolted import bond
from faying.numerics.modes import lowest_modes
from tests.helpers.boxes import SOLID_KINDS, block, row
from tests.helpers.loads import face_load

STEEL = faying.Material(name="steel", E=200e9, nu=0.3, density=7800.0)
SIZE = np.array([1.0, 0.8, 0.6])


def inside(kind, rng, count=20):
    """Points in the reference element."""
    p = rng.dirichlet(np.ones(KINDS[kind].dimension + 1), count)[:, 1:]
    if KINDS[kind].shape.name in ("quad", "hex"):
        return rng.uniform(-1, 1, p.shape)
    if KINDS[kind].shape.name == "wedge":
        return np.column_stack([rng.dirichlet(np.ones(3), count)[:, 1:], rng.uniform(-1, 1, count)])
    return p


@pytest.mark.parametrize("kind", KINDS)
def test_shape_functions_are_one_at_their_node_and_sum_to_one(kind):
    which = KINDS[kind]
    assert KINDS[kind].at(which.nodes.T)[0] == pytest.approx(np.eye(which.count), abs=1e-14)
    p = inside(kind, np.random.default_rng(1))
    values, gradients = KINDS[kind].at(p.T)
    assert values.sum(axis=1) == pytest.approx(np.ones(len(p)), abs=1e-14)
    assert values @ which.nodes == pytest.approx(p, abs=1e-14)
    step = 1e-6
    for axis in range(which.dimension):
        move = step * np.eye(which.dimension)[axis]
        slope = (KINDS[kind].at((p + move).T)[0] - KINDS[kind].at((p - move).T)[0]) / (2 * step)
        assert gradients[:, :, axis] == pytest.approx(slope, abs=1e-9)


def exact(shape, powers):
    """Integral of a monomial over the reference element, by the beta function and by parity."""
    line = [0.0 if n % 2 else 2.0 / (n + 1) for n in powers]
    if shape in ("quad", "hex"):
        return np.prod(line)
    flat = powers[:2] if shape == "wedge" else powers
    simplex = np.prod([factorial(n) for n in flat]) / factorial(sum(flat) + len(flat))
    return simplex * (line[2] if shape == "wedge" else 1.0)


@pytest.mark.parametrize(
    ("kind", "degree"),
    [
        (kind, degree)
        for kind in KINDS
        for degree in range(1, 6)
        if degree < 5 or KINDS[kind].shape.name in ("quad", "hex")
    ],
)
def test_quadrature_is_exact_up_to_its_degree(kind, degree):
    places, weights, _, _ = KINDS[kind].rule(degree)
    for powers in np.ndindex(*[degree + 1] * KINDS[kind].dimension):
        flat = powers[:2] if KINDS[kind].shape.name == "wedge" else powers
        if KINDS[kind].shape.name in ("quad", "hex") or sum(flat) <= degree:
            found = weights @ np.prod(places.T ** np.array(powers), axis=1)
            assert found == pytest.approx(exact(KINDS[kind].shape.name, powers), abs=1e-13)


@pytest.mark.parametrize("kind", SOLID_KINDS)
def test_sides_look_outwards_and_close(kind):
    points, cells = block(kind, (2, 2, 2), SIZE, move=(0.2, 1))
    for one in cells:
        closing, volume = np.zeros(3), 0.0
        for side in all_sides(one[None]):
            for face in side:
                centre, normal, area = face_centre(points, (face[None],))
                closing += area * normal if KINDS[kind].shape.name == "tet" else 0.0
                volume += area * normal @ centre / 3
                assert normal @ (centre - points[one].mean(axis=0)) > 0
        assert closing == pytest.approx(np.zeros(3), abs=1e-14)


def crooked(kind):
    points, cells = block(kind, (3, 3, 3), SIZE, move=(0.15, 3))
    return Mesh(points=points, parts={"p": cells}, faces={}, face_part={})


def mixed():
    """Bricks and wedges in one part, and tetrahedra in another."""
    points, cells = block("hex8", (4, 2, 1), SIZE)
    left = points[cells].mean(axis=1)[:, 0] < 0.5
    wedges = np.concatenate([cells[~left][:, c] for c in ([0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7])])
    other, tets = block("tet10", (1, 1, 1), (0.3, 0.8, 0.6), (-0.5, 0, 0))
    return Mesh(
        points=np.concatenate([points, other]),
        parts={"p": (cells[left], wedges), "q": tets + len(points)},
        faces={},
        face_part={},
    )


GRADIENT = np.array([[1.0, 0.3, -0.2], [0.1, -0.5, 0.4], [0.25, 0.6, 0.7]]) * 1e-4


def energy_density():
    strain = (GRADIENT + GRADIENT.T) / 2
    lam, mu = STEEL.E * 0.3 / (1.3 * 0.4), STEEL.G
    return lam / 2 * np.trace(strain) ** 2 + mu * np.sum(strain**2)


@pytest.mark.parametrize("kind", SOLID_KINDS)
def test_patch(kind):
    """A linear displacement gives the exact uniform stress: no force on inner nodes, and the exact energy."""
    mesh = crooked(kind)
    K, _ = assemble(mesh, {"p": STEEL})
    u = (mesh.points @ GRADIENT.T).ravel()
    force = (K @ u).reshape(-1, 3)
    inner = np.all((mesh.points > 1e-9) & (mesh.points < SIZE - 1e-9), axis=1)
    assert inner.any()
    assert np.abs(force[inner]).max() < 1e-9 * np.abs(force).max()
    assert u @ force.ravel() / 2 == pytest.approx(energy_density() * SIZE.prod(), rel=1e-11)


def test_patch_of_mixed_elements():
    mesh = mixed()
    K, M = assemble(mesh, dict.fromkeys(mesh.parts, STEEL))
    u = (mesh.points @ GRADIENT.T).ravel()
    assert u @ (K @ u) / 2 == pytest.approx(energy_density() * (0.48 + 0.3 * 0.48), rel=1e-11)
    ones = np.tile([1.0, 0, 0], len(mesh.points))
    assert ones @ (M @ ones) == pytest.approx(7800 * (0.48 + 0.3 * 0.48), rel=1e-12)
    inner = np.flatnonzero(np.abs(mesh.points - [0.5, 0.4, 0.0]).max(axis=1) < 1e-9)  # where bricks meet wedges
    force = (K @ u).reshape(-1, 3)
    assert len(inner) == 1
    strain = (GRADIENT + GRADIENT.T) / 2
    stress = STEEL.E * 0.3 / (1.3 * 0.4) * np.trace(strain) * np.eye(3) + 2 * STEEL.G * strain
    # only the traction on z = 0 is left; bricks give a quarter of each face to the node, wedges a third of each
    # triangle they put there
    share = 2 * 0.25 * 0.4 / 4 + sum(0.25 * 0.4 / 6 for cell in mesh.parts["p"][1] if inner[0] in cell)
    assert force[inner[0]] == pytest.approx(stress @ [0, 0, -share], rel=1e-9)


@pytest.mark.parametrize("kind", SOLID_KINDS)
def test_rigid_motions_and_nothing_else_cost_nothing(kind):
    points, cells = block(kind, (1, 1, 1), SIZE)
    one = cells[:1]
    used, numbers = np.unique(one, return_inverse=True)
    rng = np.random.default_rng(5)
    points = points[used] + 0.04 * rng.standard_normal((len(used), 3))
    mesh = Mesh(points=points, parts={"p": numbers.reshape(1, -1)}, faces={}, face_part={})
    K, _ = assemble(mesh, {"p": STEEL})
    assert np.abs(K @ rigid_motions(points)).max() < 1e-11 * np.abs(K).max()
    values = np.linalg.eigvalsh(K.toarray())
    assert np.all(np.abs(values[:6]) < 1e-12 * values[-1])
    assert values[6] > 1e-5 * values[-1]


@pytest.mark.parametrize("kind", SOLID_KINDS)
def test_mass_and_inertia(kind):
    points, cells = block(kind, (2, 2, 2), SIZE, move=(0.2, 4))
    mesh = Mesh(points=points, parts={"p": cells}, faces={}, face_part={})
    for rule in ("exact", "stiffness"):
        _, M = assemble(mesh, {"p": STEEL}, mass=rule)
        mass = STEEL.density * SIZE.prod()
        ones = np.tile([1.0, 0, 0], len(points))
        assert ones @ (M @ ones) == pytest.approx(mass, rel=1e-12)
    _, M = assemble(mesh, {"p": STEEL})
    x = points[:, 0] - 0.5
    along = np.column_stack([np.zeros_like(x), x, np.zeros_like(x)]).ravel()
    assert along @ (M @ along) == pytest.approx(mass * SIZE[0] ** 2 / 12, rel=1e-12)
    with pytest.raises(faying.InputError, match="mass = 'lumped' should be exact or stiffness"):
        assemble(mesh, {"p": STEEL}, mass="lumped")


@pytest.mark.parametrize("kind", SOLID_KINDS)
def test_order_of_convergence_of_a_frequency(kind):
    """Lowest axial frequency of a free bar with nu = 0: the error falls as h^2 (first order), h^4 (second order)."""
    bar = faying.Material(name="bar", E=200e9, nu=0.0, density=7800.0)
    found = []
    for n in (2, 4, 8):
        points, cells = block(kind, (n, 1, 1), (2.0, 0.05, 0.05))
        K, M = assemble(Mesh(points=points, parts={"p": cells}, faces={}, face_part={}), {"p": bar})
        modes = lowest_modes(K, M, min(20, len(points)), shift_frequency=50.0)
        axial = np.array([np.sum(s[0::3] ** 2) / np.sum(s**2) for s in modes.shapes.T])
        found.append(modes.frequencies[(axial > 0.97) & (modes.frequencies > 1.0)][0])
    errors = np.array(found) / (np.sqrt(bar.E / bar.density) / 4.0) - 1
    assert np.all(errors > -1e-9)
    order = 2 if KINDS[kind].count == KINDS[kind].corners else 4
    assert np.log2(errors[1] / errors[2]) == pytest.approx(order, abs=0.4)


def test_bricks_bend_and_plain_tetrahedra_lock():
    """A slender free beam, one element through its height: Euler-Bernoulli's first frequency, 22.3733 of the root."""
    height, length = 0.01, 0.3
    root = 22.3733 / length**2 * np.sqrt(STEEL.E * height**2 / 12 / STEEL.density) / (2 * np.pi)
    found = {}
    for kind in SOLID_KINDS:
        points, cells = block(kind, (20, 1, 1), (length, height, height))
        K, M = assemble(Mesh(points=points, parts={"p": cells}, faces={}, face_part={}), {"p": STEEL})
        found[kind] = lowest_modes(K, M, 8, shift_frequency=200.0).frequencies[6] / root
    for kind in ("hex8", "tet10", "wedge15", "hex20"):
        assert found[kind] == pytest.approx(1.0, abs=0.01)
    assert found["tet4"] > 1.3


@pytest.mark.parametrize("kind", SOLID_KINDS)
def test_springs_on_every_kind_of_face(kind):
    """The sum of springs is stiffness times area, also where the element faces are distorted."""
    mesh = row([1.0, 0.5], [2, 2], kinds=(kind, kind), sections=((2, 3), (2, 3)), width=0.4, height=0.3)
    joint = join(mesh, "p0.right", "p1.left")
    assert joint.area == pytest.approx(0.12, rel=1e-12)
    ones = np.ones(len(joint.weights))
    K = joint.springs(7.0 * ones, 3.0 * ones)
    move = np.zeros((len(mesh.points), 3))
    move[mesh.part_nodes("p1"), 0] = 1.0
    assert move.ravel() @ (K @ move.ravel()) == pytest.approx(7.0 * 0.12, rel=1e-10)
    slide = np.roll(move, 1, axis=1)
    assert slide.ravel() @ (K @ slide.ravel()) == pytest.approx(3.0 * 0.12, rel=1e-10)
    assert np.abs(joint.relative @ rigid_motions(mesh.points)).max() < 1e-13
    nodes = joint.at_nodes()
    assert np.all(nodes.weights > 0)
    assert nodes.area == pytest.approx(0.12, rel=1e-12)
    assert mesh.points[nodes.first_nodes[:, 0]] == pytest.approx(mesh.points[nodes.second_nodes[:, 0]])
    assert nodes.positions == pytest.approx(mesh.points[nodes.first_nodes[:, 0]], abs=1e-12)
    assert nodes.normals == pytest.approx(np.tile([1.0, 0, 0], (len(nodes.weights), 1)), abs=1e-12)
    assert bond(mesh, [("p0.right", "p1.left")]) is not None


@pytest.mark.parametrize("kinds", [("hex20", "tet10"), ("hex8", "tet4"), ("wedge15", "hex8")])
def test_springs_between_different_elements(kinds):
    mesh = row([1.0, 0.5], [2, 2], kinds=kinds, sections=((2, 3), (3, 2)), width=0.4, height=0.3)
    joint = join(mesh, "p0.right", "p1.left")
    ones = np.ones(len(joint.weights))
    move = np.zeros((len(mesh.points), 3))
    move[mesh.part_nodes("p1"), 0] = 1.0
    assert move.ravel() @ (joint.springs(7.0 * ones, ones) @ move.ravel()) == pytest.approx(7.0 * 0.12, rel=1e-10)
    assert np.abs(joint.relative @ rigid_motions(mesh.points)).max() < 1e-13


@pytest.mark.parametrize("kind", SOLID_KINDS)
def test_loads_on_every_kind_of_face(kind):
    mesh = row([1.0], [2], kinds=(kind,), sections=((2, 3),), width=0.4, height=0.3)
    centre, normal, area = face_centre(mesh.points, mesh.face("p0.right"))
    assert centre == pytest.approx([1.0, 0.2, 0.15])
    assert normal == pytest.approx([1, 0, 0])
    assert area == pytest.approx(0.12)
    point = centre + np.array([0.0, 0.03, -0.05])
    load = face_load(mesh.points, mesh.face("p0.right"), point, np.array([2.0, 0, 0])).reshape(-1, 3)
    assert load.sum(axis=0) == pytest.approx([1, 0, 0], abs=1e-13)
    assert np.cross(mesh.points - point, load).sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-13)


@pytest.mark.parametrize("kind", SOLID_KINDS)
def test_the_skin_is_the_outside(kind):
    points, cells = block(kind, (2, 3, 2), SIZE)
    outer = skin((cells,), len(points))
    _, _, area = face_centre(points, outer)
    assert area == pytest.approx(2 * (0.8 + 0.6 + 0.48), rel=1e-12)
    on_box = np.any((points < 1e-12) | (points > SIZE - 1e-12), axis=1)
    assert np.array_equal(nodes_of(outer), np.flatnonzero(on_box))


def test_every_solid_is_tested():
    assert {element.name for element in SOLIDS.values()} == set(SOLID_KINDS)


@pytest.mark.parametrize("kind", SOLID_KINDS)
def test_turned_elements_are_refused(kind):
    points, cells = block(kind, (1, 1, 1), SIZE)
    mirrored = points * [-1, 1, 1]
    assert np.all(least_jacobian(points, cells) > 0)
    with pytest.raises(faying.InputError, match=f"part 'p': {len(cells)} elements have no or negative volume"):
        Mesh(points=mirrored, parts={"p": cells}, faces={}, face_part={})


def test_faults_of_blocks():
    points, cells = block("hex8", (1, 1, 1), SIZE)
    with pytest.raises(faying.InputError, match="rows of 4, 6, 8, 10, 15, 20 nodes are known"):
        Mesh(points=points, parts={"p": cells[:, :5]}, faces={}, face_part={})
    with pytest.raises(faying.InputError, match=r"face 'f' has an array of shape \(1, 8, 1\)"):
        Mesh(points=points, parts={"p": cells}, faces={"f": cells[:, :, None]}, face_part={"f": "p"})
    with pytest.raises(faying.InputError, match="face 'f' has no elements"):
        Mesh(points=points, parts={"p": cells}, faces={"f": cells[:0, :4]}, face_part={"f": "p"})
    with pytest.raises(faying.InputError, match="8 nodes have 1 different numbers"):
        Mesh(points=points, parts={"p": cells}, faces={}, face_part={}, node_numbers=np.zeros(8, dtype=int))
    mesh = Mesh(points=points, parts={"p": cells}, faces={}, face_part={})
    assert mesh.numbers.tolist() == list(range(1, 9))
    with pytest.raises(faying.InputError, match="no part is called 'q'; the parts are 'p'"):
        mesh.part_nodes("q")


def test_the_mass_of_a_tetrahedron_by_both_rules():
    """Corner of a straight tet10: 1/70 of the mass exactly; by four points, where its function is +-1/10, 1/100."""
    points, cells = block("tet10", (1, 1, 1), SIZE)
    volume = SIZE.prod() / len(cells)
    exact = element_mass(points, cells, 7800.0)[:, 0, 0]
    coarse = element_mass(points, cells, 7800.0, "stiffness")[:, 0, 0]
    assert exact.mean() == pytest.approx(7800.0 * volume / 70, rel=1e-9)
    assert coarse.mean() == pytest.approx(7800.0 * volume / 100, rel=1e-6)


def test_a_brick_does_not_know_where_its_numbering_begins():
    """The incompatible modes are laid out by the middle of the element: any turn of its numbers gives the same."""
    points, cells = block("hex8", (1, 1, 1), SIZE)
    points = points + 0.05 * np.random.default_rng(3).standard_normal(points.shape)
    turn = [1, 2, 3, 0, 5, 6, 7, 4]
    first, turned = (element_stiffness(points, c, 200e9, 0.3)[0] for c in (cells, cells[:, turn]))
    assert turned == pytest.approx(first[turn][:, :, turn], rel=1e-9, abs=1e-9 * np.abs(first).max())
