"""Figures of a bolted structure: pressure on the joint, frequencies against preload, mode shapes."""

from typing import Any

import numpy as np

from faying.output.figures.save import new_figure, plain
from faying.output.scene.build import joint_map_of
from faying.result import Result


def pressure_map(ax: Any, result: Result, load: int = -1, joint: int = 0, *, bar: bool = True) -> Any:
    """Draw the pressure [MPa] on one joint at one load along the axes of the model; no contact stays pale.

    The colours span all loads and joints. Values are shaded over the elements, as `faying.output.scene.maps` says; of a
    result of an earlier version, whose file has no faces, points are drawn.
    """
    here = result.joint_of_point == joint
    found = joint_map_of(result, joint)
    places = result.points[here] if found is None else result.outline[found.parents].mean(axis=1)
    across = int(np.argmin(np.ptp(places, axis=0)))  # the axis that the face lies across
    x, y = (k for k in range(3) if k != across)
    most = max(float(result.pressure.max()), 1e-300) * 1e-6
    style: dict[str, Any] = {"cmap": _pale(), "vmin": 1e-6 * most, "vmax": most}
    if found is None:
        values = result.pressure[load][here] * 1e-6
        area = 2e5 * result.weights[here] / max(float(np.prod(np.ptp(places[:, [x, y]], axis=0))), 1e-300)
        drawn = ax.scatter(*(places[:, [x, y]].T * 1e3), c=values, s=area, linewidths=0, rasterized=True, **style)
    else:
        values = found.fields["pressure"][load] * 1e-6
        grid = (*(places[:, [x, y]].T * 1e3), found.triangles)
        drawn = ax.tripcolor(*grid, values, shading="gouraud", rasterized=True, **style)
    if bar:
        ax.figure.colorbar(drawn, ax=ax, label="pressure [MPa]", shrink=0.8)
    share = float(result.weights[here] @ (result.pressure[load][here] <= 0) / result.weights[here].sum())
    ax.set(
        aspect="equal",
        xlabel=f"{'xyz'[x]} [mm]",
        ylabel=f"{'xyz'[y]} [mm]",
        title=f"{plain(result.joints[joint])}, {result.loads[load] / 1e3:g} kN: open on {share:.0%}",
    )
    ax.title.set_fontsize(10)
    return ax


def _pale() -> Any:
    """The colour map of the pressure: pale where there is none."""
    from matplotlib import colormaps

    return colormaps["viridis"].with_extremes(under="0.9")


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
    from matplotlib import colormaps
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    shape = result.shapes[load, mode]
    size = float(np.linalg.norm(np.ptp(result.outline, axis=0)))
    motion = np.linalg.norm(shape, axis=1)
    moved = (result.outline + 0.06 * size * shape / motion.max()) * 1e3
    colour = motion[result.triangles].mean(axis=1) / motion.max()
    surface = Poly3DCollection(
        moved[result.triangles], facecolors=colormaps["viridis"](colour), edgecolors="none", linewidths=0
    )
    ax.add_collection3d(surface)
    low, high = moved.min(axis=0), moved.max(axis=0)
    ax.set_xlim(low[0], high[0])
    ax.set_ylim(low[1], high[1])
    ax.set_zlim(low[2], high[2])
    ax.set_box_aspect(high - low)
    ax.set_axis_off()
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
        axis.set_visible(False)  # or a layout measures its labels, although none is drawn
    ax.view_init(elev=12, azim=-62)
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
