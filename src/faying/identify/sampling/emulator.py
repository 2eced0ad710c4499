"""The surrogate of a model's frequencies: over the whole prior, and a closer one about the posterior."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import sqrt
from typing import Self, final

import numpy as np

from faying.distribution import Distribution
from faying.identify.sampling.surrogate import Surrogate
from faying.typing import Array, Mask

ANSWERED = 0.5  # share of the points at which a frequency has to be known
MARGIN = 1.3  # of the region about the posterior, over the ellipsoid that holds 99.9 % of a normal one
INSIDE = 0.999


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Emulator:
    """ln f of every mode at every load, as polynomials.

    Args:
        priors: of the parameters.
        known: which frequencies have a surrogate (load, mode).
        over_prior: the surrogate over the prior, of the known frequencies.
        close: the surrogate about the posterior; None before there is one.
        centre, inverse: of the ellipsoid about the posterior within which `close` counts, in standardised parameters;
            (x - centre) inverse has a length of at most 1 there.
    """

    priors: tuple[Distribution, ...]
    known: Mask
    over_prior: Surrogate
    close: Surrogate | None = None
    centre: Array | None = None
    inverse: Array | None = None

    @classmethod
    def fit(cls, priors: Sequence[Distribution], values: Array, frequencies: Array) -> Self:
        """Fit to frequencies (n, load, mode) [Hz] at values (n, d); NaN where there is none."""
        answered = np.isfinite(frequencies)
        known = answered.mean(axis=0) >= ANSWERED * answered.any(axis=(1, 2)).mean()
        known &= answered.sum(axis=0) >= 2
        bounded = [prior.kind == "uniform" for prior in priors]
        over_prior = Surrogate.fit(_standardised(priors, values), np.log(frequencies[:, known]), bounded=bounded)
        return cls(priors=tuple(priors), known=known, over_prior=over_prior)

    def closer(self, values: Array, frequencies: Array, posterior: Array) -> Self:
        """Add a surrogate fitted to the points about a posterior alone.

        Args:
            values: all points that were evaluated (n, d).
            frequencies: there (n, load, mode).
            posterior: samples of the parameters (k, d).
        """
        from scipy.stats import chi2

        x, about = _standardised(self.priors, values), _standardised(self.priors, posterior)
        centre = about.mean(axis=0)
        scales, axes = np.linalg.eigh(np.atleast_2d(np.cov(about.T)))
        scales = np.sqrt(np.maximum(scales, 1e-10 * scales[-1]))
        inverse = axes / (scales * MARGIN * sqrt(chi2.ppf(INSIDE, len(centre))))
        logs = np.log(frequencies[:, self.known])
        inside = np.linalg.norm((x - centre) @ inverse, axis=1) <= 1
        if np.isfinite(logs[inside]).sum(axis=0).min(initial=len(x)) < 2 * (len(centre) + 1):
            return self
        close = Surrogate.fit(x[inside], logs[inside], bounded=list(self.over_prior.bounded))
        return replace(self, close=close, centre=centre, inverse=inverse)

    def predict(self, values: Array) -> tuple[Array, Array]:
        """ln f and the sd of its error (n, load, mode) at values (n, d); NaN for frequencies without surrogate."""
        logs, error = self.predict_known(values)
        return self._spread(logs), self._spread(error)

    def predict_known(self, values: Array) -> tuple[Array, Array]:
        """ln f and the sd of its error (n, k) of the k frequencies that are known, in the order of the mask."""
        x = _standardised(self.priors, values)
        logs, error = self.over_prior.predict(x), np.repeat(self.over_prior.error[None, :], len(x), axis=0)
        if self.close is not None:
            inside = self._inside(x)
            logs[inside], error[inside] = self.close.predict(x[inside]), self.close.error
        return logs, error

    def gradient(self, values: Array) -> Array:
        """The derivatives (n, load, mode, d) of ln f by the standardised parameters."""
        x = _standardised(self.priors, values)
        slopes = self.over_prior.gradient(x)
        if self.close is not None:
            inside = self._inside(x)
            slopes[inside] = self.close.gradient(x[inside])
        return self._spread(slopes)

    def _inside(self, x: Array) -> Mask:
        assert self.centre is not None
        assert self.inverse is not None
        return np.asarray(np.linalg.norm((x - self.centre) @ self.inverse, axis=1) <= 1)

    def _spread(self, values: Array) -> Array:
        """Values (n, k, ...) of the known frequencies among all (n, load, mode, ...), NaN for the others."""
        out = np.full((len(values), *self.known.shape, *values.shape[2:]), np.nan)
        out[:, self.known] = values
        return out


def _standardised(priors: Sequence[Distribution], values: Array) -> Array:
    return np.column_stack([prior.standardised(v) for prior, v in zip(priors, values.T, strict=True)])
