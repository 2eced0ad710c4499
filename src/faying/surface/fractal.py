"""D and G of a scan or profile by several estimators, each with an interval and the band it used."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, final

import numpy as np

from faying import units
from faying.checks import choice, flag, instance, number, shown
from faying.errors import FayingError, InputError
from faying.style import Summary
from faying.surface.convention import NAMES, check_dimension, cut_factor, implied_Rq, prefactor
from faying.surface.estimators.base import Estimate, EstimateScatter
from faying.surface.estimators.table import ESTIMATORS, METHODS
from faying.surface.form import Prepared, prepared
from faying.surface.roughness import roughness
from faying.surface.scan import Profile, Scan, sides_of, steps_of
from faying.surface.spectrum import Spectrum

if TYPE_CHECKING:
    import matplotlib.axes


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class FractalFit(Summary):
    """What one estimator says of a surface.

    Args:
        method: name of the estimator.
        D: dimension of the surface [-]; 2 < D < 3 where the surface is fractal.
        G: fractal roughness [m], in the convention that `convention` states.
        D_interval: 95 % interval [-].
        G_interval: 95 % interval [m].
        band: shortest and longest wavelength used [m].
        Rq: rms height of the levelled scan [m].
        Ra: mean absolute height of the levelled scan [m].
        implied_Rq: what D and G say of all wavelengths up to the side of the scan [m].
        convention: of D and G, in words.
        noise: rms of the white part found [m].
        misfit: mean squared residual over its expectation [-], 1 for a true power law.
        missing: missing points that were filled in.
        spikes: spikes that were filled in.
        bias: what a self-test took off D [-], None without one.
        warnings: what the user ought to know.
        scatter: of D and G together, where the estimator states their covariance.
        c: prefactor of the convention [-].
        areal: whether D and G are those of a scan; else G is that of the profile itself.
        drawn: what `plot` takes the spectrum from: the levelled heights, or the spectrum itself.
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
    scatter: EstimateScatter | None = None
    c: float = 1.0
    areal: bool = True
    drawn: Scan | Profile | Spectrum | None = field(default=None, compare=False)

    @property
    def surface_G(self) -> float:
        """G [m] of the surface: that of a scan itself; of a profile that of the isotropic surface it is cut from.

        The power of a profile is a part of that of its surface, the mean of |cos|^(6 - 2 D) over all directions, and
        G^(2 D - 4) goes with it. NaN where a profile has no D between 2 and 3.
        """
        if self.areal:
            return self.G
        return self.G * cut_factor(self.D) ** (-1 / (2 * self.D - 4)) if 2 < self.D < 3 else float("nan")

    @property
    def implied_Ra(self) -> float:
        """Mean absolute height [m] of Gaussian heights of rms `implied_Rq`: (2/pi)^(1/2) of it."""
        return float(self.implied_Rq * (2 / np.pi) ** 0.5)

    def summary(self) -> tuple[str, dict[str, str]]:
        """D and G with their intervals, the band, the rms heights, the convention, and what the user ought to know."""
        (low, high), (least, most) = self.D_interval, self.G_interval
        rms = "Sq" if self.areal else "Rq"
        rows = {
            "D": f"{self.D:.4g}, 95 % interval {low:.4g} to {high:.4g}",
            "G": f"{_m(self.G)}, 95 % interval {_m(least)} to {_m(most)}",
            "band": f"wavelengths from {_m(self.band[0])} to {_m(self.band[1])}",
            rms: f"{_m(self.Rq)}; D and G imply {_m(self.implied_Rq)}",
            "convention": self.convention,
        }
        if self.missing or self.spikes:
            rows["filled in"] = f"{self.missing} missing points and {self.spikes} spikes"
        if self.bias is not None:
            rows["self-test"] = f"took {self.bias:.3g} off D"
        if self.warnings:
            rows["warnings"] = "; ".join(self.warnings)
        return f"Fractal fit of a {'scan' if self.areal else 'profile'} by {self.method}", rows

    def plot(self, ax: "matplotlib.axes.Axes | None" = None) -> "matplotlib.axes.Axes":
        """Draw the power spectrum, the band of the fit, and its power law.

        Args:
            ax: matplotlib axes to draw into; a new figure where None.

        Returns:
            The axes.

        Raises:
            InputError: for anything but axes, and for a fit that was not made from heights.
        """
        from faying.surface.figure import fit_plot

        return fit_plot(self, ax)


