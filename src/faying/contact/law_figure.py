"""The figure of one contact law: stiffness by branch, and real area, against nominal pressure."""

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.parameter import checked
from faying.contact.response import Response, label_and_scale
from faying.errors import InputError
from faying.style import SMALL, axes_of, colour, drawing, headline, plain, plain_numbers
from faying.typeset import typeset
from faying.typing import Array, Mask
from faying.units import show

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SHOWN = (0.1e6, 50e6)  # Pa: pressures of a plot where none are given
POINTS = 120


class DrawnLaw(Protocol):
    """What a law is asked for to be drawn."""

    @property
    def name(self) -> str:
        """What the law is called."""

    @property
    def branch(self) -> str:
        """What k_n is the slope of."""

    @property
    def least_pressure(self) -> float:
        """The least pressure that the law resolves [Pa]."""

    @property
    def greatest_pressure(self) -> float:
        """The pressure at which the law ends [Pa]."""

    def at_pressure(self, pressure: ArrayLike, *, after: ArrayLike | None = None) -> Response:
        """Return the response at pressures [Pa]."""


def draw_curve(
    ax: Any, pressure: Array, value: Array, valid: Mask, *, color: Any, width: float = 1.4, **style: Any
) -> None:
    """Draw a curve, thick where it is valid and thin and dotted where it is not."""
    ax.plot(pressure * 1e-6, value, ":", color=color, lw=0.8)
    ax.plot(pressure * 1e-6, np.where(valid, value, np.nan), color=color, lw=width, **style)


def name_axes(ax: Any, quantity: str) -> None:
    """Name both axes with their units; logarithmic but for a loss factor."""
    ax.set(xscale="log", xlabel="nominal pressure [MPa]", ylabel=typeset(label_and_scale(quantity)[0]))
    if not quantity.startswith("loss"):
        ax.set_yscale("log")
    plain_numbers(ax.xaxis)
    ax.grid(alpha=0.3)


@drawing
def law_plot(law: DrawnLaw, pressure: ArrayLike | None, axes: Any, after: float | str | None = None) -> "list[Axes]":
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
            draw_curve(stiff, p, value * scale, response.valid, color=colour(row), label=label, linestyle=dashed)
    if response.k_n_low is not None and response.k_n_high is not None:
        low, high = response.k_n_low * scale, response.k_n_high * scale
        stiff.fill_between(p * 1e-6, low, high, color=colour(0), alpha=0.15, lw=0, label=typeset("range of k_n"))
    if response.k_t is not None:
        draw_curve(
            stiff, p, response.k_t * scale, response.valid, color=colour(2), label=typeset("k_t, tangential"), width=1.2
        )
    back = None if after is None else law.at_pressure(p, after=after)
    if back is not None and after is not None:
        most = checked(after, name="after", unit="Pa", zero=False)
        way = np.where(p < most, 1.0, np.nan)
        label = typeset(f"k_n after {plain(show(float(most), 'Pa'))}")
        stiff.plot(p * 1e-6, way * back.k_n * scale, "-.", color=colour(3), lw=1.6, label=label)
    name_axes(stiff, "k_n")
    stiff.set_ylabel("stiffness per area [MPa/µm]")
    outside = "" if response.valid.all() else "; dotted: outside its range"
    stiff.legend(loc="upper left")
    stiff.set_title(
        f"{headline(law.name)}: ends at {plain(show(law.greatest_pressure, 'Pa'))}{outside}", fontsize=SMALL
    )
    if response.area is not None:
        draw_curve(drawn[1], p, response.area, response.valid, color=colour(1))
        if back is not None:
            drawn[1].plot(p * 1e-6, way * back.area, "-.", color=colour(3), lw=1.6)
        name_axes(drawn[1], "area")
    return drawn


def _pressures(law: DrawnLaw, pressure: ArrayLike | None) -> Array:
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
