"""What would narrow the intervals of a result: a bar for each thing that can be known better."""

from typing import Any

import numpy as np

from faying.case.scatter import SCATTER
from faying.errors import InputError
from faying.output.answer import gains
from faying.result import Result
from faying.result.interval_figure import SOURCES
from faying.style import WIDE, drawing, legend_above, new_figure
from faying.typeset import typeset


def _words(name: str, remedy: str) -> str:
    """What is done, and what is known better by it."""
    if name == "k_t/k_n":
        return f"measured {typeset(name)}"
    return f"{remedy} ({name})"


@drawing
def narrowing(result: Result) -> Any:
    """Return the figure of how much narrower the intervals get at the greatest preload, one source known better each.

    A bar is the median mode, a dot each mode. Raises InputError for a result without intervals.
    """
    interval = result.interval
    if interval is None:
        raise InputError("the result has no intervals; run it with [modes] intervals = true")
    less_of = {name: 100 * less for name, less in gains(interval).items()}
    found = [(float(np.median(less)), less, name, SCATTER[name].remedy) for name, less in less_of.items()]
    found.sort(key=lambda one: -one[0])
    fig = new_figure(WIDE, 0.9 + 0.32 * len(found))
    ax = fig.subplots()
    for row, (median, less, name, _) in enumerate(found):
        ax.barh(row, median, height=0.55, color=SOURCES[name], lw=0, label="median mode" if row == 0 else None)
        ax.plot(
            less,
            np.full(len(less), row),
            "o",
            ms=3,
            mfc="white",
            mec="0.25",
            mew=0.8,
            label="each mode" if row == 0 else None,
        )
    ax.set_yticks(range(len(found)), [_words(name, remedy) for *_, name, remedy in found])
    ax.invert_yaxis()
    ax.set_xlim(left=min(0.0, 1.05 * min((float(less.min()) for _, less, *_ in found), default=0.0)))
    ax.set_xlabel(f"interval narrower by [%], at {result.load_names[-1]}")
    ax.grid(axis="x", alpha=0.3)
    legend_above(ax)
    return fig
