"""A factorisation in single precision and modes refined from it, against double precision."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse as sp

import faying
from faying.errors import NotConverged
from faying.fe.elasticity import assemble, rigid_motions
from faying.fe.interface import join
from faying.numerics.constraint import constrain
from faying.numerics.modal_reanalysis import EVERYWHERE, ModalReanalysis, refined_modes
from faying.numerics.modes import lowest_modes
from faying.numerics.shifted import Shifted
from faying.numerics.single import Single
from faying.numerics.solve import available, conjugate_gradients, factorise
from faying.numerics.span import extension
from tests.helpers.boxes import stack

STEEL = faying.CATALOGUE["45 steel"]
SHIFT = 100.0
S = (2 * np.pi * SHIFT) ** 2
needs_pardiso = pytest.mark.skipif("pardiso" not in available(), reason="only PARDISO factorises in single precision")


@pytest.fixture(scope="module")
def bars():
    """A slender free bar of two parts: mesh, matrices of the parts, joint."""
    mesh = stack([0.25, 0.25], [10, 10], width=0.02, height=0.015, sections=[(2, 2), (2, 2)])
    K, M = assemble(mesh, dict.fromkeys(mesh.parts, STEEL))
    return mesh, K, M, join(mesh, "p0.right", "p1.left")


def sprung(bars, k_n, k_t):
    _, K, M, joint = bars
    ones = np.ones(len(joint.weights))
    return (K + joint.springs(k_n * ones, k_t * ones)).tocsr(), M


@needs_pardiso
def test_rigid_motions_are_answered_exactly_and_the_rest_to_some_digits(bars):
    """Single precision alone would lose the rigid motions: their stiffness is 1e-9 of the others'."""
    K, M = sprung(bars, 1e13, 1e13)
    rigid = rigid_motions(bars[0].points)
    factor = Single(Shifted(stiffness=K, mass=M, shift=S), rigid)
    force = M @ rigid
    assert factor.solve(force) * S == pytest.approx(rigid, abs=1e-6 * np.abs(rigid).max())
    bend = M @ np.sin(np.arange(K.shape[0]))[:, None]
    exact = factorise((K + S * M).tocsr()).solve(bend)
    assert np.linalg.norm(factor.solve(bend) - exact) < 0.05 * np.linalg.norm(exact)


@needs_pardiso
def test_a_factor_takes_half_of_the_memory(bars):
    K, M = sprung(bars, 1e13, 1e13)
    A = (K + S * M).tocsr()
    half = Single(Shifted(stiffness=K, mass=M, shift=S), rigid_motions(bars[0].points)).memory
    assert half < 0.6 * factorise(A, "pardiso").memory


@needs_pardiso
def test_digits_that_are_not_there_are_noticed(bars):
    """Without its rigid motions and at a millionth of the shift, the matrix is singular in single precision."""
    K, M = sprung(bars, 1e13, 1e13)
    with pytest.raises(NotConverged):
        Single(Shifted(stiffness=K, mass=M, shift=1e-12 * S), np.zeros((K.shape[0], 0)))


@pytest.mark.parametrize("held", [False, True])
def test_refined_modes_are_those_of_double_precision(bars, held):
    K, M = sprung(bars, 1e13, 5e12)
    mesh, *_ = bars
    rigid = rigid_motions(mesh.points)
    if held:
        fixed = (3 * mesh.face_nodes("p0.left")[:, None] + np.arange(3)).ravel()
        K, M, rigid = constrain(K, fixed), constrain(M, fixed, 0.0), rigid[:, :0]
    wanted = lowest_modes(K, M, 20, shift_frequency=SHIFT)
    found = refined_modes(K, M, 20, rigid=rigid, shift_frequency=SHIFT)
    elastic = slice(rigid.shape[1], None)
    assert found.frequencies[elastic] == pytest.approx(wanted.frequencies[elastic], rel=1e-8)
    overlap = found.shapes[:, elastic].T @ (M @ wanted.shapes[:, elastic])
    # modes that are nearly as high as each other may turn among themselves
    assert np.linalg.norm(overlap, axis=0)[:12] == pytest.approx(np.ones(12), abs=1e-6)
    assert np.nanmax(found.error) <= 1e-8


