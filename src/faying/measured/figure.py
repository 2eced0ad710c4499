"""Figures of a hammer test: stabilisation diagram, MAC, FRFs over each other, mode shapes side by side."""

from typing import Any

import numpy as np

from faying.fe.figure import draw_flat, frame_of, projected_view, shades
from faying.measured.compare import ModalComparison
from faying.measured.frf import FRF
from faying.measured.identify import Identified
from faying.style import COLOURS, COLUMN, SMALL, TALLEST, WIDE, drawing, legend_above, new_figure
from faying.typeset import unit

MAX_PAIRS = 12  # of shapes in a figure
WRITTEN = 8  # modes at most for which the values of MAC stand in the map


@drawing
def stabilisation(ax: Any, found: Identified) -> Any:
    """Draw the poles over order, those that belong to a mode filled, with the sum of the FRFs behind them."""
    poles, frf = found.poles, found.frf
    behind = ax.twinx()
    behind.semilogy(frf.frequency, np.abs(frf.rows()).sum(axis=0), color="0.75", lw=1)
    behind.set_ylabel(f"sum of |{frf.quantity}| [{unit(frf.unit)}]", color="0.4")
    behind.spines["right"].set_visible(True)
    ax.set_zorder(behind.get_zorder() + 1)
    ax.patch.set_visible(False)
    stays = poles.track >= 0
    ax.plot(poles.frequency[~stays], poles.order[~stays], "x", color="0.6", ms=3, mew=0.6, label="other poles")
    ax.plot(poles.frequency[stays], poles.order[stays], "o", color=COLOURS[0], ms=3, label="of a mode")
    for f in found.modes.frequencies:
        ax.axvline(f, color=COLOURS[1], lw=0.6, zorder=0)
    ax.set(
        xlabel="frequency [Hz]",
        ylabel="order",
        xlim=(frf.frequency[0], frf.frequency[-1]),
        ylim=(0, poles.order.max() + 1),
    )
    legend_above(ax)
    return ax


@drawing
def frf_fit(ax: Any, found: Identified) -> Any:
    """Draw one measured FRF and what the modes make of it, by size."""
    frf = found.frf
    o, i = frf.measured[0]
    ax.semilogy(frf.frequency, np.abs(frf.values[o, i]), color="0.45", lw=1.2, label="measured")
    ax.semilogy(frf.frequency, np.abs(found.fit[0]), color=COLOURS[1], lw=0.9, label="modes and residuals")
    _frf_axes(ax, frf, o, i)
    return ax


@drawing
def identified(found: Identified) -> Any:
    """Return the figure of modes that were identified: the stabilisation diagram over the first FRF and its fit."""
    fig = new_figure(WIDE, 5.4)
    upper, lower = fig.subplots(2, 1, height_ratios=(1.3, 1))
    stabilisation(upper, found)
    frf_fit(lower, found)
    return fig


@drawing
def mac_map(ax: Any, comparison: ModalComparison) -> Any:
    """Draw the MAC of test against model with its values; the pairs have a frame."""
    from matplotlib.patches import Rectangle

    table = comparison.mac
    image = ax.imshow(table, cmap="Blues", vmin=0, vmax=1, aspect="equal")
    ax.figure.colorbar(image, ax=ax, label="MAC", shrink=0.8)
    if table.shape[1] <= WRITTEN:
        for t, m in np.ndindex(table.shape):
            shade = "white" if table[t, m] > 0.6 else "0.2"
            ax.text(m, t, f"{table[t, m]:.2f}", ha="center", va="center", fontsize=SMALL, color=shade)
    for t, m in comparison.pairs:
        ax.add_patch(Rectangle((m - 0.5, t - 0.5), 1, 1, fill=False, edgecolor=COLOURS[1], lw=1.8))
    ax.set_xticks(
        range(table.shape[1]), [f"{k + 1}: {f:.0f}" for k, f in enumerate(comparison.model.frequencies)], rotation=90
    )
    ax.set_yticks(range(table.shape[0]), [f"{k + 1}: {f:.0f}" for k, f in enumerate(comparison.test.frequencies)])
    ax.set(
        xlabel="model: mode, frequency [Hz]",
        ylabel="test: mode, frequency [Hz]",
        title=f"MAC at {len(comparison.dofs)} degrees of freedom",
    )
    return ax


@drawing
def frf_overlay(ax: Any, comparison: ModalComparison, output: int = 0, input: int = 0) -> Any:
    """Draw a measured FRF and the model's, by size."""
    frf, predicted = comparison.frf, comparison.predicted
    if frf is None or predicted is None or comparison.frac is None:
        ax.text(0.5, 0.5, "no FRF between points of the model", ha="center", va="center")
        return ax
    full = comparison.full is not None and comparison.full[output, input]
    label = f"model, {'full response' if full else 'elastic modes'}"
    ax.semilogy(frf.frequency, np.abs(frf.values[output, input]), color="0.45", lw=1.2, label="test")
    ax.semilogy(frf.frequency, np.abs(predicted[output, input]), color=COLOURS[0], lw=1.0, label=label)
    _frf_axes(ax, frf, output, input)
    size = np.abs(frf.values[output, input])
    ax.set_ylim(
        0.3 * max(np.quantile(size, 0.02), 1e-9 * size.max()),
        3 * max(size.max(), np.nanmax(np.abs(predicted[output, input]))),
    )
    ax.set_title(f"{ax.get_title(loc='left')}, FRAC {comparison.frac[output, input]:.2f}", loc="left", pad=18)
    return ax


