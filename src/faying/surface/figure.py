"""Figures of a scan: map, profile, spectrum with the fitted band, estimators side by side."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from faying.errors import InputError
from faying.style import COLOURS, SMALL, WIDE, axes_of, colour, drawing, new_figure, plain, prefixed, save
from faying.surface.convention import density
from faying.surface.form import Prepared, prepared
from faying.surface.fractal_numbers import FractalNumbers
from faying.surface.heights import AreaHeights, LineHeights
from faying.surface.spectrum import Spectrum, spectrum
from faying.typeset import unit
from faying.units import show

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@drawing
def height_map(scan: AreaHeights, ax: Any) -> Any:
    """Draw the heights as a map; colours span the central 98 % of the heights."""
    factor, name = prefixed(max(scan.size), "m")
    low, high = np.nanquantile(scan.heights, [0.01, 0.99])
    scale, tall = prefixed(high - low, "m")
    image = ax.imshow(
        scan.heights / scale,
        origin="lower",
        extent=(0, scan.size[0] / factor, 0, scan.size[1] / factor),
        cmap="viridis",
        vmin=low / scale,
        vmax=high / scale,
        interpolation="nearest",
    )
    ax.figure.colorbar(image, ax=ax, label=f"height [{tall}]", shrink=0.85)
    ax.set(xlabel=f"x [{name}]", ylabel=f"y [{name}]")
    return ax


@drawing
def profile(scan: LineHeights, ax: Any) -> Any:
    """Draw a line of heights."""
    factor, name = prefixed(scan.length, "m")
    scale, tall = prefixed(np.nanmax(np.abs(scan.heights)), "m")
    ax.plot(np.arange(len(scan.heights)) * scan.spacing / factor, scan.heights / scale, lw=0.7, color=COLOURS[0])
    ax.set(xlabel=f"x [{name}]", ylabel=f"height [{tall}]")
    ax.margins(x=0)
    return ax


@drawing
def power_spectrum(of: Spectrum, fits: Mapping[str, FractalNumbers | str], ax: Any, *, name: str = "scan") -> Any:
    """Draw the power per radial frequency with the law of each fit over its band; wavelengths along the top.

    Where there are several fits, their colours are those of `estimators`.
    """
    from matplotlib.ticker import NullFormatter

    ax.loglog(of.frequency, of.density, ".", ms=3, color="0.55", label=name)
    for k, (method, fit) in enumerate(fits.items()):
        if isinstance(fit, str) or not (fit.G > 0 and 2 < fit.D < 3):
            continue
        f = np.geomspace(1 / fit.band[1], 1 / fit.band[0], 50)
        law = density(fit.D, fit.G, fit.c) * f ** (2 * fit.D - 7)
        ax.loglog(f, law, lw=1.6, color=colour(k), label=f"{method}, $D$ {fit.D:.3f}")
    ax.set(xlabel="frequency [1/m]", ylabel="power per frequency [m³]")
    top = ax.secondary_xaxis("top", functions=(_inverse, _inverse))
    top.set_xlabel("wavelength [m]")
    for axis in (ax.xaxis, top.xaxis, ax.yaxis):
        axis.set_minor_formatter(NullFormatter())
    if len(fits) < 2:
        ax.legend(loc="best")
    return ax


def _inverse(x: Any) -> Any:
    with np.errstate(divide="ignore"):
        return 1 / np.asarray(x, float)


@drawing
def overview_of(scan: AreaHeights | LineHeights, axes: Any, *, degree: int) -> "list[Axes]":
    """Draw levelled heights and their spectrum for `plot` of a scan or profile; missing points stay blank."""
    ready = prepared(scan, degree=degree)
    heights, power = axes_of(axes, 2)
    holes = ready.scan.with_heights(np.where(ready.known, ready.scan.heights, np.nan))
    if isinstance(scan, AreaHeights):
        height_map(holes, heights)
    else:
        profile(holes, heights)
    heights.set_title(f"{plain(Path(scan.source).name)}, levelled")
    power_spectrum(spectrum(ready.scan), {}, power, name="spectrum")
    return [heights, power]


@drawing
def fit_plot(fit: FractalNumbers, ax: Any) -> "Axes":
    """Draw the spectrum, the band of a fit shaded, its power law in the band and thin beyond it."""
    if fit.drawn is None:
        raise InputError("this fit was made from numbers alone and has no spectrum to draw; make it with fit_fractal")
    (axes,) = axes_of(ax, 1, width=WIDE, height=3.6)
    of = fit.drawn if isinstance(fit.drawn, Spectrum) else spectrum(fit.drawn)
    source = "both scans, summed" if isinstance(fit.drawn, Spectrum) else Path(fit.drawn.source).name
    axes.axvspan(1 / fit.band[1], 1 / fit.band[0], color=COLOURS[0], alpha=0.1, lw=0, label="band of the fit")
    power_spectrum(of, {fit.method: fit}, axes, name="spectrum")
    if fit.G > 0 and 2 < fit.D < 3:
        law = density(fit.D, fit.G, fit.c) * of.frequency ** (2 * fit.D - 7)
        axes.plot(of.frequency, law, "--", color="0.3", lw=0.8, zorder=1)
    (low, high), (least, most) = fit.D_interval, fit.G_interval
    axes.set_title(
        f"{plain(source)}: $D$ {fit.D:.3f} ({low:.3f} to {high:.3f}), $G$ "
        + unit(f"{show(fit.G, 'm', digits=3)} ({show(least, 'm', digits=3)} to {show(most, 'm', digits=3)})"),
        fontsize=SMALL,
    )
    return axes


@drawing
def estimators(fits: Mapping[str, FractalNumbers | str], ax: Any) -> Any:
    """Draw D of every estimator with its 95 % interval."""
    good = [(name, fit) for name, fit in fits.items() if not isinstance(fit, str)]
    for row, (name, fit) in enumerate(good):
        shade = colour(list(fits).index(name))
        ax.plot(fit.D_interval, (row, row), lw=2, color=shade)
        ax.plot(fit.D, row, "o", color=shade)
    ax.set_yticks(range(len(good)), [name for name, _ in good])
    ax.set(ylim=(len(good) - 0.5, -0.5), xlabel="surface dimension $D$, 95 % interval")
    ax.grid(axis="x", alpha=0.3)
    return ax


def overview(
    scan: AreaHeights | LineHeights, ready: Prepared, fits: Mapping[str, FractalNumbers | str], path: str | Path
) -> Path:
    """Write one figure of map (or line), a profile, the spectrum and the estimators; the suffix sets the format.

    Raises InputError for a suffix that matplotlib does not know or a folder that cannot be written.
    """
    return save(overview_figure(scan, ready, fits), path)


@drawing
def overview_figure(scan: AreaHeights | LineHeights, ready: Prepared, fits: Mapping[str, FractalNumbers | str]) -> Any:
    """Return the figure of map (or line), a profile, the spectrum and the estimators of a scan."""
    figure = new_figure(WIDE, 5.6)
    axes = figure.subplots(2, 2)
    if isinstance(scan, AreaHeights):
        height_map(ready.scan, axes[0, 0])
        profile(ready.scan.profile("x", scan.shape[0] // 2), axes[0, 1])
        axes[0, 1].set_title("middle row, levelled")
    else:
        profile(scan, axes[0, 0])
        axes[0, 0].set_title("as read")
        profile(ready.scan, axes[0, 1])
        axes[0, 1].set_title("levelled")
    power_spectrum(spectrum(ready.scan), fits, axes[1, 0])
    estimators(fits, axes[1, 1])
    figure.suptitle(plain(Path(scan.source).name))
    return figure
