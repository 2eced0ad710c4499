"""The figure of a result's intervals: 5 to 95 % of each frequency beside the test, and what makes it."""

from typing import TYPE_CHECKING, Any

import numpy as np

from faying.errors import InputError
from faying.result.score import Score
from faying.style import COLOURS, WIDE, drawing, legend_above, new_figure
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
    """Return the figure of the intervals at the greatest preload.

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
    """Mark the measured frequencies of the greatest preload at the modes that they are paired with."""
    score, c = Score.of(result), result.comparison
    if score is None or c is None:
        return
    at = [k for k in range(score.test.shape[1]) if np.isfinite(score.test[-1, k])]
    modes = c.modes[-1, at]
    miss = 100 * (score.test[-1, at] / result.frequencies[-1, modes] - 1)
    ax.plot(miss, modes, "s", ms=4.5, mfc="white", mec="black", mew=1.1, label="test")
