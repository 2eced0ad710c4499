"""The estimators behind `fit_fractal` that rest on the spectrum: power law, and moments of the band."""

from collections.abc import Callable
from dataclasses import dataclass
from math import log, pi
from typing import final

import numpy as np

from faying.errors import FayingError, NotConverged
from faying.surface import fpenn
from faying.surface.convention import G_from_density
from faying.surface.form import Prepared
from faying.surface.lines import find_lines
from faying.surface.moments import invert_ratio
from faying.surface.powerlaw import PowerLaw, estimate_from, fit_band, smearing, supported_band
from faying.surface.scan import Profile, Scan
from faying.surface.spectrum import Spectrum, binned, periodogram
from faying.typing import Array

Z95 = 1.959963984540054  # two-sided 95 % point of the normal distribution
Limits = tuple[float, float] | None


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

    def G_of(d: float, level: float) -> float:
        # B = S(pivot) pivot^(7-2D)
        return G_from_density(d, level + (7 - 2 * d) * log(pivot), c) if d > 2 else 0.0

    many = np.array([G_of(d, v) for d, v in zip(ds, levels, strict=True)])
    low, high = np.quantile(many, [0.025, 0.975], method="nearest")
    return Estimate(
        D=D,
        G=G_of(D, log_level),
        D_interval=(D - Z95 * sigma, D + Z95 * sigma),
        G_interval=(float(low), float(high)),
        band=band,
        **rest,  # type: ignore[arg-type]
    )


def _spectral_fit(ready: Prepared, limits: Limits) -> tuple[Spectrum, PowerLaw, tuple[str, ...]]:
    s, notes = clean_spectrum(ready.scan)
    if limits is not None:
        law, more = fit_band(s, 1 / limits[1], 1 / limits[0], fixed=True)
    else:
        law, more = fit_band(s, *supported_band(s, resolution=ready.scan.instrument.resolution))
    return s, law, notes + more


def clean_spectrum(scan: Scan | Profile) -> tuple[Spectrum, tuple[str, ...]]:
    """Return the spectrum without the sharp peaks of tool marks, and what was left out in words."""
    power, frequency, axes = periodogram(scan)
    if isinstance(scan, Profile):
        return binned(scan, power, frequency, axes), ()
    marked = find_lines(scan, power, frequency)
    share = float(power[marked].sum() / power.sum())
    if share < 1e-4:
        return binned(scan, power, frequency, axes), ()
    words = f"tool marks: {100 * share:.2g} % of the power lies in sharp peaks of the spectrum and was left out"
    return binned(scan, power, frequency, axes, exclude=marked), (words,)


def white_rms(ready: Prepared, noise: float) -> float:
    """Rms height [m] of a white level of the two-sided density."""
    steps = ready.scan.spacing if isinstance(ready.scan, Scan) else (ready.scan.spacing,)
    return float((max(noise, 0.0) / float(np.prod(steps))) ** 0.5)


