"""Shares of variance against closed forms."""

import numpy as np
import pytest

from faying.distribution import Distribution
from faying.errors import InputError
from faying.identify.sampling.surrogate import Surrogate
from faying.identify.shares import shares

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


def test_a_sum_shares_by_variance_and_what_does_not_vary_has_none():
    priors = [NORMAL, Distribution(kind="uniform", centre=5, spread=3)]
    found = shares(lambda x: np.column_stack([x[:, 0] + 2 * x[:, 1], 1e9 + 0 * x[:, 0], x[:, 1]]), priors)
    variances = np.array([4.0, 4 * 3.0])
    assert found.first[0] == pytest.approx(variances / variances.sum(), abs=0.02)
    assert found.total[0] == pytest.approx(variances / variances.sum(), abs=0.02)
    assert np.isnan(found.first[1]).all()
    assert np.isnan(found.total[1]).all()
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


def test_shares_are_those_of_their_definition():
    """Table 2 (b) and (f) of Saltelli et al. 2010 at the points that were asked for."""
    asked = []

    def outputs(x):
        asked.extend(x)
        return np.sin(x[:, :1] + 1) + 0.7 * np.cos(x[:, 1:] * x[:, :1])

    found = shares(outputs, [TURN, TURN], count=256)
    A, B = np.array(asked[:256]), np.array(asked[256:512])
    f_A, f_B, f_AB = (outputs(x)[:, 0] for x in (A, B, np.column_stack([B[:, 0], A[:, 1]])))
    both = np.concatenate([f_A, f_B])
    assert found.first[0, 0] == pytest.approx(np.mean((f_B - both.mean()) * (f_AB - f_A)) / np.var(both), rel=1e-9)
    assert found.total[0, 0] == pytest.approx(np.mean((f_AB - f_A) ** 2) / 2 / np.var(both), rel=1e-9)


def test_shares_far_above_one_are_refused():
    """Where points do not stand for their input, as after an interrupt, a share of 400 % comes out."""
    done = []

    def changing(x):
        done.append(len(x))
        return (1.0 if len(done) <= 2 else 3.0) * x[:, :1]

    with pytest.raises(InputError, match=r"a share of \d{3}% of the variance came out"):
        shares(changing, [NORMAL, NORMAL], count=1024)


def test_what_varies_by_a_millionth_has_shares():
    found = shares(lambda x: 1e3 + 1e-3 * x[:, :1], [NORMAL, NORMAL], count=256)
    assert found.first[0] == pytest.approx([1, 0], abs=0.05)


def test_faults():
    with pytest.raises(InputError, match="power of 2, for example 4096"):
        shares(ishigami, [TURN] * 3, count=1000)
    with pytest.raises(InputError, match="not finite"):
        shares(lambda x: np.where(x[:, 0] > 0, x[:, 0], np.nan), [TURN] * 3, count=64)
