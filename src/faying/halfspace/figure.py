"""Where two surfaces touch: open, elastic and at hardness; and the pressure there."""

from typing import Any

import numpy as np

from faying.halfspace.maps import ContactMaps
from faying.style import drawing

# colours that stay apart in grey and for colour-blind eyes
STATES = (("open", "#f2f2f2"), ("elastic", "#56b4e9"), ("at hardness", "#a03c00"))
PIXELS = 1200  # a side, at most


def _thick(values: Any) -> Any:
    """Shrink a map to `PIXELS` a side, each picture cell taking the largest of its points.

    Contact is rare: a picture that samples or averages a large map would lose it.
    """
    step = [max(1, -(-n // PIXELS)) for n in values.shape]
    over = [(0, -n % s) for n, s in zip(values.shape, step, strict=True)]
    padded = np.pad(values, over, constant_values=values.min())
    rows, columns = padded.shape[0] // step[0], padded.shape[1] // step[1]
    return padded.reshape(rows, step[0], columns, step[1]).max(axis=(1, 3))


def _picture(ax: Any, contact: ContactMaps, values: Any, title: str, **colours: Any) -> Any:
    """Draw values of the map into `ax`, its sides in a unit that suits them."""
    (ny, nx), (dx, dy) = contact.heights.shape, contact.spacing
    factor, unit = (1e3, "mm") if max(nx * dx, ny * dy) >= 1e-3 else (1e6, "µm")
    extent = [0.0, nx * dx * factor, 0.0, ny * dy * factor]
    drawn = ax.imshow(values, origin="lower", extent=extent, interpolation="nearest", **colours)
    ax.set(xlabel=f"x [{unit}]", ylabel=f"y [{unit}]", title=title)
    ax.set_aspect("equal")
    return drawn


@drawing
def contact_map(ax: Any, contact: ContactMaps) -> Any:
    """Draw into `ax` which points are open, in elastic contact and at hardness; the legend gives their shares [%]."""
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import Patch

    _picture(
        ax,
        contact,
        _thick(contact.state),
        f"contact at {contact.pressure * 1e-6:.4g} MPa",
        cmap=ListedColormap([colour for _, colour in STATES]),
        norm=BoundaryNorm([-0.5, 0.5, 1.5, 2.5], 3),
    )
    shares = (1 - contact.area, contact.area - contact.saturated, contact.saturated)
    shown = [(name, colour, share) for (name, colour), share in zip(STATES, shares, strict=True)]
    if contact.hardness is None:
        shown = shown[:2]
    handles = [Patch(facecolor=c, edgecolor="0.5", label=f"{name} {100 * share:.3g} %") for name, c, share in shown]
    ax.legend(handles=handles, ncols=2, handlelength=1.2, loc="upper center", bbox_to_anchor=(0.5, -0.24))
    return ax


@drawing
def pressure_map(ax: Any, contact: ContactMaps) -> Any:
    """Draw into `ax` the pressure at every point [MPa], open points white, with a colour bar."""
    pressure = _thick(contact.traction) * 1e-6
    shown, title = np.where(pressure > 0, pressure, np.nan), f"pressure, mean {contact.pressure * 1e-6:.4g} MPa"
    drawn = _picture(ax, contact, shown, title, cmap="viridis_r", vmin=0)
    ax.figure.colorbar(drawn, ax=ax, label="pressure [MPa]", shrink=0.8)
    return ax
