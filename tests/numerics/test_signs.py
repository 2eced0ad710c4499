"""A mode shape has one sign, whichever the eigensolver finds."""

import numpy as np

from faying.numerics.modes import definite


def test_a_shape_and_its_negative_are_one():
    rng = np.random.default_rng(5)
    shapes = rng.standard_normal((30, 6))
    flipped = shapes * rng.choice([-1.0, 1.0], 6)
    assert np.array_equal(definite(shapes), definite(flipped))
    found = definite(shapes)
    assert np.all(found[np.abs(found).argmax(axis=0), np.arange(6)] > 0)


def test_of_equal_components_the_first_one_decides():
    """An antisymmetric shape: rounding must not choose between its two ends."""
    for noise in (1e-9, -1e-9):
        shape = np.array([[0.2, -1.0, 0.0, 1.0 + noise]]).T
        assert definite(shape)[1, 0] == 1.0
        assert definite(-shape)[1, 0] == 1.0


def test_the_real_part_decides_and_the_imaginary_part_follows():
    shape = np.array([[0.1 + 5j, -2.0 + 0.3j]]).T
    assert np.array_equal(definite(shape), -shape)


def test_nothing_is_nothing():
    assert definite(np.zeros((3, 0))).shape == (3, 0)
    assert np.array_equal(definite(np.zeros((3, 1))), np.zeros((3, 1)))
