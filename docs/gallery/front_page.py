"""
The T-specimen at a glance
==========================

The picture of the README: a mode in space, the pressure on the joint, a frequency with its interval and the hammer
test, all measured modes with their intervals, and damping against level.

.. image:: /figures/t-specimen.png
   :alt: T-specimen: mode shape, pressure on the joint, frequencies with intervals and hammer test, damping
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np

import faying
from faying.fe.figure import draw_shape_flat
from faying.result import Result
from faying.result.figure import face_map
from faying.result.interval_figure import damping_of
from faying.style import COLOURS, SOFT, WIDE, drawing, new_figure, save
from faying.units import load_text

MODE = 0  # of the test, from 0


def lying(result: Result, mode: int) -> tuple[Any, Any]:
    """Surface and shape (n, 3) turned so that the longest side lies along x, and the motion goes up where it can."""
    longest = int(np.argmax(np.ptp(result.outline, axis=0)))
    shape = np.asarray(result.shapes[-1, mode], float)
    others = [k for k in range(3) if k != longest]
    up = max(others, key=lambda k: float((shape[:, k] ** 2).sum()))
    depth = next(k for k in others if k != up)
    order = [longest, depth, up]
    turn = np.eye(3)[order]
    turn[1] *= np.linalg.det(turn)  # no mirror image
    return result.outline @ turn.T, shape @ turn.T


def shape(ax: Any, result: Result, mode: int) -> None:
    """Draw a mode shape at the last load."""
    points, motion = lying(result, mode)
    draw_shape_flat(ax, points, result.triangles, motion)
    ax.set_title(f"mode {MODE + 1} of the test: {result.frequencies[-1, mode]:.0f} Hz at {load_text(result.loads[-1])}")


def in_the_test(ax: Any, result: Result) -> None:
    """Draw a frequency over preload with its interval, the test, and bonded faces."""
    load, rows = result.loads / 1e3, np.arange(len(result.loads))
    test, places, low, high = measured(result)
    places = places[:, MODE]
    ax.fill_between(load, low[:, MODE], high[:, MODE], color=COLOURS[0], alpha=0.2, lw=0, label="5 to 95 %")
    ax.plot(load, result.frequencies[rows, places], "o-", color=COLOURS[0], label="computed")
    ax.plot(load, test[:, MODE], "s", mfc="white", mec="black", mew=1.2, ms=5, label="hammer test")
    ax.axhline(result.bonded[places[-1]], color=SOFT, ls=":", lw=1.2, label="faces bonded")
    ax.set(xlabel="preload of each bolt [kN]", ylabel="frequency [Hz]", xticks=load)
    ax.set_title(f"frequency of mode {MODE + 1}")
    ax.grid(alpha=0.3)


def all_measured(ax: Any, result: Result) -> None:
    """Draw the interval of each measured mode at the last load, and the test: inside or not."""
    test, places, low, high = measured(result)
    f = result.frequencies[-1, places[-1]]
    y = np.arange(len(f))
    ends = 100 * (low[-1] / f - 1), 100 * (high[-1] / f - 1)
    ax.barh(y, ends[1] - ends[0], left=ends[0], height=0.4, color=COLOURS[0], alpha=0.2, lw=0)
    ax.plot(np.zeros(len(f)), y, "o", color=COLOURS[0])
    ax.plot(100 * (test[-1] / f - 1), y, "s", mfc="white", mec="black", mew=1.2, ms=5)
    inside = (low[-1] <= test[-1]) & (test[-1] <= high[-1])
    ax.set_yticks(y, [f"{k + 1}: {value:.0f} Hz" for k, value in enumerate(test[-1])])
    ax.invert_yaxis()
    ax.set_xlabel("test over computed, less 1 [%]")
    ax.set_title(f"{inside.sum()} of {len(inside)} inside at {load_text(result.loads[-1])}")
    ax.grid(axis="x", alpha=0.3)


def measured(result: Result) -> tuple[Any, Any, Any, Any]:
    """Measured frequencies (load, test mode) [Hz], the modes that they are paired with, and the ends of these."""
    c = result.comparison
    assert c is not None
    assert result.interval is not None
    rows = np.arange(len(result.loads))[:, None]
    return c.frequencies, c.modes, result.interval.low[rows, c.modes], result.interval.high[rows, c.modes]


@drawing
def draw(result: Result) -> Any:
    """Return the figure."""
    mode = int(measured(result)[1][-1, MODE])
    fig = new_figure(WIDE, 4.6)
    upper, lower = fig.subfigures(2, 1, height_ratios=(1.0, 1.15))
    left, face = upper.subplots(1, 2)
    shape(left, result, mode)
    upper.colorbar(face_map(face, result, "pressure"), ax=face, label="pressure [MPa]", shrink=0.85, pad=0.02)
    one, every, damping = lower.subplots(1, 3)
    in_the_test(one, result)
    all_measured(every, result)
    damping_of(damping, result, mode)
    damping.set(xlabel="peak acceleration [m/s²]", ylabel="damping ratio [%]")
    damping.set_title(f"damping of mode {MODE + 1}")
    lower.legend(*one.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return fig


if __name__ == "__main__":
    # a result that is there already may be named; the site's build computes it
    root = Path(sys.argv[0]).resolve().parents[2]  # the gallery has no __file__
    study = root / "examples" / "t-specimen" / "study.toml"
    found = Result.load(sys.argv[1]) if sys.argv[1:] else faying.run(study)
    save(draw(found), root / "docs" / "figures" / "t-specimen.png")
