"""Modes of a bar in two halves with springs between them, against closed forms."""

import sys

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve

import faying
from faying.fe.elasticity import assemble, rigid_motions
from faying.fe.interface import join
from faying.joint.bolted import bond
from faying.numerics.damped import damped_modes
from faying.numerics.modes import lowest_modes
from faying.numerics.solve import available, chosen, factorise
from tests.helpers.boxes import stack

BAR = faying.Material(name="bar", E=200e9, nu=0.0, density=7800.0)  # nu = 0: the bar of the textbook
HALF, SIDE = 0.5, 0.02
SHIFT = 20.0


@pytest.fixture(scope="module")
def bar():
    mesh = stack([HALF, HALF], [24, 24], width=SIDE, height=SIDE, sections=[(1, 1), (1, 1)])
    K, M = assemble(mesh, dict.fromkeys(mesh.parts, BAR))
    return mesh, K, M, join(mesh, "p0.right", "p1.left")


def sprung(bar, k_n, k_t):
    _, K, M, joint = bar
    ones = np.ones(len(joint.weights))
    return K + joint.springs(k_n * ones, k_t * ones), M


def kind(modes):
    """Share of the motion along x of each mode."""
    return np.array([np.sum(s[0::3] ** 2) / np.sum(s**2) for s in modes.shapes.T])


@pytest.mark.parametrize("stiffness", [1e10, 1e12, 1e14])
def test_axial_modes(bar, stiffness):
    """Halves that move against each other: beta tan(beta L) = 2 k/E, by hand from E u' = k (jump of u)."""
    K, M = sprung(bar, stiffness, 1e13)
    modes = lowest_modes(K, M, 40, shift_frequency=SHIFT)
    axial = modes.frequencies[(kind(modes) > 0.99) & (modes.frequencies > 1)]
    beta = brentq(lambda b: b * np.sin(b * HALF) - 2 * stiffness / BAR.E * np.cos(b * HALF), 1e-6, np.pi / 2 / HALF)
    exact = beta * np.sqrt(BAR.E / BAR.density) / (2 * np.pi)
    assert axial[0] == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize("stiffness", [1e11, 1e12, 1e13])
def test_bending_modes_with_a_joint_at_mid_length(bar, stiffness):
    """Euler-Bernoulli halves, free outside, joined by a rotational spring k I; the first mode is symmetric.

    Half beam, x from the free end: w = cosh bx + cos bx + c (sinh bx + sin bx); at the joint no shear, and the moment
    is the spring's: E I w'' = -2 k I w'.
    """
    K, M = sprung(bar, stiffness, 1e15)
    modes = lowest_modes(K, M, 16, shift_frequency=SHIFT)
    bending = modes.frequencies[(kind(modes) < 0.2) & (modes.frequencies > 1)]

    def residual(b):
        z = b * HALF
        c = -(np.sinh(z) + np.sin(z) * 1) / (np.cosh(z) - np.cos(z))  # w'''(L) = 0
        slope = b * (np.sinh(z) - np.sin(z) + c * (np.cosh(z) + np.cos(z)))
        curvature = b**2 * (np.cosh(z) - np.cos(z) + c * (np.sinh(z) - np.sin(z)))
        return BAR.E * curvature + 2 * stiffness * slope

    grid = np.linspace(0.2, 2.4 / HALF, 400)
    values = np.array([residual(b) for b in grid])
    first = np.flatnonzero(np.sign(values[:-1]) != np.sign(values[1:]))[0]
    beta = brentq(residual, grid[first], grid[first + 1])
    inertia = SIDE**4 / 12
    exact = beta**2 * np.sqrt(BAR.E * inertia / (BAR.density * SIDE**2)) / (2 * np.pi)
    assert bending[0] == pytest.approx(exact, rel=0.01)


def test_rigid_motions(bar):
    modes = lowest_modes(*sprung(bar, 1e12, 1e12), 10, shift_frequency=SHIFT)
    assert np.all(modes.frequencies[:6] < 1e-2)
    assert modes.frequencies[6] > 10


