"""The estimators behind `fit_fractal` that rest on a fitted law: spectrum, structure function, moments of the band."""

from dataclasses import dataclass
from math import log, pi
from typing import final

import numpy as np

from faying.errors import FayingError, NotConverged
from faying.surface.convention import G_from_density, structure_coefficient
from faying.surface.form import Mask, Prepared
from faying.surface.moments import invert_ratio
from faying.surface.powerlaw import PowerLaw, fit_band, smearing, supported_band
from faying.surface.scan import Array, Profile, Scan
from faying.surface.spectrum import Spectrum, spectrum, structure_function

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
    s = spectrum(ready.scan)
    if limits is not None:
        law, notes = fit_band(s, 1 / limits[1], 1 / limits[0], fixed=True)
    else:
        law, notes = fit_band(s, *supported_band(s, resolution=ready.scan.instrument.resolution))
    return s, law, notes


def white_rms(ready: Prepared, noise: float) -> float:
    """Rms height [m] of a white level of the two-sided density."""
    steps = ready.scan.spacing if isinstance(ready.scan, Scan) else (ready.scan.spacing,)
    return float((max(noise, 0.0) / float(np.prod(steps))) ** 0.5)


def by_psd(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Fit a power law with a white term to the spectrum averaged over directions (see `powerlaw`)."""
    _, law, notes = _spectral_fit(ready, limits)
    turn = np.array([[1.0, 0.0], [0.0, -0.5]])  # (ln S, slope) -> (ln S, D), D = (7 - slope)/2
    return with_intervals(
        (7 - law.slope) / 2,
        law.log_level,
        turn @ law.covariance[:2, :2] @ turn.T,
        law.pivot,
        c,
        band=(1 / float(law.used[-1]), 1 / float(law.used[0])),
        noise=white_rms(ready, law.noise),
        misfit=law.misfit,
        notes=notes,
    )


def by_moments(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Take m2/m0 of the band (white part and window smearing removed) and solve for D, as the ideal series' map does.

    The moments are sums over bins, m_2k = (2 pi)^(2k) sum (S - white) f^(2k) df; G follows from m2, the better known
    of the two. Intervals by drawing the bins from their gamma law and repeating the inversion.
    """
    s, law, notes = _spectral_fit(ready, limits)
    use = (s.frequency >= law.used[0] * 0.999999) & (s.frequency <= law.used[-1] * 1.000001) & (s.density > 0)
    f, width = s.frequency[use], s.width[use] * s.lowest
    shape = 2 * pi * f if s.axes == 2 else np.full(len(f), 2.0)
    smear = smearing(s, f, law.slope)[0]
    spread = s.spread[use] * max(1.0, law.misfit) ** 0.5

    def solve(density: Array, noise: float) -> tuple[float, float]:
        clean = (density - noise * shape) / smear
        m0, m2 = float(np.sum(clean * width)), float(np.sum(clean * f**2 * width))
        if m0 <= 0 or m2 <= 0:
            raise NotConverged("the spectral moments of the band are not positive once the noise is taken out")
        slope = invert_ratio(m2 / m0, 2.0, f, width)
        return slope, log(m2) - log(float(np.sum((f / law.pivot) ** -slope * f**2 * width)))

    slope, log_level = solve(s.density[use], law.noise)
    rng = np.random.default_rng(2024)
    draws = []
    expected = law.expected
    for _ in range(200):
        fake = expected * rng.gamma(1 / spread**2, spread**2)
        # the white level of each draw from the same weights as the fit's: its linear response to the bins
        noise = law.noise + float(law.response[2] @ (fake / expected - 1))
        try:
            draws.append(solve(fake, noise))
        except FayingError:
            continue
    if len(draws) < 150:
        raise NotConverged("the moments of this band do not fix D: most draws within their error have no solution")
    cloud = np.array(draws)
    centre = solve(expected, law.noise)
    bias = cloud.mean(axis=0) - np.array(centre)
    slope, log_level = slope - bias[0], log_level - bias[1]
    turned = np.stack([cloud[:, 1], -cloud[:, 0] / 2])
    return with_intervals(
        (7 - slope) / 2,
        log_level,
        np.cov(turned),
        law.pivot,
        c,
        band=(1 / float(f[-1]), 1 / float(f[0])),
        noise=white_rms(ready, law.noise),
        misfit=law.misfit,
        notes=notes,
    )


def _fit_structure(lag: Array, value: Array, weight: Array) -> tuple[float, float, float]:
    """Fit value = exp(a) (lag/l0)^s + nugget in relative terms; returns (s, a, nugget/exp(a)), l0 the geometric mean."""
    from scipy.optimize import least_squares

    x = np.log(lag) - np.mean(np.log(lag))
    line = np.polyfit(x, np.log(value), 1)
    start = np.array([min(max(line[0], 0.05), 1.95), line[1], 0.0])

    def residual(t: Array) -> Array:
        model = np.exp(t[1]) * (np.exp(t[0] * x) + t[2])
        return np.asarray(weight * (np.log(np.maximum(model, 1e-300)) - np.log(value)))

    bounds = ([0.01, -np.inf, -20.0], [1.999, np.inf, 50.0])
    found = least_squares(residual, start, bounds=bounds, x_scale=[0.1, 0.1, 0.05])
    return float(found.x[0]), float(found.x[1]), float(found.x[2])


def _tiles(ready: Prepared) -> list[tuple[Array, Mask]]:
    """Cut a scan into 3 x 3 parts, a profile into 8, for the spread of an estimate between parts: (heights, known)."""
    z, known = ready.scan.heights, ready.known
    if z.ndim == 1:
        return list(zip(np.array_split(z, 8), np.array_split(known, 8), strict=True))
    out = []
    for rows, krows in zip(np.array_split(z, 3), np.array_split(known, 3), strict=True):
        out += list(zip(np.array_split(rows, 3, axis=1), np.array_split(krows, 3, axis=1), strict=True))
    return out


def by_structure(ready: Prepared, limits: Limits, c: float) -> Estimate:
    """Fit SF = B lag^(6-2D) + constant to the structure function, each lag vector counting alike.

    The constant is twice the variance of white noise, less twice the power of the wavelengths that the points cannot
    hold (they lower the structure function at every lag alike), so it may be negative.

    Band: from 3 spacings to 1/16 of the shortest side. The interval is from the spread between parts of the scan
    (3 x 3, or 8 of a profile), Student's t.
    """
    from scipy.stats import t as student

    scan = ready.scan
    spacing = scan.spacing if isinstance(scan, Profile) else max(scan.spacing)
    side = scan.length if isinstance(scan, Profile) else min(scan.size)
    low, high = limits if limits is not None else (3 * spacing, side / 16)
    # an instrument's resolution bounds the wavelengths; a lag of half of it is the shortest one that means anything
    if limits is None and scan.instrument.resolution:
        low = max(low, scan.instrument.resolution)

    def one(part: Scan | Profile, known: Mask) -> tuple[float, float, float, Array]:
        sf = structure_function(part, known=known, longest=min(0.5, high / _side(part)))
        use = (sf.lag >= low) & (sf.lag <= high) & (sf.value > 0)
        if use.sum() < 4:
            raise NotConverged(f"only {int(use.sum())} lags between {low:.3g} and {high:.3g} m; give a wider band")
        lag = sf.lag[use]
        s, a, nugget = _fit_structure(lag, sf.value[use], 1 / lag**0.25)
        return s, a - s * float(np.mean(np.log(lag))), nugget * np.exp(a), lag

    s, level, nugget, lag = one(scan, ready.known)
    spots = []
    for z, known in _tiles(ready):
        try:
            part: Scan | Profile = scan.with_heights(z)
            spots.append(one(part, known)[:2])
        except FayingError:
            continue
    if len(spots) < 4:
        raise NotConverged("the scan is too small for an interval of the structure function; use method psd")
    pivot_lag = float(np.exp(np.mean(np.log(lag))))
    cloud = np.array([(lv + sl * log(pivot_lag), 3 - sl / 2) for sl, lv in spots])
    widen = (float(student.ppf(0.975, len(spots) - 1)) / Z95) ** 2
    D = 3 - s / 2
    # ln SF(pivot) -> ln S at the frequency 1/pivot: SF = 2 B k(D) lag^(6-2D), B = S f^(7-2D)
    f = 1 / pivot_lag

    def to_density(d: float, log_sf: float) -> float:
        k = structure_coefficient(d) * 2
        return log_sf - log(k) - (6 - 2 * d) * log(pivot_lag) - (7 - 2 * d) * log(f)

    centre = to_density(D, level + s * log(pivot_lag))
    moved = np.array([(to_density(min(max(d, 1.55), 2.99), v), d) for v, d in cloud])
    return with_intervals(
        D,
        centre,
        np.cov(moved.T) / len(spots) * widen,
        f,
        c,
        band=(float(lag[0]), float(lag[-1])),
        noise=(max(nugget, 0.0) / 2) ** 0.5,
    )


def _side(scan: Scan | Profile) -> float:
    return scan.length if isinstance(scan, Profile) else min(scan.size)
