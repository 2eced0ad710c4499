"""Figure of an identification: each parameter before and after the test, frequencies and loss beside the test."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from faying.identify.identification_record import IdentificationRecord
from faying.style import COLOURS, WIDE, axes_of, drawing, load_colours, new_figure
from faying.typeset import name_of
from faying.typing import Array
from faying.units import load_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@drawing
def figure(found: IdentificationRecord) -> Any:
    """Return the figure of an identification.

    Above, the 5 to 95 % of each parameter, over its prior's own 5 to 95 %: a bar as long as the prior's tells that the
    test says nothing of it. Below, the predicted 5 to 95 % of each frequency over its median, the test as dots, hollow
    where it was left out; and the same of loss factors where they were used.
    """
    heights = _heights(found)
    fig = new_figure(WIDE, 0.4 + sum(heights))
    _draw(list(fig.subplots(len(heights), 1, height_ratios=heights)), found)
    return fig


@drawing
def identification_axes(found: IdentificationRecord, ax: Any = None) -> "list[Axes]":
    """Draw the same into axes, one for each panel."""
    heights = _heights(found)
    axes = axes_of(ax, len(heights), width=WIDE, height=max(heights), columns=1)
    _draw(axes, found)
    return axes


def _draw(axes: "Sequence[Axes]", found: IdentificationRecord) -> None:
    upper, *lower = axes
    _parameters(upper, found)
    for ax, (test, predicted, unit) in zip(lower, _parts(found), strict=True):
        _beside_test(ax, found, test, predicted, unit)


def _parts(found: IdentificationRecord) -> list[tuple[Array, Array, str]]:
    """What was measured, its intervals, and the unit."""
    parts = [(found.test, found.predicted, "Hz")]
    if found.losses is not None and found.predicted_losses is not None:
        parts.append((found.losses, found.predicted_losses, ""))
    return parts


def _heights(found: IdentificationRecord) -> list[float]:
    """Heights of the panels [inches]."""
    heights = [0.6 + 0.22 * len(found.names)]
    return heights + [0.6 + 0.24 * found.test.shape[1] * len(found.loads) ** 0.5] * len(_parts(found))


def _parameters(ax: Any, found: IdentificationRecord) -> None:
    """Each parameter after the test, over its prior."""
    names = found.names
    prior = np.array([one.quantile(np.array([0.05, 0.5, 0.95])) for one in found.priors])
    width = prior[:, 2] - prior[:, 0]
    after = (found.quantiles().T - prior[:, :1]) / width[:, None]
    y = np.arange(len(names))
    ax.barh(y, np.ones(len(y)), height=0.55, color="0.88", label="before the test")
    ax.errorbar(
        after[:, 1],
        y,
        xerr=[after[:, 1] - after[:, 0], after[:, 2] - after[:, 1]],
        fmt="o",
        ms=4,
        color=COLOURS[0],
        lw=2.2,
        label="after it",
    )
    ax.set_yticks(
        y,
        [
            f"{name_of(name)} ({contraction:.2f})"
            for name, contraction in zip(names, found.posterior_contraction, strict=True)
        ],
    )
    ax.set_xlabel("5 to 95 % of the prior = 0 to 1; in brackets, sd after over sd before")
    ax.invert_yaxis()
    ax.grid(axis="x", alpha=0.3)
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)


def _beside_test(ax: Any, found: IdentificationRecord, test: Array, predicted: Array, unit: str) -> None:
    """Predicted quantiles (3, load, mode) over their median, and what was measured (load, mode)."""
    low, middle, high = predicted
    loads, modes = found.loads, test.shape[1]
    shades = load_colours(len(loads))
    for k, load in enumerate(loads):
        place = np.arange(modes) + (k - (len(loads) - 1) / 2) * 0.7 / len(loads)
        colour = shades[k]
        ends = [100 * (1 - low[k] / middle[k]), 100 * (high[k] / middle[k] - 1)]
        label = load_text(load) + (", left out" if found.left_out[k] else "")
        ax.errorbar(np.zeros(modes), place, xerr=ends, fmt="|", color=colour, lw=2.2, ms=7, label=label)
        face = "white" if found.left_out[k] else colour
        ax.plot(100 * (test[k] / middle[k] - 1), place, "s", ms=4, mfc=face, mec=colour, mew=1.3)
    last = [f"{value:.0f} {unit}" if unit else f"loss {value:.2g}" for value in middle[-1]]
    ax.set_yticks(range(modes), [f"{k + 1}: {text}" for k, text in enumerate(last)])
    ax.set_xlabel("difference from the median [%]; bars 5 to 95 %, squares measured")
    ax.invert_yaxis()
    ax.grid(axis="x", alpha=0.3)
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=4)