@pytest.mark.parametrize("solver", available())
def test_every_solver_gives_refined_modes(bars, solver):
    K, M = sprung(bars, 1e13, 5e12)
    found = refined_modes(K, M, 10, rigid=rigid_motions(bars[0].points), shift_frequency=SHIFT, solver=solver)
    wanted = lowest_modes(K, M, 10, shift_frequency=SHIFT)
    assert found.frequencies[6:] == pytest.approx(wanted.frequencies[6:], rel=1e-8)


@needs_pardiso
@settings(max_examples=20, deadline=None)
@given(
    count=st.integers(1, 40),
    apart=st.sampled_from([0.0, 1e-6, 1e-3, 2e-2]),
    copies=st.integers(2, 24),
    spare=st.integers(0, 6),
    seed=st.integers(0, 9),
)
def test_no_mode_of_a_cluster_is_missed(count, apart, copies, spare, seed):
    """Chains of 40 masses between walls, almost alike: w^2 = 4 sin^2(i pi / 82) times what each has for itself."""
    length = 40
    one = sp.diags_array([np.full(length, 2.0), -np.ones(length - 1), -np.ones(length - 1)], offsets=[0, 1, -1])
    own = 1 + apart * np.random.default_rng(seed).uniform(size=copies)
    K, M = sp.block_diag([scale * one for scale in own]).tocsr(), sp.eye_array(copies * length).tocsr()
    alone = 4 * np.sin(np.arange(1, length + 1) * np.pi / (2 * length + 2)) ** 2
    wanted = np.sqrt(np.sort(np.outer(own, alone).ravel()))[:count] / (2 * np.pi)
    none = np.zeros((copies * length, 0))
    found = refined_modes(K, M, count + spare, rigid=none, shift_frequency=float(wanted[0]), spare=spare)
    assert found.frequencies[:count] == pytest.approx(wanted, rel=1e-8)


@settings(max_examples=8, deadline=None)
@given(factors=st.lists(st.floats(-1.5, 1.5), min_size=2, max_size=4))
def test_one_factorisation_gives_the_modes_under_one_spring_after_another(bars, factors):
    """Springs softer and stiffer by up to thirty: none of the modes below the last is missed."""
    K, M = sprung(bars, 1e12, 5e11)
    near = ModalReanalysis(lowest_modes(K, M, 18, shift_frequency=SHIFT), K, M, rigid=6, most=60)
    for factor in factors:
        changed, _ = sprung(bars, 1e12 * 10**factor, 5e11 * 10**factor)
        found = near.under(changed, 10, tolerance=1e-9)
        wanted = lowest_modes(changed, M, 16, shift_frequency=SHIFT)
        assert found.frequencies[6:] == pytest.approx(wanted.frequencies[6:], rel=1e-7)


@pytest.mark.parametrize("tolerance", [1e-5, 1e-8])
@pytest.mark.parametrize(("before", "after"), [(10.0, 0.5), (10.0, 0.1), (2.6, 0.2), (0.1, 10.0)])
def test_modes_of_every_symmetry_are_found(bars, before, after, tolerance):
    """A softer joint brings torsion and bending down from beyond the basis, which residuals of others do not show."""
    K, M = sprung(bars, 1e12 * before, 5e11 * before)
    near = ModalReanalysis(lowest_modes(K, M, 18, shift_frequency=SHIFT), K, M, rigid=6)
    changed, _ = sprung(bars, 1e12 * after, 5e11 * after)
    found = near.under(changed, 10, tolerance=tolerance)
    wanted = lowest_modes(changed, M, 16, shift_frequency=SHIFT)
    assert found.frequencies[6:] == pytest.approx(wanted.frequencies[6:], rel=tolerance)