@final
@dataclass(frozen=True, kw_only=True)
class Facts:
    """What prepared heights say by themselves: `Rq`, `Ra` and `length` [m] (the side), counts of filled points,
    whether they are a scan's (`areal`) or a profile's, and the scan's notes."""

    Rq: float
    Ra: float
    length: float
    missing: int
    spikes: int
    areal: bool
    notes: tuple[str, ...] = ()

    @classmethod
    def of(cls, scan: Scan | Profile, ready: Prepared) -> "Facts":
        """Return the facts of a scan and of its prepared heights."""
        rough, sides = roughness(ready), sides_of(scan)
        return cls(
            Rq=rough.Rq,
            Ra=rough.Ra,
            length=float(np.prod(sides)) ** (1 / len(sides)),
            missing=ready.missing,
            spikes=ready.spikes,
            areal=isinstance(scan, Scan),
            notes=scan.notes,
        )


def fit_fractal(
    scan: Scan | Profile,
    method: str = "psd",
    *,
    band: tuple[float, float] | tuple[str, str] | None = None,
    degree: int = 1,
    spikes: bool = True,
    convention: str = "yan-komvopoulos",
    gamma: float = 1.5,
    self_test: bool = False,
) -> FractalFit:
    """Estimate the fractal dimension D and the fractal roughness G of a scan or profile, with 95 % intervals.

    Args:
        scan: heights [m] with their spacing; levelled, freed of spikes and filled in before the fit.
        method: "psd" (power law with white noise fitted to the spectrum; recommended), "moments" (ratio of the
            spectral moments m2 and m0), "fpenn" (a network on moments), "structure" (structure function),
            "roughness-length", "higuchi", "mfdfa" (detrended fluctuation) or "box" (box counting).
        band: shortest and longest wavelength to use instead of what the data support, from twice the spacing to the
            side; [m], or text with a unit.
        degree: of the polynomial that levels the heights, 0 to 8.
        spikes: take single outlying points out.
        convention: "yan-komvopoulos" (that of the JK model, c = 1) or "majumdar-bhushan" (c = 1/ln gamma).
        gamma: ratio of neighbouring frequencies in that series, above 1.
        self_test: correct D and G by what the method finds on synthetic surfaces like this one; not with `band`.

    Returns:
        FractalFit. For a scan G is that of the surface, the power of all directions together. For a profile G is the
        profile's own; `FractalFit.convention` states the factor for a cut from an isotropic surface.

    Raises:
        InputError: for unknown methods, bands outside the scan, and heights that carry no statistic.
        NotConverged: where the method finds no power law.

    Source:
        Yan and Komvopoulos 1998, doi:10.1063/1.368536, eq. (5), for the meaning of D and G.
    """
    instance(scan, Scan | Profile, "scan", "give a Scan or a Profile, as faying.read_scan returns it")
    choice(method, "method", METHODS)
    prefactor(convention, gamma)
    flag(spikes, "spikes")
    if flag(self_test, "self_test"):
        from faying.surface import selftest

        if band is not None:
            raise InputError("self_test chooses the band itself; leave out band or self_test")
        return selftest.self_test(scan, method, degree=degree, spikes=spikes, convention=convention, gamma=gamma)
    ready = prepared(scan, degree=degree, spikes=spikes)
    estimate = _estimated(ready, method, _limits(ready, band), prefactor(convention, gamma))
    facts = Facts.of(scan, ready)
    return result(estimate, facts, method=method, convention=convention, gamma=gamma, drawn=ready.scan)


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
    if not isinstance(band, list | tuple | np.ndarray) or len(band) != 2:
        raise InputError(f"band = {shown(band)}; give the shortest and the longest wavelength in metres")
    low, high = sorted(number(wave, "band", "m", least=0) for wave in band)
    if not (shortest * (1 - 1e-9) <= low < high <= longest * (1 + 1e-9)):
        raise InputError(
            f"band = ({low:.4g}, {high:.4g}): give wavelengths in metres between twice the spacing, "
            f"{shortest:.4g}, and the side, {longest:.4g}"
        )
    return low, high


