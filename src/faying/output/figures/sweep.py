"""Figures of a sweep: frequencies along one axis, maps over two."""

from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import InputError
from faying.style import (
    COLOURS,
    COLUMN,
    WIDE,
    check_figure,
    colour,
    drawing,
    new_figure,
    plain,
    plain_numbers,
    prefixed,
)
from faying.sweeps.axes import Axis
from faying.sweeps.files import Sweep
from faying.typeset import name_of

MAPS = 4


def check(path: str | Path, axes: int) -> None:
    """Raise InputError, before anything is computed, for a figure that cannot be drawn or written."""
    check_figure(path)
    if axes > 2:
        raise InputError(f"a figure shows one or two axes and the sweep has {axes}; leave out --plot, or fix some axes")


def _scale(axis: Axis) -> tuple[Any, str, bool]:
    """Values to draw, the label with the unit, and whether they are spaced by a factor; texts count from 0."""
    if not axis.numeric:
        return np.arange(len(axis.values), dtype=float), name_of(axis.key), False
    values = np.array(axis.values, dtype=float)
    factor, unit = prefixed(values, axis.unit)
    spaced = len(values) > 2 and values.min() > 0
    log = bool(spaced and np.ptp(np.diff(np.log(values))) < 1e-6 * abs(np.log(values[-1] / values[0])))
    return values / factor, name_of(axis.key) + (f" [{unit}]" if unit else ""), log


def _ticks(axis: Axis, place: Any) -> None:
    if not axis.numeric:
        place(range(len(axis.values)), [plain(str(v)) for v in axis.values])


@drawing
def relative_change(ax: Any, sweep: Sweep) -> Any:
    """Draw each mode's frequency along the one axis, relative to its first value that has an answer [%]."""
    axis = sweep.axes[0]
    x, label, log = _scale(axis)
    for mode in range(sweep.frequencies.shape[-1]):
        f = sweep.frequencies[..., mode].reshape(len(x), -1)[:, 0]
        known = np.flatnonzero(np.isfinite(f))
        if not len(known):
            continue
        first, last = f[known[0]], f[known[-1]]
        line = ("-", "--", "-.")[mode // len(COLOURS) % 3] if axis.numeric else "none"
        look = {"marker": ".", "color": colour(mode), "ls": line, "ms": 3.5}
        ax.plot(x, 100 * (f / first - 1), label=f"{mode + 1}: {first:.1f} to {last:.1f} Hz", **look)
    ax.set(xlabel=label, ylabel="change of frequency [%]")
    if log:
        ax.set_xscale("log")
        plain_numbers(ax.xaxis)
    _ticks(axis, ax.set_xticks)
    ax.legend(title="mode", loc="center left", bbox_to_anchor=(1.0, 0.5))
    ax.grid(alpha=0.3)
    return ax


@drawing
def frequency_map(ax: Any, sweep: Sweep, mode: int = 0) -> Any:
    """Draw one mode's frequency [Hz] over two axes; points without an answer stay grey."""
    (x, across, x_log), (y, up, y_log) = (_scale(axis) for axis in sweep.axes[:2])
    drawn = ax.pcolormesh(
        *np.meshgrid(x, y), np.ma.masked_invalid(sweep.frequencies[..., mode].T), cmap="viridis", shading="nearest"
    )
    ax.set_facecolor("0.85")
    ax.figure.colorbar(drawn, ax=ax, label="frequency [Hz]", shrink=0.9)
    ax.set(xlabel=across, ylabel=up, title=f"mode {mode + 1}")
    ax.locator_params(axis="x", nbins=4) if not x_log else None
    for log, scale, axis_of in ((x_log, ax.set_xscale, ax.xaxis), (y_log, ax.set_yscale, ax.yaxis)):
        if log:
            scale("log")
            plain_numbers(axis_of)
    for axis, place in zip(sweep.axes, (ax.set_xticks, ax.set_yticks), strict=False):
        _ticks(axis, place)
    return ax


@drawing
def figure(sweep: Sweep) -> Any:
    """Return the figure of a sweep: changes along one axis, or maps of modes 1 to 4 over two."""
    if len(sweep.axes) == 1:
        fig = new_figure(WIDE, max(3.0, 0.7 + 0.17 * sweep.frequencies.shape[-1]))
        relative_change(fig.add_subplot(), sweep)
        return fig
    count = min(MAPS, sweep.frequencies.shape[-1])
    columns = min(2, count)
    rows = -(-count // columns)
    fig = new_figure(WIDE if columns > 1 else COLUMN, 2.6 * rows)
    for mode in range(count):
        frequency_map(fig.add_subplot(rows, columns, mode + 1), sweep, mode)
    return fig