def test_what_rounding_has_left_of_a_direction_is_orthonormal(bars):
    """Columns that differ by a millionth: the Gram matrix of the rest has lost half of its digits."""
    _, M = sprung(bars, 1e12, 5e11)
    rng = np.random.default_rng(5)
    first = rng.standard_normal((M.shape[0], 3))
    first = first @ np.linalg.inv(np.linalg.cholesky(first.T @ (M @ first))).T
    again = first @ rng.standard_normal((3, 4)) + 1e-6 * rng.standard_normal((M.shape[0], 4))
    new, momentum = extension(again, first, M @ first, M)
    both = np.concatenate([first, new], axis=1)
    assert new.shape[1] == 4
    assert both.T @ (M @ both) == pytest.approx(np.eye(7), abs=1e-9)
    assert momentum == pytest.approx(M @ new, rel=1e-9, abs=1e-12 * np.abs(momentum).max())


def test_what_asks_for_too_many_rounds_is_given_up_early(bars):
    K, M = sprung(bars, 1e9, 1e9)
    near = ModalReanalysis(lowest_modes(K, M, 18, shift_frequency=SHIFT), K, M, rigid=6)
    solves = []
    solve = near.modes.factorisation.solve
    near.modes.factorisation.solve = lambda right: solves.append(right.shape) or solve(right)
    with pytest.raises(NotConverged, match="changed springs"):
        near.under(sprung(bars, 1e17, 1e17)[0], 10, tolerance=1e-12, rounds=6)
    rounds = [shape for shape in solves if shape[1] != EVERYWHERE]  # without the look for modes of all kinds
    assert 0 < len(rounds) < 6


def test_conjugate_gradients_reach_their_accuracy_for_every_right_hand_side(bars):
    K, M = sprung(bars, 1e13, 5e12)
    A = (K + S * M).tocsr()
    factor = factorise((sprung(bars, 1e12, 1e12)[0] + S * M).tocsr())
    right = np.random.default_rng(3).standard_normal((K.shape[0], 3)) * [1.0, 1e6, 0.0]
    found = conjugate_gradients(lambda x: A @ x, factor, right, accuracy=1e-9)
    assert np.all(np.linalg.norm(A @ found - right, axis=0) <= 1e-8 * np.linalg.norm(right, axis=0))
    with pytest.raises(NotConverged, match="after 2 steps"):
        conjugate_gradients(lambda x: A @ x, factor, right, accuracy=1e-14, limit=2)


def test_a_right_hand_side_that_is_no_number_has_no_solution():
    """Not 0, from which the iteration begins."""
    one = sp.eye_array(3).tocsc()
    with pytest.raises(NotConverged, match="residual stays"):
        conjugate_gradients(lambda x: one @ x, factorise(one), np.full((3, 1), np.nan), accuracy=1e-8)


def test_conjugate_gradients_begin_with_the_best_of_like_solutions(bars):
    """With the solution among them nothing is left to do; with those of nearby springs little is."""
    K, M = sprung(bars, 1e13, 5e12)
    A = (K + S * M).tocsr()
    factor = factorise((sprung(bars, 1e12, 1e12)[0] + S * M).tocsr())
    right = np.random.default_rng(3).standard_normal((K.shape[0], 2))
    steps = []

    def solved(like):
        steps.append(0)

        def times(x):
            steps[-1] += 1
            return A @ x

        return conjugate_gradients(times, factor, right, accuracy=1e-8, like=like)

    wanted = solved(None)
    near = [factorise((sprung(bars, k, k / 2)[0] + S * M).tocsr()).solve(right) for k in (0.99e13, 1.01e13)]
    found = solved(np.concatenate(near, axis=1))
    assert found == pytest.approx(wanted, rel=1e-6, abs=1e-6 * np.abs(wanted).max())
    # twice the same, and one of no size: the combination is not unique, the solution is
    again = solved(np.concatenate([wanted, near[0], wanted, 0 * wanted], axis=1))
    assert again == pytest.approx(wanted, rel=1e-6, abs=1e-6 * np.abs(wanted).max())
    assert steps[2] == 1 < steps[1] < steps[0]
