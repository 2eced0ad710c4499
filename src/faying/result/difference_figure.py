"""The figure of two runs over each other: frequencies with their intervals, losses, and pressure."""

from typing import Any

import numpy as np

from faying.result.difference import RunDifference
from faying.result.result import Result
from faying.style import SOFT, WIDE, colour, drawing, new_figure, plain_numbers, shared_legend
from faying.typing import Array

MARKS = ("o", "s")
MAX_TICKS = 12


@drawing
def differences(found: RunDifference, names: tuple[str, str] = ("first run", "second run")) -> Any:
    """Return the figure of two runs: frequencies against those of the first, loss factors, pressure over the area.

    Intervals from 5 to 95 % are bars where a run has them.
    """
    fig = new_figure(WIDE, 2.7)
    axes = fig.subplots(1, 3)
    base = found.frequencies[0]
    places = np.arange(len(found.modes))
    for side, name in enumerate(names):
        shift = (side - 0.5) * 0.24
        look = {"color": colour(side), "ms": 4, "ls": "none", "label": name}
        f = found.frequencies[side]
        axes[0].plot(places + shift, 100 * (f / base - 1), MARKS[side], **look)
        ends = _interval(found, side, base)
        if ends is not None:
            axes[0].vlines(places + shift, *ends, color=colour(side), lw=1.0)
        axes[1].plot(places + shift, found.loss_factors[side], MARKS[side], **look)
        run = (found.first, found.second)[side]
        pressure, share = carried(run, found.loads[side])
        axes[2].plot(pressure / 1e6, 100 * share, color=colour(side), lw=1.4 - 0.3 * side, ls=("-", "--")[side])
    axes[0].axhline(0, color=SOFT, lw=0.7, zorder=0)
    axes[0].set(ylabel="change of frequency [%]")
    axes[1].set(ylabel="loss factor")
    if np.nanmin(np.concatenate(found.loss_factors), initial=np.inf) > 0:
        axes[1].set_yscale("log")
        plain_numbers(axes[1].yaxis)
    step = -(-len(places) // MAX_TICKS) or 1
    for ax in axes[:2]:
        ax.set(xlabel="mode of the first run", xticks=places[::step], xticklabels=found.modes[::step, 0] + 1)
        ax.set_xlim(-0.6, len(places) - 0.4)
    axes[2].set(xlabel="contact pressure [MPa]", ylabel="area at this pressure or more [%]", ylim=(0, 100))
    axes[2].set_xlim(left=0)
    for ax in axes:
        ax.grid(alpha=0.3)
    shared_legend(fig, axes[:1])
    return fig


def carried(result: Result, load: int) -> tuple[Array, Array]:
    """Pressures [Pa], rising from 0, and the share of the area of all joints that has at least each [-]."""
    order = np.argsort(result.pressure[load])
    pressure, area = result.pressure[load][order], result.weights[order]
    above = np.cumsum(area[::-1])[::-1] / area.sum()
    bears = pressure > 0
    rising, share = pressure[bears], above[bears]
    most, all_of_it = rising[-1:], share[:1]
    return np.concatenate([0 * most, rising, most]), np.concatenate([all_of_it, share, 0 * most])


def _interval(found: RunDifference, side: int, base: Array) -> Array | None:
    """Where 5 and 95 % of each frequency lie (2, pair) [% from the first]; None without."""
    run, load, modes = (found.first, found.second)[side], found.loads[side], found.modes[:, side]
    if run.interval_low is None or run.interval_high is None:
        return None
    ends = np.stack([run.interval_low[load][modes], run.interval_high[load][modes]])
    return np.asarray(100 * (ends / base - 1))