@pytest.mark.parametrize("apart", [False, True])
@pytest.mark.parametrize("count", [4, 12, 20])
def test_rigid_motions_that_are_given_change_no_mode(bar, apart, count):
    """One body of two halves, with six of them, and two that nothing joins, with twelve; some ask for fewer."""
    mesh, K, M, _ = bar
    motions = rigid_motions(mesh.points)
    if apart:
        motions = np.concatenate([np.where(mine[:, None], motions, 0.0) for mine in halves(mesh)], axis=1)
    else:
        K, M = sprung(bar, 1e12, 1e12)
    found = lowest_modes(K, M, count, shift_frequency=SHIFT, rigid=motions)
    wanted = lowest_modes(K, M, count, shift_frequency=SHIFT)
    assert found.frequencies == pytest.approx(wanted.frequencies, rel=1e-7, abs=1e-2)
    gram = found.shapes.T @ (M @ found.shapes)
    np.testing.assert_allclose(gram, np.eye(count), atol=1e-9)


def halves(mesh):
    """Which unknowns belong to each half."""
    first = np.repeat(np.isin(np.arange(len(mesh.points)), mesh.part_nodes("p0")), 3)
    return first, ~first


def test_stiffer_joints_never_lower_a_frequency_and_all_lie_between_free_and_tied(bar):
    mesh, K, M, _ = bar
    free = lowest_modes(K, M, 24, shift_frequency=SHIFT).frequencies
    grown = bond(mesh, [("p0.right", "p1.left")])
    tied = lowest_modes(
        (grown.T @ K @ grown).tocsr(), (grown.T @ M @ grown).tocsr(), 24, shift_frequency=SHIFT
    ).frequencies
    last = free
    for stiffness in (1e9, 1e11, 1e13, 1e15):
        now = lowest_modes(*sprung(bar, stiffness, 0.8 * stiffness), 24, shift_frequency=SHIFT).frequencies
        assert np.all(now[6:] >= last[6:] * (1 - 1e-9))
        last = now
    assert np.all(last[6:] <= tied[6:] * (1 + 1e-9))


@pytest.mark.parametrize("stiffness", [1e10, 1e12])
def test_loss_factor_against_the_complex_closed_form(bar, stiffness):
    """The axial equation with k (1 + i eta) has a complex root; its square is the complex eigenvalue."""
    eta = 0.25
    K, M = sprung(bar, stiffness, 1e13)
    _, _, _, joint = bar
    ones = np.ones(len(joint.weights))
    modes = lowest_modes(K, M, 40, shift_frequency=SHIFT)
    damped = damped_modes(modes, K, M, joint.springs(eta * stiffness * ones, 0 * ones), rigid=6)
    axial = np.flatnonzero(kind(modes)[6:] > 0.99)[0]

    def residual(x):
        b = x[0] + 1j * x[1]
        z = b * np.sin(b * HALF) - 2 * stiffness * (1 + 1j * eta) / BAR.E * np.cos(b * HALF)
        return [z.real, z.imag]

    real = brentq(lambda b: residual([b, 0.0])[0], 1e-6, np.pi / 2 / HALF)
    b = complex(*fsolve(residual, [real, 0.02 * real], xtol=1e-13))
    squared = b**2 * BAR.E / BAR.density
    assert damped.frequencies[axial] == pytest.approx(np.sqrt(squared.real) / (2 * np.pi), rel=1e-4)
    assert damped.loss_factors[axial] == pytest.approx(squared.imag / squared.real, rel=1e-3)


def test_no_loss_no_damping(bar):
    K, M = sprung(bar, 1e12, 1e12)
    modes = lowest_modes(K, M, 12, shift_frequency=SHIFT)
    damped = damped_modes(modes, K, M, 1e-30 * (K - bar[1]), rigid=6)
    assert np.abs(damped.loss_factors).max() < 1e-12
    assert damped.frequencies == pytest.approx(modes.frequencies[6:], rel=1e-9)


@pytest.mark.parametrize(("massive", "count"), [(40, 60), (20, 50)])
def test_unknowns_without_mass(massive, count):
    """Masses at some nodes only: the others follow, which condensing them out beforehand does as well."""
    from scipy.linalg import eigh
    from scipy.sparse import diags_array

    mesh = stack([0.3], [10], width=0.03, height=0.03, sections=[(1, 1)])
    K, _ = assemble(mesh, {"p0": BAR})
    chosen_nodes = np.random.default_rng(1).choice(len(mesh.points), massive, replace=False)
    heavy = (3 * chosen_nodes[:, None] + np.arange(3)).ravel()
    weight = np.zeros(mesh.unknowns)
    weight[heavy] = 0.1
    ground = 1e6 * diags_array(np.ones(mesh.unknowns))
    K = (K + ground).tocsr()
    found = lowest_modes(K, diags_array(weight).tocsr(), count, shift_frequency=SHIFT)
    light = np.setdiff1d(np.arange(mesh.unknowns), heavy)
    dense = K.toarray()
    small = dense[np.ix_(heavy, heavy)] - dense[np.ix_(heavy, light)] @ np.linalg.solve(
        dense[np.ix_(light, light)], dense[np.ix_(light, heavy)]
    )
    exact = np.sqrt(eigh(small / 0.1, eigvals_only=True)[:count]) / 2 / np.pi
    assert found.frequencies == pytest.approx(exact, rel=1e-6)


