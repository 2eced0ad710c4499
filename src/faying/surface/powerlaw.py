"""Fitting a power law with a white term to a binned power spectrum, with its uncertainty.

The expected periodogram is  mu = A (f/f0)^-p (1 + w(p)/f^2) + N.  The bracket is the smearing of a power law by the
Hann window: half the second moment of its spectral kernel, 1/(3 L^2) along each axis, times the second derivative.
N takes up instrument noise, what aliasing folds back, and the error of filled-in points, so it may be of either sign.
The bins' means follow a gamma law; maximising its quasi-likelihood (Whittle's approximation) is done by Fisher scoring.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import final

import numpy as np

from faying.errors import NotConverged
from faying.surface.spectrum import Spectrum, white_shape
from faying.typing import Array, Mask
from faying.units import show

LINES = 8.0  # misfit and
GAPS = 0.8  # rms of ln(density) about a parabola above which a spectrum is taken as one of separate lines
VAGUE = 0.5  # standard error of D above which a fit says nothing of the slope
BREADTH = 0.35  # standard deviation of the smoothing over ln(frequency); wide against ln(1.5), the usual line distance


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class FittedPowerLaw:
    """density = exp(log_level) (f/pivot)^-slope + noise term; `covariance` is of (log_level, slope, noise/level).

    `density` is that of Spectrum; `slope` is its slope (5 - 2Ds), one less than that of the areal density.
    `noise` [m4 for a scan, m3 for a profile] is the white level of the two-sided density. `misfit` is the mean
    squared residual over its expected value; the covariance is multiplied by it where it exceeds 1.
    `used` [1/m] and `expected` [m3] are the bins' frequencies and fitted densities.
    """

    log_level: float
    slope: float
    noise: float
    pivot: float
    covariance: Array
    misfit: float
    used: Array
    expected: Array


def smearing(spectrum: Spectrum, frequency: Array, slope: float) -> tuple[Array, Array]:
    """Return the window's smearing (1 + w/f^2) [-] and its derivative with respect to the slope."""
    axes = spectrum.axes
    # kernel variance 1/(3 L^2) per axis; a scan: p^2/12 (1/Lx^2 + 1/Ly^2), p = slope + 1; a profile: b(b+1)/(6 L^2)
    x = spectrum.curvature / (6 * frequency**2)
    if axes == 2:
        return 1 + (slope + 1) ** 2 * x, 2 * (slope + 1) * x
    return 1 + slope * (slope + 1) * x, (2 * slope + 1) * x


FEWEST_BINS = 5  # two more than the three numbers of a power law with noise


