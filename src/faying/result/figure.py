"""Figures of a bolted structure: pressure on the joint, frequencies against preload, mode shapes."""

from typing import TYPE_CHECKING, Any

import numpy as np

from faying.fe.figure import draw_shape
from faying.joint.figure import PressureMap
from faying.result.maps import joint_map_of
from faying.result.result import Result
from faying.style import axes_of, new_figure, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def pressure_map(ax: Any, result: Result, load: int = -1, joint: int = 0, *, bar: bool = True) -> Any:
    """Draw the pressure [MPa] on one joint at one load along the axes of the model; no contact stays pale.

    The colours span all loads and joints. Values are shaded over the elements, as `faying.fe.face_map` says; of a
    result of an earlier version, whose file has no faces, points are drawn.
    """
    here = result.joint_of_point == joint
    found = joint_map_of(result, joint)
    share = float(result.weights[here] @ (result.pressure[load][here] <= 0) / result.weights[here].sum())
    return PressureMap(
        places=result.points[here] if found is None else result.outline[found.parents].mean(axis=1),
        triangles=None if found is None else found.triangles,
        values=result.pressure[load][here] if found is None else found.fields["pressure"][load],
        most=float(result.pressure.max()),
        areas=result.weights[here],
        title=f"{plain(result.joints[joint])}, {result.loads[load] / 1e3:g} kN: open on {share:.0%}",
    ).draw(ax, bar=bar)


def frequencies(ax: Any, result: Result, modes: int = 8) -> Any:
    """Draw frequency against preload, each mode relative to its bonded value; free bounds lie far below and are
    listed."""
    load = result.loads * 1e-3
    count = min(modes, len(result.bonded))
    for mode in range(count):
        ratio = result.frequencies[:, mode] / result.bonded[mode]
        bounds = result.free[mode], result.frequencies[-1, mode], result.bonded[mode]
        ax.plot(
            load,
            ratio,
            "o-",
            color=f"C{mode % 10}",
            ms=4,
            lw=1.4,
            label=f"{mode + 1}: {' / '.join(f'{f:.0f}' for f in bounds)} Hz",
        )
    ax.axhline(1, color="k", lw=0.8, ls="--")
    ax.set(
        xlabel="preload per bolt [kN]",
        ylabel="frequency / bonded frequency [-]",
        title="free / predicted at the last load / bonded",
    )
    ax.legend(fontsize=7, loc="best")
    ax.grid(alpha=0.3)
    return ax


def frequency_axes(result: Result, modes: int, ax: Any = None) -> "list[Axes]":
    """Draw frequency [Hz] against preload [kN], one axes for each of the first modes, with bands and the test."""
    axes = axes_of(ax, modes, width=3.4, height=2.7, columns=3)
    load = result.loads * 1e-3
    for mode, one in enumerate(axes):
        if result.interval_low is not None:
            _band(one, load, result.interval_low, result.interval_high, mode, "C0", "5 to 95 %")
        else:
            _band(one, load, result.low, result.high, mode, "C0", "range of the law")
        one.plot(load, result.frequencies[:, mode], "o-", color="C0", ms=4, lw=1.4, label="Faying")
        for k, name in enumerate(result.beside):
            if result.beside_frequencies is not None:
                one.plot(
                    load, result.beside_frequencies[k, :, mode], ".--", color=f"C{k + 3}", lw=1.0, label=plain(name)
                )
        c = result.comparison
        if c is not None:
            found = c.modes == mode
            rows, columns = np.nonzero(found)
            style: dict[str, Any] = {"mfc": "none", "mec": "0.2", "ms": 6, "mew": 1.2}
            one.plot(load[rows], c.frequencies[rows, columns], "o", label=c.reference, **style)
        one.set_title(f"mode {mode + 1}, bonded {result.bonded[mode]:.1f} Hz", fontsize=9)
        one.set(xlabel="preload per bolt [kN]", ylabel="frequency [Hz]")
        one.ticklabel_format(axis="y", useOffset=False)
        one.grid(alpha=0.3)
    axes[0].legend(fontsize=7)
    return axes


def _band(ax: Any, load: Any, low: Any, high: Any, mode: int, color: str, label: str) -> None:
    """The band between two frequencies (load, mode), as bars where there is one load."""
    if low is None or high is None:
        return
    if len(load) > 1:
        ax.fill_between(load, low[:, mode], high[:, mode], color=color, alpha=0.18, lw=0, label=label)
    else:
        ax.vlines(load, low[:, mode], high[:, mode], color=color, alpha=0.35, lw=6, label=label)