def test_more_modes_than_the_masses_allow():
    """Three masses that one motion moves together have one mode."""
    from scipy.sparse import csr_array

    mass = csr_array(np.ones((3, 3)))
    stiffness = csr_array(np.diag([1.0, 2.0, 3.0]))
    one = lowest_modes(stiffness, mass, 1, shift_frequency=0.01)
    assert one.frequencies == pytest.approx(np.sqrt(1 / (1 + 1 / 2 + 1 / 3)) / 2 / np.pi, rel=1e-9)
    with pytest.raises(faying.InputError, match="whose masses allow 1; ask for 1 to 1"):
        lowest_modes(stiffness, mass, 3, shift_frequency=0.01)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize(("size", "blocks"), [(2, 1), (5, 2), (60, 4), (300, 1)])
def test_the_rank_of_the_masses_does_not_hang_on_rounding(size, blocks, scale):
    """Each block of ones has rank 1, so that as many modes exist as there are blocks; rounding makes none."""
    from scipy.sparse import block_diag, csr_array

    mass = csr_array(block_diag([csr_array(scale * (i + 1) * np.ones((size, size))) for i in range(blocks)]))
    springs = np.random.default_rng(size).uniform(1, 100, size * blocks)
    flexibility = (1 / springs).reshape(blocks, size).sum(axis=1) * scale * (1 + np.arange(blocks))
    found = lowest_modes(csr_array(np.diag(springs)), mass, blocks, shift_frequency=0.01)
    assert found.frequencies == pytest.approx(np.sort(np.sqrt(1 / flexibility)) / (2 * np.pi), rel=1e-9)
    with pytest.raises(faying.InputError, match=f"whose masses allow {blocks};"):
        lowest_modes(csr_array(np.diag(springs)), mass, blocks + 1, shift_frequency=0.01)


@pytest.mark.parametrize("name", available())
def test_every_factorisation_solves(bar, name):
    _, K, M, _ = bar
    A = (K + (2 * np.pi * SHIFT) ** 2 * M).tocsr()
    right = np.random.default_rng(0).standard_normal((A.shape[0], 2))
    factor = factorise(A, name)
    x = factor.solve(right)
    assert np.linalg.norm(A @ x - right) < 1e-6 * np.linalg.norm(right)
    assert factor.solve(right[:, 0].copy()) == pytest.approx(x[:, 0], rel=1e-6, abs=1e-9 * np.abs(x).max())


@pytest.mark.skipif("pardiso" not in available(), reason="PARDISO is not installed")
@pytest.mark.parametrize("drop", [0, 1, 2])
def test_blocks_of_nodes_and_single_unknowns_give_the_same_factor(bar, drop):
    """Matrices of nodes go to PARDISO in blocks of three; a size that is not a multiple of three cannot."""
    K, M = sprung(bar, 1e12, 1e12)
    matrix = (K + (2 * np.pi * SHIFT) ** 2 * M).tocsr()
    matrix = matrix[drop:, drop:]
    right = np.random.default_rng(3).standard_normal((matrix.shape[0], 5))
    factor = factorise(matrix, "pardiso")
    assert factor._block == (1 if drop else 3)
    assert np.linalg.norm(matrix @ factor.solve(right) - right) < 1e-8 * np.linalg.norm(right)
    again = factor.again((7 * matrix).tocsr())
    assert np.linalg.norm(7 * (matrix @ again.solve(right)) - right) < 1e-8 * np.linalg.norm(right)


