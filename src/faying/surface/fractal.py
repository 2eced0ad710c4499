"""D and G of a scan or profile by several estimators, each with an interval and the band it used."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from faying.checks import choice, flag, instance, several
from faying.errors import FayingError, InputError
from faying.surface.convention import prefactor
from faying.surface.estimators.base import Estimate
from faying.surface.estimators.table import ESTIMATORS, METHODS
from faying.surface.form import Prepared, prepared
from faying.surface.fractal_fit import Facts, FractalFit, result
from faying.surface.heights import AreaHeights, LineHeights, sides_of, steps_of


def fit_fractal(
    scan: AreaHeights | LineHeights,
    method: str = "psd",
    *,
    band: tuple[float, float] | tuple[str, str] | None = None,
    degree: int = 1,
    spikes: bool = True,
    convention: str = "yan-komvopoulos",
    gamma: float = 1.5,
) -> FractalFit:
    """Estimate the fractal dimension D and the fractal roughness G of a scan or profile, with 95 % intervals.

    Args:
        scan: heights [m] with their spacing; levelled, freed of spikes and filled in before the fit.
        method: "psd" (power law with white noise fitted to the spectrum; recommended) or "structure" (structure
            function).
        band: shortest and longest wavelength to use instead of what the data support, from twice the spacing to the
            side; [m], or text with a unit.
        degree: of the polynomial that levels the heights, 0 to 8.
        spikes: take single outlying points out.
        convention: "yan-komvopoulos" (that of the JK model, c = 1) or "majumdar-bhushan" (c = 1/ln gamma).
        gamma: ratio of neighbouring frequencies in that series, above 1.

    Returns:
        FractalFit. For a scan G is that of the surface, the power of all directions together. For a profile G is the
        profile's own; `FractalFit.convention` states the factor for a cut from an isotropic surface.

    Raises:
        InputError: for unknown methods, bands outside the scan, and heights that carry no statistic.
        NotConverged: where the method finds no power law.

    Source:
        Yan and Komvopoulos 1998, doi:10.1063/1.368536, eq. (5), for the meaning of D and G.
    """
    instance(scan, AreaHeights | LineHeights, "scan", "give a Scan or a Profile, as faying.read_scan returns it")
    choice(method, "method", METHODS)
    prefactor(convention, gamma)
    flag(spikes, "spikes")
    ready = prepared(scan, degree=degree, spikes=spikes)
    estimate = _estimated(ready, method, _limits(ready, band), prefactor(convention, gamma))
    return result(estimate, Facts.of(scan, ready), method=method, convention=convention, gamma=gamma, drawn=ready.scan)


def _estimated(ready: Prepared, method: str, limits: tuple[float, float] | None, c: float) -> Estimate:
    try:
        return ESTIMATORS[method].estimate(ready, limits, c)
    except FayingError:
        raise
    except (np.linalg.LinAlgError, FloatingPointError, ValueError, ZeroDivisionError, OverflowError) as fault:
        raise InputError(
            f"{ready.scan.source}: the heights obey no power law that {method} can fit ({fault})"
        ) from fault


def _limits(ready: Prepared, band: object) -> tuple[float, float] | None:
    if band is None:
        return None
    scan = ready.scan
    longest, shortest = min(sides_of(scan)), 2 * max(steps_of(scan))
    low, high = sorted(several(band, "band", 2, "m", least=0))
    if not (shortest * (1 - 1e-9) <= low < high <= longest * (1 + 1e-9)):
        raise InputError(
            f"band = ({low:.4g}, {high:.4g}): give wavelengths in metres between twice the spacing, "
            f"{shortest:.4g}, and the side, {longest:.4g}"
        )
    return low, high


def fit_all(
    scan: AreaHeights | LineHeights, *, methods: Iterable[str] = tuple(METHODS), **options: Any
) -> dict[str, FractalFit | str]:
    """Run estimators with options of `fit_fractal`; where one fails its error text stands in place of the fit."""
    out: dict[str, FractalFit | str] = {}
    for method in methods:
        try:
            out[method] = fit_fractal(scan, method, **options)
        except FayingError as fault:
            out[method] = str(fault)
    return out
