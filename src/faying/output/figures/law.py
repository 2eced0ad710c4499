"""Curves of contact laws against nominal pressure: area, stiffness and loss, one panel each."""

from collections.abc import Mapping
from typing import Any

from faying.contact.law import Response
from faying.style import new_panels

PANELS = (
    ("area", "real area / nominal area", 1.0),
    ("k_n", "normal stiffness k_n [MPa/um]", 1e-12),
    ("k_t", "tangential stiffness k_t [MPa/um]", 1e-12),
    ("loss_n", "normal loss factor", 1.0),
)


def panel(ax: Any, responses: Mapping[str, Response], name: str, label: str, scale: float = 1.0) -> Any:
    """Draw one quantity of the laws that have it into `ax`; thin and dotted where a law leaves its validity range."""
    import numpy as np
    from matplotlib import colormaps

    for i, (law, response) in enumerate(responses.items()):
        value = response.quantities().get(name)
        if value is None:
            continue
        p, valid = response.pressure * 1e-6, response.valid
        color = colormaps["tab20"]((2 * i + i // 10) % 20)
        marker = ("-", "-.")[i // 10 % 2]
        shown = np.where(valid, value * scale, np.nan)
        ax.plot(p, value * scale, ":", color=color, lw=1.0)
        ax.plot(p, shown, marker, color=color, lw=1.8, label=law)
    ax.set(xscale="log", xlabel="nominal pressure [MPa]", ylabel=label)
    if not name.startswith("loss"):
        ax.set_yscale("log")
    ax.grid(alpha=0.3)
    return ax


def curves(responses: Mapping[str, Response]) -> Any:
    """Return a figure with one panel per quantity that any of the laws defines."""
    panels = [p for p in PANELS if any(p[0] in r.quantities() for r in responses.values())]
    fig = new_panels(min(2, len(panels)), -(-len(panels) // 2))
    for ax, (name, label, scale) in zip(fig.axes, panels, strict=False):
        panel(ax, responses, name, label, scale)
    for ax in fig.axes[len(panels) :]:
        ax.set_visible(False)
    handles = {label: h for ax in fig.axes for h, label in zip(*ax.get_legend_handles_labels(), strict=True)}
    if len(responses) > 1:
        fig.legend(
            handles.values(),
            handles.keys(),
            loc="outside lower center",
            ncols=4,
            frameon=False,
            title="thick: within the validity range; thin and dotted: outside it",
        )
    return fig
