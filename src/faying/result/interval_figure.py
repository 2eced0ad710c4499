"""Figures of a result: 5 to 95 % of each frequency beside the test and what makes it; damping against level."""

from typing import TYPE_CHECKING, Any

import numpy as np

from faying.errors import InputError
from faying.result.figure import band, mode_panels
from faying.result.groups import Levels
from faying.result.result import Result
from faying.result.score import Score
from faying.style import COLOURS, WIDE, colour, drawing, legend_above, new_figure, plain_numbers, shared_legend
from faying.typeset import typeset

if TYPE_CHECKING:
    from faying.result.result import Result


# one colour for each thing that is not known, so that it keeps its colour from figure to figure
SOURCES = {
    "scan": COLOURS[0],
    "law": COLOURS[5],
    "k_t/k_n": COLOURS[3],
    "waves": COLOURS[2],
    "preload": COLOURS[4],
    "mesh": "#4d4d4d",
    "structure": COLOURS[7],
    "parts": COLOURS[1],
    "mode": "#d9d9d9",
}


@drawing
def intervals(result: "Result") -> Any:
    """Return the figure of the intervals at the last preload.

    Left: best estimate and 5 to 95 % of each frequency over the value as modelled, with the frequencies of the test and
    of bonded faces.
    Right: the share of each thing that is not known in the square of the width.
    """
    interval = result.interval
    if interval is None:
        raise InputError("the result has no intervals; run it with [modes] intervals = true")
    count = result.frequencies.shape[1]
    fig = new_figure(WIDE, 1.2 + 0.21 * count)
    left, right = fig.subplots(1, 2, sharey=True, gridspec_kw={"width_ratios": (1.35, 1)})
    value, y = result.frequencies[-1], np.arange(count)
    low, best, high = (100 * (one[-1] / value - 1) for one in (interval.low, interval.best, interval.high))
    left.barh(y, high - low, left=low, height=0.55, color=COLOURS[0], alpha=0.3, lw=0, label="5 to 95 %")
    left.plot(best, y, "o", color=COLOURS[0], ms=4, label="best estimate")
    left.plot(np.zeros(count), y, "|", color="black", ms=9, mew=1.4, label="as modelled")
    _test(left, result)
    shown = _shown(left, low, high)
    if result.bonded is not None:
        bonded = 100 * (result.bonded / value - 1)
        left.plot(bonded, y, "|", color=COLOURS[1], ms=9, mew=1.4, label="faces bonded")
        far = bonded > shown[1]
        if far.any():
            left.plot(np.full(far.sum(), shown[1]), y[far], ">", color=COLOURS[1], ms=4, clip_on=False)
    left.set_xlim(shown)
    left.set_yticks(y, [f"{k + 1}: {f:.0f} Hz" for k, f in enumerate(interval.best[-1])])
    left.invert_yaxis()
    left.set_xlabel("difference from the value as modelled [%]")
    left.set_ylabel(f"mode at {result.load_names[-1]}")
    left.grid(axis="x", alpha=0.3)
    before = np.zeros(count)
    for name, share in zip(interval.sources, 100 * interval.shares[:, -1], strict=True):
        right.barh(y, share, left=before, height=0.55, color=SOURCES[name], lw=0, label=typeset(name))
        before = before + share
    right.set_xlim(0, 100)
    right.set_xlabel("share of the variance [%]")
    for ax, columns in ((left, 2), (right, 4)):
        legend_above(ax, columns)
    return fig


def _shown(ax: Any, low: Any, high: Any) -> tuple[float, float]:
    """Ends of the axis of differences: the bars and the test, with some room; bonded faces may lie beyond."""
    marks = [line.get_xdata() for line in ax.get_lines() if line.get_label() == "test"]
    least = min(float(low.min()), *(float(np.min(one)) for one in marks), -1e-9)
    most = max(float(high.max()), *(float(np.max(one)) for one in marks), 1e-9)
    room = 0.08 * (most - least)
    return least - room, most + room


def _test(ax: Any, result: "Result") -> None:
    """Mark the measured frequencies of the last preload at the modes that they are paired with."""
    score, c = Score.of(result), result.comparison
    if score is None or c is None:
        return
    at = np.flatnonzero(np.isfinite(score.test[-1]))
    modes = c.modes[-1, at]
    miss = 100 * (score.test[-1, at] / result.frequencies[-1, modes] - 1)
    ax.plot(miss, modes, "s", ms=4.5, mfc="white", mec="black", mew=1.1, label="test")


@drawing
def damping_levels(result: Result, load: int = -1) -> Any:
    """Return the figure of the damping ratio of every mode at levels of acceleration, low to high as a band.

    Raises InputError for a result without levels.
    """
    found = _at_levels(result)
    fig, axes = mode_panels(found.damping.shape[2], sharex=True, sharey=True)
    for mode, ax in enumerate(axes):
        damping_of(ax, result, mode, load)
        ax.set_title(f"{mode + 1}: {result.frequencies[load, mode]:.0f} Hz", pad=3)
    fig.supxlabel(f"peak acceleration where the mode moves most [m/s²], at {result.load_names[load]}")
    fig.supylabel("damping ratio [%]")
    shared_legend(fig, axes)
    return fig


@drawing
def damping_of(ax: Any, result: Result, mode: int, load: int = -1) -> Any:
    """Draw the damping ratio [%] of one mode over its level, with its band and the part that is slip."""
    found = _at_levels(result)
    a = found.accelerations
    low, high = (100 * one[load, :, mode] for one in (found.low, found.high))
    band(ax, a, low, high, label="low to high")
    ax.plot(a, 100 * found.damping[load, :, mode], "o-", color=COLOURS[0], ms=3, label="damping")
    slip = 100 * found.slip[load, :, mode]
    if np.nanmax(slip) > 30 * float(np.nanmin(found.damping[load])):  # else slip says nothing
        ax.plot(a, np.where(slip > 0, slip, np.nan), "--", color=colour(1), lw=1.0, label="of it by slip")
    ax.set(xscale="log", yscale="log")
    ax.set_ylim(bottom=30 * float(np.nanmin(found.low)))
    ax.set_xlim(a[0] / 1.4, a[-1] * 1.4)
    plain_numbers(ax.xaxis)
    plain_numbers(ax.yaxis)
    ax.grid(alpha=0.3)
    return ax


def _at_levels(result: Result) -> Levels:
    if result.levels is None:
        raise InputError("the result has no damping at levels; run it with [modes] levels")
    return result.levels
