"""Curves of contact laws against nominal pressure: stiffness, real area and loss."""

from collections.abc import Mapping
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.compare import Comparison
from faying.contact.comparison_table import label_and_scale
from faying.contact.law import ContactLaw, Response, checked
from faying.contact.models.half_space import HalfSpace
from faying.errors import InputError
from faying.style import (
    COLOURS,
    SMALL,
    TALLEST,
    WIDE,
    axes_of,
    colour,
    drawing,
    headline,
    new_panels,
    plain,
    plain_numbers,
    shared_legend,
)
from faying.typeset import typeset
from faying.typing import Array, Mask
from faying.units import show

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PANELS = ("area", "k_n", "k_t", "loss_n")
SHOWN = (0.1e6, 50e6)  # Pa: pressures of a plot where none are given
POINTS = 120
BLACK = COLOURS.index("#000000")  # of the solved contact alone


def _curve(
    ax: Any, pressure: Array, value: Array, valid: Mask, *, color: Any, width: float = 1.4, **style: Any
) -> None:
    """Draw a curve, thick where it is valid and thin and dotted where it is not."""
    ax.plot(pressure * 1e-6, value, ":", color=color, lw=0.8)
    ax.plot(pressure * 1e-6, np.where(valid, value, np.nan), color=color, lw=width, **style)


def _axes(ax: Any, quantity: str) -> None:
    """Name both axes with their units; logarithmic but for a loss factor."""
    ax.set(xscale="log", xlabel="nominal pressure [MPa]", ylabel=typeset(label_and_scale(quantity)[0]))
    if not quantity.startswith("loss"):
        ax.set_yscale("log")
    plain_numbers(ax.xaxis)
    ax.grid(alpha=0.3)


def _look(row: int) -> dict[str, Any]:
    """Colour and dashes of the row-th law: eight colours, then the same dashed, dash-dotted and dotted."""
    return {"color": colour(row), "linestyle": ("-", "--", "-.", (0, (1, 1)))[row // len(COLOURS) % 4]}


@drawing
def panel(ax: Any, responses: Mapping[str, Response], quantity: str) -> Any:
    """Draw one quantity of the laws that have it into `ax`; thin and dotted where a law leaves its validity range."""
    _, scale = label_and_scale(quantity)
    for row, (law, response) in enumerate(responses.items()):
        value = response.quantities().get(quantity)
        if value is not None:
            _curve(ax, response.pressure, value * scale, response.valid, label=law, **_look(row))
    _axes(ax, quantity)
    return ax


@drawing
def curves(responses: Mapping[str, Response]) -> Any:
    """Return a figure with one panel per quantity that any of the laws defines."""
    panels = [p for p in PANELS if any(p in r.quantities() for r in responses.values())]
    rows = -(-len(panels) // 2)
    fig = new_panels(min(2, len(panels)), rows, width=WIDE / 2, height=min(2.4, TALLEST / rows))
    for ax, quantity in zip(fig.axes, panels, strict=False):
        panel(ax, responses, quantity)
    for ax in fig.axes[len(panels) :]:
        ax.set_visible(False)
    if len(responses) > 1:
        shared_legend(fig, fig.axes, 3, title="thick: within the validity range; thin and dotted: outside it")
    return fig


@drawing
def law_plot(law: ContactLaw, pressure: ArrayLike | None, axes: Any) -> "list[Axes]":
    """Draw the stiffness of a law, by branch, and its real area; see `ContactLaw.plot`."""
    p = _pressures(law, pressure)
    response = law.at_pressure(p)
    drawn = axes_of(axes, 1 if response.area is None else 2)
    stiff, (_, scale) = drawn[0], label_and_scale("k_n")
    branch = law.branch if response.k_load is None else "unloading"
    rows = (("k_n", response.k_n, typeset(f"k_n, {branch}")), ("k_load", response.k_load, typeset("k_load, loading")))
    for row, (name, value, label) in enumerate(rows):
        if value is not None:
            dashed = "--" if name == "k_load" else "-"
            _curve(stiff, p, value * scale, response.valid, color=colour(row), label=label, linestyle=dashed)
    if response.k_n_low is not None and response.k_n_high is not None:
        low, high = response.k_n_low * scale, response.k_n_high * scale
        stiff.fill_between(p * 1e-6, low, high, color=colour(0), alpha=0.15, lw=0, label=typeset("range of k_n"))
    if response.k_t is not None:
        _curve(
            stiff, p, response.k_t * scale, response.valid, color=colour(2), label=typeset("k_t, tangential"), width=1.2
        )
    _axes(stiff, "k_n")
    stiff.set_ylabel("stiffness per area [MPa/µm]")
    outside = "" if response.valid.all() else "; dotted: outside its range"
    stiff.legend(loc="upper left")
    stiff.set_title(f"{headline(law.name)}: {plain(_ends(law))}{outside}", fontsize=SMALL)
    if response.area is not None:
        _curve(drawn[1], p, response.area, response.valid, color=colour(1))
        _axes(drawn[1], "area")
    return drawn


def _ends(law: ContactLaw) -> str:
    return f"ends at {show(law.greatest_pressure, 'Pa')}"


def _pressures(law: ContactLaw, pressure: ArrayLike | None) -> Array:
    """Rising pressures to draw at; those that the law covers where none are given."""
    if pressure is not None:
        p = np.unique(checked(pressure, name="pressure", unit="Pa", zero=False))
        if p.size < 2:
            raise InputError("a curve needs at least two different pressures; leave them out for 0.1 to 50 MPa")
        return p
    low, high = max(SHOWN[0], law.least_pressure), min(SHOWN[1], law.greatest_pressure)
    if not low < high:
        low, high = law.least_pressure, law.greatest_pressure
    return np.asarray(np.geomspace(low * (1 + 1e-12), high * (1 - 1e-12), POINTS))


@drawing
def comparison_plot(comparison: Comparison, quantity: str, *, title: str, ax: Any) -> "Axes":
    """Draw one quantity of the laws that have it, the solved contact in black; see `Mates.compare_plot`."""
    (axes,) = axes_of(ax, 1, width=WIDE, height=3.4)
    if not any(quantity in r.quantities() for r in comparison.responses.values()):
        why = "; ".join(f"{name}: {text}" for name, text in comparison.left_out.items())
        raise InputError(f"none of these laws gives {quantity}; name others" + (f" ({why})" if why else ""))
    _, scale = label_and_scale(quantity)
    for row, (law, response) in enumerate(comparison.responses.items()):
        value = response.quantities().get(quantity)
        if value is None:
            continue
        solved = law == HalfSpace.name
        look = {"color": "black", "width": 2.4} if solved else _look(row + (row >= BLACK))
        _curve(axes, comparison.pressure, value * scale, response.valid, label=law, **look)
    _axes(axes, quantity)
    axes.set_title(plain("\n".join(wrap(title, 84))), fontsize=SMALL)
    axes.legend(title="dotted: outside its range", loc="center left", bbox_to_anchor=(1.0, 0.5))
    return axes
