"""Figures of a frequency response, and of the MAC between preloads."""

from typing import Any

import numpy as np

from faying.result.result import Result
from faying.style import COLUMN, SMALL, TALLEST, WIDE, drawing, legend_above, load_colours, new_figure
from faying.units import in_mm, load_text

WRITTEN = 6  # modes at most for which the values of MAC stand in the map


def _curves(ax: Any, result: Result, output: int, input: int, of: Any) -> None:
    response = result.response
    assert response is not None
    f = response.frequencies
    shades = load_colours(len(result.loads))
    for load, receptance, shade in zip(result.loads, response.values, shades, strict=True):
        values = -((2 * np.pi * f) ** 2) * receptance[:, output, input]
        ax.plot(f, of(values), color=shade, lw=1.0, label=load_text(load))
    ax.set(xlabel="frequency [Hz]", xlim=(f[0], f[-1]))
    ax.grid(alpha=0.3)


@drawing
def amplitude(ax: Any, result: Result, output: int = 0, input: int = 0) -> Any:
    """Draw the size of the accelerance between an output and an input of the response, at every preload."""
    _curves(ax, result, output, input, np.abs)
    assert result.response is not None
    (at, along), (place, push) = result.response.outputs[output], result.response.inputs[input]
    ax.set(yscale="log", ylabel="|accelerance| [m/s²/N]")
    legend_above(ax, 4)
    ax.set_title(f"{words(at, along)}, force at {words(place, push)}", loc="left", pad=18)
    return ax


@drawing
def phase(ax: Any, result: Result, output: int = 0, input: int = 0) -> Any:
    """Draw the phase of the accelerance, -180 to 180 degrees, at every preload; broken where it wraps around."""

    def angle(values: Any) -> Any:
        degrees = np.degrees(np.angle(values))
        return np.where(np.abs(np.diff(degrees, prepend=degrees[0])) > 180, np.nan, degrees)

    _curves(ax, result, output, input, angle)
    ax.set(ylabel="phase [°]", ylim=(-190, 190), yticks=range(-180, 181, 90))
    return ax


def words(point: Any, axis: Any) -> str:
    """A degree of freedom in words: (40, 0, 15) mm along z."""
    parts = ", ".join(f"{x:.2f}" for x in np.array(axis) / np.linalg.norm(axis))
    return f"{in_mm(point)} along {axis_name(axis) or f'({parts})'}"


def axis_name(direction: Any) -> str | None:
    """x, -x, y ... of a direction along an axis, to a degree; None for others."""
    unit = np.array(direction) / np.linalg.norm(direction)
    k = int(np.abs(unit).argmax())
    if abs(unit[k]) < 0.9998:
        return None
    return ("-" if unit[k] < 0 else "") + "xyz"[k]


@drawing
def responses(result: Result, most: int = 4) -> Any:
    """Return a figure of the first pairs of output and input: amplitude, with the phase below it."""
    assert result.response is not None
    pairs = list(np.ndindex(*result.response.values.shape[2:]))[:most]
    fig = new_figure(WIDE, min(3.4 * len(pairs), 1.3 * TALLEST))
    axes = fig.subplots(2 * len(pairs), 1, squeeze=False, height_ratios=[2, 1] * len(pairs))[:, 0]
    for k, (o, i) in enumerate(pairs):
        amplitude(axes[2 * k], result, o, i)
        phase(axes[2 * k + 1], result, o, i)
    return fig


@drawing
def mac_between_loads(ax: Any, result: Result, load: int = -1) -> Any:
    """Draw the MAC of the modes at the first preload (rows) with those at another (columns)."""
    table = result.mac[load]
    image = ax.imshow(table, cmap="Blues", vmin=0, vmax=1, aspect="equal")
    ax.figure.colorbar(image, ax=ax, label="MAC", shrink=0.8)
    if len(table) <= WRITTEN:
        for row, column in np.ndindex(table.shape):
            if table[row, column] >= 0.005:
                shade = "white" if table[row, column] > 0.6 else "0.2"
                text = f"{table[row, column]:.2f}"
                ax.text(column, row, text, ha="center", va="center", fontsize=SMALL, color=shade, in_layout=False)
    count = range(len(table))
    step = 1 if len(table) <= 10 else 2
    ax.set_xticks(count[::step], [str(k + 1) for k in count[::step]])
    ax.set_yticks(count[::step], [str(k + 1) for k in count[::step]])
    ax.spines[:].set_visible(False)
    ax.set(xlabel=f"mode at {result.load_names[load]}", ylabel=f"mode at {result.load_names[0]}")
    return ax


@drawing
def macs(result: Result, most: int = 4) -> Any:
    """Return a figure of the MAC between the first preload and the last of the others."""
    loads = range(1, len(result.loads))[-most:]
    columns = min(2, len(loads))
    rows = -(-len(loads) // columns)
    fig = new_figure((COLUMN, WIDE)[columns - 1], 2.9 * rows)
    for column, load in enumerate(loads):
        mac_between_loads(fig.add_subplot(rows, columns, column + 1), result, load)
    return fig
