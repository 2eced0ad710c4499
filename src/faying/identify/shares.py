"""Which input is to blame: shares of the variance of every output."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import final

import numpy as np

from faying.distribution import Distribution
from faying.errors import InputError
from faying.identify.sampling.points import load_direction_numbers
from faying.typing import Array

MAX_SHARE = 2.0  # a share of variance beyond it is not an error of sampling
MIN_RANGE = 1e-12  # relative range of an output that does not vary


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Shares:
    """Shares of the variance of m outputs that d independent inputs have.

    Args:
        first: by the input alone (m, d); they sum to at most 1. NaN where an output does not vary.
        total: by the input with all others that it acts together with (m, d).
    """

    first: Array
    total: Array

    def beside(self, part: Array, others: Array) -> "Shares":
        """The same of a greater variance, of which this is a part (m,), and others (m, k) act by themselves."""
        first, total = (np.concatenate([one * part[:, None], others], axis=-1) for one in (self.first, self.total))
        return Shares(first=first, total=total)


def shares(function: Callable[[Array], Array], priors: Sequence[Distribution], *, count: int = 4096) -> Shares:
    """First-order and total shares of variance (Sobol indices).

    Args:
        function: from values (n, d) to outputs (n, m), finite, for any number of points at once.
        priors: of the d independent inputs.
        count: points, a power of 2; the function is evaluated at count (d + 2).

    Raises:
        InputError: count is not a power of 2, or an output is not finite.

    Source: Saltelli et al. 2010, doi:10.1016/j.cpc.2009.09.018, table 2 (b) and (f), as
        scipy.stats.sobol_indices has them.
    """
    from scipy.stats import sobol_indices

    if count < 2 or count & (count - 1):
        raise InputError(f"count = {count}; it must be a power of 2, for example 4096")
    if len(priors) == 1:  # all of it; SciPy returns no arrays then
        whole = np.ones((len(_finite(function, np.array([[priors[0].median]]))), 1))
        return Shares(first=whole, total=whole)
    ends: list[tuple[Array, Array]] = []

    def outputs(x: Array) -> Array:
        y = _finite(function, x.T)
        ends.append((y.min(axis=1), y.max(axis=1)))
        return y

    load_direction_numbers()
    dists = [SimpleNamespace(ppf=prior.quantile) for prior in priors]
    found = sobol_indices(func=outputs, n=count, dists=dists, rng=np.random.default_rng(0))
    least, greatest = np.min([low for low, _ in ends], axis=0), np.max([high for _, high in ends], axis=0)
    still = greatest - least <= MIN_RANGE * np.maximum(np.abs(least), np.abs(greatest))
    orders = np.reshape([found.first_order, found.total_order], (2, len(still), len(priors)))
    first, total = np.where(still[:, None], np.nan, orders)
    if np.nanmax([first, total], initial=0.0) > MAX_SHARE:
        raise InputError(
            f"a share of {np.nanmax([first, total]):.0%} of the variance came out, where none is above 100 %: the "
            "points do not fill the ranges of the inputs; take more samples"
        )
    return Shares(first=first, total=total)


def _finite(function: Callable[[Array], Array], x: Array) -> Array:
    """The outputs (m, n) at points (n, d)."""
    y = np.asarray(function(x), dtype=float)
    if not np.isfinite(y).all():
        raise InputError("an output is not finite; shares of variance need an answer at every point")
    return np.atleast_2d(y.T)