def by_psd(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Fit a power law with a white term to the spectrum averaged over directions (see `powerlaw`)."""
    _, law, notes = _spectral_fit(ready, limits)
    return with_intervals(
        *estimate_from(law),
        law.pivot,
        c,
        band=(1 / float(law.used[-1]), 1 / float(law.used[0])),
        noise=white_rms(ready, law.noise),
        misfit=law.misfit,
        notes=notes,
    )


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Band:
    """The bins of a fitted band: frequency, width [1/m], density [m3], the white term's shape, smearing, spread [-]."""

    law: PowerLaw
    frequency: Array
    width: Array
    density: Array
    shape: Array
    smear: Array
    spread: Array
    notes: tuple[str, ...]

    def clean(self, density: Array, noise: float) -> Array:
        """Density [m3] without its white part and the window's smearing."""
        return (density - noise * self.shape) / self.smear

    def drawn(self, rng: np.random.Generator) -> tuple[Array, float]:
        """One draw of the bins about the fitted law, and the white level that the fit would find in it."""
        expected = self.law.expected
        fake = expected * rng.gamma(1 / self.spread**2, self.spread**2)
        return fake, self.law.noise + float(self.law.response[2] @ (fake / expected - 1))


def _clean_band(ready: Prepared, limits: Limits) -> Band:
    """Fit the band and hold its bins, ready to be drawn again from their gamma law."""
    s, law, notes = _spectral_fit(ready, limits)
    use = (s.frequency >= law.used[0] * 0.999999) & (s.frequency <= law.used[-1] * 1.000001) & (s.density > 0)
    f = s.frequency[use]
    return Band(
        law=law,
        frequency=f,
        width=s.width[use] * s.lowest,
        density=s.density[use],
        shape=2 * pi * f if s.axes == 2 else np.full(len(f), 2.0),
        smear=smearing(s, f, law.slope)[0],
        spread=s.spread[use] * max(1.0, law.misfit) ** 0.5,
        notes=notes,
    )


def _through_draws(
    ready: Prepared, band: Band, c: float, solve: Callable[[Array], tuple[float, float]], extra: float = 0.0
) -> Estimate:
    """Solve for (slope, ln S(pivot)) on the measured bins; bias and covariance from 200 draws of the bins.

    `extra` is a further standard error of D (a network's).
    """
    slope, level = solve(band.clean(band.density, band.law.noise))
    rng = np.random.default_rng(2024)
    draws = []
    for _ in range(200):
        try:
            draws.append(solve(band.clean(*band.drawn(rng))))
        except FayingError:
            continue
    if len(draws) < 150:
        raise NotConverged("the moments of this band do not fix D: most draws within their error have no solution")
    cloud = np.array(draws)
    centre = solve(band.clean(band.law.expected, band.law.noise))
    slope, level = slope - float(cloud[:, 0].mean() - centre[0]), level - float(cloud[:, 1].mean() - centre[1])
    covariance = np.cov(np.stack([cloud[:, 1], -cloud[:, 0] / 2]))
    covariance[1, 1] += extra**2
    f = band.frequency
    return with_intervals(
        (7 - slope) / 2,
        level,
        covariance,
        band.law.pivot,
        c,
        band=(1 / float(f[-1]), 1 / float(f[0])),
        noise=white_rms(ready, band.law.noise),
        misfit=band.law.misfit,
        notes=band.notes,
    )


def by_moments(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Take m2/m0 of the band (white part and window smearing removed) and solve for D, as the ideal series' map does.

    The moments are sums over bins, m_2k = (2 pi)^(2k) sum (S - white) f^(2k) df; G follows from m2, the better known
    of the two. Intervals by drawing the bins from their gamma law and repeating the inversion.
    """
    band = _clean_band(ready, limits)
    f, width = band.frequency, band.width

    def solve(clean: Array) -> tuple[float, float]:
        m0, m2 = float(np.sum(clean * width)), float(np.sum(clean * f**2 * width))
        if m0 <= 0 or m2 <= 0:
            raise NotConverged("the spectral moments of the band are not positive once the noise is taken out")
        slope = invert_ratio(m2 / m0, 2.0, f, width)
        return slope, log(m2) - log(float(np.sum((f / band.law.pivot) ** -slope * f**2 * width)))

    return _through_draws(ready, band, c, solve)


def by_fpenn(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Gather the band's power into a Weierstrass-Mandelbrot series (gamma 1.5) and ask the network for D and G.

    Each frequency of the series takes the power within a factor 1.5^(1/2) of it. The interval holds the scatter of the
    bins and the network's rms error.
    """
    band = _clean_band(ready, limits)
    ends = np.concatenate([band.frequency - band.width / 2, [band.frequency[-1] + band.width[-1] / 2]])
    terms = int(log(float(ends[-1] / ends[0])) / log(fpenn.GAMMA))
    known = fpenn.trained_range()
    if terms < known.terms[0]:
        raise NotConverged(f"the band holds {terms} frequencies of a series; the network needs {known.terms[0]}")
    edges = ends[-1] * fpenn.GAMMA ** np.arange(-terms, 1.0)
    centres = edges[1:] * fpenn.GAMMA**-0.5
    length = 1 / float(centres[0])
    pivot = band.law.pivot
    tilt = 1 - band.law.slope

    def turned(f: Array) -> Array:
        """The coordinate in which the power of the fitted law grows evenly."""
        return np.log(f) if abs(tilt) < 1e-3 else np.asarray((f / pivot) ** tilt / tilt)

    def solve(clean: Array) -> tuple[float, float]:
        held = np.concatenate([[0.0], np.cumsum(clean * band.width)])
        power = np.diff(np.interp(turned(edges), turned(ends), held))
        m0, m2, m4 = (float(np.sum(power * (2 * pi * centres) ** (2 * k))) for k in range(3))
        if min(m0, m2, m4) <= 0:
            raise NotConverged("the spectral moments of the band are not positive once the noise is taken out")
        D, G = fpenn.from_series_moments(m0, m2, m4, length=length, terms=terms)
        slope = 7 - 2 * D
        if not (2.01 < D < 2.99 and G > 0):
            raise NotConverged(f"the network finds D = {D:.3f}, outside the range it was trained for")
        # a term holds B f^(1-slope) times the integral of u^-slope over a factor gamma, not times ln(gamma)
        e = (1 - slope) * log(fpenn.GAMMA) / 2
        level = (2 * D - 4) * log(G) - log(2) - log(float(np.sinh(e) / e))
        return slope, level - slope * log(pivot)

    return _through_draws(ready, band, c, solve, known.rms_D)
