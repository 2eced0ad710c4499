"""Figure of an identification: each parameter before and after the test, and the frequencies beside the test."""

from typing import Any

import numpy as np

from faying.identify.identification import Identification
from faying.output.figures.prediction import COLOURS
from faying.output.figures.save import new_figure, plain


def figure(found: Identification) -> Any:
    """Return the figure of an identification.

    Above, the 5 to 95 % of each parameter, over its prior's own 5 to 95 %: a bar as long as the prior's tells that the
    test says nothing of it. Below, the predicted 5 to 95 % of each frequency over its median, the test as dots, hollow
    where it was left out.
    """
    names, loads = found.names, found.loads
    modes = found.test.shape[1]
    fig = new_figure(6.3, 1.6 + 0.27 * len(names) + 0.3 * modes * len(loads) ** 0.5)
    upper, lower = fig.subplots(2, 1, height_ratios=[0.6 + 0.27 * len(names), 0.6 + 0.3 * modes * len(loads) ** 0.5])
    prior = np.array([one.quantile(np.array([0.05, 0.5, 0.95])) for one in found.priors])
    width = prior[:, 2] - prior[:, 0]
    after = (found.quantiles().T - prior[:, :1]) / width[:, None]
    y = np.arange(len(names))
    upper.barh(y, np.ones(len(y)), height=0.55, color="0.88", label="before the test")
    upper.errorbar(
        after[:, 1],
        y,
        xerr=[after[:, 1] - after[:, 0], after[:, 2] - after[:, 1]],
        fmt="o",
        ms=4,
        color=COLOURS[0],
        lw=2.2,
        label="after it",
    )
    upper.set_yticks(
        y, [plain(f"{name} ({told:.2f})") for name, told in zip(names, found.told, strict=True)], fontsize=8
    )
    upper.set_xlabel("5 to 95 % of the prior = 0 to 1; in brackets, sd after over sd before", fontsize=8)
    upper.invert_yaxis()
    upper.grid(axis="x", alpha=0.3)
    upper.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, fontsize=8, frameon=False)
    low, middle, high = found.predicted
    for k, load in enumerate(loads):
        place = np.arange(modes) + (k - (len(loads) - 1) / 2) * 0.7 / len(loads)
        colour = COLOURS[k % len(COLOURS)]
        ends = [100 * (1 - low[k] / middle[k]), 100 * (high[k] / middle[k] - 1)]
        label = f"{load / 1e3:g} kN" + (", left out" if found.left_out[k] else "")
        lower.errorbar(np.zeros(modes), place, xerr=ends, fmt="|", color=colour, lw=2.2, ms=7, label=label)
        face = "white" if found.left_out[k] else colour
        lower.plot(100 * (found.test[k] / middle[k] - 1), place, "o", ms=4.5, mfc=face, mec=colour, mew=1.3)
    lower.set_yticks(range(modes), [f"{k + 1}: {middle[-1, k]:.0f} Hz" for k in range(modes)])
    lower.set_xlabel("difference from the median [%]; bars 5 to 95 %, dots measured", fontsize=8)
    lower.invert_yaxis()
    lower.grid(axis="x", alpha=0.3)
    lower.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=4, fontsize=8, frameon=False)
    return fig
