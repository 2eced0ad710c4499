"""D and G of a scan or profile by several estimators, each with an interval and the band it used."""

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from faying.errors import FayingError, InputError
from faying.surface.convention import NAMES, cut_factor, implied_Rq, prefactor
from faying.surface.estimate import Estimate, by_moments, by_psd, by_structure
from faying.surface.form import Prepared, prepared
from faying.surface.roughness import roughness
from faying.surface.scan import Profile, Scan

ESTIMATORS = {"psd": by_psd, "structure": by_structure, "moments": by_moments}
METHODS = tuple(ESTIMATORS)


@final
@dataclass(frozen=True, kw_only=True)
class FractalFit:
    """What one estimator says of a surface.

    `D` is the dimension of the surface (2 < D < 3), `G` the fractal roughness [m] in the convention that `convention`
    states; `D_interval` and `G_interval` [m] are 95 % intervals. `band` is the shortest and the longest wavelength
    used [m]. `Rq` and `Ra` [m] are the scan's own after levelling, `implied_Rq` and `implied_Ra` [m] what D and G say
    of all wavelengths up to the side of the scan (Ra for Gaussian heights). `noise` [m] is the rms of the white part
    found, `misfit` the mean squared residual over its expectation (1 for a true power law). `missing` and `spikes`
    count the points that were filled in. `warnings` says what the user ought to know.
    """

    method: str
    D: float
    G: float
    D_interval: tuple[float, float]
    G_interval: tuple[float, float]
    band: tuple[float, float]
    Rq: float
    Ra: float
    implied_Rq: float
    convention: str
    noise: float
    misfit: float
    missing: int
    spikes: int
    warnings: tuple[str, ...] = ()

    @property
    def implied_Ra(self) -> float:
        """Mean absolute height [m] of Gaussian heights of rms `implied_Rq`: (2/pi)^(1/2) of it."""
        return float(self.implied_Rq * (2 / np.pi) ** 0.5)


def fit_fractal(
    scan: Scan | Profile,
    method: str = "psd",
    *,
    band: tuple[float, float] | None = None,
    degree: int = 1,
    spikes: bool = True,
    convention: str = "yan-komvopoulos",
    gamma: float = 1.5,
) -> FractalFit:
    """Estimate D and G of a scan (or a profile) with 95 % intervals.

    `method`: "psd" (power law with white noise fitted to the spectrum; the recommended one), "structure" (structure
    function), "moments" (the ratio of the spectral moments m2 and m0 over the band).
    `band` = (shortest, longest) wavelength [m] to use instead of what the data support. The heights are levelled by a
    polynomial of `degree`, spikes are taken out unless spikes=False, missing points filled in.
    `convention` is "yan-komvopoulos" (the JK model's, c = 1) or "majumdar-bhushan" (c = 1/ln gamma). For a scan G is
    that of the surface: the power of all directions together. For a profile it is the profile's own, as if cut across
    parallel ridges; `convention` states the factor for a cut from an isotropic surface.
    Raises InputError for unknown methods, bands outside the scan, and heights that carry no statistic.
    """
    if not isinstance(scan, (Scan, Profile)):
        raise InputError(f"fit_fractal needs a Scan or a Profile, not {type(scan).__name__}; build faying.Scan first")
    if method not in ESTIMATORS:
        raise InputError(f"method = {method!r}; allowed: {', '.join(METHODS)}")
    c = prefactor(convention, gamma)
    ready = prepared(scan, degree=degree, spikes=spikes)
    limits = _limits(ready, band)
    try:
        estimate = ESTIMATORS[method](ready, limits, c)
    except FayingError:
        raise
    except (np.linalg.LinAlgError, FloatingPointError, ValueError, ZeroDivisionError, OverflowError) as fault:
        raise InputError(f"{scan.source}: the heights obey no power law that {method} can fit ({fault})") from fault
    return _result(ready, estimate, method, convention, gamma)


def _limits(ready: Prepared, band: tuple[float, float] | None) -> tuple[float, float] | None:
    if band is None:
        return None
    scan = ready.scan
    longest = scan.length if isinstance(scan, Profile) else min(scan.size)
    shortest = 2 * (scan.spacing if isinstance(scan, Profile) else max(scan.spacing))
    low, high = float(min(band)), float(max(band))
    if not (shortest * (1 - 1e-9) <= low < high <= longest * (1 + 1e-9)):
        raise InputError(
            f"band = {band}: wavelengths in metres between twice the spacing, {shortest:.4g}, and the side, {longest:.4g}"
        )
    return low, high


def _result(ready: Prepared, e: Estimate, method: str, convention: str, gamma: float) -> FractalFit:
    scan = ready.scan
    rough = roughness(ready)
    c = prefactor(convention, gamma)
    length = scan.length if isinstance(scan, Profile) else float(np.prod(scan.size)) ** 0.5
    implied = implied_Rq(e.D, e.G, length, c) if 2 < e.D < 3 and 0 < e.G < float("inf") else float("nan")
    words = list(e.notes)
    if not 2 < e.D < 3:
        words.append(
            f"D = {e.D:.3f} lies outside 2 .. 3: over this band the surface is not fractal, so G means nothing"
        )
    elif not 2.1 <= e.D <= 2.9:
        words.append(f"D = {e.D:.3f} lies outside 2.1 .. 2.9, where G is very uncertain and the JK model is unproven")
    if e.misfit > 3:
        words.append(f"the spectrum strays from a power law (misfit {e.misfit:.1f}); the intervals are widened for it")
    if implied > 0 and not 0.5 < implied / rough.Rq < 2:
        words.append(
            f"D and G imply Rq {implied:.3g} m over the scan's side, the scan's own is {rough.Rq:.3g} m: the law does "
            "not hold up to that length"
        )
    if convention == NAMES[0]:
        text = "Yan-Komvopoulos (JK), c = 1"
    else:
        text = f"Majumdar-Bhushan, c = 1/ln(gamma) = {c:.4f}"
    text += "; S(f) = c G^(2Ds-2)/2 f^-(5-2Ds), D = Ds + 1"
    if isinstance(scan, Profile):
        text += "; G of the profile itself"
        if 2 < e.D < 3:
            factor = cut_factor(e.D) ** (-1 / (2 * e.D - 4))
            text += f" (times {factor:.3f} for the isotropic surface it is cut from, cut factor {cut_factor(e.D):.3f})"
    else:
        text += "; G of the surface, power summed over all directions"
        if 2 < e.D < 3:
            text += f" (a profile cut from it has {cut_factor(e.D):.3f} of its S)"
    return FractalFit(
        method=method,
        D=e.D,
        G=e.G,
        D_interval=e.D_interval,
        G_interval=e.G_interval,
        band=e.band,
        Rq=rough.Rq,
        Ra=rough.Ra,
        implied_Rq=implied,
        convention=text,
        noise=e.noise,
        misfit=e.misfit,
        missing=ready.missing,
        spikes=ready.spikes,
        warnings=tuple(words),
    )


def fit_all(scan: Scan | Profile, **options: Any) -> dict[str, FractalFit | str]:
    """Run every estimator; where one fails its error text stands in place of the fit. Options as in `fit_fractal`."""
    out: dict[str, FractalFit | str] = {}
    for method in METHODS:
        try:
            out[method] = fit_fractal(scan, method, **options)
        except FayingError as fault:
            out[method] = str(fault)
    return out
