"""Figures of a bolted structure: pressure and slip on joints, frequencies against preload, the test, mode shapes."""

from typing import TYPE_CHECKING, Any

import numpy as np

from faying.fe.figure import draw_shape_flat, frame_of, moved_by
from faying.joint.figure import DrawnFace, in_plane
from faying.result.maps import joint_map_of
from faying.result.run_record import RunRecord
from faying.result.shape_names import shape_name
from faying.style import (
    COLOURS,
    INK,
    SMALL,
    SOFT,
    TALLEST,
    WIDE,
    axes_of,
    colour,
    drawing,
    legend_above,
    load_colours,
    new_figure,
    percent,
    plain,
    shared_legend,
)
from faying.text import listed
from faying.typeset import typeset, unit
from faying.units import load_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TEST_MARK: dict[str, Any] = {"mfc": "white", "mec": "black", "ms": 4.5, "mew": 1.1, "ls": "none"}
FACE_FIELDS = {"pressure": ("pressure [MPa]", 1e6), "slip": ("slip [µm]", 1e-6)}
BONDED_ROOM = 1.0  # how far a bonded frequency may lie above the curves to be drawn, of the height of the curves


@drawing
def face_map(ax: Any, result: RunRecord, field: str, load: int = -1, joint: int = 0) -> Any:
    """Draw pressure or slip on one joint at one load, on its face at one scale, and return what a colour bar needs.

    The colours span all loads and joints; what is open stays pale, and a line marks the edge of contact. Values are
    shaded over the elements, as `faying.fe.face_map` says; where all triangles of the joint belong to other faces too,
    points are drawn.
    """
    here = result.joint_of_point == joint
    found = joint_map_of(result, joint, contact=True)
    every = getattr(result, field)
    share = float(result.weights[here] @ (result.pressure[load][here] <= 0) / result.weights[here].sum())
    label, unit = FACE_FIELDS[field]
    return DrawnFace(
        places=result.points[here] if found is None else result.outline[found.parents].mean(axis=1),
        triangles=None if found is None else found.triangles,
        values=every[load][here] if found is None else found.fields[field][load],
        contact=(result.pressure[load][here] > 0).astype(float) if found is None else found.fields["contact"][load],
        most=float(every.max()),
        areas=result.weights[here],
        label=label,
        unit=unit,
        title=f"{plain(result.joints[joint])}, {result.load_names[load]}: {percent(share)} open",
    ).paint(ax)


@drawing
def faces(result: RunRecord, field: str) -> Any:
    """Return a figure of pressure or slip on each joint at the first and the last preload."""
    loads = sorted({0, len(result.loads) - 1})
    tall = []
    for joint in range(len(result.joints)):
        flat, _ = in_plane(result.points[result.joint_of_point == joint])
        across, up = np.ptp(flat, axis=0)
        tall.append(float(np.clip(up / across, 0.15, 1.6)) if across > 0 else 1.0)
    width = (WIDE - 0.8) / len(loads) - 0.55
    heights = [0.75 + width * one for one in tall]
    fig = new_figure(WIDE, min(sum(heights), TALLEST * len(heights)))
    axes = fig.subplots(len(result.joints), len(loads), squeeze=False, height_ratios=heights)
    painted = [
        face_map(axes[joint, column], result, field, load, joint)
        for joint in range(len(result.joints))
        for column, load in enumerate(loads)
    ]
    for column in range(1, len(loads)):
        for ax in axes[:, column]:
            ax.set_ylabel("")
    fig.colorbar(painted[0], ax=list(axes.flat), label=FACE_FIELDS[field][0], fraction=0.04, pad=0.015, aspect=18)
    return fig


@drawing
def frequencies(result: RunRecord) -> Any:
    """Return a figure of every mode's frequency against preload, with its band and the test."""
    fig, axes = mode_panels(result.frequencies.shape[1], sharex=True)
    for mode, ax in enumerate(axes):
        _against_preload(ax, result, mode)
    fig.supxlabel("preload of each bolt [kN]")
    fig.supylabel("frequency [Hz]")
    shared_legend(fig, axes)
    return fig


