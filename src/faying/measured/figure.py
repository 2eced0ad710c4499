"""Figures of a hammer test: stabilisation diagram, MAC, FRFs over each other, mode shapes side by side."""

from typing import Any

import numpy as np

from faying.measured.compare import ModalComparison
from faying.measured.frf import FRF
from faying.measured.identify import Identified


def stabilisation(ax: Any, found: Identified) -> Any:
    """Draw the poles over order, those that belong to a mode filled, with the sum of the FRFs behind them."""
    poles, frf = found.poles, found.frf
    behind = ax.twinx()
    behind.semilogy(frf.frequency, np.abs(frf.rows()).sum(axis=0), color="0.75", lw=1)
    behind.set_ylabel(f"sum of |{frf.quantity}| [{frf.unit}]", color="0.5")
    ax.set_zorder(behind.get_zorder() + 1)
    ax.patch.set_visible(False)
    stays = poles.track >= 0
    ax.plot(poles.frequency[~stays], poles.order[~stays], "x", color="0.6", ms=3, mew=0.6, label="other poles")
    ax.plot(poles.frequency[stays], poles.order[stays], "o", color="C0", ms=3, label="of a mode")
    for f in found.modes.frequencies:
        ax.axvline(f, color="C3", lw=0.6, zorder=0)
    ax.set(
        xlabel="frequency [Hz]",
        ylabel="order",
        xlim=(frf.frequency[0], frf.frequency[-1]),
        ylim=(0, poles.order.max() + 1),
    )
    ax.legend(fontsize=7, loc="lower right", bbox_to_anchor=(1, 1), ncols=2, frameon=False)
    return ax


def frf_fit(ax: Any, found: Identified, row: int = 0) -> Any:
    """Draw one measured FRF and what the modes make of it, by size."""
    frf = found.frf
    o, i = frf.measured[row]
    ax.semilogy(frf.frequency, np.abs(frf.values[o, i]), color="0.45", lw=1.2, label="measured")
    ax.semilogy(frf.frequency, np.abs(found.fit[row]), color="C3", lw=0.9, label="modes and residuals")
    _frf_axes(ax, frf, o, i)
    return ax


def mac_map(ax: Any, comparison: ModalComparison) -> Any:
    """Draw the MAC of test against model with its values; the pairs have a frame."""
    table = comparison.mac
    image = ax.imshow(table, cmap="Blues", vmin=0, vmax=1, aspect="equal")
    ax.figure.colorbar(image, ax=ax, label="MAC [-]", shrink=0.8)
    for t, m in np.ndindex(table.shape):
        ax.text(
            m,
            t,
            f"{table[t, m]:.2f}",
            ha="center",
            va="center",
            fontsize=5,
            color="white" if table[t, m] > 0.6 else "0.3",
        )
    for t, m in comparison.pairs:
        ax.add_patch(_frame(int(m), int(t)))
    ax.set_xticks(
        range(table.shape[1]), [f"{k + 1}\n{f:.0f}" for k, f in enumerate(comparison.model.frequencies)], fontsize=7
    )
    ax.set_yticks(
        range(table.shape[0]), [f"{k + 1}: {f:.0f}" for k, f in enumerate(comparison.test.frequencies)], fontsize=7
    )
    ax.set(
        xlabel="mode of the model, its frequency [Hz]",
        ylabel="mode of the test: frequency [Hz]",
        title=f"MAC at {len(comparison.dofs)} degrees of freedom",
    )
    return ax


def _frame(m: int, t: int) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle((m - 0.5, t - 0.5), 1, 1, fill=False, edgecolor="C3", lw=1.8)


def frf_overlay(ax: Any, comparison: ModalComparison, output: int = 0, input: int = 0) -> Any:
    """Draw a measured FRF and the model's, by size."""
    frf, predicted = comparison.frf, comparison.predicted
    if frf is None or predicted is None or comparison.frac is None:
        ax.text(0.5, 0.5, "no FRF between points of the model", ha="center", va="center")
        return ax
    label = (
        "model, full response"
        if comparison.full is not None and comparison.full[output, input]
        else "model, elastic modes"
    )
    ax.semilogy(frf.frequency, np.abs(frf.values[output, input]), color="0.45", lw=1.2, label="test")
    ax.semilogy(frf.frequency, np.abs(predicted[output, input]), color="C0", lw=1.0, label=label)
    _frf_axes(ax, frf, output, input)
    size = np.abs(frf.values[output, input])
    ax.set_ylim(
        0.3 * max(np.quantile(size, 0.02), 1e-9 * size.max()),
        3 * max(size.max(), np.nanmax(np.abs(predicted[output, input]))),
    )
    ax.set_title(f"{ax.get_title()}, FRAC {comparison.frac[output, input]:.2f}", fontsize=9)
    return ax


