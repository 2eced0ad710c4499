"""D and G of a scan or profile by several estimators, each with an interval and the band it used."""

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from faying.errors import FayingError, InputError
from faying.surface.convention import NAMES, check_dimension, cut_factor, implied_Rq, prefactor
from faying.surface.estimate import Estimate, by_fpenn, by_moments, by_psd
from faying.surface.form import Prepared, prepared
from faying.surface.roughness import roughness
from faying.surface.scaling import by_box, by_higuchi, by_mfdfa, by_roughness_length, by_structure
from faying.surface.scan import Profile, Scan

ESTIMATORS = {
    "psd": by_psd,
    "structure": by_structure,
    "roughness-length": by_roughness_length,
    "box": by_box,
    "higuchi": by_higuchi,
    "mfdfa": by_mfdfa,
    "moments": by_moments,
    "fpenn": by_fpenn,
}
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
    count the points that were filled in. `bias` is what a self-test took off D, None without one. `warnings` says
    what the user ought to know.
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
    bias: float | None = None
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
    self_test: bool = False,
) -> FractalFit:
    """Estimate D and G of a scan (or a profile) with 95 % intervals.

    `method`: "psd" (power law with white noise fitted to the spectrum; the recommended one), "moments" (ratio of the
    spectral moments m2 and m0 over the band), "fpenn" (the paper's network on moments), "structure" (structure
    function), "roughness-length", "higuchi", "mfdfa" (multifractal detrended fluctuation), "box" (box counting).
    `band` = (shortest, longest) wavelength [m] to use instead of what the data support. The heights are levelled by a
    polynomial of `degree`, spikes are taken out unless spikes=False, missing points filled in.
    `convention` is "yan-komvopoulos" (the JK model's, c = 1) or "majumdar-bhushan" (c = 1/ln gamma). For a scan G is
    that of the surface: the power of all directions together. For a profile it is the profile's own, as if cut across
    parallel ridges; `convention` states the factor for a cut from an isotropic surface.
    `self_test` corrects D and G by what the method makes of synthetic surfaces like this one; not with `band`.
    Raises InputError for unknown methods, bands outside the scan, and heights that carry no statistic.
    """
    if not isinstance(scan, (Scan, Profile)):
        raise InputError(f"fit_fractal needs a Scan or a Profile, not {type(scan).__name__}; build faying.Scan first")
    if method not in ESTIMATORS:
        raise InputError(f"method = {method!r}; allowed: {', '.join(METHODS)}")
    c = prefactor(convention, gamma)
    if self_test:
        from faying.surface import selftest

        if band is not None:
            raise InputError("self_test chooses the band itself; leave out band or self_test")
        return selftest.self_test(scan, method, degree=degree, spikes=spikes, convention=convention, gamma=gamma)
    ready = prepared(scan, degree=degree, spikes=spikes)
    limits = _limits(ready, band)
    try:
        estimate = ESTIMATORS[method](ready, limits, c)
    except FayingError:
        raise
    except (np.linalg.LinAlgError, FloatingPointError, ValueError, ZeroDivisionError, OverflowError) as fault:
        raise InputError(f"{scan.source}: the heights obey no power law that {method} can fit ({fault})") from fault
    rough = roughness(ready)
    return result(
        estimate,
        method=method,
        convention=convention,
        gamma=gamma,
        Rq=rough.Rq,
        Ra=rough.Ra,
        length=scan.length if isinstance(scan, Profile) else float(np.prod(scan.size)) ** 0.5,
        missing=ready.missing,
        spikes=ready.spikes,
        areal=isinstance(scan, Scan),
    )


def _limits(ready: Prepared, band: tuple[float, float] | None) -> tuple[float, float] | None:
    if band is None:
        return None
    scan = ready.scan
    longest = scan.length if isinstance(scan, Profile) else min(scan.size)
    shortest = 2 * (scan.spacing if isinstance(scan, Profile) else max(scan.spacing))
    low, high = float(min(band)), float(max(band))
    if not (shortest * (1 - 1e-9) <= low < high <= longest * (1 + 1e-9)):
        raise InputError(
            f"band = {band}: give wavelengths in metres between twice the spacing, {shortest:.4g}, and the side, "
            f"{longest:.4g}"
        )
    return low, high


def result(
    e: Estimate,
    *,
    method: str,
    convention: str,
    gamma: float,
    Rq: float,
    Ra: float,
    length: float,
    missing: int,
    spikes: int,
    areal: bool,
    bias: float | None = None,
) -> FractalFit:
    """Dress an estimate with what it implies over `length` [m], its convention in words, and its warnings."""
    c = prefactor(convention, gamma)
    sound = 2 < e.D < 3 and 0 < e.G < float("inf")
    implied = implied_Rq(e.D, e.G, length, c) if sound else float("nan")
    words = list(e.notes)
    if not 2 < e.D < 3:
        words.append(f"D = {e.D:.3f} lies outside 2 .. 3: over this band the surface is not fractal, G means nothing")
    elif not 2.1 <= e.D <= 2.9:
        words.append(f"D = {e.D:.3f} lies outside 2.1 .. 2.9, where G is very uncertain and the JK model is unproven")
    if e.misfit > 3:
        words.append(f"the spectrum strays from a power law (misfit {e.misfit:.1f}); the intervals are widened for it")
    words += consistency(e.D, e.G, Rq=Rq, length=length, c=c) if sound else []
    name = "Yan-Komvopoulos (JK), c = 1" if convention == NAMES[0] else f"Majumdar-Bhushan, c = 1/ln(gamma) = {c:.4f}"
    text = name + "; S(f) = c G^(2Ds-2)/2 f^-(5-2Ds), D = Ds + 1"
    text += "; G of the surface, power summed over all directions" if areal else "; G of the profile itself"
    if sound and areal:
        text += f" (a profile cut from it has {cut_factor(e.D):.3f} of its S)"
    elif sound:
        factor = cut_factor(e.D) ** (-1 / (2 * e.D - 4))
        text += f" (times {factor:.3f} for the isotropic surface it is cut from, cut factor {cut_factor(e.D):.3f})"
    return FractalFit(
        method=method,
        D=e.D,
        G=e.G,
        D_interval=e.D_interval,
        G_interval=e.G_interval,
        band=e.band,
        Rq=Rq,
        Ra=Ra,
        implied_Rq=implied,
        convention=text,
        noise=e.noise,
        misfit=e.misfit,
        missing=missing,
        spikes=spikes,
        bias=bias,
        warnings=tuple(words),
    )


def consistency(D: float, G: float, *, Rq: float, length: float, c: float = 1.0) -> list[str]:
    """Say in words where D and G [m] imply another rms height over `length` [m] than the measured `Rq` [m].

    A factor of 2 either way passes: the longest waves, which hold most of the power, differ that much by chance.
    """
    implied = implied_Rq(check_dimension(D), G, length, c)
    if 0.5 < implied / Rq < 2:
        return []
    return [
        f"D and G imply Rq {implied:.3g} m over {length:.3g} m, the surface's own is {Rq:.3g} m: they do not belong "
        "together, or the law does not hold up to that length"
    ]


def fit_all(scan: Scan | Profile, **options: Any) -> dict[str, FractalFit | str]:
    """Run every estimator; where one fails its error text stands in place of the fit. Options as in `fit_fractal`."""
    out: dict[str, FractalFit | str] = {}
    for method in METHODS:
        try:
            out[method] = fit_fractal(scan, method, **options)
        except FayingError as fault:
            out[method] = str(fault)
    return out
