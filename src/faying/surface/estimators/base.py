"""What an estimator is, what it returns, and how the interval of G follows from those of D and the level."""

from collections.abc import Callable
from dataclasses import dataclass
from math import log
from typing import final

import numpy as np

from faying.surface.convention import G_from_density, density
from faying.surface.form import Prepared
from faying.surface.heights import AreaHeights, LineHeights, steps_of
from faying.typing import Array

Z95 = 1.959963984540054  # two-sided 95 % point of the normal distribution
Limits = tuple[float, float] | None


@final
@dataclass(frozen=True, kw_only=True)
class EstimateScatter:
    """How far D and the level of the spectrum may be off together.

    D and G are strongly correlated: what the heights fix is the level of the spectrum S in the middle of the band.

    Args:
        pivot: Frequency [1/m] at which the level is taken.
        covariance: Of (ln S(pivot), D), (2, 2).
        c: Prefactor of the convention [-].
    """

    pivot: float
    covariance: tuple[tuple[float, float], tuple[float, float]]
    c: float

    def level(self, D: float, G: float) -> float:
        """ln S(pivot) [ln m3] of D and G [m]."""
        return log(density(D, G, self.c)) - (7 - 2 * D) * log(self.pivot)

    def G(self, D: float, level: float) -> float:
        """G [m] of D and ln S(pivot); no linearisation, since ln G is steep near D = 2."""
        return G_from_density(D, level + (7 - 2 * D) * log(self.pivot), self.c)


@final
@dataclass(frozen=True, kw_only=True)
class Estimate:
    """D, G [m], 95 % intervals, band (shortest, longest wavelength [m]), rms white noise [m], misfit [-], remarks."""

    D: float
    G: float
    D_interval: tuple[float, float]
    G_interval: tuple[float, float]
    band: tuple[float, float]
    noise: float = 0.0
    misfit: float = 1.0
    notes: tuple[str, ...] = ()
    scatter: EstimateScatter | None = None


@final
@dataclass(frozen=True, kw_only=True)
class Estimator:
    """One way from heights to D and G.

    `name` is what users write; `needs` says what the heights must offer and `bias` what is known of its error.
    `estimate(ready, limits, c)` takes prepared heights, a band of wavelengths [m] or None, and the convention's c.
    """

    name: str
    needs: str
    bias: str
    estimate: Callable[[Prepared, Limits, float], Estimate]


def with_intervals(
    D: float, log_level: float, covariance: Array, pivot: float, c: float, *, band: tuple[float, float], **rest: object
) -> Estimate:
    """Build an Estimate from D, ln S(pivot) [m3] and the covariance of (ln S(pivot), D).

    The interval of G is the central 95 % of G over the joint normal law of ln S and D (no linearisation, since
    ln G = ln(2 B/c)/(2D-4) is steep near D = 2); draws with D <= 2 count as G = 0.
    """
    sigma = max(float(covariance[1, 1]), 0.0) ** 0.5
    rng = np.random.default_rng(12345)
    root = np.linalg.svd(covariance)
    draws = (root[0] * np.sqrt(root[1])) @ rng.standard_normal((2, 4000))
    ds, levels = D + draws[1], log_level + draws[0]

    (ll, ld), (_, dd) = covariance.tolist()
    scatter = EstimateScatter(pivot=pivot, covariance=((ll, ld), (ld, dd)), c=c)
    many = np.array([scatter.G(d, v) if d > 2 else 0.0 for d, v in zip(ds, levels, strict=True)])
    low, high = np.quantile(many, [0.025, 0.975], method="nearest")
    return Estimate(
        D=D,
        G=scatter.G(D, log_level) if D > 2 else 0.0,
        D_interval=(D - Z95 * sigma, D + Z95 * sigma),
        G_interval=(float(low), float(high)),
        band=band,
        scatter=scatter,
        **rest,  # type: ignore[arg-type]
    )


def white_rms(scan: AreaHeights | LineHeights, noise: float) -> float:
    """Rms height [m] of a white level of the two-sided density."""
    return float((max(noise, 0.0) / float(np.prod(steps_of(scan)))) ** 0.5)
