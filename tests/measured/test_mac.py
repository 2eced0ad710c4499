import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from faying import InputError
from faying.measured.mac import frac, mac

numbers = st.floats(-1e3, 1e3).map(lambda x: round(x, 6))
shapes = arrays(float, (2, 3, 7), elements=numbers).map(lambda a: a[0] + 1j * a[1])


@given(shapes)
def test_of_a_set_with_itself_the_diagonal_is_one_and_none_exceeds_it(a):
    a = a[np.abs(a).max(axis=1) > 1e-3]
    table = mac(a, a)
    np.testing.assert_allclose(np.diag(table), 1, atol=1e-12)
    np.testing.assert_allclose(table, table.T, atol=1e-12)
    assert np.all((table >= 0) & (table <= 1))


@given(shapes, shapes, st.floats(0, 2 * np.pi), st.floats(1e-6, 1e6))
def test_scale_and_phase_do_not_matter(a, b, angle, scale):
    np.testing.assert_allclose(mac(a * scale * np.exp(1j * angle), b), mac(a, b), atol=1e-9)


def test_modes_of_equal_masses_give_the_unit_matrix():
    """Five equal masses and springs: the modes are orthogonal in the mass, hence here in themselves."""
    k = 2 * np.eye(5) - np.eye(5, k=1) - np.eye(5, k=-1)
    modes = np.linalg.eigh(k)[1].T
    np.testing.assert_allclose(mac(modes, modes), np.eye(5), atol=1e-12)


def test_modes_of_unequal_masses_do_not_unless_weighted():
    k, m = 2 * np.eye(3) - np.eye(3, k=1) - np.eye(3, k=-1), np.array([1.0, 5.0, 2.0])
    root = np.sqrt(m)
    weighted = np.linalg.eigh(k / np.outer(root, root))[1].T
    np.testing.assert_allclose(mac(weighted, weighted), np.eye(3), atol=1e-12)
    assert mac(weighted / root, weighted / root)[0, 2] > 0.01


def test_a_shape_without_motion_matches_nothing():
    np.testing.assert_array_equal(mac([[0, 0], [1, 0]], [[1, 0]]), [[0], [1]])


def test_frac_is_one_for_frfs_that_differ_by_a_factor():
    x = np.random.default_rng(0).standard_normal((2, 50)) + 1j
    np.testing.assert_allclose(frac(x, -3j * x), 1)
    assert frac(x, x[::-1]).max() < 0.9


def test_shapes_that_do_not_fit():
    with pytest.raises(InputError, match="at 2 and at 3 degrees of freedom"):
        mac(np.ones((1, 2)), np.ones((1, 3)))
    with pytest.raises(InputError, match="same pairs and spectral lines"):
        frac(np.ones(3), np.ones(4))
