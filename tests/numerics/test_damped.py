"""Complex modes against the full quadratic and the full complex problem, small and large."""

import numpy as np
import pytest
from scipy.linalg import eig

import faying
from faying.fe.elasticity import assemble, rigid_motions
from faying.fe.interface import join
from faying.numerics.constraint import constrain, free_motions
from faying.numerics.damped import damped_modes, lowest_complex
from faying.numerics.modes import lowest_modes
from tests.helpers.boxes import stack

STEEL = faying.CATALOGUE["45 steel"]


def jointed(counts, sections, k=2e12, eta=0.3, c=None, offset=0.35):
    """Two bars with a lossy joint off the middle: K, M, loss. Loss: eta k, or dampers of c [Pa s/m]."""
    mesh = stack([offset, 0.8 - offset], counts, width=0.03, height=0.02, sections=[sections, sections])
    K, M = assemble(mesh, dict.fromkeys(mesh.parts, STEEL))
    joint = join(mesh, "p0.right", "p1.left")
    ones = np.ones(len(joint.weights))
    loss = joint.springs(eta * k * ones, 0.6 * eta * k * ones) if c is None else joint.springs(c * ones, 0.5 * c * ones)
    return K + joint.springs(k * ones, 0.8 * k * ones), M, loss


def hysteretic_exactly(K, M, loss, count):
    """All complex eigenvalues w^2 (1 + i eta) of the dense problem, elastic ones in rising order."""
    values = eig((K + 1j * loss).toarray(), M.toarray(), right=False)
    values = values[values.real > 1e3]
    return values[np.argsort(values.real)][:count]


def viscous_exactly(K, M, C, count):
    """Roots of the 2n companion with positive imaginary part, elastic ones, by rising size."""
    n = K.shape[0]
    root = np.linalg.cholesky(M.toarray())
    inverse = np.linalg.inv(root)
    stiff, damp = inverse @ K.toarray() @ inverse.T, inverse @ C.toarray() @ inverse.T
    values = np.linalg.eigvals(np.block([[np.zeros((n, n)), np.eye(n)], [-stiff, -damp]]))
    values = values[values.imag > 100]
    return values[np.argsort(np.abs(values))][:count]


@pytest.mark.parametrize("eta", [0.02, 0.3])
def test_hysteretic_loss_against_the_full_problem(eta):
    K, M, loss = jointed([3, 4], (1, 1), eta=eta)
    exact = hysteretic_exactly(K, M, loss, 8)
    found = damped_modes(lowest_modes(K, M, 16, shift_frequency=50.0), K, M, loss, rigid=6, count=8)
    assert found.frequencies == pytest.approx(np.sqrt(exact.real) / (2 * np.pi), rel=1e-5)
    assert found.loss_factors == pytest.approx(exact.imag / exact.real, rel=0.01, abs=1e-8)
    assert found.damping_ratios == pytest.approx(found.loss_factors / 2)


@pytest.mark.parametrize("c", [1e7, 2e8])
def test_viscous_dampers_against_the_companion(c):
    K, M, C = jointed([2, 3], (1, 1), c=c)
    exact = viscous_exactly(K, M, C, 6)
    found = damped_modes(lowest_modes(K, M, 14, shift_frequency=50.0), K, M, C, rigid=6, count=6, kind="viscous")
    assert found.frequencies == pytest.approx(np.abs(exact) / (2 * np.pi), rel=1e-5)
    assert found.loss_factors == pytest.approx(-2 * exact.real / np.abs(exact), rel=0.01, abs=1e-8)


def test_the_error_estimate_is_honest():
    """With a loose tolerance: the true error of every eigenvalue lies below a few times the estimate."""
    K, M, loss = jointed([3, 4], (1, 1), eta=0.5)
    modes = lowest_modes(K, M, 14, shift_frequency=50.0)
    exact = hysteretic_exactly(K, M, loss, 8)
    for tolerance in (1e-1, 1e-3, 1e-5):
        found = damped_modes(modes, K, M, loss, rigid=6, count=8, tolerance=tolerance)
        squared = (2 * np.pi * found.frequencies) ** 2 * (1 + 1j * found.loss_factors)
        true = np.abs(squared - exact) / np.abs(exact)
        assert found.error.max() < tolerance
        assert np.all(true <= 2 * found.error + 1e-9)


def test_shapes_solve_the_full_equations():
    K, M, loss = jointed([3, 4], (1, 1))
    found = damped_modes(lowest_modes(K, M, 16, shift_frequency=50.0), K, M, loss, rigid=6, count=8)
    squared = (2 * np.pi * found.frequencies) ** 2 * (1 + 1j * found.loss_factors)
    for j in range(8):
        u = found.shapes[:, j]
        miss = K @ u + 1j * (loss @ u) - squared[j] * (M @ u)
        assert np.linalg.norm(miss) < 1e-2 * np.linalg.norm(K @ u)
        assert u @ (M @ u) == pytest.approx(1.0, rel=1e-6)


