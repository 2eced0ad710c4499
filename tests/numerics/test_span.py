"""What is added to a basis: orthonormal in its operator, and no more than is new."""

import numpy as np
import pytest
from scipy.sparse import diags_array

from faying.numerics.span import GrowingColumns, Span, extension

N = 40
MASS = diags_array(np.geomspace(1e-3, 1e3, N)).tocsr()
STIFFNESS = diags_array([np.full(N - 1, -1.0), np.full(N, 2.1), np.full(N - 1, -1.0)], offsets=[-1, 0, 1]).tocsr()


def drawn(columns, seed=0):
    return np.random.default_rng(seed).standard_normal((N, columns))


def of_mass(vectors):
    return vectors.T @ (MASS @ vectors)


def test_columns_are_orthonormal_with_the_basis_and_span_what_was_given():
    start, none = np.zeros((N, 0)), np.zeros((N, 0))
    first, image = extension(drawn(3), start, none, MASS)
    new, moved = extension(drawn(4, seed=1), first, image, MASS)
    both = np.concatenate([first, new], axis=1)
    np.testing.assert_allclose(of_mass(both), np.eye(7), atol=1e-12)
    np.testing.assert_allclose(moved, MASS @ new, rtol=1e-12)
    given = drawn(4, seed=1)
    np.testing.assert_allclose(both @ (both.T @ (MASS @ given)), given, atol=1e-9)


def test_what_is_hardly_new_is_orthogonal_to_the_basis_as_well():
    """A millionth beside the basis: one projection leaves rounding of 1e-16, which is 1e-10 of it."""
    first, image = extension(drawn(3), np.zeros((N, 0)), np.zeros((N, 0)), MASS)
    new, _ = extension(first.sum(axis=1, keepdims=True) + 1e-6 * drawn(1, seed=4), first, image, MASS)
    assert np.abs(first.T @ (MASS @ new)).max() < 1e-14


def test_what_is_there_already_adds_nothing_and_half_of_it_adds_half():
    first, image = extension(drawn(3), np.zeros((N, 0)), np.zeros((N, 0)), MASS)
    again, _ = extension(first @ drawn(3)[:3], first, image, MASS, least=1e-20)
    assert again.shape == (N, 0)
    mixed = np.concatenate([first[:, :2], drawn(2, seed=2)], axis=1)
    assert extension(mixed, first, image, MASS)[0].shape == (N, 2)


@pytest.mark.parametrize("columns", [1, 5])
def test_a_span_keeps_its_projection(columns):
    first, _ = extension(drawn(2), np.zeros((N, 0)), np.zeros((N, 0)), MASS)
    span = Span(MASS, STIFFNESS, first)
    assert span.add(drawn(columns, seed=3)) == columns
    np.testing.assert_allclose(span.small, span.vectors.T @ (STIFFNESS @ span.vectors), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(of_mass(span.vectors), np.eye(2 + columns), atol=1e-12)


def test_columns_grow_under_a_view_and_after_a_turn_without_losing_any():
    """Growth moves the numbers where nobody looks at them; a view that is held keeps what it showed."""
    blocks = [drawn(k, seed=k) for k in (5, 3, 1, 4)]
    columns, wanted = GrowingColumns(blocks[0]), blocks[0]
    held = []
    for block in blocks[1:]:
        columns.add(block)
        wanted = np.concatenate([wanted, block], axis=1)
        np.testing.assert_array_equal(columns.values, wanted)
        held.append((columns.values, wanted))
    for view, wanted in held:
        np.testing.assert_array_equal(view, wanted)
    rotation = np.linalg.qr(drawn(13, seed=9)[:13])[0][:, :6]
    columns.turn(rotation)
    columns.add(blocks[1])
    np.testing.assert_allclose(
        columns.values, np.concatenate([wanted @ rotation, blocks[1]], axis=1), rtol=1e-13, atol=1e-14
    )
    np.testing.assert_array_equal(blocks[0], drawn(5, seed=5))  # what came first is not turned
