"""Modes of samples keep the name of the median's mode whose shape they have."""

import numpy as np
import pytest

from faying.identify.identity import by_name, named, paired, paired_modes


def test_modes_that_change_their_order_keep_their_names():
    """Shapes that are permuted, turned by a phase, or lost, in a mass that is not the identity."""
    rng = np.random.default_rng(0)
    root = rng.standard_normal((6, 6))
    mass = root.T @ root + np.eye(6)
    shapes = np.linalg.solve(np.linalg.cholesky(mass).T, np.linalg.qr(rng.standard_normal((6, 6)))[0])
    there = shapes[:, [2, 0, 5]] * np.exp(0.3j)
    names = named([shapes[:, :3], shapes[:, :3]], [there, shapes[:, :3]], mass)
    assert names.tolist() == [[1, -1, 0], [0, 1, 2]]
    values = np.array([[10.0, 20.0, 30.0], [11.0, 21.0, 31.0]])
    assert by_name(values, names) == pytest.approx(np.array([[20, np.nan, 10], [11, 21, 31]]), nan_ok=True)


def test_the_nearest_samples_say_which_modes_are_the_tests():
    """Most samples are far off and pair by frequency alone, wrongly; the names of the nearest hold for them, too."""
    test = np.array([[200.0, 300.0]])
    near, far = [100.0, 201.0, 299.0], [150.0, 290.0, 420.0]
    frequencies = np.array([[near]] * 8 + [[far]] * 40 + [[[np.nan] * 3]])
    modes = np.array([[1.0, 2.0]] * 7 + [[1.0, 0.0]] + [[0.0, 1.0]] * 40 + [[np.nan, np.nan]])
    names = paired_modes(test, {"named": frequencies, "modes": modes})
    assert names.tolist() == [1, 2]
    assert paired(frequencies, names)[-2].tolist() == [[290.0, 420.0]]
    assert paired_modes(test, {"named": frequencies[-1:], "modes": modes[-1:]}).tolist() == [-1, -1]
