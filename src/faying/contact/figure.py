"""Curves of contact laws against nominal pressure: stiffness, real area and loss."""

from collections.abc import Mapping
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from faying.contact.compare import Comparison
from faying.contact.law_figure import draw_curve, name_axes
from faying.contact.models.half_space import HalfSpace
from faying.contact.response import Response, label_and_scale
from faying.errors import InputError
from faying.style import (
    COLOURS,
    SMALL,
    TALLEST,
    WIDE,
    axes_of,
    colour,
    drawing,
    new_panels,
    plain,
    shared_legend,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PANELS = ("area", "k_n", "k_t", "loss_n")
BLACK = COLOURS.index("#000000")  # of the solved contact alone


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
            draw_curve(ax, response.pressure, value * scale, response.valid, label=law, **_look(row))
    name_axes(ax, quantity)
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
        draw_curve(axes, comparison.pressure, value * scale, response.valid, label=law, **look)
    name_axes(axes, quantity)
    axes.set_title(plain("\n".join(wrap(title, 84))), fontsize=SMALL)
    axes.legend(title="dotted: outside its range", loc="center left", bbox_to_anchor=(1.0, 0.5))
    return axes
