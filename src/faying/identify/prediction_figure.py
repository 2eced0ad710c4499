"""Figures of a prediction: intervals beside the test, shares of the variance, the samples against each other."""

from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from faying.errors import InputError
from faying.identify.prediction_record import LEVELS, PredictionRecord
from faying.result.backbone_figure import ROUNDING, factor_of, framed, marks
from faying.style import (
    COLOURS,
    COLUMN,
    WIDE,
    axes_of,
    drawing,
    headline,
    load_colours,
    new_figure,
    prefixed,
    shared_legend,
)
from faying.typeset import name_of
from faying.units import in_mm, load_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MAX_INPUTS = 6  # of the scatter matrix


@drawing
def intervals(found: PredictionRecord) -> Any:
    """Return the figure of the 5 to 95 % of each frequency over its median, one column a preload, the test as dots."""
    count = found.observed[0].shape[2]
    fig = new_figure(WIDE, max(2.1, 1.2 + 0.24 * count * len(found.loads) ** 0.5))
    _draw_intervals(fig.subplots(), found)
    fig.legend(loc="outside lower center", ncols=4)
    return fig


@drawing
def interval_axes(found: PredictionRecord, ax: "Axes | None" = None) -> "Axes":
    """Draw the 5 to 95 % of each frequency over its median, and the test."""
    if not found.answered:
        raise InputError(f"no sample has an answer: {'; '.join(found.reasons)}")
    count = found.observed[0].shape[2]
    (target,) = axes_of(ax, 1, width=WIDE, height=max(2.1, 1.2 + 0.24 * count * len(found.loads) ** 0.5))
    _draw_intervals(target, found)
    target.legend(loc="best")
    return target


def _draw_intervals(ax: Any, found: PredictionRecord) -> None:
    test, levels = found.observed[1], found.quantiles(LEVELS)
    low, middle, high = levels.frequencies if levels.paired is None or found.test is None else levels.paired
    count = len(found.loads)
    shades = load_colours(count)
    for load in range(count):
        y = np.arange(middle.shape[1]) + (load - (count - 1) / 2) * 0.7 / count
        shade = shades[load]
        ends = [100 * (1 - low[load] / middle[load]), 100 * (high[load] / middle[load] - 1)]
        label = load_text(found.loads[load])
        ax.errorbar(np.zeros(len(y)), y, xerr=ends, fmt="|", color=shade, lw=2.2, ms=7, capsize=0, label=label)
        ax.plot(100 * (test[load] / middle[load] - 1), y, "s", ms=4.5, mfc="white", mec=shade, mew=1.2)
    if np.isfinite(test).any():
        ax.plot([], [], "s", ms=4.5, mfc="white", mec="0.3", mew=1.2, label="test")
    ax.set_yticks(range(middle.shape[1]), [f"{k + 1}: {middle[-1, k]:.0f} Hz" for k in range(middle.shape[1])])
    ax.invert_yaxis()
    ax.set_xlabel("difference from the median [%]; bars from 5 to 95 %")
    ax.set_ylabel("mode and its median")
    ax.grid(axis="x", alpha=0.3)
    ax.set_title(headline(found.title))


@drawing
def tornado(found: PredictionRecord) -> Any:
    """Return the figure of the shares of the variance of each mode at the last preload, first order and total."""
    shares, _ = found.shares()
    modes = len(shares.first)
    order = np.argsort(np.nanmean(shares.total, axis=0))[::-1]
    fig = new_figure(WIDE, 1.3 + 0.22 * modes + 0.08 * len(found.names))
    ax = fig.subplots()
    left = np.zeros(modes)
    for rank, k in enumerate(order):
        width = np.clip(np.nan_to_num(shares.first[:, k]), 0, None)
        ax.barh(
            range(modes),
            100 * width,
            left=100 * left,
            height=0.7,
            color=COLOURS[rank % len(COLOURS)],
            hatch="//" if rank >= len(COLOURS) else None,
            label=name_of(found.names[k]),
        )
        left += width
    rest = np.clip(1 - left, 0, None)
    ax.barh(
        range(modes),
        100 * rest,
        left=100 * left,
        height=0.7,
        color="white",
        edgecolor="0.6",
        label="together, not one alone",
    )
    ax.invert_yaxis()
    ax.set_yticks(range(modes), [str(k + 1) for k in range(modes)])
    ax.set(xlim=(0, 100), ylabel="mode" if found.paired is None else "test mode")
    ax.set_xlabel(f"share of the variance at {load_text(found.loads[-1])} [%]")
    fig.legend(loc="outside lower center", ncols=2)
    ax.set_title(headline(found.title))
    return fig


@drawing
def scatter_matrix(found: PredictionRecord) -> Any:
    """Return the figure of the samples: the inputs that matter most against the frequencies at the last preload."""
    shares, _ = found.shares()
    values, _ = found.observed
    frequencies = values[:, -1]
    modes = np.arange(min(3, frequencies.shape[1]))
    order = np.argsort(np.nanmean(shares.total[modes], axis=0))[::-1][:MAX_INPUTS]
    fig = new_figure(WIDE, 1.25 * len(modes) + 0.8)
    axes = fig.subplots(len(modes), len(order), sharex="col", sharey="row", squeeze=False)
    for row, mode in enumerate(modes):
        for column, k in enumerate(order):
            ax = axes[row, column]
            factor, unit = prefixed(found.values[:, k], found.inputs.columns[k].unit)
            ax.plot(found.values[:, k] / factor, frequencies[:, mode], ".", ms=2, color=COLOURS[0], alpha=0.5)
            ax.locator_params(nbins=3)
            if row == len(modes) - 1:
                ax.set_xlabel(
                    "\n".join(wrap(name_of(found.names[k]), 18, break_long_words=False))
                    + (f"\n[{unit}]" if unit else "")
                )
        axes[row, 0].set_ylabel(f"mode {mode + 1} [Hz]")
    return fig


@drawing
def backbones(found: PredictionRecord) -> Any:
    """Return the figure of the backbones: 5 to 95 % and the median of frequency and damping, measured points over them.

    Thin lines are the samples, some of which may go farther than the quantiles. Raises InputError without backbones.
    """
    curves = found.backbones
    if curves is None:
        raise InputError("this prediction has no backbones; ask for them with --backbones 32")
    fig = new_figure(COLUMN, 4.8)
    upper, lower = fig.subplots(2, 1, sharex=True)
    a = curves.acceleration
    bands = curves.quantiles(LEVELS)
    for ax, quantity, values, band in (
        (upper, "frequency", curves.frequencies, bands[0]),
        (lower, "damping", curves.damping, bands[1]),
    ):
        factor = factor_of(quantity)
        least = ROUNDING * np.nanmax(values, initial=0.0)  # below it nothing slips yet
        low, middle, high = factor * np.where(band > least, band, np.nan)
        for k, line in enumerate(factor * np.where(values > least, values, np.nan)):
            ax.plot(a, line, color="0.6", lw=0.5, alpha=0.6, label="samples" if k == 0 else None)
        ax.fill_between(a, low, high, color=COLOURS[0], alpha=0.25, lw=0, label="5 to 95 %")
        ax.plot(a, middle, color=COLOURS[0], lw=1.8, label="median")
        if curves.measured is not None:
            marks(ax, curves.measured, quantity, 0)
        framed(ax, quantity)
    lower.set_xlabel(f"acceleration at {in_mm(curves.at)} [m/s²]")
    upper.set_title(f"{headline(found.title)}: mode {curves.mode}, {load_text(curves.preload)}")
    shared_legend(fig, [upper], 2)
    return fig
