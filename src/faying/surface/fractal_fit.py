"""D and G of heights by one estimator, with intervals and the band it used."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from faying.surface.convention import NAMES, check_dimension, cut_factor, implied_Rq, prefactor
from faying.surface.estimators.base import Estimate
from faying.surface.figure import fit_plot
from faying.surface.form import Prepared
from faying.surface.fractal_numbers import FractalNumbers, metres
from faying.surface.heights import AreaHeights, LineHeights, sides_of
from faying.surface.roughness import roughness
from faying.surface.spectrum import Spectrum

if TYPE_CHECKING:
    import matplotlib.axes


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class FractalFit(FractalNumbers):
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
        warnings: what the user ought to know.
        scatter: of D and G together, where the estimator states their covariance.
        c: prefactor of the convention [-].
        areal: whether D and G are those of a scan; else G is that of the profile itself.
        drawn: what `plot` takes the spectrum from: the levelled heights, or the spectrum itself.
    """

    def plot(self, ax: "matplotlib.axes.Axes | None" = None) -> "matplotlib.axes.Axes":
        """Draw the power spectrum, the band of the fit, and its power law.

        Args:
            ax: matplotlib axes to draw into; a new figure where None.

        Returns:
            The axes.

        Raises:
            InputError: for anything but axes, and for a fit that was not made from heights.
        """
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
    def of(cls, scan: AreaHeights | LineHeights, ready: Prepared) -> "Facts":
        """Return the facts of a scan and of its prepared heights."""
        rough, sides = roughness(ready), sides_of(scan)
        return cls(
            Rq=rough.Rq,
            Ra=rough.Ra,
            length=float(np.prod(sides)) ** (1 / len(sides)),
            missing=ready.missing,
            spikes=ready.spikes,
            areal=isinstance(scan, AreaHeights),
            notes=scan.notes,
        )


def result(
    e: Estimate,
    facts: Facts,
    *,
    method: str,
    convention: str,
    gamma: float,
    drawn: AreaHeights | LineHeights | Spectrum | None = None,
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


def consistency(D: float, G: float, *, Rq: float, length: float, c: float = 1.0) -> list[str]:
    """Say in words where D and G [m] imply another rms height over `length` [m] than the measured `Rq` [m].

    A factor of 2 either way passes: the longest waves, which hold most of the power, differ that much by chance.
    """
    implied = implied_Rq(check_dimension(D), G, length, c)
    if 0.5 < implied / Rq < 2:
        return []
    return [
        f"D and G imply Rq {metres(implied)} over {metres(length)}, the surface's own is {metres(Rq)}: they do not "
        "belong together, or the law is not valid up to that length"
    ]
