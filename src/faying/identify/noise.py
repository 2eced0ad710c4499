"""How a test differs from a model: scatter of each measured number, and one offset for each mode."""

from dataclasses import dataclass
from math import log, pi
from typing import final

import numpy as np

from faying.distribution import FACTOR_SCORE, Distribution
from faying.typing import Array, Index

SCATTER, DISCREPANCY = "test scatter", "model discrepancy"
LOSS_SCATTER, LOSS_DISCREPANCY = "loss test scatter", "loss model discrepancy"
# relative: 5 to 95 % lie within a factor of three
TEST_SD = Distribution(kind="lognormal", centre=0.003, spread=log(3) / FACTOR_SCORE)
DISCREPANCY_SD = Distribution(kind="lognormal", centre=0.01, spread=log(3) / FACTOR_SCORE)
# of loss factors, which tests repeat to a tenth or so and models hit within a third at best
LOSS_TEST_SD = Distribution(kind="lognormal", centre=0.1, spread=log(3) / FACTOR_SCORE)
LOSS_DISCREPANCY_SD = Distribution(kind="lognormal", centre=0.3, spread=log(3) / FACTOR_SCORE)


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Losses:
    """Measured loss factors beside the frequencies of a test.

    values: (load, mode) [-], NaN where there is none; scatter, discrepancy: priors of the relative sd of their scatter,
    and of one offset of their logarithm for each mode.
    """

    values: Array
    scatter: Distribution = LOSS_TEST_SD
    discrepancy: Distribution = LOSS_DISCREPANCY_SD


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Offsets:
    """What a test says of the offset b of each mode, and how likely the test is with all offsets allowed for.

    log_likelihood (n, mode); mean and variance of b (n, mode), given the parameters.
    """

    log_likelihood: Array
    mean: Array
    variance: Array


def offsets(residual: Array, variance: Array, discrepancy: Array, modes: Index, count: int) -> Offsets:
    """Take the offsets out in closed form.

    ln test = ln model + b_mode + e, with e normal of the given variance, independent, and b normal of sd `discrepancy`,
    one for each mode at all loads. So the covariance of a mode's residuals is diag(variance) + discrepancy^2.

    Args:
        residual: ln test - ln model of the k frequencies that count (n, k).
        variance: of the scatter, with the square of the surrogate's error (n, k).
        discrepancy: sd of the offsets, of all (n,) or of each mode (n, mode).
        modes: the mode, from 0, of each frequency (k,).
        count: of modes; one without a frequency has the likelihood 1 and the offset's prior.
    """
    member = np.zeros((len(modes), count))
    member[np.arange(len(modes)), modes] = 1.0
    weight = 1 / variance
    prior = np.reshape(discrepancy, (len(residual), -1)) ** 2 * np.ones(count)
    whole, pull = weight @ member, (weight * residual) @ member
    shrunk = prior / (1 + prior * whole)
    # determinant and inverse of diag + rank one (Sherman and Morrison)
    logs = np.log(variance) @ member + np.log1p(prior * whole)
    square = (weight * residual**2) @ member - shrunk * pull**2
    out = -(square + logs + member.sum(axis=0) * log(2 * pi)) / 2
    return Offsets(log_likelihood=out, mean=shrunk * pull, variance=shrunk)
