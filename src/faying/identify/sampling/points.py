"""Points that fill a space of independent inputs evenly."""

from collections.abc import Sequence

import numpy as np

from faying.distribution import Distribution
from faying.errors import InputError
from faying.files import uninterrupted
from faying.typing import Array


def sobol(size: int, count: int, seed: int) -> Array:
    """Scrambled Sobol points (count, size) between 0 and 1, none of them at an end."""
    from scipy.stats import qmc

    load_direction_numbers()
    power = max(int(np.ceil(np.log2(count))), 0)
    found: Array = qmc.Sobol(size, rng=np.random.default_rng(seed)).random_base2(power)[:count]
    refuse_alike(found)
    return np.clip(found, 1e-12, 1 - 1e-12)


def load_direction_numbers() -> None:
    """Have SciPy load Sobol's direction numbers while signals wait: it swallows one that comes just then.

    Its points would all be alike from then on. See the source of scipy.stats._sobol.
    """
    from scipy.stats import qmc

    with uninterrupted():
        qmc.Sobol(2, scramble=False).random(2)


def refuse_alike(points: Array) -> None:
    """Raise InputError where points (n, d) that should fill a space are alike in one of its directions."""
    if len(points) > 1 and np.any(np.ptp(points, axis=0) == 0):
        raise InputError("the points of a Sobol sequence are all alike: SciPy was interrupted; start the command again")


def at_shares(priors: Sequence[Distribution], shares: Array) -> Array:
    """Values (n, d) in SI units at shares of probability (n, d)."""
    return np.column_stack([prior.quantile(u) for prior, u in zip(priors, shares.T, strict=True)])
