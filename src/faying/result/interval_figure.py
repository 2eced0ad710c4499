"""The figure of a result's intervals: 5 to 95 % of each frequency beside the test, and what makes it."""

from typing import TYPE_CHECKING, Any

import numpy as np

from faying.errors import InputError
from faying.result.score import Score
from faying.style import new_figure

if TYPE_CHECKING:
    from faying.result.result import Result

# Okabe and Ito, one for each thing that is not known, so that it keeps its colour from figure to figure
COLOURS = {
    "scan": "#0072b2",
    "law": "#56b4e9",
    "k_t/k_n": "#cc79a7",
    "waves": "#009e73",
    "preload": "#f0e442",
    "structure": "#999999",
    "mode": "#d9d9d9",
}
NAMES = {"k_t/k_n": "$k_t/k_n$"}


def intervals(result: "Result") -> Any:
    """Return the figure of the intervals at the greatest preload.

    Left: 5 to 95 % of each frequency over the value as computed, with the frequencies of the test and of bonded faces.
    Right: the share of each thing that is not known in the square of the width.
    """
    interval = result.interval
    if interval is None or result.interval_low is None or result.interval_high is None:
        raise InputError("the result has no intervals; run it with [modes] intervals = true")
    count = len(result.bonded)
    fig = new_figure(7.0, 1.6 + 0.24 * count)
    left, right = fig.subplots(1, 2, sharey=True, gridspec_kw={"width_ratios": (1.35, 1)})
    value, y = result.frequencies[-1], np.arange(count)
    low, high = (100 * (end[-1] / value - 1) for end in (result.interval_low, result.interval_high))
    left.barh(y, high - low, left=low, height=0.55, color="#56b4e9", alpha=0.55, lw=0, label="5 to 95 %")
    left.plot(np.zeros(count), y, "|", color="black", ms=9, mew=1.4, label="as computed")
    left.plot(100 * (result.bonded / value - 1), y, "|", color="#d55e00", ms=9, mew=1.2, label="faces bonded")
    _test(left, result)
    most = 1.6 * max(float(np.abs(low).max()), float(np.abs(high).max()))
    left.set_xlim(-most, most)
    left.set_yticks(y, [f"{k + 1}: {f:.0f} Hz" for k, f in enumerate(value)])
    left.invert_yaxis()
    left.set_xlabel("difference from the value as computed [%]")
    left.set_ylabel(f"mode at {result.loads[-1] / 1e3:g} kN")
    left.grid(axis="x", alpha=0.3)
    before = np.zeros(count)
    for name, share in zip(interval.sources, 100 * interval.shares[:, -1], strict=True):
        right.barh(y, share, left=before, height=0.55, color=COLOURS[name], lw=0, label=NAMES.get(name, name))
        before = before + share
    right.set_xlim(0, 100)
    right.set_xlabel("share of the variance [%]")
    for ax, columns in ((left, 2), (right, 3)):
        ax.legend(
            loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=columns, fontsize=8, frameon=False, columnspacing=1.0
        )
    return fig


def _test(ax: Any, result: "Result") -> None:
    """Mark the measured frequencies of the greatest preload at the modes that they are paired with."""
    score, c = Score.of(result), result.comparison
    if score is None or c is None:
        return
    at = [k for k in range(score.test.shape[1]) if np.isfinite(score.test[-1, k])]
    modes = c.modes[-1, at]
    miss = 100 * (score.test[-1, at] / result.frequencies[-1, modes] - 1)
    ax.plot(miss, modes, "o", ms=5, mfc="white", mec="black", mew=1.3, label="test")
