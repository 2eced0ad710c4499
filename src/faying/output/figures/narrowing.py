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


@drawing
def narrowing(result: Result) -> Any:
    """Return the figure of how much narrower the intervals get at the last preload, one source known better each.

    A bar is the median mode, a dot each mode. Raises InputError for a result without intervals.
    """
    interval = result.interval
    if interval is None:
        raise InputError("the result has no intervals; run it with [modes] intervals = true")
    less_of = {name: 100 * less for name, less in gains(interval).items()}
    names = sorted(less_of, key=lambda name: -np.median(less_of[name]))
    fig = new_figure(WIDE, 0.9 + 0.32 * len(names))
    ax = fig.subplots()
    dots: dict[str, Any] = {"ms": 3, "mfc": "white", "mec": "0.25", "mew": 0.8}
    for row, name in enumerate(names):
        less, first = less_of[name], row == 0
        bar = float(np.median(less))
        ax.barh(row, bar, height=0.55, color=SOURCES[name], lw=0, label="median mode" if first else None)
        ax.plot(less, np.full(len(less), row), "o", label="each mode" if first else None, **dots)
    words = {name: f"{SCATTER[name].remedy} ({name})" for name in names} | {"k_t/k_n": f"measured {typeset('k_t/k_n')}"}
    ax.set_yticks(range(len(names)), [words[name] for name in names])
    ax.invert_yaxis()
    ax.set_xlim(left=min(0.0, 1.05 * min((float(less.min()) for less in less_of.values()), default=0.0)))
    ax.set_xlabel(f"interval narrower by [%], at {result.load_names[-1]}")
    ax.grid(axis="x", alpha=0.3)
    legend_above(ax)
    return fig
