"""Which input is to blame: shares of the variance of every output."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from faying.distribution import Distribution
from faying.errors import InputError
from faying.identify.sampling.points import load_direction_numbers
from faying.typing import Array

LEVEL = 0.9  # share of the repeats within the intervals
REPEATS = 200  # of the bootstrap
MAX_SHARE = 2.0  # a share of variance beyond it is not an error of sampling
MIN_RANGE = 1e-12  # relative range of an output that does not vary


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Shares:
    """Shares of the variance of m outputs that d independent inputs have.

    Args:
        first: by the input alone (m, d); they sum to at most 1. NaN where an output does not vary.
        total: by the input with all others that it acts together with (m, d).
        first_interval, total_interval: 5 and 95 % of each (2, m, d), by bootstrap of the points.
    """

    first: Array
    total: Array
    first_interval: Array
    total_interval: Array

    def beside(self, part: Array, others: Array) -> "Shares":
        """The same of a greater variance, of which this is a part (m,), and others (m, k) act by themselves."""
        both = {name: getattr(self, name) * part[:, None] for name in ("first", "total")}
        ends = {f"{name}_interval": getattr(self, f"{name}_interval") * part[:, None] for name in both}
        more = np.broadcast_to(others, (2, *others.shape))
        return Shares(
            **{name: np.concatenate([one, others], axis=-1) for name, one in both.items()},
            **{name: np.concatenate([one, more], axis=-1) for name, one in ends.items()},
        )


def shares(function: Callable[[Array], Array], priors: Sequence[Distribution], *, count: int = 4096) -> Shares:
    """First-order and total shares of variance (Sobol indices).

    Args:
        function: from values (n, d) to outputs (n, m), finite, for any number of points at once.
        priors: of the d independent inputs.
        count: points, a power of 2; the function is evaluated at count (d + 2).

    Raises:
        InputError: count is not a power of 2, or an output is not finite.

    Source: Saltelli et al. 2010, doi:10.1016/j.cpc.2009.09.018, table 2 (b) and (f), at the points of
        scipy.stats.sobol_indices.
    """
    from scipy.stats import sobol_indices

    if count < 2 or count & (count - 1):
        raise InputError(f"count = {count}; it must be a power of 2, for example 4096")
    if len(priors) == 1:  # all of it; SciPy returns no arrays then
        rows = len(_finite(function, np.array([[priors[0].median]])))
        whole = np.ones((rows, 1))
        return Shares(
            first=whole, total=whole, first_interval=np.ones((2, rows, 1)), total_interval=np.ones((2, rows, 1))
        )
    kept: list[Array] = []
    greatest: list[Array] = []

    def outputs(x: Array) -> Array:
        y = _finite(function, x.T)
        greatest.append(np.abs(y).max(axis=1))
        return y

    def method(f_A: Array, f_B: Array, f_AB: Array) -> Array:
        kept.extend((f_A, f_B, f_AB))
        return _indices(f_A, f_B, f_AB, np.ones((1, f_A.shape[1])))[:, 0]

    load_direction_numbers()
    rng = np.random.default_rng(0)
    sobol_indices(func=outputs, n=count, dists=[_Quantile(p) for p in priors], method=method, rng=rng)
    repeats = rng.multinomial(count, np.full(count, 1 / count), size=REPEATS).astype(float)
    f_A, f_B, f_AB = kept
    still = np.ptp(np.concatenate([f_A, f_B], axis=1), axis=1) <= MIN_RANGE * np.max(greatest, axis=0)
    first, total = np.where(still[:, None], np.nan, _indices(f_A, f_B, f_AB, np.ones((1, count)))[:, 0])
    if np.nanmax([first, total], initial=0.0) > MAX_SHARE:
        raise InputError(
            f"a share of {np.nanmax([first, total]):.0%} of the variance came out, where none is above 100 %: the "
            "points do not fill the ranges of the inputs; take more samples"
        )
    spread = np.where(still[:, None], np.nan, _indices(f_A, f_B, f_AB, repeats))
    ends = np.quantile(spread, ((1 - LEVEL) / 2, (1 + LEVEL) / 2), axis=1)
    return Shares(first=first, total=total, first_interval=ends[:, 0], total_interval=ends[:, 1])


def _finite(function: Callable[[Array], Array], x: Array) -> Array:
    """The outputs (m, n) at points (n, d)."""
    y = np.asarray(function(x), dtype=float)
    if not np.isfinite(y).all():
        raise InputError("an output is not finite; shares of variance need an answer at every point")
    return np.atleast_2d(y.T)


def _indices(f_A: Array, f_B: Array, f_AB: Array, weights: Array) -> Array:
    """First-order and total indices (2, r, m, d) for r sets of weights (r, n) of the points.

    f_A, f_B (m, n) are the outputs at both samples; f_AB (d, m, n) at the first with one input of the second.
    """
    share = weights / weights.sum(axis=1, keepdims=True)
    centre = np.concatenate([f_A, f_B], axis=1).mean(axis=1)[:, None]
    mean = (share @ (f_A + f_B - 2 * centre).T) / 2
    variance = (share @ ((f_A - centre) ** 2 + (f_B - centre) ** 2).T) / 2 - mean**2
    first = np.stack([share @ ((f_B - centre) * (f - f_A)).T for f in f_AB], axis=-1)  # table 2 (b)
    total = np.stack([share @ ((f - f_A) ** 2).T for f in f_AB], axis=-1) / 2  # table 2 (f)
    with np.errstate(divide="ignore", invalid="ignore"):
        out: Array = np.stack([first, total]) / variance[None, :, :, None]
    return out


class _Quantile:
    """A distribution under the name that SciPy asks for."""

    def __init__(self, prior: Distribution) -> None:
        self.prior = prior

    def ppf(self, u: Array) -> Array:
        return self.prior.quantile(u)