def _check_bins(frequency: Array, low: float, high: float) -> None:
    """Raise NotConverged where too few bins of frequency [1/m] are in a band."""
    if len(frequency) < FEWEST_BINS:
        raise NotConverged(
            f"the band of waves from {show(1 / high, 'm')} to {show(1 / low, 'm')} has {len(frequency)} bins of "
            f"frequency, and a power law needs {FEWEST_BINS}; widen it, or scan a longer piece, or more finely"
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Bins:
    """The bins of one fit: frequency, ln(f/pivot), two-sided density y (white noise is flat in it), weight."""

    spectrum: Spectrum
    f: Array
    x: Array
    y: Array
    weight: Array
    pivot: float

    @classmethod
    def of(cls, spectrum: Spectrum, low: float, high: float) -> "_Bins":
        use = (spectrum.frequency >= low) & (spectrum.frequency <= high) & (spectrum.density > 0)
        f = spectrum.frequency[use]
        _check_bins(f, low, high)
        weight = 1 / spectrum.spread[use] ** 2
        pivot = float(np.exp(np.average(np.log(f), weights=weight)))
        return cls(
            spectrum=spectrum,
            f=f,
            x=np.log(f / pivot),
            y=spectrum.density[use] / white_shape(f, spectrum.axes),
            weight=weight,
            pivot=pivot,
        )

    @property
    def extra(self) -> float:
        """What the areal density falls by more than the radial one."""
        return self.spectrum.axes - 1.0

    def start(self) -> Array:
        """A weighted straight line in the logarithm: ln level, slope, noise/level."""
        w = np.minimum(self.weight, np.median(self.weight)) ** 0.5
        line = np.polyfit(self.x, np.log(self.y), 1, w=w)
        return np.array([line[1], max(-line[0] - self.extra, 0.2), 0.0])

    def model(self, t: Array) -> tuple[Array, Array, Array]:
        """Expected density, its derivatives (bins, 3), and the power law alone."""
        smear, dsmear = smearing(self.spectrum, self.f, t[1])
        power = np.exp(t[0] - (t[1] + self.extra) * self.x)
        level = np.exp(t[0])
        mu = power * smear + t[2] * level
        return mu, np.stack([mu, power * (dsmear - smear * self.x), np.full(len(self.f), level)], axis=1), power

    def scoring(self, t: Array, free: Mask) -> tuple[Array, Array, Array]:
        """Expected density, relative derivatives by the free parameters, and their Fisher matrix."""
        mu, jac, _ = self.model(t)
        scaled = (jac / mu[:, None])[:, free]
        return mu, scaled, scaled.T @ (self.weight[:, None] * scaled)


def _scored(bins: _Bins, free: Mask) -> Array:
    """Maximise the quasi-likelihood by Fisher scoring with step halving; NotConverged where no step can begin."""
    theta = bins.start()

    def objective(t: Array) -> float:
        if abs(t[1]) > 20 or abs(t[0] - theta[0]) > 20:
            return float("inf")
        mu, _, power = bins.model(t)
        if (mu <= 0.02 * power).any():
            return float("inf")
        return float(np.sum(bins.weight * (np.log(mu) + bins.y / mu)))

    best = objective(theta)
    if not np.isfinite(best):
        raise NotConverged(
            f"the spectrum falls as the power {theta[1]:.3g} of the wavelength over this band: no power law"
        )
    for _ in range(200):
        mu, scaled, fisher = bins.scoring(theta, free)
        step = np.zeros(3)
        step[free] = np.linalg.lstsq(fisher, scaled.T @ (bins.weight * (bins.y / mu - 1)), rcond=1e-14)[0]
        length = 1.0
        while length > 1e-8:
            trial = theta + length * step
            value = objective(trial)
            if value <= best:
                break
            length /= 2
        else:
            break
        gain = best - value
        theta, best = trial, value
        if gain < 1e-9 * max(1.0, abs(best)) and np.all(np.abs(step) < 1e-8):
            break
    return theta


def fit(spectrum: Spectrum, low: float, high: float, *, white: bool = True) -> FittedPowerLaw:
    """Fit the bins with low <= frequency <= high [1/m]. NotConverged where the band holds too few bins or no law."""
    bins = _Bins.of(spectrum, low, high)
    free = np.array([True, True, white])
    theta = _scored(bins, free)
    mu, _, fisher = bins.scoring(theta, free)
    covariance = np.zeros((3, 3))
    covariance[np.ix_(free, free)] = np.linalg.pinv(fisher)
    misfit = float(np.sum(bins.weight * (bins.y / mu - 1) ** 2)) / max(len(bins.f) - int(free.sum()), 1)
    return FittedPowerLaw(
        log_level=float(theta[0]) + np.log(white_shape(bins.pivot, spectrum.axes)),
        slope=float(theta[1]),
        noise=float(theta[2] * np.exp(theta[0])),
        pivot=bins.pivot,
        covariance=covariance * max(1.0, misfit),
        misfit=misfit,
        used=bins.f,
        expected=mu * white_shape(bins.f, spectrum.axes),
    )


def _gaps(law: FittedPowerLaw, spectrum: Spectrum) -> float:
    """Rms of ln(density) about a parabola in ln(frequency): large for separate lines, small for any smooth spectrum."""
    use = (spectrum.frequency >= law.used[0]) & (spectrum.frequency <= law.used[-1]) & (spectrum.density > 0)
    x, y = np.log(spectrum.frequency[use]), np.log(spectrum.density[use])
    return float(np.std(y - np.polyval(np.polyfit(x, y, 2), x)))


def fit_lines(spectrum: Spectrum, low: float, high: float) -> FittedPowerLaw:
    """Fit a spectrum of separate lines, each line's power spread over a Gaussian in ln(frequency), without white term.

    The smoothing of a power law over the same bins serves as its model, so the ends need no correction. The covariance
    comes from the scatter of the smoothed residuals, with one independent residual per 2 pi^(1/2) BREADTH of ln f.
    """
    use = (spectrum.frequency >= low) & (spectrum.frequency <= high)
    f = spectrum.frequency[use]
    _check_bins(f, low, high)
    density, width = spectrum.density[use], spectrum.width[use]
    x = np.log(f)
    pivot = float(np.exp((x[0] + x[-1]) / 2))
    x = x - np.log(pivot)
    nodes = np.linspace(x[0], x[-1], 60)
    # f S weights the power of a decade of ln f alike for a flat f S; the slope's part is in the model
    kernel = np.exp(-0.5 * ((nodes[:, None] - x[None, :]) / BREADTH) ** 2)
    slope, level = 2.0, 0.0
    observed_power = density * width
    for _ in range(60):
        tilt = np.exp(slope * x)  # whitened: every line counts by its excess over the law
        smear = smearing(spectrum, f, slope)[0]
        observed = kernel @ (observed_power * tilt / smear / f)
        model = kernel @ (width / f)
        ratio = np.log(np.maximum(observed, 1e-300) / model)
        line = np.polyfit(nodes, ratio, 1)
        slope -= float(line[0])
        level = float(line[1])
        if abs(line[0]) < 1e-10:
            break
    residual = ratio - np.polyval(line, nodes)
    independent = max((x[-1] - x[0]) / (2 * np.pi**0.5 * BREADTH), 3.0)
    scatter = float(np.sum(residual**2)) / len(nodes) * independent / max(independent - 2, 1.0)
    design = np.stack([np.ones(len(nodes)), -nodes], axis=1)
    covariance = np.zeros((3, 3))
    covariance[:2, :2] = np.linalg.inv(design.T @ design) * scatter * len(nodes) / independent
    expected = np.exp(level - slope * x) * smearing(spectrum, f, slope)[0]
    return FittedPowerLaw(
        log_level=level,
        slope=slope,
        noise=0.0,
        pivot=pivot,
        covariance=covariance,
        misfit=max(1.0, scatter / float(np.mean(spectrum.spread[use] ** 2))),
        used=f,
        expected=expected,
    )


def supported_band(spectrum: Spectrum, *, resolution: float | None = None) -> tuple[float, float]:
    """Widest band of frequency [1/m] to start from: 6 cycles over the shortest side up to half the Nyquist frequency.

    Below it the levelling and the window distort the spectrum, above it aliasing, pixel averaging and filled-in points
    do. An instrument's `resolution` [m] lowers the upper end further.
    """
    high = 0.5 * spectrum.nyquist
    if resolution:
        high = min(high, 1 / resolution)
    low = 6 * spectrum.lowest
    if high <= low:
        raise NotConverged(
            f"the scan is too short for a spectrum: waves from {show(1 / high, 'm')} up can be resolved, and from "
            f"{show(1 / low, 'm')} up they are fewer than 6 on its shortest side; scan a longer piece, or more finely"
        )
    return low, high


def fit_band(
    spectrum: Spectrum, low: float, high: float, *, fixed: bool = False
) -> tuple[FittedPowerLaw, tuple[str, ...]]:
    """Fit the widest part of the band that a power law with noise describes; say in words what was cut.

    A band passes where its misfit is at most 1.6, its white term not significantly negative (blur), and its lowest
    octave not significantly off the law fitted above it (waviness, roll-off); significant is 3 standard errors. Bands
    are cut in steps of 2^(1/2) at either end, the widest tried first, down to a factor of 5. A plateau passes too, as
    long waves beyond a roll-off make one; it is taken only where no band above it passes, and the roll-off is where the
    two laws meet. Where no band passes the one of least misfit is taken, and a remark says so. A spectrum of separate
    lines goes to `fit_lines`.
    """
    law = fit(spectrum, low, high)
    if law.misfit > LINES and _gaps(law, spectrum) > GAPS:
        return fit_lines(spectrum, low / 2, high), (
            "the spectrum consists of lines (as a Weierstrass-Mandelbrot series)",
        )
    if fixed:
        return law, ()
    tried: list[tuple[FittedPowerLaw, float, float]] = []
    for law, bottom, top in _parts(spectrum, low, high):
        tried.append((law, bottom, top))
        if not _passes(spectrum, law, bottom, top):
            continue
        if _is_plateau(law):
            return _beyond(spectrum, tried[-1], low, high)
        return law, _cut_in_words(low, high, bottom, top)
    if not tried:
        return fit(spectrum, low, high), ("no part of the band obeys a power law",)
    law, bottom, top = min(tried, key=lambda entry: entry[0].misfit)
    return law, (
        *_cut_in_words(low, high, bottom, top),
        "no part of the band obeys a power law; the least bad one is used",
    )


def _parts(spectrum: Spectrum, low: float, high: float) -> Iterator[tuple[FittedPowerLaw, float, float]]:
    """Fit the whole band, then its parts, the widest first, down to a factor of 5; those that can be fitted."""
    for total in range(int(2 * np.log2(high / low) + 1e-9) + 1):
        for a in range(total + 1):
            bottom, top = low * 2 ** (a / 2), high / 2 ** ((total - a) / 2)
            if top >= 5 * bottom or total == 0:
                with suppress(NotConverged):
                    yield fit(spectrum, bottom, top), bottom, top


def _beyond(
    spectrum: Spectrum, plateau: tuple[FittedPowerLaw, float, float], low: float, high: float
) -> tuple[FittedPowerLaw, tuple[str, ...]]:
    """The law of the widest band beyond a plateau, or the plateau itself where no band there passes."""
    flat, start, end = plateau
    while start < end / 2:
        start *= 2**0.5
    for law, bottom, top in _parts(spectrum, start, high) if high >= 5 * start else ():
        if _passes(spectrum, law, bottom, top) and not _is_plateau(law):
            return law, (*_cut_in_words(low, high, bottom, top), *_roll_off_in_words(spectrum, flat, law))
    return flat, (
        *_cut_in_words(low, high, plateau[1], end),
        f"the waves of {1 / float(flat.used[-1]):.3g} .. {1 / float(flat.used[0]):.3g} m are a plateau of the spectrum "
        "and no band of shorter waves obeys a power law over a factor of 5: D and G mean nothing; measure with a finer "
        "spacing",
    )


def _is_plateau(law: FittedPowerLaw) -> bool:
    """Whether the density does not fall (D above 3), or its slope cannot be told from the white term."""
    return law.slope < 1 or float(law.covariance[1, 1]) ** 0.5 > 2 * VAGUE


def _roll_off_in_words(spectrum: Spectrum, plateau: FittedPowerLaw, law: FittedPowerLaw) -> tuple[str, ...]:
    """Where the law meets the mean level of the plateau, both as two-sided densities (areal for a scan)."""
    turn = spectrum.axes - 1
    level = float(np.mean(np.log(plateau.expected / plateau.used**turn)))
    corner = law.pivot * float(np.exp((law.log_level - turn * np.log(law.pivot) - level) / (law.slope + turn)))
    return (
        f"the spectrum is a plateau for waves longer than a roll-off at about {show(1 / corner, 'm', digits=3)}; "
        "D and G are those of the shorter waves",
    )


def _cut_in_words(low: float, high: float, bottom: float, top: float) -> tuple[str, ...]:
    short = (top, "below", "blur, noise or roll-off") if top < high * 0.999 else None
    long = (bottom, "above", "form, lay or roll-off") if bottom > low * 1.001 else None
    return tuple(
        f"wavelengths {side} {show(1 / end, 'm', digits=3)} do not follow the power law ({why}) and were excluded "
        "from D and G"
        for end, side, why in filter(None, (short, long))
    )


def _passes(spectrum: Spectrum, law: FittedPowerLaw, bottom: float, top: float) -> bool:
    level = np.exp(law.log_level) / white_shape(law.pivot, spectrum.axes)
    if law.misfit > 1.6 or law.noise / level < -3 * law.covariance[2, 2] ** 0.5:
        return False
    octave = (spectrum.frequency >= bottom) & (spectrum.frequency < 2 * bottom) & (spectrum.density > 0)
    if top < 5 * bottom or not octave.any():
        return True
    try:
        upper = fit(spectrum, 2 * bottom, top)
    except NotConverged:
        return True
    predicted, sigma = _predict(spectrum, upper, spectrum.frequency[octave])
    spread = spectrum.spread[octave] * max(1.0, upper.misfit) ** 0.5
    weight = 1 / spread**2
    excess = float(np.sum(weight * (spectrum.density[octave] / predicted - 1)) / weight.sum())
    return abs(excess) <= 3 * float((1 / weight.sum() + np.average(sigma**2, weights=weight)) ** 0.5)


def _predict(spectrum: Spectrum, law: FittedPowerLaw, f: Array) -> tuple[Array, Array]:
    """Expected density at f and the relative standard error of that extrapolation."""
    smear, dsmear = smearing(spectrum, f, law.slope)
    x = np.log(f / law.pivot)
    power = np.exp(law.log_level - law.slope * x)
    shape = white_shape(f, spectrum.axes)
    level = np.exp(law.log_level) / white_shape(law.pivot, spectrum.axes)
    mean = power * smear + law.noise * shape
    mean = np.maximum(mean, 0.02 * power)
    jac = np.stack([np.ones(len(f)), power * (dsmear - smear * x) / mean, level * shape / mean], axis=1)
    return mean, np.sqrt(np.einsum("ij,jk,ik->i", jac, law.covariance, jac))