def test_a_loss_that_is_too_great_is_told():
    K, M, C = jointed([2, 3], (1, 1), c=1e7)
    with pytest.raises(faying.NotConverged, match="the estimated error stays at"):
        damped_modes(
            lowest_modes(K, M, 10, shift_frequency=50.0), K, M, C, rigid=6, count=4, kind="viscous", tolerance=1e-30
        )


def test_held_unknowns_stay_at_rest_and_the_rest_is_as_without_them():
    """constrain() leaves the eigenvalues of the free block.

    free_motions() leaves those rigid motions that leave them at rest.
    """
    K, _, loss = jointed([2, 2], (1, 1))
    held = np.arange(30)
    free = np.setdiff1d(np.arange(K.shape[0]), held)
    block = np.linalg.eigvalsh(constrain(K, held).toarray())
    alone = np.linalg.eigvalsh(K.tocsr()[free][:, free].toarray())
    assert np.isin(np.round(alone / alone[-1], 9), np.round(block / alone[-1], 9)).all()
    assert (
        constrain(loss, held, 0.0).tocsr()[held].nnz == 0
        or np.abs(constrain(loss, held, 0.0).tocsr()[held].data).max() == 0
    )
    rigid = rigid_motions(np.random.default_rng(0).uniform(0, 1, (20, 3)))
    one_node = free_motions(rigid, np.array([0, 1, 2]))
    assert one_node.shape[1] == 3  # turns about that node
    assert np.abs(one_node[:3]).max() < 1e-12
    assert free_motions(rigid, np.zeros(0, dtype=np.int64)) is rigid
    assert free_motions(rigid, np.arange(9)).shape[1] == 0


def by_iteration(K, M, loss, kind, near):
    """Eigenvalues of the full problem nearest to those given.

    By inverse iteration with a complex shift: our witness.
    """
    from scipy.sparse.linalg import splu

    out = []
    for guess, start in near:
        value, vector = guess, start
        shifted = (K + 1j * loss - value * M) if kind == "hysteretic" else (K + value * loss + value**2 * M)
        factor = splu(shifted.tocsc())
        for _ in range(5):
            right = M @ vector if kind == "hysteretic" else loss @ vector + 2 * value * (M @ vector)
            new = factor.solve(right)
            new = new / np.linalg.norm(new)
            if kind == "hysteretic":
                value = (new @ (K @ new) + 1j * (new @ (loss @ new))) / (new @ (M @ new))
            else:
                a, b, c = new @ (M @ new), new @ (loss @ new), new @ (K @ new)
                roots = np.roots([a, b, c])
                value = roots[np.argmin(np.abs(roots - guess))]
            vector = new
        out.append(value)
    return np.array(out)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["hysteretic", "viscous"])
def test_thirty_thousand_unknowns(kind):
    """First 15 elastic modes at 30 000 unknowns: frequency to 1e-5, damping to 1 % of the full problem's."""
    K, M, loss = jointed([20, 25], (6, 4), c=None if kind == "hysteretic" else 5e7)
    assert 28e3 < K.shape[0] < 45e3
    found = damped_modes(lowest_modes(K, M, 27, shift_frequency=50.0), K, M, loss, rigid=6, count=15, kind=kind)
    omega = 2 * np.pi * found.frequencies
    if kind == "hysteretic":
        guess = omega**2 * (1 + 1j * found.loss_factors)
    else:
        guess = omega * (-found.loss_factors / 2 + 1j * np.sqrt(1 - found.loss_factors**2 / 4))
    off = guess * (1 + 1e-4)  # so that the shift is not the answer
    exact = by_iteration(K, M, loss, kind, list(zip(off, found.shapes.T, strict=True)))
    if kind == "hysteretic":
        frequency, damping = np.sqrt(exact.real), exact.imag / exact.real
    else:
        frequency, damping = np.abs(exact), -2 * exact.real / np.abs(exact)
    assert omega == pytest.approx(frequency, rel=1e-5)
    assert found.loss_factors == pytest.approx(damping, rel=0.01, abs=1e-7)