@pytest.mark.skipif("pardiso" not in available(), reason="PARDISO is not installed")
@pytest.mark.parametrize("size", [1, 2, 3, 300, 301])
def test_a_matrix_without_blocks(size):
    """Springs in a row, one unknown each: k (2, -1); the middle of blocks of three would be mostly zeros."""
    from scipy.sparse import diags_array

    matrix = diags_array([np.full(size, 2.0), -np.ones(size - 1), -np.ones(size - 1)], offsets=[0, 1, -1]).tocsr()
    right = np.arange(1.0, size + 1)
    factor = factorise(matrix, "pardiso")
    assert matrix @ factor.solve(right) == pytest.approx(right, rel=1e-10)


@pytest.mark.parametrize("name", available())
def test_no_factorisation_takes_a_matrix_that_is_not_positive_definite(name):
    from scipy.sparse import diags_array

    if name == "superlu":
        pytest.skip("LU factorises it: singular matrices alone are found")
    matrix = diags_array(
        [np.r_[np.full(59, 2.0), -1.0], np.full(59, 0.1), np.full(59, 0.1)], offsets=[0, 1, -1]
    ).tocsr()
    with pytest.raises(faying.NotConverged, match="is a part free to move"):
        factorise(matrix, name)


def test_an_unknown_factorisation_is_refused():
    with pytest.raises(faying.InputError, match=r"solver 'banana' is not here; use one of .*superlu"):
        chosen("banana")


def test_the_environment_chooses(monkeypatch):
    monkeypatch.setenv("FAYING_SOLVER", "superlu")
    assert chosen() == "superlu"


def test_a_broken_installation_is_left_out(tmp_path, monkeypatch):
    """A library that is there but cannot be loaded (built for another NumPy, say) is not a library."""
    (tmp_path / "pypardiso").mkdir()
    (tmp_path / "pypardiso" / "__init__.py").write_text("raise RuntimeError('built for another NumPy')")
    monkeypatch.syspath_prepend(tmp_path)
    for name in [name for name in sys.modules if name.split(".")[0] == "pypardiso"]:
        monkeypatch.delitem(sys.modules, name)
    assert "pardiso" not in available.__wrapped__()
    assert "superlu" in available.__wrapped__()


@pytest.mark.parametrize("turned", [False, True])
def test_ties_over_several_joints_do_not_depend_on_their_order(turned):
    """Three bars end to end, the middle one a single layer of elements whose corners lie in both joints."""
    mesh = stack([0.1, 0.1, 0.1], [2, 1, 2], width=0.02, height=0.02, sections=[(1, 1)] * 3)
    pairs = [("p0.right", "p1.left"), ("p2.left", "p1.right") if turned else ("p1.right", "p2.left")]
    merge = bond(mesh, pairs)
    whole = stack([0.3], [5], width=0.02, height=0.02, sections=[(1, 1)])
    assert merge.shape == (mesh.unknowns, whole.unknowns)


def test_a_node_of_two_joints_grows_together_with_both():
    """Three cubes in an L.

    The corner's edge lies in two joints, and the same nodes come out whatever is named first.
    """
    from faying.fe.mesh import Mesh
    from tests.helpers.boxes import block
    from tests.helpers.sides import sides_on

    points, parts, faces, owner, offset = [], {}, {}, {}, 0
    for name, origin in (("a", (0, 0, 1)), ("b", (0, 0, 0)), ("c", (1, 0, 0))):
        where, cells = block("hex8", (2, 2, 2), (1.0, 1.0, 1.0), origin)
        parts[name] = cells + offset
        for side, axis, place in (("bottom", 2, 0), ("top", 2, 1), ("left", 0, 0), ("right", 0, 1)):
            on = np.flatnonzero(np.abs(where[:, axis] - origin[axis] - place) < 1e-9)
            faces[f"{name}.{side}"] = tuple(f + offset for f in sides_on(on, (cells,), len(where)))
            owner[f"{name}.{side}"] = name
        points.append(where)
        offset += len(where)
    mesh = Mesh(points=np.concatenate(points), parts=parts, faces=faces, face_part=owner)
    sizes = {
        bond(mesh, [first, second]).shape[1]
        for first in (("a.bottom", "b.top"), ("b.top", "a.bottom"))
        for second in (("c.left", "b.right"), ("b.right", "c.left"))
    }
    assert sizes == {3 * len(np.unique(np.round(mesh.points, 6), axis=0))}


