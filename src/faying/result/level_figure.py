"""The figure of damping against level: each mode, with the band of what is not known of slip."""

from typing import Any

import numpy as np

from faying.errors import InputError
from faying.result.figure import band, mode_panels
from faying.result.result import Result
from faying.result.run_record import DampedLevels
from faying.style import COLOURS, colour, drawing, plain_numbers, shared_legend


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
    a = found.levels
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


def _at_levels(result: Result) -> DampedLevels:
    if result.at_levels is None:
        raise InputError("the result has no damping at levels; run it with [modes] levels")
    return result.at_levels
