"""How a test differs from a model: scatter of each frequency, and one offset for each mode."""

from dataclasses import dataclass
from math import log, pi
from typing import final

import numpy as np

from faying.distribution import FACTOR_SCORE, Distribution
from faying.typing import Array, Mask

SCATTER, DISCREPANCY = "test scatter", "model discrepancy"
# relative: 5 to 95 % lie within a factor of three
TEST_SD = Distribution(kind="lognormal", centre=0.003, spread=log(3) / FACTOR_SCORE)
DISCREPANCY_SD = Distribution(kind="lognormal", centre=0.01, spread=log(3) / FACTOR_SCORE)


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Offsets:
    """What a test says of the offset b of each mode, and how likely the test is with all offsets allowed for.

    log_likelihood (n, mode); mean and variance of b (n, mode), given the parameters.
    """

    log_likelihood: Array
    mean: Array
    variance: Array


def offsets(residual: Array, variance: Array, discrepancy: Array, used: Mask) -> Offsets:
    """Take the offsets out in closed form.

    ln test = ln model + b_mode + e, with e normal of the given variance, independent, and b normal of sd `discrepancy`,
    one for each mode at all loads. So the covariance of a mode's residuals is diag(variance) + discrepancy^2.

    Args:
        residual: ln test - ln model (n, load, mode); anything where not used.
        variance: of the scatter, with the square of the surrogate's error (n, load, mode).
        discrepancy: sd of the offsets (n,).
        used: which frequencies count (load, mode).
    """
    r = np.where(used, residual, 0.0)
    weight = np.where(used, 1 / np.where(used, variance, 1.0), 0.0)
    prior = discrepancy[:, None] ** 2
    whole, pull = weight.sum(axis=1), (weight * r).sum(axis=1)
    shrunk = prior / (1 + prior * whole)
    # determinant and inverse of diag + rank one (Sherman and Morrison)
    logs = np.where(used, np.log(np.where(used, variance, 1.0)), 0.0).sum(axis=1) + np.log1p(prior * whole)
    square = (weight * r**2).sum(axis=1) - shrunk * pull**2
    out = -(square + logs + used.sum(axis=0) * log(2 * pi)) / 2
    return Offsets(log_likelihood=out, mean=shrunk * pull, variance=np.broadcast_to(shrunk, pull.shape))
