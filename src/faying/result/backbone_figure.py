"""Figure of backbones: frequency and damping against acceleration, with what was measured and the static cycle."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from faying.measured.ring_down import MeasuredBackbone
from faying.result.backbone_record import BackboneRecord
from faying.style import COLUMN, axes_of, colour, drawing, headline, legend_above, new_figure, plain, plain_numbers
from faying.units import in_mm, load_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ROUNDING = 1e-9  # of the greatest damping: less is rounding


def label(curve: BackboneRecord, curves: Sequence[BackboneRecord]) -> str:
    """What tells a curve from the others: law, friction and preload, where these differ."""
    parts = []
    if len({other.laws for other in curves}) > 1:
        parts.append(", ".join(dict.fromkeys(curve.laws)))
    if len({other.preload for other in curves}) > 1:
        parts.append(load_text(curve.preload))
    if len({other.friction for other in curves}) > 1 or not parts:
        parts.append(f"friction {curve.friction_text}")
    return ", ".join(parts)


@drawing
def panel(ax: Any, curves: Sequence[BackboneRecord], quantity: str, measured: Sequence[MeasuredBackbone] = ()) -> Any:
    """Draw frequency [Hz] or damping [%] of curves over acceleration, the static cycle as circles.

    quantity: "frequency" or "damping". Measured points, those of the curves' study first, are hollow,
    with bars of 95 % where standard errors are known.
    """
    own = curves[0].measured
    measured = [*([] if own is None else [own]), *measured]
    factor = factor_of(quantity)
    for k, curve in enumerate(curves):
        color = colour(k)
        ax.plot(
            curve.acceleration,
            factor * getattr(curve, quantity),
            color=color,
            lw=1.5,
            marker=".",
            ms=3.5,
            label=label(curve, curves),
        )
        if curve.witness is not None:
            ax.plot(
                curve.witness.acceleration,
                factor * getattr(curve.witness, quantity),
                "o",
                mfc="none",
                mec=color,
                ms=6,
                mew=1.0,
                label="static cycle" if k == 0 else None,
            )
    for k, points in enumerate(measured):
        marks(ax, points, quantity, k)
    return framed(ax, quantity)


def marks(ax: Any, points: MeasuredBackbone, quantity: str, k: int) -> None:
    """Draw measured points, marked as the k-th of their kind, with 95 % intervals where standard errors are known."""
    values, error = getattr(points, quantity), getattr(points, f"{quantity}_error")
    known, factor = np.isfinite(values), factor_of(quantity)
    ends = 1.96 * factor * error[known]
    ax.errorbar(
        points.acceleration[known],
        factor * values[known],
        yerr=np.nan_to_num(ends) if np.isfinite(ends).any() else None,
        fmt="sv^x"[k % 4],
        color="0.25",
        ms=3.5,
        mew=1.0,
        mfc="white",
        elinewidth=0.8,
        label=plain(Path(points.source).stem if points.source else "measured"),
    )


def factor_of(quantity: str) -> float:
    """From SI to what is drawn."""
    return 100.0 if quantity == "damping" else 1.0


def framed(ax: Any, quantity: str) -> Any:
    """Scales, grid and names of the axes."""
    ax.set_xscale("log")
    plain_numbers(ax.xaxis)
    ax.grid(which="major", alpha=0.3)
    ax.grid(which="minor", alpha=0.1)
    if quantity == "frequency":
        ax.set_ylabel("frequency [Hz]")
        ax.ticklabel_format(axis="y", useOffset=False)
        return ax
    ax.set(ylabel="damping ratio [%]", yscale="log")
    plain_numbers(ax.yaxis)
    return ax


@drawing
def figure(curves: Sequence[BackboneRecord], measured: Sequence[MeasuredBackbone] = ()) -> Any:
    """Return the figure of curves of one mode: frequency above, damping below, over the same acceleration.

    Args:
        curves: of one mode, at one point.
        measured: points to lay over them.
    """
    fig = new_figure(COLUMN, 4.6)
    upper, lower = fig.subplots(2, 1, sharex=True)
    panel(upper, curves, "frequency", measured)
    panel(lower, curves, "damping", measured)
    first = curves[0]
    lower.set_xlabel(f"acceleration at {in_mm(first.at)} [m/s²]")
    fig.suptitle(f"{headline(first.title)}: mode {first.mode}")
    legend_above(upper, 1)
    return fig


@drawing
def backbone_axes(curve: BackboneRecord, ax: Any = None) -> "list[Axes]":
    """Draw frequency and damping of a curve, one axes each."""
    axes = axes_of(ax, 2, width=COLUMN, height=2.7)
    for one, quantity in zip(axes, ("frequency", "damping"), strict=True):
        panel(one, [curve], quantity)
        one.set_xlabel(f"acceleration at {in_mm(curve.at)} [m/s²]")
    axes[1].set_title(f"{headline(curve.title)}: mode {curve.mode}, {load_text(curve.preload)}")
    legend_above(axes[0], 1)
    return axes


@drawing
def measured(points: MeasuredBackbone) -> Any:
    """Return the figure of measured points alone: frequency above, damping below."""
    fig = new_figure(COLUMN, 4.6)
    upper, lower = fig.subplots(2, 1, sharex=True)
    for ax, quantity in ((upper, "frequency"), (lower, "damping")):
        marks(ax, points, quantity, 0)
        framed(ax, quantity)
    lower.set_xlabel("acceleration [m/s²]")
    fig.suptitle(plain(Path(points.source).name) or "free decay")
    return fig
