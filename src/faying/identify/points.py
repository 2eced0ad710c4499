"""Points that fill a space of independent inputs evenly."""

from collections.abc import Sequence

import numpy as np

from faying.distribution import Distribution
from faying.typing import Array


def sobol(size: int, count: int, seed: int) -> Array:
    """Scrambled Sobol points (count, size) between 0 and 1, none of them at an end."""
    from scipy.stats import qmc

    power = max(int(np.ceil(np.log2(count))), 0)
    found: Array = qmc.Sobol(size, rng=np.random.default_rng(seed)).random_base2(power)[:count]
    return np.clip(found, 1e-12, 1 - 1e-12)


def at_shares(priors: Sequence[Distribution], shares: Array) -> Array:
    """Values (n, d) in SI units at shares of probability (n, d)."""
    return np.column_stack([prior.quantile(u) for prior, u in zip(priors, shares.T, strict=True)])
