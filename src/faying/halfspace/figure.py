"""Where two surfaces touch: open, elastic and at hardness; and the pressure there."""

from typing import Any

from faying.halfspace.maps import ContactMaps
from faying.style import WIDE, drawing, new_panels

# colours that stay apart in grey and for colour-blind eyes
STATES = (("open", "#f2f2f2"), ("elastic", "#56b4e9"), ("at hardness", "#a03c00"))


def _extent(contact: ContactMaps) -> tuple[list[float], str]:
    """Sides of the map with a unit that suits them."""
    (ny, nx), (dx, dy) = contact.heights.shape, contact.spacing
    width, height = nx * dx, ny * dy
    factor, unit = (1e3, "mm") if max(width, height) >= 1e-3 else (1e6, "µm")
    return [0.0, width * factor, 0.0, height * factor], unit


def _frame(ax: Any, unit: str, title: str) -> None:
    ax.set(xlabel=f"x [{unit}]", ylabel=f"y [{unit}]", title=title)
    ax.set_aspect("equal")


def _thick(mask: Any, shape: tuple[int, int], pixels: int) -> Any:
    """Shrink a map to at most `pixels` a side, each picture cell taking the largest of its points.

    Contact is rare: a picture that samples or averages a large map would lose it.
    """
    import numpy as np

    step = [max(1, -(-n // pixels)) for n in shape]
    padded = np.pad(mask, [(0, -n % s) for n, s in zip(shape, step, strict=True)], constant_values=mask.min())
    rows, columns = padded.shape[0] // step[0], padded.shape[1] // step[1]
    return padded.reshape(rows, step[0], columns, step[1]).max(axis=(1, 3))


@drawing
def contact_map(ax: Any, contact: ContactMaps, *, pixels: int = 1200) -> Any:
    """Draw into `ax` which points are open, in elastic contact and at hardness; the legend gives their shares [%]."""
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import Patch

    extent, unit = _extent(contact)
    state = _thick(contact.state, contact.heights.shape, pixels)
    ax.imshow(
        state,
        origin="lower",
        extent=extent,
        interpolation="nearest",
        cmap=ListedColormap([colour for _, colour in STATES]),
        norm=BoundaryNorm([-0.5, 0.5, 1.5, 2.5], 3),
    )
    shares = (1 - contact.area, contact.area - contact.saturated, contact.saturated)
    shown = [(name, colour, share) for (name, colour), share in zip(STATES, shares, strict=True)]
    if contact.hardness is None:
        shown = shown[:2]
    handles = [Patch(facecolor=c, edgecolor="0.5", label=f"{name} {100 * share:.3g} %") for name, c, share in shown]
    place = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.24)}
    ax.legend(handles=handles, ncols=2, handlelength=1.2, **place)
    _frame(ax, unit, f"contact at {contact.pressure * 1e-6:.4g} MPa")
    return ax


@drawing
def pressure_map(ax: Any, contact: ContactMaps, *, pixels: int = 1200) -> Any:
    """Draw into `ax` the pressure at every point [MPa], open points white, with a colour bar."""
    import numpy as np

    extent, unit = _extent(contact)
    pressure = _thick(contact.traction, contact.heights.shape, pixels) * 1e-6
    drawn = ax.imshow(
        np.where(pressure > 0, pressure, np.nan),
        origin="lower",
        extent=extent,
        cmap="viridis_r",
        vmin=0,
        interpolation="nearest",
    )
    ax.figure.colorbar(drawn, ax=ax, label="pressure [MPa]", shrink=0.8)
    _frame(ax, unit, f"pressure, mean {contact.pressure * 1e-6:.4g} MPa")
    return ax


@drawing
def contact_figure(contact: ContactMaps) -> Any:
    """Return a figure with the contact's states beside its pressures."""
    fig = new_panels(2, width=WIDE / 2, height=3.6)
    left, right = fig.axes
    contact_map(left, contact)
    pressure_map(right, contact)
    return fig