@pytest.mark.slow
def test_a_hundred_and_fifty_thousand_unknowns():
    """First 15 elastic modes under viscous damping against the full quadratic problem: its companion of twice the size
    at a real shift, so that one real factorisation of K + s C + s^2 M serves: frequency to 1e-5, damping to 1 %."""
    from scipy.sparse.linalg import LinearOperator, eigs

    from faying.numerics.solve import factorise

    K, M, C = jointed([32, 40], (10, 8), c=5e7)
    assert 140e3 < K.shape[0] < 180e3
    found = damped_modes(lowest_modes(K, M, 27, shift_frequency=50.0), K, M, C, rigid=6, count=15, kind="viscous")
    n, s = K.shape[0], 2 * np.pi * 400.0
    inverse = factorise((K + s * C + s**2 * M).tocsr())

    def solve(right):
        f, g = right[:n], right[n:]
        x = -inverse.solve(M @ g + C @ f + s * (M @ f))
        return np.concatenate([x, f + s * x])

    start = np.random.default_rng(3).standard_normal(2 * n)
    theta = eigs(
        LinearOperator((2 * n, 2 * n), matvec=solve, dtype=float),
        k=60,
        ncv=140,
        v0=start,
        tol=1e-12,
        return_eigenvectors=False,
    )
    roots = s + 1 / theta
    for frequency, loss in zip(found.frequencies, found.loss_factors, strict=True):
        omega = 2 * np.pi * frequency
        root = roots[np.argmin(np.abs(roots - omega * (-loss / 2 + 1j)))]
        assert omega == pytest.approx(np.abs(root), rel=1e-5)
        assert loss == pytest.approx(-2 * root.real / np.abs(root), rel=0.01, abs=1e-8)


def test_too_few_modes_that_oscillate_are_told():
    with pytest.raises(faying.NotConverged, match="only 1 of 2 modes oscillate"):
        lowest_complex(np.ones(1), 2)


@pytest.mark.parametrize("eta", [1.0, 10.0, 30.0])
@pytest.mark.parametrize("k", [2e10, 2e12])
def test_no_mode_is_left_out_however_great_the_loss(k, eta):
    """Where complex modes have little in common with real ones, the lowest of the full problem are found all the same.

    At eta = 30 on soft springs one of them overlaps no real mode that was wanted.
    """
    K, M, loss = jointed([3, 4], (1, 1), k=k, eta=eta)
    exact = hysteretic_exactly(K, M, loss, 8)
    modes = lowest_modes(K, M, 20, shift_frequency=50.0)
    found = damped_modes(modes, K, M, loss, rigid=6, count=8, tolerance=1e-8)
    assert found.frequencies == pytest.approx(np.sqrt(exact.real) / (2 * np.pi), rel=1e-7)
    assert found.loss_factors == pytest.approx(exact.imag / exact.real, rel=1e-6, abs=1e-7)


def test_a_mode_that_creeps_is_none_that_oscillates():
    """Two masses on springs, one beyond critical damping: its two real roots are not a mode, the other's pair is."""
    from scipy.sparse import csr_array

    M, K = csr_array(np.eye(2)), csr_array(np.diag([1e6, 4e6]))
    modes = lowest_modes(K, M, 2, shift_frequency=10.0)
    for ratio, oscillate in ((0.5, True), (1.5, False)):
        C = csr_array(np.diag([2 * ratio * 1e3, 2 * 0.01 * 2e3]))
        if oscillate:
            found = damped_modes(modes, K, M, C, rigid=0, kind="viscous")
            assert found.loss_factors == pytest.approx([2 * ratio, 0.02], rel=1e-6)
        else:
            with pytest.raises(faying.NotConverged, match="only 1 of 2 modes oscillate"):
                damped_modes(modes, K, M, C, rigid=0, kind="viscous")


def test_scaled_shapes_are_the_complex_shapes_with_a_real_part_of_unit_mass():
    """The motion Re((a + i b) exp(i t)) of a mode is that of its shape, but for one real factor."""
    K, M, loss = jointed([3, 4], (1, 1), eta=0.3)
    found = damped_modes(lowest_modes(K, M, 16, shift_frequency=50.0), K, M, loss, rigid=6, count=5)
    real, imaginary = found.scaled_shapes(M)
    np.testing.assert_allclose(np.einsum("im,im->m", real, M @ real), 1.0, rtol=1e-12)
    ratio = (real + 1j * imaginary) / found.shapes
    np.testing.assert_allclose(ratio, np.broadcast_to(ratio[0], ratio.shape), rtol=1e-9)
    np.testing.assert_allclose(ratio.imag, 0, atol=1e-12)
    assert np.abs(imaginary).max() > 1e-3 * np.abs(real).max()  # the loss makes points lag
    # orthogonal to their own imaginary part, since shape^T M shape is real
    np.testing.assert_allclose(np.einsum("im,im->m", real, M @ imaginary), 0.0, atol=1e-10)