def comparison(ax: Any, result: Result) -> Any:
    """Draw the error of prediction and of the published model against the test, mode by mode."""
    c = result.comparison
    if c is None:
        ax.text(0.5, 0.5, "no reference in this study", ha="center", va="center")
        return ax
    modes = np.arange(1, c.frequencies.shape[1] + 1)
    for row, load in enumerate(result.loads):
        error = 100 * (c.predicted[row] / c.frequencies[row] - 1)
        ax.plot(modes, error, "o-", color=f"C{row}", label=f"Faying, {load / 1e3:g} kN")
        if c.published is not None:
            theirs = 100 * (c.published[row] / c.frequencies[row] - 1)
            ax.plot(modes, theirs, "x:", color=f"C{row}", label=f"{plain(c.published_name)}, {load / 1e3:g} kN")
    ax.axhline(0, color="k", lw=0.8)
    ax.set(xlabel=f"mode of the {c.reference}", ylabel=f"error [% of the {c.reference}]", xticks=modes)
    ax.legend(fontsize=7)
    ax.grid(alpha=0.3)
    return ax


def pressures(result: Result) -> Any:
    """Return a figure of the pressure on each joint at the least and the greatest preload."""
    loads = sorted({0, len(result.loads) - 1})
    wide = [result.points[result.joint_of_point == joint] for joint in range(len(result.joints))]
    spans = [np.sort(np.ptp(points, axis=0)) for points in wide]
    tall = max((float(min(one[1] / one[2], 1.0)) if one[2] > 0 else 1.0) for one in spans)
    fig = new_figure(5.2 * len(loads), (1.1 + 3.6 * max(tall, 0.3)) * len(result.joints))
    for joint in range(len(result.joints)):
        for column, load in enumerate(loads):
            ax = fig.add_subplot(len(result.joints), len(loads), joint * len(loads) + column + 1)
            pressure_map(ax, result, load, joint, bar=column == len(loads) - 1)
    return fig


def mode_shape(ax: Any, result: Result, mode: int, load: int = -1) -> Any:
    """Draw one mode shape on 3-D axes, deformed, coloured by the size of its motion."""
    draw_shape(ax, result.outline, result.triangles, result.shapes[load, mode])
    ax.set_title(
        f"{mode + 1}: {result.frequencies[load, mode]:.0f} Hz"
        + ("" if np.isnan(eta := result.loss_factors[load, mode]) else f", loss {eta:.1e}"),
        fontsize=9,
    )
    return ax


def mode_shapes(result: Result, modes: int = 8, load: int = -1) -> Any:
    """Return a figure of the first mode shapes."""
    count = min(modes, len(result.bonded))
    columns = min(4, count)
    rows = -(-count // columns)
    x, y, z = np.ptp(result.outline, axis=0)
    fig = new_figure(2.6 * columns, float(np.clip(2.6 * z / max(np.hypot(x, y), 1e-12), 1.5, 2.9) + 0.3) * rows)
    for mode in range(count):
        mode_shape(fig.add_subplot(rows, columns, mode + 1, projection="3d"), result, mode, load)
    return fig


def law_curves(result: Result) -> Any:
    """Return k_n, k_t of the joints' points against pressure, open points left out, at the greatest load."""
    fig = new_figure(7.0, 4.2)
    ax = fig.add_subplot()
    pressure = result.pressure[-1]
    for joint, name in enumerate(result.joints):
        here = (result.joint_of_point == joint) & (pressure > 1e-3 * pressure.max())
        order = np.argsort(pressure[here])
        p = pressure[here][order] * 1e-6
        ax.plot(p, result.k_n[-1][here][order] * 1e-12, "-", color=f"C{joint}", label=f"{plain(name)}: k_n")
        ax.plot(p, result.k_t[-1][here][order] * 1e-12, "--", color=f"C{joint}", label=f"{plain(name)}: k_t")
    ax.set(xscale="log", yscale="log", xlabel="pressure [MPa]", ylabel="stiffness per area [MPa/um]")
    ax.legend(fontsize=8)
    ax.grid(alpha=0.3, which="both")
    return fig