def _frf_axes(ax: Any, frf: FRF, output: int, input: int) -> None:
    ax.set(
        xlabel="frequency [Hz]",
        ylabel=f"|{frf.quantity}| [{unit(frf.unit)}]",
        xlim=(frf.frequency[0], frf.frequency[-1]),
    )
    ax.set_title(f"{frf.outputs[output]}, force at {frf.inputs[input]}", loc="left", pad=18)
    legend_above(ax)
    ax.grid(alpha=0.3)


@drawing
def shape_test(ax: Any, comparison: ModalComparison, pair: int) -> Any:
    """Draw a measured shape on flat axes: the test's points at rest and moved, on the outline of the model."""
    t, m = comparison.pairs[pair]
    moved, rest = (projected_view(points)[0] for points in _test_motion(comparison, int(t), int(m)))
    model = comparison.model
    if len(model.triangles):
        draw_flat(ax, model.points, model.triangles, np.tile((0.9, 0.91, 0.92, 1.0), (len(model.triangles), 1)))
    order = list(dict.fromkeys(d.point for d in comparison.dofs))
    for a, b in comparison.test.lines:
        if a in order and b in order:
            ax.plot(*moved[[order.index(a), order.index(b)]].T, color=COLOURS[1], lw=0.7, alpha=0.6)
    for a, b in zip(rest, moved, strict=True):
        ax.plot(*np.stack([a, b]).T, color=COLOURS[1], lw=1.2)
    ax.plot(*rest.T, "o", color="0.5", ms=2)
    ax.plot(*moved.T, "o", color=COLOURS[1], ms=3)
    _framed(ax, comparison)
    loss = comparison.test.loss_factors[t]
    damping_text = "\n" + rf"$\eta$ {100 * loss:.2g} %" if np.isfinite(loss) else ""
    ax.set_title(f"test {t + 1}: {comparison.test.frequencies[t]:.1f} Hz{damping_text}", fontsize=SMALL, pad=2)
    return ax


@drawing
def shape_model(ax: Any, comparison: ModalComparison, pair: int) -> Any:
    """Draw the model's shape of the same pair on flat axes, deformed, with the test's points on it."""
    t, m = comparison.pairs[pair]
    model = comparison.model
    moved, motion = _model_motion(comparison, int(m))
    if len(model.triangles):
        draw_flat(ax, moved, model.triangles, shades(motion[model.triangles].mean(axis=1)))
    else:
        ax.plot(*projected_view(moved)[0].T, ".", color=COLOURS[0], ms=2)
    ax.plot(*projected_view(moved[np.unique(comparison.nodes)])[0].T, "o", color=COLOURS[1], ms=3)
    _framed(ax, comparison)
    ax.set_title(f"model {m + 1}: {model.frequencies[m]:.1f} Hz\nMAC {comparison.mac[t, m]:.2f}", fontsize=SMALL, pad=2)
    return ax


def _model_motion(comparison: ModalComparison, m: int) -> tuple[Any, Any]:
    """Points of the model moved by a shape (n, 3) [m], and the motion of each relative to the greatest."""
    model = comparison.model
    motion = np.linalg.norm(model.shapes[m], axis=1)
    return model.points + _size(comparison) * model.shapes[m] / motion.max(), motion / motion.max()


def _size(comparison: ModalComparison) -> float:
    """Length of the largest motion in a drawing [m]."""
    return 0.08 * float(np.linalg.norm(np.ptp(comparison.model.points, axis=0)))


def _test_motion(comparison: ModalComparison, t: int, m: int) -> tuple[Any, Any]:
    """Points of the test moved and at rest (p, 3) [m], with the sign of the model's shape and its size at those
    points."""
    shapes = comparison.test.at(comparison.dofs)[t]
    model = comparison.model_shapes()[m]
    values = (shapes * np.vdot(shapes, model)).real  # turned to the model's phase
    peak = np.abs(model).max() / np.linalg.norm(comparison.model.shapes[m], axis=1).max()
    values = values * peak / max(np.abs(values).max(), 1e-300)
    points = list(dict.fromkeys(d.point for d in comparison.dofs))
    rest = comparison.model.points[[comparison.places[p] for p in points]]
    motion = np.zeros_like(rest)
    for dof, axis, value in zip(comparison.dofs, comparison.axes, values, strict=True):
        motion[points.index(dof.point)] += value * axis
    return rest + _size(comparison) * motion, rest


def _frame_of_shapes(comparison: ModalComparison) -> Any:
    """One frame for all pairs: the model at rest and in each of its shapes, and the points of the test."""
    found = [comparison.model.points]
    for t, m in comparison.pairs:
        found += [_model_motion(comparison, int(m))[0], _test_motion(comparison, int(t), int(m))[0]]
    return frame_of(found)


def _framed(ax: Any, comparison: ModalComparison) -> None:
    low, high = _frame_of_shapes(comparison)
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    ax.set_axis_off()


@drawing
def shapes_side_by_side(comparison: ModalComparison) -> Any:
    """Return a figure of the pairs, two a row: the test's shape, the model's, in frames of one size."""
    count = min(MAX_PAIRS, len(comparison.pairs))
    if not count:
        fig = new_figure(COLUMN, 0.6)
        fig.text(0.5, 0.5, "no mode of the test found a partner", ha="center", va="center")
        return fig
    across = min(2, count)
    rows = -(-count // across)
    low, high = _frame_of_shapes(comparison)
    tall = float((high - low)[1] / (high - low)[0])
    height = float(np.clip(WIDE / (2 * across) * tall, 0.4, 2.2))
    fig = new_figure(WIDE, min(rows * (height + 0.4), 1.4 * TALLEST))
    axes = fig.subplots(rows, 2 * across, squeeze=False)
    for ax in axes.flat:
        ax.set_axis_off()
    for k in range(count):
        row, column = divmod(k, across)
        shape_test(axes[row, 2 * column], comparison, k)
        shape_model(axes[row, 2 * column + 1], comparison, k)
    return fig