@pytest.mark.parametrize("strength", [10.0, 60.0])
def test_strong_dampers_against_the_whole_problem(strength):
    """Viscous joint.

    Loss factors up to a tenth and more: every mode is one of the full companion's, in rising order.
    """
    mesh = stack([0.1, 0.1], [4, 4], width=0.03, height=0.02, sections=[(1, 1), (1, 1)])
    parts, M = assemble(mesh, dict.fromkeys(mesh.parts, BAR))
    joint = join(mesh, "p0.right", "p1.left")
    ones = np.ones(len(joint.weights))
    K = (parts + joint.springs(1e12 * ones, 5e11 * ones)).tocsr()
    C = joint.springs(strength * 1e6 * ones, strength * 5e5 * ones)
    modes = lowest_modes(K, M, 26, shift_frequency=100.0)
    found = damped_modes(modes, K, M, C, rigid=6, count=14, kind="viscous", tolerance=1e-8)
    assert np.all(np.diff(found.frequencies) >= 0)
    assert found.loss_factors.max() > 0.02
    n = mesh.unknowns
    inverse = np.linalg.inv(M.toarray())
    companion = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ K.toarray(), -inverse @ C.toarray()]])
    roots = np.linalg.eigvals(companion)
    roots = roots[roots.imag > 100.0]
    for frequency, loss in zip(found.frequencies, found.loss_factors, strict=True):
        near = roots[
            np.argmin(
                np.abs(np.abs(roots) / 2 / np.pi - frequency) / frequency
                + np.abs(-2 * roots.real / np.abs(roots) - loss)
            )
        ]
        assert abs(near) / 2 / np.pi == pytest.approx(frequency, rel=1e-6)
        assert -2 * near.real / abs(near) == pytest.approx(loss, rel=1e-3, abs=1e-7)


def spectrum(values, size=60, seed=3):
    """Sparse K and M with given eigenvalues: springs in turned axes of masses that differ."""
    from scipy.sparse import csr_array

    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.standard_normal((size, size)))[0]
    root = np.sqrt(rng.uniform(0.5, 2.0, size))
    rest = np.linspace(2, 9, size - len(values)) * 1e9
    K = root[:, None] * (turn * np.r_[values, rest]) @ turn.T * root
    return csr_array((K + K.T) / 2), csr_array(np.diag(root**2))


@pytest.mark.parametrize("solver", [name for name in available() if name in ("pardiso", "superlu")])
def test_the_inertia_counts_the_modes_below(solver):
    from faying.numerics.solve import negative_eigenvalues

    K, M = spectrum(np.array([0.0, 0.0, 1e6, 4e6, 4e6, 9e6]))
    for below, count in ((-1.0, 0), (1.0, 2), (2e6, 3), (5e6, 5), (1e7, 6), (1e10, 60)):
        assert negative_eigenvalues((K - below * M).tocsr(), solver) == count


def test_a_missed_mode_is_counted():
    """Modes from which one is taken away stand for an iteration that has missed it."""
    from dataclasses import replace

    from faying.numerics.modes import missed_modes

    K, M = spectrum(np.array([0.0, 0.0, 1e6, 4e6, 4.1e6, 9e6]))
    found = lowest_modes(K, M, 6, shift_frequency=50.0)
    assert missed_modes(K, M, found) == 0
    keep = [0, 1, 2, 4, 5]
    assert missed_modes(K, M, replace(found, frequencies=found.frequencies[keep])) == 1


def test_an_unstable_structure_is_no_structure_with_modes():
    K, M = spectrum(np.array([-2e4, 1e6, 4e6]))
    with pytest.raises(
        faying.InputError, match=r"is unstable: 1 eigenvalues are negative, the lowest -\(22\.51 Hz\)\^2"
    ):
        lowest_modes(K, M, 3, shift_frequency=500.0)


@pytest.mark.parametrize("shift", [0.0, -1.0, np.nan, np.inf])
def test_a_shift_is_a_frequency_above_zero(shift):
    K, M = spectrum(np.array([1e6]))
    with pytest.raises(faying.InputError, match="give one above 0, near the first elastic mode"):
        lowest_modes(K, M, 1, shift_frequency=shift)


def test_a_shift_above_all_modes_is_refused():
    mesh = stack([0.1], [3], width=0.02, height=0.02)
    K, M = assemble(mesh, dict.fromkeys(mesh.parts, BAR))
    with pytest.raises(faying.InputError, match=r"a shift of 1e\+09 Hz is above all modes of these matrices"):
        lowest_modes(K, M, 9, shift_frequency=1e9)