def result(
    e: Estimate,
    facts: Facts,
    *,
    method: str,
    convention: str,
    gamma: float,
    bias: float | None = None,
    drawn: Scan | Profile | Spectrum | None = None,
) -> FractalFit:
    """Complete an estimate by what it implies over the side, its convention in words, and its warnings."""
    c = prefactor(convention, gamma)
    sound = 2 < e.D < 3 and 0 < e.G < float("inf")
    words = [*facts.notes, *e.notes]
    if not 2 < e.D < 3:
        words.append(f"D = {e.D:.3f} is outside 2 .. 3: over this band the surface is not fractal, G means nothing")
    elif not 2.1 <= e.D <= 2.9:
        words.append(f"D = {e.D:.3f} is outside 2.1 .. 2.9, where G is very uncertain and the JK model is unproven")
    if e.misfit > 3:
        words.append(f"the spectrum strays from a power law (misfit {e.misfit:.1f}); the intervals are widened for it")
    words += consistency(e.D, e.G, Rq=facts.Rq, length=facts.length, c=c) if sound else []
    return FractalFit(
        method=method,
        D=e.D,
        G=e.G,
        D_interval=e.D_interval,
        G_interval=e.G_interval,
        band=e.band,
        Rq=facts.Rq,
        Ra=facts.Ra,
        implied_Rq=implied_Rq(e.D, e.G, facts.length, c) if sound else float("nan"),
        convention=_in_words(e.D if sound else None, convention, c, facts.areal),
        noise=e.noise,
        misfit=e.misfit,
        missing=facts.missing,
        spikes=facts.spikes,
        bias=bias,
        warnings=tuple(words),
        scatter=e.scatter,
        c=c,
        areal=facts.areal,
        drawn=drawn,
    )


def _in_words(D: float | None, convention: str, c: float, areal: bool) -> str:
    """The convention of D and G, with the factor between a surface and its profiles where D is sound."""
    name = "Yan-Komvopoulos (JK), c = 1" if convention == NAMES[0] else f"Majumdar-Bhushan, c = 1/ln(gamma) = {c:.4f}"
    text = name + "; S(f) = c G^(2Ds-2)/2 f^-(5-2Ds), D = Ds + 1"
    text += "; G of the surface, power summed over all directions" if areal else "; G of the profile itself"
    if D is None:
        return text
    if areal:
        return text + f" (a profile cut from it has {cut_factor(D):.3f} of its S)"
    factor = cut_factor(D) ** (-1 / (2 * D - 4))
    return text + f" (times {factor:.3f} for the isotropic surface it is cut from, cut factor {cut_factor(D):.3f})"


def _m(metres: float) -> str:
    return units.show(metres, "m", digits=3)


def consistency(D: float, G: float, *, Rq: float, length: float, c: float = 1.0) -> list[str]:
    """Say in words where D and G [m] imply another rms height over `length` [m] than the measured `Rq` [m].

    A factor of 2 either way passes: the longest waves, which hold most of the power, differ that much by chance.
    """
    implied = implied_Rq(check_dimension(D), G, length, c)
    if 0.5 < implied / Rq < 2:
        return []
    return [
        f"D and G imply Rq {_m(implied)} over {_m(length)}, the surface's own is {_m(Rq)}: they do not belong "
        "together, or the law is not valid up to that length"
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
