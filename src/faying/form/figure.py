"""The picture of a measured form: heights above the middle plane of the minimum zone, and what the shapes leave."""

from typing import Any

import numpy as np

from faying.form.fit import FormFit
from faying.style import COLUMN, WIDE, drawing, headline, new_figure
from faying.typeset import unit
from faying.units import show


@drawing
def figure(fit: FormFit, title: str) -> Any:
    """Draw the map, with its flatness in the heading."""
    width, height = np.ptp(fit.places, axis=0)
    tall = float(np.clip((WIDE - 1.6) * height / width, 1.0, 5.0))
    fig = new_figure(float(np.clip(tall * width / height + 1.6, COLUMN, WIDE)), tall + 0.9)
    axes = fig.add_subplot()
    values = 1e6 * fit.levelled()
    most = 5e5 * fit.zone.flatness or 1.0
    x, y = 1e3 * fit.places.T
    if len(values) > 3:
        picture = axes.tripcolor(x, y, values, shading="gouraud", rasterized=True, cmap="RdBu_r", vmin=-most, vmax=most)
        bar = fig.colorbar(picture, ax=axes)
        bar.set_label(f"{'gap' if fit.is_gap else 'height'} above the middle plane [µm]")
    axes.set_aspect("equal")
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")
    flatness = unit(show(fit.zone.flatness, "m", digits=3))
    axes.set_title(f"{headline(title)}\nflatness {flatness} (minimum zone)")
    return fig