def mode_panels(count: int, **shared: bool) -> tuple[Any, list[Any]]:
    """A figure of one small axes for each mode, four in a row; shared: sharex and sharey of `subplots`."""
    columns = min(4, count)
    rows = -(-count // columns)
    fig = new_figure(WIDE, min(0.7 + 1.45 * rows, 0.7 + TALLEST))
    axes = list(fig.subplots(rows, columns, squeeze=False, **shared).flat)
    for number, ax in enumerate(axes):
        ax.set_visible(number < count)
        ax.tick_params(labelbottom=number + columns >= count)
    return fig, axes[:count]


@drawing
def frequency_axes(result: RunRecord, modes: int, ax: Any = None) -> "list[Axes]":
    """Draw frequency [Hz] against preload [kN], one axes for each of the first modes, with bands and the test."""
    axes = axes_of(ax, modes, width=WIDE / 3, height=1.9, columns=3)
    for mode, one in enumerate(axes):
        _against_preload(one, result, mode)
        one.set(xlabel="preload of each bolt [kN]", ylabel="frequency [Hz]")
    if ax is None:
        shared_legend(axes[0].figure, axes)
    else:
        axes[0].legend()
    return axes


def _against_preload(ax: Any, result: RunRecord, mode: int) -> None:
    """One mode: band, curve of the study, other laws, the test, and bonded faces where they lie near."""
    load, f = result.loads * 1e-3, result.frequencies[:, mode]
    if result.interval is not None:
        ends = tuple(result.interval.ends[:, :, mode])
        band(ax, load, *ends, label="5 to 95 %")
    elif result.low is not None and result.high is not None:
        ends = result.low[:, mode], result.high[:, mode]
        band(ax, load, *ends, label="range of the law")
    else:
        ends = f, f
    line = "o-" if len(load) > 1 else "D"
    if result.interval is not None:
        ax.plot(load, result.interval.best[:, mode], line, color=COLOURS[0], ms=3, label="best estimate")
        ax.plot(load, f, ".:", color="black", ms=4, lw=1.0, label="as modelled")
    else:
        ax.plot(load, f, line, color=COLOURS[0], ms=3, label="as modelled")
    if (others := result.alternatives) is not None:
        for k, name in enumerate(others.names):
            of_law = others.frequencies[k, :, mode]
            ax.plot(load, of_law, ".--", color=colour(k + 2), ms=4, lw=1.0, label=plain(name))
    if (c := result.comparison) is not None:
        rows, columns = np.nonzero(c.modes == mode)
        if len(rows):
            ax.plot(load[rows], c.frequencies[rows, columns], "s", label=c.reference, **TEST_MARK)
    low, high = float(np.min(ends)), float(np.max(ends))
    bonded = np.inf if result.bonded is None else result.bonded[mode]
    if high < bonded <= high + BONDED_ROOM * max(high - low, 1e-3 * high) or low <= bonded <= high:
        ax.axhline(bonded, color=SOFT, ls=":", lw=1.0, label="faces bonded")
    ax.set_title(f"mode {mode + 1}", pad=3)
    ax.grid(alpha=0.3)
    ax.margins(x=0.08, y=0.12)
    ax.locator_params(axis="y", nbins=4)


@drawing
def quantity(result: RunRecord, name: str) -> Any:
    """Return the figure of a quantity that has a value for each preload: a line for each mode, joint, bolt or the like.

    name: of the field, whose declaration says what it is.
    """
    meta, values = result.shown()[name], np.asarray(getattr(result, name))
    fig = new_figure(WIDE, 3.2)
    ax = fig.add_subplot()
    for k, label in enumerate(result.labels()[meta.dims[1]]):
        ax.plot(result.loads * 1e-3, values[:, k], "o-", color=colour(k), ms=3, label=plain(str(label)))
    unit_text = f" [{unit(meta.unit)}]" if meta.unit != "1" else ""
    ax.set(xlabel="preload of each bolt [kN]", ylabel=f"{typeset(meta.shown.title)}{unit_text}")
    ax.grid(alpha=0.3)
    legend_above(ax, 4)
    return fig


def band(ax: Any, x: Any, low: Any, high: Any, *, label: str) -> None:
    """The band between two values at each place (x,), as a bar where there is one place."""
    if len(x) > 1:
        ax.fill_between(x, low, high, color=COLOURS[0], alpha=0.18, lw=0, label=label)
    else:
        ax.vlines(x, low, high, color=COLOURS[0], alpha=0.35, lw=6, label=label)


@drawing
def comparison(ax: Any, result: RunRecord) -> Any:
    """Draw the difference of study and published model from the test, one mark a mode and load.

    A bar is 5 to 95 %; the frequency as modelled may lie outside.
    """
    c = result.comparison
    if c is None:
        ax.text(0.5, 0.5, "no reference in this study", ha="center", va="center")
        return ax
    modes = np.arange(1, c.frequencies.shape[1] + 1)
    shades = load_colours(len(result.loads))
    for row, load in enumerate(result.loads):
        place = modes + (row - (len(result.loads) - 1) / 2) * 0.62 / len(result.loads)
        error = 100 * (c.predicted[row] / c.frequencies[row] - 1)
        ax.plot(place, error, "o", ms=4, color=shades[row], label=f"computed, {load_text(load)}")
        if result.interval is not None:
            here = np.where(c.modes[row] < 0, np.nan, result.interval.ends[:, row, np.maximum(c.modes[row], 0)])
            ax.vlines(place, *(100 * (here / c.frequencies[row] - 1)), color=shades[row], lw=2.0)
        if c.published is not None:
            theirs = 100 * (c.published[row] / c.frequencies[row] - 1)
            ax.plot(place, theirs, "x", ms=5, color=shades[row], label=f"{plain(c.published_name)}, {load_text(load)}")
    ax.axhline(0, color=INK, lw=0.8)
    ax.set(xlabel=f"mode of the {c.reference}", ylabel=f"difference from the {c.reference} [%]", xticks=modes)
    ax.set_xlim(0.5, len(modes) + 0.5)
    ax.grid(axis="y", alpha=0.3)
    legend_above(ax, 2 if c.published is not None else 4)
    return ax


@drawing
def mode_shapes(result: RunRecord, load: int = -1) -> Any:
    """Return a sheet of all mode shapes at one load, in frames of one size and scale.

    Above each: frequency, name of the shape, and damping where the result has it.
    """
    count = result.frequencies.shape[1]
    shapes = [result.shapes[load, mode].astype(float) for mode in range(count)]
    frame = frame_of([result.outline, *(moved_by(result.outline, shape)[0] for shape in shapes)])
    wide, high = frame[1] - frame[0]
    tall = float(high / wide)
    columns = min(count, 6 if tall > 1.2 else 5 if tall > 0.6 else 4)
    rows = -(-count // columns)
    words = [shape_words(result, mode, load) for mode in range(count)]
    above = 0.06 + 0.145 * max(text.count("\n") + 1 for text in words)
    height = min(WIDE / columns * tall, 2.1, TALLEST / rows - above)
    fig = new_figure(WIDE, rows * (height + above))
    axes = fig.subplots(rows, columns, squeeze=False)
    for mode in range(rows * columns):
        ax = axes.flat[mode]
        ax.set_axis_off()
        if mode < count:
            draw_shape_flat(ax, result.outline, result.triangles, shapes[mode], frame=frame)
            ax.set_title(words[mode], fontsize=SMALL, pad=2)
    return fig


def shape_words(result: RunRecord, mode: int, load: int = -1) -> str:
    """Return what stands above a mode shape: frequency, name and damping, one a line."""
    lines = [f"{mode + 1}: {result.frequencies[load, mode]:.0f} Hz", plain(shape_name(result, mode, load))]
    found = result.levels
    if found is not None:
        k = len(found.accelerations) // 2
        lines.append(rf"$\zeta$ {100 * found.damping[load, k, mode]:.2g} % at {found.accelerations[k]:g} m/s²")
    elif np.isfinite(result.loss_factors[load, mode]):
        lines.append(rf"$\eta$ {100 * result.loss_factors[load, mode]:.2g} %")
    return "\n".join(filter(None, lines))


@drawing
def law_curves(ax: Any, result: RunRecord) -> Any:
    """Draw the stiffness of the joints' points against their pressure at the last load, open points left out."""
    pressure = result.pressure[-1]
    groups: dict[str, list[int]] = {}
    for joint, (surface, law) in enumerate(zip(result.surfaces, result.laws, strict=True)):
        groups.setdefault(repr((surface, law)), []).append(joint)
    for k, joints in enumerate(groups.values()):
        here = np.isin(result.joint_of_point, joints) & (pressure > 1e-3 * pressure.max())
        order = np.argsort(pressure[here])
        whose = f", {plain(listed([result.joints[j] for j in joints], 3))}" if len(groups) > 1 else ""
        for values, line, symbol in ((result.k_n, "-", "n"), (result.k_t, "--", "t")):
            stiffness = values[-1][here][order] * 1e-12
            label = rf"$k_\mathrm{{{symbol}}}${whose}"
            ax.plot(pressure[here][order] * 1e-6, stiffness, line, color=colour(k), label=label)
    ax.set(xscale="log", yscale="log", xlabel="pressure [MPa]", ylabel="stiffness per area [MPa/µm]")
    legend_above(ax, 2)
    ax.grid(alpha=0.3)
    return ax
