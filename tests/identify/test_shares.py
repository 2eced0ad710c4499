"""Shares of variance against closed forms."""

import numpy as np
import pytest

from faying.distribution import Distribution
from faying.errors import InputError
from faying.identify.shares import shares
from faying.identify.surrogate import Surrogate

TURN = Distribution(kind="uniform", centre=0, spread=np.pi)
NORMAL = Distribution(kind="normal", centre=1, spread=2)


def ishigami(x, a=7.0, b=0.1):
    return np.sin(x[:, 0]) + a * np.sin(x[:, 1]) ** 2 + b * x[:, 2] ** 4 * np.sin(x[:, 0])


def ishigami_indices(a=7.0, b=0.1):
    """First-order and total indices (Ishigami and Homma 1990)."""
    one = 0.5 * (1 + b * np.pi**4 / 5) ** 2
    two = a**2 / 8
    joint = b**2 * np.pi**8 * (1 / 18 - 1 / 50)
    whole = one + two + joint
    return np.array([one, two, 0]) / whole, np.array([one + joint, two, joint]) / whole


def test_ishigami():
    first, total = ishigami_indices()
    found = shares(ishigami, [TURN] * 3, count=8192)
    assert found.first.shape == (1, 3)
    assert found.first[0] == pytest.approx(first, abs=0.02)
    assert found.total[0] == pytest.approx(total, abs=0.02)
    for values, (low, high) in ((found.first, found.first_interval), (found.total, found.total_interval)):
        assert np.all((low <= values) & (values <= high))
        assert np.all(high - low < 0.12)


def test_a_sum_shares_by_variance_and_what_does_not_vary_has_none():
    priors = [NORMAL, Distribution(kind="uniform", centre=5, spread=3)]
    found = shares(lambda x: np.column_stack([x[:, 0] + 2 * x[:, 1], 1e9 + 0 * x[:, 0], x[:, 1]]), priors)
    variances = np.array([4.0, 4 * 3.0])
    assert found.first[0] == pytest.approx(variances / variances.sum(), abs=0.02)
    assert found.total[0] == pytest.approx(variances / variances.sum(), abs=0.02)
    assert np.isnan(found.first[1]).all()
    assert np.isnan(found.total_interval[:, 1]).all()
    assert found.first[2] == pytest.approx([0, 1], abs=0.02)


def test_of_a_surrogate():
    x = np.random.default_rng(0).standard_normal((200, 2))
    fit = Surrogate.fit(x, x[:, :1] * x[:, 1:] + x[:, :1])
    standard = Distribution(kind="normal", centre=0, spread=1)
    found = shares(fit.predict, [standard, standard])
    assert found.first[0] == pytest.approx([0.5, 0], abs=0.02)
    assert found.total[0] == pytest.approx([1, 0.5], abs=0.03)


def test_one_input_has_all_of_it():
    found = shares(lambda x: x**2, [NORMAL])
    assert (found.first, found.total) == ([[1]], [[1]])


def test_faults():
    with pytest.raises(InputError, match="power of 2, for example 4096"):
        shares(ishigami, [TURN] * 3, count=1000)
    with pytest.raises(InputError, match="not finite"):
        shares(lambda x: np.where(x[:, 0] > 0, x[:, 0], np.nan), [TURN] * 3, count=64)
