"""Self-test: an estimator run on surfaces of known D and G made like the scan, its bias taken off."""

from math import log
from typing import Any

import numpy as np

from faying.errors import FayingError, NotConverged
from faying.surface.convention import prefactor
from faying.surface.estimators.base import Z95, with_intervals
from faying.surface.form import prepared
from faying.surface.fractal_fit import Facts, FractalFit, plain_fit, result
from faying.surface.heights import AreaHeights, LineHeights
from faying.surface.lay import find_lay
from faying.surface.synthesis import spectral_heights, with_missing, with_noise
from faying.typing import Array

LARGEST = 1024  # points a side of the synthetic surfaces; larger scans are tested at this size


def stretch_of(strength: float, D: float) -> float:
    """Return the stretch of `synthesize.spectral` whose lay has this strength (1 for none, 50 at most)."""
    from scipy.optimize import brentq

    theta = (np.arange(2000) + 0.5) * np.pi / 2000

    def excess(log_stretch: float) -> float:
        s = np.exp(log_stretch)
        g = (s * np.cos(theta) ** 2 + np.sin(theta) ** 2 / s) ** (D - 4)
        return float(abs(np.sum(g * np.cos(2 * theta))) / np.sum(g)) - strength

    if excess(log(50.0)) <= 0:
        return 50.0
    return float(np.exp(brentq(excess, 0.0, log(50.0)))) if strength > 1e-6 else 1.0


def self_test(
    scan: AreaHeights | LineHeights,
    method: str,
    *,
    rounds: int = 24,
    degree: int = 1,
    spikes: bool = True,
    convention: str = "yan-komvopoulos",
    gamma: float = 1.5,
) -> FractalFit:
    """Fit D and G by `method`, corrected by what the method makes of synthetic surfaces like this one.

    `rounds` Gaussian surfaces of the same size, spacing, lay, noise and share of missing points are made at three D
    around that of the spectrum; a straight line of found over true D turns the scan's own value into the corrected D,
    and the scatter about it gives the 95 % interval (Student's t). G follows from the corrected level. Scans of more
    than 1024 points a side are tested at 1024, the scatter scaled by the side.
    Raises InputError as `fit_fractal` does, NotConverged where the method answers no longer to D or fails on the
    synthetic surfaces.
    """
    options: dict[str, Any] = {"degree": degree, "spikes": spikes, "convention": convention, "gamma": gamma}
    raw = plain_fit(scan, method, **options)
    base = raw if method == "psd" else plain_fit(scan, "psd", **options)
    c = prefactor(convention, gamma)
    centre = min(max(base.D, 2.2), 2.8)
    pivot = (raw.band[0] * raw.band[1]) ** -0.5
    trials = np.clip(np.array([centre - 0.15, centre, centre + 0.15]), 2.03, 2.97)
    level = _log_density(base, pivot, c) if np.isfinite(_log_density(base, pivot, c)) else log(raw.Rq**2 / pivot)
    rng = np.random.default_rng(0)
    rows = []
    for k in range(rounds):
        D = float(trials[k % 3])
        G = float(np.exp((level + (7 - 2 * D) * log(pivot) + log(2 / c)) / (2 * D - 4)))
        fake = _like(scan, D, G, base, rng, convention, gamma)
        try:
            fit = plain_fit(fake, method, **options)
        except FayingError:
            continue
        rows.append((D, fit.D, _log_density(fit, pivot, c) - level))
    if len(rows) < max(9, rounds // 2):
        raise NotConverged(f"{method} failed on {rounds - len(rows)} of {rounds} synthetic surfaces like this scan")
    return _corrected(scan, raw, np.array(rows), pivot, options)


def _log_density(fit: FractalFit, f: float, c: float) -> float:
    """ln S(f) of a fit."""
    if not 0 < fit.G < float("inf"):
        return float("-inf")
    return (2 * fit.D - 4) * log(fit.G) + log(c / 2) - (7 - 2 * fit.D) * log(f)


def _like(
    scan: AreaHeights | LineHeights,
    D: float,
    G: float,
    base: FractalFit,
    rng: np.random.Generator,
    convention: str,
    gamma: float,
) -> AreaHeights | LineHeights:
    counts = tuple(min(n, LARGEST) for n in scan.heights.shape)
    share = scan.missing / scan.heights.size
    common: dict[str, Any] = {"D": D, "G": G, "convention": convention, "gamma": gamma, "seed": rng}
    if isinstance(scan, LineHeights):
        line, steps, source = spectral_heights(counts[0], spacing=scan.spacing, **common)
        return LineHeights(heights=line, spacing=steps[0], source=source)
    lay = find_lay(scan)
    stretch = (lay.angle, stretch_of(lay.strength, D)) if lay.present else None
    z, _, source = spectral_heights((counts[0], counts[1]), spacing=scan.spacing, lay=stretch, **common)
    made = AreaHeights(heights=z, spacing=scan.spacing, source=source)
    if base.noise > 0:
        made = with_noise(made, rms=base.noise, seed=int(rng.integers(2**31)))
    return with_missing(made, share=share, seed=int(rng.integers(2**31))) if share > 0 else made


def _corrected(
    scan: AreaHeights | LineHeights, raw: FractalFit, rows: Array, pivot: float, options: dict[str, Any]
) -> FractalFit:
    from scipy.stats import t as student

    c = prefactor(options["convention"], options["gamma"])
    gain, offset = (float(v) for v in np.polyfit(rows[:, 0], rows[:, 1], 1))
    if gain < 0.2:
        raise NotConverged(f"{raw.method} hardly answers to D on surfaces like this scan (gain {gain:.2f}); use psd")
    D = (raw.D - offset) / gain
    residual = (rows[:, 1] - offset - gain * rows[:, 0]) / gain
    # where the found D leaves 2 .. 3 there is no G, hence no level
    sound = np.isfinite(rows[:, 2])
    if sound.sum() < 6 or not np.isfinite(_log_density(raw, pivot, c)):
        raise NotConverged(f"{raw.method} finds no G on surfaces like this scan; use psd")
    shift = float(rows[sound, 2].mean())
    free = len(rows) - 2
    covariance = np.cov(np.stack([rows[sound, 2], residual[sound]])) * (sound.sum() - 1) / (sound.sum() - 2)
    covariance[1, 1] = float(residual @ residual) / free
    size = max(scan.heights.shape)
    scale = min(1.0, LARGEST / size)
    middle = float(rows[:, 0].mean())
    leverage = 1 / len(rows) + (D - middle) ** 2 / float(np.sum((rows[:, 0] - middle) ** 2))
    widen = (float(student.ppf(0.975, free)) / Z95) ** 2 * (scale**2 + leverage)
    level = _log_density(raw, pivot, c) - shift
    facts = Facts.of(scan, prepared(scan, degree=options["degree"], spikes=options["spikes"]))
    estimate = with_intervals(
        D,
        level,
        covariance * widen,
        pivot,
        c,
        band=raw.band,
        noise=raw.noise,
        misfit=raw.misfit,
        notes=(f"self-test on {len(rows)} synthetic surfaces: found D = {offset:.3f} + {gain:.3f} true D",),
    )
    return result(
        estimate,
        facts,
        method=raw.method,
        convention=options["convention"],
        gamma=options["gamma"],
        bias=raw.D - D,
        drawn=raw.drawn,
    )
