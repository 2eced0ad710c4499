"""The picture of a measured form: heights above the middle plane of the minimum zone, and what the shapes leave."""

from typing import Any

import numpy as np

from faying.form.fit import FormFit
from faying.style import new_figure
from faying.units import show


def figure(fit: FormFit, title: str) -> Any:
    """Draw the map, with its flatness in the heading."""
    width, height = np.ptp(fit.places, axis=0)
    tall = float(np.clip(6.5 * height / width, 2.0, 7.0))
    fig = new_figure(8.0, tall + 1.1)
    axes = fig.add_subplot()
    values = 1e6 * fit.levelled()
    most = 5e5 * fit.zone.flatness or 1.0
    x, y = 1e3 * fit.places.T
    if len(values) > 3:
        picture = axes.tripcolor(x, y, values, shading="gouraud", cmap="RdBu_r", vmin=-most, vmax=most)
        bar = fig.colorbar(picture, ax=axes)
        bar.set_label(f"{'gap' if fit.is_gap else 'height'} above the middle plane [um]")
    axes.set_aspect("equal")
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")
    axes.set_title(f"{title}: flatness {show(fit.zone.flatness, 'm', digits=3)} (minimum zone)")
    return fig