def _frf_axes(ax: Any, frf: FRF, output: int, input: int) -> None:
    ax.set(xlabel="frequency [Hz]", ylabel=f"|{frf.quantity}| [{frf.unit}]", xlim=(frf.frequency[0], frf.frequency[-1]))
    ax.set_title(f"{frf.outputs[output]} / {frf.inputs[input]}", fontsize=9)
    ax.legend(fontsize=7)
    ax.grid(alpha=0.3)


def shape_test(ax: Any, comparison: ModalComparison, pair: int) -> Any:
    """Draw a measured shape on 3-D axes: the test's points at rest and moved, on the outline of the model."""
    t, m = comparison.pairs[pair]
    moved, rest = _test_motion(comparison, int(t), int(m))
    _outline(ax, comparison)
    order = list(dict.fromkeys(d.point for d in comparison.dofs))
    for a, b in comparison.test.lines:
        if a in order and b in order:
            ax.plot(*moved[[order.index(a), order.index(b)]].T, color="C3", lw=0.7, alpha=0.6)
    for a, b in zip(rest, moved, strict=True):
        ax.plot(*np.stack([a, b]).T, color="C3", lw=1.2)
    ax.plot(*rest.T, "o", color="0.5", ms=2.5)
    ax.plot(*moved.T, "o", color="C3", ms=4)
    _box(ax, comparison)
    ax.set_title(
        f"test {t + 1}: {comparison.test.frequencies[t]:.1f} Hz, loss {comparison.test.loss_factors[t]:.1e}", fontsize=9
    )
    return ax


def shape_model(ax: Any, comparison: ModalComparison, pair: int) -> Any:
    """Draw the model's shape of the same pair, deformed, with the test's points on it."""
    from matplotlib import colormaps
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    t, m = comparison.pairs[pair]
    model = comparison.model
    shape = model.shapes[m]
    motion = np.linalg.norm(shape, axis=1)
    moved = (model.points + _size(comparison) * shape / motion.max()) * 1e3
    if len(model.triangles):
        colour = motion[model.triangles].mean(axis=1) / motion.max()
        faces = colormaps["viridis"](colour)
        ax.add_collection3d(Poly3DCollection(moved[model.triangles], facecolors=faces, edgecolors="none", linewidths=0))
    else:
        ax.plot(*moved.T, ".", color="C0", ms=2)
    at = moved[np.unique(comparison.nodes)]
    ax.plot(*at.T, "o", color="C3", ms=3)
    _box(ax, comparison)
    ax.set_title(f"model {m + 1}: {model.frequencies[m]:.1f} Hz, MAC {comparison.mac[t, m]:.2f}", fontsize=9)
    return ax


def _size(comparison: ModalComparison) -> float:
    """Length of the largest motion in a drawing [m]."""
    return 0.08 * float(np.linalg.norm(np.ptp(comparison.model.points, axis=0)))


def _test_motion(comparison: ModalComparison, t: int, m: int) -> tuple[Any, Any]:
    """Points of the test moved and at rest (p, 3) [mm], with the sign of the model's shape and its size at those
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
    return (rest + _size(comparison) * motion) * 1e3, rest * 1e3


def _outline(ax: Any, comparison: ModalComparison) -> None:
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    model = comparison.model
    if len(model.triangles):
        ax.add_collection3d(
            Poly3DCollection(
                model.points[model.triangles] * 1e3, facecolors=(0.7, 0.7, 0.7, 0.08), edgecolors="none", linewidths=0
            )
        )


def _box(ax: Any, comparison: ModalComparison) -> None:
    reach = _size(comparison)
    low = (comparison.model.points.min(axis=0) - reach) * 1e3
    high = (comparison.model.points.max(axis=0) + reach) * 1e3
    ax.set_xlim(low[0], high[0])
    ax.set_ylim(low[1], high[1])
    ax.set_zlim(low[2], high[2])
    ax.set_box_aspect(high - low, zoom=1.1)
    ax.set_axis_off()
    ax.view_init(elev=12, azim=-62)


def shapes_side_by_side(comparison: ModalComparison, pairs: int = 8) -> Any:
    """Return a figure with one row for each pair: the test's shape, the model's."""
    from matplotlib.figure import Figure

    count = max(1, min(pairs, len(comparison.pairs)))
    across = min(2, count)
    rows = -(-count // across)
    fig = Figure(figsize=(5.6 * across, 3.0 * rows), layout="constrained")
    if not len(comparison.pairs):
        fig.text(0.5, 0.5, "no mode of the test found a partner", ha="center")
    for k in range(min(pairs, len(comparison.pairs))):
        row, column = divmod(k, across)
        at = row * 2 * across + 2 * column + 1
        shape_test(fig.add_subplot(rows, 2 * across, at, projection="3d"), comparison, k)
        shape_model(fig.add_subplot(rows, 2 * across, at + 1, projection="3d"), comparison, k)
    return fig
